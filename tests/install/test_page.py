"""The page that is built beside the service."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILES = ("hatch_build.py", "pyproject.toml", "requirements.lock")


@pytest.fixture
def checkout(tmp_path):
    """A checkout without a page, as far as building it goes."""
    for name in FILES:
        shutil.copy(ROOT / name, tmp_path / name)
    shutil.copytree(ROOT / "install", tmp_path / "install")
    modules = shutil.ignore_patterns("node_modules")
    shutil.copytree(ROOT / "web", tmp_path / "web", ignore=modules)
    (tmp_path / "app").mkdir()
    (tmp_path / ".venv").mkdir()
    return tmp_path


def build(checkout, **environment):
    return subprocess.run(
        [sys.executable, str(checkout / "install" / "page.py")],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def left(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_build_that_fails_says_where_to_look_and_leaves_nothing(checkout, tmp_path):
    programs = tmp_path / "programs"
    programs.mkdir()
    for name, text in (("node", "echo v22.12.0"), ("npm", "echo no network >&2; exit 1")):
        (programs / name).write_text(f"#!/bin/sh\n{text}\n")
        (programs / name).chmod(0o755)
    done = build(checkout, PATH=str(programs))
    assert done.stderr == ("the page could not be built, see .venv/page.log; the API needs none\n")
    assert "no network" in (checkout / ".venv" / "page.log").read_text()
    assert left(checkout / ".venv") == ["page.log"]
    assert left(checkout / "app") == []


@pytest.mark.slow
def test_the_page_comes_and_nothing_else_is_left(checkout):
    done = build(checkout)
    assert done.stderr == "the page is built\n"
    assert (checkout / "app" / "static" / "index.html").is_file()
    assert left(checkout / "app") == ["static"]
    assert left(checkout / ".venv") == ["page.log"]
    assert not (checkout / "web" / "node_modules").exists()
    again = build(checkout, PATH="/nowhere")
    assert again.stderr == ""
