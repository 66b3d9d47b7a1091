"""What every computation has in common."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

import msgspec
import numpy as np

from app.http.negotiation import CSV, JSON, NDJSON, NPY, PNG, SVG, TEXT
from app.http.pointers import escaped
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.strict_json import PIECE, RowLengthError, decode_json, decode_numbers, decode_rows
from app.http.units import Units
from app.operations.schema import TASK, one_of
from app.settings import Settings
from dh_to_urdf.errors import quoted
from kinematics.configuration import configuration, configuration_by_name
from kinematics.jacobian import ReferenceFrame
from kinematics.symbolic import SymbolicWorkers
from robots.robot import FloatArray, Robot

_ONE_Q = {"type": "array", "items": {"type": "number"}}
_BY_NAME = {"type": "object", "additionalProperties": {"type": "number"}}
_BATCH = {"type": "array", "items": _ONE_Q, "minItems": 1}

Configuration = Annotated[
    msgspec.Raw,
    msgspec.Meta(
        description="Joint values, one a joint in the robot's order: a list, a batch (list of"
        " lists), or an object {joint name: value}. rad and m, or degrees with ?angle=deg.",
        extra_json_schema={"anyOf": [_ONE_Q, _BATCH, _BY_NAME]},
    ),
]
SingleConfiguration = Annotated[
    msgspec.Raw,
    msgspec.Meta(
        description="Joint values, one a joint in the robot's order: a list, or an object"
        " {joint name: value}. rad and m, or degrees with ?angle=deg.",
        extra_json_schema={"anyOf": [_ONE_Q, _BY_NAME]},
    ),
]
OptionalConfiguration = Annotated[
    msgspec.Raw,
    msgspec.Meta(
        description="One q, as a list or an object {joint name: value}; may be left out.",
        extra_json_schema={"anyOf": [_ONE_Q, _BY_NAME, {"type": "null"}]},
    ),
]
TaskField = Annotated[
    str | list[int],
    msgspec.Meta(
        description="pose, position, orientation, xy, xz, yz, x, y, z, xy_phi, xyz_phi, direction"
        " (of the frame's z axis), position_direction, or a mask of six 0 or 1 for vx, vy, vz, wx,"
        " wy, wz.",
    ),
    TASK,
]
FrameField = Annotated[str | None, msgspec.Meta(description="Frame name; default the tip.")]
ReferenceFrameField = Annotated[
    str | None,
    msgspec.Meta(
        description="local_world_aligned (default): at the frame's origin in base axes. world: of"
        " the body point at the base's origin, in base axes. local: at the frame's origin, in the"
        " frame's own axes."
    ),
    one_of(ReferenceFrame, null=True),
]
RankToleranceField = Annotated[
    float,
    msgspec.Meta(
        description="Singular values below tolerance * max(1, largest) count as zero.",
        extra_json_schema={"minimum": 0, "exclusiveMaximum": 1},
    ),
]
NOT_GIVEN = b"null"
"""The text of a configuration that a request leaves out."""


def not_given() -> msgspec.Raw:
    """The value of an optional configuration that a request leaves out."""
    return msgspec.Raw(NOT_GIVEN)


Numbers: TypeAlias = list[Any]
"""In answers: nested lists of numbers, with a leading axis n for batches."""


class Context(msgspec.Struct, frozen=True):
    """What a computation knows besides robot and request.

    Attributes:
        units: Of the request and its answer.
        settings: What the deployment chose.
        form: Media type of the answer.
        symbolic: The processes for symbolic work.
    """

    units: Units
    settings: Settings
    form: str = JSON
    symbolic: SymbolicWorkers | None = None

    def symbolic_workers(self) -> SymbolicWorkers:
        """The processes for symbolic work."""
        assert self.symbolic is not None
        return self.symbolic


class Answer(msgspec.Struct, frozen=True):
    """What a computation gives: a payload for JSON and text, and what npy and CSV hold.

    A ``listing`` is the whole answer in any other form than JSON, a ``picture`` draws it as SVG,
    from which PNG is made.
    """

    payload: dict[str, Any]
    array: FloatArray | None = None
    headers: dict[str, str] | None = None
    listing: str | None = None
    rows: list[dict[str, Any]] | None = None
    picture: Callable[[], str] | None = None


@dataclass(frozen=True, eq=False)
class Operation:
    """One computation of the API.

    Attributes:
        name: Last part of its path.
        summary: One line for the docs.
        description: More for the docs.
        request: Type of the body.
        response: Type of the answer, for the docs.
        run: The computation.
        example: A body that works on ``example_robot``.
        example_robot: Id of a shipped robot.
        query: Names of the parameters of the GET form.
        quick: What :meth:`run_quickly` does, where it is not a matter of size alone.
        stream: The answer in parts, each a list of rows, where it can be sent while it grows.
        rehearsed: Whether to send the example once as the service starts.
        array_field: Field that a body of type npy stands for, if there is one.
        forms: Media types of the answer, the default first, where they are not the usual ones.
        out_of_process: Whether another process does the work, so that waiting for it takes no
            compute thread.
        pictured: Whether the answer has a picture.
        tabular: Whether the answer is a table that CSV can hold, and no array.
        extras: Whether part of it needs a package that may not be installed.
    """

    name: str
    summary: str
    description: str
    request: type[msgspec.Struct]
    response: type[msgspec.Struct]
    run: Callable[[Robot, Any, Context], Answer]
    example: dict[str, Any]
    example_robot: str
    query: tuple[str, ...]
    array_field: str | None = None
    stream: Callable[[Robot, Any, Context], Iterator[list[dict[str, Any]]]] | None = None
    quick: Callable[[Robot, Any, Context], Answer | None] | None = None
    rehearsed: bool = True
    forms: tuple[str, ...] = ()
    out_of_process: bool = False
    tabular: bool = False
    pictured: bool = False
    extras: bool = False

    @property
    def offers(self) -> tuple[str, ...]:
        """Media types of the answer, the default first."""
        if self.forms:
            return self.forms
        picture = (SVG, PNG) if self.pictured else ()
        if self.tabular:
            return (JSON, TEXT, CSV, *picture)
        return (JSON, TEXT, NPY, *((NDJSON,) if self.stream else ()), *picture)

    def run_quickly(self, robot: Robot, request: Any, context: Context) -> Answer | None:
        """The answer if it takes so little time that a thread would only cost; else None."""
        if self.quick is not None:
            return self.quick(robot, request, context)
        return self.run(robot, request, context) if is_light(robot, request) else None


MAX_INTEGER = 10**300
"""Beyond it an integer is no floating-point number."""
LIGHT_DOF = 16
LIGHT_FRAMES = 40
MAX_NUMBERS = 12_000_000


def is_light(robot: Robot, request: Any) -> bool:
    """True for one q of a robot of ordinary size."""
    raw = request.q
    if isinstance(raw, np.ndarray):
        return raw.ndim == 1 and robot.dof <= LIGHT_DOF
    if bytes(raw)[1:64].lstrip()[:1] == b"[":
        return False
    return robot.dof <= LIGHT_DOF and len(robot.frames) <= LIGHT_FRAMES


def check_size(q: FloatArray, numbers: int, pointer: str = "/q") -> None:
    """Refuses a request whose answer would fill the memory.

    Args:
        q: Shape (dof,) or (n, dof).
        numbers: Numbers in the answer for one q.
        pointer: JSON pointer for the error.

    Raises:
        RequestProblem: The answer would hold over ``MAX_NUMBERS``.
    """
    total = numbers * (len(q) if q.ndim == 2 else 1)
    if total > MAX_NUMBERS:
        raise RequestProblem(
            INVALID_REQUEST,
            f"the answer would hold {total} numbers; at most {MAX_NUMBERS} are given, send parts",
            pointer,
        )


def read_configuration(
    raw: msgspec.Raw | FloatArray, robot: Robot, context: Context, pointer: str = "/q"
) -> FloatArray:
    """Q of a request in rad and m, shape (dof,) or (n, dof).

    Raises:
        RequestProblem: Not numbers, or more configurations than one request may hold.
        WrongConfiguration: It does not fit the robot.
    """
    most = context.settings.max_batch
    q = raw if isinstance(raw, np.ndarray) else _from_json(raw, robot, pointer, most)
    q = configuration(robot, q, pointer)
    if q.ndim == 2 and not 1 <= len(q) <= most:
        raise RequestProblem(
            INVALID_REQUEST,
            f"{pointer.rsplit('/', 1)[-1]} holds {len(q)} rows; give 1 to {most}",
            pointer,
        )
    return context.units.joints_in(robot, q)


def read_single(
    raw: msgspec.Raw, robot: Robot, context: Context, pointer: str = "/q"
) -> FloatArray:
    """One q of a request in rad and m, shape (dof,).

    Raises:
        RequestProblem: Not one list of numbers.
        WrongConfiguration: It does not fit the robot.
    """
    q = read_configuration(raw, robot, context, pointer)
    if q.ndim != 1:
        name = pointer.rsplit("/", 1)[-1]
        raise RequestProblem(INVALID_REQUEST, f"{name} is a batch; give one list", pointer)
    return q


def read_frame(name: str | None, robot: Robot) -> str:
    """The frame of a request; by default the tip.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    if name is None:
        return robot.tip_frame
    robot.frame_id(name)
    return name


def read_reference_frame(name: str | None) -> ReferenceFrame:
    """The reference frame of a request.

    Raises:
        RequestProblem: There is no such one.
    """
    if name is None:
        return ReferenceFrame.LOCAL_WORLD_ALIGNED
    if name not in list(ReferenceFrame):
        raise RequestProblem(
            INVALID_REQUEST,
            f"reference_frame is {name[:32]!r}; give {', '.join(ReferenceFrame)}",
            "/reference_frame",
        )
    return ReferenceFrame(name)


def _from_json(raw: msgspec.Raw, robot: Robot, pointer: str, most: int) -> Any:
    text = bytes(raw)
    name = pointer.rsplit("/", 1)[-1]
    if text[:1] == b"{":
        if len(text) > PIECE:
            raise RequestProblem(
                INVALID_REQUEST, f"{name} has {len(text)} bytes; name each joint once", pointer
            )
        values = decode_json(text, dict[str, Any], pointer)
        for joint, value in values.items():
            plain = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not plain or abs(value) > MAX_INTEGER:
                raise RequestProblem(
                    INVALID_REQUEST,
                    f"{name} of joint {joint[:64]} is {quoted(value)}; give a number",
                    f"{pointer}/{escaped(joint)}",
                )
        return configuration_by_name(robot, values, pointer)
    if text[:1] != b"[":
        raise RequestProblem(
            INVALID_REQUEST,
            f"{name} is {text[:32].decode(errors='replace')}; give a list of numbers, one a joint",
            pointer,
        )
    if text[1:64].lstrip()[:1] == b"[":
        try:
            return decode_rows(text, pointer, robot.dof, most)
        except RowLengthError as odd:
            return configuration(robot, odd.row, f"{pointer}/{odd.index}")
    return decode_numbers(text, pointer)


UNITS_SCHEMA = Annotated[
    dict[str, str], msgspec.Meta(description='Units of the answer: {"angle": …, "length": "m"}.')
]
