"""Dexterity measures without mixed units: the homogeneous Jacobian.

Linear rows are divided by a characteristic length L, and the columns of prismatic joints multiplied
by it, which leaves no unit (Angeles and López-Cajún, *Kinematic isotropy and the conditioning index
of serial robotic manipulators*, 1992; Angeles, *Fundamentals of Robotic Mechanical Systems*, ch.
5). An isotropic Jacobian has ``L² = tr(J_v J_vᵀ) / tr(J_ω J_ωᵀ)``, the mean square distance of the
frame from the axes of the revolute joints. As no arm is isotropic everywhere, the default L is the
root mean square over all joints and over full turns of all angles: a property of the arm, the same
at every q, so that measures can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.chain import Chain, chain_of
from kinematics.deadline import svd
from kinematics.singularity import RANK_TOLERANCE, rank_of
from kinematics.task import Task
from robots.robot import FloatArray, Robot

CHARACTERISTIC_LENGTH = Bounds(1e-6, 1e6)
"""Bounds of L, m."""


@dataclass(frozen=True, eq=False)
class Dexterity:
    """Conditioning of the homogeneous task Jacobian; shapes (n,), or () for one q.

    Attributes:
        characteristic_length: L, m.
        singular_values: Of the homogeneous Jacobian, without unit, shape (..., r).
        condition_number: Largest over smallest, from 1; infinite where singular.
        isotropy: Its inverse, 0 (singular) to 1 (isotropic).
    """

    characteristic_length: float
    singular_values: FloatArray
    condition_number: FloatArray
    isotropy: FloatArray


def dexterity(
    J: FloatArray,
    is_revolute: NDArray[np.bool_],
    task: Task,
    length: float,
    tolerance: float = RANK_TOLERANCE,
) -> Dexterity:
    """Return the dexterity measures of a task Jacobian.

    Args:
        J: Shape (rows, dof) or (n, rows, dof).
        is_revolute: True for the columns of revolute joints, shape (dof,).
        task: The task space, which names the rows.
        length: L, m.
        tolerance: A singular value below ``tolerance * max(1, largest)`` counts as zero.

    Raises:
        InvalidOption: length is not in 1e-6 … 1e6.
    """
    if length not in CHARACTERISTIC_LENGTH:
        raise CHARACTERISTIC_LENGTH.refusal(
            say("characteristic_length is {length:g}; give 1e-6 up to 1e6 m", length=length),
            length,
            "characteristic_length",
        )
    scale = np.ones(len(task.rows))
    scale[: len(task.positions)] = 1.0 / length
    homogeneous = J * scale[:, None] * np.where(is_revolute, 1.0, length)
    sigma: FloatArray = svd(homogeneous, compute_uv=False)
    regular = rank_of(sigma, tolerance) == sigma.shape[-1]
    smallest = np.where(regular, sigma[..., -1], 1.0)
    largest = np.where(regular, sigma[..., 0], 1.0)
    return Dexterity(
        characteristic_length=length,
        singular_values=sigma,
        condition_number=np.where(regular, largest / smallest, np.inf),
        isotropy=np.where(regular, smallest / largest, 0.0),
    )


def characteristic_length(robot: Robot, frame: str | None = None) -> float:
    """Return the default L of a chain, m; 1 where no revolute joint moves the frame's origin.

    The mean square distance from each axis is exact: second moments of the frame's origin are
    carried from the tip to the base. Averaging over a full turn about z keeps their part that is
    symmetric about z; a prismatic joint averages over its extent (at 0 where it has no limits).

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    return _mean_lever(chain_of(robot, frame or robot.tip_frame))


@lru_cache(maxsize=512)
def _mean_lever(chain: Chain) -> float:
    squares = _mean_squares(chain)
    mean = float(np.mean(squares)) if squares else 0.0
    size = float(np.abs(chain.placements[:, [3, 7, 11]]).max(initial=0.0))
    return float(np.sqrt(mean)) if mean > (1e-9 * size) ** 2 and mean > 1e-12 else 1.0


def _mean_squares(chain: Chain) -> list[float]:
    moments = np.zeros((4, 4))
    moments[3, 3] = 1.0
    moments = _moved(moments, chain.placements[-1])
    found = []
    for k in range(chain.length - 1, -1, -1):
        if chain.is_revolute[k]:
            square = moments[0, 0] + moments[1, 1]
            found.append(float(square))
            turned = np.diag([square / 2, square / 2, moments[2, 2], 1.0])
            turned[2, 3] = turned[3, 2] = moments[2, 3]
            moments = turned
        else:
            low, high = float(chain.lower[k]), float(chain.upper[k])
            low, high = (low, high) if np.isfinite(low) and np.isfinite(high) else (0.0, 0.0)
            shift = np.eye(3, 4).reshape(12)
            shift[11] = (low + high) / 2
            moments = _moved(moments, shift)
            moments[2, 2] += (high - low) ** 2 / 12
        moments = _moved(moments, chain.placements[k])
    return found


def _moved(moments: FloatArray, placement: FloatArray) -> FloatArray:
    T = np.vstack((placement.reshape(3, 4), [0.0, 0.0, 0.0, 1.0]))
    return np.asarray(T @ moments @ T.T)
