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

from dh_to_urdf import DHError, Problem
from dh_to_urdf.errors import DHSyntaxError
from kinematics import errors as kinematics
from kinematics.symbolic import SymbolicUnavailable, WorkersBusy
from robots import errors as robots

MEDIA_TYPE = "application/problem+json"
MAX_ERRORS = 10
MAX_MESSAGE = 400
_CONTROL = re.compile(r"[\x00-\x1f\x7f]+")


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
NOT_ACCEPTABLE = ProblemType("not-acceptable", 406, "The answer has no such form")
TOO_LARGE = ProblemType("too-large", 413, "The request is too large")
INTERNAL = ProblemType("internal-error", 500, "The service failed")

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
    WorkersBusy: ProblemType("busy", 503, "The service has no room for this now"),
    kinematics.RankDeficient: ProblemType("rank-deficient", 422, "The Jacobian has lost rank"),
    kinematics.MethodUnavailable: ProblemType(
        "method-unavailable", 501, "The method needs a package that is not installed"
    ),
}

_GENERIC = (INVALID_REQUEST, MALFORMED_BODY, UNSUPPORTED_TYPE, NOT_ACCEPTABLE, TOO_LARGE, INTERNAL)
ALL_TYPES = {type_.slug: type_ for type_ in (*BY_EXCEPTION.values(), *_GENERIC)}


def problem_response(
    request: Request,
    type_: ProblemType,
    problems: Sequence[Problem],
    headers: Mapping[str, str] | None = None,
) -> Response:
    """A problem document; at most ten errors, no control characters, bounded length."""
    errors = [
        {"pointer": _shown(problem.pointer)[:200], "message": _shown(problem.message)}
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
    return Response(orjson.dumps(body), type_.status, dict(headers or {}), MEDIA_TYPE)


def _shown(message: str) -> str:
    text = _CONTROL.sub(" ", message.encode("utf-8", "replace").decode())
    return text if len(text) <= MAX_MESSAGE else text[: MAX_MESSAGE - 1] + "…"


def install(app: FastAPI) -> None:
    """Registers the handlers; every error of the service leaves through them."""
    for exception, type_ in BY_EXCEPTION.items():
        app.add_exception_handler(exception, _domain_handler(type_))
    app.add_exception_handler(RequestProblem, _request_problem)
    app.add_exception_handler(RequestValidationError, _validation_error)
    app.add_exception_handler(HTTPException, _http_exception)


def _domain_handler(type_: ProblemType) -> Any:
    async def handle(request: Request, error: Exception) -> Response:
        if isinstance(error, DHError):
            return problem_response(request, type_, error.problems)
        pointer = getattr(error, "pointer", "")
        retry = getattr(error, "retry_after", None)
        headers = {} if retry is None else {"Retry-After": str(math.ceil(retry))}
        return problem_response(request, type_, [Problem(pointer, str(error))], headers)

    return handle


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
    if status is HTTPStatus.REQUEST_ENTITY_TOO_LARGE:
        message = "the body is larger than this endpoint takes; send it in parts"
        return problem_response(request, TOO_LARGE, [Problem("", message)])
    details = {
        HTTPStatus.NOT_FOUND: f"there is nothing at {request.url.path[:100]}; GET / lists the"
        " endpoints",
        HTTPStatus.METHOD_NOT_ALLOWED: f"{request.method} is not possible at"
        f" {request.url.path[:100]}",
    }
    slug = status.phrase.lower().replace(" ", "-").replace("'", "")
    type_ = ProblemType(slug, status.value, status.phrase)
    detail = details.get(status, str(error.detail))
    return problem_response(request, type_, [Problem("", detail)], error.headers)
