"""Requests on stored robots, by body and by query, and with the robot in the body."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from tests.recorded.fixture import Asked
from tests.torture.exchange import Sent

Pose: TypeAlias = Callable[..., list[list[float]]]
"""(robot, q, frame) -> matrix."""
JSON = ("Content-Type", "application/json")
NPY_TYPE = ("Content-Type", "application/x-npy")


def post(name: str, kind: str, robot: str, body: dict[str, Any], query: str = "") -> Asked:
    """A request on a stored robot."""
    what = f"{robot} {query}"
    return Asked(
        name,
        kind,
        Sent(
            "POST",
            f"/v1/robots/{robot}/{name}",
            query,
            (JSON,),
            json.dumps(body).encode(),
            what=what,
        ),
    )


def inline(name: str, kind: str, robot: Any, body: dict[str, Any], query: str = "") -> Asked:
    """A request with the robot in the body."""
    content = json.dumps({"robot": robot, **body}).encode()
    return Asked(
        name, kind, Sent("POST", f"/v1/{name}", query, (JSON,), content, what=f"inline {query}")
    )


def get(name: str, kind: str, robot: str, query: str) -> Asked:
    """A request by query."""
    return Asked(name, kind, Sent("GET", f"/v1/robots/{robot}/{name}", query, what=query[:80]))


def npy(values: Any, **options: Any) -> bytes:
    """An array as a file."""
    stream = io.BytesIO()
    np.save(stream, np.asarray(values), **options)
    return stream.getvalue()


def ask(
    operation: str,
    kind: str,
    method: str,
    target: str,
    body: Any = None,
    type_: str = "",
    *headers: tuple[str, str],
    what: str = "",
) -> Asked:
    path, _, query = target.partition("?")
    if body is not None and not isinstance(body, bytes):
        body = (body if isinstance(body, str) else json.dumps(body)).encode()
    if body is not None and not type_:
        type_ = "application/json"
    given = (("Content-Type", type_), *headers) if type_ else headers
    what = what or f"{method} {target[:80]}"
    return Asked(operation, kind, Sent(method, path, query, given, body, what=what))
