"""Compiled distances between the links of an arm and obstacles, with witnesses and gradients.

Distances are signed, in m: negative is the depth of overlap. The formulas are exact; see Ericson,
*Real-Time Collision Detection*, 5.1 and 4.4 (segments, separating axes).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.task_error import TaskChain
from kinematics.kernels import Array
from kinematics.redundancy.clearance.link_points import RADIUS, WHOLE, link_points
from kinematics.redundancy.clearance.obstacles import CAPSULE, CIRCLE, HALF_SPACE

TINY = 1e-12


class Scene(NamedTuple):
    """What is to keep clear of what.

    Attributes:
        obstacles: See :func:`kinematics.redundancy.clearance.obstacles.encoded`; shape (M, 16).
        links: Capsules of the arm, see :class:`~.links.Links`; shape (L, 11).
    """

    obstacles: Array
    links: Array


class Pairs(NamedTuple):
    """Room for P pairs of link and obstacle.

    Attributes:
        d: Clearances, m, shape (P,).
        g: Their gradients with respect to q, m/rad or m/m, shape (P, K).
        whose: Link and obstacle of each, shape (P, 2).
    """

    d: Array
    g: Array
    whose: Array


@jit
def pair_distance(A: Array, B: Array, obstacle: Array, out: Array) -> float:
    """Return the signed distance between a segment and an obstacle's surface, m.

    Args:
        A: Start of the segment, base axes, m, shape (3,).
        B: End of the segment.
        obstacle: A row of :func:`kinematics.redundancy.clearance.obstacles.encoded`.
        out: Filled: part of the segment where the witness is (0 to 1), the direction from the
            obstacle to the segment there; shape (4,).
    """
    kind = obstacle[0]
    if kind <= CIRCLE:
        return float(_to_point(A, B, obstacle[1:4], kind == CIRCLE, out) - obstacle[4])
    if kind == CAPSULE:
        return float(_to_segment(A, B, obstacle[1:4], obstacle[4:7], out) - obstacle[7])
    if kind == HALF_SPACE:
        n = obstacle[1:4]
        a = n[0] * A[0] + n[1] * A[1] + n[2] * A[2]
        b = n[0] * B[0] + n[1] * B[1] + n[2] * B[2]
        out[0] = 0.0 if a < b else 1.0
        out[1], out[2], out[3] = n[0], n[1], n[2]
        return float(min(a, b) - obstacle[4])
    return _to_box(A, B, obstacle, out)


@inner
def _to_point(A: Array, B: Array, c: Array, flat: bool, out: Array) -> float:
    dx, dy, dz = B[0] - A[0], B[1] - A[1], B[2] - A[2]
    px, py, pz = c[0] - A[0], c[1] - A[1], c[2] - A[2]
    if flat:
        dz = pz = 0.0
    d2 = dx * dx + dy * dy + dz * dz
    t = 0.0
    if d2 > 0.0:
        t = min(1.0, max(0.0, (px * dx + py * dy + pz * dz) / d2))
    x, y, z = t * dx - px, t * dy - py, t * dz - pz
    return _direction(x, y, z, dx, dy, dz, t, out)


@inner
def _direction(
    x: float, y: float, z: float, dx: float, dy: float, dz: float, t: float, out: Array
) -> float:
    """Return the length of (x, y, z), and write its direction; across the segment if it is zero."""
    length = math.sqrt(x * x + y * y + z * z)
    out[0] = t
    if length > TINY:
        out[1], out[2], out[3] = x / length, y / length, z / length
        return length
    if dx * dx + dy * dy > TINY:
        x, y, z = -dy, dx, 0.0
    elif dz * dz > TINY:
        x, y, z = 1.0, 0.0, 0.0
    else:
        x, y, z = 0.0, 0.0, 1.0
    s = math.sqrt(x * x + y * y + z * z)
    out[1], out[2], out[3] = x / s, y / s, z / s
    return length


@inner
def _to_segment(A: Array, B: Array, P: Array, Q: Array, out: Array) -> float:
    ux, uy, uz = B[0] - A[0], B[1] - A[1], B[2] - A[2]
    vx, vy, vz = Q[0] - P[0], Q[1] - P[1], Q[2] - P[2]
    wx, wy, wz = A[0] - P[0], A[1] - P[1], A[2] - P[2]
    a, e = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    f = vx * wx + vy * wy + vz * wz
    s = t = 0.0
    if a <= 0.0 and e > 0.0:
        t = min(1.0, max(0.0, f / e))
    elif a > 0.0:
        c = ux * wx + uy * wy + uz * wz
        if e <= 0.0:
            s = min(1.0, max(0.0, -c / a))
        else:
            b = ux * vx + uy * vy + uz * vz
            # |u x v|²; the difference of products would lose half the digits
            kx, ky, kz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            denominator = kx * kx + ky * ky + kz * kz
            if denominator > 1e-24 * a * e:
                s = min(1.0, max(0.0, (b * f - c * e) / denominator))
            t = (b * s + f) / e
            if t < 0.0:
                t, s = 0.0, min(1.0, max(0.0, -c / a))
            elif t > 1.0:
                t, s = 1.0, min(1.0, max(0.0, (b - c) / a))
    x, y, z = wx + s * ux - t * vx, wy + s * uy - t * vy, wz + s * uz - t * vz
    if x * x + y * y + z * z <= TINY * TINY:  # they cross: separated along the common normal
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        _direction(x, y, z, ux, uy, uz, s, out)
        return 0.0
    return _direction(x, y, z, ux, uy, uz, s, out)


@inner
def _to_box(A: Array, B: Array, box: Array, out: Array) -> float:
    """Return the distance of a segment to a box, m; negative inside, by separating axes."""
    a, d = np.empty(3), np.empty(3)
    for i in range(3):
        u = box[7 + 3 * i : 10 + 3 * i]
        a[i] = d[i] = 0.0
        for k in range(3):
            a[i] += u[k] * (A[k] - box[1 + k])
            d[i] += u[k] * (B[k] - A[k])
    # Derivative of the squared distance along the segment: piecewise linear and rising.
    low, high = 0.0, 1.0
    if _slope(a, d, box, 0.0) >= 0.0:
        t = 0.0
    elif _slope(a, d, box, 1.0) <= 0.0:
        t = 1.0
    else:
        for i in range(3):
            if abs(d[i]) > 0.0:
                for sign in (-1.0, 1.0):
                    cut = (sign * box[4 + i] - a[i]) / d[i]
                    if low < cut < high:
                        if _slope(a, d, box, cut) < 0.0:
                            low = cut
                        else:
                            high = cut
        f, g = _slope(a, d, box, low), _slope(a, d, box, high)
        t = low - f * (high - low) / (g - f) if g > f else 0.5 * (low + high)
        t = min(high, max(low, t))
    x, total = np.empty(3), 0.0
    for i in range(3):
        p = a[i] + t * d[i]
        x[i] = p - min(box[4 + i], max(-box[4 + i], p))
        total += x[i] * x[i]
    if total > TINY * TINY:
        length = math.sqrt(total)
        out[0] = t
        for k in range(3):
            out[1 + k] = (box[7 + k] * x[0] + box[10 + k] * x[1] + box[13 + k] * x[2]) / length
        return length
    # The segment passes through the box: least depth over the box's axes and their products
    # with the segment.
    best = -math.inf
    n = np.empty(3)
    size = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    for axis in range(6):
        n[0] = n[1] = n[2] = 0.0
        i = axis % 3
        if axis < 3:
            n[i] = 1.0
        else:
            j, k = (i + 1) % 3, (i + 2) % 3
            across = math.sqrt(d[j] * d[j] + d[k] * d[k])
            if across <= 1e-9 * size or size <= 0.0:
                continue
            n[j], n[k] = -d[k] / across, d[j] / across
        first = n[0] * a[0] + n[1] * a[1] + n[2] * a[2]
        along = n[0] * d[0] + n[1] * d[1] + n[2] * d[2]
        extent = abs(n[0]) * box[4] + abs(n[1]) * box[5] + abs(n[2]) * box[6]
        for sign in (-1.0, 1.0):
            p, q = sign * first, sign * (first + along)
            apart = min(p, q) - extent
            if apart > best:
                best = apart
                if axis < 3:
                    out[0] = 0.5 if abs(p - q) < TINY else (0.0 if p < q else 1.0)
                else:  # where the segment passes the box's edge
                    j, k = (i + 1) % 3, (i + 2) % 3
                    v = math.copysign(box[4 + j], sign * n[j]) - a[j]
                    w = math.copysign(box[4 + k], sign * n[k]) - a[k]
                    t = (v * d[j] + w * d[k]) / (d[j] * d[j] + d[k] * d[k])
                    out[0] = min(1.0, max(0.0, t))
                for k in range(3):
                    normal = box[7 + k] * n[0] + box[10 + k] * n[1] + box[13 + k] * n[2]
                    out[1 + k] = sign * normal
    return best


@inner
def _slope(a: Array, d: Array, box: Array, t: float) -> float:
    s = 0.0
    for i in range(3):
        p = a[i] + t * d[i]
        if p > box[4 + i]:
            s += d[i] * (p - box[4 + i])
        elif p < -box[4 + i]:
            s += d[i] * (p + box[4 + i])
    return s


@inner
def link_distance(scene: Scene, k: int, o: int, W: Array, out: Array) -> float:
    """Return the clearance of link k from obstacle o, m, after ``link_points``.

    For a half-space, only the end of a link that is not ``WHOLE`` counts.

    Args:
        scene: Links and obstacles.
        k: Number of the link.
        o: Number of the obstacle.
        W: Workspace.
        out: Filled with the witness, see :func:`pair_distance`; shape (4,).
    """
    links, obstacle = scene.links, scene.obstacles[o]
    P = W[len(W) - len(links) + k]
    if obstacle[0] == HALF_SPACE and links[k, WHOLE] == 0.0:
        return float(pair_distance(P[3:6], P[3:6], obstacle, out) - links[k, RADIUS])
    return float(pair_distance(P[0:3], P[3:6], obstacle, out) - links[k, RADIUS])


@inner
def link_gradient(
    chain: TaskChain, scene: Scene, k: int, o: int, W: Array, out: Array, g: Array
) -> None:
    """Compute the gradient of the clearance of link k from obstacle o with respect to q.

    Args:
        chain: The chain.
        scene: Links and obstacles.
        k: Number of the link.
        o: Number of the obstacle.
        W: Workspace.
        out: Witness, as :func:`link_distance` left it.
        g: Filled, m/rad or m/m, shape (n,).
    """
    is_revolute, links, coupled = chain.is_revolute, scene.links, chain.coupling.shape[1]
    for f in range(coupled):
        g[f] = 0.0
    t, nx, ny, nz = out[0], out[1], out[2], out[3]
    if scene.obstacles[o, 0] == HALF_SPACE and links[k, WHOLE] == 0.0:
        t = 1.0
    P = W[len(W) - len(links) + k]
    first, last = int(links[k, 0]), int(links[k, 1])
    for j in range(len(is_revolute)):
        share, x, y, z = 1.0, P[3], P[4], P[5]
        if j <= first:
            x, y, z = P[0] + t * (x - P[0]), P[1] + t * (y - P[1]), P[2] + t * (z - P[2])
        elif j <= last:  # it moves the link's end alone
            share = t
        else:
            if coupled == 0:
                g[j] = 0.0
            continue
        zx, zy, zz = W[j, 0], W[j, 1], W[j, 2]
        if is_revolute[j]:
            x, y, z = x - W[j, 3], y - W[j, 4], z - W[j, 5]
            slope = nx * (zy * z - zz * y) + ny * (zz * x - zx * z) + nz * (zx * y - zy * x)
            slope *= share
        else:
            slope = share * (nx * zx + ny * zy + nz * zz)
        if coupled == 0:
            g[j] = slope
        for f in range(coupled):
            g[f] += slope * chain.coupling[j, f]


@inner
def least_distance(scene: Scene, W: Array, out: Array) -> tuple[float, int, int]:
    """Return the smallest clearance of all links and obstacles, m, and whose it is."""
    best, link, which = math.inf, -1, -1
    for k in range(len(scene.links)):
        for o in range(len(scene.obstacles)):
            d = link_distance(scene, k, o, W, out)
            if d < best:
                best, link, which = d, k, o
    return best, link, which


@jit
def clearances(
    chain: TaskChain, Q: Array, scene: Scene, W: Array, found: Array, whose: Array
) -> None:
    """Compute the least clearance at many configurations.

    Args:
        chain: The chain.
        Q: Joint values, rad and m, shape (n, K).
        scene: Links and obstacles.
        W: Workspace.
        found: Filled, m, shape (n,); inf where there are no pairs.
        whose: Filled: link and obstacle, -1 where there are no pairs; shape (n, 2).
    """
    out = np.empty(4)
    for i in range(len(Q)):
        link_points(chain, Q[i], scene.links, W)
        found[i], link, which = least_distance(scene, W, out)
        whose[i, 0], whose[i, 1] = link, which


@jit
def near_pairs(
    chain: TaskChain, q: Array, scene: Scene, within: float, W: Array, pairs: Pairs
) -> tuple[int, float]:
    """List pairs of link and obstacle nearer than ``within``, with clearances and gradients.

    Args:
        chain: The chain.
        q: Joint values, rad and m, shape (K,).
        scene: Links and obstacles.
        within: Largest clearance of a pair that is listed, m.
        W: Workspace.
        pairs: Filled; of more pairs than it has room for the nearest are listed.

    Returns:
        Pairs listed, and the least clearance of all, m.
    """
    d, out = pairs.d, np.empty(4)
    link_points(chain, q, scene.links, W)
    count, least, most = 0, math.inf, len(d)
    for k in range(len(scene.links)):
        for o in range(len(scene.obstacles)):
            c = link_distance(scene, k, o, W, out)
            least = min(least, c)
            if c > within:
                continue
            place = count
            if count == most:  # full: replaces the farthest, if that is farther
                place = 0
                for i in range(1, most):
                    if d[i] > d[place]:
                        place = i
                if d[place] <= c:
                    continue
            else:
                count += 1
            d[place] = c
            pairs.whose[place, 0], pairs.whose[place, 1] = k, o
            link_gradient(chain, scene, k, o, W, out, pairs.g[place])
    return count, least


@inner
def listed_pairs(chain: TaskChain, q: Array, scene: Scene, W: Array, pairs: Pairs) -> None:
    """Compute clearances and gradients of the pairs that ``pairs.whose`` lists."""
    out = np.empty(4)
    link_points(chain, q, scene.links, W)
    for i in range(len(pairs.d)):
        k, o = int(pairs.whose[i, 0]), int(pairs.whose[i, 1])
        pairs.d[i] = link_distance(scene, k, o, W, out)
        link_gradient(chain, scene, k, o, W, out, pairs.g[i])
