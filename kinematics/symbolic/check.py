"""Numerical checks of expressions against the table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dh_to_urdf.matrices import dh_matrices
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import DHTable
from kinematics.symbolic.chain import Chain
from kinematics.symbolic.expressions import Sum, evaluate
from kinematics.symbolic.inverse import Inverse
from kinematics.symbolic.names import Names
from kinematics.symbolic.quantities import Determinant, Entries
from kinematics.symbolic.request import Quantity
from kinematics.task import Task

TOLERANCE = 1e-9
SAMPLES = 3


class Checker:
    """Compares expressions with the table's numbers at a few q."""

    def __init__(self, table: DHTable, chain: Chain, task: Task | None = None) -> None:
        self.table = table
        self.chain = chain
        self.task = task
        rng = np.random.default_rng(7)
        self.samples = rng.uniform(-3.0, 3.0, (SAMPLES, table.dof))

    def holds(self, entries: Entries, expressed_in: str) -> bool:
        """Return whether written expressions have the right values."""
        for q in self.samples:
            values = _values(self.chain.names, q)
            found = np.array(
                [
                    [[evaluate(entry, values) for entry in row] for row in grid]
                    for grid in entries.written
                ]
            )
            expected = self._expected(entries.quantity, q, expressed_in)
            if np.abs(found - expected).max() > TOLERANCE * max(1.0, np.abs(expected).max()):
                return False
        return True

    def settle_signs(self, determinant: Determinant) -> None:
        """Give determinants the sign of the base's axes; drop any that is wrong.

        Frames whose axes span the same rows of a task may change the sign.
        """
        J = [self.jacobian(q, self.chain.frames[0]) for q in self.samples]
        for minor in determinant.minors:
            if minor.expression is None:
                continue
            columns = [j - 1 for j in determinant.joints if j not in minor.without]
            square = [one[np.ix_(list(determinant.rows), columns)] for one in J]
            # Hadamard's bound: the rounding error of a determinant scales with it.
            scale = [float(np.prod(np.linalg.norm(one, axis=0))) for one in square]
            expected = [float(np.linalg.det(one)) for one in square]
            values = [_values(self.chain.names, q) for q in self.samples]
            found = [evaluate(minor.expression, one) for one in values]
            for sign in (1, -1):
                if _close([sign * value for value in found], expected, scale):
                    minor.expression = _times(minor.expression, sign)
                    break
            else:
                minor.expression = None

    def jacobian(self, q: Matrix, expressed_in: str) -> Matrix:
        """Return the geometric Jacobian of the last frame, shape (6, dof), from the table."""
        poses = self._poses(q)
        tip = poses[self.chain.frames[-1]]
        J = np.zeros((6, self.table.dof))
        for axis in self.chain.axes:
            pose = poses[self.chain.frames[axis.node]]
            z = axis.sign * pose[:3, 2]
            v = np.cross(z, tip[:3, 3] - pose[:3, 3]) if axis.is_revolute else z
            w = z if axis.is_revolute else np.zeros(3)
            J[:, axis.joint - 1] += axis.factor * np.concatenate((v, w))
        R = poses[expressed_in][:3, :3].T
        return np.concatenate((R @ J[:3], R @ J[3:]))

    def task_jacobian(self, q: Matrix, expressed_in: str) -> Matrix:
        """Return the rows of the task, shape (rows, dof)."""
        J = self.jacobian(q, expressed_in)
        if self.task is None:
            return J
        if self.task.own_axes:
            J = np.concatenate((J[:3], self.jacobian(q, self.chain.frames[-1])[3:]))
        return np.asarray(J[list(self.task.rows)])

    def inverts(self, inverse: Inverse, expressed_in: str) -> bool:
        """Return whether matrix and divisor of an inverse belong to the table's Jacobian."""
        for q in self.samples:
            values = _values(self.chain.names, q)
            J = (
                self.jacobian(q, expressed_in)[list(inverse.rows)]
                if self.task is None
                else self.task_jacobian(q, expressed_in)
            )[:, [joint - 1 for joint in inverse.joints]]
            matrix = np.array([[evaluate(one, values) for one in row] for row in inverse.written])
            expected = evaluate(inverse.over, values) * np.eye(len(J))
            scale = max(1.0, float((np.abs(matrix) @ np.abs(J)).max()))
            if np.abs(matrix @ J - expected).max() > TOLERANCE * scale:
                return False
        return True

    def _poses(self, q: Matrix) -> dict[str, Matrix]:
        """Return every frame in the axes of frame_0."""
        matrices = dh_matrices(self.table, q)
        poses = {f"frame_{k}": T for k, T in enumerate(matrices.T0, start=1)}
        poses["frame_0"] = np.eye(4)
        poses["base_link"] = np.linalg.inv(self.table.base)
        poses["tool"] = poses[f"frame_{self.table.tip_row}"] @ self.table.tool
        return poses

    def _expected(self, quantity: Quantity, q: Matrix, expressed_in: str) -> Matrix:
        if quantity is Quantity.JACOBIAN:
            return self.task_jacobian(q, expressed_in)[None]
        matrices = dh_matrices(self.table, q)
        if quantity in (Quantity.A, Quantity.T0):
            return matrices.A if quantity is Quantity.A else matrices.T0
        poses = self._poses(q)
        last = poses[self.chain.frames[-1]]
        T = self.table.base @ last if self.chain.frames[0] == "base_link" else last
        if quantity is Quantity.T:
            return np.asarray(T[None])
        return np.asarray(T[None, :3, 3:] if quantity is Quantity.POSITION else T[None, :3, :3])


def _values(names: Names, q: Matrix) -> dict[str, float]:
    return names.values({k: float(value) for k, value in enumerate(q, start=1)})


def _close(found: Sequence[float], expected: Sequence[float], scale: Sequence[float]) -> bool:
    return all(
        abs(a - b) <= TOLERANCE * max(s, abs(b))
        for a, b, s in zip(found, expected, scale, strict=True)
    )


def _times(expression: Sum, sign: int) -> Sum:
    return Sum(tuple(term.scaled(sign) for term in expression.terms))
