"""The link matrix of each convention in general: alpha, a, d and theta as symbols."""

from __future__ import annotations

import re
from dataclasses import dataclass

from dh_to_urdf.table import Convention
from kinematics.symbolic.latex import bracketed

_BEFORE = "i-1"


@dataclass(frozen=True)
class LinkMatrix:
    """A link matrix in symbols.

    Attributes:
        convention: The convention.
        label: What it is called, in LaTeX.
        product: The elementary transformations, from left to right.
        matrix: Entries in text that is valid in Python, 4x4.
        index: Index of each symbol: ``i`` or ``i-1``.
        source: Where it stands.
    """

    convention: Convention
    label: str
    product: tuple[str, ...]
    matrix: tuple[tuple[str, ...], ...]
    index: dict[str, str]
    source: str

    def latex_matrix(self) -> list[list[str]]:
        """Return the entries in LaTeX."""
        return [[self._latex(entry) for entry in row] for row in self.matrix]

    def latex(self) -> str:
        r"""Return ``\[ A_i = … \]`` twice: the product, and the matrix."""
        factors = [re.sub(r"\((\w), (\w+)\)", self._factor, one) for one in self.product]
        product = r" \, ".join(factors).replace("Rot", r"\mathrm{Rot}")
        product = product.replace("Trans", r"\mathrm{Trans}")
        matrix = bracketed(self.latex_matrix())
        return f"\\[ {self.label} = {product} \\]\n\\[ {self.label} = {matrix} \\]\n"

    def text(self) -> str:
        """Return lines for a terminal: product and aligned matrix."""
        widths = [max(map(len, column)) for column in zip(*self.matrix, strict=True)]
        lines = [f"# {self.convention}: {' '.join(self.product)}"]
        lines.append("# " + ", ".join(f"{name}: row {row}" for name, row in self.index.items()))
        for k, row in enumerate(self.matrix):
            start = "A = [[" if k == 0 else "     ["
            cells = ", ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True))
            lines.append(f"{start}{cells}{']]' if k == 3 else '],'}")
        return "\n".join(lines) + "\n"

    def _symbol(self, name: str) -> str:
        letter = f"\\{name}" if name in ("alpha", "theta") else name
        return f"{letter}_{{{self.index[name]}}}"

    def _factor(self, found: re.Match[str]) -> str:
        return f"({found[1]}, {self._symbol(found[2])})"

    def _latex(self, entry: str) -> str:
        def written(found: re.Match[str]) -> str:
            return f"\\{found[1]} {self._symbol(found[2])}" if found[1] else self._symbol(found[2])

        names = "|".join(self.index)
        pattern = rf"(?:(cos|sin)\()?\b({names})\b\)?"
        return re.sub(pattern, written, entry).replace("*", r" \, ")


_MODIFIED = (
    ("cos(theta)", "-sin(theta)", "0", "a"),
    ("sin(theta)*cos(alpha)", "cos(theta)*cos(alpha)", "-sin(alpha)", "-d*sin(alpha)"),
    ("sin(theta)*sin(alpha)", "cos(theta)*sin(alpha)", "cos(alpha)", "d*cos(alpha)"),
    ("0", "0", "0", "1"),
)
_KHALIL = tuple(
    tuple({"a": "d"}.get(entry, re.sub(r"\bd\b", "r", entry)) for entry in row) for row in _MODIFIED
)

LINK_MATRICES = {
    Convention.STANDARD: LinkMatrix(
        Convention.STANDARD,
        "A_i",
        ("Rot(z, theta)", "Trans(z, d)", "Trans(x, a)", "Rot(x, alpha)"),
        (
            ("cos(theta)", "-sin(theta)*cos(alpha)", "sin(theta)*sin(alpha)", "a*cos(theta)"),
            ("sin(theta)", "cos(theta)*cos(alpha)", "-cos(theta)*sin(alpha)", "a*sin(theta)"),
            ("0", "sin(alpha)", "cos(alpha)", "d"),
            ("0", "0", "0", "1"),
        ),
        {"theta": "i", "d": "i", "a": "i", "alpha": "i"},
        "Denavit and Hartenberg (1955); Paul, Robot Manipulators (1981), ch. 2",
    ),
    Convention.MODIFIED: LinkMatrix(
        Convention.MODIFIED,
        r"{}^{i-1}T_i",
        ("Rot(x, alpha)", "Trans(x, a)", "Rot(z, theta)", "Trans(z, d)"),
        _MODIFIED,
        {"alpha": _BEFORE, "a": _BEFORE, "theta": "i", "d": "i"},
        "Craig, Introduction to Robotics, ch. 3",
    ),
    Convention.KHALIL: LinkMatrix(
        Convention.KHALIL,
        r"{}^{i-1}T_i",
        ("Rot(x, alpha)", "Trans(x, d)", "Rot(z, theta)", "Trans(z, r)"),
        _KHALIL,
        {"alpha": "i", "d": "i", "theta": "i", "r": "i"},
        "Khalil and Kleinfinger (1986); in a tree Rot(z, gamma) Trans(z, b) before it",
    ),
}
"""The link matrix of each convention."""
