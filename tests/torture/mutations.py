"""Changes to requests that work: values, types, structure, bytes, headers, queries."""

from __future__ import annotations

import copy
import gzip
import json
import struct
from collections.abc import Callable
from dataclasses import replace
from random import Random
from typing import Any

import numpy as np

from tests.torture.exchange import Sent
from tests.torture.seeds import TABLE, npy

VOCABULARY: dict[str, list[Any]] = {
    "task": [
        "pose",
        "position",
        "orientation",
        "xy",
        "x",
        "xy_phi",
        "direction",
        "position_direction",
        "poze",
        [0] * 6,
        [1] * 6,
        [1, 0, 0, 0, 0, 0],
        [True] * 6,
        [1] * 7,
        [2, 0, 0, 0, 0, 0],
        [0.5] * 6,
    ],
    "frame": ["tool", "base_link", "frame_0", "frame_1", "panda_hand", "nope", ""],
    "frames": ["all", ["tool"], [], ["tool", "tool"], ["frame_1", "nope"], "tool", ["tool"] * 5000],
    "euler": [
        "ZXZ",
        "zyx",
        "XYZ",
        "ZZZ",
        "Z",
        "zXz",
        "Z" * 10_000,
        {"sequence": "ZXZ", "angles": []},
        {"sequence": "zyx", "angles": [1, 2, 3]},
    ],
    "reference_frame": ["world", "local", "local_world_aligned", "base"],
    "method": [
        "pseudo_inverse",
        "damped",
        "null_space",
        "task_priority",
        "sqp",
        "qp",
        "whole_path",
        "x",
    ],
    "methods": [["qp"] * 16, ["qp"] * 1000, [], ["sqp", {"method": "qp", "label": "\u202e"}], "qp"],
    "time_law": ["linear", "cubic", "quintic", "trapezoidal", "none"],
    "samples": [2, 1, 0, 3, 100_000, 10**9, -5],
    "tf": [0, 1e-12, 1e9, 1e308, -1],
    "time_budget_ms": [0, -1, 1e-9, 5, 1e308],
    "max_restarts": [0, 1, 10**6, 10**9, -1],
    "max_iterations": [0, 1, 10**6, 10**9, -1],
    "random_seed": [0, -1, 2**31, 2**53, 2**64],
    "choose": ["closest", "most_manipulable", "farthest_from_limits", "best"],
    "tolerance": [
        0,
        1e-320,
        1e-15,
        1,
        1e308,
        -1,
        {"position": 0},
        {"position": 1e-320, "orientation": 1},
    ],
    "damping": [0, 1e-320, 1e-12, 1, 1e6, 1e308, -1],
    "quantities": ["all", ["A", "A"], [], ["det_jacobian"], ["x"], ["T"] * 1000],
    "parameters": ["symbolic", "numeric", "both"],
    "symbols": [{"a2": "L1"}, {"a2": "1x"}, {"a2": "a3"}, {"": ""}, {"x" * 300: "y" * 300}],
    "robot": [
        "pa10",
        "planar_2r",
        "puma560",
        "nope",
        "",
        "../x",
        TABLE,
        {},
        [],
        3,
        {"urdf": ""},
        {"urdf": "<robot"},
        {"urdf": 3},
        "talos",
        "simple_humanoid",
    ],
    "other": ["pa10", "ur5_urdf", "nope", {"convention": "dh", "joints": []}, None],
    "convention": ["standard", "modified", "khalil", "dh", "x", None],
    "type": ["R", "P", "F", "C", "revolute", "ball", "sphere", "box", 3],
    "quaternion_xyzw": [[0, 0, 0, 0], [0, 0, 0, 2], [1e-320] * 4, [1e308] * 4, [0.6, 0, 0, 0.8]],
    "matrix": [
        np.eye(4).tolist(),
        np.zeros((4, 4)).tolist(),
        np.diag([1, 1, -1, 1]).tolist(),
        np.diag([2, 2, 2, 1]).tolist(),
        np.diag([1, 1, 1, 2]).tolist(),
        np.eye(3).tolist(),
        [[1e308] * 4] * 4,
    ],
    "radius": [0, -1, 1e-320, 1e308, 1e6],
    "normal": [[0, 0, 0], [1e-320, 0, 0], [1e308] * 3, [0, 0, 1]],
    "size": [[0, 0, 0], [-1, 1, 1], [1e-320] * 3, [1e308] * 3],
    "angle": ["deg", "rad", "grad", "", "DEG"],
    "format": [
        "json",
        "text",
        "npy",
        "ndjson",
        "csv",
        "svg",
        "yaml",
        "latex",
        "python",
        "c",
        "x",
        "",
    ],
    "page_size": ["0", "1", "1000", "1001", "-1", "1e3", "٣", "1" * 400],
    "page_token": ["", "pa10", "zzz", "\x7f", "%00"],
    "snap": ["0", "1e-3", "1", "-1", "nan", "1e-320"],
    "explain": ["1", "true", "yes"],
}
NUMBERS: list[Any] = [
    0,
    -0.0,
    1,
    -1,
    2,
    1e-320,
    5e-324,
    1e-9,
    1e6,
    1.0000001e6,
    -1e6,
    1e15,
    1e16,
    1e154,
    1e308,
    -1.7976931348623157e308,
    2**31,
    2**53 + 1,
    2**63,
    2**64,
    -(2**63) - 1,
    10**400,
    0.1,
    3.14159,
    90,
    True,
    False,
]
TEXTS = [
    "",
    " ",
    "x",
    "tool",
    "\u0000",
    "a\nb\rc",
    "\u202eabc",
    "é",
    "𝔸",
    "../../etc/passwd",
    "%00",
    "<script>alert(1)</script>",
    "a" * 65,
    "a" * 5000,
    "~/~0~1",
    "${jndi:ldap://x}",
    "1e5",
    "pi/2",
    "90deg",
    "0,5",
    "NaN",
    "null",
    "' OR 1=1",
    "\ufeff",
    "\u2028",
    "q" * 300 + "\x07",
    "٣",
    "{}",
]
RAW_LITERALS = [
    b"NaN",
    b"Infinity",
    b"-Infinity",
    b"1e999",
    b"-1e999",
    b"01",
    b"1.",
    b".5",
    b"+1",
    b"0x10",
    b'"\\ud800"',
    b'"\\udc00\\ud800"',
    b"9" * 5000,
    b"[" * 3000,
    b"'a'",
    b"undefined",
    b'"\xff"',
    b'"\xed\xa0\x80"',
    b"1_000",
    b"/**/1",
    b"1e-999999999",
    b'"\\u0000"',
]


def mutated(sent: Sent, rng: Random) -> Sent:
    """One to three changes to a request."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3))):
        change = rng.choices([one for one, _ in CHANGES], [weight for _, weight in CHANGES])[0]
        sent = replace(change(sent, rng), what=f"{sent.what} {change.__name__.lstrip('_')}".strip())
    return sent


def _json(sent: Sent, rng: Random) -> Sent:
    """The document of a JSON body, changed in one place."""
    if sent.body is None:
        return _query(sent, rng)
    try:
        tree = json.loads(sent.body or b"")
    except (ValueError, RecursionError):
        return _bytes(sent, rng)
    holder = [tree]
    places = _places(holder)
    parent, key = rng.choice(places)
    literal = b""
    action = rng.choice(ACTIONS)
    if action == "literal":
        literal, parent[key] = rng.choice(RAW_LITERALS), "\x00RAW\x00"
    elif action == "double" and isinstance(parent, dict):
        text = json.dumps(holder[0])
        pair = f"{json.dumps(key)}: "
        doubled = text.replace(pair, f"{pair}{json.dumps(_value(key, rng))}, {pair}", 1)
        return replace(sent, body=doubled.encode("utf-8", "surrogatepass"))
    else:
        _act(action, parent, key, rng)
    holder = holder or [None]
    text = json.dumps(holder[0], ensure_ascii=rng.random() < 0.5)
    body = text.encode("utf-8", "surrogatepass")
    return replace(sent, body=body.replace(b'"\\u0000RAW\\u0000"', literal) if literal else body)


ACTIONS = (
    "value",
    "value",
    "value",
    "value",
    "text",
    "number",
    "number",
    "delete",
    "unknown",
    "rename",
    "wrap",
    "unwrap",
    "null",
    "longer",
    "literal",
    "double",
    "batch",
    "swap",
)


def _act(action: str, parent: Any, key: Any, rng: Random) -> None:
    value = parent[key]
    if action == "value":
        parent[key] = _value(key, rng)
    elif action == "text":
        parent[key] = rng.choice(TEXTS)
    elif action == "number":
        parent[key] = rng.choice(NUMBERS)
    elif action == "delete" and isinstance(parent, dict):
        del parent[key]
    elif action == "delete":
        parent.pop(key)
    elif action == "unknown" and isinstance(value, dict):
        value[rng.choice([*TEXTS, *VOCABULARY])] = _value("", rng)
    elif action == "rename" and isinstance(parent, dict):
        parent[rng.choice([*TEXTS, *VOCABULARY])] = parent.pop(key)
    elif action == "wrap":
        parent[key] = [value] if rng.random() < 0.5 else {"a": value}
    elif action == "unwrap" and isinstance(value, (list, dict)) and value:
        parent[key] = value[0] if isinstance(value, list) else next(iter(value.values()))
    elif action == "longer" and isinstance(value, list):
        parent[key] = value * rng.choice((2, 3, 100, 3000 if len(value) < 10 else 2))
    elif action == "batch" and isinstance(value, list):
        parent[key] = [copy.deepcopy(value) for _ in range(rng.choice((1, 2, 30, 2000)))]
        if rng.random() < 0.5:
            parent[key][-1] = _value(key, rng)
    elif action == "swap" and isinstance(parent, list):
        rng.shuffle(parent)
    else:
        parent[key] = None


def _value(key: Any, rng: Random) -> Any:
    """A value that a field of this name may have, or one that it may not."""
    if key in VOCABULARY and rng.random() < 0.7:
        return copy.deepcopy(rng.choice(VOCABULARY[key]))
    kind = rng.randrange(6)
    if kind == 0:
        return [
            round(rng.uniform(-3, 3), 3) for _ in range(rng.choice((0, 1, 2, 3, 4, 6, 7, 8, 64)))
        ]
    if kind == 1:
        return [[rng.uniform(-3, 3)] * rng.choice((2, 3, 6, 7))] * rng.choice((1, 3, 40))
    if kind == 2:
        return rng.choice(TEXTS)
    if kind == 3:
        return rng.choice(NUMBERS)
    if kind == 4:
        return {rng.choice([*VOCABULARY, "j1", "x"]): rng.choice(NUMBERS)}
    return copy.deepcopy(rng.choice(VOCABULARY[rng.choice(list(VOCABULARY))]))


def _places(node: Any) -> list[tuple[Any, Any]]:
    found: list[tuple[Any, Any]] = []
    pairs = node.items() if isinstance(node, dict) else enumerate(node)
    for key, value in pairs:
        found.append((node, key))
        if isinstance(value, (dict, list)) and len(found) < 2000:
            found += _places(value)
    return found


def _bytes(sent: Sent, rng: Random) -> Sent:
    """The body as bytes: cut, flipped, another encoding, another format."""
    body = sent.body or b""
    at = rng.randrange(len(body) + 1)
    changes: list[Callable[[], bytes]] = [
        lambda: body[:at],
        lambda: body[at:],
        lambda: body[:at] + rng.randbytes(rng.choice((1, 3, 50))) + body[at:],
        lambda: body[:at] + bytes([rng.randrange(256)]) + body[at + 1 :],
        lambda: b"\xef\xbb\xbf" + body,
        lambda: body.decode("latin-1").encode("utf-16"),
        lambda: body + b" x",
        lambda: body + b"\x00",
        lambda: gzip.compress(body),
        lambda: b"",
        lambda: rng.choice(
            (b"null", b"[]", b"3", b'"x"', b"{}", b"true", b"[" * 100_000, b'{"q":' * 50_000)
        ),
        lambda: b" " * 100_000 + body,
        lambda: rng.choice(RAW_LITERALS),
        lambda: body.replace(b"0.1", rng.choice(RAW_LITERALS)),
        lambda: b'{"q": [' + b'"a",' * 100_000 + b"0]}",
    ]
    return replace(sent, body=rng.choice(changes)())


def _npy(sent: Sent, rng: Random) -> Sent:
    """An npy body: other types, orders, shapes, headers, lengths."""
    if sent.method != "POST" or "robots/" not in sent.path:
        return _header(sent, rng)
    dof = rng.choice((2, 6, 7, 3, 8))
    array = np.random.default_rng(rng.randrange(2**32)).uniform(
        -2, 2, (rng.choice((1, 3, 200)), dof)
    )
    if sent.path.endswith("/ik"):
        array = np.broadcast_to(np.eye(4), (rng.choice((1, 2, 20)), 4, 4)).copy()
    array = array[0] if rng.random() < 0.2 else array
    kinds = (
        ">f8",
        "<f4",
        ">f2",
        "longdouble",
        "<i8",
        ">u2",
        "c16",
        "?",
        "U4",
        "S8",
        "M8[s]",
        "f8,f8",
        "V8",
        "<f8",
        "<f8",
        "<f8",
    )
    data = npy(array)
    choice = rng.randrange(8)
    if choice == 0:
        with np.errstate(all="ignore"):
            kept = array.astype(rng.choice(kinds)) if rng.random() < 0.8 else array.T
        data = _saved(np.asfortranarray(kept) if rng.random() < 0.3 else kept)
    elif choice == 1:
        array.flat[rng.randrange(array.size)] = rng.choice((np.nan, np.inf, -np.inf, 1e308, 1e-320))
        data = npy(array)
    elif choice == 2:
        shape = rng.choice(
            (
                "(0, 7)",
                "(-1, 7)",
                "(10**9, 7)",
                "(9999999999999999999, 7)",
                "()",
                "(7,)",
                "(1, 1, 1, 7)",
                "(2.0, 7)",
                "(True, 7)",
                "7",
                "None",
                "(" * 500,
                "[2, 7]",
                "(1000000000, 1000000000, 1000000000)",
                "(0,)",
                "(4294967296, 4294967296)",
            )
        )
        descr = rng.choice(
            ("'<f8'", "'|O'", "'<f8'", "[('a', '<f8')]", "'<f8" + "8" * 50 + "'", "object")
        )
        order = rng.choice(("False", "True", "1", "None"))
        data = _with_header(
            f"{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}".encode(),
            array.tobytes(),
            rng,
        )
    elif choice == 3:
        odd = rng.choice(
            (
                b"(" * 60,
                b"{" * 50,
                b"9**9",
                b"'a'*10",
                b"-" * 30 + b"1",
                b"(" * 60 + b")" * 60,
                b"[" + b"0," * 30_000 + b"]",
                b"__import__('os')",
                b"\xff" * 100,
                b" " * 100_000,
                b"{'a':" * 30,
                b"lambda: 0",
                b"f'{1}'",
            )
        )
        data = _with_header(odd, b"", rng)
    elif choice == 4:
        data = data[: rng.randrange(len(data))]
    elif choice == 5:
        data += rng.randbytes(rng.choice((1, 8, 56)))
    elif choice == 6:
        data = (
            data[:6] + bytes([rng.choice((0, 1, 2, 3, 4, 255)), rng.choice((0, 1, 255))]) + data[8:]
        )
    return replace(sent, body=data).with_header("Content-Type", "application/x-npy")


def _saved(array: Any) -> bytes:
    import io

    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


def _with_header(header: bytes, payload: bytes, rng: Random) -> bytes:
    wide = rng.random() < 0.5 or len(header) > 65000
    declared = len(header) + 1 if rng.random() < 0.9 else rng.choice((0, 2**31, 2**32 - 1, 65535))
    size = struct.pack("<I", declared % 2**32) if wide else struct.pack("<H", declared % 2**16)
    return (
        b"\x93NUMPY"
        + bytes([rng.choice((2, 3)) if wide else 1, 0])
        + size
        + header
        + b"\n"
        + payload
    )


def _query(sent: Sent, rng: Random) -> Sent:
    """The query: other values, unknown names, twice, broken escapes, thousands."""
    pairs = [part for part in sent.query.split("&") if part]
    names = [part.partition("=")[0] for part in pairs]
    name = rng.choice([*names, *VOCABULARY, "q", "name", "values", "columns", "tip", "base"])
    values = (
        [str(one) for one in VOCABULARY.get(name, [])]
        + [str(n) for n in NUMBERS]
        + TEXTS
        + [
            "%zz",
            "%",
            "%00",
            "%ff%fe",
            "a+b",
            "1,2,3,4,5,6",
            "[1,2]",
            "0," * 3000,
            "1e400",
            "nan",
            "pi/2,0",
            "%D9%A3",
            "0.1,0.2",
            "1_0",
            "(" * 400,
            "9" * 4000,
            "--1",
            "1;2",
            "ZXZ:1,2,3",
            "a2:L1",
            ":,:",
        ]
    )
    value = rng.choice(values).replace(" ", "+").replace("#", "%23").replace("\n", "%0A")
    value = value if rng.random() < 0.5 else value.encode("utf-8", "replace").hex("%", 1)
    value = value[:60_000]
    choice = rng.randrange(7)
    if choice <= 2:
        pairs = [p for p in pairs if p.partition("=")[0] != name] + [f"{name}={value}"]
    elif choice == 3:
        pairs.append(f"{name}={value}")
    elif choice == 4:
        pairs += rng.choice(
            (
                pairs,
                ["="],
                ["&&&"],
                [name],
                [f"x{k}=1" for k in range(5000)],
                [f"{rng.choice(TEXTS)[:50]}=1"],
            )
        )
    elif choice == 5 and pairs:
        pairs.remove(rng.choice(pairs))
    else:
        pairs = [p.replace(",", rng.choice((";", "%2C", ",,", " ", "%00")), 1) for p in pairs]
    query = "".join(c if c.isprintable() and c != " " else "%20" for c in "&".join(pairs))
    return replace(sent, query=query)


def _header(sent: Sent, rng: Random) -> Sent:
    """The headers: types, forms, tags, and those that nobody sends."""
    name, values = rng.choice(HEADERS)
    value = rng.choice(values)
    if rng.random() < 0.2:
        return replace(sent, headers=(*sent.headers, (name, value)))
    return sent.with_header(name, value)


HEADERS: list[tuple[str, list[str]]] = [
    (
        "Content-Type",
        [
            "",
            "application/json; charset=utf-16",
            "APPLICATION/JSON",
            "application/json;",
            ";",
            "text/html",
            "application/x-www-form-urlencoded",
            "multipart/form-data; boundary=x",
            "application/x-npy",
            "application/yaml",
            "text/csv",
            "application/xml",
            "text/plain",
            "text/x-symoro",
            "application/json, text/plain",
            "a" * 3000,
            "application/\xff",
        ],
    ),
    (
        "Accept",
        [
            "text/plain",
            "application/x-npy",
            "application/x-ndjson",
            "image/svg+xml",
            "image/png",
            "text/csv",
            "*/*;q=0",
            "application/json;q=nan",
            "text/*;q=inf, */*;q=-1",
            ";;;q=",
            "",
            "application/json;q=0.5, text/plain;q=1e999",
            "," * 3000,
            "text/x-c",
            "text/x-python",
            "a" * 5000,
        ],
    ),
    ("Content-Encoding", ["gzip", "identity", "br", "deflate, gzip", "x" * 300]),
    ("X-Request-ID", ["abc", "a b", "x" * 300, "\xe9", "a;b"]),
    ("If-Match", ["*", '"x"', 'W/"x"', ",,,", '"' * 300, '"a", "b"']),
    ("If-None-Match", ["*", '"x"', 'W/"x", *', ","]),
    ("Expect", ["100-continue", "200-ok"]),
    ("Range", ["bytes=0-1", "x"]),
    ("Host", ["", "evil.example", "localhost:1", "a" * 300]),
    ("X-HTTP-Method-Override", ["DELETE"]),
    ("X-Forwarded-For", ["1.2.3.4", "x" * 500]),
    ("Cookie", ["a=b; " * 500]),
]


def _target(sent: Sent, rng: Random) -> Sent:
    """The method and the path."""
    if rng.random() < 0.4:
        method = rng.choice(
            ("GET", "HEAD", "POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "BREW")
        )
        # What is no method is no HTTP: the server hangs up, whatever body is still on its way.
        return replace(sent, method=method, body=None if method == "BREW" else sent.body)
    parts = sent.path.split("/")
    at = rng.randrange(1, len(parts))
    parts[at] = rng.choice(
        (
            "",
            "..",
            ".",
            "%2e%2e",
            "%2F",
            "%00",
            "nope",
            "pa10",
            "puma560",
            "talos",
            "PA10",
            "a" * 65,
            "a" * 4000,
            "%ff",
            "%zz",
            ".hidden",
            "a%0d%0ab",
            "é",
            "planar_2r",
            "torture",
            parts[at] + "/",
            parts[at] + "%20",
            "-x",
            "ur5_urdf",
            "%E2%80%AEx",
            "stanford",
            "panda",
            "simple_humanoid",
        )
    )
    path = "".join(c if 32 < ord(c) < 127 else "%C3%A9" for c in "/".join(parts))
    return replace(sent, path=path)


def _chunked(sent: Sent, rng: Random) -> Sent:
    """The same without a declared length."""
    return replace(sent, chunked=sent.body is not None)


CHANGES: list[tuple[Callable[[Sent, Random], Sent], int]] = [
    (_json, 60),
    (_bytes, 8),
    (_npy, 8),
    (_query, 14),
    (_header, 12),
    (_target, 8),
    (_chunked, 3),
]
