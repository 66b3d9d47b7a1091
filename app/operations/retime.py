"""The field retime of a path, and what the answer says of the motion."""

from __future__ import annotations

from typing import Annotated, TypedDict

import msgspec
import numpy as np

from app.fields.per_joint import PerJoint, read_per_joint
from app.operations.operation import Context
from app.operations.shapes import Matrix, Vector
from dh_to_urdf.messages import say
from kinematics.errors import InvalidOption
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.judging.summary import finite
from kinematics.redundancy.timing.result import Retimed
from kinematics.redundancy.timing.toppra import RetimeOptions, require_toppra
from robots.robot import FloatArray, Robot

LEAST, MOST = 1e-6, 1e9


class RetimeField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Asks for the joint path in the shortest time, at rest at both ends, instead of in tf."""

    acceleration: Annotated[
        PerJoint | None,
        msgspec.Meta(
            description="Largest accelerations: a number for all joints, a list with one a joint"
            " in the robot's order, or an object {joint name: value}; rad/s² (degrees with"
            " ?angle=deg) and m/s². Default: the robot's, where its URDF has `acceleration` in"
            " every <limit>."
        ),
    ] = None
    velocity: Annotated[
        PerJoint | None,
        msgspec.Meta(
            description="Largest speeds, where they are lower than the robot's own or those are not"
            " known; likewise, rad/s and m/s. Default: the robot's."
        ),
    ] = None
    samples: Annotated[
        int | None,
        msgspec.Meta(description="Of the motion, equally spaced in time; default as the path's."),
    ] = None


class TimingView(TypedDict):
    """The path in the shortest time: a cubic spline through its samples, timed by TOPP-RA.

    ``status`` is retimed, no_motion (the arm does not move) or no_parametrisation (none was found;
    the message says why). ``success`` is measured, between samples as well: speeds, accelerations,
    joint limits, clearance and the task path hold, and the end is reached; ``violations`` names
    what does not. ``velocity_ratio`` and ``acceleration_ratio`` are the largest parts of the limits
    that are used, ``slowed`` by how much the motion had to be slowed down to keep them. The
    deviations are the largest from the task path as a curve, m and rad; ``clearance`` is a lower
    bound. Limits are null where there are none.
    """

    status: str
    success: bool
    message: str
    violations: list[str]
    warnings: list[str]
    duration: float | None
    velocity_limits: list[float | None]
    acceleration_limits: list[float | None]
    velocity_ratio: float | None
    acceleration_ratio: float | None
    slowed: float
    max_position_deviation: float | None
    max_orientation_deviation: float | None
    min_clearance: float | None
    limit_margin: float | None


class MotionSamples(TypedDict):
    """Samples of a motion."""

    t: Vector
    q: Matrix
    velocity: Matrix
    acceleration: Matrix


class RetimedMotion(TimingView, MotionSamples):
    """A motion in the shortest time: its verdict, its figures and its samples."""


def read_retime(
    field: RetimeField | None, arm: Arm, samples: int, context: Context
) -> RetimeOptions | None:
    """The options of a request, None where it does not ask for a timing.

    Raises:
        InvalidOption: No acceleration is given or known, or a value is out of range.
        MethodUnavailable: toppra is not installed.
    """
    if field is None:
        return None
    velocity = field.velocity
    options = RetimeOptions(
        _acceleration(field, arm, context),
        None if velocity is None else _limits(velocity, arm, "velocity", context),
        samples if field.samples is None else field.samples,
    )
    require_toppra()
    return options


def _acceleration(field: RetimeField, arm: Arm, context: Context) -> FloatArray:
    """The accelerations of the request; without them, those of the robot's document."""
    if field.acceleration is not None:
        return _limits(field.acceleration, arm, "acceleration", context)
    unknown = [name for name, a in zip(arm.names, arm.acceleration, strict=True) if np.isinf(a)]
    if unknown:
        raise InvalidOption(
            say(
                "retime lacks acceleration, and the robot's document has no limit of it for joint"
                " {name}; give a number for all joints, or one a joint",
                name=unknown[0],
            ),
            argument="retime",
            index=("acceleration",),
        )
    return arm.acceleration.clip(LEAST, MOST)


def _limits(value: PerJoint, arm: Arm, name: str, context: Context) -> FloatArray:
    found = read_per_joint(value, arm, LEAST, MOST, "retime", (name,))
    return arm.reduced(context.units.joints_in(arm.robot, found))


def timing_view(robot: Robot, motion: Retimed, arm: Arm, context: Context) -> TimingView:
    """Verdict and figures of a motion, without its samples."""
    unit = context.units.joints_out(robot, np.ones(robot.dof))
    return {
        "status": motion.status,
        "success": motion.success,
        "message": motion.message,
        "violations": list(motion.violations),
        "warnings": list(motion.warnings),
        "duration": motion.duration,
        "velocity_limits": [finite(float(v)) for v in motion.velocity_limits * unit],
        "acceleration_limits": [finite(float(a)) for a in motion.acceleration_limits * unit],
        "velocity_ratio": finite(motion.velocity_ratio),
        "acceleration_ratio": finite(motion.acceleration_ratio),
        "slowed": motion.slowed,
        "max_position_deviation": finite(context.units.length_out(motion.position_deviation)),
        "max_orientation_deviation": finite(motion.orientation_deviation),
        "min_clearance": finite(context.units.length_out(motion.clearance)),
        "limit_margin": finite(float((motion.limit_margin * unit[arm.chain.columns]).min())),
    }


def motion_samples(robot: Robot, motion: Retimed, context: Context) -> MotionSamples:
    """The samples of a motion for the answer."""
    out = context.units.joints_out
    return {
        "t": motion.t,
        "q": out(robot, motion.q),
        "velocity": out(robot, motion.velocity),
        "acceleration": out(robot, motion.acceleration),
    }
