"""The inverse of a small square Jacobian, by cofactors: a matrix over its determinant."""

from __future__ import annotations

from dataclasses import dataclass, field

from dh_to_urdf.messages import say
from kinematics.symbolic.arrange import expanded, folded
from kinematics.symbolic.determinant import expansion
from kinematics.symbolic.expressions import Sum
from kinematics.symbolic.factors import factored
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial
from kinematics.symbolic.quantities import Grid, Work
from kinematics.symbolic.trigonometry import combined

LARGEST = 3
"""Rows of a Jacobian whose inverse is written: beyond, it fills pages."""


@dataclass
class Inverse:
    """``J⁻¹ = matrix / over`` (Cramer's rule).

    Attributes:
        rows: Rows of J, as indices.
        joints: Numbers of the joints, one a row of the matrix.
        matrix: The adjugate of J.
        divisor: det J.
        written: An expression for each entry of the matrix.
        over: That of the determinant.
        simplified: Whether these are in their last form.
        note: Why there is none.
    """

    rows: tuple[int, ...]
    joints: tuple[int, ...]
    matrix: Grid = field(default_factory=list)
    divisor: Polynomial = ZERO
    written: list[list[Sum]] = field(default_factory=list)
    over: Sum = field(default_factory=Sum)
    simplified: bool = False
    note: str = ""


def inverse_of(work: Work) -> Inverse:
    """Return the inverse of the Jacobian of a request, not simplified, or why there is none.

    Raises:
        TooManyTerms: It exceeds the limits.
    """
    joints = tuple(sorted({axis.joint for axis in work.chain.axes}))
    task = work.request.task
    rows, note = (task.rows, "") if task is not None else work.square_rows(len(joints))
    found = Inverse(rows, joints)
    if note or len(rows) != len(joints) or not rows:
        found.note = say(
            "J has {count} rows and {count_2} columns: give a task of {count_2}"
            " rows for an inverse",
            count=len(rows),
            count_2=len(joints),
        )
        return found
    if len(rows) > LARGEST:
        found.note = say(
            "the inverse of {count} rows is long and is not written; give a task of"
            " at most {largest} rows, or ask jacobian for its numbers",
            count=len(rows),
            largest=LARGEST,
        )
        return found
    every = work.task_rows() if task is not None else _chosen(work, rows)
    J = [[row[joint - 1] for joint in joints] for row in every]
    names, size = work.names, len(J)
    found.divisor = combined(expansion(J, names), names)
    if not found.divisor:
        found.note = say(
            "these rows of J are dependent in every configuration: there is no inverse"
        )
        return found
    found.matrix = [
        [combined(_cofactor(J, j, i, work), names) for j in range(size)] for i in range(size)
    ]
    found.written = [
        [expanded(folded(entry, names), names) for entry in row] for row in found.matrix
    ]
    found.over = expanded(folded(found.divisor, names), names)
    return found


def simplify_inverse(work: Work, inverse: Inverse) -> None:
    """Write an inverse in short form, in place."""
    inverse.written = [[work.simple(entry) for entry in row] for row in inverse.matrix]
    product = factored([inverse.divisor], work.names)
    inverse.over = Sum((product,)) if product.coefficient else Sum()
    inverse.simplified = True


def _chosen(work: Work, rows: tuple[int, ...]) -> Grid:
    columns = work.jacobian(work.request.expressed_in or work.request.base)
    return [[column[i] for column in columns] for i in rows]


def _cofactor(J: Grid, row: int, column: int, work: Work) -> Polynomial:
    """Return the determinant of J without a row and a column, with its sign."""
    rest = [
        [entry for j, entry in enumerate(line) if j != column]
        for i, line in enumerate(J)
        if i != row
    ]
    found = expansion(rest, work.names) if rest else ONE
    return found.scaled(-1 if (row + column) % 2 else 1)
