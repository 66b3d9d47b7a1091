"""Answers evaluated: every formula is read as Python, nothing of the package helps."""

import math
from pathlib import Path
from subprocess import run
from types import SimpleNamespace

import numpy as np

from kinematics.symbolic import Quantity, SymbolicRequest
from kinematics.symbolic.request import checked
from kinematics.symbolic.writing import Writing


def written(table, *quantities, **options):
    """The simplified answer, made in this process."""
    asked = tuple(Quantity(name) for name in quantities) or tuple(Quantity)
    writing = Writing(table, checked(table, SymbolicRequest(quantities=asked, **options)))
    writing.plain()
    writing.simplify()
    return writing.answer()


def plain(table, *quantities, **options):
    """The answer before simplification."""
    asked = tuple(Quantity(name) for name in quantities) or tuple(Quantity)
    writing = Writing(table, checked(table, SymbolicRequest(quantities=asked, **options)))
    writing.plain()
    return writing.answer()


def evaluator(answer, q):
    """A function from nested formulas to arrays of shape (n, …), at q of shape (n, dof)."""
    scope = {"cos": np.cos, "sin": np.sin, "sqrt": math.sqrt, "pi": math.pi, **answer["values"]}
    scope |= {f"q{k}": column for k, column in enumerate(q.T, start=1)}
    for name, definition in answer["definitions"].items():
        scope[name] = eval(definition, {"__builtins__": {}}, scope)

    def value(formula):
        if isinstance(formula, str):
            found = eval(formula, {"__builtins__": {}}, scope)
            return np.broadcast_to(np.asarray(found, dtype=float), (len(q),))
        items = formula.values() if isinstance(formula, dict) else formula
        return np.stack([value(item) for item in items], axis=1)

    return value


def python_functions(code):
    """What a module of Python defines."""
    scope = {}
    exec(compile(code, "generated", "exec"), scope)
    return SimpleNamespace(**{name: item for name, item in scope.items() if name[0] != "_"})


def c_program(code, calls, folder: Path, compiler):
    """Compiles C with a main that prints what calls leave in ``out``; the numbers."""
    body = "\n".join(
        f"  {{ double out[{size}]; {call}; for (int k = 0; k < {size}; k++)"
        ' printf("%.17g\\n", out[k]); }'
        for call, size in calls
    )
    source = folder / "generated.c"
    source.write_text(f"#include <stdio.h>\n{code}\nint main(void) {{\n{body}\n  return 0;\n}}\n")
    program = folder / "generated"
    flags = ["-std=c99", "-Wall", "-Werror", "-Wno-unused-variable"]
    run([compiler, *flags, str(source), "-o", str(program), "-lm"], check=True)
    printed = run([str(program)], check=True, capture_output=True, text=True).stdout
    return np.array([float(line) for line in printed.split()])
