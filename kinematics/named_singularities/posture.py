"""The axes of a chain at many q, and factors made of them; all arrays have a leading axis n."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.chain import Chain
from kinematics.kernels import forward
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class Factor:
    """One factor of a determinant.

    Attributes:
        name: shoulder, elbow, wrist, …
        value: Signed, shape (n,).
        largest: Bound of its absolute value, or what it is compared with; shape (n,).
        unit: ``m``, ``m^2``, … or 1.
        joints: Indices in the chain of the joints that it is made of.
        vanishes_where: In words.
    """

    name: str
    value: FloatArray
    largest: FloatArray
    unit: str
    joints: tuple[int, ...]
    vanishes_where: str

    @property
    def normalised(self) -> FloatArray:
        """The value over its bound, in -1 … 1."""
        return np.clip(self.value / np.maximum(self.largest, 1e-300), -1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Posture:
    """A chain at n configurations, base axes.

    Attributes:
        Z: Directions of the axes, shape (n, K, 3).
        O: A point of each axis, shape (n, K, 3).
        R: Rotation of the frame, shape (n, 3, 3).
        p: Its origin, shape (n, 3).
    """

    Z: FloatArray
    O: FloatArray
    R: FloatArray
    p: FloatArray

    def point(self, in_tip: FloatArray) -> FloatArray:
        """A point given in the frame, shape (3,) -> (n, 3)."""
        return np.asarray(self.p + self.R @ in_tip)

    def z(self, k: int) -> FloatArray:
        """Direction of axis k, shape (n, 3)."""
        return np.asarray(self.Z[:, k])

    def column(self, k: int, point: FloatArray, is_revolute: bool) -> FloatArray:
        """Velocity of a point by joint k, shape (n, 3)."""
        return cross(self.z(k), self.from_axis(k, point)) if is_revolute else self.z(k)

    def from_axis(self, k: int, point: FloatArray) -> FloatArray:
        """Vector from the known point of axis k to a point, shape (n, 3)."""
        return np.asarray(point - self.O[:, k])

    def lever(self, k: int, point: FloatArray) -> FloatArray:
        """Distance of a point from axis k, shape (n,)."""
        return norm(across(self.from_axis(k, point), self.z(k)))

    def foot(self, k: int, point: FloatArray) -> FloatArray:
        """The point of axis k nearest to a point, shape (n, 3)."""
        return np.asarray(point - across(self.from_axis(k, point), self.z(k)))


def posture(chain: Chain, q: FloatArray) -> Posture:
    """The axes at q of shape (n, dof)."""
    n, K = len(q), chain.length
    memory, trig, poses = np.empty((n, K, 6)), np.empty(2 * K), np.empty((n, 12))
    own = np.ascontiguousarray(q[:, chain.columns])
    for k in range(n):
        axes, origins = memory[k, :, :3], memory[k, :, 3:]
        forward(chain.placements, chain.is_revolute, own[k], trig, axes, origins, poses[k])
    T = poses.reshape(n, 3, 4)
    return Posture(memory[:, :, :3], memory[:, :, 3:], T[:, :, :3], T[:, :, 3])


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Vector products, shapes (n, 3)."""
    parts = (
        a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
        a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
        a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
    )
    return np.stack(parts, axis=-1)


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar products, shapes (n, 3) -> (n,)."""
    return np.asarray((a * b).sum(axis=-1))


def norm(a: FloatArray) -> FloatArray:
    """Lengths, shape (n, 3) -> (n,)."""
    return np.sqrt(dot(a, a))


def across(a: FloatArray, z: FloatArray) -> FloatArray:
    """The part of vectors at right angles to unit vectors, shapes (n, 3)."""
    return np.asarray(a - dot(a, z)[..., None] * z)


def triple(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """``a · (b × c)``, shapes (n, 3) -> (n,)."""
    return dot(a, cross(b, c))
