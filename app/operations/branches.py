"""Branches that were followed along targets, as an answer shows them."""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict

from app.http.units import Units
from app.operations.shapes import Vector
from kinematics.inverse.one_branch import BranchEnd
from robots.robot import Robot


class BranchEndView(TypedDict):
    """A branch: its q at the first target, and where and why it ends.

    ``index``: the first target that it does not reach; null: it reaches all. ``reason``: the limit
    of ``joint``, a singularity where branches meet, unreachable where the target is out of reach
    within the limits, or jump where the straight way to it is.
    """

    start: Vector
    posture: list[str]
    index: int | None
    reason: NotRequired[Literal["limit", "singularity", "unreachable", "jump"]]
    joint: NotRequired[str]
    limit: NotRequired[Literal["lower", "upper"]]


def branch_end_view(robot: Robot, one: BranchEnd, units: Units) -> BranchEndView:
    """Return where and why a branch ends, in the units of the answer."""
    view: BranchEndView = {
        "start": units.joints_out(robot, one.start),
        "posture": list(one.posture),
        "index": one.index,
    }
    if one.reason is not None:
        view["reason"] = one.reason
    if one.joint is not None and one.limit is not None:
        view["joint"], view["limit"] = one.joint, one.limit
    return view
