"""Requests of all computations: forms, robots, units, types, and everything that is refused."""

from __future__ import annotations

import json
from collections.abc import Iterator
from random import Random
from typing import Any

import numpy as np

from tests.recorded.fixture import Asked
from tests.recorded.requests import mutate
from tests.recorded.requests.bases import ALSO, BODIES, KNOWN, NPY, QUERIES
from tests.recorded.requests.sent import JSON, npy
from tests.torture.exchange import Sent

FORMATS = ("json", "text", "npy", "ndjson", "csv", "svg", "png", "latex", "python", "c", "html")
ACCEPTS = (
    "text/plain",
    "application/x-npy",
    "application/x-ndjson",
    "text/csv",
    "image/svg+xml",
    "image/png",
    "text/html",
    "*/*;q=0",
    "application/*",
    "text/plain;q=0.5, */*;q=0.1",
    "application/json;q=0, text/plain;q=2",
    "",
)
TYPES: dict[str, tuple[tuple[str, str], ...]] = {
    "none": (),
    "empty": (("Content-Type", ""),),
    "a form": (("Content-Type", "application/x-www-form-urlencoded"),),
    "HTML": (("Content-Type", "text/html"),),
    "YAML": (("Content-Type", "application/yaml"),),
    "capitals and charset": (("Content-Type", "Application/JSON; charset=UTF-8"),),
    "latin-1": (("Content-Type", "application/json; charset=latin-1"),),
    "two": (JSON, JSON),
    "compressed": (JSON, ("Content-Encoding", "gzip")),
    "npy": (("Content-Type", "application/x-npy"),),
}


def asked() -> Iterator[Asked]:
    """All requests of computations, in order."""
    for name, bases in BODIES.items():
        yield from _forms(name, bases)
        yield from _queries(name)
        yield from _negotiated(name, *bases[0])
        if name in NPY:
            yield from _arrays(name)
        seen: set[tuple[Any, ...]] = set()
        for number, (robot, body) in enumerate(bases):
            for what, content in mutate.bodies(body, seen):
                label = f"{number}, {what}"
                yield _post(name, "refused body", label, robot, content)
        yield from _inline(name, *bases[0])


def _post(name: str, kind: str, what: str, robot: str, content: Any, query: str = "") -> Asked:
    body = content if isinstance(content, bytes) else json.dumps(content).encode()
    return Asked(
        name, kind, Sent("POST", f"/v1/robots/{robot}/{name}", query, (JSON,), body, what=what)
    )


def _forms(name: str, bases: list[tuple[str, dict[str, Any]]]) -> Iterator[Asked]:
    """Each base in the three forms, with units and as text."""
    also = [(robot, body) for robot, more in ALSO.items() for op, body in more if op == name]
    for number, (robot, body) in enumerate([*bases, *also]):
        for query in ("", "angle=deg", "format=text", "angle=deg&format=text"):
            yield _post(name, "form: stored", f"{number} {query}", robot, body, query)
        inline = {"robot": robot, **body}
        for query in ("", "angle=deg&format=text"):
            yield Asked(
                name,
                "form: inline",
                Sent(
                    "POST",
                    f"/v1/{name}",
                    query,
                    (JSON,),
                    json.dumps(inline).encode(),
                    what=f"{number} {query}",
                ),
            )
    robot, plain = QUERIES[name]
    for query in ("", "angle=deg", "format=text", "angle=rad&format=json"):
        told = "&".join(part for part in (mutate.encoded(plain), query) if part)
        yield Asked(
            name, "form: query", Sent("GET", f"/v1/robots/{robot}/{name}", told, what=query)
        )


def _queries(name: str) -> Iterator[Asked]:
    robot, plain = QUERIES[name]
    for what, query in mutate.queries(plain, KNOWN[name]):
        yield Asked(
            name, "refused query", Sent("GET", f"/v1/robots/{robot}/{name}", query, what=what)
        )


def _negotiated(name: str, robot: str, body: dict[str, Any]) -> Iterator[Asked]:
    """Types of bodies and answers, methods, robots that are none."""
    path, content = f"/v1/robots/{robot}/{name}", json.dumps(body).encode()
    kind = "types and methods"
    for form in FORMATS:
        yield _post(name, kind, f"format {form}", robot, content, f"format={form}")
    for accept in ACCEPTS:
        yield Asked(
            name,
            kind,
            Sent("POST", path, "", (JSON, ("Accept", accept)), content, what=f"accept {accept}"),
        )
    for what, headers in TYPES.items():
        yield Asked(name, kind, Sent("POST", path, "", headers, content, what=f"type {what}"))
        inline = json.dumps({"robot": robot, **body}).encode()
        yield Asked(
            name,
            kind,
            Sent("POST", f"/v1/{name}", "", headers, inline, what=f"inline, type {what}"),
        )
    text = ("Accept", "text/plain")
    for what, wrong in {
        "cut": b'{"q": [0',
        "a field more": json.dumps({**body, "zzz": 1}).encode(),
        "nothing": b"{}",
        "a robot": json.dumps({**body, "robot": "nothing"}).encode(),
    }.items():
        for place in (path, f"/v1/{name}"):
            told = f"{what} at {place}"
            yield Asked(
                name, "refused as text", Sent("POST", place, "", (JSON, text), wrong, what=told)
            )
            for form in ("text", "ndjson"):
                query = f"format={form}"
                yield Asked(
                    name, "refused as text", Sent("POST", place, query, (JSON,), wrong, what=told)
                )
    for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "HEAD"):
        yield Asked(name, kind, Sent(method, path, what=f"{method} stored"))
        yield Asked(name, kind, Sent(method, f"/v1/{name}", what=f"{method} inline"))
    yield Asked(name, kind, Sent("GET", f"/v1/{name}", what="GET inline"))
    yield Asked(name, kind, Sent("GET", f"{path}/", what="a slash at the end"))
    for other in ("nothing", "PUMA560", "a%20b", ".hidden", "a" * 65):
        yield _post(name, "unknown robot", other, other, content)
        yield Asked(
            name,
            "unknown robot",
            Sent(
                "GET",
                f"/v1/robots/{other}/{name}",
                mutate.encoded(QUERIES[name][1]),
                what=f"GET {other}",
            ),
        )
    for query in ("zzz=1", "q=0", "angle=grad", "angle=deg&angle=deg", "format=exe", "format="):
        yield _post(name, "refused query", f"POST {query}", robot, content, query)
        yield Asked(
            name,
            "refused query",
            Sent(
                "POST",
                f"/v1/{name}",
                query,
                (JSON,),
                json.dumps({"robot": robot, **body}).encode(),
                what=f"inline {query}",
            ),
        )


TABLE: dict[str, Any] = {
    "name": "probe",
    "convention": "standard",
    "units": {"angle": "rad", "length": "m"},
    "joints": [
        {
            "name": "j1",
            "type": "R",
            "alpha": "pi/2",
            "a": 0,
            "d": 0.3,
            "limits": {"lower": -1, "upper": 1},
        },
        {"name": "j2", "type": "R", "alpha": 0, "a": 0.4, "d": 0},
    ],
}
URDF = (
    '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute">'
    '<parent link="a"/><child link="b"/><axis xyz="0 0 1"/><origin xyz="0 0 1" rpy="0 0 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
)
ROBOTS: dict[str, Any] = {
    "null": None,
    "a number": 7,
    "a list": [],
    "an empty object": {},
    "an empty text": "",
    "unknown": "nothing",
    "a bad id": "../x",
    "a table": TABLE,
    "a table without convention": {k: v for k, v in TABLE.items() if k != "convention"},
    "a table with a bad cell": {**TABLE, "joints": [{**TABLE["joints"][0], "alpha": "x"}]},
    "a URDF": {"urdf": URDF},
    "a URDF with a tip": {"urdf": URDF, "tip": "b", "base": "a"},
    "a URDF with an unknown tip": {"urdf": URDF, "tip": "zzz"},
    "a URDF and more": {"urdf": URDF, "x": 1},
    "a URDF that is none": {"urdf": 3},
    "an empty URDF": {"urdf": ""},
    "a URDF of nothing": {"urdf": "<robot/>"},
}


def _inline(name: str, robot: str, body: dict[str, Any]) -> Iterator[Asked]:
    """Robots in bodies, and every field changed there once."""
    path = f"/v1/{name}"
    for what, given in ROBOTS.items():
        content = json.dumps({"robot": given, **body}).encode()
        yield Asked(name, "inline robot", Sent("POST", path, "", (JSON,), content, what=what))
    content = json.dumps(body).encode()
    yield Asked(name, "inline robot", Sent("POST", path, "", (JSON,), content, what="none"))
    rng = Random(name)
    for what, changed in mutate.bodies({"robot": robot, **body}):
        if what.startswith("raw") or rng.random() < 0.15:
            yield Asked(
                name, "refused inline body", Sent("POST", path, "", (JSON,), changed, what=what)
            )


def _arrays(name: str) -> Iterator[Asked]:
    """Bodies of type npy, right and wrong."""
    kind = (("Content-Type", "application/x-npy"),)
    ik = name == "ik"
    robot = "puma560" if ik else "planar_2r"
    target = np.eye(4)
    target[:3, 3] = 0.4, 0.2, 0.5
    good = np.array([target, target]) if ik else np.array([[0.5, -0.7], [0.1, 0.2]])
    extra = {
        "ik": "max_restarts=5&time_budget_ms=30000",
        "twist": "qd=1,-1",
        "jacobian-derivative": "qd=1,-1",
        "joint-velocities": "twist=0.1,0&task=xy",
        "wrench": "tau=1,2&task=xy",
        "joint-torques": "wrench=1,0,0,0,0,0",
        "singularity": "task=xy",
        "manipulability-gradient": "task=xy",
    }.get(name, "")
    contents = {
        "a batch": npy(good),
        "one": npy(good[0]),
        "floats of 4 bytes": npy(good.astype("f4")),
        "big-endian": npy(good.astype(">f8")),
        "Fortran's order": npy(np.asfortranarray(good)),
        "integers": npy(np.eye(4, dtype=int)[None] if ik else np.array([[0, 1]])),
        "NaN": npy(good * np.nan),
        "huge": npy(good * 1e300),
        "complex": npy(good.astype(complex)),
        "booleans": npy(good > 0),
        "texts": npy(good.astype("U4")),
        "no rows": npy(good[:0]),
        "a scalar": npy(0.5),
        "three columns": npy(np.zeros((2, 3))),
        "four dimensions": npy(np.zeros((1, 1, 4, 4))),
        "nothing": b"",
        "cut": npy(good)[:-3],
        "a byte more": npy(good) + b"x",
        "garbage": bytes(range(256)),
        "JSON": b'{"q": [0, 0]}',
    }
    path = f"/v1/robots/{robot}/{name}"
    for what, content in contents.items():
        yield Asked(name, "npy body", Sent("POST", path, extra, kind, content, what=what))
    for more in (
        "angle=deg",
        "format=npy",
        "format=text",
        "zzz=1",
        "q=0,0",
        "format=exe",
        "task=xy",
        "frame=zzz",
        "targets=1",
        "tolerance=x",
    ):
        query = f"{extra}&{more}" if extra else more
        yield Asked(
            name,
            "npy body",
            Sent("POST", path, query, kind, contents["a batch"], what=f"query {more}"),
        )
    yield Asked(
        name,
        "npy body",
        Sent("POST", path, "", kind, contents["a batch"], what="without the others"),
    )
