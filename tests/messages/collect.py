"""Every message template in the sources, by syntax tree."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("dh_to_urdf", "robots", "kinematics", "app")
MAKERS = ("say", "plural")


@dataclass(frozen=True)
class Found:
    """A template, and where it stands.

    Attributes:
        one: The template; of two forms that for one thing.
        many: The form for several; empty where there is one form.
        names: Of the values that are given for its placeholders.
        path: The file, from the root of the checkout.
        line: The line.
    """

    one: str
    many: str
    names: frozenset[str]
    path: str
    line: int


def sources() -> Iterator[tuple[str, ast.Module]]:
    """Each source file, from the root of the checkout, and its syntax tree."""
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def is_maker(node: ast.AST) -> bool:
    """Whether this is a call that makes a message."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in MAKERS


def templates() -> list[Found]:
    """All templates, in the order of files and lines.

    Raises:
        AssertionError: One is no literal, so that no catalogue can have it.
    """
    found = []
    for path, tree in sources():
        if path == "dh_to_urdf/messages.py":
            continue
        for node in ast.walk(tree):
            if not is_maker(node):
                continue
            assert isinstance(node, ast.Call)
            place = f"{path}:{node.lineno}"
            texts = [one.value for one in node.args[:2] if isinstance(one, ast.Constant)]
            assert texts, f"{place}: no literal"
            names = frozenset(one.arg or "**" for one in node.keywords)
            assert "**" not in names, f"{place}: name the values"
            one, many = str(texts[0]), str(texts[1]) if len(texts) > 1 else ""
            found.append(Found(one, many, names, path, node.lineno))
    return sorted(
        found, key=lambda one: (PACKAGES.index(one.path.split("/")[0]), one.path, one.line)
    )
