"""What the columns of answers are called: the only place of these texts."""

from __future__ import annotations

from enum import StrEnum


class Heading(StrEnum):
    """A heading, or with the name of a joint after it the beginning of one."""

    SAMPLE = "sample"
    SOLUTION = "solution"
    FRAME = "frame"
    STATUS = "status"
    TIME = "t"
    PART = "r"
    Q = "q"
    VELOCITY = "qd"
    ACCELERATION = "qdd"
    JOINT_VALUE = "joint"
    X = "x"
    Y = "y"
    Z = "z"
    ROTATION = "R"
    QUATERNION = "quaternion"
    ROLL = "roll"
    PITCH = "pitch"
    YAW = "yaw"
    RPY_DEGENERATE = "rpy_degenerate"
    ORIENTATION = "orientation"
    EULER = "euler"
    EULER_DEGENERATE = "euler_degenerate"
    POSITION_ERROR = "position_error"
    ORIENTATION_ERROR = "orientation_error"
    CLEARANCE = "clearance"
    CLEARANCE_SWEPT = "clearance_swept"
    MANIPULABILITY = "manipulability"
    ROW = "row"
    ROW_UNIT = "unit"
    POSTURE = "posture"
    WITHIN_LIMITS = "within_limits"
    BEYOND_LIMITS = "beyond_limits"
    FREE = "free"
    SWIVEL = "swivel"
    ITERATIONS = "iterations"
    RESTARTS = "restarts"
    ELAPSED = "elapsed"
    RANK = "rank"
    SINGULAR = "singular"
    CONDITION_NUMBER = "condition_number"
    SINGULAR_VALUE = "sigma"
    ISOTROPY = "isotropy"
    FACTOR = "factor"
    DETERMINANT = "determinant"
    WARNINGS = "warnings"


def numbered(heading: Heading, *names: object) -> str:
    """Return a heading for one of several, such as ``q_j1`` or ``sigma_2``."""
    return "_".join((heading.value, *map(str, names)))


def with_unit(heading: str, unit: str) -> str:
    """Return a heading with its unit: ``q_j1 [rad]``; without brackets where it has none."""
    return f"{heading} [{unit}]" if unit else heading
