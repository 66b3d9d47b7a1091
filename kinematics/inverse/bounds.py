"""Joint bounds as a solver sees them: wrapping, midpoints, random starts, reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.tree import path_signs, tree_of
from robots.robot import FloatArray, Robot

TURN = 2 * np.pi


@dataclass(frozen=True)
class JointBounds:
    """Bounds of q.

    Attributes:
        lower: Lower limits, -inf where none; shape (dof,).
        upper: Upper limits, inf where none.
        wraps: True where an angle's range spans a whole turn, so that every direction is within
            the limits and a step beyond one re-enters a turn away.
    """

    lower: FloatArray
    upper: FloatArray
    wraps: NDArray[np.bool_]

    @classmethod
    def of(cls, robot: Robot) -> JointBounds:
        """The bounds of a robot."""
        span = robot.upper - robot.lower
        return cls(robot.lower, robot.upper, robot.turns & (span >= TURN - 1e-9))

    def middle(self) -> FloatArray:
        """Mid-range; 0 where there is no limit."""
        finite = np.isfinite(self.lower) & np.isfinite(self.upper)
        low, high = np.where(finite, self.lower, 0.0), np.where(finite, self.upper, 0.0)
        return np.clip((low + high) / 2, self.lower, self.upper)

    def inside(self, q: FloatArray) -> FloatArray:
        """Q within the limits: by whole turns where that works, else at the nearest limit."""
        bounded = self.wraps & np.isfinite(self.lower)
        low, high = np.where(bounded, self.lower, 0.0), np.where(bounded, self.upper, 0.0)
        up = np.ceil((low - q) / TURN) * TURN
        down = np.ceil((q - high) / TURN) * TURN
        shifted = np.where(q < low, q + up, np.where(q > high, q - down, q))
        return np.clip(np.where(bounded, shifted, q), self.lower, self.upper)

    def nearest(self, q: FloatArray, reference: FloatArray) -> FloatArray:
        """Turns wrapping joints by whole turns towards a reference, within the limits."""
        turns = np.round((reference - q) / TURN) * TURN
        candidate = q + np.where(self.wraps, turns, 0.0)
        candidate = np.where(candidate > self.upper, candidate - TURN, candidate)
        candidate = np.where(candidate < self.lower, candidate + TURN, candidate)
        within = (candidate >= self.lower) & (candidate <= self.upper)
        return np.where(self.wraps & within, candidate, q)

    def ranges(self, reach: float) -> tuple[FloatArray, FloatArray]:
        """Where starts are taken from: the limits; a turn, or ±reach, where there is none."""
        half = np.where(self.wraps, np.pi, reach)
        open_below, open_above = np.isinf(self.lower), np.isinf(self.upper)
        low = np.where(open_below, np.where(open_above, -half, self.upper - 2 * half), self.lower)
        high = np.where(open_above, np.where(open_below, half, self.lower + 2 * half), self.upper)
        return low, high


def reach_bound(robot: Robot, frame: str) -> tuple[FloatArray, float]:
    """A sphere that the frame never leaves.

    The sum of the distances between successive joints, and of the prismatic joints' extents.

    Args:
        robot: The robot.
        frame: Frame name.

    Returns:
        Centre in the base's axes, shape (3,), and radius in m; infinite where an unlimited
        prismatic joint lets the frame go anywhere or the base itself is moved by a joint.
    """
    tree = tree_of(robot)
    indices, signs = path_signs(robot, frame)
    base_joint, base_placement = tree.frames[robot.base_frame]
    if (signs < 0).any():
        return np.zeros(3), np.inf
    if indices.size == 0:
        return np.zeros(3), np.inf
    placements = [tree.joints[int(i)].placement for i in indices]
    radius = float(np.linalg.norm(tree.frames[frame][1][:3, 3]))
    radius += sum(float(np.linalg.norm(T[:3, 3])) for T in placements[1:])
    for i in indices:
        joint = tree.joints[int(i)]
        if not joint.turns:
            column = joint.column
            radius += float(max(abs(robot.lower[column]), abs(robot.upper[column])))
    first = tree.joints[int(indices[0])]
    if first.parent != base_joint:
        return np.zeros(3), np.inf
    origin = first.placement[:3, 3] - base_placement[:3, 3]
    return base_placement[:3, :3].T @ origin, radius
