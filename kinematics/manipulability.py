"""Yoshikawa's manipulability and the determinant of the Jacobian, with their gradients in q."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.deadline import svd
from kinematics.derivatives import hessian
from kinematics.jacobian import ReferenceFrame, task_jacobian
from kinematics.singularity import RANK_TOLERANCE, rank_of
from kinematics.task import POSE, Task
from kinematics.velocity import check_options
from robots.robot import FloatArray, Robot


@dataclass(frozen=True, eq=False)
class ManipulabilityGradient:
    """Manipulability w and its gradient; every field has a leading axis n for a batch.

    Attributes:
        manipulability: The product of the singular values of the task Jacobian.
        gradient: ∂w/∂q, shape (dof,) or (n, dof); zero at a singularity, where w has no gradient
            (see ``differentiable``).
        differentiable: False at a singularity.
        determinant: det J where J is square, whose absolute value is w; else None.
        determinant_gradient: ∂(det J)/∂q, which exists everywhere; None with ``determinant``.
    """

    manipulability: FloatArray
    gradient: FloatArray
    differentiable: NDArray[np.bool_]
    determinant: FloatArray | None
    determinant_gradient: FloatArray | None


def manipulability_gradient(
    robot: Robot,
    q: FloatArray,
    task: Task = POSE,
    frame: str | None = None,
    *,
    tolerance: float = RANK_TOLERANCE,
) -> ManipulabilityGradient:
    """Return the manipulability of a task and its gradient.

    ``w = Π σ_i`` and ``dσ_i = u_iᵀ dJ v_i``, hence ``∂w/∂q_k = Σ_i (Π_{j≠i} σ_j) u_iᵀ ∂J/∂q_k v_i``
    = ``w tr(J† ∂J/∂q_k)`` (Yoshikawa, *Foundations of Robotics*, 4.4; Park, Chung and Youm, 1999),
    computed without a division, so that it is as exact near singularities as elsewhere.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        task: The task space, in base axes.
        frame: Frame name; default the tip.
        tolerance: A singular value below ``tolerance * max(1, largest)`` counts as zero.

    Returns:
        Manipulability, determinant and their gradients.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
        InvalidOption: tolerance out of range.
    """
    check_options(0.0, tolerance)
    # w is the same in the frame's own axes, where rows about these axes are rows of the Hessian.
    axes = ReferenceFrame.LOCAL if task.own_axes else ReferenceFrame.LOCAL_WORLD_ALIGNED
    J = task_jacobian(robot, q, task, frame, axes)
    H = hessian(robot, q, frame, axes)[..., list(task.rows), :, :]
    U, sigma, Vt = svd(J, full_matrices=False)
    changes = np.einsum("...mi,...mjk,...ij->...ik", U, H, Vt, optimize=True)
    gradient = (_products_of_others(sigma)[..., None, :] @ changes)[..., 0, :]
    w = np.prod(sigma, axis=-1)
    differentiable = rank_of(sigma, tolerance) == sigma.shape[-1]
    square = J.shape[-1] == J.shape[-2]
    # det J = det U det Vᵀ Π σ, and the two orthogonal factors only give the sign.
    sign = np.sign(np.linalg.det(U) * np.linalg.det(Vt)) if square else np.array(1.0)
    return ManipulabilityGradient(
        manipulability=w,
        gradient=np.where(differentiable[..., None], gradient, 0.0),
        differentiable=differentiable,
        determinant=sign * w if square else None,
        determinant_gradient=sign[..., None] * gradient if square else None,
    )


def peak_bytes(dof: int) -> int:
    """Return the bytes for each q of a batch of gradients: its Hessian, and products with it."""
    return 8 * (2 * 6 * dof**2 + 12 * dof + 40)


def _products_of_others(sigma: FloatArray) -> FloatArray:
    """Return for each entry the product of all others, shape (..., r)."""
    before, after = np.ones_like(sigma), np.ones_like(sigma)
    np.cumprod(sigma[..., :-1], axis=-1, out=before[..., 1:])
    after[..., :-1] = np.cumprod(sigma[..., :0:-1], axis=-1)[..., ::-1]
    return before * after
