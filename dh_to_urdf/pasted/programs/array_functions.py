"""Functions of arrays and lists, as NumPy, Python and MATLAB name them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import arrays, numbers
from dh_to_urdf.pasted.programs.arrays import as_array, of_matrix, to_matrix
from dh_to_urdf.pasted.programs.numbers import as_scalar, real, whole
from dh_to_urdf.pasted.programs.values import (
    MAX_ITEMS,
    Array,
    Items,
    Link,
    Opaque,
    Pose,
    Robot,
    Scalar,
    Unread,
    Value,
    is_part,
    number,
)

if TYPE_CHECKING:
    from dh_to_urdf.pasted.programs.evaluation import Expressions


def of_one(name: str, value: Value) -> Value:
    """Return a function of one number, of each element of an array."""
    if name == "fabs":
        name = "abs"
    if name in numbers.SAME:
        return of_matrix(value.matrix) if isinstance(value, Pose) else value
    if isinstance(value, (Array, Items)):
        return arrays.mapped(as_array(value), lambda element: numbers.function_of(name, element))
    return numbers.function_of(name, as_scalar(value))


def _size(arguments: Sequence[Value]) -> tuple[int, int] | None:
    found = [
        whole(element)
        for value in arguments
        if not isinstance(value, str)
        for element in as_array(value).elements
    ]
    if not 1 <= len(found) <= 2 or any(not 0 <= n <= 64 for n in found):
        raise Unread(say("an array of this size is not read"))
    return (found[0], found[0]) if len(found) == 1 else (found[0], found[1])


def of_arrays(
    name: str, arguments: list[Value], keywords: dict[str, Value], *, is_matlab: bool
) -> Value:
    """Return what a function that makes an array returns.

    Raises:
        Unread: Its arguments are not read.
    """
    keywords = {key: value for key, value in keywords.items() if key not in ("dtype", "copy")}
    if keywords:
        raise Unread(
            say("{name} with {keywords} is not read", name=name, keywords=next(iter(keywords)))
        )
    match name, len(arguments):
        case "array" | "asarray" | "matrix" | "mat" | "Matrix" | "atleast_2d", 1 | 2:
            if len(arguments) == 2 and isinstance(arguments[1], (Items, Array)):
                raise Unread(say("{name} with two lists is not read", name=name))
            found = as_array(arguments[0])
            column = name == "Matrix" and found.flat
            rows = tuple((e,) for e in found.elements) if column else found.rows
            flat = found.flat and name in ("array", "asarray")
            return Array(rows, flat, found.line, lines=found.lines)
        case "eye", _:
            size = _size(arguments)
            assert size is not None
            return of_matrix(np.eye(*size, dtype=np.float64))
        case "zeros" | "ones", _:
            value = float(name == "ones")
            if len(arguments) == 1 and not is_matlab and isinstance(arguments[0], Sum):
                count = whole(arguments[0])
                if not 0 <= count <= MAX_ITEMS:
                    raise Unread(say("an array of this size is not read"))
                return Array(((number(value),) * count,), flat=True)
            size = _size(arguments)
            assert size is not None
            return Array(((number(value),) * size[1],) * size[0])
        case "horzcat", _ if _has_links(arguments):
            return _side_by_side(arguments)
        case "horzcat", _:
            return arrays.joined([[as_array(value) for value in arguments]], 0)
        case "vertcat", _:
            return arrays.joined([[as_array(value)] for value in arguments], 0)
        case "vstack", 1 if isinstance(arguments[0], Items):
            return arrays.joined([[as_array(value)] for value in arguments[0].items], 0)
        case "hstack" | "concatenate", 1 if isinstance(arguments[0], Items):
            parts = [as_array(value) for value in arguments[0].items]
            flat = all(part.flat for part in parts)
            if name == "concatenate" and not flat:
                return arrays.joined([[part] for part in parts], 0)
            return Array(arrays.joined([parts], 0).rows, flat=flat)
        case "column_stack", 1 if isinstance(arguments[0], Items):
            return arrays.transposed(
                arrays.joined([[as_array(value)] for value in arguments[0].items], 0)
            )
        case "transpose", 1:
            return arrays.transposed(as_array(arguments[0]))
        case "inv" | "trinv", 1:
            return inverse(arguments[0])
        case "dot" | "matmul", 2:
            return arrays.product(as_array(arguments[0]), as_array(arguments[1]))
        case "diag", 1:
            elements = as_array(arguments[0]).elements
            if len(elements) > 64:
                raise Unread(say("an array of this size is not read"))
            return Array(
                tuple(
                    tuple(e if r == c else Sum() for c in range(len(elements)))
                    for r, e in enumerate(elements)
                )
            )
    raise Unread(say("{name} with these arguments is not read", name=name))


def _has_links(values: Sequence[Value]) -> bool:
    return any(is_part(value) for value in values)


def _side_by_side(values: Sequence[Value]) -> Value:
    """Return links and rows of links as one row."""
    found: list[Value] = []
    for value in values:
        found += value.items if isinstance(value, Items) else [value]
    return Items(found)


def inverse(value: Value) -> Value:
    """Return the inverse of a pose or of a square matrix."""
    matrix = to_matrix(value)
    if matrix.shape[0] != matrix.shape[1] or matrix.shape[0] > 8:
        raise Unread(say("the inverse of this matrix is not read"))
    try:
        found = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        raise Unread(say("the matrix has no inverse")) from None
    if isinstance(value, Pose):
        T = np.eye(4)
        T[:3, :3] = matrix[:3, :3].T
        T[:3, 3] = -matrix[:3, :3].T @ matrix[:3, 3]
        return Pose(T)
    return of_matrix(np.asarray(found, dtype=np.float64))


def of_array_method(
    owner: Array, name: str, arguments: Sequence[Value], keywords: dict[str, Value]
) -> Value:
    """Return what ``owner.name(…)`` of NumPy returns.

    Raises:
        Unread: It is not read.
    """
    if keywords:
        raise Unread(say("{name}() with these arguments is not read", name=name))
    match name, len(arguments):
        case "copy" | "astype", _:
            return Array(owner.rows, owner.flat, owner.line, lines=owner.lines)
        case "tolist", 0:
            rows: list[Value] = [Items(list(row)) for row in owner.rows]
            return rows[0] if owner.flat else Items(rows)
        case "flatten" | "ravel", 0:
            return Array((owner.elements,), flat=True)
        case "transpose", 0:
            return arrays.transposed(owner)
        case "dot", 1:
            return arrays.product(owner, as_array(arguments[0]))
    raise Unread(say("{name}() of an array is not read", name=name))


def of_lists(
    machine: Expressions, name: str, arguments: list[Value], keywords: dict[str, Value]
) -> Value:
    """Return what a function of lists returns.

    Raises:
        Unread: Its arguments are not read.
    """
    first = arguments[0] if arguments else None
    match name, len(arguments):
        case "list" | "tuple", 0 | 1:
            return Items(machine.iterate(first) if arguments else [], name == "tuple")
        case "dict", 0:
            return dict(keywords)
        case "reversed" | "fliplr" | "flip", 1 if isinstance(first, (Items, Array)):
            return _reversed(first, name)
        case "flipud", 1 if isinstance(first, Array):
            return Array(first.rows[::-1])
        case "range" | "arange", 1 | 2 | 3:
            return _range(name, [whole(value) for value in arguments])
        case "len" | "numel" | "length" | "numrows" | "numcols", 1:
            return number(_length(first, name))
        case "size", 1:
            sizes: list[Value] = [number(_length(first, k)) for k in ("numrows", "numcols")]
            return (
                Items(sizes, is_tuple=True)
                if isinstance(first, Items)
                else Array((tuple(as_scalar(size) for size in sizes),))
            )
        case "size", 2:
            return number(_length(first, "numrows" if whole(arguments[1]) == 1 else "numcols"))
        case "enumerate", 1 | 2:
            start = whole(arguments[1]) if len(arguments) == 2 else 0
            start = whole(keywords["start"]) if "start" in keywords else start
            return Items(
                [
                    Items([number(start + k), value], is_tuple=True)
                    for k, value in enumerate(machine.iterate(first))
                ]
            )
        case "zip", _:
            lists = [machine.iterate(value) for value in arguments]
            return Items([Items(list(row), is_tuple=True) for row in zip(*lists, strict=False)])
        case "cat", 3 if whole(first) == 2 and _has_links(arguments[1:]):
            return _side_by_side(arguments[1:])
        case "struct", _ if len(arguments) % 2 == 0:
            pairs = zip(arguments[::2], arguments[1::2], strict=True)
            return {key: value for key, value in pairs if isinstance(key, str)}
        case "deal", _:
            return Items(list(arguments), is_tuple=True)
        case "isempty", 1:
            return _length(first, "numel") == 0
        case "sum" | "max" | "min", 1:
            return _folded(name, as_array(first).elements)
        case "max" | "min", 2:
            return _folded(name, [as_scalar(value) for value in arguments])
        case "round", 1 | 2:
            places = whole(arguments[1]) if len(arguments) == 2 else 0
            return number(round(real(first), min(max(places, -9), 15)))
        case "int", 1:
            return number(math.trunc(real(first)))
        case "exist", 1 | 2:
            return isinstance(first, str) and any(first in scope for scope in machine.scopes)
    raise Unread(say("{name} with these arguments is not read", name=name))


def _range(name: str, bounds: list[int]) -> Value:
    found = range(*bounds)
    if len(found) > MAX_ITEMS:
        raise Unread(say("a range of this size is not read"))
    if name == "arange":
        return Array((tuple(number(k) for k in found),), flat=True)
    return Items([number(k) for k in found])


def _reversed(value: Items | Array, name: str) -> Value:
    if isinstance(value, Items):
        return Items(value.items[::-1], value.is_tuple)
    if name == "fliplr" or value.shape[0] == 1:
        return Array(tuple(row[::-1] for row in value.rows), value.flat)
    return Array(value.rows[::-1])


def _length(value: Value, name: str) -> int:
    if isinstance(value, (Link, Robot)):
        return 1
    if isinstance(value, (str, dict)):
        return len(value)
    if isinstance(value, Items):
        return 1 if name == "numrows" else len(value.items)
    if isinstance(value, Opaque):
        raise Unread(value.why)
    array = as_array(value)
    rows, columns = array.shape
    if name == "len":
        return columns if array.flat else rows
    if name == "length":
        return max(rows, columns) if array.elements else 0
    return {"numel": rows * columns, "numrows": rows, "numcols": columns}[name]


def _folded(name: str, elements: Sequence[Scalar]) -> Scalar:
    if name == "sum":
        total: Scalar = Sum()
        for element in elements:
            total = numbers.combined("+", total, element)
        return total
    if not elements:
        raise Unread(say("{name} of nothing", name=name))
    return (max if name == "max" else min)(elements, key=real)


def expanded(names: Sequence[str]) -> list[str]:
    """Return ``q1:4`` of sympy as q1, q2, q3.

    Raises:
        Unread: Too many names.
    """
    found: list[str] = []
    for name in names:
        stem, colon, last = name.partition(":")
        if not colon:
            found.append(name)
            continue
        letters = stem.rstrip("0123456789")
        first = stem[len(letters) :] or "0"
        if not last.isdecimal() or len(last) > 3 or len(first) > 3:
            raise Unread(say("symbols of this form are not read"))
        found += [f"{letters}{k}" for k in range(int(first), int(last))]
    if len(found) > 400:
        raise Unread(say("too many symbols"))
    return found
