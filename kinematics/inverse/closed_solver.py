"""One solution of a closed form: the one within the limits that is nearest to the seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.chain import Chain
from kinematics.inverse import kernel
from kinematics.inverse.closed_form import ClosedForm, solver
from kinematics.inverse.result import IKOptions
from kinematics.kernels import Array
from robots.robot import FloatArray

EXACT = 1e-9
"""What a closed form promises, m and rad; a finer tolerance is the numeric solver's."""


@dataclass(frozen=True, eq=False)
class ClosedSolver:
    """A complete closed form of a chain for a task.

    Attributes:
        form: The closed form.
        chain: The chain.
        rows: Rows of the task.
    """

    form: ClosedForm
    chain: Chain
    rows: Array

    def nearest(
        self, target: FloatArray, seed: FloatArray, P: Array, N: Array, limits: Array, q: Array
    ) -> tuple[float, float] | None:
        """The nearest solution within the limits, into q; see :func:`kernel.nearest`.

        Returns:
            Its position and rotation error, or None where there is none.
        """
        most, K = self.form.most + 1, len(seed)
        found, errors = np.empty((most, K)), np.empty((most, 2))
        codes = np.empty((most, len(self.form.postures)), dtype=np.int64)
        free = np.zeros(most, dtype=np.int64)
        count = solver(self.form)(
            self.form.constants,
            self.chain.placements,
            self.chain.turns,
            self.rows,
            np.ascontiguousarray(target, dtype=np.float64),
            seed,
            0.0,
            found,
            codes,
            free,
            errors,
        )
        index = kernel.nearest(found, errors, count, P, N, seed, limits, q)
        return None if index < 0 else (float(errors[index, 0]), float(errors[index, 1]))

    def proves(self, options: IKOptions) -> bool:
        """True where finding nothing means that there is nothing."""
        return min(options.tolerance.position, options.tolerance.orientation) >= EXACT
