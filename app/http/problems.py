"""Errors as RFC 9457 problem documents: one table from exceptions to answers."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.routing import Match, Mount

from app.http.pointers import json_pointer
from dh_to_urdf import DHError, Problem
from dh_to_urdf.errors import DHSyntaxError
from kinematics import errors as kinematics
from kinematics.symbolic import SymbolicUnavailable, WorkersBusy
from robots import errors as robots

MEDIA_TYPE = "application/problem+json"
MAX_ERRORS = 10
MAX_MESSAGE = 400
MAX_BYTES = 4096
_METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")
# Control characters, and those that turn the direction of what follows.
_UNSAFE = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb]+"
)


@dataclass(frozen=True, slots=True)
class ProblemType:
    """A kind of problem.

    Attributes:
        slug: Last part of its type URI.
        status: HTTP status.
        title: What it is, in one line.
    """

    slug: str
    status: int
    title: str


class RequestProblem(Exception):
    """A problem that the HTTP layer itself finds."""

    def __init__(
        self,
        type_: ProblemType,
        detail: str,
        pointer: str = "",
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.type = type_
        self.problems = (Problem(pointer, detail),)
        self.headers = dict(headers or {})


MALFORMED_BODY = ProblemType("malformed-body", 400, "The body cannot be parsed")
INVALID_REQUEST = ProblemType("invalid-request", 422, "The request cannot be used")
UNSUPPORTED_TYPE = ProblemType("unsupported-media-type", 415, "This body type is not read here")
TOO_LONG = ProblemType("uri-too-long", 414, "The address is too long")
NOT_ACCEPTABLE = ProblemType("not-acceptable", 406, "The answer has no such form")
TOO_LARGE = ProblemType("too-large", 413, "The request is too large")
INTERNAL = ProblemType("internal-error", 500, "The service failed")
STOPPING = ProblemType("stopping", 503, "The service is stopping")

BUSY = ProblemType("busy", 503, "The service has no room for this now")
UNAUTHORISED = ProblemType("unauthorised", 401, "This needs a key")
FORBIDDEN = ProblemType("forbidden", 403, "The key does not allow this")
TOO_MANY = ProblemType("too-many-requests", 429, "Too many requests")

BY_EXCEPTION: dict[type[Exception], ProblemType] = {
    DHSyntaxError: MALFORMED_BODY,
    DHError: ProblemType("invalid-table", 422, "The D-H table cannot be used"),
    robots.InvalidURDF: ProblemType("invalid-urdf", 422, "The URDF cannot be used"),
    robots.RobotTooLarge: ProblemType("robot-too-large", 422, "The robot is too large"),
    robots.UnknownFrame: ProblemType("unknown-frame", 422, "The robot has no such frame"),
    robots.RobotNotFound: ProblemType("robot-not-found", 404, "There is no such robot"),
    robots.InvalidRobotId: ProblemType("invalid-robot-id", 422, "This id cannot name a robot"),
    robots.MeshNotFound: ProblemType("mesh-not-found", 404, "The robot has no such mesh"),
    robots.RobotExists: ProblemType("robot-exists", 409, "The id is taken"),
    robots.ReadOnlyRobot: ProblemType("read-only-robot", 409, "Shipped robots are read-only"),
    robots.RevisionMismatch: ProblemType("revision-mismatch", 412, "The robot has changed"),
    robots.DamagedRobot: ProblemType("damaged-robot", 409, "The stored robot is damaged"),
    robots.QuotaReached: ProblemType("quota-reached", 409, "No more robots are taken"),
    robots.StorageFull: ProblemType("storage-full", 507, "The disk is full"),
    robots.StorageUnavailable: ProblemType(
        "storage-unavailable", 503, "Uploaded robots cannot be reached now"
    ),
    kinematics.WrongConfiguration: ProblemType("invalid-q", 422, "q does not fit the robot"),
    kinematics.WrongVector: ProblemType("invalid-vector", 422, "A twist or wrench does not fit"),
    kinematics.UnknownTask: ProblemType("unknown-task", 422, "There is no such task space"),
    kinematics.UnknownSequence: ProblemType(
        "unknown-euler-sequence", 422, "There is no such Euler sequence"
    ),
    kinematics.RepresentationSingularity: ProblemType(
        "representation-singularity", 422, "These Euler angles have no rates here"
    ),
    kinematics.InvalidTarget: ProblemType("invalid-target", 422, "The target is no pose"),
    kinematics.InvalidOption: ProblemType("invalid-option", 422, "An option is out of range"),
    SymbolicUnavailable: ProblemType("symbolic-unavailable", 501, "SymPy is not installed"),
    WorkersBusy: BUSY,
    kinematics.OutOfTime: ProblemType("out-of-time", 422, "The computation takes too long"),
    kinematics.RankDeficient: ProblemType("rank-deficient", 422, "The Jacobian has lost rank"),
    kinematics.MethodUnavailable: ProblemType(
        "method-unavailable", 501, "The method needs a package that is not installed"
    ),
}

NOT_FOUND = ProblemType("not-found", 404, "There is nothing here")
METHOD_NOT_ALLOWED = ProblemType("method-not-allowed", 405, "The method is not possible here")

_GENERIC = (
    INVALID_REQUEST, MALFORMED_BODY, UNSUPPORTED_TYPE, NOT_ACCEPTABLE, TOO_LARGE, TOO_LONG,
    NOT_FOUND, METHOD_NOT_ALLOWED, INTERNAL, STOPPING, UNAUTHORISED, FORBIDDEN, TOO_MANY, BUSY,
)  # fmt: skip
ALL_TYPES = {type_.slug: type_ for type_ in (*BY_EXCEPTION.values(), *_GENERIC)}


def problem_response(
    request: Request,
    type_: ProblemType,
    problems: Sequence[Problem],
    headers: Mapping[str, str] | None = None,
) -> Response:
    """A problem document: at most ten errors and 4 kB, no control characters.

    As text where the request asks for text, so that a terminal shows a sentence.
    """
    errors = [
        {"pointer": _pointer(problem.pointer), "message": _shown(problem.message)}
        for problem in problems[:MAX_ERRORS]
    ]
    detail = errors[0]["message"] if errors else type_.title
    if len(problems) > 1:
        detail = f"{detail} (and {len(problems) - 1} more)"
    body: dict[str, Any] = {
        "type": f"{request.scope.get('root_path', '')}/problems/{type_.slug}",
        "title": type_.title,
        "status": type_.status,
        "detail": detail,
        "errors": errors,
        "request_id": request.scope.get("state", {}).get("request_id", ""),
    }
    written = _write_text if _wants_text(request) else orjson.dumps
    content = written(body)
    while len(content) > MAX_BYTES and len(errors) > 1:
        errors.pop()
        content = written(body)
    media_type = MEDIA_TYPE if written is orjson.dumps else "text/plain; charset=utf-8"
    return Response(content, type_.status, dict(headers or {}), media_type)


def _wants_text(request: Request) -> bool:
    if request.scope.get("query_string"):
        named = request.query_params.get("format")
        if named is not None:
            return named == "text"
    return request.headers.get("accept", "").lower().lstrip().startswith("text/plain")


def _write_text(body: Mapping[str, Any]) -> bytes:
    """``422 The request cannot be used``, then what is wrong and where."""
    lines = [f"{body['status']} {body['title']}"]
    for error in body["errors"]:
        place = f"{error['pointer']}: " if error["pointer"] else ""
        lines.append(f"  {place}{error['message']}")
    lines.append(f"request_id: {body['request_id']}")
    return ("\n".join(lines) + "\n").encode()


def _shown(message: str) -> str:
    text = _UNSAFE.sub(" ", message.encode("utf-8", "replace").decode())
    return text if len(text) <= MAX_MESSAGE else text[: MAX_MESSAGE - 1] + "…"


def _pointer(pointer: str) -> str:
    """Cut without leaving half of an escape."""
    return _shown(pointer)[:200].removesuffix("~")


def install(app: FastAPI) -> None:
    """Registers the handlers; every error of the service leaves through them."""
    for exception in BY_EXCEPTION:
        app.add_exception_handler(exception, _domain_problem)
    app.add_exception_handler(RequestProblem, _request_problem)
    app.add_exception_handler(RequestValidationError, _validation_error)
    app.add_exception_handler(HTTPException, _http_exception)


async def _domain_problem(request: Request, error: Exception) -> Response:
    return domain_problem(request, error)


def domain_problem(request: Request, error: Exception) -> Response:
    """The problem document of an exception of ``BY_EXCEPTION``."""
    type_ = next(BY_EXCEPTION[kind] for kind in type(error).__mro__ if kind in BY_EXCEPTION)
    if isinstance(error, DHError):
        return problem_response(request, type_, error.problems)
    pointer = getattr(error, "pointer", "")
    if isinstance(error, kinematics.KinematicsError):
        pointer = json_pointer(error.location)
    retry = getattr(error, "retry_after", None)
    headers = {} if retry is None else {"Retry-After": str(math.ceil(retry))}
    return problem_response(request, type_, [Problem(pointer, str(error))], headers)


async def _request_problem(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestProblem)
    return problem_response(request, error.type, error.problems, error.headers)


async def _validation_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    problems = [
        Problem("/" + "/".join(str(part) for part in item["loc"][1:]), str(item["msg"]))
        for item in error.errors()[:MAX_ERRORS]
    ]
    return problem_response(request, INVALID_REQUEST, problems)


async def _http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    status = HTTPStatus(error.status_code)
    path = request.url.path
    shown = path if len(path) <= 100 else f"{path[:99]}…"
    if status is HTTPStatus.REQUEST_ENTITY_TOO_LARGE:
        message = "the body is larger than this endpoint takes; send it in parts"
        return problem_response(request, TOO_LARGE, [Problem("", message)])
    if status is HTTPStatus.NOT_FOUND:
        remedy = "GET / lists the endpoints"
        if path.endswith("/"):
            remedy = "addresses have no / at the end"
        message = f"there is nothing at {shown}; {remedy}"
        return problem_response(request, NOT_FOUND, [Problem("", message)])
    if status is HTTPStatus.METHOD_NOT_ALLOWED:
        allowed = ", ".join(allowed_methods(request))
        headers = {"Allow": allowed}
        if request.method == "OPTIONS":
            return Response(status_code=204, headers=headers)
        message = f"{request.method[:16]} is not possible at {shown}; use {allowed}"
        return problem_response(request, METHOD_NOT_ALLOWED, [Problem("", message)], headers)
    slug = status.phrase.lower().replace(" ", "-").replace("'", "")
    type_ = ProblemType(slug, status.value, status.phrase)
    return problem_response(request, type_, [Problem("", str(error.detail))], error.headers)


def allowed_methods(request: Request) -> list[str]:
    """Methods that a request's path takes, over all routes that match it."""
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
