"""The computations: each as POST and GET on a stored robot, and as POST with the robot inline."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from typing import Any

import msgspec
import numpy as np
from fastapi import FastAPI, Request, Response
from fastapi.responses import StreamingResponse
from starlette.routing import Match, Route
from starlette.types import Scope

from app.admission.buffers import SMALL_BODY, AdmittedResponse
from app.admission.thread_pool import ThreadPool, while_connected
from app.dependencies import Services, services_of
from app.http.bodies import read_body
from app.http.handlers import domain_problem
from app.http.negotiation import JSON, NDJSON, NPY, PNG, SVG, require_type, wanted_type
from app.http.npy import decode_npy
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import body_from_query, check_query, units_of
from app.http.responses import json_lines, respond
from app.http.strict_json import (
    MAX_FIELD,
    check_fields,
    decode_json,
    refuse_doubled_keys,
)
from app.http.units import Units
from app.openapi.document import inline_request_type
from app.operations import OPERATIONS, Answer, Operation
from app.operations.base import Context
from app.pictures.png import png_of
from app.settings import Settings
from kinematics.errors import OutOfTime
from robots.robot import Robot

PLAIN = Units()
INLINE_BYTES = 4_000
"""Bodies above this are read in a thread, so that they do not delay other requests."""
BATCHES = ("q", "qd", "tau", "twist", "wrench")
"""Fields of rows of numbers, which are read piece by piece."""
TARGET_BYTES = 1_000
"""Room for one of many targets."""


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
        app.router.routes += [
            ByEnding(path, handlers.post, methods=["POST"]),
            ByEnding(path, handlers.get, methods=["GET"]),
            ByEnding(f"/v1/{operation.name}", handlers.inline, methods=["POST"]),
        ]


class ByEnding(Route):
    """A route that looks at the end of a path first.

    There are some eighty, and each request asks one after the other: this takes a quarter of the
    time of a regular expression.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], *, methods: list[str]) -> None:
        super().__init__(path, endpoint, methods=methods)
        self.ending = path[path.rindex("/") :]

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """What Starlette's route says, where the ending fits."""
        if not scope["path"].endswith(self.ending):
            return Match.NONE, {}
        return super().matches(scope)


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
            request, services, operation, stored.robot, units, wanted, len(body),
            lambda: decode(operation, body, parameters, services.settings),
        )  # fmt: skip

    async def get(self, request: Request) -> Response:
        """On a stored robot, from a query."""
        operation, services = self.operation, await services_of(request)
        stored = await services.robot(request.path_params["robot_id"])
        check_query(request, *operation.query)
        units, wanted = units_of(request), wanted_type(request, *self.offers)
        body = body_from_query(request, units, stored.robot, operation.query)
        return await _answer(
            request, services, operation, stored.robot, units, wanted, len(body),
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
            parsed = await services.computed(lambda: self._inline(body, services.settings), request)
        else:
            parsed = self._inline(body, services.settings)
        robot = await services.inline_robot(parsed.robot)
        return await _answer(
            request, services, operation, robot, units, wanted, len(body), lambda: parsed
        )

    def _inline(self, body: bytes, settings: Settings) -> Any:
        if len(body) > MAX_FIELD:
            limits = _most_bytes(settings) | {"robot": settings.max_document_bytes}
            check_fields(body, limits)
        parsed: Any = decode_json(body, self.inline_type)
        robot = bytes(parsed.robot)
        # A robot is looked at by itself, once for many requests.
        refuse_doubled_keys(body.replace(robot, b"0", 1) if robot[:1] == b"{" else body)
        return parsed


def _most_bytes(settings: Settings) -> dict[str, int]:
    """Bytes of the fields that hold batches."""
    batches = dict.fromkeys(BATCHES, settings.max_compute_bytes)
    return batches | {"targets": settings.max_ik_batch * TARGET_BYTES}


async def _answer(
    request: Request,
    services: Services,
    operation: Operation,
    robot: Robot,
    units: Units,
    wanted: str,
    size: int,
    read: Any,
) -> Response:
    context = Context(units, services.settings, wanted, services.symbolic)

    def written(answer: Answer, *, short: bool = False) -> Response:
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
            short=short,
        )

    def compute(asked: msgspec.Struct) -> Response:
        return written(operation.run(robot, asked, context))

    pool = services.out_of_process if operation.out_of_process else services.compute
    if wanted == NDJSON:
        return await _streamed(request, services, operation, robot, context, read)
    if operation.out_of_process or size > INLINE_BYTES:
        return await _computed(request, services, pool, lambda: compute(read()))
    asked = read()
    answer = operation.run_quickly(robot, asked, context)
    if answer is not None:
        return written(answer, short=True)
    return await _computed(request, services, pool, lambda: compute(asked))


async def _computed(
    request: Request, services: Services, pool: ThreadPool, call: Callable[[], Response]
) -> Response:
    """An answer from a thread; a large one stays admitted until it is sent."""
    services.buffers.check()
    admission = pool.enter(services.settings.max_request_seconds)
    try:
        async with while_connected(request, admission):
            response = await admission.run(call)
    except BaseException:
        admission.leave()
        raise
    size = int(response.headers.get("content-length", 0))
    if size > SMALL_BODY:
        return AdmittedResponse(response, admission, services.buffers, size)
    admission.leave()
    return response


async def _streamed(
    request: Request,
    services: Services,
    operation: Operation,
    robot: Robot,
    context: Context,
    read: Any,
) -> Response:
    """Lines as they are computed; the work stops where the client goes away."""
    assert operation.stream is not None
    stream = operation.stream
    admission = services.compute.enter(services.settings.max_request_seconds)

    def following() -> bytes:
        return json_lines(next(parts, ()))

    try:
        async with while_connected(request, admission):
            asked = await admission.run(read)
            parts = stream(robot, asked, context)
            # The first part before the status line: what is wrong with the request shows there.
            part = await admission.run(following)
    except BaseException:
        admission.leave()
        raise

    async def body() -> AsyncIterator[bytes]:
        line = part
        while line:
            yield line
            try:
                line = await admission.run(following)
            except OutOfTime as error:
                # The status is sent already: the last line tells, in the place of the verdict.
                yield b'{"problem":%b}\n' % bytes(domain_problem(request, error).body)
                return

    # Its lines are not kept, so they take no memory; but its place is taken to the end. A reverse
    # proxy that gathers answers must not gather this one.
    lines = StreamingResponse(body(), media_type=NDJSON, headers={"X-Accel-Buffering": "no"})
    return AdmittedResponse(lines, admission, services.buffers, 0)


def _json_decoder(
    operation: Operation,
    body: bytes,
    parameters: bytes,  # noqa: ARG001
    settings: Settings,
) -> msgspec.Struct:
    if len(body) > MAX_FIELD:
        check_fields(body, _most_bytes(settings))
    request = decode_json(body, operation.request)
    refuse_doubled_keys(body)
    return request


def _npy_decoder(
    operation: Operation,
    body: bytes,
    parameters: bytes,
    settings: Settings,  # noqa: ARG001
) -> msgspec.Struct:
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
