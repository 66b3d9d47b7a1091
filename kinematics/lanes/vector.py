"""A compiled value of one or eight floats, its masks, and how they are read and written.

Compiled code that is written with it reads like code for one number and works on eight: LLVM's
``<8 x double>`` is one register with AVX-512, two with AVX, four with SSE2, and each float takes
the very operations that it would take alone. Products and sums may be fused where the processor
can (FMA): there, and only there, a result may differ in its last digits from one processor to
another.

The width is part of the type. Functions take it from their arguments, or from a value ``like`` that
is not looked at: one source serves :func:`one_lane` and :func:`eight_lanes`. Memory of lanes has
rows of one vector each, an array of shape (rows, width), and is handed over by its address.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from kinematics.compiled import inner
from kinematics.kernels import Array

Pointer = Any
"""The address of floats; see :func:`pointer`."""
Vector = Any
"""A vector of floats, of either width."""

LANES = 8
"""Width of a vector of several."""
WIDTHS = (1, LANES)

_FLAGS = ("contract", "nsz")
_DOUBLE, _INT32, _INT64 = ir.DoubleType(), ir.IntType(32), ir.IntType(64)


class VectorType(types.Type):  # type: ignore[misc]
    """The type of as many floats as its width."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"vector{width}")


class MaskType(types.Type):  # type: ignore[misc]
    """The type of as many truth values as its width."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"mask{width}")


POINTER = types.CPointer(types.float64)
VECTORS = {width: VectorType(width) for width in WIDTHS}
MASKS = {width: MaskType(width) for width in WIDTHS}


def _floats(width: int) -> Any:
    return ir.VectorType(_DOUBLE, width)


def _truths(width: int) -> Any:
    return ir.VectorType(ir.IntType(1), width)


@register_model(VectorType)
class _VectorModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: VectorType) -> None:
        super().__init__(manager, kind, _floats(kind.width))


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: MaskType) -> None:
        super().__init__(manager, kind, _truths(kind.width))


def _spread(builder: Any, value: Any, width: int) -> Any:
    """Return a vector with one float in every lane."""
    undefined = ir.Constant(_floats(width), ir.Undefined)
    first = builder.insert_element(undefined, value, _INT32(0))
    zeros = ir.Constant(ir.VectorType(_INT32, width), [0] * width)
    return builder.shuffle_vector(first, undefined, zeros)


def _as_vector(builder: Any, kind: Any, value: Any, width: int) -> Any:
    return value if isinstance(kind, VectorType) else _spread(builder, value, width)


Build = Callable[[Any, Any, Any], Any]


def _register(operation: Any, kinds: tuple[Any, ...], result: Any, width: int, make: Build) -> None:
    """Tell Numba how to build an operation on vectors and, as its other operand, a float."""

    @lower_builtin(operation, *kinds)
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        pairs = zip(sig.args, args, strict=True)
        if isinstance(kinds[0], MaskType):
            return make(builder, *args)
        return make(builder, *(_as_vector(builder, kind, value, width) for kind, value in pairs))


def _binary(operation: Any, results: dict[int, Any], make: Build) -> None:
    signatures = []
    for width, vector in VECTORS.items():
        for pair in ((vector, vector), (vector, types.float64), (types.float64, vector)):
            signatures.append(signature(results[width], *pair))
            _register(operation, pair, results[width], width, make)
    infer_global(operation)(type("Template", (ConcreteTemplate,), _template(operation, signatures)))


def _on_masks(operation: Any, operands: int, make: Any) -> None:
    signatures = []
    for width, mask in MASKS.items():
        signatures.append(signature(mask, *[mask] * operands))
        _register(operation, (mask,) * operands, mask, width, make)
    infer_global(operation)(type("Template", (ConcreteTemplate,), _template(operation, signatures)))


def _template(operation: Any, signatures: list[Any]) -> dict[str, Any]:
    return {"key": operation, "cases": signatures}


def _arithmetic(name: str) -> Build:
    return lambda builder, a, b: getattr(builder, name)(a, b, flags=_FLAGS)


def _comparison(sign: str) -> Build:
    return lambda builder, a, b: builder.fcmp_ordered(sign, a, b)


for _operations, _name in (
    ((operator.add, operator.iadd), "fadd"),
    ((operator.sub, operator.isub), "fsub"),
    ((operator.mul, operator.imul), "fmul"),
    ((operator.truediv, operator.itruediv), "fdiv"),
):
    for _operation in _operations:
        _binary(_operation, VECTORS, _arithmetic(_name))
for _operation, _sign in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.eq, "=="),
):
    _binary(_operation, MASKS, _comparison(_sign))
_on_masks(operator.and_, 2, lambda builder, a, b: builder.and_(a, b))
_on_masks(operator.or_, 2, lambda builder, a, b: builder.or_(a, b))
_on_masks(operator.invert, 1, lambda builder, a: builder.not_(a))


def _negate() -> None:
    signatures = []
    for vector in VECTORS.values():
        signatures.append(signature(vector, vector))

        @lower_builtin(operator.neg, vector)
        def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.fneg(args[0])

    template = type("Template", (ConcreteTemplate,), _template(operator.neg, signatures))
    infer_global(operator.neg)(template)


_negate()


def _function(name: str) -> Any:
    """Return LLVM's function of each lane, exact or correctly rounded."""

    def typed(context: Any, vector: Any) -> Any:
        def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            width = sig.return_type.width
            kind = ir.FunctionType(_floats(width), [_floats(width)])
            full = f"llvm.{name}.v{width}f64"
            return builder.call(cgutils.get_or_insert_function(builder.module, kind, full), args)

        return vector(vector), build

    return intrinsic(typed)


square_root, floor, absolute = _function("sqrt"), _function("floor"), _function("fabs")


@intrinsic
def larger(context: Any, a: Any, b: Any) -> Any:
    """Return the larger of two vectors, lane by lane; the second where one is no number."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", *args), *args)

    return a(a, b), build


@intrinsic
def smaller(context: Any, a: Any, b: Any) -> Any:
    """Return the smaller of two vectors, lane by lane; the second where one is no number."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered("<", *args), *args)

    return a(a, b), build


@intrinsic
def select(context: Any, mask: Any, a: Any, b: Any) -> Any:
    """Return, lane by lane, a where the mask is true, else b; one of them may be a float."""
    width = mask.width

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        chosen = (_as_vector(builder, sig.args[i], args[i], width) for i in (1, 2))
        return builder.select(args[0], *chosen)

    return VECTORS[width](mask, a, b), build


@intrinsic
def splat(context: Any, value: Any, like: Any) -> Any:
    """Return a vector with a float in every lane."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _spread(builder, args[0], sig.return_type.width)

    return like(types.float64, like), build


@intrinsic
def bits(context: Any, mask: Any) -> Any:
    """Return a mask as a whole number: bit l is lane l."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.zext(builder.bitcast(args[0], ir.IntType(sig.args[0].width)), _INT64)

    return types.int64(mask), build


@intrinsic
def mask_of(context: Any, number: Any, like: Any) -> Any:
    """Return the mask of a whole number, as :func:`bits` gives it."""
    width = like.width

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(builder.trunc(args[0], ir.IntType(width)), _truths(width))

    return MASKS[width](types.int64, like), build


def _zeros(width: int) -> Any:
    def typed(context: Any) -> Any:
        def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return ir.Constant(_floats(width), [0.0] * width)

        return VECTORS[width](), build

    return intrinsic(typed)


one_lane, eight_lanes = _zeros(1), _zeros(LANES)


@intrinsic
def pointer(context: Any, array: Any) -> Any:
    """Return the address of a C-contiguous array of floats; ``pointer[i]`` is its i-th number.

    Addresses are handed over without counting references, which would cost as much as a step of
    eight lanes. The array must be in use after the last use of its address.
    """

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return POINTER(array), build


@intrinsic
def past(context: Any, start: Any, numbers: Any) -> Any:
    """Return the address so many floats after another."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.gep(args[0], [args[1]])

    return POINTER(start, types.int64), build


def _row(builder: Any, start: Any, row: Any, width: int) -> Any:
    """Return the address of a row of lane memory."""
    address = builder.gep(start, [builder.mul(row, _INT64(width))])
    return builder.bitcast(address, ir.PointerType(_floats(width)))


@intrinsic
def load(context: Any, memory: Any, row: Any, like: Any) -> Any:
    """Return a row of the lane memory at an address; the row is not checked."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(_row(builder, args[0], args[1], sig.return_type.width), align=8)

    return like(memory, types.int64, like), build


@intrinsic
def store(context: Any, memory: Any, row: Any, value: Any) -> Any:
    """Write a vector into a row of the lane memory at an address; the row is not checked."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _row(builder, args[0], args[1], sig.args[2].width), 8)
        return context.get_dummy_value()

    return types.void(memory, types.int64, value), build


def _place(context: Any, builder: Any, kind: Any, array: Any, row: Any, column: Any) -> Any:
    """Return the address of an entry of a C-contiguous array of two axes, and its row length."""
    made = context.make_array(kind)(context, builder, array)
    length = cgutils.unpack_tuple(builder, made.shape, 2)[1]
    return builder.gep(made.data, [builder.add(builder.mul(row, length), column)]), length


@intrinsic
def gather(context: Any, array: Any, row: Any, column: Any, like: Any) -> Any:
    """Return a column of as many rows as there are lanes, from an array of shape (n, m)."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        width = sig.return_type.width
        address, length = _place(context, builder, sig.args[0], *args[:3])
        value = ir.Constant(_floats(width), ir.Undefined)
        for lane in range(width):
            value = builder.insert_element(value, builder.load(address), _INT32(lane))
            address = builder.gep(address, [length])
        return value

    return like(array, types.int64, types.int64, like), build


@intrinsic
def scatter(context: Any, array: Any, row: Any, column: Any, value: Any) -> Any:
    """Write lane l into row + l of a column of an array of shape (n, m)."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        address, length = _place(context, builder, sig.args[0], *args[:3])
        for lane in range(sig.args[3].width):
            builder.store(builder.extract_element(args[3], _INT32(lane)), address)
            address = builder.gep(address, [length])
        return context.get_dummy_value()

    return types.void(array, types.int64, types.int64, value), build


@intrinsic
def scatter_four(
    context: Any, array: Any, row: Any, column: Any, a: Any, b: Any, c: Any, d: Any
) -> Any:
    """Write four vectors side by side: lane l into row + l, columns column … column + 3.

    Eight lanes only: pairs are interleaved, then put together, so that a store takes four numbers.
    """
    indices = ir.VectorType(_INT32, LANES)
    four = ir.VectorType(_INT32, 4)

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        address, length = _place(context, builder, sig.args[0], *args[:3])
        even = ir.Constant(indices, [0, 8, 2, 10, 4, 12, 6, 14])
        odd = ir.Constant(indices, [1, 9, 3, 11, 5, 13, 7, 15])
        pairs = [
            (builder.shuffle_vector(args[3], args[4], order), builder.shuffle_vector(*args[5:], order))
            for order in (even, odd)
        ]
        for lane in range(LANES):
            left, right = pairs[lane % 2]
            k = lane - lane % 2
            chosen = ir.Constant(four, [k, k + 1, LANES + k, LANES + k + 1])
            whole = builder.shuffle_vector(left, right, chosen)
            place = builder.bitcast(address, ir.PointerType(ir.VectorType(_DOUBLE, 4)))
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
