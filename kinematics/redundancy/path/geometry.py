"""Paths: lines, polylines and circles of poses, sampled by a time law."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.errors import InvalidOption
from kinematics.inverse.task_error import twist_error
from kinematics.redundancy.path.time_law import TimeLaw
from kinematics.task import Task
from robots.robot import FloatArray

CLOSED = 1e-9
"""Distance of its ends, m and rad, below which a path is closed."""


@dataclass(frozen=True)
class Sampling:
    """Times at which a path is sampled.

    Attributes:
        time_law: The time law from one end to the other.
        tf: Duration, s.
        samples: Number N of samples, equally spaced in time; sample 0 is the start.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {"tf": Bounds(1e-6, 1e6), "samples": Bounds(2, 10_000)}

    time_law: TimeLaw = TimeLaw.CUBIC
    tf: float = 2.0
    samples: int = 101

    def __post_init__(self) -> None:
        duration, count = self.BOUNDS["tf"], self.BOUNDS["samples"]
        if self.tf not in duration:
            raise duration.refusal(
                say("tf is {tf:g}; give seconds, 1e-6 to 1e6", tf=self.tf), self.tf, "tf"
            )
        if self.samples not in count:
            raise count.refusal(
                say(
                    "samples is {samples}; give {lower} to {upper}, the start included",
                    samples=self.samples,
                    lower=count.lower,
                    upper=count.upper,
                ),
                self.samples,
                "samples",
            )


@dataclass(frozen=True)
class Circle:
    """A circle about an axis, through the start, with constant orientation.

    Attributes:
        center: A point of the axis, shape (3,).
        normal: Direction of the axis, right-handed; shape (3,).
        turns: Number of turns; negative in the opposite direction.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {"turns": Bounds(-100.0, 100.0)}

    center: FloatArray
    normal: FloatArray
    turns: float = 1.0

    def __post_init__(self) -> None:
        turns = self.BOUNDS["turns"]
        if self.turns == 0 or self.turns not in turns:
            raise turns.refusal(
                say(
                    "circle.turns is {turns:g}; give up to ±{upper:g}, not 0",
                    turns=self.turns,
                    upper=turns.upper,
                ),
                self.turns,
                "circle",
                ("turns",),
            )
        if not np.linalg.norm(self.normal) > 1e-9:
            raise InvalidOption(
                say("circle.normal is zero; give a direction"), argument="circle", index=("normal",)
            )


@dataclass(frozen=True)
class Path:
    """A sampled path.

    Attributes:
        targets: Poses, upper three rows of 4x4 matrices row by row, shape (N, 12).
        t: Times, s, shape (N,).
        r: Part of the path that is covered, 0 to 1, shape (N,).
        r_dot: Its rate, 1/s, shape (N,).
        r_ddot: Its acceleration, 1/s², shape (N,).
        closed: Whether the last target is the first one.
        at: The curve: poses, shape (n, 12), at parts r of shape (n,).
    """

    targets: FloatArray
    t: FloatArray
    r: FloatArray
    r_dot: FloatArray
    r_ddot: FloatArray
    closed: bool
    at: Callable[[FloatArray], FloatArray]

    @property
    def samples(self) -> int:
        """Number of samples, N."""
        return len(self.targets)

    @property
    def dt(self) -> float:
        """Time between samples, s."""
        return float(self.t[1] - self.t[0])


def polyline(
    start: FloatArray, poses: Sequence[FloatArray], task: Task, sampling: Sampling
) -> Path:
    """Return the path from a pose through others on straight lines, with SLERP between.

    Every pose after the start is a sample, at which the time law ends: without a stop for
    ``linear``, else at rest. Time intervals are distributed by length and angle.

    Args:
        start: First pose, 4x4, in base axes.
        poses: The others, each 4x4; rows outside the task are ignored.
        task: The task space.
        sampling: Time law, duration, number of samples.

    Raises:
        InvalidOption: More poses than intervals between samples.
    """
    intervals = sampling.samples - 1
    if len(poses) > intervals:
        raise InvalidOption(
            say(
                "samples is {samples} for {count} waypoints; give at least {count_2}",
                samples=sampling.samples,
                count=len(poses),
                count_2=len(poses) + 1,
            ),
            argument="samples",
            value=sampling.samples,
            lower=len(poses) + 1,
        )
    pieces = []
    here = start
    for pose in poses:
        pieces.append(_Piece.between(here, pose, task))
        here = pieces[-1].at(np.ones(1))[0]
    counts = _shares(pieces, intervals)
    duration = sampling.tf / intervals
    targets, rates = [_flat(start[None])], np.zeros((sampling.samples, 3))
    first = 0
    for piece, count in zip(pieces, counts, strict=True):
        law = np.array(sampling.time_law.at(np.arange(count + 1) / count))
        targets.append(_flat(piece.at(law[0, 1:])))
        share = count / intervals
        rows = slice(first, first + count + 1)
        rates[rows] = law.T * [share, share / (count * duration), share / (count * duration) ** 2]
        rates[rows, 0] += first / intervals
        first += count
    shares = np.array(counts) / intervals
    starts = np.cumsum(shares) - shares

    def at(r: FloatArray) -> FloatArray:
        poses = np.empty((len(r), 4, 4))
        whose = np.clip(np.searchsorted(starts, r, side="right") - 1, 0, len(pieces) - 1)
        for k, piece in enumerate(pieces):
            mine = whose == k
            poses[mine] = piece.at((r[mine] - starts[k]) / shares[k])
        return _flat(poses)

    return _path(np.concatenate(targets), rates, at, task, sampling)


def circle(
    start: FloatArray,
    about: Circle,
    task: Task,
    sampling: Sampling,
    argument: str = "circle",
    index: Location = ("normal",),
) -> Path:
    """Return the path around a circle through the start's position.

    Args:
        start: First pose, 4x4, in base axes.
        about: The circle.
        task: The task space.
        sampling: Time law, duration, number of samples.
        argument: Name of the circle in errors.
        index: Place in it of the field that gives the plane, for errors.

    Raises:
        InvalidOption: The start lies on the axis, or the task has fewer than two positions.
    """
    n = about.normal / np.linalg.norm(about.normal)
    if len(task.positions) < 2:
        raise InvalidOption(
            say(
                "a circle needs two positions, but the task is {task}; choose xy or position",
                task=task.name,
            ),
            argument="task",
            value=task.name,
            known=("xy", "position"),
        )
    if len(task.positions) == 2:
        (missing,) = {0, 1, 2} - set(task.positions)
        if abs(abs(n[missing]) - 1) > 1e-9:
            raise InvalidOption(
                say(
                    "the circle leaves the plane of the task {task}; give the normal across it",
                    task=task.name,
                ),
                argument=argument,
                index=index,
            )
    arm = start[:3, 3] - about.center
    along = n * (n @ arm)
    arm = arm - along
    radius = np.linalg.norm(arm)
    if not radius > 1e-9:
        raise InvalidOption(
            say("the start lies on the circle's axis; give a center elsewhere"),
            argument=argument,
            index=("center",),
        )
    s = np.linspace(0, 1, sampling.samples)
    law = np.array(sampling.time_law.at(s)).T
    center, across = about.center + along, np.cross(n, arm)

    def at(r: FloatArray) -> FloatArray:
        angle = 2 * np.pi * about.turns * r[:, None]
        poses = np.repeat(start[None], len(r), axis=0)
        poses[:, :3, 3] = center + np.cos(angle) * arm + np.sin(angle) * across
        return _flat(poses)

    targets = at(law[:, 0])
    targets[0] = start[:3].reshape(12)
    rates = law * [1, 1 / sampling.tf, 1 / sampling.tf**2]
    return _path(targets, rates, at, task, sampling)


@dataclass(frozen=True)
class _Piece:
    """A straight line with a rotation about a fixed axis."""

    start: FloatArray
    shift: FloatArray
    turn: FloatArray

    @classmethod
    def between(cls, start: FloatArray, end: FloatArray, task: Task) -> _Piece:
        shift = end[:3, 3] - start[:3, 3]
        shift[[row for row in range(3) if row not in task.positions]] = 0.0
        turn = np.zeros(3)
        if task.own_axes:
            turn = _turn_onto(start[:3, 2], end[:3, 2], start[:3, 0])
        elif task.rotations == (2,):
            turn[2] = _turn_about_z(start, end)
        elif task.rotations:
            turn = rotation_vector(end[:3, :3] @ start[:3, :3].T)
        return cls(start, shift, turn)

    def at(self, r: FloatArray) -> FloatArray:
        poses = np.repeat(self.start[None], len(r), axis=0)
        poses[:, :3, 3] += r[:, None] * self.shift
        if self.turn.any():
            poses[:, :3, :3] = rotations(self.turn, r) @ self.start[:3, :3]
        return poses


def _turn_about_z(start: FloatArray, end: FloatArray) -> float:
    """Return the angle by which the horizontal part of an axis of the frame turns, in [-π, π].

    Defined for any tilt: a frame that points down has an angle about z as well, where the shortest
    rotation to an upright end has none. Of x and y, the axis nearer to the horizontal counts.
    """
    flat = np.minimum(*(np.hypot(T[0, :2], T[1, :2]) for T in (start, end)))
    k = int(np.argmax(flat))
    before, after = (np.arctan2(T[1, k], T[0, k]) for T in (start, end))
    return math.remainder(after - before, 2 * math.pi)


def _shares(pieces: Sequence[_Piece], intervals: int) -> list[int]:
    """Return the intervals of each piece, at least one, by its share of length and angle."""
    sizes = np.array([[np.linalg.norm(p.shift), np.linalg.norm(p.turn)] for p in pieces])
    sums = sizes.sum(axis=0)
    weights = (sizes / np.where(sums > 0, sums, 1)).sum(axis=1)
    weights = weights / weights.sum() if weights.sum() > 0 else np.full(len(pieces), 1 / len(sizes))
    spare = intervals - len(pieces)
    counts = 1 + np.floor(spare * weights).astype(int)
    rest = spare * weights - np.floor(spare * weights)
    for k in np.argsort(-rest, kind="stable")[: intervals - counts.sum()]:
        counts[k] += 1
    return [int(count) for count in counts]


def _path(
    targets: FloatArray,
    rates: FloatArray,
    at: Callable[[FloatArray], FloatArray],
    task: Task,
    sampling: Sampling,
) -> Path:
    t = np.linspace(0, sampling.tf, sampling.samples)
    first, last = targets[0].reshape(3, 4), targets[-1].reshape(3, 4)
    away = np.abs((last - first)[list(task.positions), 3]).max(initial=0.0)
    if task.own_axes:
        away = max(away, np.abs((last - first)[:, 2]).max())
    elif task.rotations:
        away = max(away, np.abs((last - first)[:, :3]).max())
    r, r_dot, r_ddot = np.ascontiguousarray(rates.T)
    return Path(targets, t, r, r_dot, r_ddot, bool(away <= CLOSED), at)


def _flat(poses: FloatArray) -> FloatArray:
    return np.ascontiguousarray(poses[:, :3, :].reshape(-1, 12))


def rotations(vector: FloatArray, parts: FloatArray) -> FloatArray:
    """Return rotations by parts, shape (n,), of a rotation vector; shape (n, 3, 3)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / angle
    S = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    by = angle * parts[:, None, None]
    return np.asarray(np.eye(3) + np.sin(by) * S + 2 * np.sin(by / 2) ** 2 * (S @ S))


def rotation_vector(R: FloatArray) -> FloatArray:
    """Return the shortest rotation vector of a rotation, rad, shape (3,)."""
    T, G, e = np.zeros(12), np.zeros(12), np.empty(6)
    T[[0, 5, 10]] = 1.0
    G.reshape(3, 4)[:, :3] = R
    twist_error(T, G, e)
    return e[3:].copy()


def _turn_onto(z: FloatArray, goal: FloatArray, across: FloatArray) -> FloatArray:
    """Return the shortest rotation vector from z onto a goal; half a turn goes about ``across``."""
    axis = np.cross(z, goal)
    s, c = float(np.linalg.norm(axis)), float(z @ goal)
    if s < 1e-12:
        return np.zeros(3) if c > 0 else np.pi * across
    return np.asarray(axis * (np.arctan2(s, c) / s))
