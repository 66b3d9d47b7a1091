"""Determinant and inverse of a square Jacobian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.deadline import svd
from kinematics.singularity import rank_of
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class SquareJacobian:
    """What a square J has besides; every field has a leading axis n for a batch.

    Attributes:
        determinant: det J, shape () or (n,); in units of the rows over those of the columns.
        inverse: Shape (m, m) or (n, m, m); zero where J is not invertible.
        invertible: Whether the rank is full, by the tolerance of all ranks.
    """

    determinant: FloatArray
    inverse: FloatArray
    invertible: NDArray[np.bool_]


def square_jacobian(J: FloatArray) -> SquareJacobian | None:
    """Return determinant and inverse of a Jacobian, shape (..., m, m); None where not square.

    ``det J = det(U) det(Vᵀ) Π σ_i`` and ``J⁻¹ = V diag(1/σ_i) Uᵀ``, from one decomposition, so that
    rank, determinant and inverse agree.
    """
    if J.shape[-1] != J.shape[-2]:
        return None
    U, sigma, Vt = svd(J)
    sign = np.sign(np.linalg.det(U) * np.linalg.det(Vt))
    invertible = np.asarray(rank_of(sigma) == J.shape[-1])
    safe = np.where(invertible[..., None], sigma, 1.0)
    inverse = np.swapaxes(Vt, -1, -2) / safe[..., None, :] @ np.swapaxes(U, -1, -2)
    return SquareJacobian(
        determinant=np.asarray(sign * np.prod(sigma, axis=-1)),
        inverse=np.where(invertible[..., None, None], inverse, 0.0),
        invertible=invertible,
    )
