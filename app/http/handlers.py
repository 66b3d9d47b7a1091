"""Exceptions -> answers: every error of the service leaves through these handlers."""

from __future__ import annotations

from http import HTTPStatus

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.routing import Match, Mount

from app.http.problems import (
    INVALID_REQUEST,
    MAX_ERRORS,
    METHOD_NOT_ALLOWED,
    NOT_FOUND,
    TOO_LARGE,
    ErrorEntry,
    ProblemType,
    RequestProblem,
    problem_response,
)
from app.http.rendering import RENDERINGS, rendered
from dh_to_urdf.messages import say

_METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")


def install(app: FastAPI) -> None:
    """Register the handlers."""
    for exception in RENDERINGS:
        app.add_exception_handler(exception, _domain_problem)
    app.add_exception_handler(RequestProblem, _request_problem)
    app.add_exception_handler(RequestValidationError, _validation_error)
    app.add_exception_handler(HTTPException, _http_exception)


async def _domain_problem(request: Request, error: Exception) -> Response:
    return domain_problem(request, error)


def domain_problem(request: Request, error: Exception) -> Response:
    """Return the problem document of an exception of ``RENDERINGS``."""
    type_, entries, headers = rendered(error)
    return problem_response(request, type_, entries, headers)


async def _request_problem(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestProblem)
    return problem_response(request, error.type, error.entries, error.headers)


async def _validation_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    entries = [
        ErrorEntry("/" + "/".join(str(part) for part in item["loc"][1:]), str(item["msg"]))
        for item in error.errors()[:MAX_ERRORS]
    ]
    return problem_response(request, INVALID_REQUEST, entries)


async def _http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    status = HTTPStatus(error.status_code)
    path = request.url.path
    shown = path if len(path) <= 100 else f"{path[:99]}…"
    if status is HTTPStatus.REQUEST_ENTITY_TOO_LARGE:
        message = say("the body is larger than this endpoint takes; send it in parts")
        return problem_response(request, TOO_LARGE, [ErrorEntry("", message)])
    if status is HTTPStatus.NOT_FOUND:
        remedy = say("GET / lists the endpoints")
        if path.endswith("/"):
            remedy = say("addresses have no / at the end")
        message = say("there is nothing at {shown}; {remedy}", shown=shown, remedy=remedy)
        return problem_response(request, NOT_FOUND, [ErrorEntry("", message)])
    if status is HTTPStatus.METHOD_NOT_ALLOWED:
        allowed = ", ".join(allowed_methods(request))
        headers = {"Allow": allowed}
        if request.method == "OPTIONS":
            return Response(status_code=204, headers=headers)
        message = say(
            "{method} is not possible at {shown}; use {allowed}",
            method=request.method[:16],
            shown=shown,
            allowed=allowed,
        )
        return problem_response(request, METHOD_NOT_ALLOWED, [ErrorEntry("", message)], headers)
    slug = status.phrase.lower().replace(" ", "-").replace("'", "")
    type_ = ProblemType(slug, status.value, status.phrase)
    return problem_response(request, type_, [ErrorEntry("", str(error.detail))], error.headers)


def allowed_methods(request: Request) -> list[str]:
    """Return the methods that a request's path takes, over all routes that match it."""
    routes = request.app.router.routes
    scopes = {method: {**request.scope, "method": method} for method in _METHODS}
    found = [
        method
        for method, scope in scopes.items()
        if any(
            not isinstance(route, Mount) and route.matches(scope)[0] is Match.FULL
            for route in routes
        )
    ]
    if not found or ("GET" in found and "HEAD" not in found):
        found = ["GET", "HEAD", *(method for method in found if method != "GET")]
    return [*found, "OPTIONS"]
