"""Bodies of type npy: read exactly, or refused at once."""

import io
import json
import struct

import numpy as np
import pytest

from tests.app.http.requests import NPY, check, post
from tests.cost import within
from tests.processes import processor_seconds


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


def with_header(header, payload=b"", version=1):
    size = struct.pack("<H" if version == 1 else "<I", len(header) + 1)
    return b"\x93NUMPY" + bytes([version, 0]) + size + header + b"\n" + payload


Q = np.array([[0.5, -0.25], [1.0, 2.0], [0.125, 0.75]])


@pytest.mark.parametrize(
    "array",
    [
        Q.astype(">f8"),
        Q.astype("<f4"),
        Q.astype(">f4"),
        Q.astype("<f2"),
        np.asfortranarray(Q),
        Q.astype(">f8").copy(order="F"),
        Q[0],
        Q.astype(">f2"),
    ],
)
def test_npy_of_any_real_type_and_order_is_read_exactly(client, array):
    answer = post(client, npy(array), headers=NPY)
    assert answer.status_code == 200, answer.text
    expected = post(client, json.dumps({"q": array.astype(float).tolist()}))
    assert answer.json() == expected.json()


def test_npy_of_integers_and_of_other_versions_is_read_exactly(client):
    expected = post(client, b'{"q": [[1, -2], [3, 4]]}').json()
    whole = np.array([[1, -2], [3, 4]])
    for kind in ("<i8", ">i4", "<i2", "i1"):
        assert post(client, npy(whole.astype(kind)), headers=NPY).json() == expected
    data = whole.astype("<f8").tobytes()
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }"
    for version in (1, 2, 3):
        answer = post(client, with_header(header, data, version), headers=NPY)
        assert answer.json() == expected, version


HEADER = "{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}"


@pytest.mark.parametrize(
    ("body", "status"),
    [
        (npy(Q.astype(complex)), 422),
        (npy(Q.astype(np.longdouble)), 422),
        (npy(Q > 0), 422),
        (npy(Q.astype("U8")), 422),
        (npy(Q.astype("M8[s]")), 422),
        (npy(np.array([(0.0, 1.0)], dtype="f8,f8")), 422),
        (npy(np.array([[{}, []]], dtype=object)), 422),
        (npy(np.empty((0, 2))), 422),
        (npy(np.zeros((1, 1, 1, 2))), 422),
        (npy(np.zeros((2, 2, 2))), 422),
        (npy(np.array(0.5)), 422),
        (npy(np.array([[np.nan, 0.0]])), 422),
        (npy(np.array([[np.inf, 0.0]])), 422),
        (npy(Q)[:-1], 400),
        (npy(Q) + b"\0", 400),
        (npy(Q)[:20], 400),
        (b"", 400),
        (b"PK\x03\x04", 400),
        (with_header(HEADER.format("'<f8'", False, "(-1, 2)").encode()), 422),
        (with_header(HEADER.format("'<f8'", False, "(4294967296, 4294967296)").encode()), 422),
        (with_header(HEADER.format("'<f8'", False, "(999999999, 999999999)").encode()), 413),
        (with_header(HEADER.format("'<f8'", False, "(True, 2)").encode(), bytes(16)), 422),
        (with_header(HEADER.format("'<f8'", "1", "(1, 2)").encode(), bytes(16)), 400),
        (with_header(HEADER.format("'|O'", False, "(1, 2)").encode(), bytes(16)), 422),
        (with_header(HEADER.format("'<u1'", False, "(32000000, 2)").encode()), 413),
        (with_header(b"(" * 4000), 400),
        (with_header(b"-" * 4000 + b"1"), 400),
        (with_header(b"9**9**9**9"), 400),
        (with_header(b"__import__('os').abort()"), 400),
        (with_header(b" " * 10_000_000, version=2), 400),
        (with_header(b"{" * 60_000, version=2), 400),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff", 400),
        (b"\x93NUMPY\x09\x00v\x00", 400),
    ],
)
def test_other_npy_is_refused_at_once(client, shared_service, body, status):
    before = processor_seconds(shared_service[1])
    answer = post(client, body, headers=NPY)
    assert within(processor_seconds(shared_service[1]) - before, 2)
    pointer = answer.json()["errors"][0]["pointer"]
    check(answer, status, pointer)
