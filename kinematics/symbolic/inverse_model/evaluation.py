"""The function of a derivation run at a few targets, before it is given to anyone."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dh_to_urdf.matrices import dh_matrices
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import DHTable
from kinematics.symbolic.inverse_model.python import Python
from kinematics.symbolic.inverse_model.statements import Derivation

TOLERANCE = 1e-7
"""Largest difference of poses, m or 1, relative to the arm: twists may have been rounded."""

SWIVELS = 24
"""At some of them an arm whose twists are no right angles has no solution."""


def evaluated(derivation: Derivation, table: DHTable, samples: Matrix) -> bool:
    """Return whether the function's solutions reach the targets of some q, and hold these q.

    Args:
        derivation: The derivation.
        table: The table it is of.
        samples: Shape (n, dof).
    """
    scope: dict[str, Any] = {}
    exec(compile(Python(derivation).source(), "inverse_model", "exec"), scope)
    try:
        return _holds(derivation, table, samples, scope["inverse_model"])
    except ArithmeticError:
        return False


def _holds(
    derivation: Derivation, table: DHTable, samples: Matrix, function: Callable[..., Any]
) -> bool:
    position_only = derivation.kind in ("planar_2r", "three_joints")
    for q in samples:
        T = _pose(table, q, derivation)
        if derivation.swivel:
            found = [
                one
                for swivel in np.linspace(-np.pi, np.pi, SWIVELS, endpoint=False)
                for one in function(T.tolist(), swivel=float(swivel))
            ]
        else:
            found = function(T.tolist(), given=q.tolist())
        if not found:
            return False
        for one in found:
            error = _pose(table, np.array(one["q"]), derivation) - T
            error = error[:3, 3] if position_only else error
            if np.abs(error).max() > TOLERANCE * max(1.0, derivation.size):
                return False
    return True


def _pose(table: DHTable, q: Matrix, derivation: Derivation) -> Matrix:
    """Return the pose of the derivation's frame in its base, shape (4, 4)."""
    T0 = dh_matrices(table, q).T0
    is_tool = derivation.frame == "tool"
    row = table.tip_row if is_tool else int(derivation.frame.split("_")[1])
    T = T0[row - 1] @ (table.tool if is_tool else np.eye(4))
    return np.asarray(table.base @ T if derivation.base == "base_link" else T)
