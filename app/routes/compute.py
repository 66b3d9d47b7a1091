"""The computations: each as POST and GET on a stored robot, and as POST with the robot inline."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

import msgspec
import numpy as np
from fastapi import FastAPI, Request, Response
from fastapi.responses import StreamingResponse

from app.dependencies import Services, services_of
from app.openapi import inline_request_type
from app.operations import OPERATIONS, Answer, Operation
from app.operations.base import Context
from app.pictures.png import png_of
from app.problems import INVALID_REQUEST, RequestProblem
from app.query import body_from_query, check_query, units_of
from app.units import Units
from app.wire import (
    JSON,
    NDJSON,
    NPY,
    PNG,
    SVG,
    decode_json,
    decode_npy,
    json_lines,
    read_body,
    require_type,
    respond,
    wanted_type,
)
from robots.robot import Robot

PLAIN = Units()
INLINE_BYTES = 4_000
"""Bodies above this are read in a thread, so that they do not delay other requests."""


def add_routes(app: FastAPI, max_body: int) -> None:
    """Adds the routes of all computations.

    They are plain Starlette routes, first in the list: a solve takes 20 µs, which would be lost
    behind FastAPI's resolution of dependencies. ``app.openapi`` adds what the docs say of them.

    Args:
        app: The application.
        max_body: Largest body in bytes.
    """
    for operation in OPERATIONS:
        handlers = _Handlers(operation, max_body)
        path = f"/v1/robots/{{robot_id}}/{operation.name}"
        app.add_route(path, handlers.post, ["POST"])
        app.add_route(path, handlers.get, ["GET"])
        app.add_route(f"/v1/{operation.name}", handlers.inline, ["POST"])


class _Handlers:
    """The three forms of one computation."""

    def __init__(self, operation: Operation, max_body: int) -> None:
        self.operation = operation
        self.max_body = max_body
        self.inline_type = inline_request_type(operation)
        self.offers = operation.offers

    async def post(self, request: Request) -> Response:
        """On a stored robot, from a JSON or npy body."""
        operation, services = self.operation, await services_of(request)
        stored = await services.robot(request.path_params["robot_id"])
        kind = require_type(request, *((JSON, NPY) if operation.array_field else (JSON,)))
        units, parameters = PLAIN, b"{}"
        if request.scope["query_string"]:
            check_query(request, *(operation.query if kind == NPY else ()))
            units = units_of(request)
            if kind == NPY:
                parameters = body_from_query(request, units, stored.robot, operation.query)
        wanted = wanted_type(request, *self.offers)
        body = await read_body(request, self.max_body)
        decode = _npy_decoder if kind == NPY else _json_decoder
        return await _answer(
            services, operation, stored.robot, units, wanted, len(body),
            lambda: decode(operation, body, parameters),
        )  # fmt: skip

    async def get(self, request: Request) -> Response:
        """On a stored robot, from a query."""
        operation, services = self.operation, await services_of(request)
        stored = await services.robot(request.path_params["robot_id"])
        check_query(request, *operation.query)
        units, wanted = units_of(request), wanted_type(request, *self.offers)
        body = body_from_query(request, units, stored.robot, operation.query)
        return await _answer(
            services, operation, stored.robot, units, wanted, len(body),
            lambda: decode_json(body, operation.request),
        )  # fmt: skip

    async def inline(self, request: Request) -> Response:
        """On a robot in the body."""
        operation, services = self.operation, await services_of(request)
        require_type(request, JSON)
        check_query(request)
        units, wanted = units_of(request), wanted_type(request, *self.offers)
        body = await read_body(request, self.max_body)
        if len(body) > INLINE_BYTES:
            parsed = await services.computed(lambda: decode_json(body, self.inline_type))
        else:
            parsed = decode_json(body, self.inline_type)
        robot = await services.inline_robot(parsed.robot)  # type: ignore[attr-defined]
        return await _answer(services, operation, robot, units, wanted, len(body), lambda: parsed)


async def _answer(
    services: Services,
    operation: Operation,
    robot: Robot,
    units: Units,
    wanted: str,
    size: int,
    read: Any,
) -> Response:
    context = Context(units, services.settings, wanted, services.symbolic)

    def written(answer: Answer) -> Response:
        if answer.picture is not None and wanted == SVG:
            return Response(answer.picture(), headers=answer.headers, media_type=SVG)
        if answer.picture is not None and wanted == PNG:
            return Response(png_of(answer.picture()), headers=answer.headers, media_type=PNG)
        if answer.listing is not None and wanted != JSON:
            return Response(answer.listing, media_type=f"{wanted}; charset=utf-8")
        return respond(
            answer.payload,
            wanted,
            array=answer.array,
            rows=answer.rows,
            headers=answer.headers,
        )

    def compute(request: msgspec.Struct) -> Response:
        return written(operation.run(robot, request, context))

    if wanted == NDJSON:
        return await _streamed(services, operation, robot, context, read)
    if operation.apart:
        return await services.waited(lambda: compute(read()))
    if size > INLINE_BYTES:
        return await services.computed(lambda: compute(read()))
    request = read()
    answer = operation.run_quickly(robot, request, context)
    if answer is not None:
        return written(answer)
    return await services.computed(lambda: compute(request))


async def _streamed(
    services: Services, operation: Operation, robot: Robot, context: Context, read: Any
) -> Response:
    """Lines as they are computed; the work stops where the client goes away."""
    assert operation.stream is not None
    request = await services.computed(read)
    parts = operation.stream(robot, request, context)

    def following() -> bytes:
        return json_lines(next(parts, ()))

    # The first part before the status line: what is wrong with the request shows there.
    part = await services.computed(following)

    async def body() -> AsyncIterator[bytes]:
        line = part
        while line:
            yield line
            line = await services.computed(following)

    return StreamingResponse(body(), media_type=NDJSON)


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
