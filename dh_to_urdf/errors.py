"""The exception of this package: a refused D-H document, and its faults."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self, TypeAlias

from dh_to_urdf.messages import say

MAX_FAULTS = 10
MAX_KEY = 64
"""Characters of a key that a location shows."""

Location: TypeAlias = tuple[str | int, ...]
"""Keys and indices from the root of a document to a value in it; empty for the document."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing wrong with a document.

    Attributes:
        location: Where the value at fault stands, such as ``("joints", 2, "alpha")``.
        message: What is wrong and what to write instead.
    """

    location: Location
    message: str

    def __str__(self) -> str:
        place = location_text(self.location)
        return (
            say("{place}: {message}", place=place, message=self.message) if place else self.message
        )


class DHError(ValueError):
    """A D-H document that is refused.

    Attributes:
        faults: What is wrong, at most ten entries, in the order of the document.
    """

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults = tuple(faults[:MAX_FAULTS])
        more = len(faults) - 1
        suffix = say(" (and {more} more)", more=more) if more > 0 else ""
        super().__init__(say("{message}{suffix}", message=faults[0].message, suffix=suffix))

    @classmethod
    def single(cls, location: Location, message: str) -> Self:
        """Return an error with one fault."""
        return cls([Fault(location, message)])


class DHSyntaxError(DHError):
    """A text that is no JSON, YAML or CSV at all."""


def location_text(location: Location) -> str:
    """Write a location for people: ``joints[2].alpha``, empty for the whole document."""
    text = ""
    for part in location:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{printable(part)}" if text else printable(part)
    return text


def printable(key: str) -> str:
    """Return the first 64 characters of a key, with ``?`` for what cannot be seen."""
    return "".join(c if c.isprintable() else "?" for c in key[:MAX_KEY])


def escaped(token: object) -> str:
    """Return a key as one token of RFC 6901, at most 64 characters that can be seen."""
    return printable(str(token)).replace("~", "~0").replace("/", "~1")


_KINDS = {"list": say("a list"), "dict": say("a dict")}


def quoted(value: object, limit: int = 40) -> str:
    """Return ``repr`` of an input value, cut to ``limit`` characters, safe in a message."""
    if isinstance(value, int) and abs(value) > 10**limit:
        return say("a number of over 40 digits")
    text = repr(value) if isinstance(value, (str, int, float, bool)) or value is None else ""
    if not text:
        kind = type(value).__name__
        return _KINDS.get(kind) or say("a {kind}", kind=kind)
    return text if len(text) <= limit else text[: limit - 1] + "…"
