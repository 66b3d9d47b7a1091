"""Numbers, matrices and tables in LaTeX, for plain pdflatex with amsmath."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from app.http.problems import INVALID_REQUEST, RequestProblem
from app.sheets.sheet import Sheet, cell
from dh_to_urdf.messages import say
from kinematics.symbolic.latex import bracketed
from robots.robot import FloatArray

DECIMALS = 6
"""Decimals of numbers where a request names none."""
NOISE = 1e-12
"""What is smaller is rounding, and is written as 0."""
BIG = 1e6
"""Numbers from here on are written with a power of ten."""
MAX_ROWS = 1_000
MAX_MATRICES = 200
_SMALL = (
    "alpha",
    "beta",
    "gamma",
    "delta",
    "epsilon",
    "zeta",
    "eta",
    "theta",
    "iota",
    "kappa",
    "lambda",
    "mu",
    "nu",
    "xi",
    "pi",
    "rho",
    "sigma",
    "tau",
    "upsilon",
    "phi",
    "chi",
    "psi",
    "omega",
)
_CAPITAL = (
    "Gamma",
    "Delta",
    "Theta",
    "Lambda",
    "Xi",
    "Pi",
    "Sigma",
    "Upsilon",
    "Phi",
    "Psi",
    "Omega",
)
_SPECIAL = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    "°": r"$^\circ$",
    **{letter: f"\\{letter}" for letter in "#$%&_"},
    **{
        letter: f"$\\{name}$"
        for letter, name in zip("αβγδεζηθικλμνξπρστυφχψω", _SMALL, strict=True)
    },
    **{letter: f"$\\{name}$" for letter, name in zip("ΓΔΘΛΞΠΣΥΦΨΩ", _CAPITAL, strict=True)},
}
_KNOWN_TO_LATEX = 0x17F
"""The last letter that plain pdflatex sets as it stands, with accents of Latin scripts."""
_NOT_IN_OT1 = frozenset("ÐÞðþĄąĐđĘęĦħĮįĸĿŀŉŊŋŦŧŲųſ×÷")
"""Letters among these that its standard encoding of fonts has not."""


def escaped(text: str) -> str:
    """Return a text that LaTeX sets as it stands; letters of other scripts by their number."""
    parts = []
    for letter in text:
        if letter in _SPECIAL:
            parts.append(_SPECIAL[letter])
        elif _is_set_as_it_stands(letter):
            parts.append(letter)
        else:
            parts.append(" " if letter.isspace() else f"U+{ord(letter):04X}")
    found = "".join(parts)
    # After the end of a row, LaTeX takes [ and * for an option.
    return f"{{{found[0]}}}{found[1:]}" if found[:1] in ("[", "*") else found


def _is_set_as_it_stands(letter: str) -> bool:
    if letter.isascii():
        return letter.isprintable()
    return 0xC0 <= ord(letter) <= _KNOWN_TO_LATEX and letter not in _NOT_IN_OT1


def number(value: float, digits: int | None = None) -> str:
    r"""Return a number for math mode: ``0.25``, ``1.5 \cdot 10^{-9}``, ``\infty``.

    Args:
        value: The number.
        digits: Decimals, all of them written; None: six at most.
    """
    if not math.isfinite(value):
        return "-" if math.isnan(value) else r"\infty" if value > 0 else r"-\infty"
    if abs(value) < NOISE:
        value = 0.0
    decimals = DECIMALS if digits is None else digits
    small = digits is None and 0.0 < abs(value) < 10.0**-DECIMALS
    if small or abs(value) >= BIG:
        mantissa, _, exponent = f"{value:.{min(decimals, DECIMALS)}e}".partition("e")
        plain = mantissa.rstrip("0").rstrip(".") if digits is None else mantissa
        return rf"{plain} \cdot 10^{{{int(exponent)}}}"
    text = f"{round(value, decimals) + 0.0:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if digits is None and "." in text else text


def equation(label: str, array: FloatArray, digits: int | None = None) -> str:
    r"""Return ``\[ label = … \]`` of a matrix, shape (m, n)."""
    rows = [[number(float(value), digits) for value in row] for row in np.atleast_2d(array)]
    return f"\\[ {label} = {bracketed(rows)} \\]\n"


def equations(labels: Sequence[str], arrays: FloatArray, digits: int | None = None) -> str:
    """Return an equation for each matrix, shape (k, m, n).

    Raises:
        RequestProblem: They are more than anybody pastes into a report.
    """
    if len(labels) > MAX_MATRICES:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "{count} matrices are too many for LaTeX; give at most {max_matrices},"
                " or ask for csv",
                count=len(labels),
                max_matrices=MAX_MATRICES,
            ),
            "/format",
        )
    pairs = zip(labels, arrays, strict=True)
    return "".join(equation(label, one, digits) for label, one in pairs)


def comment(text: str) -> str:
    """Return a line that LaTeX passes over."""
    return f"% {' '.join(text.split())}\n"


def tabular(sheet: Sheet, digits: int | None = None, warnings: Sequence[str] = ()) -> str:
    """Return a table as a ``tabular``; warnings are comments after it.

    Raises:
        RequestProblem: It has more rows than anybody pastes into a report.
    """
    if len(sheet) > MAX_ROWS:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "{count} rows are too many for LaTeX; give at most {max_rows}, or ask for csv",
                count=len(sheet),
                max_rows=MAX_ROWS,
            ),
            "/format",
        )
    lines = [f"\\begin{{tabular}}{{{'r' * len(sheet.columns)}}}", "\\hline"]
    lines.append(" & ".join(map(escaped, sheet.headings)) + " \\\\ \\hline")
    lines += [" & ".join(_cell(value, digits) for value in row) + " \\\\" for row in sheet.rows()]
    lines += ["\\hline", "\\end{tabular}", ""]
    return "\n".join(lines) + "".join(map(comment, warnings))


def _cell(value: object, digits: int | None) -> str:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        text = str(value) if isinstance(value, int) else number(value, digits)
        return f"${text}$"
    return escaped(str(cell(value, digits)))
