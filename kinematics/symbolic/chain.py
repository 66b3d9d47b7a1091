"""The chain of frames between two frames of a D-H table."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dh_to_urdf.couplings import joint_map, moving_joints
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType
from kinematics.symbolic.angles import Angle
from kinematics.symbolic.names import Names
from kinematics.symbolic.parameters import lengths_of
from kinematics.symbolic.polynomial import Polynomial
from kinematics.symbolic.steps import (
    AboutX,
    AboutZ,
    Pose,
    Shift,
    Step,
    Turn,
    Vector,
    Walker,
    about_z,
    along,
    backwards,
)

BASE, TOOL = "base_link", "tool"


@dataclass(frozen=True, slots=True)
class Axis:
    """A joint on a chain, or what an entry of q moves it by.

    Attributes:
        joint: Number of the entry of q, from 1.
        node: Index of the frame on whose z axis it moves.
        sign: -1 where q is measured against z.
        is_revolute: Whether it is revolute.
        factor: What the entry of q is multiplied with in the joint's value.
    """

    joint: int
    node: int
    sign: int
    is_revolute: bool
    factor: float = 1


@dataclass(frozen=True)
class Chain:
    """Consecutive frames.

    Attributes:
        names: Symbols of the computation.
        frames: Names of the frames.
        steps: ``steps[i]`` lead from frame i to frame i + 1.
        axes: The joints between the first frame and the last.
    """

    names: Names
    frames: tuple[str, ...]
    steps: tuple[tuple[Step, ...], ...]
    axes: tuple[Axis, ...]

    def poses(self, node: int) -> list[Pose]:
        """Return all frames in the axes of one of them."""
        ahead, behind = Walker(self.names), Walker(self.names)
        after = [ahead.go(steps) for steps in self.steps[node:]]
        before = [behind.go(backwards(steps)) for steps in self.steps[:node][::-1]]
        return [*before[::-1], Pose(), *after]

    def node(self, frame: str) -> int:
        """Return the index of a frame."""
        return self.frames.index(frame)


class Steps:
    """Elementary steps of a table's rows, base and tool."""

    def __init__(self, table: DHTable, names: Names) -> None:
        self.table = table
        self.names = names
        self._lengths = {
            (length.row, length.column): names.length(length) for length in lengths_of(table)
        }
        self._values = values_of(table)

    def terms(self, k: int) -> tuple[tuple[int, float], ...]:
        """Return the entries of q in the value of row k (from 0), and their factors."""
        return self._values[k][0] if k in self._values else ()

    def row(self, k: int) -> list[Step]:
        """Return the steps of A_{k+1}."""
        row = self.table.rows[k]
        a, d, b = (self._length(k + 1, column) for column in ("a", "d", "b"))
        if row.type is JointType.PRISMATIC:
            d = self._slide(k)
        turn = self._turn(k) if row.type.is_revolute else about_z(row.theta)
        twist: list[Step] = [AboutX(row.alpha)]
        if self.table.convention is Convention.STANDARD:
            return [*turn, *along(z=d), *along(x=a), *twist]
        branch = [*about_z(row.gamma), *along(z=b)]
        return [*branch, *along(x=a), *twist, *turn, *along(z=d)]

    def _turn(self, k: int) -> list[Step]:
        terms, constant = self._values[k]
        sign, offset = self.table.rows[k].sign, self.table.rows[k].offset
        multiples = tuple(sorted((joint, sign * round(factor)) for joint, factor in terms))
        angle = math.remainder(offset + sign * constant, 2 * math.pi)
        return [AboutZ(Angle(multiples, angle))] if multiples else about_z(angle)

    def _slide(self, k: int) -> Polynomial:
        terms, constant = self._values[k]
        sign, found = self.table.rows[k].sign, Polynomial({})
        for joint, factor in terms:
            found += self.names.variable(joint) * factor_of(sign * factor, self.names)
        return found + self._length(k + 1, "offset") + self.names.number(sign * constant)

    def placement(self, number: int, placement: Matrix) -> list[Step]:
        """Return the steps of the base (0) or the tool (-1)."""
        origin: Vector = (
            self._length(number, "x"),
            self._length(number, "y"),
            self._length(number, "z"),
        )
        steps: list[Step] = [Shift(origin)] if any(origin) else []
        entry = self.names.entry
        columns = [
            (entry(float(x)), entry(float(y)), entry(float(z))) for x, y, z in placement[:3, :3].T
        ]
        turn = Turn((columns[0], columns[1], columns[2]))
        return [*steps, *([] if turn == Turn(Pose().axes) else [turn])]

    def _length(self, row: int, column: str) -> Polynomial:
        return self._lengths.get((row, column), Polynomial.constant(0))


def factor_of(value: float, names: Names) -> Polynomial:
    """Return a factor: a whole number as it is, any other as a symbol of its own."""
    if value == round(value):
        return Polynomial.constant(round(value))
    return names.number(value)


def values_of(table: DHTable) -> dict[int, tuple[tuple[tuple[int, float], ...], float]]:
    """Return the values of the rows that move, by row from 0.

    Each as entries of q, numbered from 1, with their factors, and a constant.
    """
    moving = table.moving_rows
    if not table.is_coupled:
        return {k: (((n, 1),), 0.0) for n, k in enumerate(moving, start=1)}
    found = joint_map(*moving_joints(table))
    return {
        k: (
            tuple((n + 1, float(line[n])) for n in range(len(line)) if line[n] != 0.0),
            float(constant),
        )
        for k, line, constant in zip(moving, found.matrix, found.offset, strict=True)
    }


def fraction_in(table: DHTable) -> str | None:
    """Return the name of a joint that turns by a fraction of an entry of q; None: none does."""
    values = values_of(table) if table.is_coupled else {}
    for k, (terms, _) in values.items():
        row = table.rows[k]
        if row.type.is_revolute and any(factor != round(factor) for _, factor in terms):
            return row.name
    return None


def path_to(table: DHTable, frame: int) -> list[int]:
    """Return the indices of the rows from frame 0 to frame ``frame``, in this order."""
    path = []
    while frame:
        path.append(frame - 1)
        frame = table.rows[frame - 1].parent
    return path[::-1]


def chain_of(table: DHTable, names: Names, base: str, frame: str) -> Chain:
    """Return the chain from ``base`` (base_link or frame_0) to a frame.

    Args:
        table: The table.
        names: Symbols of the computation.
        base: Name of the first frame.
        frame: ``tool`` or ``frame_k``, or the first frame itself.
    """
    steps_of = Steps(table, names)
    last = table.tip_row if frame == TOOL else 0 if frame == BASE else int(frame.split("_")[1])
    frames, steps, axes = [base], [], []
    if base == BASE and frame != BASE:
        frames.append("frame_0")
        steps.append(tuple(steps_of.placement(0, table.base)))
    for k in path_to(table, last):
        frames.append(f"frame_{k + 1}")
        steps.append(tuple(steps_of.row(k)))
        axes += _axes(table.convention, table.rows[k], steps_of.terms(k), len(frames) - 1)
    if frame == TOOL:
        frames.append(TOOL)
        steps.append(tuple(steps_of.placement(-1, table.tool)))
    return Chain(names, tuple(frames), tuple(steps), tuple(axes))


def _axes(
    convention: Convention, row: DHRow, terms: tuple[tuple[int, float], ...], node: int
) -> list[Axis]:
    on = node - 1 if convention is Convention.STANDARD else node
    return [Axis(joint, on, row.sign, row.type.is_revolute, factor) for joint, factor in terms]
