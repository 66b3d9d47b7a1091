"""The build of the page: only when it must, and with a Node that is new enough."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = ("index.html", "package.json", "package-lock.json", ".npmrc", "tsconfig.json")


@pytest.fixture
def checkout(tmp_path):
    """The page's sources and what was built of them, elsewhere."""
    shutil.copytree(ROOT / "web" / "src", tmp_path / "web" / "src")
    for name in (*SOURCES, "vite.config.js"):
        shutil.copy(ROOT / "web" / name, tmp_path / "web" / name)
    shutil.copytree(ROOT / "app" / "static", tmp_path / "app" / "static")
    return tmp_path


def test_what_is_fresh_is_not_built_and_needs_no_node(hook, checkout, monkeypatch):
    monkeypatch.setenv("PATH", str(checkout))
    assert hook.is_fresh(checkout)
    assert hook.build_page(checkout) is False


@pytest.mark.parametrize(
    "change",
    [
        lambda web: (web / "src" / "main.ts").write_text("alert(1)"),
        lambda web: (web / "src" / "main.ts").rename(web / "src" / "other.ts"),
        lambda web: (web / "src" / "scene" / "new.ts").write_text(""),
        lambda web: (web / "package-lock.json").write_text("{}"),
        lambda web: (web.parent / "app" / "static" / ".sources").unlink(),
    ],
    ids=["text", "name", "new file", "lock", "no stamp"],
)
def test_any_change_of_the_sources_makes_it_stale(hook, change, checkout):
    change(checkout / "web")
    assert not hook.is_fresh(checkout)


@pytest.mark.parametrize(
    ("version", "taken"),
    [
        ("v18.20.4", False),
        ("v20.18.9", False),
        ("v20.19.0", True),
        ("v21.7.3", False),
        ("v22.11.0", False),
        ("v22.12.0", True),
        ("v24.19.0", True),
        ("no", False),
    ],
)
def test_only_a_node_that_is_new_enough_is_taken(hook, version, taken, tmp_path, monkeypatch):
    for name in ("node", "npm"):
        program = tmp_path / name
        program.write_text(f"#!/bin/sh\necho {version}\n")
        program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert hook.npm_on_path() == (str(tmp_path / "npm") if taken else None)


def test_a_build_that_fails_says_so_and_keeps_the_page(hook, checkout, tmp_path, monkeypatch):
    folder = tmp_path / "bin"
    folder.mkdir()
    for name, text in (("node", "echo v22.12.0"), ("npm", "echo broken >&2; exit 1")):
        (folder / name).write_text(f"#!/bin/sh\n{text}\n")
        (folder / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(folder))
    (checkout / "web" / "src" / "main.ts").write_text("alert(1)")
    with pytest.raises(SystemExit, match=r"npm ci .* failed"):
        hook.build_page(checkout)
    assert (checkout / "app" / "static" / "index.html").is_file()
    assert [path.name for path in (checkout / "app").iterdir()] == ["static"]


def test_the_build_does_without_what_only_checks_need(hook, checkout, tmp_path, monkeypatch):
    folder, log = tmp_path / "bin", tmp_path / "log"
    folder.mkdir()
    npm = f'echo "$@" >> {log}; mkdir -p node_modules'
    for name, text in (("node", "echo v22.12.0"), ("npm", npm)):
        (folder / name).write_text(f"#!/bin/sh\n{text}\n")
        (folder / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")
    web = checkout / "web"
    for development in (False, False, True, True, False):
        hook.install_packages(web, development=development)
    first, second = log.read_text().splitlines()
    assert "--omit=dev" in first
    assert "--omit" not in second


def test_types_hold_and_pure_functions_pass_their_own_tests(hook):
    hook.install_packages(ROOT / "web", development=True)
    hook.run_npm(ROOT / "web", "run", "--silent", "check", NO_COLOR="1")


def test_a_second_build_by_hand_does_nothing():
    done = subprocess.run(
        [sys.executable, str(ROOT / "hatch_build.py")], capture_output=True, text=True, check=True
    )
    assert done.stdout + done.stderr == ""
