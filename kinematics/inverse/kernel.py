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
TOUCH = 1e-12
"""A limit exceeded by no more than this is rounding."""

CONVERGED, GIVEN_UP, UNREACHABLE, OUT_OF_STEPS = 1, 0, 2, 3
UNREACHABLE_RESTARTS = 2


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
def residual(
    C: Array,
    turns: Array,
    rows: Array,
    G: Array,
    q: Array,
    W: Array,
) -> tuple[float, float]:
    """Task error at q into the workspace; returns the squared position and rotation errors."""
    K, m = len(q), len(rows)
    e, T, full = W[K + 6, 6:12], W[K + 7], W[K + 8]
    forward(C, turns, q, W[0:K, 0:3], W[0:K, 3:6], T)
    twist_error(T, G, full)
    position, rotation = 0.0, 0.0
    for i in range(m):
        value = full[rows[i]]
        e[i] = value
        if rows[i] < 3:
            position += value * value
        else:
            rotation += value * value
    return position, rotation


@jit
def step(
    turns: Array,
    lower: Array,
    upper: Array,
    wraps: Array,
    rows: Array,
    q: Array,
    damping: float,
    W: Array,
    result: Array,
) -> None:
    """A damped step from the q of the last residual, within the limits, into result (K)."""
    K, m = len(q), len(rows)
    Z, O, J = W[0:K, 0:3], W[0:K, 3:6], W[0:K, 6:12]
    A, y, e = W[K : K + 6, 0:6], W[K + 6, 0:6], W[K + 6, 6:12]
    T, full = W[K + 7], W[K + 8]
    for k in range(K):
        zx, zy, zz = Z[k, 0], Z[k, 1], Z[k, 2]
        full[0], full[1], full[2] = zx, zy, zz
        full[3] = full[4] = full[5] = 0.0
        if turns[k]:
            dx, dy, dz = T[3] - O[k, 0], T[7] - O[k, 1], T[11] - O[k, 2]
            full[0], full[1], full[2] = zy * dz - zz * dy, zz * dx - zx * dz, zx * dy - zy * dx
            full[3], full[4], full[5] = zx, zy, zz
        for i in range(m):
            J[k, i] = full[rows[i]]
    # A joint that is held has its limit as result; NaN marks the free ones meanwhile.
    for k in range(K):
        result[k] = math.nan
    for _ in range(K):
        for i in range(m):
            for j in range(i + 1):
                total = 0.0
                for k in range(K):
                    if math.isnan(result[k]):
                        total += J[k, i] * J[k, j]
                A[i, j] = total
            A[i, i] += damping
        _solve_cholesky(A, e, y, m)
        again = False
        for k in range(K):
            if not math.isnan(result[k]) or wraps[k]:
                continue
            delta = 0.0
            for i in range(m):
                delta += J[k, i] * y[i]
            if (q[k] <= lower[k] and delta < 0.0) or (q[k] >= upper[k] and delta > 0.0):
                result[k] = q[k]
                again = True
        if not again:
            break
    for k in range(K):
        if math.isnan(result[k]):
            delta = 0.0
            for i in range(m):
                delta += J[k, i] * y[i]
            result[k] = inside(q[k] + delta, lower[k], upper[k], wraps[k])


@jit
def _solve_cholesky(
    A: Array,
    e: Array,
    y: Array,
    m: int,
) -> None:
    """Solves ``A y = e`` for a positive definite A (its lower triangle), in place."""
    for j in range(m):
        total = A[j, j]
        for k in range(j):
            total -= A[j, k] * A[j, k]
        pivot = math.sqrt(max(total, 1e-300))
        A[j, j] = pivot
        for i in range(j + 1, m):
            total = A[i, j]
            for k in range(j):
                total -= A[i, k] * A[j, k]
            A[i, j] = total / pivot
    for i in range(m):
        total = e[i]
        for k in range(i):
            total -= A[i, k] * y[k]
        y[i] = total / A[i, i]
    for i in range(m - 1, -1, -1):
        total = y[i]
        for k in range(i + 1, m):
            total -= A[k, i] * y[k]
        y[i] = total / A[i, i]


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
    found: Array,
    errors: Array,
    count: int,
    P: Array,
    N: Array,
    seed: Array,
    limits: Array,
    q: Array,
) -> int:
    """Of solutions in closed form the one nearest to the seed, within the limits, into q.

    Angles are turned by whole turns as near to the seed as the limits allow.

    Args:
        found: Solutions, shape (count or more, K).
        errors: Their position and rotation errors, shape (count or more, 2).
        count: How many there are.
        P: Constants of the chain; see :func:`packed`.
        N: Its whole numbers; see :func:`packed`.
        seed: Shape (K,).
        limits: Squared tolerances first.
        q: Filled, shape (K,).

    Returns:
        Its index, or -1 where none is within the limits and the tolerance.
    """
    K = N[0]
    best, index = math.inf, -1
    for i in range(count):
        if errors[i, 0] ** 2 > limits[0] or errors[i, 1] ** 2 > limits[1]:
            continue
        distance = 0.0
        for k in range(K):
            low, high = P[12 * (K + 1) + k], P[12 * (K + 1) + K + k]
            value = found[i, k]
            if N[8 + k]:
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
        q[:K] = found[index]
    return index


@jit
def descend(
    C: Array,
    turns: Array,
    lower: Array,
    upper: Array,
    wraps: Array,
    rows: Array,
    G: Array,
    q: Array,
    best: Array,
    limits: Array,
    W: Array,
) -> tuple[int, int]:
    """One start from q, which it moves. Returns its steps and CONVERGED or GIVEN_UP.

    best holds energy, then q; limits the squared tolerances and the most steps.
    """
    K = len(q)
    moved = W[K + 9 :].reshape(-1)[:K]
    stalls, lowest = 0, math.inf
    iteration = 0
    while True:
        position, rotation = residual(C, turns, rows, G, q, W)
        energy = 0.5 * (position + rotation)
        converged = position <= limits[0] and rotation <= limits[1]
        if converged or energy < best[0]:
            best[0] = energy
            best[1 : K + 1] = q
        if converged:
            return iteration, CONVERGED
        stalls = 0 if energy < STALL_RATIO * lowest else stalls + 1
        lowest = min(lowest, energy)
        if stalls >= STALLS or iteration >= limits[2]:
            return iteration, GIVEN_UP
        step(turns, lower, upper, wraps, rows, q, DAMPING * energy + FLOOR, W, moved)
        q[:] = moved
        iteration += 1


@jit
def settle(
    C: Array,
    turns: Array,
    lower: Array,
    upper: Array,
    wraps: Array,
    rows: Array,
    G: Array,
    best: Array,
    limits: Array,
    W: Array,
) -> int:
    """From the best q down to the nearest pose, every step a descent (Marquardt's rule)."""
    K = len(best) - 1
    moved = W[K + 9 :].reshape(-1)[:K]
    damping = DAMPING * best[0] + FLOOR
    iteration = 0
    while iteration < limits[2] and damping <= MAX_DAMPING:
        iteration += 1
        residual(C, turns, rows, G, best[1 : K + 1], W)
        step(turns, lower, upper, wraps, rows, best[1 : K + 1], damping, W, moved)
        position, rotation = residual(C, turns, rows, G, moved, W)
        energy = 0.5 * (position + rotation)
        if energy < best[0]:
            settled = energy > SETTLED * best[0]
            best[0] = energy
            best[1 : K + 1] = moved
            if settled or (position <= limits[0] and rotation <= limits[1]):
                break
            damping /= 5.0
        else:
            damping *= 4.0
    return iteration


@jit
def solve(
    C: Array,
    turns: Array,
    lower: Array,
    upper: Array,
    wraps: Array,
    rows: Array,
    starts: Array,
    G: Array,
    seed: Array,
    first: int,
    last: int,
    budget: int,
    best: Array,
    limits: Array,
    W: Array,
) -> tuple[int, int, int]:
    """Starts first … last, as long as the budget of steps is not used up.

    Start 0 is the seed, start s the s-th point of the sequence ``frac(offset + s*ratio)`` scaled
    to the joint ranges: starts holds offset, ratio, low and span, shape (4, K). Returns the steps,
    the start that came last, and CONVERGED or GIVEN_UP.
    """
    K = len(seed)
    q = W[K + 9 :].reshape(-1)[K : 2 * K]
    steps, code, s = 0, GIVEN_UP, first
    while True:
        for k in range(K):
            u = starts[0, k] + s * starts[1, k]
            q[k] = seed[k] if s == 0 else starts[2, k] + (u - math.floor(u)) * starts[3, k]
        used, code = descend(C, turns, lower, upper, wraps, rows, G, q, best, limits, W)
        steps += used
        if code == CONVERGED or s >= last or steps + s - first >= budget:
            return steps, s, code
        s += 1


@jit
def finish(
    C: Array,
    turns: Array,
    lower: Array,
    upper: Array,
    wraps: Array,
    rows: Array,
    G: Array,
    seed: Array,
    best: Array,
    limits: Array,
    W: Array,
    answer: Array,
) -> int:
    """Turns the best q towards the seed and measures it: answer holds q and the two errors."""
    K = len(seed)
    for k in range(K):
        answer[k] = nearest_turn(best[k + 1], seed[k], lower[k], upper[k], wraps[k])
    position, rotation = residual(C, turns, rows, G, answer[:K], W)
    answer[K], answer[K + 1] = math.sqrt(position), math.sqrt(rotation)
    return CONVERGED if position <= limits[0] and rotation <= limits[1] else GIVEN_UP


@jit
def prepare(P: Array, N: Array, G: Array, options: Array) -> tuple[int, bool]:
    """Most starts of a target, and whether it is provably farther away than the arm is long."""
    K = N[0]
    away = 0.0
    for i in range(N[1]):
        if N[2 + i] < 3:
            column = 4 * N[2 + i] + 3
            away += (G[column] - P[column]) ** 2
    limit = P[12 * (K + 1) + 6 * K] * (1.0 + 1e-9) + math.sqrt(options[0])
    last = int(options[3])
    return (min(last, UNREACHABLE_RESTARTS), True) if away > limit * limit else (last, False)


@jit
def proceed(
    P: Array,
    N: Array,
    G: Array,
    seed: Array,
    first: int,
    budget: int,
    options: Array,
    answer: Array,
    W: Array,
) -> int:
    """Solves one target, or goes on with it: starts first …, until the budget of steps is spent.

    Args:
        P: Constants of the chain; see :func:`packed`.
        N: Its whole numbers; see :func:`packed`.
        G: Target, 12 numbers.
        seed: Start 0, within the limits; shape (K,).
        first: The start to begin with; above 0, W must be as the last call left it.
        budget: Steps after which no new start is begun.
        options: Squared tolerances, most steps of a start, most restarts.
        answer: Filled: q, position and rotation error, steps, last start, code (K + 5).
        W: Workspace.

    Returns:
        The next start, or -1 if the solve is over.
    """
    K, m = N[0], N[1]
    C = P[: 12 * (K + 1)].reshape((K + 1, 12))
    bounds = P[12 * (K + 1) : 12 * (K + 1) + 6 * K].reshape((6, K))
    lower, upper, starts = bounds[0], bounds[1], bounds[2:6]
    rows, turns, wraps = N[2 : 2 + m], N[8 : 8 + K], N[8 + K : 8 + 2 * K]
    best = W[K + 9 :].reshape(-1)[2 * K : 3 * K + 1]
    last, unreachable = prepare(P, N, G, options)
    if first == 0:
        best[0] = math.inf
        best[1 : K + 1] = seed
        answer[K + 2] = 0.0
    steps, s, code = solve(
        C, turns, lower, upper, wraps, rows, starts, G, seed, first, last, budget, best, options, W
    )
    over = code == CONVERGED or s >= last
    if code != CONVERGED and over and options[2] > 0:
        steps += settle(C, turns, lower, upper, wraps, rows, G, best, options, W)
    code = finish(C, turns, lower, upper, wraps, rows, G, seed, best, options, W, answer)
    answer[K + 2] += steps
    answer[K + 3] = s
    answer[K + 4] = code
    if code != CONVERGED:
        answer[K + 4] = UNREACHABLE if unreachable else GIVEN_UP if over else OUT_OF_STEPS
    return -1 if code == CONVERGED or over else s + 1


@jit
def proceed_many(
    P: Array,
    N: Array,
    targets: Array,
    seed: Array,
    budget: int,
    options: Array,
    answers: Array,
    W: Array,
) -> None:
    """Target by target: fills answers (n, K + 5)."""
    for i in range(len(targets)):
        proceed(P, N, targets[i], seed, 0, budget, options, answers[i], W)


def packed(
    C: Array, bounds: Array, starts: Array, reach: float, turns: Array, wraps: Array, rows: Array
) -> tuple[Array, Array]:
    """Constants of a chain in two arrays, which are quicker to hand over than seven.

    Returns:
        P: C_0 … C_K, lower, upper, then offset, ratio, low and span of the starts, and the reach.
        N: K, the number of task rows, the rows (six places), turns, wraps.
    """
    P = np.concatenate((C.reshape(-1), bounds.reshape(-1), starts.reshape(-1), [reach]))
    N = np.concatenate(([len(turns), len(rows)], np.resize(rows, 6), turns, wraps))
    return P, N.astype(np.int64)


def workspace(K: int) -> Array:
    """Memory for chains of K joints; one a thread."""
    return np.empty((K + 9 + (3 * K + 1 + 11) // 12 + 1, 12))
