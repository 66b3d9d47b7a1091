"""Every command of the documentation runs, in order, and prints what its page shows."""

import re
import sys
from itertools import pairwise
from pathlib import Path

import httpx
import pytest

from dh_to_urdf import read_yaml
from tests.docs.blocks import OUTPUT, PAGES, ROOT, RUN, assert_same, blocks_of, run, runs_of

ILLUSTRATIONS = ("yaml",)
"""Languages of blocks that are read, not run."""
COMMANDS = ("console",)
"""Languages of blocks that are named in ``ELSEWHERE``."""
IMAGE = "docker/image-test.sh builds the image and runs it"
ELSEWHERE = {
    "make run": "tests/docs/test_start.py",
    "docker compose up": IMAGE,
    "docker build -t denavit .": IMAGE,
    "docker run --rm -p 8000:8000 -v denavit-data:/data denavit": IMAGE,
    'docker run --rm -v denavit-data:/data -v "$PWD":/backup alpine cp -r /data'
    " /backup/denavit-data": "tests/torture/store.py copies the directory while it is written to",
    "denavit serve --host 0.0.0.0 --port 8000 --workers 2 --data-dir /srv/denavit": "every test"
    " with a server starts one by this command, on 127.0.0.1",
}
"""Commands that these tests cannot run, and what runs them."""
NOT_IN_CURL_7_81 = re.compile(r"--json|--url-query|--rate|--variable|--expand-|%header\{")


def text_of(name: str) -> str:
    return (ROOT / name).read_text()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The reader's folder: empty, but for an environment that has the commands."""
    (tmp_path / ".venv").symlink_to(Path(sys.executable).parent.parent)
    return tmp_path


@pytest.fixture
def clean_store(server):
    """Deletes what a page uploads."""
    yield
    listed = httpx.get(f"{server}/v1/robots?page_size=1000").json()["robots"]
    for one in listed:
        if not one["shipped"]:
            assert httpx.delete(f"{server}/v1/robots/{one['id']}").status_code == 204


@pytest.mark.parametrize("name", [name for name in PAGES if runs_of(text_of(name))])
@pytest.mark.usefixtures("clean_store")
def test_commands_print_what_is_shown(name, server, folder):
    for block, shown in runs_of(text_of(name)):
        printed = run(block, server, folder)
        if shown is not None:
            assert_same(printed, shown)


def test_most_pages_have_commands():
    assert sum(len(runs_of(text_of(name))) for name in PAGES) > 35


@pytest.mark.parametrize("name", PAGES)
def test_a_block_is_run_or_shown_or_named(name):
    known = (*RUN, *OUTPUT, *ILLUSTRATIONS, *COMMANDS)
    blocks = blocks_of(text_of(name))
    assert [block.text for block in blocks if block.language not in known] == []
    commands = [block for block in blocks if block.language in COMMANDS]
    lines = [line for block in commands for line in block.text.splitlines()]
    assert [line for line in lines if line not in ELSEWHERE] == []
    for block in blocks:
        if block.language == "yaml":
            assert read_yaml(block.text).rows


def test_an_output_stands_below_its_command():
    for name in PAGES:
        blocks = blocks_of(text_of(name))
        for before, block in pairwise([None, *blocks]):
            if block.language in OUTPUT:
                assert before is not None, block.text
                assert before.language in RUN, block.text


def test_no_command_is_named_in_vain():
    blocks = [block for name in PAGES for block in blocks_of(text_of(name))]
    lines = {line for block in blocks for line in block.text.splitlines()}
    assert set(ELSEWHERE) <= lines


@pytest.mark.parametrize("name", PAGES)
def test_commands_work_with_the_curl_of_ubuntu_22_04(name):
    for block in blocks_of(text_of(name)):
        assert not NOT_IN_CURL_7_81.search(block.text), block.text
