"""Nearest singular configuration in joint space, by projections.

The point of ``σ_min(q) = 0`` nearest to q is searched by projection on the linearisation, with
``∂σ/∂q_k = uᵀ ∂J/∂q_k v``, within the limits, starting from q and from the singular values of
single joints. It is a local minimum of the distance; another one may be nearer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.derivatives import hessian
from kinematics.nearest_singularity.along_joint import SingularAlongJoint
from kinematics.nearest_singularity.search import Search
from robots.robot import FloatArray

PROJECTION_STEPS = 60
STARTS = 4


@dataclass(frozen=True, eq=False)
class Found:
    """A singular configuration.

    Attributes:
        distance: Euclidean, from q, in rad and m.
        singular_value: The smallest one there, measured.
        q: Shape (dof,).
    """

    distance: float
    singular_value: float
    q: FloatArray


def in_joint_space(search: Search, joints: tuple[SingularAlongJoint, ...]) -> Found | None:
    """Return the nearest singular configuration found, at most as far as along one joint."""
    along: list[Found] = []
    for one in joints:
        if one.value is not None and one.distance is not None and one.singular_value is not None:
            x = search.q.copy()
            x[one.column] = one.value
            along.append(Found(one.distance, one.singular_value, x))
    along.sort(key=lambda item: item.distance)
    # A single joint leaves the others alone, so they must be within their limits already.
    lower, upper = search.robot.lower, search.robot.upper
    found = [item for item in along if np.all((item.q >= lower) & (item.q <= upper))]
    for start in [search.q, *(item.q for item in along[:STARTS])]:
        projected = _projected(search, start)
        if projected is not None:
            found.append(projected)
    return min(found, key=lambda item: item.distance, default=None)


def _projected(search: Search, start: FloatArray) -> Found | None:
    """Return the point of the singular set nearest to q that projections from a start lead to."""
    columns = search.chain.columns
    x = np.clip(start, search.robot.lower, search.robot.upper)
    best: Found | None = None
    for _ in range(PROJECTION_STEPS):
        U, V, sigma, zero = search.decomposed(x)
        if zero:
            distance = float(np.linalg.norm(x - search.q))
            if best is not None and distance >= best.distance - 1e-12:
                if sigma < best.singular_value and distance <= best.distance + 1e-9:
                    best = Found(distance, sigma, x)
                break
            best = Found(distance, sigma, x)
        H = hessian(search.robot, x, search.frame, search.axes)
        H = H[search.rows][:, columns][:, :, columns]
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


def _nearest_within(search: Search, G: FloatArray, wanted: FloatArray, x: FloatArray) -> FloatArray:
    """Return the point nearest to q of the y with ``G (y - x) = wanted`` within the limits."""
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
