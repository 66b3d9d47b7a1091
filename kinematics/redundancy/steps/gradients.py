"""Compiled potentials of the joint space and their analytic gradients.

A method descends a potential; a quantity to maximise (manipulability) enters with a minus sign.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.task_error import TaskChain, unknowns
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import Scene, link_distance, link_gradient
from kinematics.redundancy.clearance.link_points import link_points
from kinematics.redundancy.kernel import ArmConstants, least_step, orthonormal_rows


class Repulsion(NamedTuple):
    """How obstacles repel.

    Attributes:
        safe: Clearance that is kept, m.
        influence: Clearance from which on an obstacle repels, m; above ``safe``.
    """

    safe: float
    influence: float


@jit
def limit_potential(q: Array, lower: Array, upper: Array, g: Array) -> float:
    """Return ``H = 1/n Σ ((q_j − mid_j) / (upper_j − mid_j))²``; write its gradient into g.

    Joints without limits contribute nothing (Liégeois, IEEE Trans. SMC 7(12), 1977). Arrays
    of shape (n,), rad and m.
    """
    n, total = len(q), 0.0
    for j in range(n):
        half = 0.5 * (upper[j] - lower[j])
        g[j] = 0.0
        if 0.0 < half < math.inf:
            x = (q[j] - 0.5 * (lower[j] + upper[j])) / half
            total += x * x / n
            g[j] = 2.0 * x / (n * half)
    return total


@jit
def posture_potential(q: Array, wanted: Array, g: Array) -> float:
    """Return ``½ ‖q − wanted‖²``; write its gradient into g; all of shape (K,), rad and m."""
    total = 0.0
    for j in range(len(q)):
        g[j] = q[j] - wanted[j]
        total += 0.5 * g[j] * g[j]
    return total


@jit
def obstacle_potential(
    chain: TaskChain, q: Array, scene: Scene, repulsion: Repulsion, W: Array, g: Array
) -> float:
    """Return ``Σ ½ ((influence − d) / (influence − safe))²`` of pairs nearer than ``influence``.

    Args:
        chain: The chain.
        q: Joint values, rad and m, shape (K,).
        scene: Links and obstacles.
        repulsion: How obstacles repel.
        W: Workspace.
        g: Filled with the gradient, shape (K,).
    """
    K, total = len(q), 0.0
    out, one = np.empty(4), np.empty(K)
    g[:] = 0.0
    link_points(chain, q, scene.links, W)
    scale = 1.0 / (repulsion.influence - repulsion.safe)
    for k in range(len(scene.links)):
        for o in range(len(scene.obstacles)):
            x = (repulsion.influence - link_distance(scene, k, o, W, out)) * scale
            if x > 0.0:
                total += 0.5 * x * x
                link_gradient(chain, scene, k, o, W, out, one)
                for j in range(K):
                    g[j] -= x * scale * one[j]
    return total


@jit
def manipulability_potential(arm: ArmConstants, W: Array, g: Array) -> float:
    """Return ``−w = −sqrt det(J Jᵀ)``; write its gradient into g, 0 where J loses rank.

    ``∂w/∂q_j = w tr(J† ∂J/∂q_j)``, with the derivatives of the geometric Jacobian in closed form:
    a column of linear velocity changes with joint j by ``ω_j × v_i`` for j ≤ i and by
    ``ω_i × v_j`` beyond, one of angular velocity by ``ω_j × ω_i`` for j < i. Where unknowns are
    coupled, by joint values first.

    Args:
        arm: Constants of the arm.
        W: Workspace, after :func:`kinematics.inverse.task_error.residual` at q.
        g: Filled, shape (K,).
    """
    is_revolute, rows, own = arm.chain.is_revolute, arm.rows, arm.own
    K, m = len(is_revolute), len(rows)
    n, coupled = unknowns(arm.chain), arm.chain.coupling.shape[1] > 0
    T = W[K]
    V, O = np.empty((K, 3)), np.zeros((K, 3))
    for k in range(K):
        if is_revolute[k]:
            x, y, z = T[3] - W[k, 3], T[7] - W[k, 4], T[11] - W[k, 5]
            V[k] = _cross(W[k, 0], W[k, 1], W[k, 2], x, y, z)
            O[k, 0], O[k, 1], O[k, 2] = W[k, 0], W[k, 1], W[k, 2]
        else:
            V[k, 0], V[k, 1], V[k, 2] = W[k, 0], W[k, 1], W[k, 2]
    J = np.empty((m, K))
    for i in range(m):
        for k in range(K):
            J[i, k] = _component(V[k], O[k], rows[i], own, T)
    if coupled:
        J = in_unknowns(arm.chain, J)
    Q, L = np.empty((m, n)), np.zeros((m, m))
    order = np.empty(m, dtype=np.int64)
    g[:] = 0.0
    if orthonormal_rows(J, Q, L, order) < m:
        return 0.0
    w = 1.0
    for i in range(m):
        w *= L[i, i]
    P, e, y, s = np.empty((n, m)), np.zeros(m), np.empty(m), np.empty(n)
    for i in range(m):
        e[:] = 0.0
        e[i] = 1.0
        least_step(Q, L, order, e, y, s)
        for k in range(n):
            P[k, i] = s[k]
    if coupled:
        P = in_joints(arm.chain, P)
    for j in range(K):
        trace = 0.0
        for i in range(K):
            dv = np.zeros(3)
            dw = np.zeros(3)
            if j <= i:
                dv = _cross(O[j, 0], O[j, 1], O[j, 2], V[i, 0], V[i, 1], V[i, 2])
            else:
                dv = _cross(O[i, 0], O[i, 1], O[i, 2], V[j, 0], V[j, 1], V[j, 2])
            if j < i and not own:
                dw = _cross(O[j, 0], O[j, 1], O[j, 2], O[i, 0], O[i, 1], O[i, 2])
            elif j >= i and own:  # the frame's axes rotate as well, with every joint
                dw = _cross(O[i, 0], O[i, 1], O[i, 2], O[j, 0], O[j, 1], O[j, 2])
            for r in range(m):
                trace += P[i, r] * _component(dv, dw, rows[r], own, T)
        if coupled:
            for f in range(n):
                g[f] -= w * trace * arm.chain.coupling[j, f]
        else:
            g[j] = -w * trace
    return -w


@inner
def in_unknowns(chain: TaskChain, J: Array) -> Array:
    """Return a Jacobian by unknowns, shape (m, n), from one by joints, shape (m, K)."""
    m, n = len(J), chain.coupling.shape[1]
    found = np.zeros((m, n))
    for i in range(m):
        for k in range(J.shape[1]):
            for j in range(n):
                found[i, j] += J[i, k] * chain.coupling[k, j]
    return found


@inner
def in_joints(chain: TaskChain, P: Array) -> Array:
    """Return motions of joints, shape (K, m), from those of unknowns, shape (n, m)."""
    K, n = chain.coupling.shape
    found = np.zeros((K, P.shape[1]))
    for k in range(K):
        for j in range(n):
            for i in range(P.shape[1]):
                found[k, i] += chain.coupling[k, j] * P[j, i]
    return found


@inner
def _cross(a: float, b: float, c: float, x: float, y: float, z: float) -> Array:
    v = np.empty(3)
    v[0], v[1], v[2] = b * z - c * y, c * x - a * z, a * y - b * x
    return v


@inner
def _component(v: Array, o: Array, row: int, own: bool, T: Array) -> float:
    if row < 3:
        return float(v[row])
    if own:
        return float(T[row - 3] * o[0] + T[row + 1] * o[1] + T[row + 5] * o[2])
    return float(o[row - 3])
