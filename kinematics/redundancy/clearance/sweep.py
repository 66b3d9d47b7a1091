"""Compiled least clearance between two configurations, all joints moving linearly.

Between samples q moves on a straight line, so every point of a link has a bounded speed and a
bounded acceleration. Within an interval of half width h about a configuration where a link has the
clearance c, its clearance is at least ``c − h v − h² a / 2``, with v the largest speed of the
link's ends there and a the bound on acceleration: intervals are halved until that bound suffices.
The result is a lower bound that is attained up to ``RESOLUTION``.
"""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import least_distance, link_distance
from kinematics.redundancy.clearance.link_points import OFFSET, link_points

RESOLUTION = 1e-5
"""Largest difference of a reported swept clearance below the true one, m."""
MAX_DEPTH = 40
MAX_VISITS = 20_000
"""Configurations evaluated in one interval; then the bound proved so far is returned."""
MAX_DISTANCES = 100_000_000
"""Distances computed for a whole path: some seconds."""


@inner
def reaches(W: Array, K: int, R: Array) -> None:
    """Compute bounds R[j, k] of the distance of joint j from joint k (K: the frame), m."""
    for j in range(K):
        total = 0.0
        for k in range(j + 1, K + 1):
            x = W[k, 3] - W[k - 1, 3]
            y = W[k, 4] - W[k - 1, 4]
            z = W[k, 5] - W[k - 1, 5]
            total += math.sqrt(x * x + y * y + z * z)
            R[j, k] = max(R[j, k], total)


@jit
def swept_clearance(
    C: Array,
    is_revolute: Array,
    a: Array,
    b: Array,
    obstacles: Array,
    S: Array,
    enough: float,
    resolution: float,
    W: Array,
    most: int = MAX_VISITS,
) -> float:
    """Return a lower bound of the clearance of all configurations between a and b, m.

    Args:
        C: Constants of the chain.
        is_revolute: Shape (K,).
        a: One end, shape (K,).
        b: The other.
        obstacles: Shape (M, 16).
        S: Links, shape (L, 11).
        enough: Clearance at whose proof the search stops, m.
        resolution: Largest difference of the bound from an attained clearance, m.
        W: Workspace.
        most: Configurations evaluated before the bound proved so far is returned.

    Returns:
        The bound, m; at least ``enough`` where that is proved.
    """
    K = len(is_revolute)
    if len(obstacles) == 0:
        return math.inf
    d, q, out = b - a, np.empty(K), np.empty(4)
    R = np.zeros((K, K + 1))
    link_points(C, is_revolute, a, S, W)
    reaches(W, K, R)
    attained, _, _ = least_distance(W, S, obstacles, out)
    link_points(C, is_revolute, b, S, W)
    reaches(W, K, R)
    other, _, _ = least_distance(W, S, obstacles, out)
    attained = min(attained, other)
    spin = 0.0
    for j in range(K):
        spin += abs(d[j]) if is_revolute[j] else 0.0
    acceleration = np.zeros(len(S))
    for k in range(len(S)):
        for j in range(K):
            arm = max(_lever(S, R, is_revolute, j, k, 0), _lever(S, R, is_revolute, j, k, 1))
            acceleration[k] += 2.0 * spin * abs(d[j]) * arm
    bound, visits = math.inf, 0
    stack = np.empty((MAX_DEPTH + 2, 2))
    stack[0, 0], stack[0, 1] = 0.0, 1.0
    top = 1
    while top > 0:
        top -= 1
        low, high = stack[top, 0], stack[top, 1]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        for j in range(K):
            q[j] = a[j] + middle * d[j]
        link_points(C, is_revolute, q, S, W)
        visits += 1
        certain = math.inf
        for k in range(len(S)):
            v = max(_speed(W, is_revolute, d, S, k, 0), _speed(W, is_revolute, d, S, k, 1))
            loss = half * v + 0.5 * half * half * acceleration[k]
            for o in range(len(obstacles)):
                c = link_distance(W, S, k, obstacles[o], out)
                attained = min(attained, c)
                certain = min(certain, c - loss)
        if certain >= min(enough, attained - resolution) or top >= MAX_DEPTH or visits >= most:
            bound = min(bound, certain)
        else:
            stack[top, 0], stack[top, 1] = middle, high
            stack[top + 1, 0], stack[top + 1, 1] = low, middle
            top += 2
    return min(bound, attained)


@inner
def _lever(S: Array, R: Array, is_revolute: Array, j: int, k: int, end: int) -> float:
    """Return the largest distance of joint j from an end of link k; 1 if prismatic, 0 if beyond."""
    row = int(S[k, end])
    if j > row:
        return 0.0
    if not is_revolute[j]:
        return 1.0
    at = OFFSET + 3 * end
    x, y, z = S[k, at], S[k, at + 1], S[k, at + 2]
    return float(R[j, row] + math.sqrt(x * x + y * y + z * z))


@inner
def _speed(W: Array, is_revolute: Array, d: Array, S: Array, k: int, end: int) -> float:
    """Return the speed of an end of link k per unit of the interval, m."""
    P = W[len(W) - len(S) + k, 3 * end : 3 * end + 3]
    x = y = z = 0.0
    for j in range(min(int(S[k, end]), len(d) - 1) + 1):
        zx, zy, zz = W[j, 0], W[j, 1], W[j, 2]
        if is_revolute[j]:
            rx, ry, rz = P[0] - W[j, 3], P[1] - W[j, 4], P[2] - W[j, 5]
            x += d[j] * (zy * rz - zz * ry)
            y += d[j] * (zz * rx - zx * rz)
            z += d[j] * (zx * ry - zy * rx)
        else:
            x, y, z = x + d[j] * zx, y + d[j] * zy, z + d[j] * zz
    return math.sqrt(x * x + y * y + z * z)


@jit
def swept_clearances(
    C: Array,
    is_revolute: Array,
    Q: Array,
    obstacles: Array,
    S: Array,
    resolution: float,
    W: Array,
    found: Array,
    first: int,
    last: int,
    enough: float,
) -> float:
    """Compute :func:`swept_clearance` between successive configurations, shape (n - 1,).

    Only the least of all is resolved; the others are proved not to be below it.

    Args:
        C: Constants of the chain.
        is_revolute: Shape (K,).
        Q: Configurations, shape (n, K).
        obstacles: Shape (M, 16).
        S: Links, see :mod:`kinematics.redundancy.clearance.link_points`.
        resolution: Largest difference of the bound from an attained clearance, m.
        W: Workspace.
        found: Filled from ``first`` up to before ``last``.
        first: The first interval.
        last: The one after the last.
        enough: Least clearance of the intervals before, m.

    Returns:
        The least clearance so far, m.
    """
    work = max(1, len(S) * len(obstacles) * (len(Q) - 1))
    most = max(16, min(MAX_VISITS, MAX_DISTANCES // work))
    for i in range(first, last):
        found[i] = swept_clearance(
            C, is_revolute, Q[i], Q[i + 1], obstacles, S, enough, resolution, W, most
        )
        enough = min(enough, found[i])
    return enough
