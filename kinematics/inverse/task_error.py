"""Compiled: the error of a pose in a task, and the Jacobian of that error.

Poses are the upper three rows of 4x4 matrices, row by row (12 numbers), in base axes. Scalars stand
where small arrays would be clearer, because that is what the compiler keeps in registers.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kinematics.chain import Chain
from kinematics.compiled import inner, jit
from kinematics.kernels import Array, forward
from kinematics.task import Task


class TaskChain(NamedTuple):
    """A chain of K joints, moved by n ≤ K unknowns, and the rows of error that a task counts.

    Attributes:
        C: Constant placements C_0 … C_K, shape (K + 1, 12); see :class:`kinematics.chain.Chain`.
        is_revolute: Nonzero for an angle, shape (K,).
        mask: See :attr:`kinematics.task.Task.mask`; shape (7,).
        coupling: Joint values by unknowns, shape (K, n); (K, 0) where they are the unknowns.
        offset: Joint values where the unknowns are 0, shape (K,).
    """

    C: Array
    is_revolute: Array
    mask: Array
    coupling: Array
    offset: Array


def task_chain(chain: Chain, task: Task) -> TaskChain:
    """Return what compiled functions know of a chain and a task, every array of floats."""
    return TaskChain(
        chain.placements,
        chain.is_revolute.astype(np.float64),
        task.mask,
        chain.coupling,
        chain.offset,
    )


@inner
def unknowns(chain: TaskChain) -> int:
    """Return the number of unknowns that move a chain, n."""
    n = chain.coupling.shape[1]
    return int(n if n > 0 else len(chain.is_revolute))


@inner
def joint_values(chain: TaskChain, q: Array) -> Array:
    """Return the joint values of a coupled chain, shape (K,), at unknowns of shape (n,)."""
    coupling, values = chain.coupling, np.empty(len(chain.is_revolute))
    for k in range(len(values)):
        value = chain.offset[k]
        for j in range(len(q)):
            value += coupling[k, j] * q[j]
        values[k] = value
    return values


@inner
def add_up(chain: TaskChain, rows: Array) -> None:
    """Turn derivatives by joints, shape (K, m), into those by unknowns in the first n rows."""
    K, m = rows.shape
    n, sums = chain.coupling.shape[1], np.zeros((chain.coupling.shape[1], m))
    for k in range(K):
        for j in range(n):
            c = chain.coupling[k, j]
            if c != 0.0:
                for i in range(m):
                    sums[j, i] += c * rows[k, i]
    for j in range(n):
        for i in range(m):
            rows[j, i] = sums[j, i]


@jit
def workspace(K: int) -> Array:
    """Return memory for a chain of K joints, shape (K + 2 + ⌈K / 4⌉, 12); one a thread.

    Row k < K holds axis, origin (base axes, m) and Jacobian column of joint k, row K the pose of
    the frame, row K + 1 the task error (6) and memory of the solver (6). The rest is a
    configuration (K), sines and cosines (2 K).
    """
    return np.empty((K + 2 + (3 * K + 11) // 12, 12))


@jit
def twist_error(T: Array, G: Array, e: Array) -> None:
    """Fill e with the position error, m, and the rotation vector of ``R_G R_Tᵀ``, rad.

    Both in base axes. The rotation vector is exact to rounding from 0 to half a turn.

    Args:
        T: Pose of the frame, 12 numbers.
        G: Pose of the target, 12 numbers.
        e: Filled, shape (6,).
    """
    e[0], e[1], e[2] = G[3] - T[3], G[7] - T[7], G[11] - T[11]
    d00 = G[0] * T[0] + G[1] * T[1] + G[2] * T[2]
    d01 = G[0] * T[4] + G[1] * T[5] + G[2] * T[6]
    d02 = G[0] * T[8] + G[1] * T[9] + G[2] * T[10]
    d10 = G[4] * T[0] + G[5] * T[1] + G[6] * T[2]
    d11 = G[4] * T[4] + G[5] * T[5] + G[6] * T[6]
    d12 = G[4] * T[8] + G[5] * T[9] + G[6] * T[10]
    d20 = G[8] * T[0] + G[9] * T[1] + G[10] * T[2]
    d21 = G[8] * T[4] + G[9] * T[5] + G[10] * T[6]
    d22 = G[8] * T[8] + G[9] * T[9] + G[10] * T[10]
    x, y, z = 0.5 * (d21 - d12), 0.5 * (d02 - d20), 0.5 * (d10 - d01)
    s = math.sqrt(x * x + y * y + z * z)
    c = 0.5 * (d00 + d11 + d22 - 1.0)
    angle = math.atan2(s, c)
    if c > 0.0 or s > 1e-3:
        f = 1.0 if s < 1e-9 else angle / s
        e[3], e[4], e[5] = f * x, f * y, f * z
        return
    # Near half a turn the antisymmetric part vanishes; the axis is in the symmetric one.
    b = 1.0 - c
    u, v, w = math.sqrt(max(0.0, (d00 - c) / b)), math.sqrt(max(0.0, (d11 - c) / b)), 0.0
    w = math.sqrt(max(0.0, (d22 - c) / b))
    if u >= v and u >= w:
        u = -u if x < 0.0 else u
        v, w = 0.5 * (d01 + d10) / (b * u), 0.5 * (d02 + d20) / (b * u)
    elif v >= w:
        v = -v if y < 0.0 else v
        u, w = 0.5 * (d01 + d10) / (b * v), 0.5 * (d12 + d21) / (b * v)
    else:
        w = -w if z < 0.0 else w
        u, v = 0.5 * (d02 + d20) / (b * w), 0.5 * (d12 + d21) / (b * w)
    e[3], e[4], e[5] = angle * u, angle * v, angle * w


@inner
def axis_error(T: Array, G: Array, e: Array) -> None:
    """Fill e with the position error, m, and the rotation vector that turns z_T to z_G, rad.

    The rotation vector is perpendicular to both axes; arguments as of :func:`twist_error`.
    """
    e[0], e[1], e[2] = G[3] - T[3], G[7] - T[7], G[11] - T[11]
    x, y, z = T[2], T[6], T[10]
    u, v, w = G[2], G[6], G[10]
    a, b, c = y * w - z * v, z * u - x * w, x * v - y * u
    s, along = math.sqrt(a * a + b * b + c * c), x * u + y * v + z * w
    if along < 0.0 and s < 1e-9:  # half a turn, about any axis across: the frame's x
        e[3], e[4], e[5] = math.pi * T[0], math.pi * T[4], math.pi * T[8]
        return
    f = 1.0 if s < 1e-9 else math.atan2(s, along) / s
    e[3], e[4], e[5] = f * a, f * b, f * c


@jit
def residual(chain: TaskChain, G: Array, q: Array, W: Array) -> tuple[float, float]:
    """Compute pose and task error at q into the workspace.

    Args:
        chain: The chain and the task.
        G: Pose of the target, 12 numbers or more.
        q: Unknowns, rad and m, shape (n,).
        W: See :func:`workspace`.

    Returns:
        Squared norms of the position error, m², and of the rotation error, rad².
    """
    K, mask = len(chain.is_revolute), chain.mask
    T, e = W[K], W[K + 1]
    trig = W[K + 2 :].reshape(-1)[K : 3 * K]
    if chain.coupling.shape[1] > 0:
        forward(chain.C, chain.is_revolute, joint_values(chain, q), trig, W, T)
    else:
        forward(chain.C, chain.is_revolute, q, trig, W, T)
    if mask[6] != 0.0:
        axis_error(T, G, e)
    else:
        twist_error(T, G, e)
    for i in range(6):
        e[i] *= mask[i]
    position = e[0] * e[0] + e[1] * e[1] + e[2] * e[2]
    rotation = e[3] * e[3] + e[4] * e[4] + e[5] * e[5]
    return position, rotation


@jit
def columns(chain: TaskChain, W: Array) -> None:
    """Compute the task Jacobian at the q of the last :func:`residual` into the workspace.

    Columns stand in rows: ``W[j, 6:12]`` is that of unknown j, in base axes. With own axes the
    rotation about the frame's z axis is taken out.
    """
    is_revolute, mask, K = chain.is_revolute, chain.mask, len(chain.is_revolute)
    Z, O, J, T = W[0:K, 0:3], W[0:K, 3:6], W[0:K, 6:12], W[K]
    m0, m1, m2, m3, m4, m5 = mask[0], mask[1], mask[2], mask[3], mask[4], mask[5]
    px, py, pz = T[3], T[7], T[11]
    for k in range(K):
        zx, zy, zz = Z[k, 0], Z[k, 1], Z[k, 2]
        if is_revolute[k]:
            dx, dy, dz = px - O[k, 0], py - O[k, 1], pz - O[k, 2]
            J[k, 0] = m0 * (zy * dz - zz * dy)
            J[k, 1] = m1 * (zz * dx - zx * dz)
            J[k, 2] = m2 * (zx * dy - zy * dx)
            J[k, 3], J[k, 4], J[k, 5] = m3 * zx, m4 * zy, m5 * zz
        else:
            J[k, 0], J[k, 1], J[k, 2] = m0 * zx, m1 * zy, m2 * zz
            J[k, 3] = J[k, 4] = J[k, 5] = 0.0
    if mask[6] != 0.0:
        ax, ay, az = T[2], T[6], T[10]
        for k in range(K):
            about = J[k, 3] * ax + J[k, 4] * ay + J[k, 5] * az
            J[k, 3] -= about * ax
            J[k, 4] -= about * ay
            J[k, 5] -= about * az
    if chain.coupling.shape[1] > 0:
        add_up(chain, J)
