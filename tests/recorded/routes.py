"""Requests of all routes that are no computations."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from tests.corpus import addresses, bodies, tables, urdfs
from tests.corpus.case import MINE as CORPUS
from tests.corpus.case import Case
from tests.recorded import mutate
from tests.recorded.documents import CSV, DOCUMENTS, PAR, PASTED, TREE, URDF, YAML
from tests.recorded.fixture import FOLDER, MINE, SETUP, Asked
from tests.torture.exchange import Sent
from tests.torture.seeds import TABLE

LONGEST_BODY = 6_000
"""Bytes of a case of the corpus that is recorded."""
TABLE_FORMS = ("json", "text", "yaml", "csv", "par", "latex", "markdown", "tsv", "matlab")
BARE = {name: value for name, value in TABLE.items() if name != "name"}
SR400 = (FOLDER.parent / "fixtures" / "par" / "sr400.par").read_text()


def asked() -> Iterator[Asked]:
    """All requests, in order."""
    yield from _setup()
    yield from _robots()
    yield from _uploads()
    yield from _tables()
    yield from _conversions()
    yield from _diff()
    yield from _others()
    yield from _corpus()


def _ask(
    operation: str, kind: str, method: str, target: str, body: Any = None, type_: str = "",
    *headers: tuple[str, str], what: str = "",
) -> Asked:  # fmt: skip
    path, _, query = target.partition("?")
    if body is not None and not isinstance(body, bytes):
        body = (body if isinstance(body, str) else json.dumps(body)).encode()
    if body is not None and not type_:
        type_ = "application/json"
    given = (("Content-Type", type_), *headers) if type_ else headers
    what = what or f"{method} {target[:80]}"
    return Asked(operation, kind, Sent(method, path, query, given, body, what=what))


def _setup() -> Iterator[Asked]:
    yield _ask(SETUP, "upload", "PUT", f"/v1/robots/{MINE}tree", TREE)
    yield _ask(SETUP, "upload", "PUT", f"/v1/robots/{MINE}mixed", BARE)
    yield _ask(SETUP, "upload", "PUT", f"/v1/robots/{MINE}urdf", URDF, "application/xml")


def _robots() -> Iterator[Asked]:
    def ask(method: str, target: str, body: Any = None, *headers: tuple[str, str]) -> Asked:
        return _ask("robots", "store", method, target, body, "", *headers)

    for query in ("", "page_size=3", "page_size=2&page_token=planar_8r", "page_token=zzzz",
                  "page_size=0", "page_size=1001", "page_size=x", "page_size=", "page_size=1.5",
                  "page_token=%7F&page_size=1", "zzz=1", "page_size=1&page_size=2", "angle=deg",
                  "format=text&page_size=5", "format=csv", "format=json&page_size=1"):  # fmt: skip
        yield ask("GET", f"/v1/robots?{query}" if query else "/v1/robots")
    for robot in ("puma560", "planar_2r", "scara", "panda_urdf", "baxter", "stanford",
                  "double_pendulum_continuous", f"{MINE}tree", f"{MINE}mixed", f"{MINE}urdf",
                  "nothing", "PUMA560", "a%20b", "%2e%2e", ".hidden", "a" * 65):  # fmt: skip
        for rest in ("", "?angle=deg", "?format=text", "/urdf", "/dh", "/meshes"):
            yield ask("GET", f"/v1/robots/{robot}{rest}")
    for query in ("zzz=1", "angle=grad", "format=csv", "angle=deg&angle=deg", "format="):
        yield ask("GET", f"/v1/robots/puma560?{query}")
        yield ask("GET", f"/v1/robots/puma560/urdf?{query}")
    here = f"/v1/robots/{MINE}arm"
    tag = ("If-Match", f"{{etag:{here}}}")
    other = ("If-Match", '"0123"')
    small = {"convention": "dh", "joints": [{"type": "R", "alpha": 0, "a": 1, "d": 0}]}
    longer = {"convention": "dh", "joints": [{"type": "R", "alpha": 0, "a": 2, "d": 0}]}
    yield ask("GET", here)
    yield ask("DELETE", here)
    yield ask("PUT", here, small, other)
    yield ask("PUT", here, small, ("If-Match", "*"))
    yield ask("PUT", here, small, ("If-None-Match", "*"))
    yield ask("PUT", here, small, ("If-None-Match", "*"))
    yield ask("PUT", here, small)
    yield ask("GET", here)
    yield ask("GET", here, None, ("If-None-Match", f"{{etag:{here}}}"))
    yield ask("GET", here, None, ("If-None-Match", f"W/{{etag:{here}}}"))
    yield ask("GET", here, None, ("If-None-Match", '"0123"'))
    yield ask("GET", here, None, ("If-None-Match", "*"))
    yield ask("GET", f"{here}/urdf", None, ("If-None-Match", f"{{etag:{here}}}"))
    yield ask("GET", f"{here}/dh", None, ("If-None-Match", f"{{etag:{here}}}"))
    yield ask("PUT", here, longer, other)
    yield ask("PUT", here, longer, ("If-None-Match", f"{{etag:{here}}}"))
    yield ask("PUT", here, longer, tag)
    yield ask("PUT", here, small, ("If-Match", f'"0123", {{etag:{here}}}'))
    yield ask("PUT", f"{here}?name=other", small)
    yield ask("PUT", f"{here}?name={MINE}arm", small)
    yield ask("PUT", here, {**small, "name": "other"})
    yield ask("PUT", here, {**small, "name": f"{MINE}arm"})
    yield ask("PUT", f"{here}?format=text", small)
    yield ask("PUT", f"{here}?angle=deg", small)
    yield ask("POST", f"{here}/fk", {"q": [0.5]})
    yield ask("DELETE", here, None, other)
    yield ask("DELETE", here, None, ("If-None-Match", f"{{etag:{here}}}"))
    yield ask("DELETE", f"{here}?zzz=1")
    yield ask("DELETE", here, None, tag)
    yield ask("DELETE", here)
    yield ask("DELETE", here, None, ("If-Match", "*"))
    yield ask("POST", f"/v1/robots?name={MINE}posted", small)
    yield ask("POST", f"/v1/robots?name={MINE}posted", small)
    yield ask("POST", "/v1/robots", {**small, "name": f"{MINE}posted"})
    yield ask("POST", f"/v1/robots?name={MINE}b!c", small)
    yield ask("POST", "/v1/robots?name=!!", small)
    yield ask("POST", "/v1/robots", small)
    yield ask("POST", "/v1/robots", {**small, "name": "puma560"})
    yield ask("POST", f"/v1/robots?name={MINE}text&format=text", small)
    for name in ("posted", "b-c", "text"):
        yield ask("DELETE", f"/v1/robots/{MINE}{name}")
    for robot in ("puma560", "panda_urdf"):
        yield ask("PUT", f"/v1/robots/{robot}", small)
        yield ask("DELETE", f"/v1/robots/{robot}")
    for method in ("PATCH", "TRACE", "OPTIONS", "HEAD", "POST"):
        for target in ("/v1/robots", "/v1/robots/puma560", "/v1/robots/puma560/urdf",
                       "/v1/robots/puma560/dh", "/v1/robots/puma560/meshes"):  # fmt: skip
            if (method, target) != ("POST", "/v1/robots"):
                yield ask(method, target)


def _uploads() -> Iterator[Asked]:
    """Each type of document, in all forms of the query; and each field of a table changed."""
    here = f"/v1/robots/{MINE}up"
    for what, (type_, query, document) in DOCUMENTS.items():
        given = f"{here}?{query}" if query else here
        yield _ask("uploads", "type", "PUT", given, document, type_, what=what)
        for rest in ("", "/urdf", "/dh", "/dh?format=text&angle=deg"):
            yield _ask("uploads", "type", "GET", here + rest, what=f"{what}{rest}")
        yield _ask("uploads", "type", "DELETE", here, what=what)
        for more in ("zzz=1", "angle=deg", "angle=grad", "length=mm", "length=inch",
                     "convention=x", "convention=khalil", "values=L9:1", "values=x", "columns=x",
                     "columns=theta,d,a,alpha", "loops=cut", "loops=x", "tip=zzz", "base=zzz",
                     "format=csv", "name="):  # fmt: skip
            added = f"{given}{'&' if query else '?'}{more}"
            yield _ask("uploads", "query", "PUT", added, document, type_, what=f"{what}: {more}")
            yield _ask("uploads", "query", "DELETE", here, what=f"{what}: {more}")
    for what, body in mutate.bodies(BARE):
        yield _ask("uploads", "refused table", "POST", "/v1/dh-to-urdf", body, what=what)
    for what, body in mutate.bodies(TREE):
        if not what.startswith("raw"):
            yield _ask("uploads", "refused table", "POST", "/v1/dh-to-urdf", body,
                       what=f"tree, {what}")  # fmt: skip


def _tables() -> Iterator[Asked]:
    """D-H tables of robots."""
    def ask(target: str) -> Asked:
        return _ask("dh", "table", "GET", target)

    for robot in ("puma560", "pa10", "scara", "planar_3r", f"{MINE}tree", f"{MINE}mixed"):
        for convention in ("standard", "modified", "khalil"):
            yield ask(f"/v1/robots/{robot}/dh?convention={convention}")
            yield ask(f"/v1/robots/{robot}/dh?convention={convention}&angle=deg&format=text")
        for form in TABLE_FORMS:
            yield ask(f"/v1/robots/{robot}/dh?format={form}")
            yield ask(f"/v1/robots/{robot}/dh?format={form}&angle=deg")
    for robot in ("panda_urdf", "ur5_urdf", "baxter", "double_pendulum_continuous",
                  f"{MINE}urdf"):  # fmt: skip
        for query in ("", "convention=standard", "convention=modified&explain=1",
                      "convention=khalil&format=text&angle=deg&explain=true", "convention=x",
                      "convention=modified&tip=zzz", "convention=modified&base=zzz",
                      "convention=modified&positive_a=1", "convention=dh&snap=1e-6"):  # fmt: skip
            yield ask(f"/v1/robots/{robot}/dh?{query}")
    yield ask("/v1/robots/panda_urdf/dh?tip=panda_link8&convention=modified&angle=deg&format=text")
    for query in ("snap=1", "snap=x", "snap=-1", "snap=", "snap=nan", "explain=x", "explain=",
                  "positive_a=2", "convention=", "convention=DH", "convention=x", "angle=grad",
                  "format=exe", "format=svg", "format=", "zzz=1", "tip=zzz", "base=zzz", "tip=",
                  "tip=frame_3", "base=frame_1&tip=frame_4", "convention=dh&convention=mdh",
                  "explain=1", "explain=0", "snap=1e-9", "positive_a=true"):  # fmt: skip
        yield ask(f"/v1/robots/puma560/dh?{query}")
        yield ask(f"/v1/robots/{MINE}tree/dh?{query}")


def _conversions() -> Iterator[Asked]:
    def ask(target: str, body: Any, type_: str = "application/json", what: str = "") -> Asked:
        return _ask(target.partition("?")[0][4:], "conversion", "POST", target, body, type_,
                    what=what or target)  # fmt: skip

    xml = "application/xml"
    for query in ("", "convention=standard", "convention=modified&explain=1",
                  "convention=khalil&format=text&angle=deg", "convention=x", "convention=dh&tip=zzz",
                  "convention=dh&base=zzz", "convention=dh&snap=1", "convention=dh&snap=x",
                  "convention=dh&explain=x", "convention=dh&zzz=1", "convention=dh&angle=grad",
                  "convention=dh&positive_a=1&format=csv", "convention=dh&format=yaml",
                  "convention=dh&format=exe", "convention=dh&name=x"):  # fmt: skip
        yield ask(f"/v1/urdf-to-dh?{query}", URDF, xml)
        yield ask(f"/v1/urdf-to-dh?{query}", urdfs.ARM, xml, f"arm {query}")
    for what, text in {"nothing": "", "no XML": "x", "JSON": "{}", "no robot": "<a/>",
                       "cut": URDF[:80]}.items():  # fmt: skip
        yield ask("/v1/urdf-to-dh?convention=dh", text, xml, what)
    yield ask("/v1/urdf-to-dh?convention=dh", URDF, "application/json", "as JSON")
    yield ask("/v1/urdf-to-dh?convention=dh", URDF, "text/plain", "as text")
    axes = {
        "name": "two_r", "convention": "standard",
        "joints": [
            {"name": "j1", "type": "revolute", "point": [0, 0, 0.1], "direction": [0, 0, 1]},
            {"name": "j2", "type": "P", "point": [0.4, 0, 0.3], "direction": [0, 1, 0],
             "limits": {"lower": -2, "upper": 2}},
        ],
        "tip": {"xyz": [0.9, 0, 0.3], "rpy": [0, "pi/2", 0]},
    }  # fmt: skip
    plain = {name: value for name, value in axes.items() if name != "convention"}
    for query in ("", "convention=dh", "format=text&angle=deg", "explain=1", "snap=x", "zzz=1",
                  "format=exe", "positive_a=1", "angle=grad", "name=x", "tip=x"):  # fmt: skip
        yield ask(f"/v1/axes-to-dh?{query}", axes)
        yield ask(f"/v1/axes-to-dh?{query}", plain, what=f"plain {query}")
    for convention in ("standard", "modified", "khalil", "x", "", "DH"):
        yield ask(f"/v1/axes-to-dh?convention={convention}", plain)
    for what, body in mutate.bodies(axes):
        yield ask("/v1/axes-to-dh", body, what=what)
    yield ask("/v1/axes-to-dh", axes, "application/yaml", "as YAML")
    for query in ("", "to=standard", "to=modified", "to=khalil", "to=x", "to=", "to=dh&angle=deg",
                  "to=dh&format=text", "to=dh&format=csv", "to=dh&format=exe", "to=dh&tip=zzz",
                  "to=dh&tip=b", "to=dh&zzz=1", "to=dh&name=y", "to=dh&angle=grad",
                  "to=dh&explain=1", "to=dh&format=latex", "to=dh&convention=dh"):  # fmt: skip
        for what, body, type_ in (
            ("table", BARE, "application/json"), ("tree", TREE, "application/json"),
            ("CSV", CSV, "text/csv"), ("YAML", YAML, "application/yaml"), ("URDF", URDF, xml),
            ("par", PAR, "text/x-symoro"), ("pasted", PASTED, "text/plain"),
        ):  # fmt: skip
            yield ask(f"/v1/convert-dh?{query}", body, type_, f"{what} {query}")
    for what, (type_, query, document) in DOCUMENTS.items():
        yield ask(f"/v1/dh-to-urdf?{query}", document, type_, what)
        yield ask(f"/v1/convert-dh?to=standard&{query}", document, type_, what)
    for query in ("", "loops=cut", "loops=cut&values=RL4:0.5,d2:1,d3:1,d4:1,d8:1", "loops=x"):
        yield ask(f"/v1/dh-to-urdf?{query}", SR400, "text/x-symoro", f"loops {query}")


def _diff() -> Iterator[Asked]:
    def ask(target: str, body: Any, what: str = "") -> Asked:
        return _ask("diff", "comparison", "POST", target, body, what=what or target)

    body = {"other": "ur5_urdf", "tolerance": {"length": 1e-6, "angle": 1e-6}, "base": "frame_0",
            "tip": "frame_6", "other_base": "base_link", "other_tip": "tool0"}  # fmt: skip
    for robot, other in (("ur5", "ur5e"), ("puma560", "puma560"), ("panda", "panda_urdf"),
                         ("planar_2r", "planar_3r"), ("scara", BARE), ("ur5", {"urdf": URDF}),
                         ("ur5", {"urdf": URDF, "tip": "zzz"}), ("ur5", {}), ("ur5", 3),
                         ("ur5", None), ("ur5", "nothing"), ("ur5", []),
                         ("ur5", {"convention": "dh"})):  # fmt: skip
        for query in ("", "angle=deg", "format=text&angle=deg"):
            yield ask(f"/v1/robots/{robot}/diff?{query}", {"other": other}, f"{robot} {query}")
            inline = {"robot": robot, "other": other}
            yield ask(f"/v1/diff?{query}", inline, f"inline {robot} {query}")
    for what, changed in mutate.bodies(body):
        yield ask("/v1/robots/ur5/diff", changed, what)
    for what, changed in mutate.bodies({"robot": {"urdf": URDF, "tip": "tip"}, "other": "planar_2r"}):
        yield ask("/v1/diff", changed, f"inline, {what}")
    for query in ("zzz=1", "angle=grad", "format=csv", "angle=deg&angle=deg"):
        yield ask(f"/v1/robots/ur5/diff?{query}", {"other": "ur5e"})
    yield _ask("diff", "comparison", "POST", "/v1/robots/nothing/diff", {"other": "ur5"})
    yield _ask("diff", "comparison", "POST", "/v1/robots/ur5/diff", YAML, "application/yaml")
    yield _ask("diff", "comparison", "GET", "/v1/robots/ur5/diff")


def _others() -> Iterator[Asked]:
    """Health, problems, meshes, the docs and addresses of nothing."""
    def ask(target: str, *headers: tuple[str, str], method: str = "GET", group: str = "") -> Asked:
        group = group or target.split("?")[0].split("/")[1] or "index"
        return _ask(group, "route", method, target, None, "", *headers)

    for target in ("/health/live", "/health/ready", "/", "/problems/invalid-request"):
        for method in ("GET", "HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PATCH"):
            if (method, target) != ("HEAD", "/"):
                yield ask(target, method=method)
    for accept in ("application/json", "text/plain", "image/png", "*/*", "text/csv, */*;q=0.1"):
        yield ask("/", ("Accept", accept))
    yield ask("/?format=text")
    yield ask("/?format=csv")
    for slug in PROBLEMS:
        yield ask(f"/problems/{slug}")
        yield ask(f"/problems/{slug}", ("Accept", "text/plain"))
    for target in ("/v1", "/v1/nothing", "/v1/robots/", "/nothing", "/v1//robots", "/docs/",
                   "/v2/robots", "/v1/../robots", "/metrics/", "/health", "/health/x",
                   "/v1/robots/puma560/nothing", "/v1/robots/puma560/fk/x", "/assets/x.js",
                   "/docs-assets/x", "/openapi.yaml", "/favicon.ico"):  # fmt: skip
        yield ask(target, group="addresses")
        yield ask(target, ("Accept", "text/plain"), group="addresses")
        yield ask(target, method="DELETE", group="addresses")
    for robot in ("panda_urdf", "double_pendulum", "puma560", f"{MINE}urdf", "nothing"):
        yield ask(f"/v1/robots/{robot}/meshes", group="meshes")
        yield ask(f"/v1/robots/{robot}/meshes?format=text", group="meshes")
        yield ask(f"/v1/robots/{robot}/meshes?zzz=1", group="meshes")
        yield ask(f"/v1/robots/{robot}/meshes/nothing.stl", group="meshes")
    mesh = "/v1/robots/panda_urdf/meshes/panda_description/meshes/collision/link7.stl"
    yield ask(mesh, group="meshes")
    yield ask(mesh, ("If-None-Match", f"{{etag:{mesh}}}"), group="meshes")
    yield ask(f"{mesh}?format=json", group="meshes")
    yield ask("/v1/robots/panda_urdf/meshes/..%2f..%2fetc%2fpasswd", group="meshes")


PROBLEMS = (
    "malformed-body", "invalid-request", "unsupported-media-type", "uri-too-long",
    "not-acceptable", "too-large", "internal-error", "stopping", "busy", "unauthorised",
    "forbidden", "too-many-requests", "invalid-table", "invalid-urdf", "robot-too-large",
    "unknown-frame", "robot-not-found", "invalid-robot-id", "mesh-not-found", "robot-exists",
    "read-only-robot", "revision-mismatch", "damaged-robot", "quota-reached", "storage-full",
    "storage-unavailable", "invalid-q", "invalid-vector", "unknown-task",
    "unknown-euler-sequence", "representation-singularity", "invalid-target", "invalid-option",
    "symbolic-unavailable", "out-of-time", "rank-deficient", "method-unavailable", "not-found",
    "method-not-allowed", "nothing", "x" * 90,
)  # fmt: skip


def _corpus() -> Iterator[Asked]:
    """The hostile and odd requests of tests/corpus, as far as they are short."""
    cases: list[Case] = []
    for module in (urdfs, tables, bodies, addresses):
        cases += [*module.refused(), *module.accepted()]
    for case in cases:
        sent = case.sent
        if len(sent.body or b"") > LONGEST_BODY or len(sent.target) > LONGEST_BODY:
            continue
        if sent.path in ("/docs", "/openapi.json") or (
            sent.path == "/" and (sent.method == "HEAD" or sent.header("accept"))
        ):
            continue
        yield Asked("corpus", "refused" if not case.accepted else "accepted",
                    replace(sent, what=case.name))  # fmt: skip
        if case.accepted and sent.method in ("PUT", "POST"):
            yield _ask("corpus", "accepted", "DELETE", f"/v1/robots/{CORPUS}", what="and away")
