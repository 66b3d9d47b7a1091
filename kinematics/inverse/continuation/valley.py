"""Real solutions along a valley: where the Jacobian has nearly lost rank along a whole curve.

An arm whose axes are parallel or meet but for rounding has targets to which a whole curve of
configurations comes within a hair. Newton's method does not move along it; here five of six
equations are held, and the zeros of what is left, a function of one variable, are looked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from kinematics.deadline import checkpoint
from kinematics.inverse.continuation.settling import error_and_columns
from kinematics.inverse.task_error import TaskChain
from kinematics.inverse.windings import on_circle
from robots.robot import FloatArray

NARROW = 1e-3
"""Part of the largest singular value below which a direction is along a valley."""
STEP = 0.03
STEPS = 210
"""Steps each way, about one turn together."""
CORRECTIONS = 8
HELD = 1e-13
"""Error that is held, m or rad."""
FLAT = 1e-12
"""What is left along a curve of solutions: there are no zeros that stand alone."""


@dataclass(frozen=True, eq=False)
class _Point:
    q: FloatArray
    along: FloatArray
    across: FloatArray
    left: float
    is_narrow: bool


@dataclass(frozen=True, eq=False)
class Valley:
    """A valley that was gone along.

    Attributes:
        points: Joint values along it, shape (N, K).
        zeros: Solutions in it, right but for rounding; none where all of it is one.
    """

    points: FloatArray
    zeros: tuple[FloatArray, ...]

    def holds(self, q: FloatArray, is_revolute: NDArray[np.bool_]) -> bool:
        """Return whether q is on it or next to it."""
        return bool(np.abs(on_circle(self.points - q, is_revolute)).max(axis=1).min() < STEP)


def valley_through(chain: TaskChain, target: FloatArray, q: FloatArray) -> Valley | None:
    """Return the valley through q with its zeros.

    Args:
        chain: The arm and the task, as many joints as rows.
        target: Pose in the base's axes, shape (4, 4).
        q: In the valley or beside it, shape (K,).

    Returns:
        None where q is in no valley; one joint alone has none, as no other direction is wide.
    """
    if len(q) < 2:
        return None
    start = _held(chain, target, q, None)
    if start is None or not start.is_narrow:
        return None
    found: list[FloatArray] = []
    seen: list[FloatArray] = []
    for way in (STEP, -STEP):
        points = list(_walk(chain, target, start, way))
        seen += [point.q for point in points]
        if max(abs(point.left) for point in points) < FLAT:
            continue
        for one, other in pairwise(points):
            if one.left * other.left <= 0.0:
                found += _zero(chain, target, one, way)
        found += _touching(points)
    return Valley(np.array(seen), tuple(found))


def _walk(chain: TaskChain, target: FloatArray, start: _Point, way: float) -> Iterator[_Point]:
    point = start
    yield point
    for _ in range(STEPS):
        checkpoint()
        ahead = _held(chain, target, point.q + way * point.along, point)
        if ahead is None or not ahead.is_narrow:
            return
        yield ahead
        point = ahead


def _touching(points: list[_Point]) -> list[FloatArray]:
    """Return points where what is left comes near to zero and turns back."""
    left = np.abs([point.left for point in points])
    return [
        points[k].q
        for k in range(1, len(points) - 1)
        if left[k] <= left[k - 1] and left[k] <= left[k + 1] and left[k] < 1e-2 * left.max()
    ]


def _zero(chain: TaskChain, target: FloatArray, point: _Point, way: float) -> list[FloatArray]:
    def left(part: float) -> float:
        there = _held(chain, target, point.q + part * way * point.along, point)
        return np.nan if there is None else there.left

    at = _bracketed(left)
    there = None if at is None else _held(chain, target, point.q + at * way * point.along, point)
    return [] if there is None else [there.q]


def _bracketed(function: Callable[[float], float]) -> float | None:
    ends = function(0.0), function(1.0)
    if not ends[0] * ends[1] <= 0.0:
        return None
    return float(brentq(function, 0.0, 1.0, xtol=1e-12))


def _held(
    chain: TaskChain, target: FloatArray, q: FloatArray, before: _Point | None
) -> _Point | None:
    """Return the point of the valley across from q; None where it is not reached."""
    q = q.copy()
    K = len(q)
    for _ in range(CORRECTIONS):
        error, J = np.empty(6), np.empty((K, 6))
        error_and_columns(chain, target, q, error, J)
        u, sigma, v = np.linalg.svd(J.T)
        parts = u.T @ error
        step = v[: K - 1].T @ (parts[: K - 1] / sigma[: K - 1])
        if not np.isfinite(step).all() or np.abs(step).max() > 1.0:
            return None
        if np.abs(parts[: K - 1]).max() < HELD:
            break
        q += step
    else:
        if np.abs(parts[: K - 1]).max() > 1e3 * HELD:
            return None
    along, across = v[K - 1], u[:, K - 1]
    if before is not None:
        along = along * np.copysign(1.0, along @ before.along)
        across = across * np.copysign(1.0, across @ before.across)
    narrow = sigma[K - 1] < NARROW * sigma[0] and sigma[K - 2] > NARROW * sigma[0]
    return _Point(q, along, across, float(across @ error), bool(narrow))
