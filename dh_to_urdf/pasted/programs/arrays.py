"""Arrays of a program: elementwise and matrix arithmetic, joining, indexing."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.numbers import as_scalar, combined, known, real
from dh_to_urdf.pasted.programs.values import MAX_ITEMS, Array, Items, Pose, Scalar, Unread, Value
from dh_to_urdf.poses import Matrix


def as_array(value: Value) -> Array:
    """Return lists of numbers, or of lists of numbers, as an array.

    Raises:
        Unread: They are no such thing.
    """
    if isinstance(value, Array):
        return value
    if isinstance(value, Pose):
        return of_matrix(value.matrix)
    if isinstance(value, Items):
        if value.items and all(isinstance(item, (Items, Array)) for item in value.items):
            rows = [as_array(item).elements for item in value.items]
            if any(isinstance(item, Array) and not item.flat for item in value.items):
                raise Unread(say("has more than two dimensions"))
            return rectangle(rows)
        return Array((tuple(as_scalar(item) for item in value.items),), flat=True)
    return Array(((as_scalar(value),),), flat=True)


def rectangle(rows: Sequence[Sequence[Scalar]], line: int = 0) -> Array:
    """Return an array of rows of one length.

    Raises:
        Unread: They differ, or are too many.
    """
    for k, row in enumerate(rows, start=1):
        if len(row) != len(rows[0]):
            raise Unread(
                say(
                    "row {k} of the matrix has {count} elements where row 1 has {count_2}",
                    k=k,
                    count=len(row),
                    count_2=len(rows[0]),
                )
            )
    if sum(len(row) for row in rows) > MAX_ITEMS:
        raise Unread(say("is too large"))
    return Array(tuple(tuple(row) for row in rows), line=line)


def of_matrix(matrix: Matrix) -> Array:
    """Return a matrix of plain numbers."""
    return Array(tuple(tuple(Sum(plain=float(x)) for x in row) for row in matrix))


def to_matrix(value: Value) -> Matrix:
    """Return an array of known numbers.

    Raises:
        Unread: One is unknown.
    """
    array = as_array(value)
    return np.array([[real(element) for element in row] for row in array.rows])


def mapped(array: Array, function: Callable[[Scalar], Scalar]) -> Array:
    """Return a function of each element."""
    rows = tuple(tuple(function(element) for element in row) for row in array.rows)
    return Array(rows, array.flat, array.line)


def elementwise(symbol: str, left: Value, right: Value) -> Array:
    """Return an operation on each pair of elements; a single number or a row is repeated.

    Raises:
        Unread: The shapes do not fit.
    """
    if not isinstance(left, (Array, Items, Pose)):
        scalar = as_scalar(left)
        return mapped(as_array(right), lambda element: combined(symbol, scalar, element))
    if not isinstance(right, (Array, Items, Pose)):
        other = as_scalar(right)
        return mapped(as_array(left), lambda element: combined(symbol, element, other))
    one, two = as_array(left), as_array(right)
    if one.shape != two.shape or one.flat != two.flat:
        raise Unread(say("combines arrays of different shapes"))
    rows = tuple(
        tuple(combined(symbol, a, b) for a, b in zip(row, others, strict=True))
        for row, others in zip(one.rows, two.rows, strict=True)
    )
    return Array(rows, one.flat, one.line)


def product(left: Array, right: Array) -> Array:
    """Return the product of two matrices of known numbers.

    Raises:
        Unread: The shapes do not fit, or a number is unknown.
    """
    if left.flat or right.flat or left.shape[1] != right.shape[0]:
        raise Unread(say("multiplies matrices whose shapes do not fit"))
    if left.shape[0] * right.shape[1] > MAX_ITEMS:
        raise Unread(say("is too large"))
    return of_matrix(to_matrix(left) @ to_matrix(right))


def transposed(array: Array) -> Array:
    """Return rows as columns; one dimension stays."""
    if array.flat or not array.rows:
        return array
    return Array(tuple(zip(*array.rows, strict=True)), line=array.line)


def joined(rows: Sequence[Sequence[Array]], line: int) -> Array:
    """Return blocks side by side and below each other.

    Raises:
        Unread: Their shapes do not fit.
    """
    found: list[tuple[Scalar, ...]] = []
    for row in rows:
        blocks = [block for block in row if block.elements]
        if len({block.shape[0] for block in blocks}) > 1:
            raise Unread(say("joins blocks of different heights"))
        found += [
            tuple(element for part in lines for element in part)
            for lines in zip(*(block.rows for block in blocks), strict=True)
        ]
    return rectangle(found, line)


def flat_numbers(value: Value, size: int | None = None) -> list[Sum]:
    """Return the known numbers of a list or an array.

    Raises:
        Unread: Another size, or an unknown number.
    """
    elements = as_array(value).elements
    if size is not None and len(elements) != size:
        raise Unread(say("is no list of {size} numbers", size=size))
    return [known(element) for element in elements]
