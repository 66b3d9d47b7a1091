"""The compiled solver of one chain: FK, error, Jacobian and damped step, fused, no allocation.

Damping by the error (Chan and Lawrence 1988; Sugihara, IEEE T-RO 27(5), 2011): with the residual
``E = ½ eᵀe``, ``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e`` and ``λ = 0.03 E + 1e-10``. Joints that span a turn
wrap; others are held at a limit as long as the step would push them through it. A start that
stalls is given up for the next point of a low-discrepancy sequence.

Everything is in the terms of :class:`kinematics.chain.Chain`; poses are the upper three rows of
4x4 matrices, row by row (12 numbers). Scalars stand where small arrays would be clearer, because
that is what the compiler keeps in registers.
"""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import jit
from kinematics.kernels import Array, forward

DAMPING = 0.03
FLOOR = 1e-10
STALL_RATIO = 0.9
STALLS = 3
SETTLED = 1.0 - 1e-9
MAX_DAMPING = 1e6
TURN = 2.0 * math.pi
HEAD = 10
"""Place of the first row of bounds in the constants."""
TOUCH = 1e-12
"""A limit exceeded by no more than this is rounding."""

CONVERGED, GIVEN_UP, UNREACHABLE, OUT_OF_STEPS = 1, 0, 2, 3
UNREACHABLE_RESTARTS = 2
NUMERIC = -1
"""Kind of a chain without closed form."""


@jit
def twist_error(
    T: Array,
    G: Array,
    e: Array,
) -> None:
    """Position error and rotation vector of ``R_G R_Tᵀ`` in base axes, into e (6)."""
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


@jit
def axis_error(T: Array, G: Array, e: Array) -> None:
    """Position error, and the rotation vector across both that turns z_T to z_G, into e (6)."""
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
def residual(
    C: Array, is_revolute: Array, mask: Array, G: Array, q: Array, W: Array
) -> tuple[float, float]:
    """Task error at q into the workspace; returns the squared position and rotation errors."""
    K = len(q)
    T, e = W[K], W[K + 1, 0:6]
    trig = W[K + 2 :].reshape(-1)[2 * K : 4 * K]
    forward(C, is_revolute, q, trig, W[0:K, 0:3], W[0:K, 3:6], T)
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
def columns(is_revolute: Array, mask: Array, K: int, W: Array) -> None:
    """The task Jacobian at the q of the last residual, a column a row, into the workspace."""
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


@jit
def step(
    is_revolute: Array,
    lower: Array,
    upper: Array,
    wraps: Array,
    mask: Array,
    q: Array,
    damping: float,
    W: Array,
    result: Array,
) -> None:
    """A damped step from the q of the last residual, within the limits, into result (K).

    The result may be q itself.
    """
    K = len(q)
    J, e, y = W[0:K, 6:12], W[K + 1, 0:6], W[K + 1, 6:12]
    delta = W[K + 2 :].reshape(-1)[:K]
    columns(is_revolute, mask, K, W)
    for _ in range(K):
        damped(J, K, damping, e, y)
        again = False
        for k in range(K):
            d = 0.0
            for i in range(6):
                d += J[k, i] * y[i]
            delta[k] = d
            if wraps[k] == 0.0 and (
                (d < 0.0 and q[k] <= lower[k]) or (d > 0.0 and q[k] >= upper[k])
            ):
                J[k, :] = 0.0  # held at its limit: the others do without it
                again = True
        if not again:
            break
    for k in range(K):
        result[k] = inside(q[k] + delta[k], lower[k], upper[k], wraps[k])


@jit
def damped(J: Array, K: int, damping: float, e: Array, y: Array) -> None:
    """Solves ``(Σ J_k J_kᵀ + damping) y = e`` by symmetric elimination (LDLᵀ).

    Every pivot is at least the damping, but for rounding, which is not let below it.
    """
    a00 = a11 = a22 = a33 = a44 = a55 = damping
    a10 = a20 = a30 = a40 = a50 = a21 = a31 = a41 = a51 = 0.0
    a32 = a42 = a52 = a43 = a53 = a54 = 0.0
    for k in range(K):
        j0, j1, j2, j3, j4, j5 = J[k, 0], J[k, 1], J[k, 2], J[k, 3], J[k, 4], J[k, 5]
        a00 += j0 * j0
        a10, a11 = a10 + j1 * j0, a11 + j1 * j1
        a20, a21, a22 = a20 + j2 * j0, a21 + j2 * j1, a22 + j2 * j2
        a30, a31, a32, a33 = a30 + j3 * j0, a31 + j3 * j1, a32 + j3 * j2, a33 + j3 * j3
        a40, a41, a42 = a40 + j4 * j0, a41 + j4 * j1, a42 + j4 * j2
        a43, a44 = a43 + j4 * j3, a44 + j4 * j4
        a50, a51, a52 = a50 + j5 * j0, a51 + j5 * j1, a52 + j5 * j2
        a53, a54, a55 = a53 + j5 * j3, a54 + j5 * j4, a55 + j5 * j5
    y0, y1, y2, y3, y4, y5 = e[0], e[1], e[2], e[3], e[4], e[5]

    r0 = 1.0 / a00
    f1, f2, f3, f4, f5 = a10 * r0, a20 * r0, a30 * r0, a40 * r0, a50 * r0
    a11 -= f1 * a10
    a21, a22 = a21 - f2 * a10, a22 - f2 * a20
    a31, a32, a33 = a31 - f3 * a10, a32 - f3 * a20, a33 - f3 * a30
    a41, a42, a43, a44 = a41 - f4 * a10, a42 - f4 * a20, a43 - f4 * a30, a44 - f4 * a40
    a51, a52, a53 = a51 - f5 * a10, a52 - f5 * a20, a53 - f5 * a30
    a54, a55 = a54 - f5 * a40, a55 - f5 * a50
    y1, y2, y3, y4, y5 = y1 - f1 * y0, y2 - f2 * y0, y3 - f3 * y0, y4 - f4 * y0, y5 - f5 * y0

    r1 = 1.0 / max(a11, damping)
    f2, f3, f4, f5 = a21 * r1, a31 * r1, a41 * r1, a51 * r1
    a22 -= f2 * a21
    a32, a33 = a32 - f3 * a21, a33 - f3 * a31
    a42, a43, a44 = a42 - f4 * a21, a43 - f4 * a31, a44 - f4 * a41
    a52, a53, a54, a55 = a52 - f5 * a21, a53 - f5 * a31, a54 - f5 * a41, a55 - f5 * a51
    y2, y3, y4, y5 = y2 - f2 * y1, y3 - f3 * y1, y4 - f4 * y1, y5 - f5 * y1

    r2 = 1.0 / max(a22, damping)
    f3, f4, f5 = a32 * r2, a42 * r2, a52 * r2
    a33 -= f3 * a32
    a43, a44 = a43 - f4 * a32, a44 - f4 * a42
    a53, a54, a55 = a53 - f5 * a32, a54 - f5 * a42, a55 - f5 * a52
    y3, y4, y5 = y3 - f3 * y2, y4 - f4 * y2, y5 - f5 * y2

    r3 = 1.0 / max(a33, damping)
    f4, f5 = a43 * r3, a53 * r3
    a44 -= f4 * a43
    a54, a55 = a54 - f5 * a43, a55 - f5 * a53
    y4, y5 = y4 - f4 * y3, y5 - f5 * y3

    r4 = 1.0 / max(a44, damping)
    f5 = a54 * r4
    a55 -= f5 * a54
    y5 -= f5 * y4

    y5 = y5 / max(a55, damping)
    y4 = (y4 - a54 * y5) * r4
    y3 = (y3 - a43 * y4 - a53 * y5) * r3
    y2 = (y2 - a32 * y3 - a42 * y4 - a52 * y5) * r2
    y1 = (y1 - a21 * y2 - a31 * y3 - a41 * y4 - a51 * y5) * r1
    y0 = (y0 - a10 * y1 - a20 * y2 - a30 * y3 - a40 * y4 - a50 * y5) * r0
    y[0], y[1], y[2], y[3], y[4], y[5] = y0, y1, y2, y3, y4, y5


@jit
def inside(
    value: float,
    lower: float,
    upper: float,
    wraps: bool,
) -> float:
    """A joint value within its limits: by whole turns where it wraps, else the nearest limit."""
    if wraps:
        if value < lower:
            value += TURN * math.ceil((lower - value) / TURN)
        elif value > upper:
            value -= TURN * math.ceil((value - upper) / TURN)
    return min(max(value, lower), upper)


@jit
def inside_all(q: Array, lower: Array, upper: Array, wraps: Array, result: Array) -> None:
    """:func:`inside` for each joint."""
    for k in range(len(q)):
        result[k] = inside(q[k], lower[k], upper[k], wraps[k])


@jit
def nearest_turn(
    value: float,
    reference: float,
    lower: float,
    upper: float,
    wraps: bool,
) -> float:
    """The same direction as value by whole turns, within the limits, nearest to a reference."""
    if not wraps:
        return value
    candidate = value + TURN * math.floor((reference - value) / TURN + 0.5)
    if candidate > upper:
        candidate -= TURN
    elif candidate < lower:
        candidate += TURN
    return candidate if lower <= candidate <= upper else value


@jit
def nearest(
    found: Array, errors: Array, count: int, P: Array, seed: Array, limits: Array, q: Array
) -> int:
    """Of solutions in closed form the one nearest to the seed, within the limits, into q.

    Angles are turned by whole turns as near to the seed as the limits allow.

    Args:
        found: Solutions, shape (count or more, K).
        errors: Their position and rotation errors, shape (count or more, 2).
        count: How many there are.
        P: Constants of the chain; see :func:`packed`.
        seed: Shape (K,).
        limits: Squared tolerances first.
        q: Filled, shape (K or more,).

    Returns:
        Its index, or -1 where none is within the limits and the tolerance.
    """
    K, _, _, bounds, _ = unpacked(P)
    lower, upper, is_revolute = bounds[0], bounds[1], bounds[6]
    best, index = math.inf, -1
    for i in range(count):
        if errors[i, 0] ** 2 > limits[0] or errors[i, 1] ** 2 > limits[1]:
            continue
        distance = 0.0
        for k in range(K):
            low, high, value = lower[k], upper[k], found[i, k]
            if is_revolute[k]:
                value += TURN * math.floor((seed[k] - value) / TURN + 0.5)
                if value > high + TOUCH and value - TURN >= low - TOUCH:
                    value -= TURN
                elif value < low - TOUCH and value + TURN <= high + TOUCH:
                    value += TURN
            if value > high + TOUCH or value < low - TOUCH:
                distance = math.inf
                break
            value = min(max(value, low), high)
            found[i, k] = value
            distance += (value - seed[k]) ** 2
        if distance < best:
            best, index = distance, i
    if index >= 0:
        for k in range(K):
            q[k] = found[index, k]
    return index


@jit
def descend(
    C: Array,
    bounds: Array,
    mask: Array,
    G: Array,
    q: Array,
    best: Array,
    limits: Array,
    W: Array,
) -> tuple[int, int]:
    """One start from q, which it moves. Returns its steps and CONVERGED or GIVEN_UP.

    best holds q, its energy and its squared errors; limits the squared tolerances and the most
    steps.
    """
    K = len(q)
    lower, upper, is_revolute, wraps = bounds[0], bounds[1], bounds[6], bounds[7]
    stalls, lowest = 0, math.inf
    iteration = 0
    while True:
        position, rotation = residual(C, is_revolute, mask, G, q, W)
        energy = 0.5 * (position + rotation)
        converged = position <= limits[0] and rotation <= limits[1]
        if converged or energy < best[K]:
            best[K], best[K + 1], best[K + 2] = energy, position, rotation
            for k in range(K):
                best[k] = q[k]
        if converged:
            return iteration, CONVERGED
        stalls = 0 if energy < STALL_RATIO * lowest else stalls + 1
        lowest = min(lowest, energy)
        if stalls >= STALLS or iteration >= limits[2]:
            return iteration, GIVEN_UP
        step(is_revolute, lower, upper, wraps, mask, q, DAMPING * energy + FLOOR, W, q)
        iteration += 1


@jit
def settle(
    C: Array, bounds: Array, mask: Array, G: Array, best: Array, limits: Array, W: Array, q: Array
) -> int:
    """From the best q down to the nearest pose, every step a descent (Marquardt's rule).

    q is memory, shape (K,).
    """
    K = len(q)
    lower, upper, is_revolute, wraps = bounds[0], bounds[1], bounds[6], bounds[7]
    damping = DAMPING * best[K] + FLOOR
    iteration = 0
    while iteration < limits[2] and damping <= MAX_DAMPING:
        iteration += 1
        residual(C, is_revolute, mask, G, best[:K], W)
        step(is_revolute, lower, upper, wraps, mask, best[:K], damping, W, q)
        position, rotation = residual(C, is_revolute, mask, G, q, W)
        energy = 0.5 * (position + rotation)
        if energy < best[K]:
            settled = energy > SETTLED * best[K]
            best[K], best[K + 1], best[K + 2] = energy, position, rotation
            for k in range(K):
                best[k] = q[k]
            if settled or (position <= limits[0] and rotation <= limits[1]):
                break
            damping /= 5.0
        else:
            damping *= 4.0
    return iteration


@jit
def _beyond(P: Array, G: Array, limits: Array) -> bool:
    """True where a target is provably farther away than the arm is long."""
    _, reach, mask, _, C = unpacked(P)
    away = 0.0
    for i in range(3):
        away += mask[i] * (G[4 * i + 3] - C[0, 4 * i + 3]) ** 2
    limit = reach * (1.0 + 1e-9) + math.sqrt(limits[0])
    return away > limit * limit


@jit
def proceed(
    P: Array,
    G: Array,
    seed: Array,
    first: int,
    budget: int,
    limits: Array,
    most: int,
    answer: Array,
    W: Array,
) -> tuple[int, int, int]:
    """Solves one target, or goes on with it: starts first …, until the budget of steps is spent.

    Start 0 is the seed, start s the s-th point of the sequence ``frac(offset + s*ratio)`` scaled
    to the joint ranges.

    Args:
        P: Constants of the chain; see :func:`packed`.
        G: Target, 12 or 16 numbers.
        seed: Start 0, within the limits; shape (K,).
        first: The start to begin with; above 0, the answer must be as the last call left it.
        budget: Steps after which no new start is begun.
        limits: Squared tolerances, most steps of a start.
        most: Most restarts.
        answer: Filled: q, its position and rotation error, then the best q of all starts, its
            energy and squared errors; shape (2 K + 5,).
        W: Workspace.

    Returns:
        Steps, the start that came last, and a code. After OUT_OF_STEPS the next start may follow.
    """
    K, _, mask, bounds, C = unpacked(P)
    lower, upper, is_revolute, wraps = bounds[0], bounds[1], bounds[6], bounds[7]
    best, q = answer[K + 2 : 2 * K + 5], W[K + 2 :].reshape(-1)[K : 2 * K]
    unreachable = _beyond(P, G, limits)
    last = min(most, UNREACHABLE_RESTARTS) if unreachable else most
    if first == 0:
        best[K] = math.inf
        for k in range(K):
            best[k] = seed[k]
    steps, s = 0, first
    while True:
        for k in range(K):
            u = bounds[2, k] + s * bounds[3, k]
            q[k] = seed[k] if s == 0 else bounds[4, k] + (u - math.floor(u)) * bounds[5, k]
        used, code = descend(C, bounds, mask, G, q, best, limits, W)
        steps += used
        if code == CONVERGED or s >= last or steps + s - first >= budget:
            break
        s += 1
    over = code == CONVERGED or s >= last
    if code != CONVERGED and over and limits[2] > 0:
        steps += settle(C, bounds, mask, G, best, limits, W, q)
    position, rotation, turned = best[K + 1], best[K + 2], False
    for k in range(K):
        answer[k] = nearest_turn(best[k], seed[k], lower[k], upper[k], wraps[k])
        turned = turned or answer[k] != best[k]
    if turned:
        position, rotation = residual(C, is_revolute, mask, G, answer[:K], W)
    answer[K], answer[K + 1] = math.sqrt(position), math.sqrt(rotation)
    if position <= limits[0] and rotation <= limits[1]:
        return steps, s, CONVERGED
    return steps, s, UNREACHABLE if unreachable else GIVEN_UP if over else OUT_OF_STEPS


def packed(
    placements: Array,
    is_revolute: Array,
    wraps: Array,
    bounds: Array,
    starts: Array,
    reach: float,
    mask: Array,
    kind: int = NUMERIC,
    form: Array | None = None,
) -> Array:
    """Constants of a chain in one array, which is quicker to hand over than eight.

    Args:
        placements: C_0 … C_K, shape (K + 1, 12).
        is_revolute: Nonzero for an angle, shape (K,).
        wraps: Nonzero where a joint spans a turn, shape (K,).
        bounds: Lower and upper limits, shape (2, K).
        starts: Offset, ratio, low and span, shape (4, K).
        reach: See :attr:`kinematics.chain.Chain.reach`.
        mask: See :attr:`kinematics.task.Task.mask`; shape (7,).
        kind: Class of its closed form, for whom it may concern.
        form: Constants of its closed form.

    Returns:
        K, reach, kind, mask, then lower, upper, the starts, turns and wraps, then C_0 … C_K, then
        the closed form's.
    """
    head = np.concatenate(([len(is_revolute), reach, kind], mask))
    rows = np.concatenate((bounds, starts, [is_revolute, wraps]))
    tail = np.empty(0) if form is None else form
    return np.concatenate((head, rows.reshape(-1), placements.reshape(-1), tail))


@jit
def unpacked(P: Array) -> tuple[int, float, Array, Array, Array]:
    """K, reach, mask (7), bounds (8, K), and C (K + 1, 12) of what :func:`packed` made."""
    K = int(P[0])
    bounds = P[HEAD : HEAD + 8 * K].reshape((8, K))
    C = P[HEAD + 8 * K : HEAD + 20 * K + 12].reshape((K + 1, 12))
    return K, P[1], P[3:HEAD], bounds, C


@jit
def workspace(K: int) -> Array:
    """Memory for chains of K joints; one a thread."""
    return np.empty((K + 2 + (4 * K + 11) // 12, 12))
