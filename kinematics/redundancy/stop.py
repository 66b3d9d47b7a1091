"""Reasons for which a method stops before the end of a path, or falls back to another."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from robots.robot import FloatArray


class StopReason(StrEnum):
    """Kinds of stops; with ``AS_QP`` all samples are there, those of ``qp``."""

    RANK = "rank"
    DIVERGED = "diverged"
    TIME = "time"
    AS_QP = "as_qp"


@dataclass(frozen=True)
class Stop:
    """A stop.

    Attributes:
        reason: Its kind.
        sample: The sample that was not reached.
        rank: Rank of the task's Jacobian before it, for ``RANK``; else -1.
        joint: The joint of the chain that would move most, for ``DIVERGED``; else -1.
        motion: By how much it would, rad or m.
    """

    reason: StopReason
    sample: int
    rank: int = -1
    joint: int = -1
    motion: float = 0.0

    @classmethod
    def diverged(cls, sample: int, rank: int, step: FloatArray) -> Stop:
        """Return the stop before a sample to which the joints would move by ``step``."""
        size = np.nan_to_num(np.abs(step), nan=np.inf)
        joint = int(np.argmax(size))
        return cls(StopReason.DIVERGED, sample, rank, joint, float(size[joint]))
