"""The nearest singular configuration: along each joint alone, and in joint space.

Along one joint every entry of the Jacobian (base axes, at the frame) is ``a + b cos q + c sin q``,
for a sliding joint ``a + b q``. So det J is a trigonometric (or plain) polynomial of at most the
degree of its size, and det J Jᵀ of twice that: samples give it exactly, and all its roots at once.
Each root is then polished on the model, and only kept where the smallest singular value counts as
zero there.

In joint space the nearest point of ``σ_min(q) = 0`` is sought by projection on its linearisation,
with ``∂σ/∂q_k = uᵀ ∂J/∂q_k v``, within the limits, from q and from what single joints reached. It
is a local minimum of the distance; another one may be nearer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from kinematics.chain import Chain, chain_of
from kinematics.configuration import configuration
from kinematics.derivatives import hessian, jacobian_derivative
from kinematics.errors import WrongConfiguration
from kinematics.jacobian import jacobian
from kinematics.singularity import RANK_TOLERANCE, rank_of
from kinematics.task import POSE, Task
from kinematics.velocity import check_options
from robots.robot import FloatArray, Robot

SAMPLES = 64
MOST_CANDIDATES = 16
NEAR_ROOT = 1e-2
POLISHING_STEPS = 60
PROJECTION_STEPS = 60
STARTS = 4
LARGEST_VALUE = 1e5
SLIDE_EXTENT = 10.0
"""Extents (of the chain's constants, m) within which a slide without limits is searched."""


@dataclass(frozen=True, eq=False)
class SingularAlongJoint:
    """Where one joint alone makes the arm singular.

    Attributes:
        column: Entry of q.
        value: The nearest singular value within the limits, rad or m; None where there is none.
        distance: How far that is from q, rad or m.
        values: All singular values within the limits and a turn of q, ascending.
        singular_value: The smallest singular value of the task Jacobian at ``value``, measured.
    """

    column: int
    value: float | None
    distance: float | None
    values: tuple[float, ...]
    singular_value: float | None


@dataclass(frozen=True, eq=False)
class NearestSingularity:
    """What is near a q.

    Attributes:
        singular: Whether q itself is singular; then it is the answer everywhere.
        joints: For each joint between base and frame.
        q: The nearest singular configuration found within the limits, shape (dof,); None: none.
        distance: Its Euclidean distance from q, in rad and m.
        singular_value: The smallest singular value there, measured.
    """

    singular: bool
    joints: tuple[SingularAlongJoint, ...]
    q: FloatArray | None
    distance: float | None
    singular_value: float | None


@dataclass(frozen=True, eq=False)
class _Search:
    robot: Robot
    chain: Chain
    frame: str
    rows: list[int]
    q: FloatArray
    tolerance: float

    def jacobians(self, q: FloatArray) -> FloatArray:
        """Task Jacobians over the chain's columns, shape (n, m, K)."""
        return jacobian(self.robot, q, self.frame)[:, self.rows][:, :, self.chain.columns]

    def decomposed(self, q: FloatArray) -> tuple[FloatArray, FloatArray, float, bool]:
        """Singular vectors to the smallest singular value, it itself, and if it counts as zero."""
        U, sigma, Vt = np.linalg.svd(self.jacobians(q[None])[0])
        r = len(sigma)
        zero = bool(rank_of(sigma, self.tolerance) < r)
        return U[:, r - 1 :], Vt[r - 1 :].T, float(sigma[-1]), zero


def nearest_singularity(
    robot: Robot,
    q: FloatArray,
    task: Task = POSE,
    frame: str | None = None,
    *,
    tolerance: float = RANK_TOLERANCE,
) -> NearestSingularity:
    """Seeks singular configurations near a q.

    Args:
        robot: The robot.
        q: Shape (dof,), rad and m; it may be outside the limits, the results are not.
        task: The task space, in base axes.
        frame: Frame name; default the tip.
        tolerance: A singular value below ``tolerance * max(1, largest)`` counts as zero.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape, is not finite or beyond ±1e5.
        InvalidOption: tolerance out of range.
    """
    check_options(0.0, tolerance)
    frame = frame or robot.tip_frame
    chain = chain_of(robot, frame)
    q = configuration(robot, q)
    if q.ndim != 1:
        raise WrongConfiguration("q is a batch; give one q", "/q")
    if not np.abs(q).max() <= LARGEST_VALUE:
        joint = robot.joints[int(np.argmax(np.abs(q)))].name
        raise WrongConfiguration(
            f"q of joint {joint} is beyond ±1e5, where no singularities are sought; give its value"
            " within a turn",
            "/q",
        )
    if chain.length == 0:
        return NearestSingularity(True, (), q, 0.0, 0.0)
    search = _Search(robot, chain, frame, list(task.rows), q, tolerance)
    sigma, singular = search.decomposed(q)[2:]
    if singular:
        here = tuple(
            SingularAlongJoint(int(k), float(q[k]), 0.0, (float(q[k]),), sigma)
            for k in chain.columns
        )
        return NearestSingularity(True, here, q, 0.0, sigma)
    joints = tuple(_along(search, k) for k in range(chain.length))
    return _in_joint_space(search, joints)


def _along(search: _Search, k: int) -> SingularAlongJoint:
    column, turns = int(search.chain.columns[k]), bool(search.chain.turns[k])
    here = float(search.q[column])
    low, high = float(search.chain.lower[k]), float(search.chain.upper[k])
    if turns:
        low, high = max(low, here - 2 * np.pi), min(high, here + 2 * np.pi)
        if np.isinf([search.chain.lower[k], search.chain.upper[k]]).all():
            low, high = here - np.pi, here + np.pi
    else:
        size = SLIDE_EXTENT * max(1.0, float(np.abs(search.chain.placements[:, [3, 7, 11]]).max()))
        low = low if np.isfinite(low) else min(here, high) - size
        high = high if np.isfinite(high) else max(here, low) + size
    if not low <= high:
        return SingularAlongJoint(column, None, None, (), None)
    found: list[tuple[float, float]] = []
    for start in _candidates(search, column, turns, low, high):
        polished = _polished(search, column, start)
        if polished is None:
            continue
        value, sigma = polished
        turn = 2 * np.pi if turns else np.inf
        first = int(np.ceil((low - 1e-9 - value) / turn)) if turns else 0
        last = int(np.floor((high + 1e-9 - value) / turn)) if turns else 0
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


def _candidates(search: _Search, column: int, turns: bool, low: float, high: float) -> list[float]:
    """Where the determinant's polynomial has roots, or its samples a minimum; best first."""
    if turns:
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
        if turns:
            roots = _turning_roots(values, degree, float(search.q[column]))
        else:
            middle, half = (low + high) / 2, (high - low) / 2
            roots = [middle + half * x for x in _sliding_roots(values, nodes, degree)]
    smallest = sigma[:, -1]
    before, after = np.roll(smallest, 1), np.roll(smallest, -1)
    if not turns:
        before[0] = after[-1] = np.inf
    minima = np.flatnonzero((smallest <= before) & (smallest <= after))
    minima = minima[np.argsort(smallest[minima])]
    return [*roots[:MOST_CANDIDATES], *grid[minima[: MOST_CANDIDATES // 2]].tolist()]


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


def _polished(search: _Search, column: int, start: float) -> tuple[float, float] | None:
    """Newton's method on the smallest singular value along one joint; None where it stays."""
    x, direction = search.q.copy(), np.zeros(search.robot.dof)
    x[column], direction[column] = start, 1.0
    best: tuple[float, float] | None = None
    before = np.inf
    for count in range(POLISHING_STEPS):
        U, V, sigma, zero = search.decomposed(x)
        # At a double root the steps still quarter it; elsewhere it does not vanish.
        if count > 4 and sigma > 0.7 * before:
            break
        before = sigma
        if zero and (best is None or sigma < best[1]):
            best = float(x[column]), sigma
        elif best is not None:
            break
        change = jacobian_derivative(search.robot, x, direction, search.frame)
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


def _in_joint_space(search: _Search, joints: tuple[SingularAlongJoint, ...]) -> NearestSingularity:
    along: list[tuple[float, float, FloatArray]] = []
    for one in joints:
        if one.value is not None and one.distance is not None and one.singular_value is not None:
            x = search.q.copy()
            x[one.column] = one.value
            along.append((one.distance, one.singular_value, x))
    along.sort(key=lambda item: item[0])
    # A single joint leaves the others alone, so they must be within their limits already.
    lower, upper = search.robot.lower, search.robot.upper
    found = [item for item in along if np.all((item[2] >= lower) & (item[2] <= upper))]
    for start in [search.q, *(x for _, _, x in along[:STARTS])]:
        projected = _projected(search, start)
        if projected is not None:
            found.append(projected)
    if not found:
        return NearestSingularity(False, joints, None, None, None)
    distance, sigma, x = min(found, key=lambda item: item[0])
    return NearestSingularity(False, joints, x, distance, sigma)


def _projected(search: _Search, start: FloatArray) -> tuple[float, float, FloatArray] | None:
    """The point of the singular set nearest to q, as far as projections from a start lead."""
    columns = search.chain.columns
    x = np.clip(start, search.robot.lower, search.robot.upper)
    best: tuple[float, float, FloatArray] | None = None
    for _ in range(PROJECTION_STEPS):
        U, V, sigma, zero = search.decomposed(x)
        if zero:
            distance = float(np.linalg.norm(x - search.q))
            if best is not None and distance >= best[0] - 1e-12:
                if sigma < best[1] and distance <= best[0] + 1e-9:
                    best = distance, sigma, x
                break
            best = distance, sigma, x
        H = hessian(search.robot, x, search.frame)[search.rows][:, columns][:, :, columns]
        G = np.einsum("ma,mjk,jb->abk", U, H, V).reshape(-1, len(columns))
        wanted = np.zeros(len(G))
        wanted[0] = -sigma
        step = _nearest_within(search, G, wanted, x) - x[columns]
        length = float(np.linalg.norm(step))
        if not length > 1e-15:
            break
        x = x.copy()
        x[columns] += step * min(1.0, 0.3 / length)
    return best


def _nearest_within(
    search: _Search, G: FloatArray, wanted: FloatArray, x: FloatArray
) -> FloatArray:
    """Of the points y with ``G (y - x) = wanted`` within the limits, the one nearest to q."""
    columns = search.chain.columns
    lower, upper = search.chain.lower, search.chain.upper
    here = x[columns]
    y = np.clip(search.q[columns], lower, upper)
    free = np.ones(len(columns), dtype=bool)
    for _ in range(len(columns)):
        rest = wanted - G @ (y - here)
        change = np.linalg.pinv(G[:, free], rcond=1e-9) @ rest
        y[free] += change
        outside = free & ((y < lower) | (y > upper))
        y = np.clip(y, lower, upper)
        if not outside.any():
            break
        free &= ~outside
        if not free.any():
            break
        y[free] = search.q[columns][free]
    return np.asarray(np.clip(y, lower, upper))
