"""Compiled: follow complex solutions along a way of targets.

A step is predicted by the cubic through the last two points and their directions, and corrected by
Newton's method. Its length halves where the correction is large or does not settle, so that the
step stays on its own solution.
"""

from __future__ import annotations

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.continuation.complex_chain import (
    Closure,
    Way,
    complex_forward,
    linearise,
    solve,
    target_at,
)
from kinematics.kernels import Array

ARRIVED, BESIDE, FAR, LOST = 0, 1, 2, 3
"""Ends of a way: at its target; at or just before it where solutions meet; at infinity; before."""
FIRST_STEP = 0.05
SHORTEST = 1e-9
MOST_STEPS = 600
SETTLED = 1e-4
"""Last correction of a step, rad: Newton's method squares it."""
POLISHED = 1e-9
"""Last correction at the target, rad."""
LARGEST_ANGLE, LARGEST_LENGTH = 25.0, 1e5
"""Imaginary part of an angle, rad, and a length in sizes of the chain, beyond which is infinity."""
SINGULAR = 1e-7
"""Smallest pivot of a Jacobian, in parts of its largest, below which solutions meet."""
NO_RANK = 1e-13
"""Smallest pivot below which a Newton step means nothing."""
MOST_POLISHING = 40
LONGEST = 0.3
"""Longest polishing step beside where solutions meet, rad or sizes."""
NEAR = 1e-2
"""Rest of a way that counts as just before its target."""


@jit
def pose_of(chain: Closure, q: Array, P: Array) -> None:
    """Compute the pose of the frame at complex joint values, 12 numbers."""
    complex_forward(chain, q, np.empty((len(q), 6), np.complex128), P)


@inner
def _corrected(
    chain: Closure, way: Way, t: float, q: Array, most: float, W: Array, G: Array, A: Array
) -> float:
    """Correct q by Newton's method; return the first correction, infinite where it fails."""
    m, P, first = len(chain.rows), G[12:], np.inf
    target_at(way, t, G)
    for attempt in range(4):
        linearise(chain, way, G, q, W, P, A)
        if solve(A) == 0.0:
            return np.inf
        size = 0.0
        for c in range(m):
            d = A[c, m]
            size = max(size, abs(d.real) + abs(d.imag))
            q[chain.unknowns[c]] += d
        if attempt == 0:
            first = size
            if not first <= most:
                return np.inf
        elif not size <= 0.3 * first:
            return np.inf
        if size < SETTLED:
            return first
    return np.inf


@inner
def _follow(chain: Closure, way: Way, q: Array, most: float, floats: Array) -> int:
    """Follow one solution to the end of a way.

    Args:
        chain: The chain and its task.
        way: The way.
        q: Joint values at its start, shape (K,); changed to those of its end.
        most: Largest first correction of a step, rad.
        floats: Memory, shape (6 K + 110,), complex.

    Returns:
        How it ended.
    """
    K, m = len(q), len(chain.rows)
    G, W = floats[:24], floats[24 : 36 + 6 * K].reshape((K + 2, 6))
    A = floats[36 + 6 * K : 36 + 6 * K + m * (m + 2)].reshape((m, m + 2))
    before, direction = np.empty(m, np.complex128), np.empty(m, np.complex128)
    direction_before, trial = np.empty(m, np.complex128), q.copy()
    target_at(way, 0.0, G)
    linearise(chain, way, G, q, W, G[12:], A)
    if solve(A) == 0.0:
        return LOST
    for c in range(m):
        direction[c] = A[c, m + 1]
        before[c], direction_before[c] = q[chain.unknowns[c]], direction[c]
    t, last, h = 0.0, 0.0, FIRST_STEP
    for _ in range(MOST_STEPS):
        h = min(h, 1.0 - t)
        whole = h >= 1.0 - t
        at = 1.0 if whole else t + h
        for c in range(m):
            k = chain.unknowns[c]
            if last > 0.0:
                s = (h + last) / last
                trial[k] = (
                    (2.0 * s - 3.0) * s * s * (before[c] - q[k])
                    + before[c]
                    + last * s * ((s - 1.0) * (s - 1.0)) * direction_before[c]
                    + last * s * s * (s - 1.0) * direction[c]
                )
            else:
                trial[k] = q[k] + h * direction[c]
        for j in range(len(chain.driven)):
            trial[chain.driven[j]] = way.start[j] + way.change[j] * at
        first = _corrected(chain, way, at, trial, most, W, G, A)
        if first > most:
            h *= 0.4
            if h < SHORTEST:
                return BESIDE if 1.0 - t < NEAR else LOST
            continue
        for c in range(m):
            k = chain.unknowns[c]
            before[c], direction_before[c] = q[k], direction[c]
            direction[c] = A[c, m + 1]
            if chain.is_revolute[k] != 0.0:
                near = abs(trial[k].imag) < LARGEST_ANGLE
            else:
                near = abs(trial[k]) < LARGEST_LENGTH
            if not near:
                return FAR if 1.0 - t < NEAR else LOST
        for k in range(K):
            q[k] = trial[k]
        if whole:
            return ARRIVED
        t, last = at, h
        if first < 0.05 * most:
            h *= 2.0
        elif first < 0.3 * most:
            h *= 1.4
    return BESIDE if 1.0 - t < NEAR else LOST


@jit
def follow(chain: Closure, way: Way, Q: Array, most: float, ends: Array) -> None:
    """Follow solutions to the end of a way.

    Args:
        chain: The chain and its task.
        way: The way.
        Q: Joint values at its start, one solution a row, shape (N, K); changed to those of its
            end, or of where they were last known.
        most: Largest first correction of a step, rad; a smaller one is safer and slower.
        ends: Filled with how each ended, shape (N,).
    """
    floats = np.empty(6 * Q.shape[1] + 110, np.complex128)
    m, K = len(chain.rows), Q.shape[1]
    G, W = floats[:24], floats[24 : 36 + 6 * K].reshape((K + 2, 6))
    A = floats[36 + 6 * K : 36 + 6 * K + m * (m + 2)].reshape((m, m + 2))
    for n in range(len(Q)):
        ends[n] = _follow(chain, way, Q[n], most, floats)
        if ends[n] != ARRIVED:
            continue
        target_at(way, 1.0, G)
        last = LONGEST
        for _ in range(MOST_POLISHING):
            linearise(chain, way, G, Q[n], W, G[12:], A)
            least = solve(A)
            if least < SINGULAR:
                ends[n] = BESIDE
                if least < NO_RANK:
                    break
            size = 0.0
            for c in range(m):
                size = max(size, abs(A[c, m].real) + abs(A[c, m].imag))
            # Beside where solutions meet the first steps may be long, and halve what is left.
            if not size < (0.9 * last if ends[n] == BESIDE else 2.0 * SETTLED):
                break
            last = size
            for c in range(m):
                Q[n, chain.unknowns[c]] += A[c, m]
            if size < POLISHED:
                break
