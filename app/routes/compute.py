"""The computations: each as POST and GET on a stored robot, and as POST with the robot inline."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import msgspec
from fastapi import FastAPI, Request, Response
from fastapi.responses import StreamingResponse
from starlette.routing import Match, Route
from starlette.types import Scope

from app.admission.memory import SMALL_BODY, AdmittedResponse, Reservation
from app.admission.need import body_need
from app.admission.thread_pool import Admission, while_connected
from app.dependencies import Services, services_of
from app.fields.doubts import RequestDoubts
from app.fields.field import Reading
from app.http.bodies import read_body
from app.http.compression import compressed, needs_coding
from app.http.csv_table import CsvForm
from app.http.handlers import domain_problem
from app.http.language import language_headers, language_of
from app.http.negotiation import (
    CSV,
    JSON,
    LATEX,
    NDJSON,
    NPY,
    SVG,
    TEXT,
    require_type,
    wanted_type,
)
from app.http.npy import decode_npy
from app.http.query import check_query, csv_form_of, digits_of, units_of, with_status
from app.http.responses import json_lines, respond, told_in_header
from app.http.strict_json import MAX_FIELD, check_fields, decode_json, refuse_doubled_keys
from app.http.text import render_text
from app.http.units import Units
from app.operations.operation import PICTURES, Answer, Context, Operation, Runs
from app.pictures.png import png_of
from app.settings import Settings
from app.sheets.latex import tabular
from kinematics.errors import OutOfTime
from robots.robot import Robot
from robots.stored_robot import StoredRobot

PLAIN = Units()
EMPTY: Mapping[str, str] = MappingProxyType({})
INLINE_BYTES = 4_000
"""Bodies above this are read in a thread, so that they do not delay other requests."""
TRIED = "denavit.tried"
"""Entry of the scope of a request of which it is known that it takes longer than microseconds."""
TARGET_BYTES = 1_000
"""Room for one of many targets."""


def add_routes(
    app: FastAPI, operations: Iterable[Operation], max_body: int
) -> dict[str, Computation]:
    """Add the routes of computations.

    They are plain Starlette routes, first in the list: a solve takes 20 µs, which would be lost
    behind FastAPI's resolution of dependencies. ``app.openapi`` adds what the documents say.

    Args:
        app: The application.
        operations: The computations.
        max_body: Largest body in bytes.

    Returns:
        What answers each computation, by its name.
    """
    found = {operation.name: Computation(operation, max_body) for operation in operations}
    for operation in operations:
        handlers = found[operation.name]
        path = f"/v1/robots/{{robot_id}}/{operation.name}"
        app.router.routes += [
            ByEnding(path, handlers.post, methods=["POST"]),
            ByEnding(path, handlers.get, methods=["GET"]),
            ByEnding(f"/v1/{operation.name}", handlers.inline, methods=["POST"]),
        ]
    return found


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


class Computation:
    """The three forms of one computation.

    Args:
        operation: What it is.
        max_body: Largest body in bytes.
    """

    def __init__(self, operation: Operation, max_body: int) -> None:
        self.operation = operation
        self.form = operation.form
        self.max_body = max_body
        self.bodies = (JSON, NPY) if operation.npy_field else (JSON,)
        self.batches = {name for name, field in self.form.fields.items() if field.large}

    async def post(self, request: Request) -> Response:
        """Compute on a stored robot, from a JSON or npy body."""
        services = await services_of(request)
        stored = await services.robot(request.path_params["robot_id"], request)
        kind = require_type(request, *self.bodies)
        asking = self._asking(request, stored, services.settings, kind == NPY)
        body = await read_body(request, self.max_body)
        if kind == NPY:
            return await self._answer(
                request, asking, len(body), lambda: self._npy(body, asking.query, asking.reading)
            )
        return await self._answer(
            request, asking, len(body), lambda: self._json(body, services.settings)
        )

    async def get(self, request: Request) -> Response:
        """Compute on a stored robot, from a query."""
        services = await services_of(request)
        stored = await services.robot(request.path_params["robot_id"], request)
        asking = self._asking(request, stored, services.settings, True)
        decoded = self.form.from_query(asking.query, asking.reading)
        size = len(request.scope["query_string"])
        return await self._answer(request, asking, size, lambda: decoded)

    def at_once(
        self, request: Request, stored: StoredRobot, services: Services, body: bytes | None
    ) -> Response | None:
        """Return the answer of :meth:`post` or :meth:`get` if it takes microseconds, else None.

        Args:
            request: The request, of which only the head is read.
            stored: The robot.
            services: Those of the application.
            body: A JSON body; None: a query.

        Raises:
            RequestProblem: What is asked cannot be read.
            KinematicsError: It does not fit.
        """
        asking = self._asking(request, stored, services.settings, body is None)
        if asking.wanted == NDJSON or needs_coding(request):
            return None
        decoded = (
            self.form.from_query(asking.query, asking.reading)
            if body is None
            else self._json(body, services.settings)
        )
        form = _form_of(request, asking.wanted)
        asked = self.form.resolved(decoded, asking.reading)
        response = self._short(asked, form, _context(request, asking, services))
        if response is None:
            request.scope[TRIED] = True
        return response

    def _asking(
        self, request: Request, stored: StoredRobot, settings: Settings, by_query: bool
    ) -> _Asking:
        """Return what the head says; ``by_query``: fields of the request are in the query."""
        units, query = PLAIN, EMPTY
        if by_query or request.scope["query_string"]:
            more = self.form.parameters if by_query else ()
            check_query(request, *more, common=self.operation.parameters)
            units, query = units_of(request), request.query_params
        wanted = wanted_type(request, *self.operation.forms)
        reading = _reading(stored.robot, units, settings, stored.robot.doubts)
        return _Asking(reading, wanted, query)

    def _short(self, asked: msgspec.Struct, form: _Form, context: Context) -> Response | None:
        """Return the answer of a request if it takes microseconds, else None."""
        robot = context.doubts.robot
        answer = self.operation.run_at_once(robot, asked, context)
        return None if answer is None else _written(answer, form, context, short=True)

    async def inline(self, request: Request) -> Response:
        """Compute on a robot in the body."""
        services = await services_of(request)
        require_type(request, JSON)
        check_query(request, common=self.operation.parameters)
        units, wanted = units_of(request), wanted_type(request, *self.operation.forms)
        body = await read_body(request, self.max_body)
        if len(body) > INLINE_BYTES:
            reservation = services.memory.reservation(len(body))
            try:
                await reservation.grow(body_need(len(body)))
                decoded = await services.computed(
                    lambda: self._with_robot(body, services.settings), request
                )
            finally:
                reservation.end()
        else:
            decoded = self._with_robot(body, services.settings)
        robot, told = await services.inline_robot(decoded.robot, request)
        reading = _reading(robot, units, services.settings, told)
        asking = _Asking(reading, wanted, request.query_params)
        return await self._answer(request, asking, len(body), lambda: decoded)

    def _json(self, body: bytes, settings: Settings) -> msgspec.Struct:
        if len(body) > MAX_FIELD:
            check_fields(body, self._most_bytes(settings))
        decoded = self.form.from_json(body)
        refuse_doubled_keys(body)
        return decoded

    def _npy(self, body: bytes, query: Mapping[str, str], reading: Reading) -> msgspec.Struct:
        assert self.operation.npy_field is not None
        array = decode_npy(body)
        return self.form.from_npy(self.operation.npy_field, array, query, reading)

    def _with_robot(self, body: bytes, settings: Settings) -> Any:
        if len(body) > MAX_FIELD:
            check_fields(body, self._most_bytes(settings) | {"robot": settings.max_document_bytes})
        decoded: Any = decode_json(body, self.form.inline)
        robot = bytes(decoded.robot)
        # A robot is looked at by itself, once for many requests.
        refuse_doubled_keys(body.replace(robot, b"0", 1) if robot[:1] == b"{" else body)
        return decoded

    def _most_bytes(self, settings: Settings) -> dict[str, int]:
        """Return the bytes of the fields that may hold batches."""
        most = dict.fromkeys(self.batches, settings.max_compute_bytes)
        return most | {"targets": settings.max_ik_batch * TARGET_BYTES}

    async def _answer(
        self,
        request: Request,
        asking: _Asking,
        size: int,
        decode: Callable[[], msgspec.Struct],
    ) -> Response:
        """Run the computation where it belongs, and write its answer."""
        services = await services_of(request)
        form, context = _form_of(request, asking.wanted), _context(request, asking, services)

        def read() -> msgspec.Struct:
            asked: msgspec.Struct = self.form.resolved(decode(), asking.reading)
            return asked

        work = _Work(request, services, self.operation, asking.reading.robot, context, form)
        if size > INLINE_BYTES:
            return await work.answered(read, size)
        asked = read()
        if asking.wanted != NDJSON and TRIED not in request.scope:
            response = self._short(asked, form, context)
            if response is not None:
                return compressed(response, request)
        return await work.answered(lambda: asked, 0)


def _reading(robot: Robot, units: Units, settings: Settings, told: tuple[str, ...]) -> Reading:
    """Return what a request is read with; ``told`` is what its answer says of the robot."""
    return Reading(robot, units, settings, RequestDoubts(robot, units, told), {})


def _context(request: Request, asking: _Asking, services: Services) -> Context:
    reading = asking.reading
    return Context(
        reading.units,
        reading.settings,
        reading.doubts,
        asking.wanted,
        services.symbolic,
        services.programs,
        language_of(request),
    )


@dataclass(frozen=True, slots=True)
class _Form:
    """The form of an answer.

    Attributes:
        type: Its media type.
        digits: Decimals of numbers in text and LaTeX; None: their own choice.
        table: How CSV is written; None for other forms.
        statuses: Whether npy comes with the status of each row.
    """

    type: str
    digits: int | None = None
    table: CsvForm | None = None
    statuses: bool = False


@dataclass(frozen=True, slots=True)
class _Asking:
    """What the head of a request says.

    Attributes:
        reading: With what its fields are read.
        wanted: Media type of the answer.
        query: Its query, whose names have been checked.
    """

    reading: Reading
    wanted: str
    query: Mapping[str, str]


def _form_of(request: Request, wanted: str) -> _Form:
    if not request.scope["query_string"]:
        return _Form(wanted)
    digits = digits_of(request, wanted)
    table = csv_form_of(request, wanted, digits)
    return _Form(wanted, digits, table, with_status(request, wanted))


def _written(answer: Answer, form: _Form, context: Context, *, short: bool = False) -> Response:
    """Return an answer in the wanted form."""
    wanted, spoken = form.type, context.language
    if wanted in PICTURES and answer.picture is not None:
        told = {**(answer.headers or {}), **told_in_header(context.warnings, spoken)}
        drawn = answer.picture()
        return Response(drawn if wanted == SVG else png_of(drawn), headers=told, media_type=wanted)
    if answer.listing is not None and wanted != JSON:
        told = told_in_header(context.warnings, spoken)
        listing = spoken.text(answer.listing)
        if wanted == TEXT and told:
            warnings = {"warnings": spoken.told(context.warnings)}
            listing += render_text(warnings, None, spoken)
        told = language_headers(spoken, told)
        return Response(listing, headers=told, media_type=f"{wanted}; charset=utf-8")
    if wanted == LATEX:
        told = {**(answer.headers or {}), **told_in_header(context.warnings, spoken)}
        return Response(_latex(answer, form), headers=told, media_type=f"{wanted}; charset=utf-8")
    return respond(
        answer.text if wanted == TEXT and answer.text is not None else answer.payload,
        wanted,
        spoken,
        array=answer.records() if form.statuses and answer.records else answer.array,
        sheet=answer.sheet() if wanted == CSV and answer.sheet is not None else None,
        headers=answer.headers,
        short=short,
        digits=form.digits,
        table=form.table,
    )


def _latex(answer: Answer, form: _Form) -> str:
    """What LaTeX holds: matrices, or the table."""
    if answer.latex is not None:
        return answer.latex(form.digits)
    assert answer.sheet is not None
    return tabular(answer.sheet(), form.digits, answer.payload.get("warnings", ()))


@dataclass(frozen=True, slots=True)
class _Work:
    """A computation that takes a thread, and its memory."""

    request: Request
    services: Services
    operation: Operation
    robot: Robot
    context: Context
    form: _Form

    async def answered(self, read: Callable[[], msgspec.Struct], size: int) -> Response:
        """Return the answer, once there is memory for it; a large one stays admitted until sent.

        Args:
            read: Gives the request.
            size: Bytes from which it is read, in a thread; 0 where it has been.
        """
        services, streamed = self.services, self.form.type == NDJSON
        apart = self.operation.runs is Runs.PROCESS and not streamed
        pool = services.out_of_process if apart else services.compute
        admission = pool.enter(services.settings.max_request_seconds)
        reservation = services.memory.reservation(size)
        try:
            async with while_connected(self.request, admission):
                if size:
                    await reservation.grow(body_need(size))
                    asked = await admission.run(read)
                else:
                    asked = read()
                need = self.operation.memory(self.robot, asked, self.context)
                await reservation.grow(need)
                if streamed:
                    return await self._streamed(asked, admission, reservation)
                response = await admission.run(lambda: self._written(asked))
        except BaseException:
            reservation.end()
            admission.leave()
            raise
        length = int(response.headers.get("content-length", 0))
        if length > SMALL_BODY:
            return AdmittedResponse(response, admission, reservation, length)
        reservation.end()
        admission.leave()
        return response

    def _written(self, asked: msgspec.Struct) -> Response:
        answer = self.operation.run(self.robot, asked, self.context)
        return compressed(_written(answer, self.form, self.context), self.request)

    async def _streamed(
        self, asked: msgspec.Struct, admission: Admission, reservation: Reservation
    ) -> Response:
        """Lines as they are computed; the work stops where the client goes away."""
        assert self.operation.stream is not None
        parts, spoken = (
            self.operation.stream(self.robot, asked, self.context),
            self.context.language,
        )

        def following() -> bytes:
            return json_lines(next(parts, ()), spoken)

        # The first part before the status line: what is wrong with the request shows there.
        part = await admission.run(following)

        async def body() -> AsyncIterator[bytes]:
            line = part
            while line:
                yield line
                try:
                    line = await admission.run(following)
                except OutOfTime as error:
                    # The status is sent already: the last line tells, in the place of the verdict.
                    told = bytes(domain_problem(self.request, error).body)
                    yield b'{"problem":%b}\n' % told
                    return

        # Its place and its memory are taken to the end. A reverse proxy that gathers answers must
        # not gather this one.
        told = told_in_header(self.context.warnings, spoken)
        headers = language_headers(spoken, {"X-Accel-Buffering": "no", **told})
        lines = StreamingResponse(body(), media_type=NDJSON, headers=headers)
        return AdmittedResponse(lines, admission, reservation, reservation.size)
