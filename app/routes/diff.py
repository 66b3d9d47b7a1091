"""diff: where two robots diverge, up to base, tool and zero offsets."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias, TypeVar

import msgspec
from fastapi import APIRouter, Request, Response

from app.dependencies import RobotDep, ServicesDep
from app.http.bodies import read_body
from app.http.language import language_of
from app.http.negotiation import JSON, TEXT, require_type, wanted_type
from app.http.problems import RequestProblem
from app.http.query import check_query, units_of
from app.http.responses import respond
from app.http.strict_json import decode_body
from app.http.units import Units
from app.openapi.answers import REF
from app.openapi.problems import PROBLEMS
from app.operations.shapes import AnswerUnits
from dh_to_urdf import DHError, Fault
from dh_to_urdf.errors import Location
from dh_to_urdf.extraction.as_written import (
    CellDifference,
    differences_as_written,
    words_as_written,
)
from dh_to_urdf.extraction.comparison import compare
from dh_to_urdf.extraction.comparison_result import Comparison, Difference
from dh_to_urdf.messages import Message, say
from robots.chains import chain_of_robot
from robots.errors import InvalidURDF, RobotTooLarge, UnknownFrame
from robots.robot import Robot

RobotField = Annotated[
    msgspec.Raw,
    msgspec.Meta(
        description='A D-H table, {"urdf": text, "tip": …}, or the id of a stored robot.',
        extra_json_schema={
            "anyOf": [
                {"type": "string"},
                {"$ref": REF.format(name="DHTable")},
                {"$ref": REF.format(name="InlineURDF")},
            ]
        },
    ),
]


class DiffTolerance(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """What counts as equal: m and rad."""

    length: float = 1e-6
    angle: float = 1e-6


class DiffRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """The robot to compare with; chains run from ``base`` to ``tip``, default the robots' own."""

    other: RobotField
    tolerance: DiffTolerance = msgspec.field(default_factory=DiffTolerance)
    base: str | None = None
    tip: str | None = None
    other_base: str | None = None
    other_tip: str | None = None


class InlineDiffRequest(DiffRequest, forbid_unknown_fields=True, kw_only=True):
    """Two robots in one body."""

    robot: RobotField


class DifferenceView(msgspec.Struct, kw_only=True):
    """A parameter of the standard D-H row that differs."""

    joint: int
    name: str
    parameter: str
    first: float | str
    second: float | str
    difference: float | None
    absorbed_by: str | None


class DiffJoint(msgspec.Struct, kw_only=True):
    """One joint in both robots; largest deviation of the frames after it."""

    first: str
    second: str
    zero_offset: float
    position: float
    orientation: float


class DiffResidual(msgspec.Struct, kw_only=True):
    """Largest deviation of the tips with base, tool and zero offsets made equal."""

    position: float
    orientation: float
    configurations: int


class CellDifferenceView(msgspec.Struct, kw_only=True):
    """A cell of two tables of one convention that differs; joint 0 for base and tool.

    ``parameter`` is the column as the convention calls it; ``difference`` is not reduced by turns.
    """

    joint: int
    name: str
    parameter: str
    first: float | str
    second: float | str
    difference: float | None


class DiffResponse(msgspec.Struct, kw_only=True):
    """Where two robots diverge: ``identical``, ``equivalent`` or ``different``.

    ``as_written``: what differs cell by cell, before anything is rewritten; null where the robots
    are not both tables of one convention, or only a part of them is compared.
    """

    units: AnswerUnits
    verdict: str
    summary: str
    as_written: list[CellDifferenceView] | None
    first_difference: DifferenceView | None
    differences: list[DifferenceView]
    joints: list[DiffJoint]
    reversed: list[str]
    residual: DiffResidual | None
    warnings: list[str]


def build_router(max_body: int) -> APIRouter:
    """Routes of comparisons.

    Args:
        max_body: Largest body in bytes.
    """
    router = APIRouter(prefix="/v1", tags=["convert"], responses=PROBLEMS)
    answer: dict[int | str, dict[str, Any]] = {
        200: {
            "description": "The comparison.",
            "content": {
                JSON: {"schema": {"$ref": REF.format(name="DiffResponse")}},
                TEXT: {"schema": {"type": "string"}},
            },
        }
    }

    def body_of(name: str, example: dict[str, Any]) -> dict[str, Any]:
        schema = {"$ref": REF.format(name=name)}
        return {
            "requestBody": {
                "required": True,
                "content": {JSON: {"schema": schema, "example": example}},
            }
        }

    @router.post(
        "/robots/{robot_id}/diff",
        summary="Where two robots diverge",
        responses=answer,
        openapi_extra=body_of("DiffRequest", {"other": "panda_urdf"}),
    )
    async def diff(request: Request, stored: RobotDep, services: ServicesDep) -> Response:
        """Joint by joint, up to base, tool and zero offsets of the joints."""
        asked = await _asked(request, max_body, DiffRequest)
        other = await _other(services, asked, request)
        robot = stored.robot
        return await _answer(request, services, asked, (robot, robot.doubts), other)

    @router.post(
        "/diff",
        summary="Where two robots in the body diverge",
        responses=answer,
        openapi_extra=body_of("InlineDiffRequest", {"robot": "ur5", "other": "ur5_urdf"}),
    )
    async def diff_inline(request: Request, services: ServicesDep) -> Response:
        asked = await _asked(request, max_body, InlineDiffRequest)
        robot, told = await services.inline_robot(asked.robot, request)
        other = await _other(services, asked, request)
        return await _answer(request, services, asked, (robot, told), other)

    return router


T = TypeVar("T")
Told: TypeAlias = tuple[Robot, tuple[str, ...]]
"""A robot, and what the answer says of it."""


async def _asked(request: Request, max_body: int, type_: type[T]) -> T:
    check_query(request)
    require_type(request, JSON)
    return decode_body(await read_body(request, max_body), type_)


async def _other(services: ServicesDep, asked: DiffRequest, request: Request) -> Told:
    """The robot of ``other``, and what the answer says of it; errors point there."""
    try:
        return await services.inline_robot(asked.other, request)
    except DHError as error:
        faults = [Fault(_of_other(one.location), one.message) for one in error.faults]
        raise type(error)(faults) from None
    except UnknownFrame as error:
        argument, *index = _of_other((error.argument, *error.index))
        raise UnknownFrame(error.name, error.valid, str(argument), tuple(index)) from None
    except (InvalidURDF, RobotTooLarge) as error:
        raise error.within(_of_other(error.location)) from None
    except RequestProblem as error:
        (entry,) = error.entries
        detail = entry.message
        if isinstance(detail, Message) and detail.values.get("field") == "robot":
            detail = detail.having(field="other")
        pointer = "/other" + entry.pointer.removeprefix("/robot")
        raise RequestProblem(error.type, detail, pointer) from None


def _of_other(location: Location) -> Location:
    return ("other", *(location[1:] if location[:1] == ("robot",) else location))


async def _answer(
    request: Request, services: ServicesDep, asked: DiffRequest, first: Told, second: Told
) -> Response:
    units, wanted = units_of(request), wanted_type(request, JSON, TEXT)
    spoken = language_of(request)
    (robot, doubts), (other, more) = first, second
    warnings = [*dict.fromkeys((*doubts, *(say("other: {one}", one=one) for one in more)))]

    def answer() -> Response:
        found = compare(
            chain_of_robot(robot, asked.base, asked.tip),
            chain_of_robot(other, asked.other_base, asked.other_tip),
            length=asked.tolerance.length,
            angle=asked.tolerance.angle,
        )
        payload = _payload(found, _cells(robot, other, asked), units)
        return respond({**payload, "warnings": warnings}, wanted, spoken)

    return await services.computed(answer, request)


def _cells(robot: Robot, other: Robot, asked: DiffRequest) -> tuple[CellDifference, ...] | None:
    """Return what differs as written; None where the two are not written alike."""
    ends = (asked.base, asked.tip, asked.other_base, asked.other_tip)
    if robot.table is None or other.table is None or any(end is not None for end in ends):
        return None
    tolerance = asked.tolerance
    return differences_as_written(
        robot.table, other.table, length=tolerance.length, angle=tolerance.angle
    )


def _payload(
    found: Comparison, cells: tuple[CellDifference, ...] | None, units: Units
) -> dict[str, Any]:
    def angle(value: float) -> float:
        return float(units.angles_out(value))  # type: ignore[arg-type]

    def view(difference: Difference) -> dict[str, Any]:
        values = (difference.first, difference.second, difference.difference)
        if difference.parameter in ("alpha", "theta"):
            values = tuple(angle(v) if isinstance(v, float) else v for v in values)  # type: ignore[assignment]
        return {
            "joint": difference.joint,
            "name": difference.name,
            "parameter": difference.parameter,
            **dict(zip(("first", "second", "difference"), values, strict=True)),
            "absorbed_by": difference.absorbed_by,
        }

    def cell_view(cell: CellDifference) -> dict[str, Any]:
        values = (cell.first, cell.second, cell.difference)
        if cell.is_angle:
            values = tuple(angle(v) if isinstance(v, float) else v for v in values)  # type: ignore[assignment]
        named = {"joint": cell.joint, "name": cell.name, "parameter": cell.parameter}
        return named | dict(zip(("first", "second", "difference"), values, strict=True))

    summary = found.words
    if cells:
        summary = say(
            "{cells} Up to base, tool and zero offsets: {summary}",
            cells=words_as_written(cells),
            summary=summary,
        )
    differences = [view(difference) for difference in found.differences]
    residual = found.residual
    return {
        "units": units.named,
        "verdict": found.verdict.value,
        "summary": summary,
        "as_written": None if cells is None else [cell_view(cell) for cell in cells],
        "first_difference": differences[0] if differences else None,
        "differences": differences,
        "joints": [
            {
                "first": joint.first,
                "second": joint.second,
                "zero_offset": angle(joint.zero_offset) if joint.is_revolute else joint.zero_offset,
                "position": joint.position,
                "orientation": angle(joint.orientation),
            }
            for joint in found.joints
        ],
        "reversed": list(found.reversed),
        "residual": residual
        and {
            "position": residual.position,
            "orientation": angle(residual.orientation),
            "configurations": residual.configurations,
        },
    }
