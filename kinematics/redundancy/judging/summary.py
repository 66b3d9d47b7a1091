"""Figures of a followed path: one row of a comparison."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinematics.redundancy.follow import PathResult
from robots.robot import FloatArray


@dataclass(frozen=True)
class Summary:
    """Figures of a followed path; lengths in m, joint values in the requested units.

    Attributes:
        max_position_error: Largest of all samples, m.
        end_position_error: At the last sample that was computed, m.
        max_orientation_error: rad.
        end_orientation_error: rad.
        sum_dq: Σ‖Δq‖.
        largest_step: Largest |Δq_j| in a sample.
        min_clearance: At samples; None without obstacles.
        min_clearance_swept: A lower bound at samples and between, at most 1e-5 m too low.
        limit_margin: Least distance to a joint limit, negative beyond; None without limits.
        speed_ratio: Largest speed relative to a joint's limit; None without limits.
        drift: ‖q at the end − q at the start‖ where the path is closed, else None.
        ms_per_point: Time of the method per sample, ms.
    """

    max_position_error: float
    end_position_error: float
    max_orientation_error: float
    end_orientation_error: float
    sum_dq: float
    largest_step: float
    min_clearance: float | None
    min_clearance_swept: float | None
    limit_margin: float | None
    speed_ratio: float | None
    drift: float | None
    ms_per_point: float


def summary(result: PathResult, unit: FloatArray) -> Summary:
    """Return the figures of a result.

    Args:
        result: The result.
        unit: Factors from rad and m to the requested units, shape (dof,).
    """
    measures, arm = result.measures, result.problem.arm
    columns = arm.chain.columns
    q = result.q[:, columns] * unit[columns]
    steps = np.diff(q, axis=0)
    lower, upper = arm.chain.lower * unit[columns], arm.chain.upper * unit[columns]
    drift = result.drift
    return Summary(
        float(measures.position_error.max()),
        float(measures.position_error[-1]),
        float(measures.orientation_error.max()),
        float(measures.orientation_error[-1]),
        float(np.linalg.norm(steps, axis=1).sum()),
        float(np.abs(steps).max(initial=0.0)),
        finite(float(measures.clearance.min())),
        finite(measures.min_swept),
        finite(float(np.minimum(q - lower, upper - q).min())),
        float(measures.speed_ratio.max(initial=0.0)) if np.isfinite(arm.velocity).any() else None,
        None if drift is None else float(np.linalg.norm(drift * unit)),
        1e3 * result.elapsed / max(1, len(result.q) - 1),
    )


def finite(value: float) -> float | None:
    """Return a value, None where it is infinite."""
    return value if math.isfinite(value) else None
