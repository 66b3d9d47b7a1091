"""The one exception of this package: a D-H document that cannot be used, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

MAX_PROBLEMS = 10


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing wrong with a document.

    Attributes:
        pointer: JSON pointer (RFC 6901) to the offending value, e.g. ``/joints/2/alpha``.
        message: What is wrong and what to write instead.
    """

    pointer: str
    message: str


class DHError(ValueError):
    """A D-H document that is refused.

    Attributes:
        problems: What is wrong, at most ten entries, in the order of the document.
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems[:MAX_PROBLEMS])
        more = len(problems) - 1
        suffix = f" (and {more} more)" if more > 0 else ""
        super().__init__(f"{problems[0].message}{suffix}")

    @classmethod
    def single(cls, pointer: str, message: str) -> Self:
        """An error with one problem."""
        return cls([Problem(pointer, message)])


class DHSyntaxError(DHError):
    """A text that is no JSON, YAML or CSV at all."""


def escaped(token: object) -> str:
    """A key as one token of a JSON pointer (RFC 6901), at most 64 characters that can be seen."""
    shown = "".join(c if c.isprintable() else "?" for c in str(token)[:64])
    return shown.replace("~", "~0").replace("/", "~1")


def quoted(value: object, limit: int = 40) -> str:
    """``repr`` of an input value, cut to ``limit`` characters, safe to show in a message."""
    if isinstance(value, int) and abs(value) > 10**limit:
        return "a number of over 40 digits"
    text = repr(value) if isinstance(value, (str, int, float, bool)) or value is None else ""
    if not text:
        return f"a {type(value).__name__}"
    return text if len(text) <= limit else text[: limit - 1] + "…"
