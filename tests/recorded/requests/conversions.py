"""Tables of robots, conversions that store nothing, and comparisons of robots."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tests.corpus import urdfs
from tests.recorded.fixture import FOLDER, MINE, Asked
from tests.recorded.requests import mutate, sent
from tests.recorded.requests.documents import BARE, CSV, DOCUMENTS, PAR, PASTED, TREE, URDF, YAML

TABLE_FORMS = ("json", "text", "yaml", "csv", "par", "latex", "markdown", "tsv", "matlab")
SR400 = (FOLDER.parent / "fixtures" / "par" / "sr400.par").read_text()


def asked() -> Iterator[Asked]:
    """All requests, in order."""
    yield from _tables()
    yield from _conversions()
    yield from _diff()


def _tables() -> Iterator[Asked]:
    """D-H tables of robots."""

    def ask(target: str) -> Asked:
        return sent.ask("dh", "table", "GET", target)

    for robot in ("puma560", "pa10", "scara", "planar_3r", f"{MINE}tree", f"{MINE}mixed"):
        for convention in ("standard", "modified", "khalil"):
            yield ask(f"/v1/robots/{robot}/dh?convention={convention}")
            yield ask(f"/v1/robots/{robot}/dh?convention={convention}&angle=deg&format=text")
        for form in TABLE_FORMS:
            yield ask(f"/v1/robots/{robot}/dh?format={form}")
            yield ask(f"/v1/robots/{robot}/dh?format={form}&angle=deg")
    for robot in ("panda_urdf", "ur5_urdf", "baxter", "double_pendulum_continuous", f"{MINE}urdf"):
        for query in (
            "",
            "convention=standard",
            "convention=modified&explain=1",
            "convention=khalil&format=text&angle=deg&explain=true",
            "convention=x",
            "convention=modified&tip=zzz",
            "convention=modified&base=zzz",
            "convention=modified&positive_a=1",
            "convention=dh&snap=1e-6",
        ):
            yield ask(f"/v1/robots/{robot}/dh?{query}")
    yield ask("/v1/robots/panda_urdf/dh?tip=panda_link8&convention=modified&angle=deg&format=text")
    for query in (
        "snap=1",
        "snap=x",
        "snap=-1",
        "snap=",
        "snap=nan",
        "explain=x",
        "explain=",
        "positive_a=2",
        "convention=",
        "convention=DH",
        "convention=x",
        "angle=grad",
        "format=exe",
        "format=svg",
        "format=",
        "zzz=1",
        "tip=zzz",
        "base=zzz",
        "tip=",
        "tip=frame_3",
        "base=frame_1&tip=frame_4",
        "convention=dh&convention=mdh",
        "explain=1",
        "explain=0",
        "snap=1e-9",
        "positive_a=true",
    ):
        yield ask(f"/v1/robots/puma560/dh?{query}")
        yield ask(f"/v1/robots/{MINE}tree/dh?{query}")


def _conversions() -> Iterator[Asked]:
    def ask(target: str, body: Any, type_: str = "application/json", what: str = "") -> Asked:
        return sent.ask(
            target.partition("?")[0][4:],
            "conversion",
            "POST",
            target,
            body,
            type_,
            what=what or target,
        )

    xml = "application/xml"
    for query in (
        "",
        "convention=standard",
        "convention=modified&explain=1",
        "convention=khalil&format=text&angle=deg",
        "convention=x",
        "convention=dh&tip=zzz",
        "convention=dh&base=zzz",
        "convention=dh&snap=1",
        "convention=dh&snap=x",
        "convention=dh&explain=x",
        "convention=dh&zzz=1",
        "convention=dh&angle=grad",
        "convention=dh&positive_a=1&format=csv",
        "convention=dh&format=yaml",
        "convention=dh&format=exe",
        "convention=dh&name=x",
    ):
        yield ask(f"/v1/urdf-to-dh?{query}", URDF, xml)
        yield ask(f"/v1/urdf-to-dh?{query}", urdfs.ARM, xml, f"arm {query}")
    for what, text in {
        "nothing": "",
        "no XML": "x",
        "JSON": "{}",
        "no robot": "<a/>",
        "cut": URDF[:80],
    }.items():
        yield ask("/v1/urdf-to-dh?convention=dh", text, xml, what)
    yield ask("/v1/urdf-to-dh?convention=dh", URDF, "application/json", "as JSON")
    yield ask("/v1/urdf-to-dh?convention=dh", URDF, "text/plain", "as text")
    axes = {
        "name": "two_r",
        "convention": "standard",
        "joints": [
            {"name": "j1", "type": "revolute", "point": [0, 0, 0.1], "direction": [0, 0, 1]},
            {
                "name": "j2",
                "type": "P",
                "point": [0.4, 0, 0.3],
                "direction": [0, 1, 0],
                "limits": {"lower": -2, "upper": 2},
            },
        ],
        "tip": {"xyz": [0.9, 0, 0.3], "rpy": [0, "pi/2", 0]},
    }
    plain = {name: value for name, value in axes.items() if name != "convention"}
    for query in (
        "",
        "convention=dh",
        "format=text&angle=deg",
        "explain=1",
        "snap=x",
        "zzz=1",
        "format=exe",
        "positive_a=1",
        "angle=grad",
        "name=x",
        "tip=x",
    ):
        yield ask(f"/v1/axes-to-dh?{query}", axes)
        yield ask(f"/v1/axes-to-dh?{query}", plain, what=f"plain {query}")
    for convention in ("standard", "modified", "khalil", "x", "", "DH"):
        yield ask(f"/v1/axes-to-dh?convention={convention}", plain)
    for what, body in mutate.bodies(axes):
        yield ask("/v1/axes-to-dh", body, what=what)
    yield ask("/v1/axes-to-dh", axes, "application/yaml", "as YAML")
    for query in (
        "",
        "to=standard",
        "to=modified",
        "to=khalil",
        "to=x",
        "to=",
        "to=dh&angle=deg",
        "to=dh&format=text",
        "to=dh&format=csv",
        "to=dh&format=exe",
        "to=dh&tip=zzz",
        "to=dh&tip=b",
        "to=dh&zzz=1",
        "to=dh&name=y",
        "to=dh&angle=grad",
        "to=dh&explain=1",
        "to=dh&format=latex",
        "to=dh&convention=dh",
    ):
        for what, body, type_ in (
            ("table", BARE, "application/json"),
            ("tree", TREE, "application/json"),
            ("CSV", CSV, "text/csv"),
            ("YAML", YAML, "application/yaml"),
            ("URDF", URDF, xml),
            ("par", PAR, "text/x-symoro"),
            ("pasted", PASTED, "text/plain"),
        ):
            yield ask(f"/v1/convert-dh?{query}", body, type_, f"{what} {query}")
    for what, (type_, query, document) in DOCUMENTS.items():
        yield ask(f"/v1/dh-to-urdf?{query}", document, type_, what)
        yield ask(f"/v1/convert-dh?to=standard&{query}", document, type_, what)
    for query in ("", "loops=cut", "loops=cut&values=RL4:0.5,d2:1,d3:1,d4:1,d8:1", "loops=x"):
        yield ask(f"/v1/dh-to-urdf?{query}", SR400, "text/x-symoro", f"loops {query}")


def _diff() -> Iterator[Asked]:
    def ask(target: str, body: Any, what: str = "") -> Asked:
        return sent.ask("diff", "comparison", "POST", target, body, what=what or target)

    body = {
        "other": "ur5_urdf",
        "tolerance": {"length": 1e-6, "angle": 1e-6},
        "base": "frame_0",
        "tip": "frame_6",
        "other_base": "base_link",
        "other_tip": "tool0",
    }
    for robot, other in (
        ("ur5", "ur5e"),
        ("puma560", "puma560"),
        ("panda", "panda_urdf"),
        ("planar_2r", "planar_3r"),
        ("scara", BARE),
        ("ur5", {"urdf": URDF}),
        ("ur5", {"urdf": URDF, "tip": "zzz"}),
        ("ur5", {}),
        ("ur5", 3),
        ("ur5", None),
        ("ur5", "nothing"),
        ("ur5", []),
        ("ur5", {"convention": "dh"}),
    ):
        for query in ("", "angle=deg", "format=text&angle=deg"):
            yield ask(f"/v1/robots/{robot}/diff?{query}", {"other": other}, f"{robot} {query}")
            inline = {"robot": robot, "other": other}
            yield ask(f"/v1/diff?{query}", inline, f"inline {robot} {query}")
    for what, changed in mutate.bodies(body):
        yield ask("/v1/robots/ur5/diff", changed, what)
    for what, changed in mutate.bodies(
        {"robot": {"urdf": URDF, "tip": "tip"}, "other": "planar_2r"}
    ):
        yield ask("/v1/diff", changed, f"inline, {what}")
    for query in ("zzz=1", "angle=grad", "format=csv", "angle=deg&angle=deg"):
        yield ask(f"/v1/robots/ur5/diff?{query}", {"other": "ur5e"})
    yield sent.ask("diff", "comparison", "POST", "/v1/robots/nothing/diff", {"other": "ur5"})
    yield sent.ask("diff", "comparison", "POST", "/v1/robots/ur5/diff", YAML, "application/yaml")
    yield sent.ask("diff", "comparison", "GET", "/v1/robots/ur5/diff")
