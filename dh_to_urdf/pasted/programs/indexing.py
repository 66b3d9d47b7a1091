"""Elements of lists and arrays: those of MATLAB count from 1, those of Python from 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.arrays import as_array, rectangle
from dh_to_urdf.pasted.programs.numbers import as_scalar, whole
from dh_to_urdf.pasted.programs.values import (
    MAX_ITEMS,
    Array,
    Items,
    Pose,
    Scalar,
    Unread,
    Value,
)


@dataclass(frozen=True, slots=True)
class Several:
    """Positions from 0 that a slice or a list of numbers picks.

    Attributes:
        positions: The positions.
        span: Start, stop and step, for a slice of Python.
    """

    positions: tuple[int, ...]
    span: slice | None = None


Key: TypeAlias = int | Several
"""One position from 0, or several."""


def matlab_key(value: Value) -> Key:
    """Return positions from 0 of an index of MATLAB that is no colon.

    Raises:
        Unread: No whole numbers from 1 on.
    """
    if isinstance(value, Array) and (len(value.elements) != 1 or value.shape[0] != 1):
        found = tuple(whole(element) - 1 for element in value.elements)
        if any(position < 0 for position in found):
            raise Unread(say("has an index below 1"))
        return Several(found)
    position = whole(value.elements[0] if isinstance(value, Array) else value) - 1
    if not 0 <= position < MAX_ITEMS:
        raise Unread(say("has an index out of range"))
    return position


def python_key(value: Value, size: int) -> int:
    """Return a position from 0 of an index of Python.

    Raises:
        Unread: It is out of range.
    """
    position = whole(value)
    if position < -size or position >= size:
        raise Unread(
            say("has an index {position} where there are {size}", position=position, size=size)
        )
    return position % size


def _one(items: Sequence[Value], position: int) -> Value:
    if position >= len(items):
        raise Unread(
            say(
                "has an index {position} where there are {count}",
                position=position + 1,
                count=len(items),
            )
        )
    return items[position]


def items_at(items: Items, key: Key) -> Value:
    """Return an item of a list, or a list of several."""
    if isinstance(key, Several):
        return Items([_one(items.items, k) for k in key.positions], items.is_tuple)
    return _one(items.items, key)


def array_at(array: Array, keys: Sequence[Key], *, is_matlab: bool) -> Value:
    """Return an element or a part of an array.

    Raises:
        Unread: Out of range, or too many indices.
    """
    rows, columns = array.shape
    if len(keys) == 1 and array.flat:
        keys = (0, keys[0])
    elif len(keys) == 1 and is_matlab:
        key = keys[0]
        if isinstance(key, int):
            return _element(array, key % rows if rows else 0, key // rows if rows else 0)
        parts = [_element(array, k % rows, k // rows) for k in key.positions]
        if columns == 1 and rows > 1:
            return Array(tuple((part,) for part in parts))
        return Array((tuple(parts),))
    elif len(keys) == 1:
        key = keys[0]
        if isinstance(key, int):
            line = array.lines[key] if key < len(array.lines) else array.line
            return Array((array.rows[key],), flat=True, view_of=array, line=line)
        keys = (key, Several(tuple(range(columns))))
    if len(keys) != 2:
        raise Unread(say("has too many indices"))
    first, second = keys
    if isinstance(first, int) and isinstance(second, int):
        return _element(array, first, second)
    lines = first.positions if isinstance(first, Several) else (first,)
    places = second.positions if isinstance(second, Several) else (second,)
    found = tuple(tuple(_element(array, r, c) for c in places) for r in lines)
    if is_matlab:
        return Array(found, line=array.line)
    if isinstance(first, int) or array.flat:
        return Array(found, flat=True, view_of=array)
    if isinstance(second, int):
        return Array((tuple(row[0] for row in found),), flat=True, view_of=array)
    return Array(found, view_of=array, line=array.line)


def _element(array: Array, row: int, column: int) -> Scalar:
    if row >= array.shape[0] or column >= array.shape[1]:
        raise Unread(
            say(
                "has an index ({row}, {column}) beyond {shape}",
                row=row + 1,
                column=column + 1,
                shape=array.shape,
            )
        )
    return array.rows[row][column]


def with_element(array: Array, keys: Sequence[Key], value: Value, *, is_matlab: bool) -> Array:
    """Return an array with elements set; a row of MATLAB grows at its end.

    Raises:
        Unread: Out of range, or the shapes do not fit.
    """
    rows = [list(row) for row in array.rows]
    height, width = array.shape
    if len(keys) == 1 and (array.flat or (is_matlab and height <= 1)):
        keys = (0, keys[0])
        rows = rows or [[]]
    elif len(keys) == 1 and is_matlab and width == 1:
        keys = (keys[0], 0)
    elif len(keys) == 1 and not is_matlab:
        keys = (keys[0], Several(tuple(range(width))))
    if len(keys) != 2:
        raise Unread(say("sets elements by one index of a matrix"))
    lines = keys[0].positions if isinstance(keys[0], Several) else (keys[0],)
    if isinstance(keys[1], Several):
        places = keys[1].positions
        if not height and isinstance(value, Array):
            places = tuple(range(len(value.elements)))
    else:
        places = (keys[1],)
    if is_matlab:
        _grow(rows, lines, places)
    for k, r in enumerate(lines):
        for m, c in enumerate(places):
            if r >= len(rows) or c >= len(rows[r]):
                raise Unread(say("sets an element that is not there"))
            rows[r][c] = _part(value, k, m, (len(lines), len(places)))
    found = rectangle(rows)
    return Array(found.rows, array.flat, array.line, lines=array.lines)


def _grow(rows: list[list[Scalar]], lines: Sequence[int], places: Sequence[int]) -> None:
    """Add zeros so that the elements are there, as MATLAB does."""
    width = max([len(rows[0]) if rows else 0, *(c + 1 for c in places)])
    height = max([len(rows), *(r + 1 for r in lines)])
    if width * height > MAX_ITEMS:
        raise Unread(say("is too large"))
    for row in rows:
        row.extend([Sum()] * (width - len(row)))
    rows.extend([Sum()] * width for _ in range(height - len(rows)))


def _part(value: Value, row: int, column: int, shape: tuple[int, int]) -> Scalar:
    """Return the number for one of the elements that are set."""
    if not isinstance(value, (Array, Items, Pose)):
        return as_scalar(value)
    array = as_array(value)
    if array.shape == shape:
        return array.rows[row][column]
    if len(array.elements) == shape[0] * shape[1] and 1 in shape and 1 in array.shape:
        return array.elements[row + column]
    if array.shape[0] == 1 and array.shape[1] == shape[1]:
        return array.rows[0][column]
    raise Unread(say("sets elements from an array of another shape"))


def matlab_items_with(items: Items, key: Key, value: Value) -> Items:
    """Return a list with one item set; positions in between stay empty."""
    if isinstance(key, Several):
        if not isinstance(value, Items) or len(value.items) != len(key.positions):
            raise Unread(say("sets several links at once from another number of them"))
        for position, item in zip(key.positions, value.items, strict=True):
            items = matlab_items_with(items, position, item)
        return items
    if isinstance(value, Items) and len(value.items) == 1:
        value = value.items[0]
    found = list(items.items)
    found.extend([None] * (key + 1 - len(found)))
    found[key] = value
    return replace(items, items=found)


def without_items(items: Items, key: Key) -> Items:
    """Return a list without some of its items, as ``L(2) = []`` leaves it."""
    gone = set(key.positions) if isinstance(key, Several) else {key}
    if any(position >= len(items.items) for position in gone):
        raise Unread(say("removes an item that is not there"))
    return replace(items, items=[v for k, v in enumerate(items.items) if k not in gone])
