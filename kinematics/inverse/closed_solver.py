"""One solution of a closed form: the one within the limits that is nearest to the seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinematics.compiled import jit
from kinematics.inverse.closed_form import ClosedForm, Kind, parallel_axes, planar, spherical_wrist
from kinematics.inverse.kernel import nearest
from kinematics.inverse.result import IKOptions
from kinematics.kernels import Array
from robots.robot import FloatArray

EXACT = 1e-9
"""What a closed form promises, m and rad; a finer tolerance is the numeric solver's."""
MOST = 17
"""Rows for the solutions of any class."""


@jit
def _spherical_wrist(
    constants: Array, P: Array, N: Array, target: Array, seed: Array, limits: Array, out: Array
) -> bool:
    K, m = N[0], N[1]
    found, errors = np.empty((MOST, K)), np.empty((MOST, 2))
    codes, free = np.empty((MOST, 3), np.int64), np.empty(MOST, np.int64)
    C, turns = P[: 12 * (K + 1)].reshape((K + 1, 12)), N[8 : 8 + K] != 0
    count = spherical_wrist.solve(
        constants, C, turns, N[2 : 2 + m], target, seed, 0.0, found, codes, free, errors
    )
    index = nearest(found, errors, count, P, N, seed, limits, out)
    if index >= 0:
        out[K : K + 2] = errors[index]
    return index >= 0


@jit
def _parallel_axes(
    constants: Array, P: Array, N: Array, target: Array, seed: Array, limits: Array, out: Array
) -> bool:
    K, m = N[0], N[1]
    found, errors = np.empty((MOST, K)), np.empty((MOST, 2))
    codes, free = np.empty((MOST, 3), np.int64), np.empty(MOST, np.int64)
    C, turns = P[: 12 * (K + 1)].reshape((K + 1, 12)), N[8 : 8 + K] != 0
    count = parallel_axes.solve(
        constants, C, turns, N[2 : 2 + m], target, seed, 0.0, found, codes, free, errors
    )
    index = nearest(found, errors, count, P, N, seed, limits, out)
    if index >= 0:
        out[K : K + 2] = errors[index]
    return index >= 0


@jit
def _planar(
    constants: Array, P: Array, N: Array, target: Array, seed: Array, limits: Array, out: Array
) -> bool:
    K, m = N[0], N[1]
    found, errors = np.empty((MOST, K)), np.empty((MOST, 2))
    codes, free = np.empty((MOST, 3), np.int64), np.empty(MOST, np.int64)
    C, turns = P[: 12 * (K + 1)].reshape((K + 1, 12)), N[8 : 8 + K] != 0
    count = planar.solve(
        constants, C, turns, N[2 : 2 + m], target, seed, 0.0, found, codes, free, errors
    )
    index = nearest(found, errors, count, P, N, seed, limits, out)
    if index >= 0:
        out[K : K + 2] = errors[index]
    return index >= 0


_COMPILED: dict[Kind, Callable[..., bool]] = {
    "spherical_wrist": _spherical_wrist,
    "parallel_axes": _parallel_axes,
    "planar_2r": _planar,
    "planar_3r": _planar,
    "scara": _planar,
}


@dataclass(frozen=True, eq=False)
class ClosedSolver:
    """A closed form that gives all solutions of a task.

    Attributes:
        form: The closed form.
    """

    form: ClosedForm

    @staticmethod
    def covers(form: ClosedForm) -> bool:
        """True for classes whose solutions are finitely many."""
        return form.kind in _COMPILED

    @cached_property
    def _function(self) -> Callable[..., bool]:
        return _COMPILED[self.form.kind]

    def nearest(
        self, P: Array, N: Array, target: FloatArray, seed: FloatArray, limits: Array, out: Array
    ) -> bool:
        """The solution nearest to the seed, and its two errors, into out; False: there is none.

        Args:
            P: Constants of the chain; see :func:`kinematics.inverse.kernel.packed`.
            N: Its whole numbers.
            target: Shape (4, 4).
            seed: In the chain's order, within the limits; shape (K,).
            limits: Squared tolerances first.
            out: Filled, shape (K + 2 or more,).
        """
        return self._function(self.form.constants, P, N, target, seed, limits, out)

    def proves(self, options: IKOptions) -> bool:
        """True where finding nothing means that there is nothing."""
        return min(options.tolerance.position, options.tolerance.orientation) >= EXACT
