"""What forbids a target, as an answer shows it."""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict

from app.http.units import Units
from app.operations.shapes import Vector
from kinematics.inverse.forbidden import Forbidden, JointBeyond
from robots.robot import Robot


class JointBeyondView(TypedDict):
    """A joint beyond its limit, in the units of the answer."""

    joint: str
    value: float
    limit: float
    excess: float


class BranchBeyondView(TypedDict):
    """A solution that the limits forbid; the joints beyond them, the farthest first."""

    posture: list[str]
    q: Vector
    joints: list[JointBeyondView]


class ForbiddenView(TypedDict):
    """What forbids a target: its position, its orientation, or the limits, and by how much.

    ``proven``: that the target is out of reach is proved; it says nothing of the misses.
    ``position_miss``, in the unit of the answer, and ``orientation_miss``, rad: what is proved to
    be missed at the least where ``status`` of ``ik`` is unreachable by length or axes alone, and
    ``explanation`` tells the bound; else the smallest that a search found while the other is
    reached within the limits, never more than ``reachable`` shows. ``branches``, where limits
    forbid it: the solution of each that is least beyond them.
    """

    by: Literal["position", "orientation", "limits", "unknown"]
    proven: bool
    position_miss: NotRequired[float]
    orientation_miss: NotRequired[float]
    branches: NotRequired[list[BranchBeyondView]]


def forbidden_view(robot: Robot, found: Forbidden, units: Units) -> ForbiddenView:
    """Return what forbids a target, in the units of the answer."""
    view: ForbiddenView = {"by": found.by.value, "proven": found.proven}
    if found.position_miss is not None:
        view["position_miss"] = units.length_out(found.position_miss)
    if found.orientation_miss is not None:
        view["orientation_miss"] = found.orientation_miss
    if found.branches:
        view["branches"] = [
            {
                "posture": list(one.posture),
                "q": units.joints_out(robot, one.q),
                "joints": [_joint(joint, units) for joint in one.joints],
            }
            for one in found.branches
        ]
    return view


def _joint(one: JointBeyond, units: Units) -> JointBeyondView:
    def out(value: float) -> float:
        return units.angle_out(value) if one.is_revolute else units.length_out(value)

    return {
        "joint": one.joint,
        "value": out(one.value),
        "limit": out(one.limit),
        "excess": out(one.excess),
    }
