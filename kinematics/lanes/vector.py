"""A compiled value of one, four or eight floats, and its masks.

Compiled code that is written with it reads like code for one number and works on eight: LLVM's
``<8 x double>`` is one register with AVX-512, two with AVX, four with SSE2, and each float takes
the very operations that it would take alone. Products and sums may be fused where the processor
can (FMA): there, and only there, a result may differ in its last digits from one processor to
another.

The width is part of the type. Functions take it from their arguments, or from a value ``like`` that
is not looked at: one source serves :func:`one_lane` and :func:`eight_lanes`. Memory of lanes has
rows of one vector each; see :mod:`kinematics.lanes.memory`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

Vector = Any
"""A vector of floats, of either width."""

LANES = 8
"""Width of a vector for many of the same."""
FEW = 4
"""Width of a vector for a few: a pass takes half the time."""
WIDTHS = (1, FEW, LANES)

_FLAGS = ("contract", "nsz")
DOUBLE, INT32, INT64 = ir.DoubleType(), ir.IntType(32), ir.IntType(64)


class VectorType(types.Type):
    """The type of as many floats as its width."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"vector{width}")


class MaskType(types.Type):
    """The type of as many truth values as its width."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"mask{width}")


VECTORS = {width: VectorType(width) for width in WIDTHS}
MASKS = {width: MaskType(width) for width in WIDTHS}


def floats(width: int) -> Any:
    """Return LLVM's type of a vector."""
    return ir.VectorType(DOUBLE, width)


def _truths(width: int) -> Any:
    return ir.VectorType(ir.IntType(1), width)


@register_model(VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: VectorType) -> None:
        super().__init__(manager, kind, floats(kind.width))  # type: ignore[no-untyped-call]


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: MaskType) -> None:
        super().__init__(manager, kind, _truths(kind.width))  # type: ignore[no-untyped-call]


def _spread(builder: Any, value: Any, width: int) -> Any:
    """Return a vector with one float in every lane."""
    undefined = ir.Constant(floats(width), ir.Undefined)
    first = builder.insert_element(undefined, value, INT32(0))
    zeros = ir.Constant(ir.VectorType(INT32, width), [0] * width)
    return builder.shuffle_vector(first, undefined, zeros)


def _as_vector(builder: Any, kind: Any, value: Any, width: int) -> Any:
    return _spread(builder, value, width) if kind == types.float64 else value


Build = Callable[..., Any]
"""Builds the instructions of an operation, from LLVM's builder and values."""


def built(typed: Build) -> Any:
    """Make a compiled function of one that types it and returns how it is built."""
    return intrinsic(typed)


def _register(operation: Any, cases: list[tuple[int, Any, tuple[Any, ...]]], make: Build) -> None:
    """Tell Numba how to type and build an operation: width, result and operands of each case."""
    for width, _, operands in cases:
        _lower(operation, operands, width, make)
    typed: Any = signature
    signatures = [typed(result, *operands) for _, result, operands in cases]
    template = type("Template", (ConcreteTemplate,), {"key": operation, "cases": signatures})
    infer_global(operation)(template)  # type: ignore[no-untyped-call]


def _lower(operation: Any, operands: tuple[Any, ...], width: int, make: Build) -> None:
    @lower_builtin(operation, *operands)  # type: ignore[no-untyped-call,untyped-decorator]
    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        pairs = zip(operands, args, strict=True)
        return make(builder, *(_as_vector(builder, kind, value, width) for kind, value in pairs))


def _binary(operation: Any, results: dict[int, Any], make: Build) -> None:
    _register(
        operation,
        [
            (width, results[width], pair)
            for width, vector in VECTORS.items()
            for pair in ((vector, vector), (vector, types.float64), (types.float64, vector))
        ],
        make,
    )


def _on_masks(operation: Any, operands: int, make: Build) -> None:
    cases = [(width, mask, (mask,) * operands) for width, mask in MASKS.items()]
    _register(operation, cases, make)


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
_register(
    operator.neg,
    [(width, vector, (vector,)) for width, vector in VECTORS.items()],
    lambda builder, a: builder.fneg(a),
)


def _function(name: str) -> Any:
    """Return LLVM's function of each lane, exact or correctly rounded."""

    def typed(context: Any, vector: Any) -> Any:
        def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            width = sig.return_type.width
            kind = ir.FunctionType(floats(width), [floats(width)])
            full = f"llvm.{name}.v{width}f64"
            declared: Any = cgutils.get_or_insert_function
            return builder.call(declared(builder.module, kind, full), args)

        return vector(vector), build

    return built(typed)


square_root, floor, absolute = _function("sqrt"), _function("floor"), _function("fabs")


@built
def larger(context: Any, a: Any, b: Any) -> Any:
    """Return the larger of two vectors, lane by lane; the second where one is no number."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", *args), *args)

    return a(a, b), build


@built
def smaller(context: Any, a: Any, b: Any) -> Any:
    """Return the smaller of two vectors, lane by lane; the second where one is no number."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered("<", *args), *args)

    return a(a, b), build


@built
def select(context: Any, mask: Any, a: Any, b: Any) -> Any:
    """Return, lane by lane, a where the mask is true, else b; one of them may be a float."""
    width = mask.width

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        chosen = (_as_vector(builder, sig.args[i], args[i], width) for i in (1, 2))
        return builder.select(args[0], *chosen)

    return VECTORS[width](mask, a, b), build


@built
def splat(context: Any, value: Any, like: Any) -> Any:
    """Return a vector with a float in every lane."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _spread(builder, args[0], sig.return_type.width)

    return like(types.float64, like), build


@built
def bits(context: Any, mask: Any) -> Any:
    """Return a mask as a whole number: bit l is lane l."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.zext(builder.bitcast(args[0], ir.IntType(sig.args[0].width)), INT64)

    return types.int64(mask), build


@built
def mask_of(context: Any, number: Any, like: Any) -> Any:
    """Return the mask of a whole number, as :func:`bits` gives it."""
    width = like.width

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.bitcast(builder.trunc(args[0], ir.IntType(width)), _truths(width))

    return MASKS[width](types.int64, like), build


@built
def first_of(context: Any, vector: Any) -> Any:
    """Return the float in the first lane."""

    def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], INT32(0))

    return types.float64(vector), build


def _zeros(width: int) -> Any:
    def typed(context: Any) -> Any:
        def build(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return ir.Constant(floats(width), [0.0] * width)

        return VECTORS[width](), build

    return built(typed)


one_lane, four_lanes, eight_lanes = _zeros(1), _zeros(FEW), _zeros(LANES)
