"""Manipulability ellipsoids of velocity and force, for translation and rotation separately."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.deadline import svd
from kinematics.singularity import RANK_TOLERANCE, SMALLEST
from kinematics.task import Task
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """Velocity ellipsoid of unit joint velocities, and force ellipsoid of unit joint torques.

    Both have the same axes and reciprocal semi-axes (Yoshikawa, *Foundations of Robotics*, 4.3).
    A leading axis n for a batch.

    Attributes:
        axes: Directions in base axes, unit vectors, one a row; shape (k, 3), the longest velocity
            first.
        velocity: Semi-axes of ``{J qd : |qd| <= 1}``, m/s or rad/s, shape (k,).
        force: Semi-axes of ``{f : |Jᵀ f| <= 1}``, N or N m, shape (k,); infinite where the
            structure carries any force.
    """

    axes: FloatArray
    velocity: FloatArray
    force: FloatArray


def ellipsoids(
    J: FloatArray, task: Task, tolerance: float = RANK_TOLERANCE
) -> tuple[Ellipsoid | None, Ellipsoid | None]:
    """Return the ellipsoids of translation and rotation; None where the task has no such rows.

    Args:
        J: Task Jacobian in base axes, shape (rows, dof) or (n, rows, dof).
        task: The task space, which names the rows.
        tolerance: A semi-axis below ``tolerance * max(1, largest)`` counts as zero.
    """
    split = len(task.positions)
    translation = _ellipsoid(J[..., :split, :], task.positions, tolerance)
    return translation, _ellipsoid(J[..., split:, :], task.rotations, tolerance)


def _ellipsoid(J: FloatArray, rows: tuple[int, ...], tolerance: float) -> Ellipsoid | None:
    k = len(rows)
    if k == 0:
        return None
    if J.shape[-1] < k:
        J = np.concatenate((J, np.zeros((*J.shape[:-1], k - J.shape[-1]))), axis=-1)
    U, sigma, _ = svd(J, full_matrices=False)
    axes = np.zeros((*sigma.shape, 3))
    axes[..., rows] = np.swapaxes(U, -1, -2)
    axes[np.abs(axes) < 1e-14] = 0.0
    leading = np.take_along_axis(axes, _first_of_weight(axes)[..., None], axis=-1)
    axes = np.where(leading < 0, -axes, axes) + 0.0
    threshold = np.maximum(tolerance * np.maximum(1.0, sigma[..., :1]), SMALLEST)
    counts = sigma > threshold
    force = np.where(counts, 1.0 / np.where(counts, sigma, 1.0), np.inf)
    return Ellipsoid(axes, sigma, force)


def _first_of_weight(vectors: FloatArray) -> NDArray[np.intp]:
    return np.asarray(np.argmax(np.abs(vectors) > 1e-9, axis=-1))
