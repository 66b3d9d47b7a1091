"""Time-optimal motion of a followed path, judged by measurements, never by what toppra reports."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from dh_to_urdf.messages import chained, say
from kinematics.redundancy.clearance.sweep import RESOLUTION
from kinematics.redundancy.follow import PathResult
from kinematics.redundancy.measure import error_vectors, swept_between
from kinematics.redundancy.problem import TOUCH, PathProblem
from kinematics.redundancy.timing.toppra import (
    MOST_GRID,
    RetimeOptions,
    Spline,
    Timing,
    fastest,
    spline_through,
)
from kinematics.slices import slices
from robots.robot import FloatArray

LOOKS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Parts between two points of the grid at which speeds and accelerations are measured."""
STEPS = 4
"""Gauss-Newton steps towards the nearest pose of the path."""
NUDGE = 1e-6
MOST_PARTS = 64
"""Largest number of parts of an interval of the grid in which the clearance is swept."""
SLOWED, FINER = 1.005, 3
"""Factor of slowing down above which the grid is refined, and the refinement."""
HELD = 1e-6
"""Relative excess of measured speeds and accelerations at which limits count as held."""


class RetimeStatus(StrEnum):
    """Outcome of the timing.

    ``retimed``: a timing was found. ``no_motion``: the arm did not move. ``no_parametrisation``:
    toppra found no timing.
    """

    RETIMED = "retimed"
    NO_MOTION = "no_motion"
    NO_PARAMETRISATION = "no_parametrisation"


@dataclass(frozen=True, eq=False)
class Retimed:
    """A time-optimal motion; n samples equally spaced in time, one for an arm that does not move.

    Attributes:
        status: Outcome; without a timing there are no samples.
        success: Limits, speeds, accelerations, task path and clearance hold, as measured between
            samples as well, and the end is reached.
        message: The outcome in words.
        violations: Criteria that do not hold: tracking, limits, clearance, velocity, acceleration,
            completeness.
        duration: s; None without a timing.
        t: s, shape (n,).
        q: Configurations of all joints, shape (n, dof), rad and m.
        velocity: Shape (n, dof), rad/s and m/s.
        acceleration: Shape (n, dof), rad/s² and m/s²; discontinuous where the solution is.
        velocity_limits: Limits kept, inf where none, shape (dof,).
        acceleration_limits: Likewise.
        velocity_ratio: Largest speed relative to its limit.
        acceleration_ratio: Largest acceleration relative to its limit.
        slowed: Factor by which the whole motion was slowed down to keep the limits between the
            grid points of toppra; 1 for none.
        position_deviation: Largest distance from the task path as a curve, m.
        orientation_deviation: Largest angle to it, rad.
        clearance: A lower bound of the least clearance along the motion, m; inf without obstacles.
        limit_margin: Least distance of each of the arm's joints to its limits, shape (K,).
        warnings: Assumptions.
    """

    status: RetimeStatus
    success: bool
    message: str
    violations: tuple[str, ...]
    duration: float | None
    t: FloatArray
    q: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    velocity_limits: FloatArray
    acceleration_limits: FloatArray
    velocity_ratio: float
    acceleration_ratio: float
    slowed: float
    position_deviation: float
    orientation_deviation: float
    clearance: float
    limit_margin: FloatArray
    warnings: tuple[str, ...]


def motion_bytes(dof: int) -> int:
    """Return the bytes of each sample of a motion: joint values and their rates."""
    return 8 * (4 * dof + 10)


def grid_bytes(joints: int) -> int:
    """Return the bytes of the grid on which a motion is timed, and of what is measured on it."""
    return MOST_GRID * 8 * (30 * joints + 100)


def retimed(result: PathResult, options: RetimeOptions) -> Retimed:
    """Return the time-optimal motion along the path of a result.

    Raises:
        MethodUnavailable: toppra is not installed.
    """
    problem = result.problem
    arm = problem.arm
    Q = arm.reduced(result.q)
    velocity = arm.velocity.copy()
    if options.velocity is not None:
        velocity = np.minimum(velocity, options.velocity)
    acceleration = options.acceleration
    spline = spline_through(Q)
    if spline is None:
        return _standing(result, velocity, acceleration)
    while True:
        timing = fastest(spline, velocity, acceleration)
        if isinstance(timing, str):
            return _untimed(result, velocity, acceleration, timing)
        used = _used(timing, velocity, acceleration)
        slowed = max(1.0, used[0], np.sqrt(used[1]))
        if slowed <= SLOWED or len(spline.grid) * FINER > MOST_GRID:
            break
        spline = spline.finer(FINER)
    timing = timing.slowed(slowed)
    used = _used(timing, velocity, acceleration)
    along = spline.at(spline.grid, 0)
    r = np.interp(spline.index, np.arange(len(Q)), problem.path.r[: len(Q)])
    position, orientation = deviations(problem, along, r)
    clearance = _clearance(problem, spline, along)
    margin = np.minimum(along - arm.chain.lower, arm.chain.upper - along).min(axis=0)
    found = {
        "tracking": position > problem.tolerance.position
        or orientation > problem.tolerance.orientation,
        "limits": bool(margin.min() < -TOUCH),
        "clearance": clearance < problem.d_safe,
        "velocity": used[0] > 1 + HELD,
        "acceleration": used[1] > 1 + HELD,
        "completeness": not _arrived(result),
    }
    violations = tuple(name for name, broken in found.items() if broken)
    duration = float(timing.times[-1])
    t = np.linspace(0.0, duration, options.samples)
    return Retimed(
        RetimeStatus.RETIMED,
        not violations,
        _message(result, violations, duration, position, orientation, clearance, margin.min()),
        violations,
        duration,
        t,
        *_whole(problem, timing.at(t)),
        *_limits(problem, velocity, acceleration),
        *used,
        slowed,
        position,
        orientation,
        clearance,
        margin,
        _warnings(result, velocity),
    )


def deviations(problem: PathProblem, Q: FloatArray, r: FloatArray) -> tuple[float, float]:
    """Return the largest distances of configurations from the task path as a curve, m and rad.

    Measured to the nearest pose of the path, m and rad weighted equally, by Gauss-Newton from a
    first guess: never less than the true distance.

    Args:
        problem: The path problem.
        Q: Shape (n, K).
        r: First guesses of the nearest parts of the path, shape (n,).
    """
    least = error_vectors(problem.arm, Q, problem.path.at(r))
    best = np.linalg.norm(least, axis=1)
    for _ in range(STEPS):
        ahead, behind = np.minimum(r + NUDGE, 1.0), np.maximum(r - NUDGE, 0.0)
        rise = error_vectors(problem.arm, Q, problem.path.at(ahead))
        rise -= error_vectors(problem.arm, Q, problem.path.at(behind))
        rise /= (ahead - behind)[:, None]
        size = np.sum(rise**2, axis=1)
        here = error_vectors(problem.arm, Q, problem.path.at(r))
        step = np.sum(rise * here, axis=1) / np.where(size > 0, size, 1.0)
        r = np.clip(r - step, 0.0, 1.0)
        e = error_vectors(problem.arm, Q, problem.path.at(r))
        nearer = np.linalg.norm(e, axis=1) < best
        least[nearer], best[nearer] = e[nearer], np.linalg.norm(e[nearer], axis=1)
    position, orientation = (
        np.linalg.norm(least[:, :3], axis=1),
        np.linalg.norm(least[:, 3:], axis=1),
    )
    return float(position.max()), float(orientation.max())


def _used(timing: Timing, velocity: FloatArray, acceleration: FloatArray) -> tuple[float, float]:
    """Return the largest used parts of the limits, at ``LOOKS`` between all points of the grid."""
    steps = np.diff(timing.times)
    most = np.zeros(2)
    for part in slices(len(steps), len(LOOKS) * len(velocity)):
        k = np.repeat(np.arange(part.start, part.stop), len(LOOKS))
        _, v, a = timing.within(k, (steps[part, None] * LOOKS).reshape(-1))
        used = (np.abs(v) / velocity).max(), (np.abs(a) / acceleration).max()
        most = np.maximum(most, used)
    return float(most[0]), float(most[1])


def _clearance(problem: PathProblem, spline: Spline, along: FloatArray) -> float:
    """Return a lower bound of the clearance along the spline, m.

    Swept along chords, less the distance of the spline from them: a cubic piece of length h is at
    most ``h² max|q″| / 8`` off its chord. Where that is large, h is made shorter.
    """
    if not len(problem.obstacles):
        return np.inf
    bend = np.abs(spline.at(spline.grid, 2))
    steps = np.diff(spline.grid)
    # Within a piece the second derivative is linear: largest at an end.
    off = np.maximum(bend[1:], bend[:-1]) * steps[:, None] ** 2 / 8
    loss = off @ _levers(problem, along)
    parts = np.clip(np.ceil(np.sqrt(loss / RESOLUTION)), 1, MOST_PARTS).astype(np.int64)
    k = np.repeat(np.arange(len(steps)), parts)
    part = np.arange(len(k)) - np.repeat(np.cumsum(parts) - parts, parts)
    s = np.append(spline.grid[k] + steps[k] * part / parts[k], 1.0)
    swept = swept_between(problem, spline.at(s, 0))
    return float((swept - (loss / parts**2)[k]).min())


def _levers(problem: PathProblem, Q: FloatArray) -> FloatArray:
    """Return the largest distance of a link from each joint, m; 1 if prismatic.

    Shape (K,), by entries of q: of those that move several joints the sum.
    """
    chain, rows = problem.arm.chain, problem.links.rows
    Q = chain.values(Q)
    lengths = np.linalg.norm(chain.placements[1:, [3, 7, 11]], axis=1)
    lengths = lengths + np.where(chain.is_revolute, 0.0, np.abs(Q).max(axis=0))
    offsets = np.linalg.norm(rows[:, 3:9].reshape(-1, 2, 3), axis=2)
    ends = offsets[rows[:, :2] >= 0].max(initial=0.0)
    levers = np.where(chain.is_revolute, np.cumsum(lengths[::-1])[::-1] + ends, 1.0)
    return np.asarray(levers @ np.abs(chain.coupling)) if chain.is_coupled else levers


def _arrived(result: PathResult) -> bool:
    problem, measures = result.problem, result.measures
    return (
        len(result.q) == problem.path.samples
        and measures.position_error[-1] <= problem.tolerance.position
        and measures.orientation_error[-1] <= problem.tolerance.orientation
    )


def _whole(
    problem: PathProblem, motion: tuple[FloatArray, FloatArray, FloatArray]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the motion of all joints of the robot; joints outside the arm are fixed."""
    q, v, a = motion
    still = np.zeros(problem.arm.robot.dof)
    return (
        problem.arm.expanded(q, problem.start),
        problem.arm.expanded(v, still),
        problem.arm.expanded(a, still),
    )


def _limits(
    problem: PathProblem, velocity: FloatArray, acceleration: FloatArray
) -> tuple[FloatArray, FloatArray]:
    none = np.full(problem.arm.robot.dof, np.inf)
    return (
        problem.arm.expanded(velocity[None], none)[0],
        problem.arm.expanded(acceleration[None], none)[0],
    )


def _standing(result: PathResult, velocity: FloatArray, acceleration: FloatArray) -> Retimed:
    """Return the result for an arm that does not move."""
    problem, measures = result.problem, result.measures
    q, chain = result.q[:1], problem.arm.chain
    here = problem.arm.reduced(q[0])
    margin = np.minimum(here - chain.lower, chain.upper - here)
    least = float(measures.clearance[0])
    found = {
        "limits": bool(margin.min() < -TOUCH),
        "clearance": least < problem.d_safe,
        "completeness": not _arrived(result),
    }
    violations = tuple(name for name, broken in found.items() if broken)
    return Retimed(
        RetimeStatus.NO_MOTION,
        not violations,
        say("the arm does not move: there is nothing to time"),
        violations,
        0.0,
        np.zeros(1),
        q,
        np.zeros_like(q),
        np.zeros_like(q),
        *_limits(problem, velocity, acceleration),
        0.0,
        0.0,
        1.0,
        float(measures.position_error[0]),
        float(measures.orientation_error[0]),
        least,
        margin,
        (),
    )


def _untimed(
    result: PathResult, velocity: FloatArray, acceleration: FloatArray, message: str
) -> Retimed:
    """Return the result where there is no timing."""
    none = np.empty((0, result.problem.arm.robot.dof))
    return Retimed(
        RetimeStatus.NO_PARAMETRISATION,
        False,
        message,
        ("completeness",),
        None,
        np.empty(0),
        none,
        none,
        none,
        *_limits(result.problem, velocity, acceleration),
        np.nan,
        np.nan,
        1.0,
        np.nan,
        np.nan,
        np.nan,
        np.full(result.problem.arm.K, np.nan),
        (),
    )


def _warnings(result: PathResult, velocity: FloatArray) -> tuple[str, ...]:
    arm = result.problem.arm
    free = [name for name, most in zip(arm.names, velocity, strict=True) if np.isinf(most)]
    if not free:
        return ()
    return (
        say(
            "no speed limit is known of {free}{which}: only acceleration holds them"
            " back; give retime.velocity",
            free=", ".join(free[:8]),
            which=" …" if len(free) > 8 else "",
        ),
    )


def _message(
    result: PathResult,
    violations: tuple[str, ...],
    duration: float,
    position: float,
    orientation: float,
    clearance: float,
    margin: float,
) -> str:
    problem = result.problem
    if not violations:
        return say(
            "the path takes {duration:.4g} s, with tf it took {t:g} s",
            duration=duration,
            t=problem.path.t[-1],
        )
    words = {
        "tracking": say(
            "it deviates from the task path by {position:.4g} m, {orientation:.4g} rad",
            position=position,
            orientation=orientation,
        ),
        "limits": say("a joint is {margin:.4g} rad or m outside its limits", margin=-margin),
        "clearance": say(
            "the clearance falls to {clearance:.4g} m (d_safe is {d_safe:g})",
            clearance=clearance,
            d_safe=problem.d_safe,
        ),
        "velocity": say("a joint is too fast"),
        "acceleration": say("a joint accelerates too much"),
        "completeness": say("the path that was followed does not reach its end"),
    }
    remedy = say("; ask for more samples, or margin") if result.verdict.success else ""
    return say(
        "timed to {duration:.4g} s, but {violations}{remedy}",
        duration=duration,
        violations=chained("; ", (words[v] for v in violations)),
        remedy=remedy,
    )
