"""What the checks of access share: which requests they look at, and the answer that refuses one."""

from __future__ import annotations

from fastapi import Request
from starlette.types import Receive, Scope, Send

from app.http.problems import ErrorEntry, ProblemType, problem_response

CALLER, ITSELF = "denavit.caller", object()
"""Entry of the scope of a request that the service makes to itself; no client can set it."""
UPLOADS = "/v1/robots"
CHANGING = ("PUT", "DELETE", "PATCH")


def is_from_outside(scope: Scope) -> bool:
    """Return whether this is an HTTP request that the service does not make to itself."""
    return scope["type"] == "http" and scope.get(CALLER) is not ITSELF


def path_of(scope: Scope) -> str:
    """Return the path of a request, without the prefix of a reverse proxy."""
    path: str = scope["path"]
    return path.removeprefix(scope.get("root_path", "").rstrip("/"))


def changes_robots(scope: Scope) -> bool:
    """Return whether a request changes stored robots."""
    method = scope["method"]
    return method in CHANGING or (method == "POST" and path_of(scope).rstrip("/") == UPLOADS)


async def refuse(
    scope: Scope,
    receive: Receive,
    send: Send,
    type_: ProblemType,
    detail: str,
    challenge: str | None = None,
) -> None:
    """Answer with a problem document; a challenge says which key would be accepted."""
    headers = {} if challenge is None else {"WWW-Authenticate": challenge}
    response = problem_response(Request(scope), type_, [ErrorEntry("", detail)], headers)
    await response(scope, receive, send)
