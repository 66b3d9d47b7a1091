"""The computations: each as POST and GET on a stored robot, and as POST with the robot inline."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
from fastapi import APIRouter, Request, Response

from app.dependencies import RobotDep, Services, ServicesDep
from app.openapi import inline_request_type, operation_docs
from app.operations import OPERATIONS, Answer, Operation
from app.operations.base import Context
from app.problems import INVALID_REQUEST, RequestProblem
from app.query import body_from_query, check_query, units_of
from app.units import Units
from app.wire import (
    JSON,
    NPY,
    TEXT,
    decode_json,
    decode_npy,
    read_body,
    require_type,
    respond,
    wanted_type,
)
from robots.robot import Robot

INLINE_BYTES = 4_000
"""Bodies above this are read in a thread, so that they do not delay other requests."""


def build_router(max_body: int) -> APIRouter:
    """Routes of all computations.

    Args:
        max_body: Largest body in bytes.
    """
    router = APIRouter(prefix="/v1", tags=["compute"])
    for operation in OPERATIONS:
        _add(router, operation, max_body)
    return router


def _add(router: APIRouter, operation: Operation, max_body: int) -> None:
    inline_type = inline_request_type(operation)
    offers = (JSON, TEXT, NPY)

    async def post(request: Request, stored: RobotDep, services: ServicesDep) -> Response:
        read = (JSON, NPY) if operation.array_field else (JSON,)
        kind = require_type(request, *read)
        check_query(request, *(operation.query if kind == NPY else ()))
        units, wanted = units_of(request), wanted_type(request, *offers)
        parameters = body_from_query(request, units, stored.robot) if kind == NPY else b"{}"
        body = await read_body(request, max_body)
        decode = _npy_decoder if kind == NPY else _json_decoder
        return await _answer(
            services, operation, stored.robot, units, wanted, len(body),
            lambda: decode(operation, body, parameters),
        )  # fmt: skip

    async def get(request: Request, stored: RobotDep, services: ServicesDep) -> Response:
        check_query(request, *operation.query)
        units, wanted = units_of(request), wanted_type(request, *offers)
        body = body_from_query(request, units, stored.robot)
        return await _answer(
            services, operation, stored.robot, units, wanted, len(body),
            lambda: decode_json(body, operation.request),
        )  # fmt: skip

    async def inline(request: Request, services: ServicesDep) -> Response:
        require_type(request, JSON)
        check_query(request)
        units, wanted = units_of(request), wanted_type(request, *offers)
        body = await read_body(request, max_body)
        if len(body) > INLINE_BYTES:
            parsed = await services.computed(lambda: decode_json(body, inline_type))
        else:
            parsed = decode_json(body, inline_type)
        robot = await services.inline_robot(parsed.robot)  # type: ignore[attr-defined]
        return await _answer(services, operation, robot, units, wanted, len(body), lambda: parsed)

    docs, name = operation_docs(operation), operation.name
    text = operation.description
    path = f"/robots/{{robot_id}}/{name}"
    router.post(path, description=text, **docs.post)(post)
    router.get(path, description=text, **docs.get)(get)
    router.post(f"/{name}", description=text, **docs.inline)(inline)


async def _answer(
    services: Services,
    operation: Operation,
    robot: Robot,
    units: Units,
    wanted: str,
    size: int,
    read: Any,
) -> Response:
    context = Context(units, services.settings)

    def written(answer: Answer) -> Response:
        return respond(answer.payload, wanted, array=answer.array, headers=answer.headers)

    def compute(request: msgspec.Struct) -> Response:
        return written(operation.run(robot, request, context))

    if size > INLINE_BYTES:
        return await services.computed(lambda: compute(read()))
    request = read()
    answer = operation.run_quickly(robot, request, context)
    if answer is not None:
        return written(answer)
    return await services.computed(lambda: compute(request))


def _json_decoder(operation: Operation, body: bytes, parameters: bytes) -> msgspec.Struct:  # noqa: ARG001
    return decode_json(body, operation.request)


def _npy_decoder(operation: Operation, body: bytes, parameters: bytes) -> msgspec.Struct:
    array = decode_npy(body)
    field = operation.array_field or "q"
    values = decode_json(parameters, dict[str, Any])
    if field in values:
        raise RequestProblem(
            INVALID_REQUEST, f"{field} is in the npy body and in the query", f"/{field}"
        )
    values[field] = []
    request = decode_json(msgspec.json.encode(values), operation.request)
    setattr(request, field, np.asarray(array))
    return request
