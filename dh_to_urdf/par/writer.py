""":class:`DHTable` -> SYMORO ``.par``: readable by OpenSYMORO and ``read_par``."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from dh_to_urdf.cells.notation import angle_text, number_text, variable_cell
from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.par.inertia import PARAMETERS, to_parameters
from dh_to_urdf.par.text import DYNAMICS
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType

_SIGMA = {JointType.PRISMATIC: "1", JointType.FIXED: "2"}
_IDENTITY = np.eye(4)


def table_to_par(table: DHTable) -> str:
    """Write the ``.par`` file of a table.

    A tool becomes one or two fixed frames (sigma = 2) after the last. Links without known inertia
    get SYMORO's own symbols (``XX1`` …). Names and limits are written in comments.

    Args:
        table: A khalil table, or a modified one, which is khalil with γ = b = 0.

    Raises:
        DHError: The table is standard, or its name cannot stand in the file.
    """
    if table.convention is Convention.STANDARD:
        raise DHError.single(
            ("convention",),
            say(
                "a .par file holds the khalil convention, and this table is standard; convert it to"
                " khalil or modified first"
            ),
        )
    tool = _tool_rows(table)
    rows = (*table.rows, *tool)
    serial = all(row.parent == k for k, row in enumerate(rows))
    n = len(rows)
    lines = [f"(* Robotname = '{table.name}' *)"]
    lines += [f"NL = {n}", f"NJ = {n}", f"NF = {n}", f"Type = {0 if serial else 1}"]
    lines += ["is_floating = 0", "is_mobile = 0", "", "(* Geometric parameters *)"]
    columns = [_geometry(table, k, row) for k, row in enumerate(rows, start=1)]
    lines += [_list(key, [column[key] for column in columns]) for key in columns[0]]
    for k, row in enumerate(table.rows, start=1):
        lines += _notes(k, row)
    lines += [f"(* Frame {k}: tool *)" for k in range(len(table.rows) + 1, n + 1)]
    lines += ["", "(* Dynamic parameters and external forces *)"]
    links = [_dynamics(k, row, k > len(table.rows)) for k, row in enumerate(rows, start=1)]
    lines += [_list(key, [link[key] for link in links]) for key in DYNAMICS]
    lines += ["", "(* Joint parameters *)"]
    lines += [_list(key, [f"{key}{k}" for k in range(1, n + 1)]) for key in ("QP", "QDP", "GAM")]
    lines += ["", "(* Velocity and acceleration of the base *)"]
    lines += [_list(key, ["0", "0", "0"]) for key in ("W0", "WP0", "V0", "VP0")]
    lines += ["", "(* Acceleration of gravity *)", _list("G", ["0", "0", "G3"])]
    lines += ["", "(* Transformation of 0 frame position fT0 *)"]
    lines += [_list("Z", [number_text(float(value)) for value in table.base.ravel()])]
    return "\n".join([*lines, "", "(* End of definition *)", ""])


def _list(key: str, entries: list[str]) -> str:
    return f"{key} = {{{','.join(entries)}}}"


def _geometry(table: DHTable, k: int, row: DHRow) -> dict[str, str]:
    theta, r = angle_text(row.theta), number_text(row.d)
    if row.type.is_revolute:
        theta = variable_cell(table, k - 1, "th", "r")
    elif row.type is JointType.PRISMATIC:
        r = variable_cell(table, k - 1, "th", "r")
    return {
        "ant": str(row.parent),
        "sigma": _SIGMA.get(row.type, "0"),
        "b": number_text(row.b),
        "d": number_text(row.a),
        "r": r,
        "gamma": angle_text(row.gamma),
        "alpha": angle_text(row.alpha),
        "mu": "0" if row.type is JointType.FIXED else "1",
        "theta": theta,
    }


def _notes(k: int, row: DHRow) -> list[str]:
    items = [f"name = '{row.name}'"] if row.name != f"j{k}" else []
    if row.type is JointType.CONTINUOUS:
        items.append("type = continuous")
    for key in ("lower", "upper", "velocity", "effort"):
        limit = getattr(row.limits, key)
        if limit is not None:
            items.append(f"{key} = {number_text(limit)}")
    if not row.visual:
        items.append("visual = false")
    return [f"(* Joint {k}: {', '.join(items)} *)"] if items else []


def _dynamics(k: int, row: DHRow, tool: bool) -> dict[str, str]:
    fixed = row.type is JointType.FIXED
    link = dict.fromkeys(DYNAMICS, "0")
    if row.inertial is not None:
        parameters = to_parameters(row.inertial)
        link.update({key: number_text(value) for key, value in parameters.items()})
    elif not tool:
        link.update({key: f"{key}{k}" for key in PARAMETERS})
    if not fixed:
        link.update({key: f"{key}{k}" for key in ("IA", "FV", "FS")})
    return link


def _tool_rows(table: DHTable) -> tuple[DHRow, ...]:
    """Return the tool as fixed khalil rows: a translation, then a rotation.

    ``Rz(γ) Tz(b) Tx(d) Rz(θ)`` with ``θ = -γ`` is any translation, and ``Rz(γ) Rx(α) Rz(θ)`` any
    rotation. One row could hold both, but is ill-conditioned where α is small.
    """
    if np.array_equal(table.tool, _IDENTITY):
        return ()
    R, (x, y, z) = table.tool[:3, :3], table.tool[:3, 3].tolist()
    row = DHRow("tool", JointType.FIXED, 0.0, 0.0, 0.0, 0.0, table.tip_row)
    across = math.atan2(y, x) if x or y else 0.0
    shift = replace(row, a=math.hypot(x, y), b=z, gamma=across, theta=-across)
    gamma, alpha, theta = _euler_zxz(R)
    turn = replace(row, gamma=gamma, alpha=alpha, theta=theta)
    if alpha == 0.0:
        return (replace(shift, theta=theta - across),)
    if not (x or y or z):
        return (turn,)
    return (shift, replace(turn, parent=len(table.rows) + 1))


def _euler_zxz(R: Matrix) -> tuple[float, float, float]:
    """Return γ, α, θ (rad) of ``R = Rz(γ) Rx(α) Rz(θ)``; γ = 0 where α is 0 or π.

    α and θ are computed from R without γ, so that the product is R near α = 0 too.
    """
    (r11, r12, r13), (r21, r22, r23), (_, _, r33) = R.tolist()
    gamma = math.atan2(r13, -r23) if math.hypot(r13, r23) > 3e-16 else 0.0
    cos, sin = math.cos(gamma), math.sin(gamma)
    alpha = math.atan2(sin * r13 - cos * r23, r33) if math.hypot(r13, r23) > 3e-16 else 0.0
    if r33 < 0 and alpha == 0.0:
        alpha = math.pi
    return gamma, alpha, math.atan2(-(cos * r12 + sin * r22), cos * r11 + sin * r21)
