"""Requests that store, list, read and delete robots, and upload every type of document."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tests.recorded.fixture import MINE, SETUP, Asked
from tests.recorded.requests import mutate, sent
from tests.recorded.requests.documents import BARE, DOCUMENTS, TREE, URDF


def setup() -> Iterator[Asked]:
    """What others rest on."""
    yield sent.ask(SETUP, "upload", "PUT", f"/v1/robots/{MINE}tree", TREE)
    yield sent.ask(SETUP, "upload", "PUT", f"/v1/robots/{MINE}mixed", BARE)
    yield sent.ask(SETUP, "upload", "PUT", f"/v1/robots/{MINE}urdf", URDF, "application/xml")


def asked() -> Iterator[Asked]:
    """All requests, in order."""
    yield from _robots()
    yield from _uploads()


def _robots() -> Iterator[Asked]:
    def ask(method: str, target: str, body: Any = None, *headers: tuple[str, str]) -> Asked:
        return sent.ask("robots", "store", method, target, body, "", *headers)

    for query in (
        "",
        "page_size=3",
        "page_size=2&page_token=planar_8r",
        "page_token=zzzz",
        "page_size=0",
        "page_size=1001",
        "page_size=x",
        "page_size=",
        "page_size=1.5",
        "page_token=%7F&page_size=1",
        "zzz=1",
        "page_size=1&page_size=2",
        "angle=deg",
        "format=text&page_size=5",
        "format=csv",
        "format=json&page_size=1",
    ):
        yield ask("GET", f"/v1/robots?{query}" if query else "/v1/robots")
    for robot in (
        "puma560",
        "planar_2r",
        "scara",
        "panda_urdf",
        "baxter",
        "stanford",
        "double_pendulum_continuous",
        f"{MINE}tree",
        f"{MINE}mixed",
        f"{MINE}urdf",
        "nothing",
        "PUMA560",
        "a%20b",
        "%2e%2e",
        ".hidden",
        "a" * 65,
    ):
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
        for target in (
            "/v1/robots",
            "/v1/robots/puma560",
            "/v1/robots/puma560/urdf",
            "/v1/robots/puma560/dh",
            "/v1/robots/puma560/meshes",
        ):
            if (method, target) != ("POST", "/v1/robots"):
                yield ask(method, target)


def _uploads() -> Iterator[Asked]:
    """Each type of document, in all forms of the query; and each field of a table changed."""
    here = f"/v1/robots/{MINE}up"
    for what, (type_, query, document) in DOCUMENTS.items():
        given = f"{here}?{query}" if query else here
        yield sent.ask("uploads", "type", "PUT", given, document, type_, what=what)
        for rest in ("", "/urdf", "/dh", "/dh?format=text&angle=deg"):
            yield sent.ask("uploads", "type", "GET", here + rest, what=f"{what}{rest}")
        yield sent.ask("uploads", "type", "DELETE", here, what=what)
        for more in (
            "zzz=1",
            "angle=deg",
            "angle=grad",
            "length=mm",
            "length=inch",
            "convention=x",
            "convention=khalil",
            "values=L9:1",
            "values=x",
            "columns=x",
            "loops=cut",
            "loops=x",
            "tip=zzz",
            "base=zzz",
            "format=csv",
            "name=",
        ):
            added = "&".join(part for part in (query, more) if part)
            told = f"{what}: {more}"
            if more in ("zzz=1", "tip=zzz", "format=csv", "name="):
                yield sent.ask(
                    "uploads", "query", "PUT", f"{here}?{added}", document, type_, what=told
                )
            door = f"/v1/dh-to-urdf?{added}"
            yield sent.ask("uploads", "query", "POST", door, document, type_, what=told)
        yield sent.ask("uploads", "query", "DELETE", here, what=what)
    for what, body in mutate.bodies(BARE):
        yield sent.ask("uploads", "refused table", "POST", "/v1/dh-to-urdf", body, what=what)
    joints = TREE["joints"]
    for what, body in mutate.bodies({**TREE, "joints": [joints[1] | {"ant": 0}, joints[2]]}):
        if what.startswith("joints"):
            yield sent.ask(
                "uploads", "refused table", "POST", "/v1/dh-to-urdf", body, what=f"tree, {what}"
            )
