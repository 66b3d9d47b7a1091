"""Expressions as source of a function in Python, C or MATLAB, with common subexpressions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy
from sympy.printing.c import C99CodePrinter
from sympy.printing.pycode import PythonCodePrinter

from kinematics.symbolic.expressions import Sum, number_text, symbols
from kinematics.symbolic.names import ROOTS, Kind, Names


@dataclass(frozen=True)
class Function:
    """A function to write.

    Attributes:
        name: Its name.
        says: Description of its result, in one line.
        shape: Shape of the result: () for a number, (4, 4), (3,), ….
        expressions: Entries of the result, row by row.
    """

    name: str
    says: str
    shape: tuple[int, ...]
    expressions: tuple[Sum, ...]


class _Python(PythonCodePrinter):  # type: ignore[misc]
    def _print_Float(self, value: sympy.Float) -> str:  # noqa: N802
        return repr(float(value))


class _C(C99CodePrinter):  # type: ignore[misc]
    def _print_Float(self, value: sympy.Float) -> str:  # noqa: N802
        return repr(float(value))


class _Matlab(_Python):
    def doprint(self, expression: sympy.Expr) -> str:
        return str(super().doprint(expression)).replace("**", "^")


@dataclass(frozen=True)
class _Body:
    assignments: list[tuple[str, str]]
    results: list[str]
    angles: list[str]
    variables: list[str]
    lengths: list[str]


def python_code(
    functions: Sequence[Function], names: Names, dof: int, *, share: bool = True
) -> str:
    """Return a Python module; lengths are keyword arguments with the table's values.

    Args:
        functions: What to write.
        names: Symbols of the expressions.
        dof: Length of q.
        share: Whether to compute common subexpressions once.
    """
    parts = ["from math import cos, sin, sqrt"]
    for function in functions:
        body = _body(
            function,
            names,
            _Python({"fully_qualified_modules": False}),
            share,
        )
        arguments = "".join(f", {name}={names.lengths[name]!r}" for name in body.lengths)
        lines = [
            f"def {function.name}(q{arguments}):",
            f'    """{function.says}; q: {dof} values, rad and m."""',
        ]
        lines += [f"    {name} = q[{names.variables[name] - 1}]" for name in body.variables]
        lines += [f"    {name} = {_angle(name, names)}" for name in body.angles]
        lines += [f"    {name} = {value}" for name, value in body.assignments]
        lines.append(f"    return {_listed(body.results, function.shape)}")
        parts.append("\n".join(lines))
    return "\n\n\n".join(parts) + "\n"


def c_code(functions: Sequence[Function], names: Names, dof: int, *, share: bool = True) -> str:
    """Return C99 functions that fill ``out`` row by row; lengths are arguments after q.

    Args:
        functions: What to write.
        names: Symbols of the expressions.
        dof: Length of q.
        share: Whether to compute common subexpressions once.
    """
    parts = ["#include <math.h>"]
    for function in functions:
        body = _body(function, names, _C(), share)
        arguments = "".join(f"double {name}, " for name in body.lengths)
        size = len(function.expressions)
        values = ", ".join(f"{name} = {names.lengths[name]!r}" for name in body.lengths)
        shape = " x ".join(map(str, function.shape)) or "one number"
        lines = [
            f"/* {function.says}; q in rad and m{'; ' if values else ''}{values}; out: {shape}. */",
            f"void {function.name}(const double q[{dof}], {arguments}double out[{size}])",
            "{",
        ]
        lines += [
            f"    const double {name} = q[{names.variables[name] - 1}];" for name in body.variables
        ]
        lines += [f"    const double {name} = {_angle(name, names)};" for name in body.angles]
        lines += [f"    const double {name} = {value};" for name, value in body.assignments]
        lines += [f"    out[{k}] = {value};" for k, value in enumerate(body.results)]
        if not (body.angles or body.variables):
            lines.append("    (void)q;")
        parts.append("\n".join([*lines, "}"]))
    return "\n\n".join(parts) + "\n"


def matlab_code(
    functions: Sequence[Function], names: Names, dof: int, *, share: bool = True
) -> str:
    """Return MATLAB functions; lengths are set in them.

    Args:
        functions: What to write.
        names: Symbols of the expressions.
        dof: Length of q.
        share: Whether to compute common subexpressions once.
    """
    parts = []
    for function in functions:
        body = _body(function, names, _Matlab({"fully_qualified_modules": False}), share)
        lines = [
            f"function out = {function.name}(q)",
            f"% {function.says}; q: {dof} values, rad and m.",
        ]
        lines += [f"    {name} = {names.lengths[name]!r};" for name in body.lengths]
        lines += [f"    {name} = q({names.variables[name]});" for name in body.variables]
        lines += [f"    {name} = {_angle(name, names, '({})', first=1)};" for name in body.angles]
        lines += [f"    {name} = {value};" for name, value in body.assignments]
        lines += [*_matlab_result(body.results, function.shape), "end"]
        parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def _matlab_result(values: Sequence[str], shape: tuple[int, ...]) -> list[str]:
    """Return lines that set the result; of several matrices the last index is their number."""
    if len(shape) < 2:
        column = "; ".join(values)
        return [f"    out = [{column}];" if shape else f"    out = {column};"]
    *outer, rows, columns = shape
    size, lines = rows * columns, []
    for k in range(outer[0] if outer else 1):
        grid = [
            ", ".join(values[k * size + i * columns : k * size + (i + 1) * columns])
            for i in range(rows)
        ]
        lines.append(f"    out{f'(:, :, {k + 1})' if outer else ''} = [{grid[0]}")
        lines += [f"        {row}" for row in grid[1:]]
        lines[-1] += "];"
    return lines


def _body(function: Function, names: Names, printer: _Python | _C, share: bool) -> _Body:
    found = sorted(set().union(*map(symbols, function.expressions)), key=names.order)
    kinds = {kind: [name for name in found if names.kind(name) is kind] for kind in Kind}
    table = {name: sympy.Symbol(name) for name in found if name not in ROOTS}
    expressions = [_sympy(expression, table) for expression in function.expressions]
    shared: list[tuple[sympy.Symbol, sympy.Expr]] = []
    if share:
        fresh = sympy.numbered_symbols("t", start=1)
        shared, expressions = sympy.cse(expressions, symbols=fresh, optimizations=None)
    return _Body(
        assignments=[(str(symbol), printer.doprint(value)) for symbol, value in shared],
        results=[printer.doprint(value) for value in expressions],
        angles=kinds[Kind.TRIGONOMETRIC],
        variables=kinds[Kind.VARIABLE],
        lengths=kinds[Kind.LENGTH],
    )


def _sympy(expression: Sum, table: Mapping[str, sympy.Symbol]) -> sympy.Expr:
    terms = []
    for term in expression.terms:
        factors = [_number(number_text(term.coefficient))]
        for factor, exponent in term.factors:
            if isinstance(factor, Sum):
                base = _sympy(factor, table)
            else:
                base = sympy.sqrt(ROOTS[factor]) if factor in ROOTS else table[factor]
            factors.append(base**exponent)
        terms.append(sympy.Mul(*factors))
    return sympy.Add(*terms)


def _number(digits: str) -> sympy.Expr:
    return sympy.Integer(digits) if digits.lstrip("-").isdigit() else sympy.Float(digits, 17)


def _angle(name: str, names: Names, index: str = "[{}]", first: int = 0) -> str:
    angle = names.angles[name[1:]]
    parts = []
    for joint, n in angle.multiples:
        times = "" if abs(n) == 1 else f"{abs(n)}*"
        parts.append(f"{'-' if n < 0 else '+'} {times}q{index.format(joint - 1 + first)}")
    if angle.constant:
        parts.append(f"{'-' if angle.constant < 0 else '+'} {abs(angle.constant)!r}")
    inside = " ".join(parts).removeprefix("+ ")
    inside = f"-{inside[2:]}" if inside.startswith("- ") else inside
    return f"{'cos' if name[0] == 'C' else 'sin'}({inside})"


def _listed(values: Sequence[str], shape: tuple[int, ...], indent: str = "    ") -> str:
    if not shape:
        return values[0]
    if len(shape) == 1:
        return f"[{', '.join(values)}]"
    step = len(values) // shape[0]
    inner = f"{indent}    "
    rows = [_listed(values[k * step : (k + 1) * step], shape[1:], inner) for k in range(shape[0])]
    return "[" + "".join(f"\n{inner}{row}," for row in rows) + f"\n{indent}]"
