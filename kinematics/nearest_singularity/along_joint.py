"""Singular values of one joint alone: all roots of the determinant at once.

Along one joint every entry of the Jacobian (base axes, at the frame) is ``a + b cos q + c sin q``,
for a prismatic joint ``a + b q``. So det J is a trigonometric (or plain) polynomial of at most the
degree of its size, and det J Jᵀ of twice that: samples determine it exactly, and all its roots at
once. Each root is then refined on the model, and kept only where the smallest singular value counts
as zero there. An entry of q that moves several joints, or one by a multiple, is sampled finely
instead, and minima of the smallest singular value are the candidates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from kinematics.derivatives import jacobian_derivative
from kinematics.nearest_singularity.search import Search
from robots.robot import FloatArray

SAMPLES = 64
FINEST = 2048
"""Most samples of an entry of q that moves several joints."""
MOST_CANDIDATES = 16
NEAR_ROOT = 1e-2
POLISHING_STEPS = 60
SLIDE_EXTENT = 10.0
"""Extents (of the chain's constants, m) that a prismatic joint without limits is searched in."""


@dataclass(frozen=True, eq=False)
class SingularAlongJoint:
    """Values of one joint, the others fixed, at which the arm is singular.

    Attributes:
        column: Entry of q.
        value: The nearest singular value within the limits, rad or m; None where there is none.
        distance: Its distance from q, rad or m.
        values: All singular values within the limits and a turn of q, ascending.
        singular_value: The smallest singular value of the task Jacobian at ``value``, measured.
    """

    column: int
    value: float | None
    distance: float | None
    values: tuple[float, ...]
    singular_value: float | None


def along_joint(search: Search, k: int) -> SingularAlongJoint:
    """Return the values of joint k of the chain alone at which the arm is singular."""
    column, is_revolute = int(search.chain.columns[k]), bool(search.chain.is_angle[k])
    periodic = bool(search.chain.is_periodic[k])
    here = float(search.q[column])
    low, high = float(search.chain.lower[k]), float(search.chain.upper[k])
    if is_revolute:
        low, high = max(low, here - 2 * np.pi), min(high, here + 2 * np.pi)
        if periodic and np.isinf([search.chain.lower[k], search.chain.upper[k]]).all():
            low, high = here - np.pi, here + np.pi
    else:
        size = SLIDE_EXTENT * max(1.0, float(np.abs(search.chain.placements[:, [3, 7, 11]]).max()))
        low = low if np.isfinite(low) else min(here, high) - size
        high = high if np.isfinite(high) else max(here, low) + size
    if not low <= high:
        return SingularAlongJoint(column, None, None, (), None)
    found: list[tuple[float, float]] = []
    alone = search.chain.coupling[:, k : k + 1] if search.chain.is_coupled else np.ones((1, 1))
    several = not np.array_equal(alone[alone != 0.0], [1.0])
    starts = (
        _sampled(search, column, is_revolute, low, high, float(np.abs(alone).sum()))
        if several
        else _candidates(search, column, is_revolute, low, high)
    )
    for start in starts:
        polished = _polished(search, column, start)
        if polished is None:
            continue
        value, sigma = polished
        turn = 2 * np.pi if periodic else np.inf
        first = int(np.ceil((low - 1e-9 - value) / turn)) if periodic else 0
        last = int(np.floor((high + 1e-9 - value) / turn)) if periodic else 0
        for count in range(first, last + 1):
            shifted = value + count * turn if count else value
            inside = min(max(shifted, low), high)
            if abs(inside - shifted) > 1e-9 or any(abs(inside - x) < 1e-7 for x, _ in found):
                continue
            if inside != value:
                x = search.q.copy()
                x[column] = inside
                sigma, zero = search.decomposed(x)[2:]
                if not zero:
                    continue
            found.append((inside, sigma))
    if not found:
        return SingularAlongJoint(column, None, None, (), None)
    value, sigma = min(found, key=lambda pair: abs(pair[0] - here))
    values = tuple(sorted(x for x, _ in found))
    return SingularAlongJoint(column, value, abs(value - here), values, sigma)


def _candidates(
    search: Search, column: int, is_revolute: bool, low: float, high: float
) -> list[float]:
    """Return roots of the determinant's polynomial and minima of its samples, the best first."""
    if is_revolute:
        grid = search.q[column] + 2 * np.pi * np.arange(SAMPLES) / SAMPLES
    else:
        nodes = np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)[::-1]
        grid = (low + high) / 2 + (high - low) / 2 * nodes
    batch = np.repeat(search.q[None], SAMPLES, axis=0)
    batch[:, column] = grid
    J = search.jacobians(batch)
    sigma = np.linalg.svd(J, compute_uv=False)
    r = sigma.shape[1]
    square = J.shape[1] == J.shape[2]
    values = np.linalg.det(J) if square else np.prod(sigma, axis=1) ** 2
    degree = r if square else 2 * r
    largest = np.abs(values).max()
    roots: list[float] = []
    if largest > 0:
        values = values / largest
        if is_revolute:
            roots = _turning_roots(values, degree, float(search.q[column]))
        else:
            middle, half = (low + high) / 2, (high - low) / 2
            roots = [middle + half * x for x in _sliding_roots(values, nodes, degree)]
    smallest = sigma[:, -1]
    before, after = np.roll(smallest, 1), np.roll(smallest, -1)
    if not is_revolute:
        before[0] = after[-1] = np.inf
    minima = np.flatnonzero((smallest <= before) & (smallest <= after))
    minima = minima[np.argsort(smallest[minima])]
    return [*roots[:MOST_CANDIDATES], *grid[minima[: MOST_CANDIDATES // 2]].tolist()]


def _sampled(
    search: Search, column: int, is_revolute: bool, low: float, high: float, speed: float
) -> list[float]:
    """Return the minima of the smallest singular value over samples of the whole range."""
    turns = (high - low) * speed / (2 * np.pi) if is_revolute else speed
    count = int(np.clip(SAMPLES * max(1.0, turns), SAMPLES, FINEST))
    grid = np.linspace(low, high, count)
    batch = np.repeat(search.q[None], count, axis=0)
    batch[:, column] = grid
    smallest = np.linalg.svd(search.jacobians(batch), compute_uv=False)[:, -1]
    before = np.append(np.inf, smallest[:-1])
    after = np.append(smallest[1:], np.inf)
    minima = np.flatnonzero((smallest <= before) & (smallest <= after))
    minima = minima[np.argsort(smallest[minima])]
    return [float(x) for x in grid[minima[: 4 * MOST_CANDIDATES]]]


def _turning_roots(values: FloatArray, degree: int, start: float) -> list[float]:
    coefficients = np.fft.fft(values) / len(values)
    ordered = np.concatenate((coefficients[-degree:], coefficients[: degree + 1]))
    kept = np.flatnonzero(np.abs(ordered) > 1e-13)
    if not kept.size:
        return []
    z = np.roots(ordered[kept[0] : kept[-1] + 1][::-1])
    z = z[np.abs(np.abs(z) - 1.0) < NEAR_ROOT]
    z = z[np.argsort(np.abs(np.abs(z) - 1.0))]
    return [start + float(x) for x in np.angle(z)]


def _sliding_roots(values: FloatArray, nodes: FloatArray, degree: int) -> list[float]:
    series = chebyshev.chebfit(nodes, values, degree)
    kept = np.flatnonzero(np.abs(series) > 1e-13)
    if not kept.size or kept[-1] == 0:
        return []
    x = chebyshev.chebroots(series[: kept[-1] + 1])
    x = x[(np.abs(x.imag) < NEAR_ROOT) & (np.abs(x.real) < 1 + NEAR_ROOT)]
    return [float(min(max(one.real, -1.0), 1.0)) for one in x]


def _polished(search: Search, column: int, start: float) -> tuple[float, float] | None:
    """Refine a root by Newton's method on the smallest singular value; None if it stays above."""
    x, direction = search.q.copy(), np.zeros(search.robot.dof)
    x[column], direction[column] = start, 1.0
    best: tuple[float, float] | None = None
    before = np.inf
    for count in range(POLISHING_STEPS):
        U, V, sigma, zero = search.decomposed(x)
        # At a double root each step divides it by four; if it falls slower, it does not vanish.
        if count > 4 and sigma > 0.7 * before:
            break
        before = sigma
        if zero and (best is None or sigma < best[1]):
            best = float(x[column]), sigma
        elif best is not None:
            break
        change = jacobian_derivative(search.robot, x, direction, search.frame, search.axes)
        slope = U.T @ change[search.rows][:, search.chain.columns] @ V
        square = float((slope * slope).sum())
        if sigma == 0.0 or square <= 1e-24:
            break
        # Only the first entry of Uᵀ J V is not zero, and it is sigma.
        step = -sigma * float(slope[0, 0]) / square
        if abs(step) <= 1e-16 * max(1.0, abs(x[column])):
            break
        x[column] += min(max(step, -0.2), 0.2)
    return best
