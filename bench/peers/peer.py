"""What a peer is: a name, the distribution that it comes in, and how to set it up for an arm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from bench.peers.arms import Arm
from robots.robot import FloatArray

Solve = Callable[[FloatArray], FloatArray | None]


@dataclass(frozen=True)
class Peer:
    """One solver.

    Attributes:
        name: Name in the report.
        distribution: Whose version is reported.
        make: Sets it up for an arm; raises Unsupported where it cannot.
        how: The settings, for the report.
    """

    name: str
    distribution: str
    make: Callable[[Arm], Solve]
    how: str
