"""Results as an answer: nested lists of strings, a listing, or source code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from dh_to_urdf.table import DHTable
from kinematics.symbolic.code import Function, c_code, matlab_code, python_code
from kinematics.symbolic.expressions import Product, Sum, latex, symbols, text
from kinematics.symbolic.inverse import Inverse
from kinematics.symbolic.names import Kind, Names
from kinematics.symbolic.quantities import Determinant, Entries, Minor, Work
from kinematics.symbolic.request import Notation, Quantity, SymbolicRequest
from kinematics.task import ROWS

Writer: TypeAlias = Callable[[Sum], str]

_FUNCTIONS = {
    Quantity.A: ("link_matrices", "Link matrices A_k"),
    Quantity.T0: ("partial_products", "Products 0A_k in frame_0"),
    Quantity.T: ("fk", "Pose of {frame} in {base}, 4x4"),
    Quantity.POSITION: ("position", "Origin of {frame} in {base}"),
    Quantity.ROTATION: ("rotation", "Axes of {frame} in {base}, as columns"),
    Quantity.JACOBIAN: (
        "jacobian",
        "Geometric Jacobian of {frame} in the axes of {expressed_in}, {rows}",
    ),
}


def view(entries: Entries, write: Writer) -> Any:
    """Return a quantity as nested lists of strings."""
    grids = [[[write(entry) for entry in row] for row in grid] for grid in entries.written]
    if entries.quantity in (Quantity.A, Quantity.T0):
        return grids
    (grid,) = grids
    if entries.quantity is Quantity.POSITION:
        return dict(zip("XYZ", (row[0] for row in grid), strict=True))
    if entries.quantity is Quantity.ROTATION:
        return {axis: [row[j] for row in grid] for j, axis in enumerate("xyz")}
    return grid


def determinant_view(
    found: Determinant, names: Sequence[str], write: Writer, work: Work
) -> dict[str, Any]:
    """Return det J as it was found; J itself where its determinant was not found.

    Args:
        found: The determinants.
        names: Names of the joints.
        write: Writer of expressions.
        work: Simplifies the entries of J.
    """
    square = len(found.minors) == 1
    answer: dict[str, Any] = {
        "rows": [ROWS[i] for i in found.rows],
        "columns": [names[joint - 1] for joint in found.joints],
        "note": found.note,
    }
    if square:
        return answer | _minor_view(found.minors[0], write, work)
    minors = [
        {
            "without": [names[joint - 1] for joint in minor.without],
            **_minor_view(minor, write, work),
        }
        for minor in found.minors
    ]
    return answer | {"expression": None, "minors": minors}


def _minor_view(minor: Minor, write: Writer, work: Work) -> dict[str, Any]:
    if minor.expression is not None:
        factors = [
            {"factor": write(_alone(factor)), "exponent": exponent}
            for term in minor.expression.terms
            for factor, exponent in term.factors
        ]
        return {"expression": write(minor.expression), "factors": factors}
    if minor.sparse is None:
        return {"expression": None}
    return {
        "expression": None,
        "determinant_of": {
            "matrix": [[write(work.simple(p)) for p in row] for row in minor.sparse.matrix],
            "expressed_in": minor.sparse.axes,
            "at_origin_of": minor.sparse.point,
        },
    }


def inverse_view(inverse: Inverse, names: Sequence[str], write: Writer) -> dict[str, Any] | None:
    """Return an inverse: its matrix, and what that is divided by; None where there is none."""
    if not inverse.written:
        return None
    return {
        "matrix": [[write(entry) for entry in row] for row in inverse.written],
        "divisor": write(inverse.over),
        "rows": [names[joint - 1] for joint in inverse.joints],
        "columns": [ROWS[i] for i in inverse.rows],
    }


def _alone(factor: str | Sum) -> Sum:
    return factor if isinstance(factor, Sum) else Sum((Product(1, ((factor, 1),)),))


def used_symbols(
    entries: Sequence[Entries], determinant: Determinant | None, inverse: Inverse | None
) -> set[str]:
    """Return every symbol that occurs."""
    found: set[str] = set()
    if inverse is not None:
        found |= symbols(inverse.over)
        for row in inverse.written:
            found = found.union(*map(symbols, row))
    for one in entries:
        for grid in one.written:
            for row in grid:
                found = found.union(*map(symbols, row))
    for minor in determinant.minors if determinant else ():
        if minor.expression is not None:
            found |= symbols(minor.expression)
        elif minor.sparse is not None:
            for line in minor.sparse.matrix:
                found = found.union(*(entry.symbols() for entry in line))
    return found


def definitions(used: set[str], names: Names) -> dict[str, str]:
    """Return ``{"C1": "cos(q1)", …}``, from the base to the tip."""
    turning = [name for name in used if names.kind(name) is Kind.TRIGONOMETRIC]
    return {name: names.definition(name) for name in sorted(turning, key=names.order)}


def source(
    table: DHTable,
    request: SymbolicRequest,
    entries: Sequence[Entries],
    determinant: Determinant | None,
    inverse: Inverse | None,
    names: Names,
    *,
    share: bool,
) -> str:
    """Return the quantities as functions of Python, C or MATLAB."""
    functions = []
    words = {
        "frame": request.frame,
        "base": request.base,
        "expressed_in": request.expressed_in or request.base,
        "rows": "linear rows first"
        if request.task is None
        else f"rows {', '.join(request.task.row_names)}",
    }
    for one in entries:
        name, says = _FUNCTIONS[one.quantity]
        grids = one.written
        shape: tuple[int, ...] = (len(grids[0]), len(grids[0][0]))
        if one.quantity in (Quantity.A, Quantity.T0):
            shape = (len(grids), *shape)
        elif one.quantity is Quantity.POSITION:
            shape = (3,)
        flat = tuple(entry for grid in grids for row in grid for entry in row)
        functions.append(Function(name, says.format(**words), shape, flat))
    if determinant is not None and determinant.minors and determinant.found:
        functions.append(_determinant_function(determinant))
    if inverse is not None and inverse.written:
        functions += _inverse_functions(inverse)
    write = {
        Notation.PYTHON: python_code,
        Notation.C: c_code,
        Notation.MATLAB: matlab_code,
    }[request.notation]
    return write(functions, names, table.dof, share=share)


def _determinant_function(determinant: Determinant) -> Function:
    rows = ", ".join(ROWS[i] for i in determinant.rows)
    expressions = tuple(minor.expression or Sum() for minor in determinant.minors)
    if len(expressions) == 1:
        return Function("det_jacobian", f"det J of the rows {rows}", (), expressions)
    left_out = "; ".join(
        "without " + ", ".join(f"q{joint}" for joint in minor.without)
        for minor in determinant.minors
    )
    says = f"Minors of J, rows {rows}: {left_out}"
    return Function("jacobian_minors", says, (len(expressions),), expressions)


def _inverse_functions(inverse: Inverse) -> list[Function]:
    rows, size = ", ".join(ROWS[i] for i in inverse.rows), len(inverse.rows)
    flat = tuple(entry for row in inverse.written for entry in row)
    return [
        Function(
            "inverse_jacobian_matrix",
            f"The inverse of J, rows {rows}, times inverse_jacobian_divisor",
            (size, size),
            flat,
        ),
        Function(
            "inverse_jacobian_divisor",
            f"What inverse_jacobian_matrix is divided by: det J of the rows {rows}",
            (),
            (inverse.over,),
        ),
    ]


def writer_of(notation: Notation) -> Writer:
    """Return the writer of an answer's entries: LaTeX, else short names."""
    return latex if notation is Notation.LATEX else text


def characters(entries: Entries, write: Writer) -> int:
    """Return the length of a quantity as text."""
    return sum(len(write(entry)) for grid in entries.written for row in grid for entry in row)
