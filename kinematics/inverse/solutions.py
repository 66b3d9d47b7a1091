"""All solutions of one target, and which of them to take."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import numpy as np

from kinematics.inverse.self_motion.result import SelfMotion
from kinematics.jacobian import jacobian
from robots.robot import FloatArray, Robot


class Choice(StrEnum):
    """Which of several solutions to take."""

    CLOSEST = "closest"
    MOST_MANIPULABLE = "most_manipulable"
    FARTHEST_FROM_LIMITS = "farthest_from_limits"


@dataclass(frozen=True)
class IKSolution:
    """One q that reaches the target, checked by forward kinematics.

    Attributes:
        q: Shape (dof,); the turns of its angles nearest to the seed within the limits.
        posture: Names of the branches, such as front, up, noflip; empty where there are none.
        within_limits: Whether every joint is within its limits; one that touches its limit is on
            it.
        position_error: Measured, m.
        orientation_error: Measured, rad.
        free: Joints that a singular branch leaves free; they have the seed's value.
        swivel: Arm angle of a redundant arm, rad.
        multiplicity: Number of solutions that meet here, over the complex numbers; 1 where none.
    """

    q: FloatArray
    posture: tuple[str, ...]
    within_limits: bool
    position_error: float
    orientation_error: float
    free: tuple[str, ...] = ()
    swivel: float | None = None
    multiplicity: int = 1


@dataclass(frozen=True)
class IKSolutions:
    """What was found.

    Attributes:
        method: ``closed_form``; ``algebraic``, all solutions of the polynomial equations; or
            ``search``, many starts of the numeric solver.
        complete: True where mathematics says that there are no others (but for whole turns).
        description: What was recognised of the arm, or what was done.
        seed: The q that ``free`` joints and turns refer to; shape (dof,).
        solutions: Closest to the seed first, those within the limits before the others.
        self_motion: Of an arm with more joints than the task needs, the sets of solutions that
            these stand for; None where there is nothing to say of them.
    """

    method: Literal["closed_form", "algebraic", "search"]
    complete: bool
    description: str
    seed: FloatArray
    solutions: tuple[IKSolution, ...]
    self_motion: SelfMotion | None = None


def choose(robot: Robot, found: IKSolutions, frame: str, choice: Choice) -> IKSolution | None:
    """Return the solution within the limits that a choice prefers, None where there is none.

    ``most_manipulable`` compares ``sqrt(det(J Jᵀ))``, ``farthest_from_limits`` the smallest
    distance to a limit relative to the joint's range.
    """
    within = [one for one in found.solutions if one.within_limits]
    if not within:
        return None
    if choice is Choice.CLOSEST:
        return within[0]
    if choice is Choice.MOST_MANIPULABLE:
        return max(
            within,
            key=lambda one: float(
                np.prod(np.linalg.svd(jacobian(robot, one.q, frame), compute_uv=False))
            ),
        )
    limited = np.isfinite(robot.lower) & np.isfinite(robot.upper) & (robot.upper > robot.lower)
    span = np.where(limited, robot.upper - robot.lower, 1.0)

    def margin(one: IKSolution) -> float:
        gaps = np.minimum(one.q - robot.lower, robot.upper - one.q) / span
        return float(gaps[limited].min()) if limited.any() else 0.0

    return max(within, key=margin)
