"""Self-motions of redundant arms, as an answer shows them."""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict

from app.http.units import Units
from app.operations.shapes import Matrix, Vector
from kinematics.inverse.self_motion.result import CurveEnd, SelfMotion, SelfMotionCurve
from robots.robot import Robot


class CurveEndView(TypedDict):
    """Why a curve ends: a limit of a joint, a singularity, or never (unbounded)."""

    reason: Literal["limit", "singularity", "unbounded"]
    joint: NotRequired[str]
    limit: NotRequired[Literal["lower", "upper"]]


class SelfMotionCurveView(TypedDict):
    """A curve of q within the limits; ``lower`` and ``upper``: the range of each joint along it.

    ``parameter``: the swivel angle or the joint at each of its ``q``, of which an arc's first and
    last are its ends. ``ends``, of an arc: why it ends at its first and at its last q. ``turns``,
    of a closed curve: whole turns that each joint makes around it.
    """

    topology: Literal["closed", "arc"]
    posture: list[str]
    interval: Vector
    lower: Vector
    upper: Vector
    ends: list[list[CurveEndView]]
    turns: NotRequired[list[int]]
    parameter: Vector
    q: Matrix


class SelfMotionView(TypedDict):
    """The set of all solutions of an arm with more joints than the task needs.

    ``dimension`` of the set; 1: curves, each followed to its ends. ``parameter``: ``swivel``, or
    the joint that they are told by. ``complete``: mathematics knows no other curves.
    ``without_limits``: number of curves without regard to limits.
    """

    dimension: int
    parameter: str | None
    complete: bool
    without_limits: int
    curves: list[SelfMotionCurveView]


def self_motion_view(robot: Robot, found: SelfMotion, units: Units) -> SelfMotionView:
    """Return self-motions in the units of the answer."""
    angular = found.parameter == "swivel" or any(
        joint.name == found.parameter and joint.type.is_revolute for joint in robot.joints
    )
    return {
        "dimension": found.dimension,
        "parameter": found.parameter,
        "complete": found.complete,
        "without_limits": found.unlimited,
        "curves": [_curve(robot, one, units, angular) for one in found.curves],
    }


def _curve(robot: Robot, one: SelfMotionCurve, units: Units, angular: bool) -> SelfMotionCurveView:
    values = units.angles_out(one.parameter) if angular else units.lengths_out(one.parameter)
    view: SelfMotionCurveView = {
        "topology": "closed" if one.closed else "arc",
        "posture": list(one.posture),
        "interval": values[[0, -1]],
        "lower": units.joints_out(robot, one.lower),
        "upper": units.joints_out(robot, one.upper),
        "ends": [[_end(each) for each in end] for end in one.ends],
        "parameter": values,
        "q": units.joints_out(robot, one.q),
    }
    if one.closed:
        view["turns"] = list(one.turns)
    return view


def _end(one: CurveEnd) -> CurveEndView:
    view: CurveEndView = {"reason": one.reason}
    if one.joint is not None and one.limit is not None:
        view["joint"], view["limit"] = one.joint, one.limit
    return view
