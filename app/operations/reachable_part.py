"""What of a target is within reach, as an answer shows it."""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict

from app.http.units import Units
from app.operations.joint_values import joint_values_view
from app.operations.shapes import Vector
from kinematics.inverse.reachable import Reachable
from robots.robot import Robot


class ReachableView(TypedDict):
    """A q within the limits that reaches a part of a target; errors in m and rad.

    ``given_up``: what it does not reach. ``direction_error``: of the tool's axis z alone;
    ``rotation_error``: about it, with its sign.
    """

    q: Vector
    joint_values: NotRequired[dict[str, float]]
    given_up: list[Literal["position", "direction_of_tool_axis", "rotation_about_tool_axis"]]
    position_error: float
    orientation_error: float
    direction_error: float
    rotation_error: NotRequired[float]


def reachable_view(robot: Robot, part: Reachable, units: Units) -> ReachableView:
    """Return a part of a target that is within reach, in the units of the answer."""
    view: ReachableView = {
        "q": units.joints_out(robot, part.q),
        **joint_values_view(robot, part.q, units),  # type: ignore[typeddict-item]
        "given_up": [one.value for one in part.given_up],
        "position_error": units.length_out(part.position_error),
        "orientation_error": part.orientation_error,
        "direction_error": part.direction_error,
    }
    if part.rotation_error is not None:
        view["rotation_error"] = part.rotation_error
    return view
