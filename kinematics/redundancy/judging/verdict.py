"""Verdict on a followed path, from measurements alone, never from what a solver reports."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from dh_to_urdf.messages import chained, say
from kinematics.inverse import IKStatus
from kinematics.redundancy.clearance.sweep import RESOLUTION
from kinematics.redundancy.measure import Measures, clearances_at, nearest_part
from kinematics.redundancy.problem import TOUCH, PathProblem
from kinematics.redundancy.reach import reach
from kinematics.redundancy.stop import Stop, StopReason
from kinematics.singularity import rank_of
from robots.robot import FloatArray

JUMP = 1.0
"""Motion of a joint in one sample, rad or m, beyond which a path that stays lost has diverged."""
HELD_BACK = 0.01
"""Clearance beyond d_safe, relative to the arm's length, at which an obstacle holds a link."""
ROUNDING = 1e-12
"""Error, m and rad, below which it is written as 0."""
STUCK = 1e-6
"""Motion, rad or m, below which an arm has not left its start."""
REACH_SECONDS = 0.2
REACH_RESTARTS = 100
AS_QP = say(
    "; these are the samples of qp: the program of the whole path found"
    " none that hold further, or had too little time"
)


class Reason(StrEnum):
    """Why a path was not followed.

    ``singular_start``: the task's Jacobian loses rank at the start, and no step leaves it.
    ``singular``: it loses rank on the way. ``unreachable``: a target of the path is out of reach
    within the limits, or was not reached by a search. ``diverged``: the steps grew without bound.
    ``infeasible``: the first target that is missed and the last are within reach, but not together
    with limits, speeds and clearance. ``collision``: a link meets
    an obstacle. ``clearance``: it comes nearer than d_safe. ``limits``: a joint leaves its
    limits. ``velocity``: a joint exceeds its speed limit. ``tracking``: the error is
    beyond the tolerance, such as the drift of an open loop. ``timeout``: the time was up.
    """

    SINGULAR_START = "singular_start"
    SINGULAR = "singular"
    UNREACHABLE = "unreachable"
    DIVERGED = "diverged"
    INFEASIBLE = "infeasible"
    COLLISION = "collision"
    CLEARANCE = "clearance"
    LIMITS = "limits"
    VELOCITY = "velocity"
    TRACKING = "tracking"
    TIMEOUT = "timeout"


@dataclass(frozen=True)
class Verdict:
    """Whether a path was followed.

    Attributes:
        success: Errors, limits, clearance (swept) and speeds hold at every sample, to the end.
        reason: Why not, None for a success.
        message: The reason in words, with sample, joint, obstacle and remedy.
        violations: Every criterion that does not hold: tracking, limits, clearance, velocity,
            completeness.
        tracked: Part of the path, 0 to 1, that was followed within the tolerance.
        first_lost: The first sample beyond the tolerance, or not computed; None for a success.
    """

    success: bool
    reason: Reason | None
    message: str
    violations: tuple[str, ...]
    tracked: float
    first_lost: int | None


def judge(
    problem: PathProblem,
    Q: FloatArray,
    measures: Measures,
    stop: Stop | None,
    constrained: bool,
) -> Verdict:
    """Judge joint values of shape (n, K) by their measures.

    Args:
        problem: The path problem.
        Q: Joint values, n of N samples.
        measures: Measures of Q.
        stop: Why the method stopped before the end, or fell back to another.
        constrained: Whether the method keeps limits and clearance where it can.
    """
    N = problem.path.samples
    failing = np.flatnonzero(measures.off_path(problem.tolerance))
    first_lost = int(failing[0]) if failing.size else (len(Q) if len(Q) < N else None)
    violations = _violations(problem, measures, first_lost, len(Q) < N)
    told = ""
    if stop is not None and stop.reason is StopReason.AS_QP:
        told, stop = AS_QP, None
    if not violations:
        return Verdict(True, None, say("the path is followed{told}", told=told), (), 1.0, None)
    tracked = 1.0 if first_lost is None else float(problem.path.r[max(0, first_lost - 1)])
    reason, message = _reason(problem, Q, measures, stop, constrained, violations, first_lost)
    return Verdict(False, reason, chained("", (message, told)), violations, tracked, first_lost)


def violated_at(problem: PathProblem, measures: Measures) -> list[tuple[str, ...]]:
    """Return the criteria that do not hold at each sample: tracking, limits, clearance, velocity.

    A clearance between two samples and a speed from one to the next count for the later one.
    """
    swept = np.concatenate(([np.inf], measures.swept))
    fast = np.concatenate(([0.0], measures.speed_ratio))
    found = {
        "tracking": measures.off_path(problem.tolerance),
        "limits": measures.limit_margin < -TOUCH,
        "clearance": np.minimum(measures.clearance, swept) < problem.d_safe,
        "velocity": fast > 1 + TOUCH,
    }
    rows = zip(*(values.tolist() for values in found.values()), strict=True)
    return [tuple(name for name, one in zip(found, row, strict=True) if one) for row in rows]


def _violations(
    problem: PathProblem, measures: Measures, first_lost: int | None, cut: bool
) -> tuple[str, ...]:
    found = {
        "tracking": first_lost is not None,
        "limits": bool(measures.limit_margin.min() < -TOUCH),
        "clearance": measures.min_swept < problem.d_safe,
        "velocity": bool(measures.speed_ratio.max(initial=0.0) > 1 + TOUCH),
        "completeness": cut,
    }
    return tuple(name for name, holds in found.items() if holds)


def _reason(
    problem: PathProblem,
    Q: FloatArray,
    measures: Measures,
    stop: Stop | None,
    constrained: bool,
    violations: tuple[str, ...],
    first_lost: int | None,
) -> tuple[Reason, str]:
    rank = _rank(problem, Q[0])
    m, name = problem.arm.m, problem.arm.task.name
    if stop is not None and stop.reason is StopReason.TIME:
        return Reason.TIMEOUT, (
            say(
                "the time was over before sample {sample}; ask for fewer samples",
                sample=stop.sample,
            )
        )
    if stop is not None and stop.reason is StopReason.RANK:
        way = (
            say("use damped, or leave the start with perturb")
            if stop.sample <= 1
            else say("use damped")
        )
        if m > problem.arm.K or (rank < m and _never(problem)):
            way = say(
                "task {name} has {m} rows, more than this arm can move; choose xy or another",
                name=name,
                m=m,
            )
        message = say(
            "refused: rank(J) = {rank} < {m} before sample {sample}, J† = Jᵀ(JJᵀ)⁻¹"
            " does not exist; {way}",
            rank=stop.rank,
            m=m,
            sample=stop.sample,
            way=way,
        )
        return (Reason.SINGULAR_START if stop.sample <= 1 else Reason.SINGULAR), message
    moved = float(np.abs(Q - Q[0]).max())
    if first_lost is not None:
        stuck = first_lost < len(Q) and np.abs(Q[first_lost] - Q[0]).max() < STUCK
        if rank < m and stuck and _reached(problem, first_lost) is IKStatus.CONVERGED:
            return Reason.SINGULAR_START, (
                say(
                    "rank(J) = {rank} < {m} at the start, and no step leads towards sample"
                    " {first_lost}: the arm moved by {moved:.2g}; leave the start with"
                    " perturb, such as 0.05",
                    rank=rank,
                    m=m,
                    first_lost=first_lost,
                    moved=moved,
                )
            )
        away = _unreachable(problem, first_lost)
        jumped = not constrained and measures.largest_step > JUMP
        beyond = "" if away is None else say("; {away}", away=away)
        if stop is not None:
            unit = "rad" if problem.arm.chain.is_revolute[stop.joint] else "m"
            return Reason.DIVERGED, (
                say(
                    "the steps grew after sample {first_lost}: joint {name} would move by"
                    " {motion:.3g} {unit} to sample {sample}, out of its branch; use"
                    " damped, or qp{beyond}",
                    first_lost=first_lost,
                    name=problem.arm.names[stop.joint],
                    motion=stop.motion,
                    unit=unit,
                    sample=stop.sample,
                    beyond=beyond,
                )
            )
        if jumped and measures.off_path(problem.tolerance)[-1]:
            return Reason.DIVERGED, (
                say(
                    "the steps grew after sample {first_lost}, up to {largest_step:.3g} rad"
                    " or m in one{beyond}",
                    first_lost=first_lost,
                    largest_step=measures.largest_step,
                    beyond=beyond,
                )
            )
        if away is not None:
            return Reason.UNREACHABLE, (
                say(
                    "{away}; the path is lost {where} (tolerance {problem}); the end is"
                    " missed by {missed}",
                    away=away,
                    where=_where(problem, measures, first_lost),
                    problem=_allowed(problem),
                    missed=_missed(measures),
                )
            )
    if constrained:
        return Reason.INFEASIBLE, _conflict(problem, Q, measures, violations, first_lost)
    least = measures.min_swept
    if "clearance" in violations:
        kind = Reason.COLLISION if least < 0 else Reason.CLEARANCE
        return kind, _clearance(problem, Q, measures)
    if "limits" in violations:
        return Reason.LIMITS, _limits(problem, Q)
    if first_lost is not None:
        return Reason.TRACKING, (
            say(
                "the error is over the tolerance, {problem}, {where}, up to {measures};"
                " the end is missed by {missed}",
                problem=_allowed(problem),
                where=_where(problem, measures, first_lost),
                measures=_largest(measures),
                missed=_missed(measures),
            )
        )
    return Reason.VELOCITY, _velocity(problem, Q)


def _rank(problem: PathProblem, q: FloatArray) -> int:
    _, J, _ = problem.arm.task_at(q, problem.path.targets[0])
    sigma = np.asarray(np.linalg.svd(J, compute_uv=False), np.float64)
    return int(rank_of(sigma))


def _never(problem: PathProblem) -> bool:
    """Return whether the task loses rank at another q as well: the arm cannot do it anywhere."""
    k = np.arange(problem.arm.K)
    return _rank(problem, problem.first + 0.3 * np.sin(1.0 + 2.0 * k)) < problem.arm.m


def _reached(problem: PathProblem, sample: int) -> IKStatus:
    """Return how a solve for the target of a sample ends, with some time and restarts."""
    return reach(
        problem, sample, problem.start, restarts=REACH_RESTARTS, seconds=REACH_SECONDS
    ).status


def _unreachable(problem: PathProblem, first_lost: int) -> str | None:
    """Say that no q within the limits reaches the first lost or the last sample, or was found."""
    for sample in (first_lost, problem.path.samples - 1):
        status = _reached(problem, sample)
        if status is IKStatus.UNREACHABLE:
            return say("sample {sample} is out of reach within the limits", sample=sample)
        if status is not IKStatus.CONVERGED:
            return say(
                "no q within the limits was found that reaches sample {sample}", sample=sample
            )
    return None


def _where(problem: PathProblem, measures: Measures, first_lost: int) -> str:
    """Describe which samples are lost: all from the first on, or some of them."""
    lost, N = measures.off_path(problem.tolerance), problem.path.samples
    count = int(lost.sum()) + N - len(lost)
    if first_lost + count == N:
        return say("from sample {first_lost} on", first_lost=first_lost)
    return say(
        "at {count} of {n} samples, the first of them {first_lost}",
        count=count,
        n=N,
        first_lost=first_lost,
    )


def _largest(measures: Measures) -> str:
    return _errors(measures.position_error.max(), measures.orientation_error.max())


def _allowed(problem: PathProblem) -> str:
    """Write the tolerance of the path."""
    return _errors(problem.tolerance.position, problem.tolerance.orientation)


def _missed(measures: Measures) -> str:
    return _errors(measures.position_error[-1], measures.orientation_error[-1])


def _errors(position: float, orientation: float) -> str:
    """Write errors; those that are rounding are zero."""
    m, rad = (0.0 if value < ROUNDING else value for value in (position, orientation))
    return say("{m:.4g} m, {rad:.4g} rad", m=m, rad=rad)


def _conflict(
    problem: PathProblem,
    Q: FloatArray,
    measures: Measures,
    violations: tuple[str, ...],
    first_lost: int | None,
) -> str:
    if measures.clearance[0] < problem.d_safe:
        return say(
            "the start itself is too near: {clearance}", clearance=_clearance(problem, Q, measures)
        )
    parts: list[str] = []
    if first_lost is not None:
        parts.append(
            say(
                "{both} within reach, but the path is lost {where}: the targets were"
                " not met within the tolerance, {problem}, together with limits, speeds"
                " and clearance{held}; the end is missed by {missed}",
                both=_both(problem, first_lost),
                where=_where(problem, measures, first_lost),
                problem=_allowed(problem),
                held=_held(problem, Q, measures, first_lost),
                missed=_missed(measures),
            )
        )
    if "clearance" in violations:
        parts.append(_clearance(problem, Q, measures))
    if "limits" in violations:
        parts.append(_limits(problem, Q))
    if "velocity" in violations:
        parts.append(_velocity(problem, Q))
    return chained("; ", parts)


def _held(problem: PathProblem, Q: FloatArray, measures: Measures, first_lost: int) -> str:
    """Name what holds the arm at the first lost sample: obstacle, limits, speeds, its branch."""
    at = min(first_lost, len(Q) - 1)
    chain, names = problem.arm.chain, problem.arm.names
    holds = []
    if measures.clearance[at] < problem.d_safe + HELD_BACK * problem.scale:
        link, obstacle = measures.nearest[at]
        holds.append(
            say("{name} by obstacle {obstacle}", name=problem.links.names[link], obstacle=obstacle)
        )
    margin = np.minimum(Q[at] - chain.lower, chain.upper - Q[at])
    holds += [say("{name} at its limit", name=names[k]) for k in np.flatnonzero(margin < TOUCH)]
    if at:
        step = np.abs(Q[at] - Q[at - 1])
        fast = step > problem.most_per_step * (1 - TOUCH)
        holds += [say("{name} by its speed", name=names[k]) for k in np.flatnonzero(fast)]
        far = ~fast & (step > problem.near_step * (1 - TOUCH))
        holds += [say("{name} by its branch", name=names[k]) for k in np.flatnonzero(far)]
    return say(" (held: {holds})", holds=chained(", ", holds[:4])) if holds else ""


def _clearance(problem: PathProblem, Q: FloatArray, measures: Measures) -> str:
    """Describe the least clearance, at a sample or swept between two, and where it is."""
    at = int(np.argmin(measures.clearance))
    link, obstacle = measures.nearest[at]
    where = say("about sample {at}", at=at)
    if measures.swept.min(initial=np.inf) < measures.clearance[at] - 2 * RESOLUTION:
        at = int(np.argmin(measures.swept))
        part = nearest_part(problem, Q[at], Q[at + 1])
        _, nearest = clearances_at(problem, (Q[at] + part * (Q[at + 1] - Q[at]))[None])
        link, obstacle = nearest[0]
        where = say("between samples {at} and {at_2}", at=at, at_2=at + 1)
    return say(
        "the clearance falls to {min_swept:.4g} m (d_safe is {d_safe:g}),"
        " {name} to obstacle {obstacle} {where}",
        min_swept=measures.min_swept,
        d_safe=problem.d_safe,
        name=problem.links.names[link],
        obstacle=obstacle,
        where=where,
    )


def _both(problem: PathProblem, first_lost: int) -> str:
    """Name the samples whose targets were found to be within reach."""
    last = problem.path.samples - 1
    return (
        say("sample {last} is", last=last)
        if first_lost == last
        else say("samples {first_lost} and {last} are", first_lost=first_lost, last=last)
    )


def _limits(problem: PathProblem, Q: FloatArray) -> str:
    chain = problem.arm.chain
    outside = np.maximum(chain.lower - Q, Q - chain.upper)
    at, joint = np.unravel_index(int(np.argmax(outside)), outside.shape)
    unit = "rad" if chain.is_angle[joint] else "m"
    return say(
        "joint {name} is {outside:.4g} {unit} outside its limits at sample {at}",
        name=problem.arm.names[joint],
        outside=outside[at, joint],
        unit=unit,
        at=at,
    )


def _velocity(problem: PathProblem, Q: FloatArray) -> str:
    ratio = np.abs(np.diff(Q, axis=0)) / problem.most_per_step
    at, joint = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
    return say(
        "joint {name} would be {ratio:.3g} times as fast as it may be before"
        " sample {at}; give at least tf {t:.4g}",
        name=problem.arm.names[joint],
        ratio=ratio[at, joint],
        at=at + 1,
        t=problem.path.t[-1] * ratio.max(),
    )
