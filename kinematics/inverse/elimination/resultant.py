"""What the elimination knows of an arm before there is a target.

The six axes and the target are a loop, ``M(q_1) C_1 M(q_2) … C_5 M(q_6) X = 1``. With joints
numbered from 0 it is cut so that joint 4 drops out:

    ``C_1 M(q_1) C_2 M(q_2) C_3 M(q_3) C_4 u = M(q_0)⁻¹ X⁻¹ M(q_5)⁻¹ C_5⁻¹ u``

for the axis and the origin u of joint 4. Both sides are lifted to the 14 products of
:func:`lift`, on which a rigid motion acts linearly; joints 0 and 5 are eliminated from them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinematics.inverse.continuation.closure import SquareSystem
from kinematics.kernels import Array
from robots.robot import FloatArray

JOINTS = 6
LIFTED = 14
MONOMIALS = 9
OFFSETS = (0.31, -0.47, 0.73)
"""Added to the angles of joints 1 to 3, rad, so that the tangents of their halves stay small at
the round values that real targets have."""


class Resultant(NamedTuple):
    """Constants of an arm of six revolute joints.

    Attributes:
        reverses: Nonzero where the joints are taken from the last to the first.
        before: C_0, shape (4, 4); lengths of all placements are in units of the system's size.
        after: C_6⁻¹, shape (4, 4).
        axis: Lifted axis of joint 4 in the frame after joint 5, shape (14,).
        left: Coefficients of ``sin q_1``, ``cos q_1`` and 1 in the lifted left sides, each of the
            monomials ``x_2^i x_3^j``, i and j up to 2, in the tangents of half angles; shape
            (3, 14, 9).
        factor: U of ``left[1] - 1j * left[0] = U V``, real and imaginary part; shape (2, 14, 4).
        rows: V, real and imaginary part; shape (2, 4, 9).
        loop: C_1 … C_5 in the order of the elimination, shape (5, 4, 4).
        offsets: Of joints 1 to 3, rad, shape (3,).
    """

    reverses: float
    before: Array
    after: Array
    axis: Array
    left: Array
    factor: Array
    rows: Array
    loop: Array
    offsets: Array


def resultants_of(system: SquareSystem) -> tuple[Resultant, ...]:
    """Return the elimination in both orders of the joints; none where the arm is another."""
    closure = system.closure
    turns = bool(system.is_revolute.all()) and len(closure.driven) == 0
    if not turns or system.joints != JOINTS or system.rows != JOINTS or closure.own_axes:
        return ()
    placements = np.tile(np.eye(4), (JOINTS + 1, 1, 1))
    placements[:, :3] = closure.C.reshape(-1, 3, 4)
    loop: FloatArray = placements[1:-1]
    orders: tuple[FloatArray, ...] = (loop, np.linalg.inv(loop[::-1]).astype(np.float64))
    return tuple(_resultant(placements, loop, reverses) for reverses, loop in enumerate(orders))


def _resultant(placements: FloatArray, loop: FloatArray, reverses: int) -> Resultant:
    angles = np.arange(3) * (2.0 * np.pi / 3.0)
    lifted = np.empty((3, 3, 3, LIFTED))
    turned = np.array([[_turn(a + offset) for a in angles] for offset in OFFSETS])
    for i in range(3):
        first = loop[0] @ turned[0, i] @ loop[1]
        for j in range(3):
            second = first @ turned[1, j] @ loop[2]
            for k in range(3):
                last = second @ turned[2, k] @ loop[3]
                lifted[i, j, k] = lift(last[:3, 3], last[:3, 2])
    fit = np.linalg.inv(np.stack((np.sin(angles), np.cos(angles), np.ones(3)), axis=1))
    # sin, cos and 1 in the tangent of the half angle, times 1 + x².
    halves = np.array([[0.0, 1.0, 1.0], [2.0, 0.0, 0.0], [0.0, -1.0, 1.0]])
    left = np.einsum("xi,pj,qk,ijkn->xnpq", fit, halves @ fit, halves @ fit, lifted)
    left = left.reshape(3, LIFTED, MONOMIALS)
    u, sigma, v = np.linalg.svd(left[1] - 1j * left[0])
    factor, rows = u[:, :4] * sigma[:4], v[:4]
    end = np.linalg.inv(loop[4])
    return Resultant(
        float(reverses),
        placements[0].copy(),
        np.linalg.inv(placements[-1]),
        lift(end[:3, 3], end[:3, 2]),
        np.ascontiguousarray(left),
        np.stack((factor.real, factor.imag)),
        np.stack((rows.real, rows.imag)),
        np.ascontiguousarray(loop),
        np.array(OFFSETS),
    )


def lift(p: FloatArray, l: FloatArray) -> FloatArray:
    """Return ``p, l, p·p, p·l, p×l, (p·p) l - 2 (p·l) p`` of a point and a direction, (14,)."""
    squares = [p @ p, p @ l]
    return np.concatenate((p, l, squares, np.cross(p, l), (p @ p) * l - 2.0 * (p @ l) * p))


def _turn(angle: float) -> FloatArray:
    result = np.eye(4)
    c, s = np.cos(angle), np.sin(angle)
    result[:2, :2] = [[c, -s], [s, c]]
    return result
