"""Bodies of computations, JSON and npy."""

from __future__ import annotations

import gzip
import io
import json
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from tests.corpus.case import NPY, Case, body

FK, IK = "/v1/robots/planar_2r/fk", "/v1/robots/planar_2r/ik"
ARM = "/v1/robots/puma560/"
Q6 = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
NO_JSON: dict[str, bytes] = {
    "nothing": b"",
    "blanks": b" \t\r\n",
    "cut": b'{"q": [0, 0',
    "open text": b'{"q": "',
    "NaN": b'{"q": [NaN, 0]}',
    "Infinity": b'{"q": [-Infinity, 0]}',
    "a comma more": b'{"q": [0, 0,]}',
    "a comma less": b'{"q": [0 0]}',
    "leading zero": b'{"q": [00, 0]}',
    "leading plus": b'{"q": [+1, 0]}',
    "bare point": b'{"q": [.5, 0]}',
    "hexadecimal": b'{"q": [0x10, 0]}',
    "underscore": b'{"q": [1_0, 0]}',
    "single quotes": b"{'q': [0, 0]}",
    "no quotes": b"{q: [0, 0]}",
    "comment": b'{"q": [0, 0]} // a',
    "two values": b'{"q": [0, 0]}{"q": [0, 0]}',
    "NUL after": b'{"q": [0, 0]}\0',
    "NUL in a text": b'{"q": [0, 0], "euler": "\0"}',
    "newline in a text": b'{"q": [0, 0], "euler": "a\nb"}',
    "UTF-16": '{"q": [0, 0]}'.encode("utf-16"),
    "UTF-32": '{"q": [0, 0]}'.encode("utf-32"),
    "a mark": b'\xef\xbb\xbf{"q": [0, 0]}',
    "no UTF-8": b'{"q": [0, 0], "euler": "\xc3\x28"}',
    "overlong": b'{"q": [0, 0], "euler": "\xc0\xaf"}',
    "surrogate": b'{"q": [0, 0], "euler": "\xed\xa0\x80"}',
    "half of a pair": b'{"q": [0, 0], "euler": "\\ud83d"}',
    "bad escape": b'{"q": [0, 0], "euler": "\\x41"}',
    "deep in a field": b'{"q": ' + b"[" * 1_100 + b"}",
    "XML": b"<q>0 0</q>",
    "YAML": b"q: [0, 0]",
    "a form": b"q=0,0",
    "gzip": gzip.compress(b'{"q": [0, 0]}'),
    "msgpack": b"\x81\xa1q\x92\x00\x00",
    "garbage": bytes(range(256)),
}
WRONG: dict[str, tuple[str, Any, tuple[str, ...]]] = {
    "null": (FK, None, ("object",)),
    "a list": (FK, [0, 0], ("object",)),
    "a number": (FK, 3, ("object",)),
    "a text": (FK, "q", ("object",)),
    "no q": (FK, {}, ("q",)),
    "q null": (FK, {"q": None}, ("q",)),
    "q a number": (FK, {"q": 0}, ("q",)),
    "q a text": (FK, {"q": "0,0"}, ("q",)),
    "q empty": (FK, {"q": []}, ("q",)),
    "q of one": (FK, {"q": [0]}, ("2",)),
    "q of three": (FK, {"q": [0, 0, 0]}, ("2",)),
    "q of texts": (FK, {"q": ["a", "b"]}, ("q",)),
    "q of true": (FK, {"q": [True, False]}, ("q",)),
    "q of nulls": (FK, {"q": [None, None]}, ("q",)),
    "q of lists of lists": (FK, {"q": [[[0, 0]]]}, ("q",)),
    "q ragged": (FK, {"q": [[0, 0], [0]]}, ("q",)),
    "q with an empty row": (FK, {"q": [[]]}, ("q",)),
    "q mixed": (FK, {"q": [[0, 0], 0]}, ("q",)),
    "q 1e308": (FK, {"q": [1e308, 0]}, ("q",)),
    "q of 400 digits": (FK, {"q": [10**400, 0]}, ("q",)),
    "q by wrong names": (FK, {"q": {"a": 0, "b": 0}}, ("j1",)),
    "q by one name": (FK, {"q": {"j1": 0}}, ("j2",)),
    "q by a name too many": (FK, {"q": {"j1": 0, "j2": 0, "j3": 0}}, ("j3",)),
    "q of 100,000 texts": (FK, {"q": ["x"] * 100_000}, ("q",)),
    "q of 100,000 objects": (FK, {"q": [{}] * 100_000}, ("q",)),
    "q of a million rows": (FK, {"q": [[0, 0]] * 1_000_000}, ("q", "200000")),
    "one long row": (FK, {"q": [[0] * 1_000_000]}, ("q",)),
    "unknown field": (FK, {"q": [0, 0], "qq": 1}, ("'qq'",)),
    "field with a newline": (FK, {"q": [0, 0], "a\nb\u202e": 1}, ("unknown field",)),
    "long unknown field": (FK, {"q": [0, 0], "x" * 100_000: 1}, ("unknown field",)),
    "100,000 unknown fields": (
        FK,
        {"q": [0, 0], **{f"k{k}": 0 for k in range(100_000)}},
        ("unknown field",),
    ),
    "unknown frame": (FK, {"q": [0, 0], "frames": ["nil"]}, ("'nil'", "tool")),
    "frame by number": (FK, {"q": [0, 0], "frames": [99]}, ("frames",)),
    "frame universe": (FK, {"q": [0, 0], "frames": ["universe"]}, ("universe",)),
    "frames a number": (FK, {"q": [0, 0], "frames": 3}, ("frames",)),
    "no frames": (FK, {"q": [0, 0], "frames": []}, ("frames",)),
    "empty frame": (FK, {"q": [0, 0], "frames": [""]}, ("frame",)),
    "frame a path": (FK, {"q": [0, 0], "frames": ["../../etc/passwd"]}, ("frame",)),
    "unknown euler": (FK, {"q": [0, 0], "euler": "ABC"}, ("ABC",)),
    "euler of two": (FK, {"q": [0, 0], "euler": "ZX"}, ("ZX",)),
    "euler twice the same": (FK, {"q": [0, 0], "euler": "ZZX"}, ("ZZX",)),
    "euler very long": (FK, {"q": [0, 0], "euler": "ZXZ" * 10_000}, ("euler",)),
    "reference frame": (ARM + "jacobian", {"q": Q6, "reference_frame": "moon"}, ("moon",)),
    "unknown task": (ARM + "singularity", {"q": Q6, "task": "dance"}, ("dance",)),
    "mask of zeros": (ARM + "singularity", {"q": Q6, "task": [0] * 6}, ("task",)),
    "mask of five": (ARM + "singularity", {"q": Q6, "task": [1] * 5}, ("task",)),
    "mask of twos": (ARM + "singularity", {"q": Q6, "task": [2] * 6}, ("task",)),
    "tolerance negative": (ARM + "singularity", {"q": Q6, "tolerance": -1}, ("tolerance",)),
    "no target": (ARM + "ik", {}, ("target",)),
    "target empty": (ARM + "ik", {"target": {}}, ("target",)),
    "target null": (ARM + "ik", {"target": None}, ("target",)),
    "target and targets": (ARM + "ik", {"target": {"position": [0, 0, 0]}, "targets": []}, ()),
    "quaternion zero": (
        ARM + "ik",
        {"target": {"position": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 0]}},
        ("quaternion",),
    ),
    "quaternion of length two": (
        ARM + "ik",
        {"target": {"position": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 2]}},
        ("quaternion",),
    ),
    "two orientations": (
        ARM + "ik",
        {"target": {"position": [0, 0, 0], "rpy": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]}},
        ("target",),
    ),
    "matrix that mirrors": (
        ARM + "ik",
        {"target": {"matrix": np.diag([1, 1, -1, 1]).tolist()}},
        ("matrix",),
    ),
    "matrix of 3 rows": (ARM + "ik", {"target": {"matrix": np.eye(3).tolist()}}, ("matrix",)),
    "matrix of 1e308": (ARM + "ik", {"target": {"matrix": [[1e308] * 4] * 4}}, ("matrix",)),
    "restarts without end": (
        ARM + "ik",
        {"target": {"matrix": np.eye(4).tolist()}, "max_restarts": 10**9},
        ("max_restarts",),
    ),
    "iterations without end": (
        ARM + "ik",
        {"target": {"matrix": np.eye(4).tolist()}, "max_iterations": 10**12},
        ("max_iterations",),
    ),
    "time without end": (
        ARM + "ik",
        {"target": {"matrix": np.eye(4).tolist()}, "time_budget_ms": 1e12},
        ("time_budget_ms",),
    ),
    "time negative": (
        ARM + "ik",
        {"target": {"matrix": np.eye(4).tolist()}, "time_budget_ms": -1},
        ("time_budget_ms",),
    ),
    "seed of five": (
        ARM + "ik",
        {"target": {"matrix": np.eye(4).tolist()}, "seed": [0] * 5},
        ("seed",),
    ),
    "no targets": (ARM + "ik", {"targets": []}, ("targets",)),
    "a million targets": (ARM + "ik", {"targets": [{}] * 1_000_000}, ()),
    "samples without end": (
        "/v1/robots/planar_3r/path",
        {"q": [0, 0, 0], "task": "xy", "target": {"position": [1, 1]}, "samples": 10**9},
        ("samples",),
    ),
    "a path of no time": (
        "/v1/robots/planar_3r/path",
        {"q": [0, 0, 0], "task": "xy", "target": {"position": [1, 1]}, "tf": -1},
        ("tf",),
    ),
    "obstacle of nothing": (
        "/v1/robots/planar_3r/path",
        {"q": [0, 0, 0], "task": "xy", "target": {"position": [1, 1]}, "obstacles": [{}]},
        ("obstacles",),
    ),
    "obstacle of negative size": (
        "/v1/robots/planar_3r/path",
        {
            "q": [0, 0, 0],
            "task": "xy",
            "target": {"position": [1, 1]},
            "obstacles": [{"type": "sphere", "center": [0, 0, 0], "radius": -1}],
        },
        ("radius",),
    ),
    "100,000 obstacles": (
        "/v1/robots/planar_3r/path",
        {
            "q": [0, 0, 0],
            "task": "xy",
            "target": {"position": [1, 1]},
            "obstacles": [{"type": "sphere", "center": [9, 9, 9], "radius": 1}] * 100_000,
        },
        ("200000 texts",),
    ),
    "symbols that are code": (
        "/v1/robots/planar_2r/symbolic",
        {"symbols": {"a1": "__import__('os')"}},
        ("a1",),
    ),
    "unknown quantities": ("/v1/robots/planar_2r/symbolic", {"quantities": ["x"]}, ("x",)),
    "no robot": ("/v1/fk", {"q": [0]}, ("robot",)),
    "robot null": ("/v1/fk", {"robot": None, "q": [0]}, ("robot",)),
    "robot a number": ("/v1/fk", {"robot": 7, "q": [0]}, ("robot",)),
    "robot a list": ("/v1/fk", {"robot": [], "q": [0]}, ("robot",)),
    "robot empty": ("/v1/fk", {"robot": {}, "q": [0]}, ("convention",)),
    "robot of a URDF and more": (
        "/v1/fk",
        {"robot": {"urdf": "<robot/>", "x": 1}, "q": [0]},
        ("urdf",),
    ),
    "robot of a URDF that is none": ("/v1/fk", {"robot": {"urdf": 3}, "q": [0]}, ("urdf",)),
    "robot of an empty URDF": ("/v1/fk", {"robot": {"urdf": ""}, "q": [0]}, ("XML",)),
    "axes to D-H of nothing": ("/v1/axes-to-dh", {}, ("convention",)),
    "axes of zero length": (
        "/v1/axes-to-dh?convention=standard",
        {"joints": [{"type": "R", "point": [0, 0, 0], "direction": [0, 0, 0]}]},
        ("direction",),
    ),
    "diff with itself missing": ("/v1/robots/ur5/diff", {}, ("other",)),
    "diff with a number": ("/v1/robots/ur5/diff", {"other": 3}, ("other",)),
}


def npy(array: Any, **options: Any) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, **options)
    return stream.getvalue()


def header(text: str, data: bytes = b"", version: int = 1) -> bytes:
    size = struct.pack("<H" if version == 1 else "<I", len(text) + 1)
    return b"\x93NUMPY" + bytes([version, 0]) + size + text.encode() + b"\n" + data


def described(descr: str, shape: str, fortran: str = "False") -> str:
    return f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}"


Q = np.array([[0.5, -0.25], [1.0, 2.0], [0.125, 0.75]])
NO_NPY: dict[str, bytes] = {
    "nothing": b"",
    "magic only": b"\x93NUMPY",
    "version 9": b"\x93NUMPY\x09\x00\x10\x00",
    "header of 4 GB": b"\x93NUMPY\x02\x00\xff\xff\xff\xff",
    "cut": npy(Q)[:-3],
    "a byte more": npy(Q) + b"x",
    "two files": npy(Q) * 2,
    "npz": b"PK\x03\x04" + bytes(200),
    "pickle": b"\x80\x04\x95\x0e\x00\x00\x00\x00\x00\x00\x00\x8c\x02os\x94",
    "objects": npy(np.array([[{}, []]], dtype=object)),
    "objects said": header(described("'|O'", "(1, 2)"), bytes(16)),
    "complex": npy(Q.astype(complex)),
    "long doubles": npy(Q.astype(np.longdouble)),
    "booleans": npy(Q > 0),
    "texts": npy(Q.astype("U4")),
    "bytes": npy(Q.astype("S4")),
    "dates": npy(Q.astype("M8[s]")),
    "records": npy(np.array([(0.0, 1.0)], dtype="f8,f8")),
    "a subarray": header(described("('<f8', (2,))", "(1,)"), bytes(16)),
    "no numbers": npy(np.empty((0, 2))),
    "no columns": npy(np.empty((2, 0))),
    "a scalar": npy(np.array(0.5)),
    "four dimensions": npy(np.zeros((1, 1, 1, 2))),
    "three columns": npy(np.zeros((2, 3))),
    "NaN": npy(np.array([[np.nan, 0.0]])),
    "infinity": npy(np.array([[np.inf, 0.0]])),
    "huge numbers": npy(np.array([[1e308, 0.0]])),
    "int64 at its end": npy(np.array([[2**63 - 1, 0]])),
    "negative shape": header(described("'<f8'", "(-1, 2)"), bytes(16)),
    "shape that overflows": header(described("'<f8'", "(4294967296, 4294967296)"), bytes(16)),
    "shape of terabytes": header(described("'<f8'", "(999999999, 99999)"), bytes(16)),
    "shape of floats": header(described("'<f8'", "(1.0, 2.0)"), bytes(16)),
    "shape a list": header(described("'<f8'", "[1, 2]"), bytes(16)),
    "shape true": header(described("'<f8'", "(True, 2)"), bytes(16)),
    "order a text": header(described("'<f8'", "(1, 2)", "'C'"), bytes(16)),
    "no order": header("{'descr': '<f8', 'shape': (1, 2), }", bytes(16)),
    "a key more": header(
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), 'x': 1}", bytes(16)
    ),
    "a type twice": header("{'descr': '<f8', " + described("'<i8'", "(1, 2)")[1:], bytes(16)),
    "a shape twice": header("{'shape': (2,), " + described("'<f8'", "(1, 2)")[1:], bytes(16)),
    "code": header("__import__('os').system('id')", bytes(16)),
    "brackets": header("(" * 4000),
    "a tower of powers": header(described("'<f8'", "(9**9**9, 2)"), bytes(16)),
    "unknown type": header(described("'<z8'", "(1, 2)"), bytes(16)),
    "void": header(described("'|V8'", "(1, 2)"), bytes(16)),
    "blanks of ten megabytes": header(" " * 10_000_000, version=2),
}
RIGHT: dict[str, tuple[str, bytes, str]] = {
    "npy": (FK, npy(Q), NPY),
    "npy big-endian": (FK, npy(Q.astype(">f8")), NPY),
    "npy in Fortran's order": (FK, npy(np.asfortranarray(Q)), NPY),
    "npy of float32": (FK, npy(Q.astype("f4")), NPY),
    "npy of integers": (FK, npy(np.array([[0, 1]])), NPY),
    "npy of one": (FK, npy(Q[0]), NPY),
    "npy of version 3": (FK, header(described("'<f8'", "(1, 2)"), bytes(16), 3), NPY),
    "blanks around": (FK, b' \r\n\t{ "q" : [ 0 , -0.0 ] } \n', "application/json"),
    "escapes": (FK, b'{"\\u0071": [0, 1E-3], "frames": ["\\u0074ool"]}', "application/json"),
    "tiny numbers": (FK, b'{"q": [1e-400, 5e-324]}', "application/json"),
    "the type in capitals": (FK, b'{"q": [0, 0]}', "Application/JSON;charset=utf-8"),
    "by names": (FK, b'{"q": {"j2": 1, "j1": 0}}', "application/json"),
    "a batch of one": (FK, b'{"q": [[0, 0]]}', "application/json"),
    "a batch of 10,000": (
        FK,
        json.dumps({"q": [[0.1, 0.2]] * 10_000}).encode(),
        "application/json",
    ),
    "a target out of reach": (
        IK,
        b'{"task": "xy", "target": {"position": [99, 0]}}',
        "application/json",
    ),
}


def refused() -> Iterator[Case]:
    """Bodies that no computation takes."""
    for name, text in NO_JSON.items():
        yield body(f"no JSON: {name}", FK, text, (400, 422))
    for name, (path, value, words) in WRONG.items():
        yield body(f"body: {name}", path, json.dumps(value), (422, 413), *words)
    for name, text in NO_NPY.items():
        yield body(f"no npy: {name}", FK, text, (400, 413, 422), kind=NPY)
    for name, encoding in (("gzip", "gzip"), ("br", "br"), ("several", "gzip, gzip, gzip")):
        packed = gzip.compress(b'{"q": [0, 0]}')
        yield body(
            f"compressed: {name}",
            FK,
            packed,
            415,
            "compressed",
            headers=(("Content-Encoding", encoding),),
        )
    doubled = {
        "q": (FK, b'{"q": [0, 0], "q": [1, 1]}'),
        "q by an escape": (FK, b'{"q": [0, 0], "\\u0071": [1, 1]}'),
        "a joint": (FK, b'{"q": {"j1": 0, "j1": 1, "j2": 0}}'),
        "a target": (IK, b'{"task": "xy", "target": {"position": [1, 0], "position": [0, 1]}}'),
        "the robot": ("/v1/fk", b'{"robot": "planar_2r", "robot": "ur5", "q": [0, 0]}'),
        "in a robot": ("/v1/fk", b'{"robot": {"urdf": "a", "urdf": "b"}, "q": [0, 0]}'),
    }
    for name, (path, text) in doubled.items():
        yield body(f"a key twice: {name}", path, text, 422, "stands twice")


def accepted() -> Iterator[Case]:
    """Bodies that must not be refused."""
    for name, (path, text, kind) in RIGHT.items():
        yield body(f"body, right: {name}", path, text, 200, kind=kind)
