"""Axis lines of a chain at q = 0 and their relations.

Everything in base axes. Files round their angles and lengths, so relations hold within
``ANGLE`` and ``LENGTH`` (relative to the arm); what that leaves, the polish of the solutions on
the chain itself takes away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from robots.robot import FloatArray

ANGLE = 1e-8
LENGTH = 1e-8
INDEPENDENT = 1e-7
"""Part of the largest singular value below which joints do the same."""
INDEPENDENT_SEED = 20_261_130


@dataclass(frozen=True, eq=False)
class AxisLines:
    """Axes of a chain at q = 0.

    Attributes:
        directions: Unit vectors along the axes, shape (K, 3).
        points: A point of each axis, m, shape (K, 3).
        is_revolute: True for an angle, shape (K,).
        pose: Pose of the frame, shape (4, 4).
        size: Length that distances are compared with, m.
    """

    directions: FloatArray
    points: FloatArray
    is_revolute: NDArray[np.bool_]
    pose: FloatArray
    size: float

    def parallel(self, i: int, j: int) -> bool:
        """Return whether two axes have the same or opposite directions."""
        return bool(np.linalg.norm(np.cross(self.directions[i], self.directions[j])) <= ANGLE)

    def feet(self, i: int, j: int) -> tuple[FloatArray, FloatArray]:
        """Return the ends of the common normal of two axes, m; from the point of i if parallel."""
        u, v = self.directions[i], self.directions[j]
        between = self.points[j] - self.points[i]
        if self.parallel(i, j):
            return self.points[i], self.points[j] - (between @ v) * v
        normal = np.cross(u, v)
        square = normal @ normal
        along_u = np.cross(between, v) @ normal / square
        along_v = np.cross(between, u) @ normal / square
        return self.points[i] + along_u * u, self.points[j] + along_v * v

    def apart(self, i: int, j: int) -> float:
        """Return the distance of two axes, m."""
        a, b = self.feet(i, j)
        return float(np.linalg.norm(b - a))

    def meeting_point(self, i: int, j: int) -> FloatArray | None:
        """Return the one point in which two axes intersect, m; None: they do not."""
        if self.parallel(i, j) or self.apart(i, j) > LENGTH * self.size:
            return None
        a, b = self.feet(i, j)
        return np.asarray((a + b) / 2)

    def centre(self, i: int) -> FloatArray | None:
        """Return the one point in which axes i, i + 1, i + 2 meet, m; None: they do not."""
        a, b = self.meeting_point(i, i + 1), self.meeting_point(i + 1, i + 2)
        if a is None or b is None or np.linalg.norm(b - a) > LENGTH * self.size:
            return None
        return np.asarray((a + b) / 2)

    def foot(self, i: int, point: FloatArray) -> FloatArray:
        """Return the point of axis i nearest to a point, m."""
        u = self.directions[i]
        return np.asarray(self.points[i] + ((point - self.points[i]) @ u) * u)

    def lever(self, i: int, point: FloatArray) -> float:
        """Return the distance of a point from axis i, m."""
        return float(np.linalg.norm(point - self.foot(i, point)))

    def moves(self, point: FloatArray, q: FloatArray) -> FloatArray:
        """Return how a point at the end and its frame move with each joint at q, shape (6, K).

        Rows are linear velocity, in parts of ``size``, and angular velocity.

        Args:
            point: Where it is at q = 0, m.
            q: rad, and parts of ``size``, shape (K,).
        """
        columns: list[FloatArray] = []
        for k in range(len(q) - 1, -1, -1):
            h = self.directions[k]
            if self.is_revolute[k]:
                R = _rotation(h, float(q[k]))
                arm = (point - self.points[k]) / self.size
                columns.append(np.concatenate((np.cross(h, arm), h)))
                point = self.points[k] + R @ (point - self.points[k])
                columns = [np.concatenate((R @ one[:3], R @ one[3:])) for one in columns]
            else:
                columns.append(np.concatenate((h, np.zeros(3))))
                point = point + q[k] * self.size * h
        return np.array(columns[::-1]).T

    def are_independent(self, point: FloatArray, rows: slice) -> bool:
        """Return whether some rows of the motion of a point see every joint, but for singular q."""
        random = np.random.default_rng(INDEPENDENT_SEED)
        for q in random.uniform(-np.pi, np.pi, (3, len(self.directions))):
            sigma = np.linalg.svd(self.moves(point, q)[rows], compute_uv=False)
            if sigma[-1] > INDEPENDENT * sigma[0]:
                return True
        return False

    def in_tip(self, direction: FloatArray) -> FloatArray:
        """Return a direction in the axes of the frame."""
        return np.asarray(self.pose[:3, :3].T @ direction)

    def point_in_tip(self, point: FloatArray) -> FloatArray:
        """Return the coordinates of a point in the frame, m."""
        return self.in_tip(point - self.pose[:3, 3])


def axis_lines(chain: Chain) -> AxisLines:
    """Return the axes of a chain at q = 0."""
    directions, points = [], []
    R, p = np.eye(3), np.zeros(3)
    for row in chain.placements:
        step = row.reshape(3, 4)
        p = p + R @ step[:, 3]
        R = R @ step[:, :3]
        directions.append(R[:, 2])
        points.append(p)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = R, p
    unit = np.array(directions[:-1])
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    extent = float(np.linalg.norm(chain.placements[1:-1, [3, 7, 11]], axis=1).sum())
    tool = float(np.linalg.norm(chain.placements[-1, [3, 7, 11]]))
    return AxisLines(unit, np.array(points[:-1]), chain.is_revolute, pose, extent + tool or 1.0)


def _rotation(h: FloatArray, angle: float) -> FloatArray:
    """Return the rotation about a unit vector (Rodrigues), shape (3, 3)."""
    K = np.array([[0.0, -h[2], h[1]], [h[2], 0.0, -h[0]], [-h[1], h[0], 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K)
