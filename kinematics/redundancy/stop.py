"""Why a method stopped before the end of a path, or did less than it is there for."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class StopReason(StrEnum):
    """Kinds of stops; after the last there are all samples, those of ``qp``."""

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
        rank: Rank of the task's Jacobian before it, where that is the reason.
    """

    reason: StopReason
    sample: int
    rank: int = -1
