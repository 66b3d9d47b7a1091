"""Explanation of the construction of a table in words, one step a pair of axes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dh_to_urdf.extraction.construction import ConstructedPair
from dh_to_urdf.extraction.extract import Extraction, PairFinding
from dh_to_urdf.extraction.normals import ROUNDING, Case
from dh_to_urdf.messages import chained, say
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
        words = chained(" ", _sentences(k, finding, extraction, previous[:3, 3]))
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
        words = say(
            "Frame 0 is {base} itself: its z is the axis of {first} (axis 1).",
            base=chain.base,
            first=first,
        )
    else:
        moved = np.array_equal(extraction.table.base, np.eye(4))
        leads = say("a and α of row 1 lead") if moved else say("The matrix `base` leads")
        words = say(
            "z of {base} is not the axis of {first} (axis 1), so frame 0 is a new"
            " one: z_0 along axis 1, the origin at {frame}, which is the point of"
            " that axis nearest to {base}, and x_0 = {frame_2}. {leads} there.",
            base=chain.base,
            first=first,
            frame=_point(frame[:3, 3]),
            frame_2=_direction(frame[:3, 0]),
            leads=leads,
        )
    origin = frame[:3, 3]
    return Step(0, (first,), None, None, None, origin, origin, frame[:3, 0], words)


def _sentences(k: int, finding: PairFinding, extraction: Extraction, previous: Matrix) -> list[str]:
    pair = finding.pair
    last = k == len(extraction.findings)
    said: list[str] = []
    if pair.first.type is JointType.PRISMATIC:
        said.append(
            say(
                "{first} slides, so only the direction of its axis counts; the line is"
                " drawn through {point}.",
                first=pair.first.name,
                point=_point(pair.first.point),
            )
        )
    if pair.first.type is JointType.FIXED:
        said.append(
            say(
                "Axis {k} belongs to no joint: it is a fixed line at right angles to"
                " both neighbours, which are only {bridged:.2g} rad from parallel, so"
                " that their own common normal would stand far outside the robot.",
                k=k,
                bridged=finding.bridged,
            )
        )
    if finding.snapped:
        cost = (
            say("the tool makes up for it, so it costs nothing")
            if last
            else say(
                "what that costs is in the residual, {position:.1e} m",
                position=extraction.residual.position,
            )
        )
        said.append(
            say(
                "They are {snapped:.2g} rad from parallel and taken as parallel; {cost}.",
                snapped=finding.snapped,
                cost=cost,
            )
        )
    said.append(_relation(k, pair, last))
    said.append(_normal(k, pair, last, extraction, previous))
    said.append(_result(k, pair, last, extraction))
    return said


def _relation(k: int, pair: ConstructedPair, last: bool) -> str:
    first = say("Axis {k} ({first})", k=k, first=pair.first.name)
    second = say("axis {k} ({second})", k=k + 1, second=pair.second.name)
    if last:
        second = say("the tip's z, which stands for the next axis,")
    case = pair.normal.case
    if case is Case.COINCIDENT:
        return say(
            "{first} and {second} lie on one line: they are coincident.", first=first, second=second
        )
    if case is Case.PARALLEL:
        return say(
            "{first} and {second} are parallel, {length} apart.",
            first=first,
            second=second,
            length=_length(pair.normal.length),
        )
    angle = _angle(pair.normal.tilt)
    if case is Case.INTERSECTING:
        return say(
            "{first} and {second} intersect at {foot_on_first} under {angle}.",
            first=first,
            second=second,
            foot_on_first=_point(pair.foot_on_first),
            angle=angle,
        )
    return say(
        "{first} and {second} are skew: they pass each other {length} apart under {angle}.",
        first=first,
        second=second,
        length=_length(pair.normal.length),
        angle=angle,
    )


def _normal(
    k: int, pair: ConstructedPair, last: bool, extraction: Extraction, previous: Matrix
) -> str:
    x = f"x_{k} = {_direction(pair.x)}"
    case = pair.normal.case
    feet = say(
        "from {foot_on_first} on axis {k} to {foot_on_second}",
        foot_on_first=_point(pair.foot_on_first),
        k=k,
        foot_on_second=_point(pair.foot_on_second),
    )
    standard = extraction.table.convention is Convention.STANDARD
    if case is Case.SKEW:
        x += _turned(k, pair)
        return say(
            "One line only is at right angles to both, {feet}; {x} lies along it.", feet=feet, x=x
        )
    if case is Case.INTERSECTING:
        return say(
            "{x} stands there at right angles to both axes, to the side nearer to"
            " x_{k}; the common normal has no length.",
            x=x,
            k=k - 1,
        )
    beside = float(np.linalg.norm(pair.foot_on_first - previous)) <= 1e-9
    if case is Case.PARALLEL:
        x += _turned(k, pair)
        which = say("at the previous origin") if beside else say("that saves most lengths")
        return say(
            "Any common normal will do; the one {which} is taken, {feet}; {x} lies along it.",
            which=which,
            feet=feet,
            x=x,
        )
    if last and standard:
        there = _point(pair.foot_on_second)
        return say(
            "Any x will do; frame {k} is put into the tip itself, {x}, origin {there}.",
            k=k,
            x=x,
            there=there,
        )
    kept = say("x stays as it is at q = 0, {x}", x=x)
    where = (
        say("and so does the origin")
        if beside
        else say("and the origin is {foot_on_first}", foot_on_first=_point(pair.foot_on_first))
    )
    return say("Any x will do; {kept}, {where}.", kept=kept, where=where)


def _turned(k: int, pair: ConstructedPair) -> str:
    if pair.row.a >= 0.0:
        return ""
    return say(" (turned to the side nearer to x_{k}, so that the length is negative)", k=k - 1)


def _result(k: int, pair: ConstructedPair, last: bool, extraction: Extraction) -> str:
    row, standard = pair.row, extraction.table.convention is Convention.STANDARD
    is_revolute, slides = row.type.is_revolute, row.type is JointType.PRISMATIC
    theta = (
        f"θ_{k} = q{_offset(row.offset, _angle)}" if is_revolute else f"θ_{k} = {_angle(row.theta)}"
    )
    d = f"d_{k} = q{_offset(row.offset, _length)}" if slides else f"d_{k} = {_length(row.d)}"
    length, twist = _length(row.a), _angle(row.alpha)
    if standard:
        return say(
            "From frame {k} to frame {k_2}: {theta} about z_{k}, {d} along it, then"
            " a_{k_2} = {length} along x_{k_2} and α_{k_2} = {twist} about it.",
            k=k - 1,
            k_2=k,
            theta=theta,
            d=d,
            length=length,
            twist=twist,
        )
    khalil = extraction.table.convention is Convention.KHALIL
    z, a, r = ("r", "d", "khalil") if khalil else ("d", "a", "")
    d = d.replace("d_", f"{z}_", 1) if r else d
    there = (
        say("belong to the tool")
        if last and (row.a or row.alpha)
        else say("go into row {k}", k=k + 1)
    )
    if last and not (row.a or row.alpha):
        return say(
            "Frame {k} stands on axis {k}: {theta}, {d}; the rest is the tool.",
            k=k,
            theta=theta,
            d=d,
        )
    index = k + 1 if r else k
    return say(
        "Frame {k} stands on axis {k}: {theta}, {d}; {a}_{index} = {length}"
        " along x_{k} and α_{index} = {twist} about it {there}.",
        k=k,
        theta=theta,
        d=d,
        a=a,
        index=index,
        length=length,
        twist=twist,
        there=there,
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
