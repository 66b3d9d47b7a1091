"""What the encoding of an answer takes, and the needs of requests with one q or a batch."""

from __future__ import annotations

import numpy as np

from app.admission.need import Need
from app.http.negotiation import CSV, JSON, NDJSON, NPY, TEXT
from app.operations.operation import MAX_NUMBERS
from dh_to_urdf.messages import say
from robots.robot import FloatArray

FLOAT = 8
"""Bytes of a number in an array."""
JSON_NUMBER = 20
"""Bytes of a number in JSON: seventeen digits, a point, a comma, often a sign."""
CSV_NUMBER = JSON_NUMBER + 3 * FLOAT
"""Bytes of a number in CSV: its text, and the columns that are made of arrays."""
LISTED = 56
"""Bytes of a number in a Python list."""
WORDS = 700
"""Bytes of a sentence."""
ROW_OBJECTS = 400
"""Bytes of the Python objects of a row: small arrays, numbers in lists."""
ROOM = 2_000_000
"""Bytes that any computation may take besides."""
TEXT_BYTES = 12_000_000
"""Bytes of a text for a terminal, which shortens what is long."""
PICTURE_BYTES = 12_000_000
"""Bytes of a picture, as SVG and as pixels."""


def rows_of(q: FloatArray, *others: FloatArray) -> int:
    """Return the number of rows of batches, 1 where there is none."""
    return max(len(one) if np.ndim(one) == 2 else 1 for one in (q, *others))


def encoded(form: str, numbers: float, array: float = 0.0) -> float:
    """Return the bytes of an answer in a form.

    Args:
        form: Media type.
        numbers: Numbers in the whole answer.
        array: Numbers in the array that npy holds.
    """
    if form == JSON:
        return JSON_NUMBER * numbers
    if form == CSV:
        return CSV_NUMBER * numbers
    return 2 * FLOAT * array if form == NPY else 0.0


def fixed_bytes(form: str) -> int:
    """Return the bytes of an answer that do not grow with it."""
    if form in (JSON, NPY, NDJSON):
        return ROOM
    return ROOM + (TEXT_BYTES if form in (TEXT, CSV) else PICTURE_BYTES)


def rows_need(
    rows: int,
    each: float,
    form: str,
    *,
    numbers: int,
    of: str = say("rows of q"),
    argument: str = "q",
) -> Need:
    """Return the need of a batch with so many bytes for each row.

    Args:
        rows: How many; no more than an answer may hold, as others are refused anyway.
        each: Bytes of a row.
        form: Media type of the answer.
        numbers: Numbers that the answer holds for a row.
        of: What a row is, in words.
        argument: The field that holds them.
    """
    return Need(each, min(rows, MAX_NUMBERS // numbers + 1), fixed_bytes(form), of, argument)
