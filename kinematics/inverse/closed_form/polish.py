"""Every candidate is measured on the chain and, where rounding shows, improved; compiled.

A Gauss-Newton step with a trace of damping, ``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e``, kept where it makes the
error smaller. What does not come within ``ACCEPTED`` of the target is no solution.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kinematics.compiled import inner
from kinematics.inverse.closed_form.vectors import wrapped
from robots.robot import FloatArray

ACCEPTED = 1e-9
ENOUGH = 2e-14
STEPS = 6
DAMPING = 1e-13
SAME = 1e-7
WORK = 64
"""Length of the first axis of the working memory, shape (WORK, 6)."""

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]


@inner
def measure(
    placements: FloatArray,
    turns: BoolArray,
    target: FloatArray,
    q: FloatArray,
    work: FloatArray,
) -> None:
    """The error of the pose at q, in base axes.

    Args:
        placements: C_0 … C_K, shape (K + 1, 12).
        turns: True for an angle, shape (K,).
        target: Pose in the base's axes, shape (4, 4).
        q: Shape (K,).
        work: Row 0 receives the position error in m and the rotation error in rad; rows 1 … K
            a point of each axis and its direction, row K + 1 the frame's origin.
    """
    count = len(q)
    x, at = placements, 0
    r00, r01, r02, p0 = x[at, 0], x[at, 1], x[at, 2], x[at, 3]
    r10, r11, r12, p1 = x[at, 4], x[at, 5], x[at, 6], x[at, 7]
    r20, r21, r22, p2 = x[at, 8], x[at, 9], x[at, 10], x[at, 11]
    for k in range(count):
        if turns[k]:
            c, s = math.cos(q[k]), math.sin(q[k])
            r00, r01 = c * r00 + s * r01, c * r01 - s * r00
            r10, r11 = c * r10 + s * r11, c * r11 - s * r10
            r20, r21 = c * r20 + s * r21, c * r21 - s * r20
        else:
            p0 += q[k] * r02
            p1 += q[k] * r12
            p2 += q[k] * r22
        work[k + 1, 0], work[k + 1, 1], work[k + 1, 2] = p0, p1, p2
        work[k + 1, 3], work[k + 1, 4], work[k + 1, 5] = r02, r12, r22
        at = k + 1
        p0 += r00 * x[at, 3] + r01 * x[at, 7] + r02 * x[at, 11]
        p1 += r10 * x[at, 3] + r11 * x[at, 7] + r12 * x[at, 11]
        p2 += r20 * x[at, 3] + r21 * x[at, 7] + r22 * x[at, 11]
        a, b, c = r00, r01, r02
        r00 = a * x[at, 0] + b * x[at, 4] + c * x[at, 8]
        r01 = a * x[at, 1] + b * x[at, 5] + c * x[at, 9]
        r02 = a * x[at, 2] + b * x[at, 6] + c * x[at, 10]
        a, b, c = r10, r11, r12
        r10 = a * x[at, 0] + b * x[at, 4] + c * x[at, 8]
        r11 = a * x[at, 1] + b * x[at, 5] + c * x[at, 9]
        r12 = a * x[at, 2] + b * x[at, 6] + c * x[at, 10]
        a, b, c = r20, r21, r22
        r20 = a * x[at, 0] + b * x[at, 4] + c * x[at, 8]
        r21 = a * x[at, 1] + b * x[at, 5] + c * x[at, 9]
        r22 = a * x[at, 2] + b * x[at, 6] + c * x[at, 10]
    t = target
    work[0, 0], work[0, 1], work[0, 2] = t[0, 3] - p0, t[1, 3] - p1, t[2, 3] - p2
    d00 = t[0, 0] * r00 + t[0, 1] * r01 + t[0, 2] * r02
    d01 = t[0, 0] * r10 + t[0, 1] * r11 + t[0, 2] * r12
    d02 = t[0, 0] * r20 + t[0, 1] * r21 + t[0, 2] * r22
    d10 = t[1, 0] * r00 + t[1, 1] * r01 + t[1, 2] * r02
    d11 = t[1, 0] * r10 + t[1, 1] * r11 + t[1, 2] * r12
    d12 = t[1, 0] * r20 + t[1, 1] * r21 + t[1, 2] * r22
    d20 = t[2, 0] * r00 + t[2, 1] * r01 + t[2, 2] * r02
    d21 = t[2, 0] * r10 + t[2, 1] * r11 + t[2, 2] * r12
    d22 = t[2, 0] * r20 + t[2, 1] * r21 + t[2, 2] * r22
    x0, x1, x2 = 0.5 * (d21 - d12), 0.5 * (d02 - d20), 0.5 * (d10 - d01)
    sine, cosine = math.sqrt(x0 * x0 + x1 * x1 + x2 * x2), 0.5 * (d00 + d11 + d22 - 1.0)
    factor = 1.0
    if cosine < 0.9:
        factor = math.atan2(sine, cosine) / sine if sine > 1e-9 else 1e9
    work[0, 3], work[0, 4], work[0, 5] = factor * x0, factor * x1, factor * x2
    if cosine < 0.0 and sine <= 1e-9:
        work[0, 3] = math.pi
    work[count + 1, 0], work[count + 1, 1], work[count + 1, 2] = p0, p1, p2


@inner
def _columns(turns: BoolArray, work: FloatArray) -> None:
    """The Jacobian, a column a row: rows 1 … K of work, from what :func:`measure` left there."""
    count = len(turns)
    p0, p1, p2 = work[count + 1, 0], work[count + 1, 1], work[count + 1, 2]
    for k in range(1, count + 1):
        o0, o1, o2 = work[k, 0], work[k, 1], work[k, 2]
        z0, z1, z2 = work[k, 3], work[k, 4], work[k, 5]
        if turns[k - 1]:
            o0, o1, o2 = p0 - o0, p1 - o1, p2 - o2
            work[k, 0] = z1 * o2 - z2 * o1
            work[k, 1] = z2 * o0 - z0 * o2
            work[k, 2] = z0 * o1 - z1 * o0
        else:
            work[k, 0], work[k, 1], work[k, 2] = z0, z1, z2
            work[k, 3], work[k, 4], work[k, 5] = 0.0, 0.0, 0.0


@inner
def _norms(work: FloatArray, rows: IntArray) -> tuple[float, float]:
    position = orientation = 0.0
    for row in rows:
        if row < 3:
            position += work[0, row] * work[0, row]
        else:
            orientation += work[0, row] * work[0, row]
    return math.sqrt(position), math.sqrt(orientation)


@inner
def _step(q: FloatArray, rows: IntArray, work: FloatArray) -> None:
    """Adds a damped Gauss-Newton step to q; rows 1 … K of work as :func:`_columns` leaves them."""
    count, m = len(q), len(rows)
    base = count + 1
    largest = 0.0
    for i in range(m):
        for j in range(i + 1):
            total = 0.0
            for k in range(1, count + 1):
                total += work[k, rows[i]] * work[k, rows[j]]
            work[base + i, j] = total
        largest = max(largest, work[base + i, i])
    for j in range(m):
        work[base + j, j] += DAMPING * largest + 1e-300
        pivot = work[base + j, j]
        for k in range(j):
            pivot -= work[base + j, k] * work[base + j, k]
        pivot = math.sqrt(max(pivot, 0.1 * DAMPING * largest + 1e-300))
        work[base + j, j] = pivot
        for i in range(j + 1, m):
            total = work[base + i, j]
            for k in range(j):
                total -= work[base + i, k] * work[base + j, k]
            work[base + i, j] = total / pivot
    y = work[base + 6]
    for i in range(m):
        total = work[0, rows[i]]
        for k in range(i):
            total -= work[base + i, k] * y[k]
        y[i] = total / work[base + i, i]
    for i in range(m - 1, -1, -1):
        total = y[i]
        for k in range(i + 1, m):
            total -= work[base + k, i] * y[k]
        y[i] = total / work[base + i, i]
    for k in range(count):
        for i in range(m):
            q[k] += work[k + 1, rows[i]] * y[i]


@inner
def improve(
    placements: FloatArray,
    turns: BoolArray,
    target: FloatArray,
    rows: IntArray,
    q: FloatArray,
    errors: FloatArray,
    work: FloatArray,
) -> bool:
    """Brings q closer to the target where it can, and measures it.

    Args:
        placements: C_0 … C_K, shape (K + 1, 12).
        turns: True for an angle, shape (K,).
        target: Pose in the base's axes, shape (4, 4).
        rows: The rows of the error that count: 0 … 2 position, 3 … 5 rotation.
        q: A candidate, shape (K,); changed in place.
        errors: Receives the norms of the position error, m, and of the rotation error, rad.
        work: Working memory, shape (WORK, 6).

    Returns:
        Whether q reaches the target within ``ACCEPTED``.
    """
    best = np.inf
    for attempt in range(STEPS + 1):
        measure(placements, turns, target, q, work)
        position, orientation = _norms(work, rows)
        error = position + orientation
        if not error < best:
            if attempt > 0:
                for k in range(len(q)):
                    q[k] = work[WORK - 2 + k // 6, k % 6]
            break
        settled = error > 0.5 * best
        best, errors[0], errors[1] = error, position, orientation
        if error <= ENOUGH or settled or attempt == STEPS:
            break
        for k in range(len(q)):
            work[WORK - 2 + k // 6, k % 6] = q[k]
        _columns(turns, work)
        _step(q, rows, work)
    return bool(best <= ACCEPTED)


@inner
def none_yet() -> int:
    """0, of a type that lets the compiler make one version of what counts on from it."""
    return int(np.int64(0))


@inner
def keep(
    placements: FloatArray,
    turns: BoolArray,
    target: FloatArray,
    rows: IntArray,
    q: FloatArray,
    n: int,
    errors: FloatArray,
    work: FloatArray,
) -> int:
    """Row n of q becomes a solution if it is one and no earlier row is the same.

    Args:
        placements: C_0 … C_K, shape (K + 1, 12).
        turns: True for an angle, shape (K,).
        target: Pose in the base's axes, shape (4, 4).
        rows: The rows of the error that count.
        q: Solutions so far, then a candidate in row n; shape (N, K).
        n: Number of solutions so far.
        errors: Position and rotation errors of the solutions, m and rad; shape (N, 2).
        work: Working memory.

    Returns:
        Number of solutions now, n or n + 1.
    """
    candidate = q[n]
    if not improve(placements, turns, target, rows, candidate, errors[n], work):
        return n
    for k in range(len(candidate)):
        if turns[k]:
            candidate[k] = wrapped(candidate[k])
    for i in range(n):
        same = True
        for k in range(len(candidate)):
            difference = candidate[k] - q[i, k]
            if turns[k]:
                difference = wrapped(difference)
            if abs(difference) > SAME:
                same = False
                break
        if same:
            return n
    return n + 1
