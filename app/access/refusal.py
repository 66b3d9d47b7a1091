"""What the checks of access share: which requests they look at, and the answer that refuses one."""

from __future__ import annotations

from fastapi import Request
from fastapi.routing import iter_route_contexts
from starlette.routing import compile_path
from starlette.types import Receive, Scope, Send

from app.http.problems import ErrorEntry, ProblemType, problem_response
from app.telemetry.observed import REFUSED_ROUTE

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


def route_of(scope: Scope) -> str | None:
    """Return the template of the route that a request would take, None where none does.

    For requests that are turned away before they are routed; of several routes of a path, the one
    that takes the method comes first.
    """
    app = scope.get("app")
    if app is None:
        return None
    if not hasattr(app.state, "route_templates"):
        app.state.route_templates = [
            (compile_path(route.path)[0], route.methods or (), route.path)
            for route in iter_route_contexts(app.routes)
            if route.path is not None
        ]
    path, method = path_of(scope), scope["method"]
    found = [
        (method in methods, template)
        for pattern, methods, template in app.state.route_templates
        if pattern.match(path)
    ]
    return max(found, key=lambda one: one[0])[1] if found else None


async def refuse(
    scope: Scope,
    receive: Receive,
    send: Send,
    type_: ProblemType,
    detail: str,
    challenge: str | None = None,
) -> None:
    """Answer with a problem document; a challenge says which key would be accepted.

    The route that the request would have taken is noted for its log line.
    """
    scope[REFUSED_ROUTE] = route_of(scope)
    headers = {} if challenge is None else {"WWW-Authenticate": challenge}
    response = problem_response(Request(scope), type_, [ErrorEntry("", detail)], headers)
    await response(scope, receive, send)
