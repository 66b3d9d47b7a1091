"""What a length is called: by default, by its table, by a request."""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

_NAME = re.compile(r"[A-Za-z]{1,12}(?:_?\d{1,3})?")
_TAKEN = re.compile(r"[CSqtx]_?\d+")
_WORDS = frozenset(keyword.kwlist).union(
    ("auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else"),
    ("enum", "extern", "float", "for", "goto", "if", "inline", "int", "long", "register"),
    ("restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch", "typedef"),
    ("union", "unsigned", "void", "volatile", "while", "cos", "sin", "sqrt", "pi", "q", "out"),
)


@dataclass(frozen=True, slots=True)
class Length:
    """A length that can have a name.

    Attributes:
        name: Name by default.
        row: Number of its row from 1; 0 for the base, -1 for the tool.
        column: ``a``, ``d``, ``b``, ``offset``, or ``x``, ``y``, ``z`` of base and tool.
        value: m.
        given: Name in the table; empty where it has none that can be used.
        sign: -1 where the length is minus what that name stands for.
    """

    name: str
    row: int
    column: str
    value: float
    given: str = ""
    sign: int = 1

    @property
    def names(self) -> tuple[str, ...]:
        """Names by which a request may call it."""
        return (self.name, self.given) if self.given else (self.name,)


def distinct(lengths: list[Length]) -> list[Length]:
    """Return the lengths without given names that would stand for two values."""
    while True:
        named: dict[str, set[float]] = {}
        for length in lengths:
            value = length.sign * length.value if length.given else length.value
            named.setdefault(length.given or length.name, set()).add(value)
        kept = [
            replace(length, given="", sign=1)
            if length.given and len(named[length.given]) > 1
            else length
            for length in lengths
        ]
        if kept == lengths:
            return kept
        lengths = kept


def is_usable(name: str) -> bool:
    """Return whether a length can have a name: letters, and a number."""
    return bool(_NAME.fullmatch(name)) and name not in _WORDS and not _TAKEN.fullmatch(name)


def written_name(
    length: Length, chosen: Mapping[str, str], *, symbolic: bool
) -> tuple[str | None, int]:
    """Return the name by which a length is written, None for its number; and its sign.

    Args:
        length: The length.
        chosen: Names that a request chose, by the default one or that of the table.
        symbolic: Whether all lengths have names.
    """
    if length.name in chosen:
        return chosen[length.name], 1
    if length.given:
        name = chosen.get(length.given, length.given if symbolic else None)
        return name, length.sign
    return (length.name if symbolic else None), 1
