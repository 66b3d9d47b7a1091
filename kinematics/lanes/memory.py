"""Compiled: memory of lanes, rows of one vector each, and arrays read and written across lanes.

An array of shape (rows, width) is lane memory. Its address is handed over: an array that is handed
over is counted as in use and no longer in use, which costs as much as a step of eight lanes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types

from kinematics.compiled import inner
from kinematics.kernels import Array
from kinematics.lanes.vector import DOUBLE, INT32, INT64, LANES, built, floats

Pointer = Any
"""The address of floats; see :func:`start_of`."""
POINTER = types.CPointer(types.float64)  # type: ignore[no-untyped-call]


@built
def start_of(context: Any, array: Any) -> Any:
    """Return the address of a C-contiguous array of floats, of which ``[i]`` is the i-th number.

    The array must be in use after the last use of its address.
    """

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return POINTER(array), build


@built
def past(context: Any, start: Any, numbers: Any) -> Any:
    """Return the address so many floats after another."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.gep(args[0], [args[1]])

    return POINTER(start, types.int64), build


def _row(builder: Any, start: Any, row: Any, width: int) -> Any:
    """Return the address of a row of lane memory."""
    address = builder.gep(start, [builder.mul(row, INT64(width))])
    return builder.bitcast(address, ir.PointerType(floats(width)))


@built
def load(context: Any, memory: Any, row: Any, like: Any) -> Any:
    """Return a row of the lane memory at an address; the row is not checked."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(_row(builder, args[0], args[1], sig.return_type.width), align=8)

    return like(memory, types.int64, like), build


@built
def store(context: Any, memory: Any, row: Any, value: Any) -> Any:
    """Write a vector into a row of the lane memory at an address; the row is not checked."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _row(builder, args[0], args[1], sig.args[2].width), 8)
        return context.get_dummy_value()

    return types.void(memory, types.int64, value), build


@built
def spread_out(context: Any, start: Any, step: Any, like: Any) -> Any:
    """Return a vector of which lane l is number ``l step`` after an address.

    Numbers that were written one by one just before are quicker read so than as a row: a processor
    hands a number on from a store to a load of the same size alone.
    """

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        width = sig.return_type.width
        value, address = ir.Constant(floats(width), ir.Undefined), args[0]
        for lane in range(width):
            value = builder.insert_element(value, builder.load(address), INT32(lane))
            address = builder.gep(address, [args[1]])
        return value

    return like(start, types.int64, like), build


STACK = 512
"""Numbers of :func:`stack_memory`."""


@built
def stack_memory(context: Any) -> Any:
    """Return the address of ``STACK`` numbers that are there until the function returns.

    What is taken from the stack costs nothing; each place in the source has memory of its own.
    """

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        with builder.goto_entry_block():
            memory = builder.alloca(ir.ArrayType(DOUBLE, STACK))
        memory.align = 64
        return builder.bitcast(memory, ir.PointerType(DOUBLE))

    return POINTER(), build


def _place(context: Any, builder: Any, kind: Any, array: Any, row: Any, column: Any) -> Any:
    """Return the address of an entry of a C-contiguous array of two axes, and its row length."""
    made = context.make_array(kind)(context, builder, array)
    length = builder.extract_value(made.shape, 1)
    return builder.gep(made.data, [builder.add(builder.mul(row, length), column)]), length


@built
def gather(context: Any, array: Any, row: Any, column: Any, like: Any) -> Any:
    """Return a column of as many rows as there are lanes, from an array of shape (n, m)."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        width = sig.return_type.width
        address, length = _place(context, builder, sig.args[0], *args[:3])
        value = ir.Constant(floats(width), ir.Undefined)
        for lane in range(width):
            value = builder.insert_element(value, builder.load(address), INT32(lane))
            address = builder.gep(address, [length])
        return value

    return like(array, types.int64, types.int64, like), build


@built
def scatter(context: Any, array: Any, row: Any, column: Any, value: Any) -> Any:
    """Write lane l into row + l of a column of an array of shape (n, m)."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        address, length = _place(context, builder, sig.args[0], *args[:3])
        for lane in range(sig.args[3].width):
            builder.store(builder.extract_element(args[3], INT32(lane)), address)
            address = builder.gep(address, [length])
        return context.get_dummy_value()

    return types.void(array, types.int64, types.int64, value), build


@built
def scatter_four(
    context: Any, array: Any, row: Any, column: Any, a: Any, b: Any, c: Any, d: Any
) -> Any:
    """Write four vectors side by side: lane l into row + l, columns column … column + 3.

    Eight lanes only: pairs are interleaved, then put together, so that a store takes four numbers.
    """
    indices = ir.VectorType(INT32, LANES)
    four = ir.VectorType(INT32, 4)

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        address, length = _place(context, builder, sig.args[0], *args[:3])
        even = ir.Constant(indices, [0, 8, 2, 10, 4, 12, 6, 14])
        odd = ir.Constant(indices, [1, 9, 3, 11, 5, 13, 7, 15])
        pairs = [
            (
                builder.shuffle_vector(args[3], args[4], order),
                builder.shuffle_vector(*args[5:], order),
            )
            for order in (even, odd)
        ]
        for lane in range(LANES):
            left, right = pairs[lane % 2]
            k = lane - lane % 2
            chosen = ir.Constant(four, [k, k + 1, LANES + k, LANES + k + 1])
            whole = builder.shuffle_vector(left, right, chosen)
            place = builder.bitcast(address, ir.PointerType(ir.VectorType(DOUBLE, 4)))
            builder.store(whole, place, 8)
            address = builder.gep(address, [length])
        return context.get_dummy_value()

    return types.void(array, types.int64, types.int64, a, b, c, d), build


@inner
def lane_memory(rows: int, width: int) -> Array:
    """Return memory of lanes, shape (rows, width), that begins where a cache line does."""
    memory = np.empty(rows * width + 7)
    past = (memory.ctypes.data >> 3) & 7
    first = (8 - past) & 7
    return memory[first : first + rows * width].reshape((rows, width))
