"""Poses, first and second derivatives of a chain at many q together, in base axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.chain import Chain
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class ManyPoses:
    """What a chain of K joints, moved by n entries of q, does at N values of q.

    Attributes:
        chain: The chain.
        directions: Unit vectors along the axes, shape (N, K, 3).
        linear: Linear velocity of the frame by each joint, m/rad or m/m, shape (N, K, 3).
        position: Of the frame, m, shape (N, 3).
        rotation: Of the frame, shape (N, 3, 3).
    """

    chain: Chain
    directions: FloatArray
    linear: FloatArray
    position: FloatArray
    rotation: FloatArray

    @classmethod
    def at(cls, chain: Chain, q: FloatArray) -> ManyPoses:
        """Return the poses of a chain at q, shape (N, n), rad and m."""
        values, count = chain.values(q), len(q)
        R, p = np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3))
        Z, O = np.empty((count, chain.length, 3)), np.empty((count, chain.length, 3))
        for k, row in enumerate(chain.placements):
            step = row.reshape(3, 4)
            p = p + R @ step[:, 3]
            R = R @ step[:, :3]
            if k == chain.length:
                break
            Z[:, k], O[:, k] = R[:, :, 2], p
            if chain.is_revolute[k]:
                c, s = np.cos(values[:, k, None]), np.sin(values[:, k, None])
                x, y = R[:, :, 0], R[:, :, 1]
                R = np.stack((c * x + s * y, c * y - s * x, R[:, :, 2]), axis=2)
            else:
                p = p + values[:, k, None] * Z[:, k]
        turns = chain.is_revolute[None, :, None]
        return cls(chain, Z, np.where(turns, np.cross(Z, p[:, None] - O), Z), p, R)

    def jacobian(self) -> FloatArray:
        """Return the derivative of the position by q, shape (N, 3, n)."""
        return self.chain.in_q(np.swapaxes(self.linear, 1, 2))

    def trace(self, B: FloatArray) -> FloatArray:
        """Return tr(Bᵀ R), shape (N,)."""
        return np.asarray(np.einsum("ij,nij->n", B, self.rotation))

    def trace_gradient(self, B: FloatArray) -> FloatArray:
        """Return the derivative of tr(Bᵀ R) by q, shape (N, n)."""
        M = self.rotation @ B.T
        v = np.stack(
            (M[:, 2, 1] - M[:, 1, 2], M[:, 0, 2] - M[:, 2, 0], M[:, 1, 0] - M[:, 0, 1]), axis=1
        )
        by_joint = -np.einsum("nki,ni->nk", self.directions, v)
        return self.chain.in_q(np.where(self.chain.is_revolute, by_joint, 0.0))

    def second_derivative(self, B: FloatArray, along: FloatArray) -> FloatArray:
        """Return that of ``tr(Bᵀ R) + along · p`` by q, shape (N, n, n).

        Args:
            B: Shape (3, 3).
            along: Shape (N, 3).
        """
        Z, turns = self.directions, self.chain.is_revolute
        M = self.rotation @ B.T
        traces = np.trace(M, axis1=1, axis2=2)[:, None, None]
        # Row j, column i, right for j ≤ i: joint j carries what joint i does.
        turned = Z @ M @ np.swapaxes(Z, 1, 2) - (Z @ np.swapaxes(Z, 1, 2)) * traces
        both = turns[:, None] & turns[None, :]
        carried = np.cross(Z[:, :, None], self.linear[:, None])
        moved = np.einsum("njik,nk->nji", carried, along) * turns[:, None]
        whole = np.triu(np.where(both, turned, 0.0) + moved)
        whole = whole + np.swapaxes(np.triu(whole, 1), 1, 2)
        rows = self.chain.in_q(whole)
        return np.swapaxes(self.chain.in_q(np.swapaxes(rows, 1, 2)), 1, 2)
