"""The self-motions of an arm with a spherical shoulder and wrist, one a branch, by swivel angle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinematics.chain import Chain
from kinematics.deadline import checkpoint
from kinematics.inverse.closed_form import ClosedForm, solutions
from kinematics.inverse.continuation.settling import settle
from kinematics.inverse.self_motion.curve import Curve, Stop
from kinematics.inverse.task_error import task_chain
from kinematics.inverse.windings import on_circle
from kinematics.task import Task
from robots.robot import FloatArray

FIRST_NODES = 48
JUMP = 0.35
"""Largest change of a joint from one node to the next, rad."""
FINEST = 2e-5
"""Swivel angle, rad, below which nodes are not brought closer: joints jump there."""
TURN = 2.0 * np.pi

Codes = tuple[int, ...]
Branches = dict[Codes, FloatArray]


@dataclass(frozen=True, eq=False)
class SwivelCurve:
    """A branch of the closed form, over the swivel angles at which it exists.

    Attributes:
        curve: Its joint values.
        swivels: Swivel angles of the nodes, increasing, rad; shape (N,).
    """

    curve: Curve
    swivels: FloatArray

    def swivel(self, u: float) -> float:
        """Return the swivel angle at a place on the curve, rad, beyond its last by whole turns."""
        rounds = np.floor(u / self.curve.last) if u > self.curve.last else 0.0
        rest = u - rounds * self.curve.last
        nodes = np.arange(len(self.swivels))
        return float(np.interp(rest, nodes, self.swivels) + rounds * TURN)

    def place(self, swivel: float) -> float | None:
        """Return the place of a swivel angle, rad; None: the branch does not exist there."""
        turned = self.swivels[0] + (swivel - self.swivels[0]) % TURN
        if turned > self.swivels[-1]:
            return None
        return float(np.interp(turned, self.swivels, np.arange(len(self.swivels))))


def swivel_curves(
    form: ClosedForm,
    chain: Chain,
    task: Task,
    target: FloatArray,
    given: FloatArray,
    first: float,
) -> tuple[SwivelCurve, ...]:
    """Return the branches of a target.

    Args:
        form: Of kind ``srs``.
        chain: Its joints are all free.
        task: One of the form's tasks.
        target: Pose of the frame in base axes, shape (4, 4), m.
        given: Values for joints that a singular branch leaves free, shape (K,).
        first: Swivel angle of the first node, rad.
    """

    def branches(swivel: float) -> Branches:
        angle = float((swivel + np.pi) % TURN - np.pi)
        found = solutions(form, chain, target, task=task, given=given, swivel=angle)
        loose = [bool(free.any()) for free in found.free]
        return {
            tuple(codes): q
            for codes, q, free in zip(found.codes.tolist(), found.q, loose, strict=True)
            if not free
        }

    swivels = list(first + np.arange(FIRST_NODES) * (TURN / FIRST_NODES))
    known = [branches(swivel) for swivel in swivels]
    if not any(known):
        return ()
    swivels.append(first + TURN)
    known.append(known[0])
    swivels, known = _refined(swivels, known, branches)
    made = []
    for codes in sorted({codes for one in known for codes in one}):
        made += _curves(codes, swivels, known, branches, chain, task, target)
    return tuple(made)


def _refined(
    swivels: list[float], known: list[Branches], branches: Callable[[float], Branches]
) -> tuple[list[float], list[Branches]]:
    """Put nodes between those from one of which to the next a joint changes much."""
    angles, values = [swivels[0]], [known[0]]
    waiting = list(zip(swivels[:0:-1], known[:0:-1], strict=True))
    while waiting:
        checkpoint()
        b, there = waiting[-1]
        a, here = angles[-1], values[-1]
        if b - a > FINEST and _jumps(here, there):
            middle = 0.5 * (a + b)
            waiting.append((middle, branches(middle)))
            continue
        waiting.pop()
        angles.append(b)
        values.append(there)
    return angles, values


def _jumps(here: Branches, there: Branches) -> bool:
    if here.keys() != there.keys():
        return True
    return any(_change(here[codes], there[codes]) > JUMP for codes in here)


def _change(q: FloatArray, other: FloatArray) -> float:
    return float(np.abs(on_circle(q - other, np.ones(len(q), dtype=np.bool_))).max())


def _curves(
    codes: Codes,
    swivels: list[float],
    known: list[Branches],
    branches: Callable[[float], Branches],
    chain: Chain,
    task: Task,
    target: FloatArray,
) -> list[SwivelCurve]:
    """Return one branch as curves: where it does not exist, or jumps, one ends."""
    runs: list[list[tuple[float, FloatArray]]] = [[]]
    for angle, one in zip(swivels, known, strict=True):
        q = one.get(codes)
        if q is None or (runs[-1] and _change(q, runs[-1][-1][1]) > JUMP):
            runs.append([])
        if q is not None:
            runs[-1].append((angle, q))
    closed = len(runs) == 1
    if not closed and runs[0] and runs[-1] and runs[0][0][0] == swivels[0]:
        # The turn begins in the middle of a curve.
        later = [(angle + TURN, q) for angle, q in runs.pop(0)]
        if runs[-1][-1][0] == swivels[-1] and _change(runs[-1][-1][1], later[0][1]) < 1e-9:
            later = later[1:]
            runs[-1] += later
        else:
            runs.append(later)
    return [_one(codes, run, closed, branches, chain, task, target) for run in runs if len(run) > 1]


def _one(
    codes: Codes,
    run: list[tuple[float, FloatArray]],
    closed: bool,
    branches: Callable[[float], Branches],
    chain: Chain,
    task: Task,
    target: FloatArray,
) -> SwivelCurve:
    swivels = np.array([angle for angle, _ in run])
    q = np.array([values for _, values in run])
    for k in range(1, len(q)):
        q[k] = q[k - 1] + on_circle(q[k] - q[k - 1], chain.is_revolute)
    constants = task_chain(chain, task)

    def between(u: float) -> FloatArray:
        k = min(int(u), len(q) - 2)
        guess = q[k] + (u - k) * (q[k + 1] - q[k])
        found = branches(float(swivels[k] + (u - k) * (swivels[k + 1] - swivels[k]))).get(codes)
        if found is None:
            # Two branches are one there.
            settle(constants, target, guess, np.empty(2))
            return np.asarray(guess)
        return np.asarray(guess + on_circle(found - guess, chain.is_revolute))

    stops = (Stop.SINGULARITY, Stop.SINGULARITY)
    return SwivelCurve(Curve(q, closed, between, stops, codes), swivels)
