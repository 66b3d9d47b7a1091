"""What is true, by the poses of both programs' answers; what each misses, and what is false."""

from __future__ import annotations

import numpy as np

from bench.all_solutions.arms import Arm
from robots.robot import FloatArray

REACHED = 1e-7
"""Largest difference of an entry of a pose that reaches its target, m or 1."""
SAME, SAME_BESIDE_SINGULAR = 1e-5, 2e-2
"""Largest joint difference of two answers that are one: there errors of a pose count as roots."""
BESIDE = 1e-3
"""Part of the largest singular value below which an answer is beside a singular one."""
SINGULAR = 1e-6
SURELY = 1e-6
"""Depth inside the limits from which an answer must not be left out, rad."""
STEPS = 200
"""Along a family of solutions."""


def apart(q: FloatArray, other: FloatArray) -> float:
    """Return the largest difference on the circle."""
    return float(np.abs((q - other + np.pi) % (2 * np.pi) - np.pi).max())


class Judge:
    """Judges the answers to one target.

    Attributes:
        arm: The arm.
        target: The pose, 4x4.
    """

    def __init__(self, arm: Arm, target: FloatArray) -> None:
        self.arm, self.target = arm, target

    def is_true(self, q: FloatArray) -> bool:
        """Whether q reaches the target."""
        return bool(np.abs(self.arm.pose(q) - self.target).max() <= REACHED)

    def truth(self, *answers: list[FloatArray]) -> list[FloatArray]:
        """Return the true ones among answers that are surely within the limits, each once."""
        found: list[FloatArray] = []
        for q in (one for some in answers for one in some):
            if self.is_true(q) and self.arm.inside(q, -SURELY) and not self.has(found, q):
                found.append(q)
        return found

    def has(self, answers: list[FloatArray], q: FloatArray) -> bool:
        """Whether q is among answers, or on a family of solutions that one of them shows."""
        near = min((apart(one, q) for one in answers), default=np.inf)
        if near < SAME:
            return True
        sigma = np.linalg.svd(self.arm.jacobian(q), compute_uv=False)
        least = sigma[-1] / sigma[0]
        if least > BESIDE:
            return False
        if near < SAME_BESIDE_SINGULAR:
            return True
        return least < SINGULAR and any(self._leads(q, one) for one in answers)

    def _leads(self, q: FloatArray, end: FloatArray) -> bool:
        """Whether singular solutions lead from q to another."""
        for _ in range(STEPS):
            way = (end - q + np.pi) % (2 * np.pi) - np.pi
            if np.abs(way).max() < SAME_BESIDE_SINGULAR:
                return True
            J = self.arm.jacobian(q)
            _, sigma, rows = np.linalg.svd(J)
            null = rows[sigma < 1e-5 * sigma[0]]
            step = null.T @ (null @ way)
            size = np.abs(step).max(initial=0.0)
            if size < 1e-6:
                return False
            q = q + step * min(1.0, 0.05 / size)
            for _ in range(3):
                T = self.arm.pose(q)
                R = self.target[:3, :3] @ T[:3, :3].T
                turn = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
                error = np.concatenate((self.target[:3, 3] - T[:3, 3], turn))
                q = q + np.linalg.lstsq(self.arm.jacobian(q), error, rcond=1e-4)[0]
            if not self.is_true(q):
                return False
        return False
