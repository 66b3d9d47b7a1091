"""Best configuration for a sample whose target cannot be reached.

Least squares of the task error (Levenberg-Marquardt) by QPs within limits, speeds and clearances.
Contradictory clearances are violated as little as possible.
"""

from __future__ import annotations

import daqp
import numpy as np
from numpy.typing import NDArray

from kinematics.redundancy.steps.linearised import SOFT, Linearised
from robots.robot import FloatArray

ITERATIONS = 25
WEAKEST, STRONGEST = 1e-10, 1e4
SETTLED = 1.0 - 1e-4
CLEARANCE_WEIGHT = 1e4
"""Weight of a missing metre of clearance relative to a metre of error, squared."""
SOFTNESS = 1e-6


def best_effort(
    model: Linearised, previous: FloatArray, target: FloatArray, need: float
) -> FloatArray:
    """Return the configuration nearest to a target that limits, speeds and clearances allow.

    Args:
        model: The linear model, bounded for the sample.
        previous: Configuration of the sample before, shape (K,), rad and m.
        target: Pose in base axes, shape (12,).
        need: Clearance to keep, m.
    """
    q = np.clip(previous, model.region.low, model.region.high)
    eye = np.eye(len(q))
    model.at(q, target, need)
    value = merit(model)
    damping = 1e-2 * min(1.0, value) + 1e-6
    for _ in range(ITERATIONS):
        e, J = model.arrays.e, model.arrays.J
        H = J.T @ J + damping * eye
        f = -(J.T @ e)
        A, upper, lower, sense = model.rows(task=False)
        delta = solved(H, f, A, upper, lower, sense)
        if delta is None:
            break
        trial = np.clip(q + delta, model.region.low, model.region.high)
        model.at(trial, target, need)
        now = merit(model)
        if now < value:
            settled = now > SETTLED * value
            q, value = trial, now
            if settled:
                break
            damping = max(WEAKEST, damping / 5)
        else:
            damping *= 6
            if damping > STRONGEST or np.abs(delta).max() < 1e-12:
                break
            model.at(q, target, need)
    return q


def merit(model: Linearised) -> float:
    """Return the squared task error plus the weighted missing clearance."""
    return model.error + CLEARANCE_WEIGHT * model.missing**2


def solved(
    H: FloatArray,
    f: FloatArray,
    A: FloatArray,
    upper: FloatArray,
    lower: FloatArray,
    sense: NDArray[np.int32],
) -> FloatArray | None:
    """Return the minimum of ½ δᵀHδ + fᵀδ; soft clearances if infeasible; None if still so."""
    delta, _, flag, _ = daqp.solve(H, f, A, upper, lower, sense)
    if flag > 0:
        return np.asarray(delta)
    soft = np.array(sense)
    soft[len(f) :] = SOFT
    delta, _, flag, _ = daqp.solve(H, f, A, upper, lower, soft, rho_soft=SOFTNESS)
    return np.asarray(delta) if flag > 0 else None
