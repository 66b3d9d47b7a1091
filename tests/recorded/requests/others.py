"""Health, problems, meshes, addresses of nothing, and the cases of tests/corpus."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from tests.corpus import addresses, bodies, tables, urdfs
from tests.corpus.case import MINE as CORPUS
from tests.corpus.case import Case
from tests.recorded.fixture import MINE, Asked
from tests.recorded.requests import sent

LONGEST_DOCUMENT, LONGEST_BODY = 6_000, 700_000
"""Bytes of a case of the corpus that is recorded: of a document, and of other requests."""
PROBLEMS = (
    "malformed-body",
    "invalid-request",
    "unsupported-media-type",
    "uri-too-long",
    "not-acceptable",
    "too-large",
    "internal-error",
    "stopping",
    "busy",
    "unauthorised",
    "forbidden",
    "too-many-requests",
    "invalid-table",
    "invalid-urdf",
    "robot-too-large",
    "unknown-frame",
    "robot-not-found",
    "invalid-robot-id",
    "mesh-not-found",
    "robot-exists",
    "read-only-robot",
    "revision-mismatch",
    "damaged-robot",
    "quota-reached",
    "storage-full",
    "storage-unavailable",
    "invalid-q",
    "invalid-vector",
    "unknown-task",
    "unknown-euler-sequence",
    "representation-singularity",
    "invalid-target",
    "invalid-option",
    "symbolic-unavailable",
    "out-of-time",
    "rank-deficient",
    "method-unavailable",
    "not-found",
    "method-not-allowed",
    "nothing",
    "x" * 90,
)


def asked() -> Iterator[Asked]:
    """All requests, in order."""
    yield from _others()
    yield from _corpus()


def _others() -> Iterator[Asked]:
    """Health, problems, meshes, the docs and addresses of nothing."""

    def ask(target: str, *headers: tuple[str, str], method: str = "GET", group: str = "") -> Asked:
        group = group or target.split("?")[0].split("/")[1] or "index"
        return sent.ask(group, "route", method, target, None, "", *headers)

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
    for target in (
        "/v1",
        "/v1/nothing",
        "/v1/robots/",
        "/nothing",
        "/v1//robots",
        "/docs/",
        "/v2/robots",
        "/v1/../robots",
        "/metrics/",
        "/health",
        "/health/x",
        "/v1/robots/puma560/nothing",
        "/v1/robots/puma560/fk/x",
        "/assets/x.js",
        "/docs-assets/x",
        "/openapi.yaml",
        "/favicon.ico",
    ):
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


def _corpus() -> Iterator[Asked]:
    """The hostile and odd requests of tests/corpus, as far as they are short."""
    cases: list[Case] = []
    for module in (urdfs, tables, bodies, addresses):
        longest = LONGEST_DOCUMENT if module in (urdfs, tables) else LONGEST_BODY
        cases += [
            case
            for case in (*module.refused(), *module.accepted())
            if len(case.sent.body or b"") <= (LONGEST_DOCUMENT if case.accepted else longest)
        ]
    for case in cases:
        asked_for = case.sent
        if asked_for.path in ("/docs", "/openapi.json") or (
            asked_for.path == "/" and (asked_for.method == "HEAD" or asked_for.header("accept"))
        ):
            continue
        yield Asked(
            "corpus",
            "refused" if not case.accepted else "accepted",
            replace(asked_for, what=case.name),
        )
        if case.accepted and asked_for.method in ("PUT", "POST"):
            yield sent.ask("corpus", "accepted", "DELETE", f"/v1/robots/{CORPUS}", what="and away")
