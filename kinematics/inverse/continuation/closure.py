"""The square system of a chain and a task: as many unknowns as rows, or none."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.compiled import writable
from kinematics.inverse.continuation.complex_chain import Closure
from kinematics.task import Task
from robots.robot import FloatArray

LEAST_PIVOT = 1e-6
"""Part of the largest singular value below which a Jacobian at a general point has lost rank."""
MOST_JOINTS = 16
EXACT, NEARLY = 1e-12, 1e-4
"""Angle of two axes, rad, or their distance in sizes, that is rounding of 0; and that is small
enough to be meant as 0."""
SIZE_SEED = 20_231_107


@dataclass(frozen=True, eq=False)
class SquareSystem:
    """A chain whose task has as many rows as it has unknowns.

    Attributes:
        closure: For compiled functions.
        size: Unit of its lengths, m.
        joints: Number of joints of the chain; the others were added so that it is square, and
            are 0 in a solution.
        is_revolute: True for an angle, added ones included; shape (K,).
        rows: Number of equations, m.
    """

    closure: Closure
    size: float
    joints: int
    is_revolute: NDArray[np.bool_]

    @property
    def added(self) -> int:
        """Number of joints that were added."""
        return len(self.is_revolute) - self.joints

    @property
    def rows(self) -> int:
        """Number of equations, and of unknowns."""
        return len(self.closure.rows)

    @cached_property
    def is_nearly_special(self) -> bool:
        """Return whether axes that follow each other are parallel, or meet, but for rounding."""
        for placement in self.closure.C[1 : self.joints]:
            R, t = placement.reshape(3, 4)[:, :3], placement.reshape(3, 4)[:, 3]
            across = np.hypot(R[0, 2], R[1, 2])
            if EXACT < across < NEARLY:
                return True
            if across >= NEARLY and EXACT < abs(t @ [-R[1, 2], R[0, 2], 0.0]) / across < NEARLY:
                return True
        return False

    def scaled(self, pose: FloatArray) -> NDArray[np.complex128]:
        """Return a pose, 4x4 or 12 numbers, as compiled functions take it, in units of the size."""
        numbers = np.array(pose, dtype=np.complex128).reshape(-1)[:12]
        numbers[[3, 7, 11]] /= self.size
        return numbers


def square_system(chain: Chain, task: Task, driven: tuple[int, ...] = ()) -> SquareSystem | None:
    """Return the square system of a chain and a task.

    Args:
        chain: Its joints must all be free.
        task: The task.
        driven: Joints whose values are given.

    Returns:
        None where there is none: joints that the task leaves free, or rows of rotation that no
        polynomial equations stand for.
    """
    wanted = _equations(chain, task)
    sought = chain.length - len(driven)
    if wanted is None or not 0 < sought <= len(wanted) or chain.length > MOST_JOINTS:
        return None
    placements, turning = chain.placements.copy(), list(chain.is_revolute)
    lengths = np.linalg.norm(placements[1:-1, [3, 7, 11]], axis=1)
    size = float(lengths.max(initial=0.0)) or float(np.abs(placements[-1, [3, 7, 11]]).max()) or 1.0
    placements[:, [3, 7, 11]] /= size
    for number in range(len(wanted) - sought):
        placements = _with_joint(placements, number)
        turning.append(True)
    unknowns = [k for k in range(len(turning)) if k not in driven]
    closure = Closure(
        writable(placements),
        np.array(turning, dtype=np.float64),
        np.array(wanted, dtype=np.int64),
        float(task.own_axes),
        np.array(unknowns, dtype=np.int64),
        np.array(driven, dtype=np.int64),
    )
    return SquareSystem(closure, size, chain.length, np.array(turning))


def _equations(chain: Chain, task: Task) -> tuple[int, ...] | None:
    """Return the rows of a task if they are zero where polynomials are, else None."""
    if task.own_axes or len(task.rotations) in (0, 3):
        return task.rows
    # One angle is a polynomial condition only where the frame turns about its axis alone.
    if len(task.rotations) == 1 and _turns_about(chain, task.rotations[0]):
        return task.rows
    return None


def _turns_about(chain: Chain, axis: int) -> bool:
    R, turning = np.eye(3), []
    for placement, turns in zip(chain.placements, chain.is_revolute, strict=False):
        R = R @ placement.reshape(3, 4)[:, :3]
        if turns:
            turning.append(R[:, 2].copy())
    across = np.delete(np.array(turning).reshape(-1, 3), axis, axis=1)
    return bool((np.abs(across) < 1e-12).all())


def _with_joint(placements: FloatArray, number: int) -> FloatArray:
    """Return a chain with one more revolute joint in general position, the same pose at 0."""
    random = np.random.default_rng(SIZE_SEED + number)
    tip = np.vstack((placements[-1].reshape(3, 4), [0.0, 0.0, 0.0, 1.0]))
    mount = np.eye(4)
    mount[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0]
    mount[:3, :3] *= np.linalg.det(mount[:3, :3])
    mount[:3, 3] = random.uniform(-0.5, 0.5, 3)
    ends = (tip @ mount)[:3].reshape(1, 12), np.linalg.inv(mount)[:3].reshape(1, 12)
    return np.vstack((placements[:-1], *ends))
