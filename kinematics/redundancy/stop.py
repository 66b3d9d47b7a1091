"""Reasons for which a method stops before the end of a path, or falls back to another."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


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
    """

    reason: StopReason
    sample: int
    rank: int = -1
