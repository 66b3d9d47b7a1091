"""Large batches in slices, so that what is needed in between does not grow with the batch."""

from __future__ import annotations

from collections.abc import Iterator

from kinematics.deadline import checked

NUMBERS = 500_000
"""Numbers of a slice, whatever the machine."""
SLICE_BYTES = 4 * 8 * NUMBERS
"""Bytes that are enough for what is computed of a slice, four arrays of its size."""


def slices(rows: int, numbers: int) -> Iterator[slice]:
    """Yield slices of so many rows in all, with a checkpoint before each.

    Args:
        rows: Rows of the batch.
        numbers: Numbers that a row takes in between.
    """
    step = max(1, NUMBERS // max(1, numbers))
    for start in checked(range(0, rows, step), 1):
        yield slice(start, min(start + step, rows))
