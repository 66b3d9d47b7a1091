"""Bounds of distances along a chain that hold at every q."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.chain import Chain
from kinematics.named_singularities.posture import Posture, norm
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class Reach:
    """How far points beyond the joints of a chain can be from their axes.

    Attributes:
        links: Distances between successive joints, the last to the frame, m; shape (K,).
        slides: How far each joint slides from its zero at most, m; 0 where it turns. Without limits
            as far as it does in the batch and in others, and at least the arm's size; shape (K,).
        here: The configurations, shape (n, K).
    """

    links: FloatArray
    slides: FloatArray
    here: FloatArray

    @classmethod
    def of(cls, chain: Chain, q: FloatArray, size: float, others: FloatArray) -> Reach:
        """Return the bounds of a chain for configurations.

        Args:
            chain: The chain.
            q: The configurations, shape (n, dof).
            size: Of the arm, m.
            others: Largest magnitudes in other configurations that count, shape (K,).
        """
        extents = np.maximum(np.abs(chain.lower), np.abs(chain.upper))
        here = np.maximum(np.abs(q[:, chain.columns]).max(axis=0), others)
        slides = np.where(np.isfinite(extents), np.maximum(extents, here), np.maximum(size, here))
        links = np.linalg.norm(chain.placements[1:, [3, 7, 11]], axis=1)
        return cls(links, np.where(chain.is_revolute, 0.0, slides), q[:, chain.columns])

    def from_axis(self, at: Posture, i: int, last: int, point: FloatArray) -> FloatArray:
        """Return a bound of the distance of a point from axis i; shape (n,).

        Args:
            at: The posture.
            i: The axis.
            last: The joint that carries the point, with no joint in between that moves it.
            point: The point, shape (n, 3).
        """
        between = float(self.links[i:last].sum() + self.slides[i : last + 1].sum())
        return np.asarray(between + norm(at.from_axis(last, point)))

    def along(self, k: int, part: FloatArray) -> FloatArray:
        """Return a bound of a length along a sliding joint, given what it is now; shape (n,)."""
        return np.asarray(np.abs(part - self.here[:, k]) + self.slides[k])
