"""D-H tables out: of robots, of URDFs, of joint axes, and from one convention to another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fastapi import APIRouter, Request, Response

from app.dependencies import RobotDep, ServicesDep
from app.documents import (
    BINARY,
    DECODED_TYPES,
    SPREADSHEET_TYPES,
    XML_TYPES,
    memory_beside,
    robot_from_body,
)
from app.http.bodies import read_body
from app.http.csv_table import CsvForm
from app.http.language import language_headers, language_of
from app.http.negotiation import CSV, JSON, TEXT, YAML, require_type, wanted_type
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import (
    DECIMAL_TEXT,
    LANG_TEXT,
    check_query,
    csv_form_of,
    flag_of,
    number,
    units_of,
)
from app.http.responses import respond, told_in_header
from app.http.strict_json import decode_body
from app.http.units import Units
from app.openapi.answers import REF
from app.openapi.problems import PROBLEMS
from app.routes.robots import etag, not_modified
from dh_to_urdf import Convention, DHTable
from dh_to_urdf.documents.layouts import document, to_csv, to_text, to_yaml
from dh_to_urdf.documents.mapping import CONVENTION_ALIASES
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.axes_document import read_axes
from dh_to_urdf.extraction.conversion import to_convention
from dh_to_urdf.extraction.extract import MAX_SNAP, SNAP, Extraction, extract
from dh_to_urdf.languages import Language
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.writer import TABLE_TEXTS
from robots.chains import chain_of_robot, chain_of_urdf
from robots.robot import Robot

CHOICES = say("standard (distal, Paul), modified (proximal, Craig) or khalil (Khalil-Kleinfinger)")
FORM = ("format", "lang", "decimal")
EXTRACTION = ("snap", "explain", "positive_a")
WRITERS = {form.media_type: form for form in TABLE_TEXTS.values()}
OFFERS = (JSON, TEXT, YAML, CSV, *WRITERS)

_AXES_EXAMPLE = {
    "name": "two_r",
    "convention": "standard",
    "joints": [
        {"name": "j1", "type": "revolute", "point": [0, 0, 0.1], "direction": [0, 0, 1]},
        {
            "name": "j2",
            "type": "revolute",
            "point": [0.4, 0, 0.3],
            "direction": [0, 1, 0],
            "limits": {"lower": -2, "upper": 2},
        },
    ],
    "tip": {"xyz": [0.9, 0, 0.3], "rpy": [0, "pi/2", 0]},
}


def build_router(max_body: int) -> APIRouter:
    """Routes of tables.

    Args:
        max_body: Largest document in bytes.
    """
    router = APIRouter(prefix="/v1", responses=PROBLEMS)
    answer: dict[int | str, dict[str, Any]] = {
        200: {
            "description": "The table. CSV writes base and tool as fixed rows.",
            "content": {
                JSON: {"schema": {"$ref": REF.format(name="DHTable")}},
                **{kind: {"schema": {"type": "string"}} for kind in OFFERS[1:]},
            },
        }
    }

    @router.get(
        "/robots/{robot_id}/dh",
        summary="A robot as D-H table",
        tags=["robots"],
        responses=answer,
        openapi_extra={
            "parameters": _parameters("convention", "base", "tip", *EXTRACTION, "angle", *FORM)
        },
    )
    async def read_dh(request: Request, stored: RobotDep, services: ServicesDep) -> Response:
        """Of a robot made from a table its own, in any convention; else extracted from its URDF."""
        check_query(request, "convention", "base", "tip", "decimal", *EXTRACTION)
        form = _form_of(request)
        tag = etag(stored.robot)
        headers = {"ETag": tag, "Vary": "Accept"}
        found = not_modified(request, tag)
        if found is not None:
            return found
        call = _robot_table(stored.robot, request)
        return await services.computed(lambda: _written(call(), form, headers), request)

    @router.post(
        "/urdf-to-dh",
        summary="URDF to D-H table",
        tags=["convert"],
        responses=answer,
        openapi_extra={
            "requestBody": {
                "required": True,
                "content": {"application/xml": {"schema": {"type": "string"}}},
            },
            "parameters": _parameters(
                "convention",
                "base",
                "tip",
                *EXTRACTION,
                "angle",
                *FORM,
                required=("convention",),
            ),
        },
    )
    async def urdf_to_dh(request: Request, services: ServicesDep) -> Response:
        check_query(request, "convention", "base", "tip", "decimal", *EXTRACTION)
        require_type(request, *XML_TYPES)
        query = request.query_params
        convention = _convention(query.get("convention"))
        body = await read_body(request, max_body)
        return await _extracted(
            request,
            services,
            convention,
            lambda: chain_of_urdf(body, query.get("base"), query.get("tip")),
            len(body),
        )

    @router.post(
        "/axes-to-dh",
        summary="Joint axes to D-H table",
        tags=["convert"],
        responses=answer,
        openapi_extra={
            "requestBody": {
                "required": True,
                "content": {
                    JSON: {
                        "schema": {"$ref": REF.format(name="JointAxes")},
                        "example": _AXES_EXAMPLE,
                    }
                },
            },
            "parameters": _parameters("convention", *EXTRACTION, "angle", *FORM),
        },
    )
    async def axes_to_dh(request: Request, services: ServicesDep) -> Response:
        """Points and directions of the axes at q = 0, as measured on a drawing, in base axes."""
        check_query(request, "convention", *EXTRACTION)
        require_type(request, JSON)
        data = decode_body(await read_body(request, max_body), Any)
        inside = data.pop("convention", None) if isinstance(data, dict) else None
        named = request.query_params.get("convention")
        if inside is not None and named is not None:
            raise RequestProblem(
                INVALID_REQUEST, say("convention is in the body and in the query"), "/convention"
            )
        convention = _convention(inside if named is None else named)
        return await _extracted(request, services, convention, lambda: read_axes(data))

    @router.post(
        "/convert-dh",
        summary="D-H table to another convention",
        tags=["convert"],
        responses=answer,
        openapi_extra={
            "requestBody": {
                "required": True,
                "content": {
                    "application/json": {"schema": {"$ref": REF.format(name="DHTable")}},
                    "application/yaml": {"schema": {"$ref": REF.format(name="DHTable")}},
                    "text/csv": {"schema": {"type": "string"}},
                    **{kind: {"schema": BINARY} for kind in SPREADSHEET_TYPES},
                },
            },
            "parameters": _parameters("to", "tip", "angle", *FORM, required=("to",)),
        },
    )
    async def convert_dh(request: Request, services: ServicesDep) -> Response:
        """The same q, limits and FK; a tree in khalil is cut down to the chain to ``tip``."""
        convention = _convention(request.query_params.get("to"), "to")
        form = _form_of(request)
        body = await read_body(request, max_body, DECODED_TYPES)
        tip = request.query_params.get("tip")

        def convert() -> Response:
            table = robot_from_body(request, body, "robot", ("to", "tip", "angle", "decimal")).table
            if table is None:
                raise RequestProblem(
                    INVALID_REQUEST,
                    say("the body is a URDF; POST it to /v1/urdf-to-dh?convention=…"),
                )
            return _written(to_convention(table, convention, tip), form)

        return await services.loaded(convert, len(body), memory_beside(request))

    return router


async def _extracted(
    request: Request,
    services: ServicesDep,
    convention: Convention,
    read: Callable[[], SerialChain],
    size: int = 0,
) -> Response:
    form, snap = _form_of(request), _snap(request)
    positive_a = flag_of(request, "positive_a")

    def answer() -> Response:
        found = extract(read(), convention, snap=snap, positive_a=positive_a)
        return _written(found, form)

    return await services.computed(answer, request, size)


def _robot_table(robot: Robot, request: Request) -> Callable[[], DHTable | Extraction]:
    """How the table of a robot is got: its own one by conversion, anything else by extraction."""
    query, own = request.query_params, robot.table
    base, tip, named = query.get("base"), query.get("tip"), query.get("convention")
    if own is not None and not any(key in query for key in ("base", *EXTRACTION)):
        convention = own.convention if named is None else _convention(named)
        return lambda: to_convention(own, convention, tip)
    convention = own.convention if own is not None and named is None else _convention(named)
    snap, positive_a = _snap(request), flag_of(request, "positive_a")
    return lambda: extract(
        chain_of_robot(robot, base, tip), convention, snap=snap, positive_a=positive_a
    )


@dataclass(frozen=True, slots=True)
class _Form:
    """The form of an answer.

    Attributes:
        type: Its media type.
        units: Of angles.
        language: What its sentences are in.
        table: How CSV is written; None for other forms.
        explained: Whether it says how each frame was found.
    """

    type: str
    units: Units
    language: Language
    table: CsvForm | None
    explained: bool


def _form_of(request: Request) -> _Form:
    units, wanted = units_of(request), wanted_type(request, *OFFERS)
    table = csv_form_of(request, wanted, None)
    return _Form(wanted, units, language_of(request), table, flag_of(request, "explain"))


def _written(
    found: DHTable | Extraction, form: _Form, headers: dict[str, str] | None = None
) -> Response:
    """The answer in the wanted form."""
    table = found if isinstance(found, DHTable) else found.table
    degrees, wanted, spoken = form.units.degrees, form.type, form.language
    if wanted == JSON:
        mapping = document(found, degrees=degrees, explained=form.explained)
        return respond(mapping, JSON, spoken, headers=headers)
    if wanted == YAML:
        text = to_yaml(spoken.told(document(found, degrees=degrees, explained=form.explained)))
    elif form.table is not None:
        named = form.table.language
        text = to_csv(table, degrees=degrees, language=named, commas=form.table.commas)
    elif wanted in WRITERS:
        writer = WRITERS[wanted]
        write = writer.write_degrees if degrees and writer.write_degrees else writer.write
        text = write(table)
    else:
        text = spoken.text(to_text(found, degrees=degrees, explained=form.explained))
    told = {} if wanted in (YAML, TEXT) else told_in_header(table.warnings, spoken)
    headers = language_headers(spoken, {**told, **(headers or {})})
    return Response(text.encode(), 200, headers, f"{wanted}; charset=utf-8")


def _convention(raw: object, name: str = "convention") -> Convention:
    if raw is None:
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} is missing; give {choices}", name=name, choices=CHOICES),
            f"/{name}",
        )
    found = CONVENTION_ALIASES.get(raw.strip().lower()) if isinstance(raw, str) else None
    if found is None:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "{name} {raw!r} is unknown; give {choices}",
                name=name,
                raw=str(raw)[:40],
                choices=CHOICES,
            ),
            f"/{name}",
        )
    return found


def _snap(request: Request) -> float:
    text = request.query_params.get("snap")
    snap = SNAP if text is None else number("snap", text, Units())
    if not 0.0 <= snap <= MAX_SNAP:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "snap is {snap:g}; give an angle from 0 to {max_snap} rad",
                snap=snap,
                max_snap=MAX_SNAP,
            ),
            "/snap",
        )
    return snap


_DESCRIPTIONS = {
    "convention": "standard, modified or khalil.",
    "to": "standard, modified or khalil.",
    "base": "Frame to start from; default the robot's base.",
    "tip": "Frame to end at; default the robot's tip. Of a tree in khalil: a joint or frame_k.",
    "snap": "Axes tilted by less than this are taken as parallel, rad; default 1e-8.",
    "explain": "true: how each frame was found, in words.",
    "positive_a": "true: no negative a, at the price of larger offsets.",
    "angle": "rad (default) or deg: angles of the answer (of CSV bodies, too); par and matlab are"
    " always in rad.",
    "format": f"json (default), text, yaml, csv, {', '.join(TABLE_TEXTS)}; or by Accept.",
    "lang": LANG_TEXT,
    "decimal": DECIMAL_TEXT,
}


def _parameters(*names: str, required: tuple[str, ...] = ()) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "in": "query",
            "required": name in required,
            "description": _DESCRIPTIONS[name],
            "schema": {"type": "string"},
        }
        for name in names
    ]
