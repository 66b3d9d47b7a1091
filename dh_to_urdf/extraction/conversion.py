"""Conversion of tables between conventions, whose axes and common normals are the same.

``Rz(θ_k) Tz(d_k) Tx(a_k) Rx(α_k)`` is row k of a standard table. A modified table has the same
product, split elsewhere: its row k is ``Tx(a_{k-1}) Rx(α_{k-1}) Rz(θ_k) Tz(d_k)``. So a and α
move by one row, the last ones into the tool, without computation (Craig, *Introduction to
Robotics*, section 3.4; Khalil and Dombre, *Modeling, Identification and Control of Robots*,
section 3.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.matrices import branch_matrix
from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, Inertial, JointType


def to_convention(table: DHTable, convention: Convention, tip: str | None = None) -> DHTable:
    """Convert a table to another convention with the same q, limits, masses and tool pose.

    Args:
        table: The table. A Khalil table that is a tree is cut down to the chain to ``tip``.
        convention: What to write it in.
        tip: Name of the joint, or ``frame_k``, that the chain of a tree ends at; the tool of the
            table is kept only where it sits there. Default: the whole table.

    Returns:
        The table, serial unless nothing had to be changed.

    Raises:
        DHError: The table is a tree and no tip is named, or the tip is unknown.
    """
    if tip is not None:
        table = chain_to(table, tip)
    if convention is table.convention:
        return table
    if not is_serial(table):
        leaves = ", ".join(_leaves(table)[:8])
        raise DHError.single(
            ("tip",),
            say(
                "the table is a tree, which only khalil can write; name the tip of one"
                " chain ({leaves})",
                leaves=leaves,
            ),
        )
    if table.convention is Convention.KHALIL:
        table = _without_branches(table)
    if Convention.STANDARD not in (table.convention, convention):
        return replace(table, convention=convention)
    if convention is Convention.STANDARD:
        return _standard(table)
    return _modified(table, convention)


def is_serial(table: DHTable) -> bool:
    """Return True where every row follows the row before it."""
    return all(row.parent == k for k, row in enumerate(table.rows))


def chain_to(table: DHTable, tip: str) -> DHTable:
    """Return the chain of a tree from its base to one frame, as a table.

    Args:
        table: The table.
        tip: Name of a joint, or ``frame_k``.

    Returns:
        The rows of the chain; ``q`` holds their joints only.

    Raises:
        DHError: There is no such joint or frame.
    """
    k = _row_number(table, tip)
    tool = table.tool if k == table.tip_row else np.eye(4)
    path: list[int] = []
    while k > 0:
        path.append(k)
        k = table.rows[k - 1].parent
    rows = [replace(table.rows[k - 1], parent=n) for n, k in enumerate(reversed(path))]
    names = {row.name for row in rows}
    for row in rows:
        others = [row.mimic.joint] if row.mimic is not None else []
        for name in (*others, *(name for name, _ in row.coupling)):
            if name not in names:
                raise DHError.single(
                    ("tip",),
                    say(
                        "joint {row} depends on {name}, which is not between the base and"
                        " {tip}; name a tip after it",
                        row=row.name,
                        name=name,
                        tip=quoted(tip),
                    ),
                )
    return replace(table, rows=tuple(rows), tool=tool)


def _row_number(table: DHTable, tip: str) -> int:
    for k, row in enumerate(table.rows, start=1):
        if tip in (row.name, f"frame_{k}"):
            return k
    if tip == "tool":
        return table.tip_row
    names = ", ".join(row.name for row in table.rows[:12])
    raise DHError.single(
        ("tip",),
        say("tip is {tip}; name a joint ({names}) or frame_k", tip=quoted(tip), names=names),
    )


def _leaves(table: DHTable) -> list[str]:
    parents = {row.parent for row in table.rows}
    return [row.name for k, row in enumerate(table.rows, start=1) if k not in parents]


def _without_branches(table: DHTable) -> DHTable:
    """Move Khalil's γ and b of a serial table into the row before, whose z they share."""
    base, rows = table.base, list(table.rows)
    for k, row in enumerate(rows):
        if row.gamma == 0.0 and row.b == 0.0:
            continue
        branch = branch_matrix(row)
        rows[k] = replace(row, gamma=0.0, b=0.0)
        if k == 0:
            base = base @ branch
        else:
            rows[k - 1] = _turned(rows[k - 1], row.gamma, row.b)
    return replace(table, base=base, rows=tuple(rows))


def _turned(row: DHRow, angle: float, length: float) -> DHRow:
    """Return a row whose frame is turned about and moved along its own z."""
    is_revolute, slides = row.type.is_revolute, row.type is JointType.PRISMATIC
    own = angle if is_revolute else length if slides else 0.0
    kept = tuple(pair for pair in row.symbols if pair[0] != "d" or slides or not length)
    return replace(
        row,
        symbols=kept,
        theta=row.theta if is_revolute else row.theta + angle,
        d=row.d if slides else row.d + length,
        offset=row.offset + own,
        inertial=_moved(row.inertial, branch_matrix(replace(row, gamma=-angle, b=-length))),
    )


def _modified(table: DHTable, convention: Convention) -> DHTable:
    """Convert standard to modified or khalil; a base ``Tx Rx`` becomes a and α of row 1."""
    base = table.base
    a, alpha, name = 0.0, 0.0, ""
    if (found := _along_x(base)) is not None:
        (a, alpha), base = found, np.eye(4)
    rows = []
    for row in table.rows:
        inertial = _moved(row.inertial, _x_matrix(row.a, row.alpha))
        symbols = _with_name_of_a(row, name)
        rows.append(replace(row, a=a, alpha=alpha, inertial=inertial, symbols=symbols))
        a, alpha, name = row.a, row.alpha, dict(row.symbols).get("a", "")
    tool = _x_matrix(a, alpha) @ table.tool
    return replace(table, convention=convention, base=base, rows=tuple(rows), tool=tool)


def _standard(table: DHTable) -> DHTable:
    """Convert modified to standard; a tool ``Tx Rx`` becomes a and α of the last row."""
    tool = table.tool
    a, alpha, name = 0.0, 0.0, ""
    if (found := _along_x(tool)) is not None:
        (a, alpha), tool = found, np.eye(4)
    rows: list[DHRow] = []
    for row in reversed(table.rows):
        back = _x_matrix(-a, -alpha)
        symbols, inertial = _with_name_of_a(row, name), _moved(row.inertial, back)
        rows.append(replace(row, a=a, alpha=alpha, inertial=inertial, symbols=symbols))
        a, alpha, name = row.a, row.alpha, dict(row.symbols).get("a", "")
    base = table.base @ _x_matrix(a, alpha)
    standard = Convention.STANDARD
    return replace(table, convention=standard, base=base, rows=tuple(reversed(rows)), tool=tool)


def _with_name_of_a(row: DHRow, name: str) -> tuple[tuple[str, str], ...]:
    """Return the names of a row's lengths with another one for a; empty for none."""
    rest = tuple(pair for pair in row.symbols if pair[0] != "a")
    return (("a", name), *rest) if name else rest


def _x_matrix(a: float, alpha: float) -> Matrix:
    """Return ``Tx(a) Rx(α)``, 4x4."""
    T = np.eye(4)
    cos, sin = np.cos(alpha), np.sin(alpha)
    T[1:3, 1:3] = [[cos, -sin], [sin, cos]]
    T[0, 3] = a
    return T


def _along_x(T: Matrix) -> tuple[float, float] | None:
    """Return (a, α) of a placement that is exactly ``Tx(a) Rx(α)``, else None."""
    a, alpha = float(T[0, 3]), float(np.arctan2(T[2, 1], T[1, 1]))
    return (a, alpha) if np.abs(T - _x_matrix(a, alpha)).max() <= 1e-15 else None


def _moved(inertial: Inertial | None, T: Matrix) -> Inertial | None:
    """Return a body given in frame k in a frame where frame k has placement T."""
    if inertial is None or np.array_equal(T, np.eye(4)):
        return inertial
    R = T[:3, :3]
    com = R @ inertial.com + T[:3, 3]
    inertia = R @ np.array(inertial.inertia) @ R.T
    return replace(inertial, com=_triple(com), inertia=tuple(_triple(row) for row in inertia))


def _triple(values: Sequence[float] | Matrix) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
