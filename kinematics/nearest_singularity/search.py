"""The function whose zeros are searched: the smallest singular value of a task Jacobian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.chain import Chain
from kinematics.deadline import checkpoint
from kinematics.jacobian import ReferenceFrame, jacobian
from kinematics.singularity import rank_of
from kinematics.task import Task
from robots.robot import FloatArray, Robot


@dataclass(frozen=True, eq=False)
class Search:
    """Robot, chain, task and start of a search, and the smallest singular value at any q."""

    robot: Robot
    chain: Chain
    frame: str
    task: Task
    q: FloatArray
    tolerance: float

    @property
    def rows(self) -> list[int]:
        """Rows of the task."""
        return list(self.task.rows)

    @property
    def axes(self) -> ReferenceFrame:
        """Axes of the rows; singular values are the same in both."""
        own = self.task.own_axes
        return ReferenceFrame.LOCAL if own else ReferenceFrame.LOCAL_WORLD_ALIGNED

    def jacobians(self, q: FloatArray) -> FloatArray:
        """Return the task Jacobians over the chain's columns, shape (n, m, K)."""
        J = jacobian(self.robot, q, self.frame, self.axes)
        return J[:, self.rows][:, :, self.chain.columns]

    def decomposed(self, q: FloatArray) -> tuple[FloatArray, FloatArray, float, bool]:
        """Return the vectors of the least singular value, the value, and if it counts as zero."""
        checkpoint()
        U, sigma, Vt = np.linalg.svd(self.jacobians(q[None])[0])
        r = len(sigma)
        zero = bool(rank_of(sigma, self.tolerance) < r)
        return U[:, r - 1 :], Vt[r - 1 :].T, float(sigma[-1]), zero
