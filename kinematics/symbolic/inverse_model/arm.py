"""A D-H table of any convention as joints and the links after them, with lengths by name.

Between two moving axes every convention has ``Rz Tz`` (part of the joint before or after) and
``Tx Rx``. Regrouped, the arm is ``B A_1 … A_n E`` with ``A_i = Rz(θ_i) Tz(d_i) Tx(a_i) Rx(α_i)``:
Paul's matrices, whatever the table's convention; of a modified table, a_i and α_i are those of the
next row.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from dh_to_urdf.table import Convention, DHTable, JointType
from kinematics.symbolic.chain import Steps, path_to, values_of
from kinematics.symbolic.names import Names
from kinematics.symbolic.parameters import lengths_of
from kinematics.symbolic.polynomial import ZERO, Polynomial
from kinematics.symbolic.steps import AboutX, Pose, Step, Walker, about_z, along

ANGLE = 1e-8
"""Angle, rad, within which a twist counts as a multiple of π/2, as for the closed forms."""
LENGTH = 1e-8
"""Length, relative to the arm, below which it counts as 0."""


class FixedBetween(ValueError):
    """A fixed row between two joints, which no regrouping takes away."""


@dataclass(frozen=True)
class Link:
    """A joint and the link after it.

    Attributes:
        row: Index of its row in the table.
        is_revolute: Whether it turns.
        sign: -1 where its coordinate runs against z.
        turn: θ - sign · coordinate of a turning joint; θ of a sliding one; rad.
        slide: d of a turning joint; d - sign · coordinate of a sliding one.
        a: a_i.
        alpha: α_i, rad.
    """

    row: int
    is_revolute: bool
    sign: int
    turn: float
    slide: Polynomial
    a: Polynomial
    alpha: float


@dataclass(frozen=True)
class Arm:
    """The chain from the base to the frame.

    Attributes:
        links: The joints that move, with the links between them; a and α of the last are 0.
        before: Steps from the base that the target is given in to axis 1.
        after: Steps from the last joint to the frame.
        mount: Steps from base_link to axis 1, whatever the target is given in.
        size: Sum of its lengths, m.
        rounded: Whether a twist or a length was rounded to what it nearly is.
    """

    links: tuple[Link, ...]
    before: tuple[Step, ...]
    after: tuple[Step, ...]
    mount: tuple[Step, ...]
    size: float
    rounded: bool = False

    @property
    def types(self) -> str:
        """Return ``RRPRRR`` and the like."""
        return "".join("R" if link.is_revolute else "P" for link in self.links)


@dataclass
class _Group:
    """Consecutive steps about and along z, or about and along x."""

    about_z: bool
    turn: float = 0.0
    slide: Polynomial = ZERO
    joint: int | None = None

    @property
    def is_trivial(self) -> bool:
        return self.joint is None and not self.slide and math.cos(self.turn) > 1 - 1e-24


@dataclass
class _Line:
    """Groups so far, z and x in turn."""

    groups: list[_Group] = field(default_factory=list)

    def add(self, new: _Group) -> None:
        last = self.groups[-1] if self.groups else None
        both = last is not None and last.joint is not None and new.joint is not None
        if last is None or last.about_z != new.about_z or both:
            if both:
                self.groups.append(_Group(about_z=False))
            self.groups.append(new)
            return
        last.turn += new.turn
        last.slide += new.slide
        last.joint = new.joint if last.joint is None else last.joint


def arm_of(table: DHTable, names: Names, base: str, frame: str) -> Arm:
    """Return the arm between two frames.

    Args:
        table: The table.
        names: Symbols; its lengths are entered there.
        base: ``base_link`` or ``frame_0``.
        frame: ``tool`` or ``frame_k``.

    Raises:
        FixedBetween: A fixed row between two joints is in the way.
    """
    steps = Steps(table, names)
    last = table.tip_row if frame == "tool" else int(frame.split("_")[1])
    rows = path_to(table, last)
    size = sum(abs(one.value) for one in lengths_of(table) if one.row - 1 in rows) or 1.0
    line = _Line()
    for k in rows:
        for group in _groups(table, names, k):
            line.add(group)
    groups, rounded = _rounded(line.groups, names, size)
    groups = _regrouped(groups)
    joints = [i for i, group in enumerate(groups) if group.joint is not None]
    placed = steps.placement(0, table.base)
    tool = steps.placement(-1, table.tool) if frame == "tool" else []
    if not joints:
        return Arm((), (), (), (), size)
    head = [step for group in groups[: joints[0]] for step in _steps(group)]
    tail = [step for group in groups[joints[-1] + 1 :] for step in _steps(group)]
    links = []
    for i in joints:
        between = groups[i + 1] if i != joints[-1] else _Group(about_z=False)
        links.append(_link(table, names, groups[i], between))
    return Arm(
        tuple(links),
        (*(placed if base == "base_link" else []), *head),
        (*tail, *tool),
        (*placed, *head),
        size,
        rounded,
    )


def _link(table: DHTable, names: Names, joint: _Group, between: _Group) -> Link:
    assert joint.joint is not None
    row = table.rows[joint.joint]
    turns, turn, slide = row.type.is_revolute, joint.turn, joint.slide
    turn += row.offset if turns else 0.0
    slide += ZERO if turns else _lengths(table, names).get((joint.joint + 1, "offset"), ZERO)
    turn = math.remainder(turn, 2 * math.pi)
    return Link(joint.joint, turns, row.sign, turn, slide, between.slide, between.turn)


def _lengths(table: DHTable, names: Names) -> dict[tuple[int, str], Polynomial]:
    return {(one.row, one.column): names.length(one) for one in lengths_of(table)}


def _groups(table: DHTable, names: Names, k: int) -> list[_Group]:
    """Return the groups of row k, from left to right."""
    row, known = table.rows[k], _lengths(table, names)
    a, d, b = (known.get((k + 1, column), ZERO) for column in ("a", "d", "b"))
    moves = row.type is not JointType.FIXED
    theta = 0.0 if row.type.is_revolute else row.theta
    joint = _Group(
        True, theta, ZERO if row.type is JointType.PRISMATIC else d, k if moves else None
    )
    across = _Group(False, row.alpha, a)
    if table.convention is Convention.STANDARD:
        return [joint, across]
    return [_Group(True, row.gamma, b), across, joint]


def _rounded(groups: list[_Group], names: Names, size: float) -> tuple[list[_Group], bool]:
    """Return the groups with twists near multiples of π/2 and tiny lengths as what they mean."""
    found, rounded = [], False
    for group in groups:
        turn, slide = group.turn, group.slide
        if not group.about_z:
            meant = round(turn / (math.pi / 2)) * math.pi / 2
            if abs(turn - meant) <= ANGLE:
                rounded |= abs(turn - meant) > 1e-12
                turn = math.remainder(meant, 2 * math.pi)
        if slide and group.joint is None and abs(constant(slide, names)) <= LENGTH * size:
            slide, rounded = ZERO, True
        found.append(replace(group, turn=turn, slide=slide))
    return found, rounded


def constant(p: Polynomial, names: Names) -> float:
    """Return the value of a polynomial in lengths and numbers."""
    values = {name: float(value) for name, value in names.numbers.items()}
    values |= {"sqrt(2)": math.sqrt(2), "sqrt(3)": math.sqrt(3)} | names.lengths
    return math.fsum(
        float(value) * math.prod(values[name] ** exponent for name, exponent in monomial)
        for monomial, value in p
    )


def _regrouped(groups: Sequence[_Group]) -> list[_Group]:
    """Return groups with one x group between two joints.

    Raises:
        FixedBetween: That is not possible without other lengths than the table's.
    """
    rest = [group for group in groups if not group.is_trivial or group.about_z]
    joints = [i for i, group in enumerate(rest) if group.joint is not None]
    if not joints:
        return list(rest)
    found = list(rest[: joints[0] + 1])
    for start, end in pairwise(joints):
        found += _between(found[-1], list(rest[start + 1 : end]))
        found.append(rest[end])
    return [*found, *rest[joints[-1] + 1 :]]


def _between(joint: _Group, groups: list[_Group]) -> list[_Group]:
    """Return one x group for those between two joints; what is along z goes into the joint."""
    along_x = _Group(about_z=False)
    for group in groups:
        if not group.about_z:
            along_x.slide += group.slide
            along_x.turn += group.turn
            continue
        quarters = along_x.turn / (math.pi / 2)
        flat = abs(math.sin(along_x.turn)) < 1e-12
        halves = abs(math.sin(group.turn)) < 1e-12
        sign = 1 if round(quarters) % 4 == 0 else -1
        if group.is_trivial:
            continue
        if not flat or not (halves or not along_x.slide):
            raise FixedBetween
        # Tx(a) Rx(0 or π) Rz(γ) Tz(b) = Rz(±γ) Tz(±b) Tx(±a) Rx(0 or π)
        joint.turn += sign * group.turn
        joint.slide += group.slide.scaled(sign)
        if halves and math.cos(group.turn) < 0:
            along_x.slide = -along_x.slide
    along_x.turn = math.remainder(along_x.turn, 2 * math.pi)
    return [along_x]


def _steps(group: _Group) -> list[Step]:
    if group.about_z:
        return [*about_z(math.remainder(group.turn, 2 * math.pi)), *along(z=group.slide)]
    return [*along(x=group.slide), AboutX(group.turn)]


def pose_of(steps: Sequence[Step], names: Names) -> Pose:
    """Return the pose that constant steps lead to."""
    return Walker(names).go(steps)


def coordinates(table: DHTable, arm: Arm) -> list[tuple[dict[int, float], float]]:
    """Return the coordinate of each link as entries of q, by number from 1, and a constant."""
    values = values_of(table)
    return [(dict(values[link.row][0]), values[link.row][1]) for link in arm.links]
