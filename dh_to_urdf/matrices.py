"""Link matrices A_k, partial products 0A_k and T of a table, without a URDF."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dh_to_urdf.couplings import joint_map, moving_joints
from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType


@dataclass(frozen=True)
class DHMatrices:
    """Link matrices and products at one q or a batch of them.

    Attributes:
        A: Link matrices, shape (..., n, 4, 4); n is the number of rows, fixed ones included.
        T0: Partial products 0A_k in frame 0, shape (..., n, 4, 4).
        T: ``base @ 0A_n @ tool``, shape (..., 4, 4).
    """

    A: Matrix
    T0: Matrix
    T: Matrix


def link_matrix(row: DHRow, convention: Convention, v: ArrayLike) -> Matrix:
    """Return ``A_k`` of one row.

    Args:
        row: The row.
        convention: What it means.
        v: The joint variable ``sign*q + offset``, any shape S, rad or m; ignored if fixed.

    Returns:
        Shape S + (4, 4).
    """
    v = np.asarray(v, dtype=np.float64)
    theta = v if row.type.is_revolute else np.full(v.shape, row.theta)
    d = v if row.type is JointType.PRISMATIC else np.full(v.shape, row.d)
    ct, st = np.cos(theta), np.sin(theta)
    ca, sa = np.cos(row.alpha), np.sin(row.alpha)
    A = np.zeros((*v.shape, 4, 4))
    A[..., 3, 3] = 1.0
    if convention is Convention.STANDARD:
        A[..., 0, 0], A[..., 0, 1], A[..., 0, 2], A[..., 0, 3] = ct, -st * ca, st * sa, row.a * ct
        A[..., 1, 0], A[..., 1, 1], A[..., 1, 2], A[..., 1, 3] = st, ct * ca, -ct * sa, row.a * st
        A[..., 2, 1], A[..., 2, 2], A[..., 2, 3] = sa, ca, d
        return A
    A[..., 0, 0], A[..., 0, 1], A[..., 0, 3] = ct, -st, row.a
    A[..., 1, 0], A[..., 1, 1], A[..., 1, 2], A[..., 1, 3] = st * ca, ct * ca, -sa, -d * sa
    A[..., 2, 0], A[..., 2, 1], A[..., 2, 2], A[..., 2, 3] = st * sa, ct * sa, ca, d * ca
    if row.gamma != 0.0 or row.b != 0.0:
        return np.asarray(branch_matrix(row) @ A)
    return A


def branch_matrix(row: DHRow) -> Matrix:
    """Return Khalil's ``Rz(γ) Tz(b)``, 4x4; the identity outside trees."""
    B = np.eye(4)
    B[:2, :2] = [
        [np.cos(row.gamma), -np.sin(row.gamma)],
        [np.sin(row.gamma), np.cos(row.gamma)],
    ]
    B[2, 3] = row.b
    return B


def joint_variables(table: DHTable, q: ArrayLike) -> Matrix:
    """Return ``v = sign*q + offset`` of every row, 0 for fixed rows, rad and m.

    Followers and coupled joints have their value in the place of q.

    Args:
        table: The table.
        q: Shape (..., dof), rad or m.

    Returns:
        Shape (..., n).

    Raises:
        ValueError: q has another length than the table has joint variables.
    """
    q = np.asarray(q, dtype=np.float64)
    if q.ndim == 0 or q.shape[-1] != table.dof:
        raise ValueError(say("q must hold {dof} values, one a joint", dof=table.dof))
    v = np.zeros((*q.shape[:-1], len(table.rows)))
    if table.is_coupled:
        found = joint_map(*moving_joints(table))
        q = q @ found.matrix.T + found.offset
    for column, k in enumerate(table.moving_rows):
        v[..., k] = table.rows[k].sign * q[..., column] + table.rows[k].offset
    return v


def dh_matrices(table: DHTable, q: ArrayLike) -> DHMatrices:
    """Return A_k, 0A_k and T of a table (the product of the A_k along each chain).

    Args:
        table: The table; a tree's T is that of its longest chain.
        q: Shape (..., dof), rad or m, in the order of the rows that move.

    Returns:
        The matrices.

    Raises:
        ValueError: q has a wrong length.
    """
    v = joint_variables(table, q)
    shape = (*v.shape[:-1], len(table.rows), 4, 4)
    A, T0 = np.empty(shape), np.empty(shape)
    for k, row in enumerate(table.rows):
        A[..., k, :, :] = link_matrix(row, table.convention, v[..., k])
        parent = T0[..., row.parent - 1, :, :] if row.parent else np.eye(4)
        T0[..., k, :, :] = parent @ A[..., k, :, :]
    tip = table.tip_row
    last = T0[..., tip - 1, :, :] if tip else np.broadcast_to(np.eye(4), (*v.shape[:-1], 4, 4))
    return DHMatrices(A, T0, np.asarray(table.base @ last @ table.tool))
