"""Axes of a chain at many q, and factors made of them; all arrays have a leading axis n."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.kernels import forward
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class Zeros:
    """A factor that depends on one turning joint alone, as the sine of an angle.

    Attributes:
        joint: Index of the joint in the chain.
        sine: Of the angle, times a length; shape (n,).
        cosine: Likewise.
        sense: 1 where the angle grows with the joint's value, -1 where it falls; shape (n,).
    """

    joint: int
    sine: FloatArray
    cosine: FloatArray
    sense: FloatArray

    def values(self, q: FloatArray) -> tuple[float, float] | None:
        """Return the joint's two values in (-pi, pi] where the factor vanishes, rad.

        Args:
            q: The joint's value in the first configuration, rad, of shape ().

        Returns:
            The smaller first; None where the factor vanishes at every value.
        """
        sine, cosine = float(self.sine[0]), float(self.cosine[0])
        if np.hypot(sine, cosine) == 0.0:
            return None
        first = float(q) - float(self.sense[0]) * np.arctan2(sine, cosine)
        both = (np.pi - np.remainder(np.pi - first - shift, 2 * np.pi) for shift in (0.0, np.pi))
        low, high = sorted(float(value) for value in both)
        return low, high


@dataclass(frozen=True, eq=False)
class Factor:
    """One factor of a determinant.

    Attributes:
        name: shoulder, elbow, wrist, …
        value: Signed, shape (n,).
        largest: Bound of its absolute value, the same at every q; shape (n,).
        unit: ``m``, ``m^2``, … or 1.
        joints: Indices in the chain of the joints that it depends on.
        vanishes_where: Where it vanishes, in words.
        zeros: The values of the one joint that it depends on, if it does.
        vanishes: Whether it is zero, and the rank lost with it, shape (n,).
    """

    name: str
    value: FloatArray
    largest: FloatArray
    unit: str
    joints: tuple[int, ...]
    vanishes_where: str
    zeros: Zeros | None = None
    vanishes: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))

    @property
    def normalised(self) -> FloatArray:
        """The value divided by its bound, in -1 … 1."""
        return np.clip(self.value / np.maximum(self.largest, 1e-300), -1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Posture:
    """Axes and frame of a chain at n configurations, in base axes.

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
        """Return a point given in the frame, shape (3,), in base axes, shape (n, 3)."""
        return np.asarray(self.p + self.R @ in_tip)

    def z(self, k: int) -> FloatArray:
        """Return the direction of axis k, shape (n, 3)."""
        return np.asarray(self.Z[:, k])

    def column(self, k: int, point: FloatArray, is_revolute: bool) -> FloatArray:
        """Return the velocity of a point per unit speed of joint k, shape (n, 3)."""
        return cross(self.z(k), self.from_axis(k, point)) if is_revolute else self.z(k)

    def from_axis(self, k: int, point: FloatArray) -> FloatArray:
        """Return the vector from the known point of axis k to a point, shape (n, 3)."""
        return np.asarray(point - self.O[:, k])

    def lever(self, k: int, point: FloatArray) -> FloatArray:
        """Return the distance of a point from axis k, shape (n,)."""
        return norm(across(self.from_axis(k, point), self.z(k)))

    def foot(self, k: int, point: FloatArray) -> FloatArray:
        """Return the point of axis k nearest to a point, shape (n, 3)."""
        return np.asarray(point - across(self.from_axis(k, point), self.z(k)))


def posture(chain: Chain, q: FloatArray) -> Posture:
    """Return the axes at q of shape (n, dof)."""
    n, K = len(q), chain.length
    memory, trig, poses = np.empty((n, K, 6)), np.empty(2 * K), np.empty((n, 12))
    own = np.ascontiguousarray(q[:, chain.columns])
    for k in range(n):
        forward(chain.placements, chain.is_revolute, own[k], trig, memory[k], poses[k])
    T = poses.reshape(n, 3, 4)
    return Posture(memory[:, :, :3], memory[:, :, 3:], T[:, :, :3], T[:, :, 3])


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return vector products, shapes (n, 3)."""
    parts = (
        a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
        a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
        a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
    )
    return np.stack(parts, axis=-1)


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return scalar products, shapes (n, 3) -> (n,)."""
    return np.asarray((a * b).sum(axis=-1))


def norm(a: FloatArray) -> FloatArray:
    """Return lengths, shape (n, 3) -> (n,)."""
    return np.sqrt(dot(a, a))


def across(a: FloatArray, z: FloatArray) -> FloatArray:
    """Return the part of vectors at right angles to unit vectors, shapes (n, 3)."""
    return np.asarray(a - dot(a, z)[..., None] * z)


def triple(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return ``a · (b × c)``, shapes (n, 3) -> (n,)."""
    return dot(a, cross(b, c))
