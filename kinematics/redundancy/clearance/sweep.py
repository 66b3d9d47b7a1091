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
from kinematics.inverse.task_error import TaskChain, joint_values
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import Scene, least_distance, link_distance
from kinematics.redundancy.clearance.link_points import OFFSET, link_points_at

RESOLUTION = 1e-5
"""Largest difference of a reported swept clearance below the true one, m."""
MAX_DEPTH = 40
MAX_VISITS = 20_000
"""Configurations evaluated in one interval; then the bound proved so far is returned."""
MAX_DISTANCES = 100_000_000
"""Distances computed for a whole path: some seconds."""


@inner
def _reaches(W: Array, R: Array) -> None:
    """Raise R[j, k] to the distance of joint j from joint k (K: the frame), m, or above.

    It is at most the lengths between, added up. R has shape (K, K + 1).
    """
    K = len(R)
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
    chain: TaskChain,
    a: Array,
    b: Array,
    scene: Scene,
    enough: float,
    W: Array,
    most: int = MAX_VISITS,
) -> float:
    """Return a lower bound of the clearance of all configurations between a and b, m.

    Args:
        chain: The chain.
        a: One end, unknowns in rad and m, shape (n,).
        b: The other.
        scene: Links and obstacles.
        enough: Clearance at whose proof the search stops, m.
        W: Workspace.
        most: Configurations evaluated before the bound proved so far is returned.

    Returns:
        The bound: at most ``RESOLUTION`` below an attained clearance, or at least ``enough``.
    """
    is_revolute, links, K = chain.is_revolute, scene.links, len(chain.is_revolute)
    if len(scene.obstacles) == 0:
        return math.inf
    if chain.coupling.shape[1] > 0:
        # Joint values are linear in the unknowns, and so on a straight line as well.
        a, b = joint_values(chain, a), joint_values(chain, b)
    d, q, out = b - a, np.empty(K), np.empty(4)
    R = np.zeros((K, K + 1))
    link_points_at(chain, a, links, W)
    _reaches(W, R)
    attained, _, _ = least_distance(scene, W, out)
    link_points_at(chain, b, links, W)
    _reaches(W, R)
    other, _, _ = least_distance(scene, W, out)
    attained = min(attained, other)
    spin = 0.0
    for j in range(K):
        spin += abs(d[j]) if is_revolute[j] else 0.0
    acceleration = np.zeros(len(links))
    for k in range(len(links)):
        for j in range(K):
            arm = max(_lever(chain, links, R, j, k, 0), _lever(chain, links, R, j, k, 1))
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
        link_points_at(chain, q, links, W)
        visits += 1
        certain = math.inf
        for k in range(len(links)):
            v = max(_speed(chain, links, W, d, k, 0), _speed(chain, links, W, d, k, 1))
            loss = half * v + 0.5 * half * half * acceleration[k]
            for o in range(len(scene.obstacles)):
                c = link_distance(scene, k, o, W, out)
                attained = min(attained, c)
                certain = min(certain, c - loss)
        if certain >= min(enough, attained - RESOLUTION) or top >= MAX_DEPTH or visits >= most:
            bound = min(bound, certain)
        else:
            stack[top, 0], stack[top, 1] = middle, high
            stack[top + 1, 0], stack[top + 1, 1] = low, middle
            top += 2
    return min(bound, attained)


@inner
def _lever(chain: TaskChain, links: Array, R: Array, j: int, k: int, end: int) -> float:
    """Return the largest distance of joint j from an end of link k, m.

    1 if the joint is prismatic, 0 if it is beyond the link.
    """
    row = int(links[k, end])
    if j > row:
        return 0.0
    if not chain.is_revolute[j]:
        return 1.0
    at = OFFSET + 3 * end
    x, y, z = links[k, at], links[k, at + 1], links[k, at + 2]
    return float(R[j, row] + math.sqrt(x * x + y * y + z * z))


@inner
def _speed(chain: TaskChain, links: Array, W: Array, d: Array, k: int, end: int) -> float:
    """Return the speed of an end of link k where the joints move with speeds d, shape (K,)."""
    P = W[len(W) - len(links) + k, 3 * end : 3 * end + 3]
    x = y = z = 0.0
    for j in range(min(int(links[k, end]), len(d) - 1) + 1):
        zx, zy, zz = W[j, 0], W[j, 1], W[j, 2]
        if chain.is_revolute[j]:
            rx, ry, rz = P[0] - W[j, 3], P[1] - W[j, 4], P[2] - W[j, 5]
            x += d[j] * (zy * rz - zz * ry)
            y += d[j] * (zz * rx - zx * rz)
            z += d[j] * (zx * ry - zy * rx)
        else:
            x, y, z = x + d[j] * zx, y + d[j] * zy, z + d[j] * zz
    return math.sqrt(x * x + y * y + z * z)


@jit
def swept_clearances(
    chain: TaskChain, Q: Array, scene: Scene, enough: float, most: int, W: Array, found: Array
) -> float:
    """Compute :func:`swept_clearance` between successive configurations.

    Only the least of all is resolved; the others are proved not to be below it.

    Args:
        chain: The chain.
        Q: Configurations, rad and m, shape (n, K).
        scene: Links and obstacles.
        enough: The least clearance of the intervals before, m.
        most: Configurations looked at in one interval.
        W: Workspace.
        found: Filled, m, shape (n - 1,).

    Returns:
        The least clearance so far, m.
    """
    for i in range(len(found)):
        found[i] = swept_clearance(chain, Q[i], Q[i + 1], scene, enough, W, most)
        enough = min(enough, found[i])
    return enough


def most_visits(scene: Scene, intervals: int) -> int:
    """Return how many configurations may be looked at in each interval of a path."""
    distances = max(1, len(scene.links) * len(scene.obstacles) * intervals)
    return max(16, min(MAX_VISITS, MAX_DISTANCES // distances))
