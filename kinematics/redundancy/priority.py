"""Tasks in strict order: each is done as well as possible without affecting those before it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.singularity import RANK_TOLERANCE
from robots.robot import FloatArray


def prioritized_step(
    tasks: Sequence[tuple[FloatArray, FloatArray]], dof: int
) -> tuple[FloatArray, FloatArray]:
    """Return the step of least norm that solves the tasks in lexicographic order.

    With Z a basis of the null space of all tasks before, task k adds ``Z (J_k Z)† (e_k − J_k Δq)``
    (Siciliano and Slotine, ICAR 1991, with an orthonormal basis in place of the projector, so that
    the tasks before stay exact to rounding). It minimises ``‖J_k Δq − e_k‖`` subject to the tasks
    before, by the KKT conditions of that program.

    Args:
        tasks: Jacobian (m_k, dof) and error (m_k,) of each, the highest priority first.
        dof: Number of joints.

    Returns:
        Δq, shape (dof,), and an orthonormal basis of the null space of all tasks, shape
        (dof, free).
    """
    q, Z = np.zeros(dof), np.eye(dof)
    for J, e in tasks:
        if Z.shape[1] == 0:
            break
        U, sigma, Vt = np.linalg.svd(J @ Z)
        floor = RANK_TOLERANCE * max(1.0, float(np.linalg.norm(J, 2)))
        rank = int(np.sum(sigma > floor))
        left = e - J @ q
        q = q + Z @ (Vt[:rank].T @ ((U[:, :rank].T @ left) / sigma[:rank]))
        Z = Z @ Vt[rank:].T
    return q, Z
