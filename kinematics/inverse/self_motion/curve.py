"""A curve of joint values that all reach one target."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from robots.robot import FloatArray


class Stop(StrEnum):
    """Why a curve ends, where no limit of a joint ends it."""

    SINGULARITY = "singularity"
    UNBOUNDED = "unbounded"


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve of joint values, known at nodes and, by evaluation, everywhere between them.

    Attributes:
        q: Joint values at the nodes, continuous, so that angles may leave (-pi, pi]; shape (N, K).
        closed: Whether the last node is the first again, but for whole turns of angles.
        between: Gives the joint values, shape (K,), at a place ``u`` in [0, N - 1]: node ``i`` is
            at ``u = i``.
        stops: Why an open curve ends at its first and at its last node.
        codes: Of the branch of a closed form.
    """

    q: FloatArray
    closed: bool
    between: Callable[[float], FloatArray]
    stops: tuple[Stop, Stop] = (Stop.SINGULARITY, Stop.SINGULARITY)
    codes: tuple[int, ...] = ()

    @property
    def last(self) -> int:
        """The place of the last node."""
        return len(self.q) - 1

    def at(self, u: float) -> FloatArray:
        """Return the joint values at a place, shape (K,); a closed curve goes on beyond its last.

        Args:
            u: The place.
        """
        if not self.closed or 0.0 <= u <= self.last:
            return self._inside(min(max(u, 0.0), float(self.last)))
        rounds = math.floor(u / self.last)
        return np.asarray(self._inside(u - rounds * self.last) + rounds * (self.q[-1] - self.q[0]))

    def _inside(self, u: float) -> FloatArray:
        node = round(u)
        return self.q[node].copy() if u == node else self.between(u)
