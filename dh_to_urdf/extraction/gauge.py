"""Parameters of a table that can change without a change of the arm, fixed for a comparison.

The zero of a prismatic joint is free, and so are the points of the lines before it; along parallel
axes only the sum of the d is determined, along coincident ones only the sum of the θ. To compare
two arms, these are chosen in the same way for both.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from dh_to_urdf.extraction.arrangement import arrange
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.construction import Construction
from dh_to_urdf.extraction.normals import Case
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import DHRow, JointType

REACH = 1e-3
"""Part of a prismatic axis across the axis before, below which the two count as parallel."""


def with_slides_centred(chain: SerialChain, snap: float) -> tuple[SerialChain, Matrix]:
    """Shift the zeros of prismatic joints so that origins are nearest to the axes before.

    Prismatic joints before the first revolute one keep their zeros: no axis is before them.

    Args:
        chain: The chain.
        snap: Axes tilted by less than this count as parallel, rad.

    Returns:
        The chain, and what was added to each q, shape (n,).
    """
    moved = np.zeros(len(chain.joints))
    for start, end in reversed(_runs(chain)):
        tip = chain.poses(np.zeros(len(chain.joints)))
        axes = chain.lines()
        lines = arrange(axes, tip, chain.size, snap, bridge=False, from_base=False).lines
        before = lines[start - 1]
        across = np.eye(3) - np.outer(before.direction, before.direction)
        slides = np.array([line.direction for line in axes[start:end]]).T
        U, reach, Vt = np.linalg.svd(across @ slides, full_matrices=False)
        inverse = np.where(reach > REACH, 1.0 / np.maximum(reach, REACH), 0.0)
        apart = across @ (lines[end - 1].point - before.point)
        shift = -Vt.T @ (inverse * (U.T @ apart))
        joints = list(chain.joints)
        for k, value in zip(range(start, end), shift, strict=True):
            placement = joints[k].placement.copy()
            placement[:3, 3] += placement[:3, :3] @ (value * joints[k].axis)
            joints[k] = replace(joints[k], placement=placement)
            moved[k] += value
        chain = replace(chain, joints=tuple(joints))
    return chain, moved


def _runs(chain: SerialChain) -> list[tuple[int, int]]:
    """Return runs of prismatic joints as ranges, each behind a revolute joint."""
    found: list[tuple[int, int]] = []
    k, joints = 0, chain.joints
    while k < len(joints):
        end = k
        while end < len(joints) and joints[end].type is JointType.PRISMATIC:
            end += 1
        if end > k > 0:
            found.append((k, end))
        k = max(end, k + 1)
    return found


def settled(
    made: Construction, rows: tuple[DHRow, ...], others: tuple[DHRow, ...]
) -> tuple[DHRow, ...]:
    """Distribute d and θ along common directions in the other rows as in the first rows.

    Args:
        made: The construction of the first rows; it says which axes are parallel.
        rows: The first rows.
        others: Rows of another chain; theirs is the same motion before and after.
    """
    parallel = [pair.normal.case.is_parallel for pair in made.pairs]
    coincident = [pair.normal.case is Case.COINCIDENT for pair in made.pairs]
    fitted = _share(rows, others, parallel, "d", lambda row: not row.type.is_revolute)
    return _share(rows, fitted, coincident, "theta", lambda row: row.type.is_revolute)


def _share(
    rows: tuple[DHRow, ...],
    others: tuple[DHRow, ...],
    linked: list[bool],
    column: str,
    takes: Callable[[DHRow], bool],
) -> tuple[DHRow, ...]:
    """Move the constants of a column in linked rows into the offset of a joint that moves so."""
    fitted = list(others)
    start = 0
    while start < len(rows):
        end = start
        while end < len(rows) - 1 and linked[end] and _is_parallel(fitted[end]):
            end += 1
        group = range(start, end + 1)
        start = end + 1
        taker = next((k for k in group if takes(rows[k])), None)
        if taker is None:
            continue
        for k in group:
            if takes(rows[k]):
                continue
            excess = getattr(fitted[k], column) - getattr(rows[k], column)
            turned = sum(abs(fitted[i].alpha) > 1.0 for i in range(min(k, taker), max(k, taker)))
            fitted[k] = replace(fitted[k], **{column: getattr(rows[k], column)})
            offset = fitted[taker].offset + (-excess if turned % 2 else excess)
            fitted[taker] = replace(fitted[taker], offset=offset)
    return tuple(fitted)


def _is_parallel(row: DHRow) -> bool:
    return min(abs(row.alpha), abs(abs(row.alpha) - math.pi)) <= 1e-12
