"""What a request will need, said before it is computed."""

from __future__ import annotations

from dataclasses import dataclass
from math import isqrt

from dh_to_urdf.messages import say

SMALL = 4_000_000
"""Bytes of a need, a body or an answer that fit beside everything else."""
READING = 4.0
"""Bytes for one of a body while it is read: fields are cut out of it, and become arrays."""
READING_DOCUMENT = 50.0
"""Bytes for one of a document of a robot while it is read: trees of its elements, lists of cells.
Measured with what is cut into the smallest pieces: 45."""


@dataclass(frozen=True, slots=True)
class Need:
    """The memory that a request will need, by its largest size.

    Attributes:
        each: Bytes for one of what is counted.
        count: How many there are.
        fixed: Bytes besides.
        of: What is counted, in words.
        argument: The field that says how many.
        squared: Whether there are ``count`` times ``count``.
    """

    each: float
    count: int = 1
    fixed: int = 0
    of: str = say("rows of q")
    argument: str = "q"
    squared: bool = False

    @property
    def bytes(self) -> int:
        """All of it."""
        return self.fixed + int(self.each * self.count * (self.count if self.squared else 1))

    def fitting(self, most: int) -> int:
        """Return how many would fit in so many bytes."""
        found = max(0, int((most - self.fixed) / self.each)) if self.each > 0 else 0
        return isqrt(found) if self.squared else found


NOTHING = Need(0.0)
"""What is too small to be counted."""


def body_need(size: int) -> Need:
    """Return what reading a body needs besides its bytes: copies of its fields, and the values."""
    return Need(READING, size, of=say("bytes in a body"), argument="")


def document_need(size: int, beside: int = 0) -> Need:
    """Return what reading a document of a robot needs besides its bytes.

    Args:
        size: Its bytes.
        beside: Bytes that it takes whatever its size, such as those of a process that reads it.
    """
    of = say("bytes in a document")
    return Need(READING_DOCUMENT, size, fixed=beside, of=of, argument="")
