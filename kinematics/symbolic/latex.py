"""Matrices in LaTeX with amsmath."""

from __future__ import annotations

from collections.abc import Sequence

WIDEST = 10
"""Columns of a ``bmatrix``: amsmath's MaxMatrixCols, beyond which it stops with an error."""


def bracketed(rows: Sequence[Sequence[str]]) -> str:
    r"""Return a matrix of entries in LaTeX: a ``bmatrix``, or a wide one as ``array``."""
    body = " \\\\\n".join(" & ".join(row) for row in rows)
    columns = max((len(row) for row in rows), default=0)
    if columns <= WIDEST:
        return f"\\begin{{bmatrix}}\n{body}\n\\end{{bmatrix}}"
    begin = f"\\left[\\begin{{array}}{{{'c' * columns}}}"
    return f"{begin}\n{body}\n\\end{{array}}\\right]"
