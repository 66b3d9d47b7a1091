"""A chain as the rows of a standard table, constructed without bridges, for a comparison."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from dh_to_urdf.extraction.arrangement import arrange
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.construction import Construction, construct
from dh_to_urdf.matrices import link_matrix
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow


@dataclass(frozen=True)
class StandardForm:
    """A chain in standard form.

    Attributes:
        construction: The frames and the rows between them.
        angles: True angles between successive directed axes, 0 to π, the tip's z last, rad.
        rows: The rows, standard convention.
    """

    construction: Construction
    angles: tuple[float, ...]
    rows: tuple[DHRow, ...]

    def leading_pose(self, q: Matrix) -> Matrix:
        """Multiply base, the rows before the last of q, and θ and d of that last one.

        Args:
            q: Joint values of the first rows, shape (k,), rad and m.

        Returns:
            Shape (4, 4).
        """
        T = self.construction.base
        for row, value in zip(self.rows, q, strict=False):
            cut = replace(row, a=0.0, alpha=0.0) if row is self.rows[len(q) - 1] else row
            T = T @ link_matrix(cut, Convention.STANDARD, value + row.offset)
        return T


def standard_form(chain: SerialChain, snap: float) -> StandardForm:
    """Construct the standard rows of a chain.

    Args:
        chain: The chain.
        snap: Axes tilted by less than this are taken as parallel, rad.
    """
    tip = chain.poses(np.zeros(len(chain.joints)))
    axes = chain.lines()
    lines = arrange(axes, tip, chain.size, snap, bridge=False, from_base=False)
    construction = construct(lines, tip, chain.size, last_at_tip=True)
    directions = [*(axis.direction for axis in axes), tip[:3, 2]]
    angles = tuple(
        math.atan2(float(np.linalg.norm(np.cross(u, v))), float(u @ v))
        for u, v in pairwise(directions)
    )
    return StandardForm(construction, angles, tuple(pair.row for pair in construction.pairs))


def with_fitting_senses(
    rows: tuple[DHRow, ...], others: tuple[DHRow, ...], size: float
) -> tuple[DHRow, ...]:
    """Turn each x of the other rows to the sense that fits the first rows better.

    Args:
        rows: The rows to fit to.
        others: The rows to turn.
        size: Length that differences of a are compared with, m.
    """
    fitted = list(others)
    for k, (row, other) in enumerate(zip(rows, others, strict=True)):
        here = abs(other.a - row.a) / size + abs(wrapped(other.alpha - row.alpha))
        there = abs(-other.a - row.a) / size + abs(wrapped(-other.alpha - row.alpha))
        if there < here - 1e-9:
            fitted[k] = _turned(replace(fitted[k], a=-other.a, alpha=-other.alpha), math.pi)
            if k + 1 < len(fitted):
                fitted[k + 1] = _turned(fitted[k + 1], -math.pi)
    return tuple(fitted)


def zero_offset(first: DHRow, second: DHRow) -> float:
    """Return what to add to q of the first row to get q of the second, rad or m."""
    offset = first.offset - second.offset
    return wrapped(offset) if first.type.is_revolute else offset


def wrapped(angle: float) -> float:
    """Return an angle within ±π, rad."""
    return math.remainder(angle, 2 * math.pi)


def _turned(row: DHRow, angle: float) -> DHRow:
    if row.type.is_revolute:
        return replace(row, offset=row.offset + angle)
    return replace(row, theta=row.theta + angle)
