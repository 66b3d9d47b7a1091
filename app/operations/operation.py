"""What a computation of the API is: its request, its answer, its call, and where it runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Any

import msgspec
from numpy.typing import NDArray

from app.admission.need import Need
from app.fields.doubts import RequestDoubts
from app.fields.form import RequestForm, form_of
from app.fields.joints import is_one
from app.http.negotiation import CSV, JSON, LATEX, NDJSON, NPY, PNG, SVG, TEXT
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import COMMON
from app.http.units import Units
from app.settings import Settings
from app.sheets.sheet import SheetSource
from dh_to_urdf.languages import ENGLISH, Language
from dh_to_urdf.messages import say
from kinematics.processes.pool import ProcessPool
from kinematics.symbolic import SymbolicWorkers
from robots.robot import FloatArray, Robot

ARRAY_FORMS = (JSON, TEXT, NPY)
TABLE_FORMS = (JSON, TEXT, CSV, LATEX)
SHEET_FORMS = (*ARRAY_FORMS, CSV, LATEX)
LINES = (NDJSON,)
PICTURES = (SVG, PNG)
LIGHT_DOF = 16
LIGHT_FRAMES = 40
MAX_NUMBERS = 12_000_000
"""Numbers that one answer may hold."""


class Runs(Enum):
    """Where a computation runs."""

    EVENT_LOOP = "event loop"
    """One q of a robot of ordinary size at once, as it takes microseconds; the rest in a thread."""
    THREAD = "thread"
    """Always in a compute thread."""
    PROCESS = "process"
    """In another process, so that waiting for it takes no compute thread."""


@dataclass(frozen=True, slots=True)
class Context:
    """What a computation knows besides robot and request.

    Attributes:
        units: Of the request and its answer.
        settings: What the deployment chose.
        form: Media type of the answer.
        symbolic: The processes for symbolic work.
        programs: The processes for whole paths.
        language: What the answer is written in.
        doubts: Collects what was accepted but is probably not meant.
    """

    units: Units
    settings: Settings
    doubts: RequestDoubts
    form: str = JSON
    symbolic: SymbolicWorkers | None = None
    programs: ProcessPool | None = None
    language: Language = ENGLISH

    @property
    def warnings(self) -> list[str]:
        """What was accepted but is probably not meant, for the answer, the gravest first."""
        return self.doubts.warnings

    def symbolic_workers(self) -> SymbolicWorkers:
        """Return the processes for symbolic work."""
        assert self.symbolic is not None
        return self.symbolic


class Answer(msgspec.Struct, frozen=True):
    """What a computation gives: a payload for JSON and text, and what the other forms hold.

    Attributes:
        payload: What JSON and text show, of the answer type of the operation.
        array: What npy holds.
        headers: Further headers.
        text: What text shows, where that is not the payload.
        listing: The whole answer in any other form than JSON.
        sheet: Makes the table that CSV holds.
        latex: Writes what LaTeX holds, with so many decimals; where there is none, the table.
        picture: Draws it as SVG, from which PNG is made.
        records: Makes what npy holds where each row comes with its status: rows with named fields.
    """

    payload: Mapping[str, Any]
    array: FloatArray | None = None
    headers: dict[str, str] | None = None
    text: Mapping[str, Any] | None = None
    listing: str | None = None
    sheet: SheetSource | None = None
    latex: Callable[[int | None], str] | None = None
    picture: Callable[[], str] | None = None
    records: Callable[[], NDArray[Any]] | None = None


@dataclass(frozen=True, eq=False)
class Operation:
    """One computation of the API.

    Attributes:
        name: Last part of its path.
        summary: One line for the documents.
        description: More for the documents.
        request: Type of the request, whose annotations declare its fields.
        answer: Type of the answer's JSON, a TypedDict.
        memory: What a request will need, from its sizes and the form of the answer.
        run: The computation.
        example: A body that works on ``example_robot``.
        example_robot: Id of a shipped robot.
        runs: Where it runs.
        forms: Media types of the answer, the default first.
        npy_field: Field that a body of type npy stands for, if there is one.
        attempt: Gives the answer if that takes so little time that a thread would only cost, else
            None; by default the computation itself for one q.
        stream: The answer in parts, each a list of rows, where it can be sent while it grows.
        needs: Name of an optional package that part of it needs.
        statuses: Whether rows of its npy can come with their statuses.
        installed: Whether base, tool and limits of the robot may be given for one request.
        lengths: Whether lengths of request and answer may be in mm.
        orientations: Whether its answer has orientations, which may be written in further ways.
    """

    name: str
    summary: str
    description: str
    request: type[msgspec.Struct]
    answer: type
    memory: Callable[[Robot, Any, Context], Need]
    run: Callable[[Robot, Any, Context], Answer]
    example: dict[str, Any]
    example_robot: str
    runs: Runs = Runs.EVENT_LOOP
    forms: tuple[str, ...] = ARRAY_FORMS
    npy_field: str | None = None
    attempt: Callable[[Robot, Any, Context], Answer | None] | None = None
    stream: Callable[[Robot, Any, Context], Iterator[list[dict[str, Any]]]] | None = None
    needs: str | None = None
    statuses: bool = False
    installed: bool = True
    orientations: bool = False
    lengths: bool = True

    @property
    def parameters(self) -> tuple[str, ...]:
        """Parameters of every form that are no fields of its request."""
        # A listing of closed forms is no table of numbers.
        words = self.runs is not Runs.PROCESS and any(form in (TEXT, CSV) for form in self.forms)
        table = words and CSV in self.forms
        more = [
            *(["digits"] if words else ()),
            *(["decimal"] if table else ()),
            *(["with"] if self.statuses else ()),
            *(["orientation"] if self.orientations else ()),
            *(["length"] if self.lengths else ()),
        ]
        return (*COMMON, *more)

    @cached_property
    def form(self) -> RequestForm[Any]:
        """How its request is given and read."""
        return form_of(self.request, installed=self.installed)

    def run_at_once(self, robot: Robot, request: Any, context: Context) -> Answer | None:
        """Return the answer if it takes so little time that a thread would only cost; else None."""
        if self.runs is not Runs.EVENT_LOOP:
            return None
        if self.attempt is not None:
            return self.attempt(robot, request, context)
        return self.run(robot, request, context) if is_light(robot, request) else None


def is_light(robot: Robot, request: Any) -> bool:
    """Return whether a request is about one q of a robot of ordinary size."""
    return is_one(request.q) and robot.dof <= LIGHT_DOF and len(robot.frames) <= LIGHT_FRAMES


def check_size(q: FloatArray, numbers: int, argument: str = "q") -> None:
    """Refuse a request whose answer would fill the memory.

    Args:
        q: Shape (dof,) or (n, dof).
        numbers: Numbers in the answer for one q.
        argument: The field at fault.

    Raises:
        RequestProblem: The answer would hold over ``MAX_NUMBERS``.
    """
    total = numbers * (len(q) if q.ndim == 2 else 1)
    if total > MAX_NUMBERS:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "the answer would hold {total} numbers; at most {max_numbers} are"
                " given, send parts",
                total=total,
                max_numbers=MAX_NUMBERS,
            ),
            f"/{argument}",
        )
