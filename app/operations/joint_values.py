"""Values of all joints of robots whose joints depend on each other, beside q in answers."""

from __future__ import annotations

from typing import Any, TypedDict

from app.http.units import Units
from kinematics.configuration import joint_values_of
from robots.robot import FloatArray, Robot


class JointValues(TypedDict, total=False):
    """Of a robot with followers or couplings: what each joint that moves turns or slides by."""

    joint_values: dict[str, Any]


def joints_shown(robot: Robot) -> int:
    """Return how many values :func:`joint_values_view` shows for one q."""
    return 0 if robot.coupled is None else len(robot.moving)


def joint_values_view(robot: Robot, q: FloatArray, units: Units) -> JointValues:
    """Return the values of all joints, nothing where q holds them.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        units: Those of the answer.
    """
    if robot.coupled is None:
        return {}
    turns = {joint.name: joint.type.is_revolute for joint in robot.moving}
    found = joint_values_of(robot, q)
    return {
        "joint_values": {
            name: one.item() if one.ndim == 0 else one
            for name, value in found.items()
            for one in (units.angles_out(value) if turns[name] else units.lengths_out(value),)
        }
    }
