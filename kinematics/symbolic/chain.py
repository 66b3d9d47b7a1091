"""The chain of frames between two frames of a D-H table."""

from __future__ import annotations

from dataclasses import dataclass

from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType
from kinematics.symbolic.names import Names
from kinematics.symbolic.parameters import lengths_of
from kinematics.symbolic.polynomial import Polynomial
from kinematics.symbolic.steps import (
    AboutX,
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
    """A joint on a chain.

    Attributes:
        joint: Its number in q, from 1.
        node: Index of the frame on whose z axis it moves.
        sign: -1 where q is measured against z.
        is_revolute: Whether it is revolute.
    """

    joint: int
    node: int
    sign: int
    is_revolute: bool


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
            (length.row, length.column): names.length(length.name, length.value)
            for length in lengths_of(table)
        }
        self._numbers = {k: n for n, k in enumerate(table.moving_rows, start=1)}

    def joint(self, k: int) -> int | None:
        """Return the number in q of row k (from 0); None for a fixed row."""
        return self._numbers.get(k)

    def row(self, k: int) -> list[Step]:
        """Return the steps of A_{k+1}."""
        row, joint = self.table.rows[k], self.joint(k)
        a, d, b = (self._length(k + 1, column) for column in ("a", "d", "b"))
        if row.type is JointType.PRISMATIC and joint is not None:
            d = self.names.variable(joint).scaled(row.sign) + self._length(k + 1, "offset")
        turn = about_z(row.offset, joint, row.sign) if row.type.is_revolute else about_z(row.theta)
        twist: list[Step] = [AboutX(row.alpha)]
        if self.table.convention is Convention.STANDARD:
            return [*turn, *along(z=d), *along(x=a), *twist]
        branch = [*about_z(row.gamma), *along(z=b)]
        return [*branch, *along(x=a), *twist, *turn, *along(z=d)]

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
        axes += _axis(table.convention, table.rows[k], steps_of.joint(k), len(frames) - 1)
    if frame == TOOL:
        frames.append(TOOL)
        steps.append(tuple(steps_of.placement(-1, table.tool)))
    return Chain(names, tuple(frames), tuple(steps), tuple(axes))


def _axis(convention: Convention, row: DHRow, joint: int | None, node: int) -> list[Axis]:
    if joint is None:
        return []
    on = node - 1 if convention is Convention.STANDARD else node
    return [Axis(joint, on, row.sign, row.type.is_revolute)]
