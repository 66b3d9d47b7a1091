"""A chain as lanes walk along it: modified D-H parameters, or placements where these do not do.

The placement between two joints is ``Rz(β) Tz(b) Tx(a) Rx(α) Rz(γ) Tz(c)`` (Craig, *Introduction to
Robotics*, 3.4). What is about and along z joins the motions of the joints before and after, so that
a step along the chain takes half of the products. The common normal of axes that are nearly
parallel is ill-conditioned, b and c grow without bound: such a placement stays as it is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots.robot import FloatArray

# Places in the row of a joint.
REVOLUTE = 0
"""Nonzero for an angle."""
QUARTERS = 1
"""Quarter turns that are added to an angle."""
ANGLE = 2
"""What else is added to an angle, rad; of a length, the angle that stays."""
LENGTH = 3
"""What is added to a length, m; of an angle, the length that stays."""
WHOLE = 4
"""Nonzero where twelve numbers of a placement follow, in place of a, and cosine and sine of α."""
A = 5
COSINE = 6
SINE = 7
WIDTH = 17
"""Numbers of a row."""

_PARALLEL = 1e-15
"""Axes with a smaller sine between them are parallel: what a rounded matrix cannot tell apart."""
_LEAST_SINE = 0.02
"""Axes with a smaller sine between them keep their placement."""
_ROUNDING = 4e-15
"""How far, relative, the parameters may be from the placement that they stand for."""


class _Parameters(NamedTuple):
    before: float
    along_before: float
    a: float
    cosine: float
    sine: float
    after: float
    along_after: float


def links_of(placements: FloatArray, is_revolute: NDArray[np.bool_]) -> FloatArray:
    """Return the constants of a chain for :func:`kinematics.lanes.walk.walk`, shape (K + 2, WIDTH).

    Args:
        placements: C_0 … C_K of :class:`kinematics.chain.Chain`, shape (K + 1, 12).
        is_revolute: Shape (K,).

    Returns:
        C_0 in the first twelve numbers of the first row, C_K in those of the last; between them a
        row for each joint.
    """
    K = len(is_revolute)
    links = np.zeros((K + 2, WIDTH))
    links[0, :12], links[K + 1, :12] = placements[0], placements[K]
    if K == 0:  # nothing moves: C_0 is all
        links[1, :12] = np.eye(4)[:3].reshape(12)
        return links
    angles = np.zeros(K)
    links[1 : K + 1, REVOLUTE] = is_revolute
    links[1 : K + 1, COSINE] = 1.0
    for k in range(1, K):
        row = links[k]
        found = _parameters(placements[k].reshape(3, 4))
        if found is None:
            row[WHOLE], row[A:] = 1.0, placements[k]
            continue
        angles[k - 1] += found.before
        angles[k] += found.after
        row[LENGTH] += found.along_before
        links[k + 1, LENGTH] += found.along_after
        row[A], row[COSINE], row[SINE] = found.a, found.cosine, found.sine
    quarters = np.round(angles / (math.pi / 2))
    rest = angles - quarters * (math.pi / 2)
    links[1 : K + 1, QUARTERS] = quarters
    links[1 : K + 1, ANGLE] = np.where(np.abs(rest) < 4e-16, 0.0, rest)
    return links


def _parameters(T: FloatArray) -> _Parameters | None:
    """Return the parameters of a placement, shape (3, 4); None where they are not as exact."""
    R, p = T[:, :3], T[:, 3]
    sine = math.hypot(R[0, 2], R[1, 2])
    if _PARALLEL < sine < _LEAST_SINE:
        return None
    is_parallel = sine <= _PARALLEL
    if is_parallel:  # the common normal is where the origins say
        before = math.atan2(p[1], p[0]) if p[0] or p[1] else 0.0
    else:
        before = math.atan2(R[0, 2], -R[1, 2])
    c, s = _exact(before)
    x, y = c * p[0] + s * p[1], c * p[1] - s * p[0]
    # Signed: what rounding has left of a half turn says which way it went.
    sine, cosine = s * R[0, 2] - c * R[1, 2], R[2, 2]
    after_along = 0.0 if is_parallel else -y / sine
    # What is left of R is a turn about z.
    first = c * R[0] + s * R[1]
    second = cosine * (c * R[1] - s * R[0]) + sine * R[2]
    after = math.atan2(second[0], first[0])
    found = _Parameters(before, p[2] - after_along * cosine, x, cosine, sine, after, after_along)
    off = np.abs(_placement(found) - T).max()
    return found if off <= _ROUNDING * (1.0 + np.abs(p).max()) else None


def _exact(angle: float) -> tuple[float, float]:
    """Return cosine and sine, exact for whole quarter turns."""
    quarters = round(angle / (math.pi / 2))
    rest = angle - quarters * (math.pi / 2)
    c, s = (1.0, 0.0) if abs(rest) < 4e-16 else (math.cos(rest), math.sin(rest))
    return ((c, s), (-s, c), (-c, -s), (s, -c))[quarters % 4]


def _placement(found: _Parameters) -> FloatArray:
    """Return the placement of parameters, shape (3, 4)."""
    (c, s), (u, v) = _exact(found.before), _exact(found.after)
    Rz = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    Rx = np.array(
        [[1.0, 0.0, 0.0], [0.0, found.cosine, -found.sine], [0.0, found.sine, found.cosine]]
    )
    Rw = np.array([[u, -v, 0.0], [v, u, 0.0], [0.0, 0.0, 1.0]])
    R = Rz @ Rx
    p = Rz @ [found.a, 0.0, found.along_before] + found.along_after * R[:, 2]
    return np.column_stack((R @ Rw, p))
