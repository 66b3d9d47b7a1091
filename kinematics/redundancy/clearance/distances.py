"""Compiled distances between the links of an arm and obstacles, with witnesses and gradients.

Links are capsules, the rows S of :class:`~.links.Links`. Distances are signed:
negative is the depth of overlap. The formulas are exact; see Ericson, *Real-Time Collision
Detection*, 5.1 and 4.4 (segments, separating axes).
"""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.kernels import Array
from kinematics.redundancy.clearance.link_points import RADIUS, WHOLE, link_points

TINY = 1e-12


@jit
def pair_distance(A: Array, B: Array, obstacle: Array, out: Array) -> float:
    """Return the signed distance between a segment and an obstacle's surface, m.

    Args:
        A: Start of the segment, shape (3,).
        B: End of the segment.
        obstacle: A row of :func:`kinematics.redundancy.clearance.obstacles.encoded`.
        out: Filled: part of the segment where the witness is (0 to 1), the direction from the
            obstacle to the segment there; shape (4,).
    """
    kind = obstacle[0]
    if kind <= 1.0:
        return float(_to_point(A, B, obstacle[1:4], kind == 1.0, out) - obstacle[4])
    if kind == 2.0:
        return float(_to_segment(A, B, obstacle[1:4], obstacle[4:7], out) - obstacle[7])
    if kind == 3.0:
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
def link_distance(W: Array, S: Array, k: int, obstacle: Array, out: Array) -> float:
    """Return the clearance of link k, m, after ``link_points``; out as of :func:`pair_distance`.

    For a half-space, only the end of a link that is not ``WHOLE`` counts.
    """
    P = W[len(W) - len(S) + k]
    if obstacle[0] == 3.0 and S[k, WHOLE] == 0.0:
        return float(pair_distance(P[3:6], P[3:6], obstacle, out) - S[k, RADIUS])
    return float(pair_distance(P[0:3], P[3:6], obstacle, out) - S[k, RADIUS])


@inner
def link_gradient(
    W: Array, is_revolute: Array, K: int, S: Array, k: int, out: Array, half: bool, g: Array
) -> None:
    """Compute the gradient in q of a link's distance from its witness; g of shape (K,)."""
    t, nx, ny, nz = out[0], out[1], out[2], out[3]
    if half and S[k, WHOLE] == 0.0:
        t = 1.0
    P = W[len(W) - len(S) + k]
    first, last = int(S[k, 0]), int(S[k, 1])
    for j in range(K):
        share, x, y, z = 1.0, P[3], P[4], P[5]
        if j <= first:
            x, y, z = P[0] + t * (x - P[0]), P[1] + t * (y - P[1]), P[2] + t * (z - P[2])
        elif j <= last:  # it moves the link's end alone
            share = t
        else:
            g[j] = 0.0
            continue
        zx, zy, zz = W[j, 0], W[j, 1], W[j, 2]
        if is_revolute[j]:
            x, y, z = x - W[j, 3], y - W[j, 4], z - W[j, 5]
            g[j] = nx * (zy * z - zz * y) + ny * (zz * x - zx * z) + nz * (zx * y - zy * x)
            g[j] *= share
        else:
            g[j] = share * (nx * zx + ny * zy + nz * zz)


@inner
def least_distance(W: Array, S: Array, obstacles: Array, out: Array) -> tuple[float, int, int]:
    """Return the smallest clearance of all links and obstacles, m, with link and obstacle."""
    best, link, which = math.inf, -1, -1
    for k in range(len(S)):
        for o in range(len(obstacles)):
            d = link_distance(W, S, k, obstacles[o], out)
            if d < best:
                best, link, which = d, k, o
    return best, link, which


@jit
def clearances(
    C: Array,
    is_revolute: Array,
    Q: Array,
    obstacles: Array,
    S: Array,
    W: Array,
    found: Array,
    whose: Array,
) -> None:
    """Compute the least clearance at many configurations, m.

    Args:
        C: Constants of the chain.
        is_revolute: Shape (K,).
        Q: Shape (n, K).
        obstacles: Shape (M, 16).
        S: Links, shape (L, 11).
        W: Workspace.
        found: Filled, shape (n,).
        whose: Filled: link and obstacle, shape (n, 2).
    """
    out = np.empty(4)
    for i in range(len(Q)):
        link_points(C, is_revolute, Q[i], S, W)
        found[i], link, which = least_distance(W, S, obstacles, out)
        whose[i, 0], whose[i, 1] = link, which


@jit
def near_pairs(
    C: Array,
    is_revolute: Array,
    q: Array,
    obstacles: Array,
    S: Array,
    within: float,
    W: Array,
    d: Array,
    g: Array,
    whose: Array,
) -> tuple[int, float]:
    """List pairs of link and obstacle nearer than ``within``, with clearances and gradients.

    Args:
        C: Constants of the chain.
        is_revolute: Shape (K,).
        q: Shape (K,).
        obstacles: Shape (M, 16).
        S: Links, shape (L, 11).
        within: Largest clearance of a pair that is listed, m.
        W: Workspace.
        d: Filled: clearances, m, shape (P,); of more than P pairs the nearest are listed.
        g: Filled: gradients, shape (P, K).
        whose: Filled: link and obstacle, shape (P, 2).

    Returns:
        Pairs listed, and the least clearance of all.
    """
    K = len(is_revolute)
    out = np.empty(4)
    link_points(C, is_revolute, q, S, W)
    count, least, most = 0, math.inf, len(d)
    for k in range(len(S)):
        for o in range(len(obstacles)):
            c = link_distance(W, S, k, obstacles[o], out)
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
            whose[place, 0], whose[place, 1] = k, o
            link_gradient(W, is_revolute, K, S, k, out, obstacles[o, 0] == 3.0, g[place])
    return count, least


@jit
def listed_pairs(
    C: Array,
    is_revolute: Array,
    q: Array,
    obstacles: Array,
    S: Array,
    whose: Array,
    count: int,
    W: Array,
    d: Array,
    g: Array,
) -> None:
    """Compute clearances and gradients of given pairs; see :func:`near_pairs`."""
    K = len(is_revolute)
    out = np.empty(4)
    link_points(C, is_revolute, q, S, W)
    for i in range(count):
        k, o = int(whose[i, 0]), int(whose[i, 1])
        d[i] = link_distance(W, S, k, obstacles[o], out)
        link_gradient(W, is_revolute, K, S, k, out, obstacles[o, 0] == 3.0, g[i])
