"""Compiled poses and Jacobians of one chain at many configurations."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from numpy.typing import NDArray

from kinematics.compiled import jit

Array: TypeAlias = NDArray[Any]


@jit
def forward(C: Array, turns: Array, q: Array, Z: Array, O: Array, T: Array) -> None:
    """Poses along a chain, in the terms of :class:`kinematics.chain.Chain`.

    Args:
        C: Constant placements, shape (K + 1, 12): upper three rows of 4x4 matrices.
        turns: Nonzero for an angle, shape (K,).
        q: Joint values, shape (K,).
        Z: Filled with the axes of the joints, shape (K, 3).
        O: Filled with their origins, shape (K, 3).
        T: Filled with the pose of the frame, 12 numbers.
    """
    r00, r01, r02, p0 = C[0, 0], C[0, 1], C[0, 2], C[0, 3]
    r10, r11, r12, p1 = C[0, 4], C[0, 5], C[0, 6], C[0, 7]
    r20, r21, r22, p2 = C[0, 8], C[0, 9], C[0, 10], C[0, 11]
    for k in range(len(q)):
        if turns[k]:
            c, s = math.cos(q[k]), math.sin(q[k])
            r00, r01 = c * r00 + s * r01, c * r01 - s * r00
            r10, r11 = c * r10 + s * r11, c * r11 - s * r10
            r20, r21 = c * r20 + s * r21, c * r21 - s * r20
        else:
            p0 += q[k] * r02
            p1 += q[k] * r12
            p2 += q[k] * r22
        Z[k, 0], Z[k, 1], Z[k, 2] = r02, r12, r22
        O[k, 0], O[k, 1], O[k, 2] = p0, p1, p2
        x = C[k + 1]
        p0 += r00 * x[3] + r01 * x[7] + r02 * x[11]
        p1 += r10 * x[3] + r11 * x[7] + r12 * x[11]
        p2 += r20 * x[3] + r21 * x[7] + r22 * x[11]
        a, b, c = r00, r01, r02
        r00 = a * x[0] + b * x[4] + c * x[8]
        r01 = a * x[1] + b * x[5] + c * x[9]
        r02 = a * x[2] + b * x[6] + c * x[10]
        a, b, c = r10, r11, r12
        r10 = a * x[0] + b * x[4] + c * x[8]
        r11 = a * x[1] + b * x[5] + c * x[9]
        r12 = a * x[2] + b * x[6] + c * x[10]
        a, b, c = r20, r21, r22
        r20 = a * x[0] + b * x[4] + c * x[8]
        r21 = a * x[1] + b * x[5] + c * x[9]
        r22 = a * x[2] + b * x[6] + c * x[10]
    T[0], T[1], T[2], T[3] = r00, r01, r02, p0
    T[4], T[5], T[6], T[7] = r10, r11, r12, p1
    T[8], T[9], T[10], T[11] = r20, r21, r22, p2


@jit
def forward_many(
    C: Array, turns: Array, columns: Array, Q: Array, q: Array, W: Array, out: Array
) -> None:
    """Poses at many configurations.

    Args:
        C: Constant placements, shape (K + 1, 12).
        turns: Shape (K,).
        columns: Entry of a configuration for each joint, shape (K,).
        Q: Configurations, shape (n, dof).
        q: Memory, shape (K,).
        W: Memory, shape (K, 6).
        out: Filled, shape (n, 16): 4x4 matrices.
    """
    for i in range(len(Q)):
        for k in range(len(columns)):
            q[k] = Q[i, columns[k]]
        forward(C, turns, q, W[:, 0:3], W[:, 3:6], out[i])
        out[i, 12] = out[i, 13] = out[i, 14] = 0.0
        out[i, 15] = 1.0


@jit
def jacobian_many(
    C: Array, turns: Array, columns: Array, Q: Array, q: Array, W: Array, T: Array, out: Array
) -> None:
    """Geometric Jacobians at the frame's origin in base axes, at many configurations.

    Args:
        C: Constant placements, shape (K + 1, 12).
        turns: Shape (K,).
        columns: Entry of a configuration for each joint, shape (K,).
        Q: Configurations, shape (n, dof).
        q: Memory, shape (K,).
        W: Memory, shape (K, 6).
        T: Filled with the poses, shape (n, 16).
        out: Zeros, filled, shape (n, 6, dof).
    """
    for i in range(len(Q)):
        for k in range(len(columns)):
            q[k] = Q[i, columns[k]]
        forward(C, turns, q, W[:, 0:3], W[:, 3:6], T[i])
        T[i, 12] = T[i, 13] = T[i, 14] = 0.0
        T[i, 15] = 1.0
        for k in range(len(columns)):
            j = columns[k]
            zx, zy, zz = W[k, 0], W[k, 1], W[k, 2]
            if turns[k]:
                dx, dy, dz = T[i, 3] - W[k, 3], T[i, 7] - W[k, 4], T[i, 11] - W[k, 5]
                out[i, 0, j] = zy * dz - zz * dy
                out[i, 1, j] = zz * dx - zx * dz
                out[i, 2, j] = zx * dy - zy * dx
                out[i, 3, j], out[i, 4, j], out[i, 5, j] = zx, zy, zz
            else:
                out[i, 0, j], out[i, 1, j], out[i, 2, j] = zx, zy, zz
