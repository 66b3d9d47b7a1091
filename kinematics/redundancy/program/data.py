"""What the program of a whole path is made from, in plain arrays, and the memory that it takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from robots.robot import FloatArray

SPHERE, CIRCLE, CAPSULE, HALF_SPACE, BOX = "sphere", "circle", "capsule", "half_space", "box"


@dataclass(frozen=True, eq=False)
class Segment:
    """A capsule of the arm.

    Attributes:
        carriers: Joint (or K for the frame, -1 for the base) that carries start and end.
        offsets: Start and end in the axes of their carriers, m, shape (2, 3).
        radius: m.
        whole: Whether its start counts too; else it is the end of the one before.
    """

    carriers: tuple[int, int]
    offsets: FloatArray
    radius: float
    whole: bool


@dataclass(frozen=True, eq=False)
class Solid:
    """An obstacle: its kind and its row of numbers; see :mod:`..clearance.obstacles`."""

    kind: str
    row: FloatArray


@dataclass(frozen=True, eq=False)
class ProgramData:
    """Everything that a program takes: N samples, K unknowns each.

    Attributes:
        first: Row 0 of the path, which is kept, shape (K,).
        targets: Poses of the samples from 1 on, shape (N - 1, 12).
        placements: Of the chain; see :class:`kinematics.chain.Chain`.
        is_revolute: Likewise.
        coupling: Likewise; None where joint k is entry k.
        offset: Likewise.
        rows: Rows of the task error that the arm can move.
        own_axes: Whether rotations are taken in the frame's own axes.
        segments: Capsules of the arm.
        solids: Obstacles.
        need: Clearance to keep at the samples, m.
        need_between: Clearance to keep at the places between them, m.
        between: Places k + s between samples k and k + 1 at which clearance is kept too.
        most_per_step: Largest motion of each joint between samples, shape (K,).
        lower: Limits, shape (K,).
        upper: Limits, shape (K,).
    """

    first: FloatArray
    targets: FloatArray
    placements: FloatArray
    is_revolute: tuple[bool, ...]
    coupling: FloatArray | None
    offset: FloatArray
    rows: tuple[int, ...]
    own_axes: bool
    segments: tuple[Segment, ...]
    solids: tuple[Solid, ...]
    need: float
    need_between: float
    between: tuple[tuple[int, float], ...]
    most_per_step: FloatArray
    lower: FloatArray
    upper: FloatArray

    @property
    def samples(self) -> int:
        """Number of samples, N."""
        return len(self.targets) + 1


@dataclass(frozen=True)
class Attempt:
    """A task of the process: a program is solved from a first guess.

    Attributes:
        program: A pickled :class:`ProgramData`; the process keeps its last one.
        guess: Shape (N, K); row 0 is kept.
        seconds: Longest time.
        iterations: Most iterations.
        kept: Whether the program is small, so that it is kept beside another one.
    """

    program: bytes
    guess: FloatArray
    seconds: float
    iterations: int
    kept: bool


def array_of(answer: bytes, samples: int) -> FloatArray:
    """Return the unknowns of an answer, shape (N - 1, K)."""
    return np.frombuffer(answer).reshape(samples - 1, -1)
