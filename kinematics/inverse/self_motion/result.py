"""What is said of the self-motions of an arm at a target."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from robots.robot import FloatArray


@dataclass(frozen=True)
class CurveEnd:
    """Why a curve ends.

    Attributes:
        reason: ``limit``, ``singularity`` or ``unbounded``.
        joint: The joint that is at its limit, else None.
        limit: Which one.
    """

    reason: Literal["limit", "singularity", "unbounded"]
    joint: str | None = None
    limit: Literal["lower", "upper"] | None = None


@dataclass(frozen=True, eq=False)
class SelfMotionCurve:
    """A curve of q within the limits, all of which reach the target.

    Attributes:
        closed: Whether it leads back to its start, else it is an arc.
        q: Some of its q, in its order, first and last its ends; shape (n, dof).
        parameter: The value of the parameter at each, rad or m, shape (n,).
        lower: Smallest value of each joint along it, shape (dof,).
        upper: Largest, likewise.
        ends: Why it ends at its first and at its last q; none where it is closed.
        posture: Names of its branch, where the arm has such.
        turns: Whole turns that each joint makes around a closed one, shape (dof,).
    """

    closed: bool
    q: FloatArray
    parameter: FloatArray
    lower: FloatArray
    upper: FloatArray
    ends: tuple[tuple[CurveEnd, ...], ...]
    posture: tuple[str, ...]
    turns: tuple[int, ...]


@dataclass(frozen=True)
class SelfMotion:
    """The self-motions of an arm at a target.

    Attributes:
        dimension: Of the set of solutions.
        parameter: ``swivel``, or the joint that they are told by; None where they are not curves.
        complete: Whether mathematics says that there are no other curves.
        unlimited: Number of curves without regard to limits.
        curves: Within the limits; the nearest to the seed first.
    """

    dimension: int
    parameter: str | None
    complete: bool
    unlimited: int
    curves: tuple[SelfMotionCurve, ...]
