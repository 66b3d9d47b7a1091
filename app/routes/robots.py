"""Robots: list, read, upload, replace, delete; and their URDF and D-H documents."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated, Any, Literal, TypeAlias

import msgspec
import numpy as np
from fastapi import APIRouter, Path, Request, Response

from app.access.control import key_of
from app.dependencies import RobotDep, ServicesDep
from app.documents import (
    ARCHIVE_TYPES,
    BINARY,
    DECODED_TYPES,
    PAR_TYPES,
    PASTED_TYPES,
    SPREADSHEET_TYPES,
    id_from_name,
    memory_beside,
    robot_from_body,
)
from app.http.bodies import read_body
from app.http.conditions import if_match_of, if_none_match_of
from app.http.language import language_of
from app.http.negotiation import JSON, TEXT, media_type, wanted_type
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import check_query, flag_of, units_of
from app.http.responses import respond
from app.http.units import Units
from app.openapi.answers import REF
from app.openapi.problems import PROBLEMS
from app.routes.mesh_lines import MeshLine, mesh_lines
from dh_to_urdf.couplings import coefficient_in
from dh_to_urdf.documents.layouts import document
from dh_to_urdf.languages import Language
from dh_to_urdf.messages import say
from kinematics.meshes.archived_robot import ArchivedRobot, archived_robot
from robots.errors import RevisionMismatch, RobotError, RobotExists
from robots.revisions import ANY
from robots.robot import Robot
from robots.store import RobotStore
from robots.stored_robot import StoredRobot

NEAR = 3
"""Look-alike ids that an answer names."""
OVERWRITE = "overwrite"
"""Query parameter that allows to replace or delete the robot of another."""
DEFAULT_PAGE, MAX_PAGE = 100, 1000
"""Written forms of a table by media type."""

_EXAMPLE = {
    "name": "my_arm",
    "convention": "standard",
    "units": {"angle": "deg", "length": "m"},
    "joints": [
        {
            "name": "j1",
            "type": "revolute",
            "alpha": 90,
            "a": 0,
            "d": 0.4,
            "theta": 0,
            "limits": {"lower": -170, "upper": 170},
        },
        {
            "name": "j2",
            "type": "revolute",
            "alpha": 0,
            "a": 0.3,
            "d": 0,
            "theta": 0,
            "limits": {"lower": -120, "upper": 120},
        },
    ],
}
_CSV_EXAMPLE = (
    "name,type,alpha,a,d,theta,offset,sign,lower,upper\n"
    "j1,R,pi/2,0,0.4,0,0,1,-170deg,170deg\nj2,R,0,0.3,0,0,0,1,-120deg,120deg\n"
)
_PAR_EXAMPLE = (
    "(* Robotname = 'planar' *)\nNL = 2\nNJ = 2\nNF = 2\nType = 0\n"
    "ant = {0,1}\nsigma = {0,0}\nb = {0,0}\nd = {0,0.5}\nr = {0,0}\ngamma = {0,0}\n"
    "alpha = {0,0}\nmu = {1,1}\ntheta = {th1,th2}\n"
)
_PASTED_EXAMPLE = (
    "| i | α_i | a_i | d_i | θ_i |\n|---|-----|-----|-----|-----|\n"
    "| 1 | 90° | 0 | 0,4 | θ_1 |\n| 2 | 0 | 0.3 | 0 | θ_2 - π/2 |\n"
)


Kind: TypeAlias = Literal["dh", "urdf"]
"""What a robot was made from."""


class JointView(msgspec.Struct, kw_only=True):
    """One entry of q; null where there is no limit or it is unknown.

    Acceleration and jerk are there where the robot's document limits them for any joint.
    """

    name: str
    type: Literal["revolute", "prismatic", "continuous"]
    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None
    acceleration: float | msgspec.UnsetType | None = msgspec.UNSET
    jerk: float | msgspec.UnsetType | None = msgspec.UNSET


class FollowerView(msgspec.Struct, kw_only=True):
    """A joint that is no entry of q: its value is multiplier * (that of ``joint``) + offset."""

    name: str
    type: Literal["revolute", "prismatic", "continuous"]
    joint: str
    multiplier: float
    offset: float


class CouplingView(msgspec.Struct, kw_only=True):
    """A joint whose geometry is moved by others besides: by their values times coefficients."""

    name: str
    joints: dict[str, float]


class RobotView(msgspec.Struct, kw_only=True):
    """A robot. ``joints`` are the entries of q.

    The answer to an upload also holds the D-H table as it was read, with its units, and the meshes
    that came with it.
    """

    id: str
    kind: Kind
    title: str
    source: str | None
    shipped: bool
    revision: str
    dof: int
    convention: Literal["standard", "modified", "khalil"] | None
    units: dict[str, str]
    joints: list[JointView]
    followers: list[FollowerView]
    couplings: list[CouplingView]
    base_frame: str
    tip_frame: str
    frames: list[str]
    warnings: list[str]
    meshes: list[MeshLine] | msgspec.UnsetType = msgspec.UNSET
    table: (
        Annotated[
            dict[str, Any],
            msgspec.Meta(extra_json_schema={"allOf": [{"$ref": REF.format(name="DHTable")}]}),
        ]
        | msgspec.UnsetType
    ) = msgspec.UNSET


class RobotLine(msgspec.Struct, kw_only=True):
    """A robot in a list."""

    id: str
    kind: Kind
    title: str
    dof: int
    shipped: bool


class RobotList(msgspec.Struct, kw_only=True):
    """One page of robots, by id."""

    robots: list[RobotLine]
    next_page_token: str | None


def robot_view(stored: StoredRobot, units: Units) -> dict[str, Any]:
    """What the API says of a robot."""
    robot = stored.robot

    rates = [
        key
        for key in ("acceleration", "jerk")
        if any(getattr(joint, key) is not None for joint in robot.joints)
    ]

    def out(value: float | None, is_revolute: bool) -> float | None:
        if value is None or not is_revolute:
            return value
        return float(units.angles_out(np.array(value)))

    return {
        "id": stored.id,
        "kind": robot.kind,
        "title": stored.title,
        "source": stored.source,
        "shipped": stored.shipped,
        "revision": robot.revision,
        "dof": robot.dof,
        "convention": robot.table.convention.value if robot.table else None,
        "units": units.named,
        "joints": [
            {
                "name": joint.name,
                "type": joint.type.value,
                "lower": out(joint.lower, joint.type.is_revolute),
                "upper": out(joint.upper, joint.type.is_revolute),
                "velocity": out(joint.velocity, joint.type.is_revolute),
                "effort": joint.effort,
                **{key: out(getattr(joint, key), joint.type.is_revolute) for key in rates},
            }
            for joint in robot.joints
        ],
        **_dependences(robot, units),
        "base_frame": robot.base_frame,
        "tip_frame": robot.tip_frame,
        "frames": list(robot.frames),
        "warnings": list(robot.warnings),
    }


def _dependences(robot: Robot, units: Units) -> dict[str, Any]:
    """Return the joints that depend on others, in the units of the answer."""
    coupled = robot.coupled
    if coupled is None:
        return {"followers": [], "couplings": []}
    turns = {joint.name: joint.type.is_revolute for joint in coupled.joints}
    turn = float(units.angles_out(np.array(1.0)))

    def shown(coefficient: float, name: str, leader: str) -> float:
        return coefficient_in(turn, coefficient, turns=turns[name], leader_turns=turns[leader])

    followers = [
        {
            "name": joint.name,
            "type": joint.type.value,
            "joint": joint.mimic.joint,
            "multiplier": shown(joint.mimic.multiplier, joint.name, joint.mimic.joint),
            "offset": joint.mimic.offset * (turn if turns[joint.name] else 1.0),
        }
        for joint in coupled.followers
        if joint.mimic is not None
    ]
    couplings = [
        {
            "name": joint.name,
            "joints": {other: shown(c, joint.name, other) for other, c in joint.coupling},
        }
        for joint in coupled.couplings
    ]
    return {"followers": followers, "couplings": couplings}


def etag(robot: Robot) -> str:
    """Strong entity tag of a robot's documents."""
    return f'"{robot.revision}"'


def not_modified(request: Request, tag: str) -> Response | None:
    """304 where the client has this revision already."""
    given = request.headers.get("if-none-match")
    if given is None:
        return None
    tags = {item.strip().removeprefix("W/") for item in given.split(",")}
    return (
        Response(status_code=304, headers={"ETag": tag, "Vary": "Accept, Accept-Language"})
        if {tag, "*"} & tags
        else None
    )


def build_router(max_body: int) -> APIRouter:
    """Routes of robots.

    Args:
        max_body: Largest document in bytes.
    """
    router = APIRouter(prefix="/v1/robots", tags=["robots"], responses=PROBLEMS)
    view: dict[int | str, dict[str, Any]] = {
        200: {
            "description": "The robot.",
            "content": {
                JSON: {"schema": {"$ref": REF.format(name="RobotView")}},
                TEXT: {"schema": {"type": "string"}},
            },
        }
    }
    overwriting = {
        "name": OVERWRITE,
        "in": "query",
        "required": False,
        "schema": {"type": "boolean", "default": False},
    }
    documents = {
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {
                    "schema": {"$ref": REF.format(name="DHTable")},
                    "example": _EXAMPLE,
                },
                "application/yaml": {"schema": {"$ref": REF.format(name="DHTable")}},
                "text/csv": {"schema": {"type": "string"}, "example": _CSV_EXAMPLE},
                "text/x-symoro": {"schema": {"type": "string"}, "example": _PAR_EXAMPLE},
                "text/plain": {"schema": {"type": "string"}, "example": _PASTED_EXAMPLE},
                **{kind: {"schema": BINARY} for kind in SPREADSHEET_TYPES},
                "application/xml": {"schema": {"type": "string"}},
                "application/zip": {"schema": BINARY},
            },
        },
        "parameters": [
            {
                "name": name,
                "in": "query",
                "required": False,
                "schema": {"type": "string"},
                "description": text,
            }
            for name, text in (
                ("name", "Name of the robot, where the document gives none or another."),
                ("convention", "CSV and pasted text: standard, modified or khalil."),
                ("angle", "CSV and pasted text: rad (default) or deg."),
                ("length", "CSV and pasted text: m (default) or mm."),
                ("columns", "Pasted text without a heading: its columns, as theta,d,a,alpha."),
                ("values", "Numbers for names in cells, as D3:0.45,RL4:450mm."),
                ("loops", "SYMORO: cut reads the spanning tree of a robot with closed loops."),
                ("urdf", "zip: the URDF that is meant, where the archive has several."),
                ("tip", "URDF: default tip frame."),
                (
                    "base",
                    "URDF: frame in whose axes results are given; where a joint floats, the part"
                    " of the robot that holds it.",
                ),
            )
        ]
        + [overwriting | {"description": "Replace a robot that another has stored."}],
    }

    @router.get(
        "",
        summary="List robots",
        responses={
            200: {
                "description": "One page.",
                "content": {JSON: {"schema": {"$ref": REF.format(name="RobotList")}}},
            }
        },
        openapi_extra={
            "parameters": [
                {"name": "page_size", "in": "query", "schema": {"type": "integer", "default": 100}},
                {"name": "page_token", "in": "query", "schema": {"type": "string"}},
            ]
        },
    )
    async def list_robots(
        request: Request,
        services: ServicesDep,
    ) -> Response:
        check_query(request, "page_size", "page_token", common=("format", "lang"))
        wanted = wanted_type(request, JSON, TEXT)
        text = request.query_params.get("page_size", str(DEFAULT_PAGE))
        page_size = int(text) if re.fullmatch(r"[0-9]{1,6}", text) else 0
        page_token = request.query_params.get("page_token", "")
        if not 1 <= page_size <= MAX_PAGE:
            raise RequestProblem(
                INVALID_REQUEST,
                say(
                    "page_size is {text!r}; give 1 to {max_page}", text=text[:32], max_page=MAX_PAGE
                ),
                "/page_size",
            )
        store, spoken = services.store_of(request), language_of(request)
        return await services.loaded(lambda: _page(store, page_size, page_token, wanted, spoken))

    @router.post(
        "",
        status_code=201,
        summary="Upload a robot",
        responses=view | {201: view[200]},
        openapi_extra=documents,
    )
    async def create_robot(request: Request, services: ServicesDep) -> Response:
        wanted, overwrite = wanted_type(request, JSON, TEXT), flag_of(request, OVERWRITE)
        read = await _document(request, services, max_body, default_name=None)
        name = request.query_params.get("name", read.robot.name)
        robot_id = id_from_name(name)
        if not robot_id:
            raise RequestProblem(
                INVALID_REQUEST,
                say(
                    "no id can be made of the name {name!r}; give one in the query, such as"
                    " ?name=my-arm",
                    name=name[:64],
                ),
                "/name",
            )
        store, writer = services.store_of(request), services.writer_of(request, overwrite=overwrite)
        stored, created = await services.stored(
            lambda: store.put(
                robot_id, read.robot, meshes=read.files, writer=writer, create_only=not overwrite
            )
        )
        return await _uploaded(request, services, stored, wanted, read.notes, created=created)

    @router.get("/{robot_id}", summary="Read a robot", responses=view)
    async def read_robot(request: Request, stored: RobotDep) -> Response:
        check_query(request)
        units, wanted = units_of(request), wanted_type(request, JSON, TEXT)
        tag = etag(stored.robot)
        payload = robot_view(stored, units)
        return not_modified(request, tag) or respond(
            payload, wanted, language_of(request), headers={"ETag": tag, "Vary": "Accept"}
        )

    @router.put(
        "/{robot_id}",
        summary="Upload or replace a robot",
        responses=view | {201: view[200]},
        openapi_extra=documents,
    )
    async def put_robot(
        request: Request, robot_id: Annotated[str, Path()], services: ServicesDep
    ) -> Response:
        store = services.store_of(request)
        store.check_id(robot_id)
        wanted, unless = wanted_type(request, JSON, TEXT), if_none_match_of(request)
        writer = services.writer_of(request, overwrite=flag_of(request, OVERWRITE))
        read = await _document(request, services, max_body, default_name=robot_id)
        _check_name(request, read.robot, robot_id)

        def put() -> tuple[StoredRobot, bool]:
            try:
                return store.put(
                    robot_id,
                    read.robot,
                    meshes=read.files,
                    writer=writer,
                    create_only=ANY in unless,
                    if_match=if_match_of(request),
                    if_none_match=unless,
                )
            except RobotExists:
                raise RevisionMismatch(robot_id, "another") from None

        stored, created = await services.stored(put)
        return await _uploaded(request, services, stored, wanted, read.notes, created=created)

    @router.delete(
        "/{robot_id}",
        status_code=204,
        summary="Delete a robot",
        openapi_extra={
            "parameters": [overwriting | {"description": "Delete what another key has stored."}]
        },
    )
    async def delete_robot(
        request: Request, robot_id: Annotated[str, Path()], services: ServicesDep
    ) -> Response:
        check_query(request, OVERWRITE)
        if_match, unless = if_match_of(request), if_none_match_of(request)
        store = services.store_of(request)
        # Without keys nobody is known, and who asks for a deletion means no other change.
        overwrite = flag_of(request, OVERWRITE) or key_of(request.scope) is None
        writer = services.writer_of(request, overwrite=overwrite)
        await services.stored(
            lambda: store.delete(robot_id, writer=writer, if_match=if_match, if_none_match=unless)
        )
        return Response(status_code=204)

    @router.get(
        "/{robot_id}/urdf",
        summary="The URDF of a robot",
        response_class=Response,
        responses={200: {"description": "URDF.", "content": {"application/xml": {}}}},
    )
    async def read_urdf(request: Request, stored: RobotDep) -> Response:
        check_query(request)
        tag = etag(stored.robot)
        return not_modified(request, tag) or Response(
            stored.robot.urdf, media_type="application/xml", headers={"ETag": tag, "Vary": "Accept"}
        )

    return router


def _page(
    store: RobotStore, page_size: int, page_token: str, wanted: str, spoken: Language
) -> Response:
    later = store.ids_after(page_token, page_size + 1)
    lines = []
    for robot_id in later[:page_size]:
        # Deleted a moment ago, or damaged: then /health/ready names it.
        with suppress(RobotError):
            line = store.summary(robot_id)
            lines.append({name: getattr(line, name) for name in RobotLine.__struct_fields__})
    token = later[page_size - 1] if len(later) > page_size else None
    return respond({"robots": lines, "next_page_token": token}, wanted, spoken)


async def _document(
    request: Request, services: ServicesDep, max_body: int, default_name: str | None
) -> ArchivedRobot:
    """Returns the robot of a body: a document by itself, or an archive with its meshes."""
    if media_type(request) not in ARCHIVE_TYPES:
        body = await read_body(request, max_body, DECODED_TYPES)
        robot = await services.loaded(
            lambda: robot_from_body(request, body, default_name, also=(OVERWRITE,)),
            len(body),
            memory_beside(request),
        )
        return ArchivedRobot(robot, {}, ())
    check_query(
        request, "name", "urdf", "base", "tip", OVERWRITE, common=("angle", "format", "lang")
    )
    given, archive = (
        request.query_params,
        await read_body(request, services.settings.max_archive_bytes),
    )

    def read() -> ArchivedRobot:
        with services.meshes.archive(archive) as opened:
            return archived_robot(opened, given.get("urdf"), given.get("base"), given.get("tip"))

    return await services.mesh_read(read, request, len(archive))


async def _uploaded(
    request: Request,
    services: ServicesDep,
    stored: StoredRobot,
    wanted: str,
    notes: Sequence[str],
    *,
    created: bool,
) -> Response:
    """The answer to an upload: the robot, its table as it was read, and what was doubtful."""
    view, table = robot_view(stored, Units()), stored.robot.table
    view["warnings"] += notes
    if stored.robot.meshes:
        view["meshes"] = mesh_lines(stored)
    store = services.store_of(request)
    near = await services.loaded(lambda: store.look_alikes(stored.id))
    if store.hides_shared(stored.id):
        view["warnings"] += [
            say(
                "'{stored}' is the id of a shared robot too; requests with this key"
                " mean yours, until you delete it",
                stored=stored.id,
            )
        ]
    if near:
        shown = ", ".join(f"'{other}'" for other in near[:NEAR])
        view["warnings"] += [
            say(
                "the id '{stored}' looks like that of another robot: {shown}; mind which is meant",
                stored=stored.id,
                shown=shown,
            )
        ]
    if table is not None:
        echo = document(table, degrees=request.query_params.get("angle") == "deg")
        view["table"] = {key: value for key, value in echo.items() if key != "warnings"}
    headers = {"ETag": etag(stored.robot)}
    if created:
        headers["Location"] = f"{request.scope.get('root_path', '')}/v1/robots/{stored.id}"
    status = 201 if created else 200
    return respond(view, wanted, language_of(request), status=status, headers=headers)


def _check_name(request: Request, robot: Robot, robot_id: str) -> None:
    """A table's own name must be the path's id; a URDF keeps the name that it has."""
    named = request.query_params.get("name")
    if named is not None and robot_id not in (named, id_from_name(named)):
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "name is {named!r} but the path says {robot_id!r}; leave name out",
                named=named[:64],
                robot_id=robot_id,
            ),
            "/name",
        )
    if robot.table is not None and robot_id not in (robot.name, id_from_name(robot.name)):
        text = media_type(request) in (*PAR_TYPES, *PASTED_TYPES, *SPREADSHEET_TYPES)
        remedy = (
            say("give name={robot_id} in the query", robot_id=robot_id)
            if text
            else say("leave name out")
        )
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "name is {robot!r} but the path says {robot_id!r}; make them equal or {remedy}",
                robot=robot.name,
                robot_id=robot_id,
                remedy=remedy,
            ),
            "/name",
        )
