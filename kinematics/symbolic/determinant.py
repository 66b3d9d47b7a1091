"""Factors of det J, in the frame and at the point where J is sparsest.

The determinant of the full Jacobian is the same in every frame and at every point, and does not
change when a column is subtracted from another. The columns of parallel axes are subtracted
from each other, J is written in the frame and at the origin with the most zeros, and its block
triangular form (Dulmage and Mendelsohn) gives the factors: at the centre of a spherical wrist,
that of the arm and that of the wrist.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

from dh_to_urdf.messages import say
from kinematics.symbolic.chain import Axis, Chain
from kinematics.symbolic.jacobian import Column, column
from kinematics.symbolic.names import Names
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial, TooManyTerms
from kinematics.symbolic.steps import Pose
from kinematics.symbolic.trigonometry import combined, reduced

MAX_ENTRY = 400
"""Number of terms of an entry of J above which a frame is not considered."""


@dataclass(frozen=True)
class Sparse:
    """A square Jacobian in its sparsest form.

    Attributes:
        axes: Name of the frame in whose axes it is written.
        point: Name of the frame at whose origin the linear velocity is taken.
        rows: Which of vx, vy, vz, wx, wy, wz, as indices.
        matrix: Square, by rows.
        joints: Numbers of the joints, one a column.
    """

    axes: str
    point: str
    rows: tuple[int, ...]
    matrix: tuple[tuple[Polynomial, ...], ...]
    joints: tuple[int, ...]


class Views:
    """J of a chain in the axes of all frames and at the origins of all."""

    def __init__(self, chain: Chain, rows: Sequence[int]) -> None:
        """Compute the poses.

        Args:
            chain: From the base to the frame whose Jacobian is meant.
            rows: Rows of the task, of vx, vy, vz, wx, wy, wz.
        """
        self.chain = chain
        self.rows = tuple(rows)
        self._poses = _kept_poses(chain, self.rows)
        self._columns: dict[tuple[int, int, int], Column | None] = {}
        self._differences: dict[tuple[int, int, int, int], Column | None] = {}

    def sparsest(self, joints: Sequence[int]) -> Sparse:
        """Return the square Jacobian of these joints in the frame and point where it is sparsest.

        Args:
            joints: Numbers of the joints, as many as rows.

        Raises:
            TooManyTerms: It exceeds the limits in every frame.
        """
        used = [axis for axis in self.chain.axes if axis.joint in joints]
        numbers = tuple(axis.joint for axis in used)
        best: tuple[tuple[int, int], Sparse] | None = None
        for axes, poses in self._poses.items():
            for point in _points(self.chain, poses, self.rows):
                columns = self._square(axes, point, used)
                if columns is None:
                    continue
                matrix = tuple(tuple(column[i] for column in columns) for i in self.rows)
                score = _cost(matrix)
                if best is None or score < best[0]:
                    where = self.chain.frames[axes], self.chain.frames[point]
                    best = score, Sparse(*where, self.rows, matrix, numbers)
        if best is None:
            raise TooManyTerms(say("the Jacobian has too many terms in every frame"))
        return best[1]

    def _square(self, axes: int, point: int, used: Sequence[Axis]) -> list[Column] | None:
        """Return columns of J, parallel axes as differences; None where they are too large."""
        columns = []
        for k, axis in enumerate(used):
            following = used[k + 1] if k + 1 < len(used) else None
            found = self._difference(axes, point, axis, following)
            if found is None:
                return None
            columns.append(found)
        return columns

    def _difference(
        self, axes: int, point: int, axis: Axis, following: Axis | None
    ) -> Column | None:
        one = self._column(axes, point, axis)
        if one is None or following is None or not (axis.is_revolute and following.is_revolute):
            return one
        key = (axes, point, axis.joint, following.joint)
        if key not in self._differences:
            other = self._column(axes, point, following)
            sign = _parallel(one, other) if other is not None else 0
            found: Column | None = one
            if other is not None and sign:
                moved = (a - b.scaled(sign) for a, b in zip(one, other, strict=True))
                found = _tidy(moved, self.chain.names)
            self._differences[key] = found
        return self._differences[key]

    def _column(self, axes: int, point: int, axis: Axis) -> Column | None:
        key = (axes, point, axis.joint)
        if key not in self._columns:
            poses = self._poses[axes]
            try:
                plain = column(axis, poses, poses[point].origin)
            except TooManyTerms:
                self._columns[key] = None
            else:
                self._columns[key] = _tidy(plain, self.chain.names)
        return self._columns[key]


def determinant(sparse: Sparse, names: Names) -> list[Polynomial]:
    """Return the factors of the determinant, the sign in the first; ``[0]`` if identically zero.

    Raises:
        TooManyTerms: A block exceeds the limits.
    """
    blocks = _blocks(sparse.matrix)
    if blocks is None:
        return [ZERO]
    order_rows = [i for rows, _ in blocks for i in rows]
    order_columns = [j for _, columns in blocks for j in columns]
    factors = [Polynomial.constant(_parity(order_rows) * _parity(order_columns))]
    for rows, columns in blocks:
        block = [[sparse.matrix[i][j] for j in columns] for i in rows]
        factors.append(combined(expansion(block, names), names))
    return factors


def _kept_poses(chain: Chain, rows: Sequence[int]) -> dict[int, list[Pose]]:
    """Return poses in each frame whose axes keep the task's rows, the middle ones first."""
    found = {}
    middle = (len(chain.frames) - 1) / 2
    for axes in sorted(range(len(chain.frames)), key=lambda k: (abs(k - middle), k)):
        try:
            poses = chain.poses(axes)
        except TooManyTerms:
            continue
        if _keeps(poses[0], rows):
            found[axes] = poses
    return found


def _keeps(base: Pose, rows: Sequence[int]) -> bool:
    """Return whether rotating from the base's axes mixes rows of the task only with each other.

    Then the determinant changes by the factor of an orthogonal matrix, ±1.
    """
    linear, angular = {i for i in rows if i < 3}, {i - 3 for i in rows if i >= 3}
    return all(
        not base.axes[j][i]
        for part in (linear, angular)
        for i in range(3)
        for j in range(3)
        if (i in part) != (j in part)
    )


def _points(chain: Chain, poses: list[Pose], rows: Sequence[int]) -> list[int]:
    """Return frames with different origins; only the tip where the task lacks rows to move it."""
    angular = [i for i in range(3, 6) if i not in rows]
    turning = [poses[axis.node].axes[2] for axis in chain.axes if axis.is_revolute]
    linear = {i for i in rows if i < 3}
    if any(z[i - 3] for z in turning for i in angular if linear != {i - 3}):
        return [len(poses) - 1]
    found: list[int] = []
    for k in reversed(range(len(poses))):
        if all(poses[k].origin != poses[other].origin for other in found):
            found.append(k)
    return found


def _parallel(one: Column, other: Column) -> int:
    """Return 1 or -1 for axes with the same or the opposite direction, else 0."""
    for sign in (1, -1):
        if all(a == b.scaled(sign) for a, b in zip(one[3:], other[3:], strict=True)):
            return sign
    return 0


def _tidy(entries: Iterable[Polynomial], names: Names) -> Column | None:
    found = []
    for p in entries:
        if len(p) > MAX_ENTRY:
            return None
        found.append(combined(reduced(p, names), names))
    return tuple(found)


def _cost(matrix: Sequence[Sequence[Polynomial]]) -> tuple[int, int]:
    """Return the approximate cost of expanding the blocks, and the number of terms."""
    terms = sum(len(entry) for row in matrix for entry in row)
    blocks = _blocks(matrix)
    if blocks is None:
        return 0, terms
    cost = 0
    for rows, columns in blocks:
        product = 1
        for i in rows:
            product *= max(1, sum(len(matrix[i][j]) for j in columns))
        cost += product
    return cost, terms


def _blocks(
    matrix: Sequence[Sequence[Polynomial]],
) -> list[tuple[tuple[int, ...], tuple[int, ...]]] | None:
    """Return diagonal blocks of the block triangular form; None if no diagonal can be full.

    The rows of a block are matched with its columns; the blocks are the strong components of the
    graph from a column to the columns matched with its rows.
    """
    size = len(matrix)
    match: dict[int, int] = {}

    def place(i: int, seen: set[int]) -> bool:
        for j in range(size):
            if matrix[i][j] and j not in seen:
                seen.add(j)
                if j not in match or place(match[j], seen):
                    match[j] = i
                    return True
        return False

    if not all(place(i, set()) for i in range(size)):
        return None
    row_of = match
    follows = {j: {k for k in range(size) if matrix[row_of[j]][k]} for j in range(size)}
    reach = {j: _reachable(j, follows) for j in range(size)}
    left, blocks = set(range(size)), []
    while left:
        # A block on which no remaining block depends comes first.
        first = min(left, key=lambda j: (len(reach[j] & left), j))
        block = tuple(sorted(k for k in reach[first] & left if first in reach[k]))
        blocks.append((tuple(sorted(row_of[j] for j in block)), block))
        left -= set(block)
    return blocks


def _reachable(start: int, follows: dict[int, set[int]]) -> set[int]:
    found, todo = {start}, [start]
    while todo:
        for k in follows[todo.pop()] - found:
            found.add(k)
            todo.append(k)
    return found


def expansion(block: Sequence[Sequence[Polynomial]], names: Names) -> Polynomial:
    """Return a determinant by Laplace's expansion; each minor of the last rows once."""
    size = len(block)

    @cache
    def minor(row: int, columns: tuple[int, ...]) -> Polynomial:
        if row == size:
            return ONE
        result = ZERO
        for position, j in enumerate(columns):
            entry = block[row][j]
            if entry:
                rest = minor(row + 1, columns[:position] + columns[position + 1 :])
                result += (entry * rest).scaled(-1 if position % 2 else 1)
        return reduced(result, names)

    return minor(0, tuple(range(size)))


def _parity(order: Iterable[int]) -> int:
    places = list(order)
    inversions = sum(a > b for i, a in enumerate(places) for b in places[i + 1 :])
    return -1 if inversions % 2 else 1
