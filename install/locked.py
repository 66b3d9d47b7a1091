"""Print the entries of requirements.lock that some tables of pyproject.toml need.

``python install/locked.py run build``: ``run`` is the service with symbolic kinematics, ``build``
the build backend, ``page`` Node for building the page, ``uv`` the installer. The lock also holds
what only developers need; each of its entries says ``# via`` what it is there.
"""

from __future__ import annotations

import re
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements.lock"
EDITABLE = "editables"
"""What the build backend needs besides to install the checkout itself."""


@dataclass(frozen=True)
class Entry:
    """One entry of the lock.

    Attributes:
        name: Name of the distribution, as package indexes compare it.
        text: The entry: version, marker, hashes.
        parents: Names of the distributions that depend on it.
    """

    name: str
    text: str
    parents: frozenset[str]


def normalised(name: str) -> str:
    """Return a distribution's name as package indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def named(requirement: str) -> str:
    """Return the normalised name of what a requirement asks for."""
    return normalised(re.split(r"[^\w.-]", requirement.strip(), maxsplit=1)[0])


def entries(lock: str) -> list[Entry]:
    """Return the entries of a lock that ``uv pip compile`` wrote, in its order."""
    found = []
    for block in re.split(r"\n(?=\w)", lock.strip()):
        lines = block.splitlines()
        notes = [line.strip(" #") for line in lines if line.lstrip().startswith("#")]
        text = "\n".join(line for line in lines if not line.lstrip().startswith("#"))
        parents = {named(note.removeprefix("via ")) for note in notes if note != "via"}
        found.append(Entry(named(lines[0]), text, frozenset(parents)))
    return found


def needed(locked: list[Entry], wanted: set[str]) -> list[Entry]:
    """Return the entries of some distributions and of all that they depend on.

    Raises:
        SystemExit: The lock lacks one.
    """
    if missing := wanted - {entry.name for entry in locked}:
        sys.exit(f"requirements.lock lacks {', '.join(sorted(missing))}; run: make lock")
    known: set[str] = set()
    found = wanted
    while found != known:
        known = found
        found = known | {entry.name for entry in locked if entry.parents & known}
    return [entry for entry in locked if entry.name in known]


def tables() -> dict[str, list[str]]:
    """Return the requirements of each table that the command line may name."""
    read: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    project, extras = read["project"], read["project"]["optional-dependencies"]
    return {
        "run": project["dependencies"] + extras["symbolic"],
        "build": [*read["build-system"]["requires"], EDITABLE],
        "page": extras["page"],
        "uv": ["uv"],
    }


def locked(*names: str) -> str:
    """Return the lock's text of what the tables of these names need; all of it for none."""
    found = entries(LOCK.read_text(encoding="utf-8"))
    if names:
        known = tables()
        found = needed(found, {named(wanted) for name in names for wanted in known[name]})
    return "".join(f"{entry.text}\n" for entry in found)


if __name__ == "__main__":
    sys.stdout.write(locked(*sys.argv[1:]))
