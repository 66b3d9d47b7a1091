"""The computations: each as POST and GET on a stored robot, and as POST with the robot inline."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

import msgspec
from fastapi import FastAPI, Request, Response
from fastapi.responses import StreamingResponse
from starlette._utils import get_route_path
from starlette.routing import BaseRoute, Match, Route
from starlette.types import Receive, Scope, Send

from app.admission.memory import SMALL_BODY, AdmittedResponse, Reservation
from app.admission.need import body_need
from app.admission.thread_pool import Admission, while_connected
from app.dependencies import Services, services_of
from app.fields.doubts import RequestDoubts
from app.fields.field import Reading
from app.fields.lengths import in_metres
from app.http.bodies import read_body
from app.http.compression import compressed
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
from app.http.responses import json_head, json_lines, json_of, respond, told_in_header
from app.http.strict_json import MAX_FIELD, check_fields, decode_json, refuse_doubled_keys
from app.http.text import render_text
from app.http.units import Units
from app.operations.operation import PICTURES, Answer, Context, Operation, Runs
from app.pictures.png import png_of
from app.settings import Settings
from app.sheets.latex import tabular
from app.telemetry.tracing import asked_for
from dh_to_urdf.languages import Language
from kinematics.errors import OutOfTime
from robots.robot import Robot
from robots.stored_robot import StoredRobot

PLAIN = Units()
EMPTY: Mapping[str, str] = MappingProxyType({})
INLINE_BYTES = 4_000
"""Bodies above this are read in a thread, so that they do not delay other requests."""
ON_ROBOT = "/v1/robots/{robot_id}/"
"""Beginning of the paths of computations on stored robots."""
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
    routes: list[Route] = []
    for name, handlers in found.items():
        routes += [
            Route(f"{ON_ROBOT}{name}", handlers.post, methods=["POST"]),
            Route(f"{ON_ROBOT}{name}", handlers.get, methods=["GET"]),
            Route(f"/v1/{name}", handlers.inline, methods=["POST"]),
        ]
    # Who traces asks the routes for the template of a path, one after the other.
    app.router.routes += routes if asked_for() else [ByName(routes), *routes]
    return found


class ByName(BaseRoute):
    """Finds the route of a computation by the end of its path, however many there are.

    There are some eighty, and Starlette asks one after the other. A path or a method that is not
    found here is looked for among all routes, which say what is wrong with it.

    Args:
        routes: Those of the computations.
    """

    def __init__(self, routes: Iterable[Route]) -> None:
        self._routes = {
            (method, route.path.removeprefix(ON_ROBOT), route.path.startswith(ON_ROBOT)): route
            for route in routes
            for method in route.methods or ()
        }

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """The route of a computation, its endpoint and the robot, where the path is that of one."""
        if scope["type"] != "http":
            return Match.NONE, {}
        path = get_route_path(scope)
        # /v1/robots/{id}/{name}; names of some computations have a slash of their own.
        parts = path.split("/", 4)
        stored = len(parts) == 5 and parts[2] == "robots" and parts[1] == "v1" and not parts[0]
        name, params = (parts[4], {"robot_id": parts[3]}) if stored else (path, {})
        route = self._routes.get((scope["method"], name, stored))
        if route is None or (stored and not parts[3]):
            return Match.NONE, {}
        given = {**scope.get("path_params", {}), **params}
        return Match.FULL, {"route": route, "endpoint": route.endpoint, "path_params": given}

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes the request on to the route that was found."""
        await scope["route"].handle(scope, receive, send)


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
        terms = self.terms(request, by_query=kind == NPY)
        reading = _reading(stored, terms, services.settings)
        body = await read_body(request, self.max_body)
        if kind == NPY:
            return await self._answer(
                request, terms, reading, len(body), lambda: self._npy(body, terms.query, reading)
            )
        return await self._answer(
            request,
            terms,
            reading,
            len(body),
            lambda: self._json(body, services.settings, terms.units),
        )

    async def get(self, request: Request) -> Response:
        """Compute on a stored robot, from a query."""
        services = await services_of(request)
        stored = await services.robot(request.path_params["robot_id"], request)
        terms = self.terms(request, by_query=True)
        reading = _reading(stored, terms, services.settings)
        decoded = self.form.from_query(terms.query, reading)
        size = len(request.scope["query_string"])
        return await self._answer(request, terms, reading, size, lambda: decoded)

    def terms(self, request: Request, *, by_query: bool) -> Terms:
        """Return what the head of a request asks for, whatever its robot and its body.

        Args:
            request: The request, of which only the head is read.
            by_query: Whether fields of the request are in the query.

        Raises:
            RequestProblem: A parameter is unknown, stands twice, or cannot be read.
        """
        units, query = PLAIN, EMPTY
        if by_query or request.scope["query_string"]:
            more = self.form.parameters if by_query else ()
            check_query(request, *more, common=self.operation.parameters)
            units, query = units_of(request, lengths=True), request.query_params
        wanted = wanted_type(request, *self.operation.forms)
        return Terms(units, query, wanted, language_of(request))

    def at_once(
        self,
        terms: Terms,
        form: Form,
        stored: StoredRobot,
        services: Services,
        body: bytes | None,
    ) -> Written | None:
        """Return the answer of :meth:`post` or :meth:`get` if it takes microseconds, else None.

        Args:
            terms: What its head asks for.
            form: That of its answer.
            stored: The robot.
            services: Those of the application.
            body: A JSON body; None: a query.

        Raises:
            RequestProblem: What is asked cannot be read.
            KinematicsError: It does not fit.
        """
        reading = _reading(stored, terms, services.settings)
        of_one_q = None if body is None else self.form.from_one_q(body, reading)
        if of_one_q is not None:
            asked = _Asked(stored.robot, of_one_q, _context(terms, reading, services))
        elif body is None:
            decoded = self.form.from_query(terms.query, reading)
            asked = self._asked(terms, reading, services, decoded)
        else:
            decoded = self._json(body, services.settings, terms.units)
            asked = self._asked(terms, reading, services, decoded)
        answer = self.operation.run_at_once(asked.robot, asked.request, asked.context)
        if answer is None:
            return None
        if form.type == JSON and answer.headers is None:
            return Written(json_head(terms.language), json_of(answer.payload, terms.language))
        response = _written(answer, form, asked.context, short=True)
        if type(response) is not Response:
            return None
        head = tuple(one for one in response.raw_headers if one[0] != b"content-length")
        return Written(head, bytes(response.body))

    def _asked(
        self, terms: Terms, reading: Reading, services: Services, decoded: msgspec.Struct
    ) -> _Asked:
        """Return what is asked, with every value in the units of ``kinematics``."""
        reading = self.form.installed(decoded, reading)
        request = self.form.resolved(decoded, reading)
        return _Asked(reading.robot, request, _context(terms, reading, services))

    def _short(self, asked: _Asked, form: Form) -> Response | None:
        """Return the answer of a request if it takes microseconds, else None."""
        answer = self.operation.run_at_once(asked.robot, asked.request, asked.context)
        return None if answer is None else _written(answer, form, asked.context, short=True)

    async def inline(self, request: Request) -> Response:
        """Compute on a robot in the body."""
        services = await services_of(request)
        require_type(request, JSON)
        check_query(request, common=self.operation.parameters)
        units, wanted = units_of(request, lengths=True), wanted_type(request, *self.operation.forms)
        body = await read_body(request, self.max_body)
        if len(body) > INLINE_BYTES:
            reservation = services.memory.reservation(len(body))
            try:
                await reservation.grow(body_need(len(body)))
                decoded = await services.computed(
                    lambda: self._with_robot(body, services.settings, units), request
                )
            finally:
                reservation.end()
        else:
            decoded = self._with_robot(body, services.settings, units)
        robot, told = await services.inline_robot(decoded.robot, request)
        reading = Reading(robot, units, services.settings, RequestDoubts(robot, units, told), {})
        terms = Terms(units, request.query_params, wanted, language_of(request))
        return await self._answer(request, terms, reading, len(body), lambda: decoded)

    def _json(self, body: bytes, settings: Settings, units: Units) -> msgspec.Struct:
        if len(body) > MAX_FIELD:
            check_fields(body, self._most_bytes(settings))
        decoded = self.form.from_json(body, units)
        refuse_doubled_keys(body)
        return decoded

    def _npy(self, body: bytes, query: Mapping[str, str], reading: Reading) -> msgspec.Struct:
        assert self.operation.npy_field is not None
        array = decode_npy(body)
        return self.form.from_npy(self.operation.npy_field, array, query, reading)

    def _with_robot(self, body: bytes, settings: Settings, units: Units) -> Any:
        if len(body) > MAX_FIELD:
            check_fields(body, self._most_bytes(settings) | {"robot": settings.max_document_bytes})
        scaled = in_metres(body, self.form.inline) if units.millimetres else body
        decoded: Any = decode_json(scaled, self.form.inline)
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
        terms: Terms,
        reading: Reading,
        size: int,
        decode: Callable[[], msgspec.Struct],
    ) -> Response:
        """Run the computation where it belongs, and write its answer."""
        services = await services_of(request)
        form = form_of(request, terms.wanted)

        def read() -> _Asked:
            return self._asked(terms, reading, services, decode())

        work = _Work(request, services, self.operation, form)
        if size > INLINE_BYTES:
            return await work.answered(read, size)
        asked = read()
        if terms.wanted != NDJSON and TRIED not in request.scope:
            response = self._short(asked, form)
            if response is not None:
                return compressed(response, request)
        return await work.answered(lambda: asked, 0)


@dataclass(frozen=True, slots=True)
class Terms:
    """What the head of a request asks for.

    Attributes:
        units: Of the request and its answer.
        query: Its query, whose names have been checked.
        wanted: Media type of the answer.
        language: What the answer is written in.
    """

    units: Units
    query: Mapping[str, str]
    wanted: str
    language: Language


@dataclass(frozen=True, slots=True)
class _Asked:
    """What is computed.

    Attributes:
        robot: As the request has it installed.
        request: In the units of ``kinematics``.
        context: What the computation knows besides.
    """

    robot: Robot
    request: Any
    context: Context


@dataclass(frozen=True, slots=True)
class Form:
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


class Written(NamedTuple):
    """An answer with status 200, as it is sent.

    Attributes:
        head: Its headers but for its length.
        body: Its body.
    """

    head: tuple[tuple[bytes, bytes], ...]
    body: bytes


def form_of(request: Request, wanted: str) -> Form:
    """Return the form of an answer of the wanted type.

    Raises:
        RequestProblem: A parameter of the form cannot be read, or does not fit the type.
    """
    if not request.scope["query_string"]:
        return Form(wanted)
    digits = digits_of(request, wanted)
    table = csv_form_of(request, wanted, digits)
    return Form(wanted, digits, table, with_status(request, wanted))


def _reading(stored: StoredRobot, terms: Terms, settings: Settings) -> Reading:
    """Return what a request about a stored robot is read with."""
    robot, units = stored.robot, terms.units
    return Reading(robot, units, settings, RequestDoubts(robot, units, robot.doubts), {})


def _context(terms: Terms, reading: Reading, services: Services) -> Context:
    return Context(
        reading.units,
        reading.settings,
        reading.doubts,
        terms.wanted,
        services.symbolic,
        services.programs,
        terms.language,
    )


def _written(answer: Answer, form: Form, context: Context, *, short: bool = False) -> Response:
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


def _latex(answer: Answer, form: Form) -> str:
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
    form: Form

    async def answered(self, read: Callable[[], _Asked], size: int) -> Response:
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
                need = self.operation.memory(asked.robot, asked.request, asked.context)
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

    def _written(self, asked: _Asked) -> Response:
        answer = self.operation.run(asked.robot, asked.request, asked.context)
        return compressed(_written(answer, self.form, asked.context), self.request)

    async def _streamed(
        self, asked: _Asked, admission: Admission, reservation: Reservation
    ) -> Response:
        """Lines as they are computed; the work stops where the client goes away."""
        assert self.operation.stream is not None
        parts, spoken = (
            self.operation.stream(asked.robot, asked.request, asked.context),
            asked.context.language,
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
        told = told_in_header(asked.context.warnings, spoken)
        headers = language_headers(spoken, {"X-Accel-Buffering": "no", **told})
        lines = StreamingResponse(body(), media_type=NDJSON, headers=headers)
        return AdmittedResponse(lines, admission, reservation, reservation.size)
