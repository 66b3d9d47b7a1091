"""All complex solutions of six revolute joints at once, where elimination finds them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgeev

from kinematics.inverse.continuation.closure import SquareSystem
from kinematics.inverse.continuation.following import pose_of
from kinematics.inverse.elimination.eliminating import eigenproblem
from kinematics.inverse.elimination.finishing import finish
from kinematics.inverse.elimination.resultant import Resultant, resultants_of
from kinematics.inverse.elimination.roots import ROOTS, roots
from kinematics.inverse.task_error import TaskChain
from robots.robot import FloatArray

ComplexArray = NDArray[np.complex128]

TRIALS = 3
"""Random targets on which the orders of elimination are tried."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """What is known of an arm of six revolute joints.

    Attributes:
        system: Its equations.
        orders: The eliminations that find all solutions of general targets, the best first.
    """

    system: SquareSystem
    orders: tuple[Resultant, ...]

    def solutions(self, target: FloatArray) -> ComplexArray | None:
        """Return all solutions of a target over the complex numbers.

        No six joints have more than 16 that stand alone (Raghavan and Roth, 1993), so that 16
        which are regular, each checked, are all.

        Args:
            target: Pose of the frame in base axes, shape (4, 4), m.

        Returns:
            Joint values, shape (16, 6), the imaginary parts of real ones exactly 0; None where
            the arm or the target is special: fewer were found, or some of them meet.
        """
        scaled = np.array(target, dtype=np.float64)
        scaled[:3, 3] /= self.system.size
        for arm in self.orders:
            found = _solutions(self.system, arm, scaled)
            if found is not None:
                return found
        return None

    def real(
        self,
        chain: TaskChain,
        target: FloatArray,
        reference: FloatArray,
        limits: FloatArray,
        touch: float,
    ) -> tuple[FloatArray, list[list[float]]] | None:
        """Return the real solutions of a target in order; see :func:`finishing.finish`.

        Returns:
            Joint values, shape (n, 6), and n times errors, state and distance; None as of
            :meth:`solutions`.
        """
        Q = self.solutions(target)
        if Q is None:
            return None
        q, measured = np.empty((ROOTS, 6)), np.empty((ROOTS, 4))
        pose = np.array(target, dtype=np.float64)
        count = finish(chain, pose, Q, reference, limits, touch, q, measured)
        return None if count < 0 else (q[:count], measured[:count].tolist())


def elimination_of(system: SquareSystem) -> Elimination | None:
    """Return the elimination of an arm; None where it finds no general target's solutions."""
    random = np.random.default_rng(0)
    targets = []
    for _ in range(TRIALS):
        pose, target = np.empty(12, dtype=np.complex128), np.eye(4)
        q = random.uniform(-np.pi, np.pi, len(system.is_revolute)).astype(np.complex128)
        pose_of(system.closure, q, pose)
        target[:3] = pose.real.reshape(3, 4)
        targets.append(target)
    counted = [
        (sum(_solutions(system, arm, target) is not None for target in targets), arm)
        for arm in resultants_of(system)
    ]
    orders = sorted((pair for pair in counted if pair[0] > 0), key=lambda pair: -pair[0])
    return Elimination(system, tuple(arm for _, arm in orders)) if orders else None


def _solutions(system: SquareSystem, arm: Resultant, target: FloatArray) -> ComplexArray | None:
    E, Z = np.empty((ROOTS, ROOTS)), np.empty((12, ROOTS))
    R, L = np.empty((14, 8)), np.empty((14, 27))
    if eigenproblem(arm, target, E, Z, R, L) == 0.0:
        return None
    real, imaginary, _, vectors, failed = dgeev(E, compute_vl=0)
    if failed:
        return None
    Q = np.empty((ROOTS, 6), dtype=np.complex128)
    pose = target[:3].reshape(12).astype(np.complex128)
    values = real + 1j * imaginary
    vectors = np.ascontiguousarray(vectors)
    found = roots(system.closure, arm, target, pose, values, vectors, (Z, R, L), Q)
    return Q if found == ROOTS else None
