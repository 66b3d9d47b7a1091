"""Links between the documents of the repository lead somewhere, as a forge resolves them."""

import re

import pytest

from app.guide.rendering import headings_of
from tests.docs.blocks import ROOT

DOCUMENTS = (
    *sorted(ROOT.glob("*.md")),
    *sorted(ROOT.glob("docs/*.md")),
    *sorted(ROOT.glob("labs/**/*.md")),
    ROOT / "web/README.md",
)
LINK = re.compile(r"\]\(([^)\s]+)\)|<(http[^>]+)>")
SERVICE = "http://localhost:8000"
FOLDERS = "app|kinematics|robots|dh_to_urdf|tests|bench|deploy|docker|docs|web"
PATH = re.compile(rf"`((?:{FOLDERS})/[\w/.-]*)`")
MADE = ("app/static",)
"""What is not in the repository, but built."""


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links(document, client):
    for relative, absolute in LINK.findall(document.read_text()):
        link = relative or absolute
        if link.startswith("http"):
            assert link.startswith(SERVICE), link
            assert client.get(link.removeprefix(SERVICE) or "/").status_code == 200, link
            continue
        target, _, fragment = link.partition("#")
        path = (document.parent / target).resolve() if target else document
        assert path.exists(), link
        if fragment:
            assert fragment in {one.anchor for one in headings_of(path.read_text())}, link


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_that_are_named_exist(document):
    named = {name for name in PATH.findall(document.read_text()) if "*" not in name}
    assert [name for name in named if name not in MADE and not (ROOT / name).exists()] == []
