"""Explanation of the construction of a table in words, one step a pair of axes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dh_to_urdf.extraction.construction import ConstructedPair
from dh_to_urdf.extraction.extract import Extraction, PairFinding
from dh_to_urdf.extraction.normals import ROUNDING, Case
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, JointType


@dataclass(frozen=True)
class Step:
    """One step of the construction.

    Attributes:
        frame: Number of the frame that it makes.
        axes: Names of the two joints; the second is ``tip`` in the last step; one at frame 0.
        case: skew, intersecting, parallel or coincident; None at frame 0.
        angle: Angle between the directed axes, rad, 0 to π; None at frame 0.
        distance: Their distance, m; None at frame 0.
        foot_on_first: Where their common normal meets the first axis, base axes, m.
        foot_on_second: Where it meets the second one.
        x: The frame's x axis in base axes.
        words: The step in words.
    """

    frame: int
    axes: tuple[str, ...]
    case: Case | None
    angle: float | None
    distance: float | None
    foot_on_first: Matrix
    foot_on_second: Matrix
    x: Matrix
    words: str


def explain(extraction: Extraction) -> tuple[Step, ...]:
    """Return the steps of a construction, frame 0 first."""
    steps = [_frame_zero(extraction)]
    previous = extraction.frame_zero
    for k, finding in enumerate(extraction.findings, start=1):
        pair = finding.pair
        u, v = pair.first.direction, pair.second.direction
        angle = math.atan2(float(np.linalg.norm(np.cross(u, v))), float(u @ v))
        words = " ".join(_sentences(k, finding, extraction, previous[:3, 3]))
        steps.append(
            Step(
                k,
                (pair.first.name, pair.second.name),
                pair.normal.case,
                angle,
                pair.normal.length,
                pair.foot_on_first,
                pair.foot_on_second,
                pair.x,
                words,
            )
        )
        previous = np.eye(4)
        previous[:3, 3] = pair.foot_on_second
    return tuple(steps)


def _frame_zero(extraction: Extraction) -> Step:
    frame, chain = extraction.frame_zero, extraction.chain
    first = chain.joints[0].name
    if np.abs(frame - np.eye(4)).max() <= ROUNDING:
        words = f"Frame 0 is {chain.base} itself: its z is the axis of {first} (axis 1)."
    else:
        moved = np.array_equal(extraction.table.base, np.eye(4))
        leads = "a and α of row 1 lead" if moved else "The matrix `base` leads"
        words = (
            f"z of {chain.base} is not the axis of {first} (axis 1), so frame 0 is a new one: z_0"
            f" along axis 1, the origin at {_point(frame[:3, 3])}, which is the point of that axis"
            f" nearest to {chain.base}, and x_0 = {_direction(frame[:3, 0])}. {leads} there."
        )
    origin = frame[:3, 3]
    return Step(0, (first,), None, None, None, origin, origin, frame[:3, 0], words)


def _sentences(k: int, finding: PairFinding, extraction: Extraction, previous: Matrix) -> list[str]:
    pair = finding.pair
    last = k == len(extraction.findings)
    said = []
    if pair.first.type is JointType.PRISMATIC:
        said.append(
            f"{pair.first.name} slides, so only the direction of its axis counts; the line is"
            f" drawn through {_point(pair.first.point)}."
        )
    if pair.first.type is JointType.FIXED:
        said.append(
            f"Axis {k} belongs to no joint: it is a fixed line at right angles to both neighbours,"
            f" which are only {finding.bridged:.2g} rad from parallel, so that their own common"
            " normal would stand far outside the robot."
        )
    if finding.snapped:
        cost = (
            "the tool makes up for it, so it costs nothing"
            if last
            else f"what that costs is in the residual, {extraction.residual.position:.1e} m"
        )
        said.append(
            f"They are {finding.snapped:.2g} rad from parallel and taken as parallel; {cost}."
        )
    said.append(_relation(k, pair, last))
    said.append(_normal(k, pair, last, extraction, previous))
    said.append(_result(k, pair, last, extraction))
    return said


def _relation(k: int, pair: ConstructedPair, last: bool) -> str:
    first = f"Axis {k} ({pair.first.name})"
    second = f"axis {k + 1} ({pair.second.name})"
    if last:
        second = "the tip's z, which stands for the next axis,"
    case = pair.normal.case
    if case is Case.COINCIDENT:
        return f"{first} and {second} lie on one line: they are coincident."
    if case is Case.PARALLEL:
        return f"{first} and {second} are parallel, {_length(pair.normal.length)} apart."
    angle = _angle(pair.normal.tilt)
    if case is Case.INTERSECTING:
        return f"{first} and {second} intersect at {_point(pair.foot_on_first)} under {angle}."
    return (
        f"{first} and {second} are skew: they pass each other {_length(pair.normal.length)} apart"
        f" under {angle}."
    )


def _normal(
    k: int, pair: ConstructedPair, last: bool, extraction: Extraction, previous: Matrix
) -> str:
    x = f"x_{k} = {_direction(pair.x)}"
    case = pair.normal.case
    feet = f"from {_point(pair.foot_on_first)} on axis {k} to {_point(pair.foot_on_second)}"
    standard = extraction.table.convention is Convention.STANDARD
    if case is Case.SKEW:
        x += _turned(k, pair)
        return f"One line only is at right angles to both, {feet}; {x} lies along it."
    if case is Case.INTERSECTING:
        return (
            f"{x} stands there at right angles to both axes, to the side nearer to x_{k - 1}; the"
            " common normal has no length."
        )
    beside = float(np.linalg.norm(pair.foot_on_first - previous)) <= 1e-9
    if case is Case.PARALLEL:
        x += _turned(k, pair)
        which = "at the previous origin" if beside else "that saves most lengths"
        return f"Any common normal will do; the one {which} is taken, {feet}; {x} lies along it."
    if last and standard:
        there = _point(pair.foot_on_second)
        return f"Any x will do; frame {k} is put into the tip itself, {x}, origin {there}."
    kept = f"x stays as it is at q = 0, {x}"
    where = (
        "and so does the origin" if beside else f"and the origin is {_point(pair.foot_on_first)}"
    )
    return f"Any x will do; {kept}, {where}."


def _turned(k: int, pair: ConstructedPair) -> str:
    if pair.row.a >= 0.0:
        return ""
    return f" (turned to the side nearer to x_{k - 1}, so that the length is negative)"


def _result(k: int, pair: ConstructedPair, last: bool, extraction: Extraction) -> str:
    row, standard = pair.row, extraction.table.convention is Convention.STANDARD
    is_revolute, slides = row.type.is_revolute, row.type is JointType.PRISMATIC
    theta = (
        f"θ_{k} = q{_offset(row.offset, _angle)}" if is_revolute else f"θ_{k} = {_angle(row.theta)}"
    )
    d = f"d_{k} = q{_offset(row.offset, _length)}" if slides else f"d_{k} = {_length(row.d)}"
    length, twist = _length(row.a), _angle(row.alpha)
    if standard:
        return (
            f"From frame {k - 1} to frame {k}: {theta} about z_{k - 1}, {d} along it, then a_{k} ="
            f" {length} along x_{k} and α_{k} = {twist} about it."
        )
    khalil = extraction.table.convention is Convention.KHALIL
    z, a, r = ("r", "d", "khalil") if khalil else ("d", "a", "")
    d = d.replace("d_", f"{z}_", 1) if r else d
    there = "belong to the tool" if last and (row.a or row.alpha) else f"go into row {k + 1}"
    if last and not (row.a or row.alpha):
        return f"Frame {k} stands on axis {k}: {theta}, {d}; the rest is the tool."
    index = k + 1 if r else k
    return (
        f"Frame {k} stands on axis {k}: {theta}, {d}; {a}_{index} = {length} along x_{k} and"
        f" α_{index} = {twist} about it {there}."
    )


def _offset(value: float, form: object) -> str:
    if value == 0.0:
        return ""
    shown = form(abs(value))  # type: ignore[operator]
    return f" {'+' if value > 0 else '-'} {shown}"


def _angle(value: float) -> str:
    return f"{_number(math.degrees(value))}°"


def _length(value: float) -> str:
    return f"{_number(value)} m"


def _point(value: Matrix) -> str:
    return f"({', '.join(_number(float(x)) for x in value)}) m"


def _direction(value: Matrix) -> str:
    return f"({', '.join(_number(float(x)) for x in value)})"


def _number(value: float) -> str:
    return f"{0.0 if abs(value) < 5e-10 else value:.6g}"
