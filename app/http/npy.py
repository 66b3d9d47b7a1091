"""npy files in and out: real numbers only, exact or refused."""

from __future__ import annotations

import io
import math
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.http.problems import INVALID_REQUEST, MALFORMED_BODY, TOO_LARGE, RequestProblem
from dh_to_urdf.messages import say
from robots.robot import FloatArray

MAX_HEADER = 4096
"""Bytes; a header of numbers takes 128."""
MAX_VALUES = 16_000_000
PART = 1_000_000
"""Bytes of a large file that are sent at once."""
_KEYS = re.compile(rb"""['"](?:descr|fortran_order|shape)['"]\s*:""")


def decode_npy(body: bytes, pointer: str = "") -> FloatArray:
    """An npy file of real numbers -> a float array in native byte order.

    Raises:
        RequestProblem: Not npy, another type than numbers, or shorter or longer than its header
            says.
    """
    stream = io.BytesIO(body)
    try:
        version = np.lib.format.read_magic(stream)
        if version not in ((1, 0), (2, 0), (3, 0)):
            raise ValueError
        # Version 3 is version 2 with other letters in names of fields, which numbers have not.
        reader = (
            np.lib.format.read_array_header_1_0
            if version == (1, 0)
            else np.lib.format.read_array_header_2_0
        )
        shape, fortran, dtype = reader(stream, max_header_size=MAX_HEADER)
        if len(_KEYS.findall(body, 0, stream.tell())) != 3:
            raise ValueError  # a key stands twice, of which the reader takes the last
    except Exception:  # numpy's header reader lets errors of its tokenizer and parser through
        raise RequestProblem(
            MALFORMED_BODY,
            say("the body is no npy file of numbers; write it with np.save"),
            pointer,
        ) from None
    if dtype.hasobject or dtype.kind not in "fiu" or dtype.itemsize > 8:
        raise RequestProblem(
            INVALID_REQUEST, say("the npy array holds no real numbers; save it as float64"), pointer
        )
    if len(shape) > 3 or not all(type(extent) is int and 0 < extent < 10**9 for extent in shape):
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "the npy array has shape {shape}; give one to three dimensions, none empty",
                shape=str(shape)[:80],
            ),
            pointer,
        )
    count = math.prod(shape)
    if count > MAX_VALUES:
        raise RequestProblem(
            TOO_LARGE,
            say(
                "the npy array holds {count} numbers; at most {max_values} are read",
                count=count,
                max_values=MAX_VALUES,
            ),
            pointer,
        )
    start = stream.tell()
    if count * dtype.itemsize != len(body) - start:
        raise RequestProblem(
            MALFORMED_BODY, say("the npy file is shorter or longer than its header says"), pointer
        )
    array = np.frombuffer(body, dtype=dtype, count=count, offset=start)
    array = array.reshape(shape, order="F" if fortran else "C")
    return np.ascontiguousarray(array, dtype=np.float64)


def npy_parts(array: NDArray[Any]) -> list[bytes | memoryview]:
    """An npy file of numbers, or of rows with named fields: its head, and the array's own memory.

    The array must not be changed until they are sent.
    """
    whole = np.ascontiguousarray(array)
    stream = io.BytesIO()
    head = np.lib.format.header_data_from_array_1_0(whole)
    np.lib.format.write_array_header_1_0(stream, head)
    content = whole.reshape(-1).view(np.uint8).data
    starts = range(0, len(content), PART)
    return [stream.getvalue(), *(content[start : start + PART] for start in starts)]
