"""A request for closed forms, and its checks before any work."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.table import DHTable
from kinematics.errors import InvalidOption
from kinematics.symbolic.chain import BASE, TOOL, path_to
from kinematics.symbolic.length_names import Length, is_usable, written_name
from kinematics.symbolic.parameters import lengths_of
from kinematics.task import Task
from robots.errors import UnknownFrame, hint


class Quantity(StrEnum):
    """Quantities that can be written.

    ``A``: the link matrices A_k. ``T0``: the products 0A_k in frame 0. ``T``: the pose of the
    frame in the base, with its ``position`` and the columns of its ``rotation``. ``jacobian``: the
    geometric Jacobian. ``det_jacobian``: its determinant in factors; for a redundant arm those of
    its square parts. ``inverse_jacobian``: where J is square and small, its inverse, as a matrix
    and what it is divided by. ``inverse``: the inverse model in steps, of arms with a closed form.
    """

    A = "A"
    T0 = "T0"
    T = "T"
    POSITION = "position"
    ROTATION = "rotation"
    JACOBIAN = "jacobian"
    DET_JACOBIAN = "det_jacobian"
    INVERSE_JACOBIAN = "inverse_jacobian"
    INVERSE = "inverse"


class Notation(StrEnum):
    """Notation of expressions: short names as in lectures, LaTeX, or source of a function."""

    TEXT = "text"
    LATEX = "latex"
    PYTHON = "python"
    C = "c"
    MATLAB = "matlab"


CODE = (Notation.PYTHON, Notation.C, Notation.MATLAB)
PARAMETERS = ("numeric", "symbolic")
DEFAULT_BUDGET = 10.0
MAX_SYMBOLS = 256


@dataclass(frozen=True)
class SymbolicRequest:
    """Quantities to write, and their form.

    Attributes:
        quantities: The quantities.
        parameters: ``numeric``: lengths as numbers; ``symbolic``: by the names of
            :func:`kinematics.symbolic.parameters.lengths_of`.
        symbols: Pairs of a default name and another; with ``numeric`` only these lengths have a
            name.
        frame: The frame of pose and Jacobian: ``tool`` or ``frame_k``.
        base: The frame in whose axes the pose is given: ``base_link`` or ``frame_0``.
        expressed_in: The frame in whose axes the Jacobian is given; None for the base.
        task: Rows of the Jacobian, and of its determinant and inverse; None: all, and for these
            two those that do not vanish.
        notation: Notation of expressions.
        time_budget: Time for simplification, s.
        listing: Whether the answer is also given as one text.
    """

    quantities: tuple[Quantity, ...] = (Quantity.T,)
    parameters: str = "numeric"
    symbols: tuple[tuple[str, str], ...] = ()
    frame: str = TOOL
    base: str = BASE
    expressed_in: str | None = None
    task: Task | None = None
    notation: Notation = Notation.TEXT
    time_budget: float = DEFAULT_BUDGET
    listing: bool = False


def checked(table: DHTable, request: SymbolicRequest) -> SymbolicRequest:
    """Return the request with its quantities in the order of :class:`Quantity`, each once.

    Raises:
        InvalidOption: An option is unknown, a name cannot be used, or the time is not above 0.
        UnknownFrame: There is no such frame, or it is not between base and frame.
    """
    if not request.quantities:
        raise InvalidOption(
            say(
                "quantities is empty; name some of {quantity}, or all", quantity=", ".join(Quantity)
            ),
            argument="quantities",
            known=tuple(Quantity),
        )
    if request.parameters not in PARAMETERS:
        raise InvalidOption(
            say(
                "parameters is {parameters}; give numeric or symbolic",
                parameters=quoted(request.parameters),
            ),
            argument="parameters",
            value=request.parameters,
            known=PARAMETERS,
        )
    if not (math.isfinite(request.time_budget) and request.time_budget > 0):
        raise InvalidOption(
            say("time_budget is not above 0; give seconds"),
            argument="time_budget",
            value=request.time_budget,
            lower=0.0,
        )
    if request.base not in (BASE, "frame_0"):
        raise UnknownFrame(request.base, (BASE, "frame_0"), "base")
    frames = (TOOL, *(f"frame_{k}" for k in range(1, len(table.rows) + 1)))
    if request.frame not in frames:
        raise UnknownFrame(request.frame, frames, "frame")
    between = frames_between(table, request.base, request.frame)
    if request.expressed_in is not None and request.expressed_in not in between:
        raise UnknownFrame(request.expressed_in, between, "expressed_in")
    check_symbols(table, request)
    found = tuple(quantity for quantity in Quantity if quantity in request.quantities)
    return replace(request, quantities=found)


def quantity_from(name: str, argument: str = "quantities", index: Location = ()) -> Quantity:
    """Return a quantity by name.

    Raises:
        InvalidOption: There is none of this name.
    """
    if name not in list(Quantity):
        raise InvalidOption(
            say(
                "quantity {name} is unknown; {hint}",
                name=quoted(name),
                hint=hint(name, tuple(Quantity)),
            ),
            argument=argument,
            index=index,
            value=name,
            known=tuple(Quantity),
        )
    return Quantity(name)


def notation_from(name: str, argument: str = "format", index: Location = ()) -> Notation:
    """Return a notation by name.

    Raises:
        InvalidOption: There is none of this name.
    """
    if name not in list(Notation):
        raise InvalidOption(
            say(
                "format is {name}; give {notation}", name=quoted(name), notation=", ".join(Notation)
            ),
            argument=argument,
            index=index,
            value=name,
            known=tuple(Notation),
        )
    return Notation(name)


def frames_between(table: DHTable, base: str, frame: str) -> tuple[str, ...]:
    """Return the names of the frames from the base to a frame."""
    last = table.tip_row if frame == TOOL else int(frame.removeprefix("frame_"))
    start = (base,) if base == "frame_0" else (base, "frame_0")
    path = (f"frame_{k + 1}" for k in path_to(table, last))
    return (*start, *path, *((TOOL,) if frame == TOOL else ()))


def check_symbols(table: DHTable, request: SymbolicRequest) -> None:
    """Refuse names that cannot be used.

    Raises:
        InvalidOption: A name is unknown, cannot be used, or stands for unequal lengths.
    """
    if len(request.symbols) > MAX_SYMBOLS:
        raise InvalidOption(
            say("symbols holds over {max_symbols} names", max_symbols=MAX_SYMBOLS),
            argument="symbols",
            value=len(request.symbols),
            upper=MAX_SYMBOLS,
        )
    lengths = lengths_of(table)
    values = {name: length.value for length in lengths for name in length.names}
    chosen = dict(request.symbols)
    for default, name in request.symbols:
        if default not in values:
            known = (
                hint(default, tuple(values)) if values else say("every length of the table is 0")
            )
            raise InvalidOption(
                say(
                    "the table has no length {default}; {known}",
                    default=quoted(default),
                    known=known,
                ),
                argument="symbols",
                index=(default,),
                value=default,
                known=tuple(values),
            )
        if not is_usable(name):
            raise InvalidOption(
                say(
                    "{name} cannot name {default}; give letters and a number such as L1"
                    " (C1, S1, q1, t1, x1 and words of Python and C are taken)",
                    name=quoted(name),
                    default=default,
                ),
                argument="symbols",
                index=(default,),
                value=name,
            )
    _check_shared(lengths, chosen, request.parameters == "symbolic")


def _check_shared(lengths: Sequence[Length], chosen: Mapping[str, str], symbolic: bool) -> None:
    named: dict[str, tuple[str, float]] = {}
    for length in lengths:
        name, sign = written_name(length, chosen, symbolic=symbolic)
        if name is None:
            continue
        default, value = length.name, sign * length.value
        other, known = named.setdefault(name, (default, value))
        if known != value:
            raise InvalidOption(
                say(
                    "{name} would name both {other} = {known:g} and {default} = {value:g};"
                    " give each its own name",
                    name=name,
                    other=other,
                    known=known,
                    default=default,
                    value=value,
                ),
                argument="symbols",
                index=(default if default in chosen else other,),
                value=name,
            )
