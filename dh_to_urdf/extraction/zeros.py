"""Zeros of the joints at which two chains have the same axes, up to the placement of their bases.

Two chains are the same arm exactly if a motion maps their axes onto each other: directed lines of
revolute joints, directions of prismatic ones. The motion and the zeros are found by Gauss-Newton
steps; the columns of the Jacobian are brackets of screws (Murray, Li and Sastry, section 2.4), so
that zeros without effect do not change.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from dh_to_urdf.extraction.axes import ChainJoint, SerialChain
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import JointType

STARTS = 5
MAX_SOUGHT = 16
"""Number of joints up to which zeros are also sought from random starts."""
STEPS = 30
FITTED = 1e-12
"""Sum of squared differences below which the axes are the same."""


def with_zeros(chain: SerialChain, zeros: Matrix) -> SerialChain:
    """Return the chain with q = 0 where q = ``zeros`` was, shape (n,), rad and m."""
    moved = [
        replace(joint, placement=_moved(joint, float(zero)))
        for joint, zero in zip(chain.joints, zeros, strict=True)
    ]
    return replace(chain, joints=tuple(moved))


@dataclass(frozen=True)
class Fit:
    """Motion and zeros that map the axes of a second chain onto those of a first one.

    Attributes:
        zeros: What to add to q of the first chain to get q of the second, shape (n,).
        placement: Where to put the base of the second chain in that of the first, 4x4.
        left: Sum of squared differences of directions, and of moments in sizes of the robot.
    """

    zeros: Matrix
    placement: Matrix
    left: float


def fit_axes(first: SerialChain, second: SerialChain, start: Matrix) -> Fit:
    """Fit zeros and base of a second chain so that its axes are nearest to the first's.

    Args:
        first: The first chain.
        second: Another one with the same kinds of joints.
        start: Zeros to start from, shape (n,); then random ones.
    """
    size = max(first.size, second.size)
    target = _Axes.of(first, size)
    random = np.random.default_rng(0)
    scale = np.where(target.is_revolute, np.pi, size)
    best = _fitted(target, second, start, size)
    for _ in range(STARTS if len(start) <= MAX_SOUGHT else 0):
        if best.left <= FITTED:
            break
        tried = _fitted(target, second, random.uniform(-scale, scale), size)
        best = min(best, tried, key=lambda fit: fit.left)
    return best


@dataclass(frozen=True)
class _Axes:
    """Axes at q = 0 as directions and moments (0 for prismatic joints), shape (n, 3)."""

    is_revolute: Matrix
    directions: Matrix
    moments: Matrix

    @classmethod
    def of(cls, chain: SerialChain, size: float) -> _Axes:
        """Return the axes of a chain, with lengths in sizes of the robot."""
        lines = chain.lines()
        is_revolute = np.array([line.type.is_revolute for line in lines])
        directions = np.array([line.direction for line in lines])
        points = np.array([line.point for line in lines]) / size
        return cls(is_revolute, directions, np.cross(points, directions) * is_revolute[:, None])

    def screws(self) -> Matrix:
        """Return the twists of the joints, shape (n, 2, 3): angular part, then linear part."""
        is_revolute = self.is_revolute[:, None]
        angular = self.directions * is_revolute
        return np.stack([angular, np.where(is_revolute, self.moments, self.directions)], axis=1)

    def moved(self, T: Matrix) -> _Axes:
        """Return the axes after a motion."""
        directions = self.directions @ T[:3, :3].T
        moments = self.moments @ T[:3, :3].T
        moments = moments + np.cross(T[:3, 3], directions) * self.is_revolute[:, None]
        return _Axes(self.is_revolute, directions, moments)

    def minus(self, other: _Axes) -> Matrix:
        """Return directions and moments less those of others, shape (6 n,)."""
        return np.concatenate(
            [self.directions - other.directions, self.moments - other.moments]
        ).ravel()


def _fitted(target: _Axes, chain: SerialChain, zeros: Matrix, size: float) -> Fit:
    """Fit by damped Gauss-Newton steps from given zeros."""
    scale = np.where(target.is_revolute, 1.0, size)
    tried, T = zeros, _laid(target, _Axes.of(with_zeros(chain, zeros), size))
    best, damping = Fit(zeros, T, math.inf), 1e-6
    for _ in range(STEPS):
        laid = _Axes.of(with_zeros(chain, tried), size).moved(T)
        missed = target.minus(laid)
        left = float(missed @ missed)
        if left >= best.left:
            damping *= 10.0
            if damping > 1e6:
                break
        else:
            gained = left < 0.999999 * best.left
            best, damping = Fit(tried, T, left), max(damping / 10.0, 1e-12)
            J = _jacobian(laid)
            square, slope = J.T @ J, J.T @ missed
            if left <= 1e-30 or not gained:
                break
        step = np.linalg.solve(square + damping * np.eye(len(slope)), slope).astype(np.float64)
        tried, T = best.zeros + step[6:] * scale, _motion(step[:6]) @ best.placement
    placement = best.placement.copy()
    placement[:3, 3] *= size
    return replace(best, placement=placement)


def _motion(twist: Matrix) -> Matrix:
    """Return a motion that is a twist to first order: a rotation after a translation."""
    angle = float(np.linalg.norm(twist[:3]))
    axis = twist[:3] / angle if angle else np.array([0.0, 0.0, 1.0])
    joint = ChainJoint("", JointType.REVOLUTE, np.eye(4), axis)
    T = _moved(joint, angle)
    T[:3, 3] = twist[3:]
    return T


def _laid(target: _Axes, axes: _Axes) -> Matrix:
    """Return the motion that aligns axes with the target: directions first, then moments."""
    T = np.eye(4)
    U, _, Vt = np.linalg.svd(target.directions.T @ axes.directions)
    T[:3, :3] = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    turned = axes.moved(T)
    crosses = np.cross(np.eye(3), turned.directions[:, None]).transpose(0, 2, 1)
    crosses = crosses * turned.is_revolute[:, None, None]
    missed = (target.moments - turned.moments).ravel()
    T[:3, 3] = np.linalg.lstsq(crosses.reshape(-1, 3), missed, rcond=1e-9)[0]
    return T


def _jacobian(axes: _Axes) -> Matrix:
    """Return the derivative of the axes by base (six) and zeros, shape (6 n, 6 + n)."""
    base = np.zeros((6, 2, 3))
    base[:3, 0], base[3:, 1] = np.eye(3), np.eye(3)
    screws = np.concatenate([base, axes.screws()])
    angular, linear = screws[:, None, 0], screws[:, None, 1]
    turned = np.cross(angular, axes.directions)
    moved = np.cross(angular, axes.moments) + np.cross(linear, axes.directions)
    count = len(axes.is_revolute)
    # A zero moves the axes after its own.
    after = np.concatenate([np.ones((6, count)), np.triu(np.ones((count, count)), 1)])[..., None]
    moved = moved * axes.is_revolute[:, None]
    return np.concatenate([turned * after, moved * after], axis=1).reshape(6 + count, -1).T


def _moved(joint: ChainJoint, value: float) -> Matrix:
    chain = SerialChain("", "", "", (joint,), np.eye(4))
    return chain.poses(np.array([value]))
