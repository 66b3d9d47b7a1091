"""All self-motions of an arm at a target, within its limits, and solutions that stand for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from dh_to_urdf.messages import plural, say
from kinematics.chain import Chain
from kinematics.inverse.closed_form import ClosedForm, swivel_of
from kinematics.inverse.self_motion.curve import Curve, Stop
from kinematics.inverse.self_motion.parameter import parameter_of, points, slice_values
from kinematics.inverse.self_motion.pieces import TURN, LimitMet, Limits, Piece, pieces
from kinematics.inverse.self_motion.result import CurveEnd, SelfMotion, SelfMotionCurve
from kinematics.inverse.self_motion.swivel_curves import SwivelCurve, swivel_curves
from kinematics.inverse.self_motion.tracing import Motion, is_on, trace
from kinematics.inverse.windings import on_circle, turned
from kinematics.task import Task
from robots.robot import FloatArray, Robot

MOST_SAMPLES = 48
"""Samples of a curve in an answer."""
STILL = 1e-9
"""Motion of a joint along a curve that is none, rad or m."""


@dataclass(frozen=True, eq=False)
class Representative:
    """A solution that stands for a self-motion.

    Attributes:
        q: Within the limits where the curve is; shape (dof,).
        free: Joints that move alone along the curve.
        swivel: Swivel angle, rad, where the arm has one.
        posture: Names of its branch.
    """

    q: FloatArray
    free: tuple[str, ...]
    swivel: float | None
    posture: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Family:
    """The self-motions of an arm at a target.

    Attributes:
        motion: What is told of them.
        representatives: Solutions on them; beyond the limits where all curves are.
        description: How they were found.
    """

    motion: SelfMotion
    representatives: tuple[Representative, ...]
    description: str


@dataclass(frozen=True, eq=False)
class _Asked:
    robot: Robot
    chain: Chain
    start: FloatArray

    @property
    def limits(self) -> Limits:
        return Limits(self.chain.lower, self.chain.upper, self.chain.is_periodic)

    def whole(self, values: FloatArray) -> FloatArray:
        """Return q of joint values, turned towards the start; where it touches a limit, on it."""
        q = self.start.copy()
        q[self.chain.columns] = values
        q = turned(self.robot, q, self.start, self.chain)
        inside = np.clip(q, self.robot.lower, self.robot.upper)
        return inside if float(np.abs(inside - q).max(initial=0.0)) <= 1e-9 else q


def swivel_family(
    robot: Robot,
    chain: Chain,
    form: ClosedForm,
    task: Task,
    target: FloatArray,
    start: FloatArray,
    wished: float | None = None,
) -> Family:
    """Return the self-motions of an arm with a spherical shoulder and wrist, a branch each.

    Args:
        robot: The robot.
        chain: Its joints are all free.
        form: Of kind ``srs``.
        task: One of the form's tasks.
        target: Pose of the frame in base axes, shape (4, 4), m.
        start: The seed, shape (dof,), rad and m.
        wished: Swivel angle, rad, to which each representative is nearest; None: the seed.
    """
    asked = _Asked(robot, chain, start)
    given = start[chain.columns]
    first = swivel_of(form, given) if wished is None else wished
    branches = swivel_curves(form, chain, task, target, given, first)
    told: list[SelfMotionCurve] = []
    representatives: list[Representative] = []
    for branch in branches:
        names = _posture(form, branch)
        found = pieces(branch.curve, asked.limits)
        told += [_told(asked, branch.curve, one, _swivels(branch), names) for one in found]
        if wished is None:
            places = [u for one in found for u in _places(asked, branch.curve, one)]
        else:
            places = [_nearest_swivel(branch, one, wished) for one in found]
            gaps = [_gap(branch, u, wished) for u in places]
            places = [places[int(np.argmin(gaps))]] if places else []
        for u in places:
            q = asked.whole(branch.curve.at(u))
            angle = float((branch.swivel(u) + np.pi) % TURN - np.pi)
            representatives.append(Representative(q, (), angle, names))
    proved = all(branch.curve.closed for branch in branches)
    motion = SelfMotion(1, "swivel", proved, len(branches), _ordered(told, start))
    return Family(motion, tuple(representatives), "")


def joint_family(
    robot: Robot,
    chain: Chain,
    task: Task,
    target: FloatArray,
    start: FloatArray,
    known: FloatArray | None = None,
) -> Family | None:
    """Return the self-motions of any arm with one joint more than the task has rows.

    Args:
        robot: The robot.
        chain: Its joints to the frame.
        task: The task.
        target: Pose of the frame in base axes, shape (4, 4), m.
        start: The seed, shape (dof,), rad and m.
        known: A solution that is known, shape (K,).

    Returns:
        None where the arm is another.
    """
    chosen = parameter_of(chain, task)
    if chosen is None:
        return None
    joint, fibre = chosen
    asked, motion = _Asked(robot, chain, start), Motion(chain, task, target)
    seed = start[chain.columns]
    values = slice_values(motion, joint, asked.limits, float(seed[joint]))
    curves: list[Curve] = []
    alone: list[FloatArray] = []
    for point in points(motion, joint, fibre, values, (seed, known)):
        if any(is_on(motion, curve, point) for curve in curves):
            continue
        curve = trace(motion, point)
        if curve is not None:
            curves.append(curve)
        elif all(float(np.abs(motion.apart(point, one)).max()) > 1e-3 for one in alone):
            alone.append(point)
    told: list[SelfMotionCurve] = []
    representatives: list[Representative] = []
    for curve in curves:
        free = _free(chain, curve)
        for piece in pieces(curve, asked.limits):
            told.append(_told(asked, curve, piece, _values(curve, joint), ()))
            representatives += [
                Representative(asked.whole(curve.at(u)), free, None, ())
                for u in _places(asked, curve, piece)[:2]
            ]
    representatives += [Representative(asked.whole(q), (), None, ()) for q in alone]
    if not told:
        representatives += [
            Representative(asked.whole(curve.at(_least_beyond(asked, curve))), (), None, ())
            for curve in curves
        ]
    name = chain.names[joint]
    description = say(
        "one joint more than the task needs: {curves} of solutions, {pieces} within the limits,"
        " followed from the solutions at {values} values of {joint}; each is shown where it is"
        " nearest to the seed, and at its middle",
        curves=plural("{count} curve", "{count} curves", count=len(curves)),
        pieces=plural("{count} piece", "{count} pieces", count=len(told)),
        values=len(values),
        joint=name,
    )
    motion_told = SelfMotion(1, name, False, len(curves), _ordered(told, start))
    return Family(motion_told, tuple(representatives), description)


Parameter = Callable[[FloatArray, FloatArray], FloatArray]
"""Gives the parameter at places of a curve, for turns that its joints are moved by."""


def _swivels(branch: SwivelCurve) -> Parameter:
    def at(places: FloatArray, shift: FloatArray) -> FloatArray:
        del shift
        angles = np.array([branch.swivel(u) for u in places])
        return np.asarray(angles - np.floor((angles[0] + np.pi) / TURN) * TURN)

    return at


def _values(curve: Curve, joint: int) -> Parameter:
    def at(places: FloatArray, shift: FloatArray) -> FloatArray:
        return np.array([float(curve.at(u)[joint] + shift[joint]) for u in places])

    return at


def _posture(form: ClosedForm, branch: SwivelCurve) -> tuple[str, ...]:
    pairs = zip(form.postures, branch.curve.codes, strict=True)
    return tuple(names[code] for names, code in pairs if names[code])


def _free(chain: Chain, curve: Curve) -> tuple[str, ...]:
    moves = np.ptp(curve.q, axis=0) > STILL
    return (chain.names[int(np.argmax(moves))],) if np.count_nonzero(moves) == 1 else ()


def _ordered(told: list[SelfMotionCurve], start: FloatArray) -> tuple[SelfMotionCurve, ...]:
    return tuple(
        sorted(told, key=lambda one: float(np.linalg.norm(one.q - start, axis=1).min(initial=0.0)))
    )


def _inner(piece: Piece) -> FloatArray:
    """Return places from the start to the end of a piece, nodes between them."""
    nodes = np.arange(np.ceil(piece.start), np.floor(piece.end) + 1.0)
    return np.unique(np.concatenate(([piece.start], nodes, [piece.end])))


def _places(asked: _Asked, curve: Curve, piece: Piece) -> list[float]:
    """Return the places of a piece that are shown: nearest to the seed, middle, ends."""
    if piece.end <= piece.start:
        return [piece.start]

    limits, seed = asked.limits, asked.start[asked.chain.columns]
    turns = limits.turns(curve.at(0.5 * (piece.start + piece.end)))
    around = limits.is_periodic & ~limits.matters

    def away(u: float) -> float:
        return float(np.square(on_circle(curve.at(u) + turns - seed, around)).sum())

    inner = _inner(piece)
    distances = [away(u) for u in inner]
    best = int(np.argmin(distances))
    low, high = inner[max(best - 1, 0)], inner[min(best + 1, len(inner) - 1)]
    found = minimize_scalar(away, bounds=(low, high), method="bounded", options={"xatol": 1e-6})
    nearest = float(found.x) if found.fun < distances[best] else float(inner[best])
    middle = 0.5 * (piece.start + piece.end)
    return [nearest, middle] if piece.whole else [nearest, middle, piece.start, piece.end]


def _nearest_swivel(branch: SwivelCurve, piece: Piece, wished: float) -> float:
    """Return the place of a piece whose swivel angle is nearest to a wished one."""
    place = branch.place(wished)
    if place is not None:
        for u in (place, place + branch.curve.last):
            if piece.start <= u <= piece.end:
                return u
    return min((piece.start, piece.end), key=lambda u: _gap(branch, u, wished))


def _gap(branch: SwivelCurve, u: float, wished: float) -> float:
    """Return the difference of the swivel angle at a place from a wished one, rad."""
    return abs(float((branch.swivel(u) - wished + np.pi) % TURN - np.pi))


def _least_beyond(asked: _Asked, curve: Curve) -> float:
    """Return the node at which the joint that is farthest beyond its limits is so the least."""
    return float(np.argmin([asked.limits.excess(q).max() for q in curve.q]))


def _told(
    asked: _Asked,
    curve: Curve,
    piece: Piece,
    parameter: Parameter,
    posture: tuple[str, ...],
) -> SelfMotionCurve:
    inner = _inner(piece)
    values = np.array([curve.at(u) for u in inner])
    lower, upper = _range(curve, inner, values)
    shift = _shift(asked, values[len(values) // 2], lower, upper)
    shown = np.unique(np.linspace(0, len(inner) - 1, min(len(inner), MOST_SAMPLES)).round())
    shown = shown.astype(int)
    columns, start = asked.chain.columns, asked.start
    q, low, high = np.repeat(start[None], len(shown), axis=0), start.copy(), start.copy()
    q[:, columns] = values[shown] + shift
    low[columns], high[columns] = lower + shift, upper + shift
    bounds = asked.robot.lower, asked.robot.upper
    whole = np.round((values[-1] - values[0]) / TURN).astype(int)
    turns = np.zeros(len(start), dtype=int)
    turns[columns] = np.where(asked.chain.is_revolute, whole, 0) if piece.whole else 0
    ends = tuple(_ends(asked, met, stop) for met, stop in zip(piece.met, piece.stops, strict=True))
    return SelfMotionCurve(
        piece.whole,
        _touching(q, *bounds),
        parameter(inner[shown], shift),
        _touching(low, *bounds),
        _touching(high, *bounds),
        () if piece.whole else ends,
        posture,
        tuple(int(one) for one in turns),
    )


def _touching(q: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Return q whose values that are beyond a limit by rounding are on it."""
    inside = np.clip(q, lower, upper)
    return np.asarray(np.where(np.abs(inside - q) <= 1e-9, inside, q))


def _joint(curve: Curve, k: int, sign: float) -> Callable[[float], float]:
    def at(u: float) -> float:
        return sign * float(curve.at(u)[k])

    return at


def _range(curve: Curve, inner: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the smallest and largest value of each joint along a piece."""
    lower, upper = values.min(axis=0), values.max(axis=0)
    for k in np.flatnonzero(upper - lower > STILL):
        for sign, ends in ((1.0, lower), (-1.0, upper)):
            best = int(np.argmin(sign * values[:, k]))
            if 0 < best < len(inner) - 1:
                found = minimize_scalar(
                    _joint(curve, int(k), sign),
                    bounds=(inner[best - 1], inner[best + 1]),
                    method="bounded",
                    options={"xatol": 1e-5, "maxiter": 12},
                )
                ends[k] = sign * min(float(found.fun), sign * ends[k])
    return lower, upper


def _shift(asked: _Asked, middle: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Return the whole turns to add to each joint of a piece so that it is within the limits.

    Of a joint of more than a turn, those that keep its whole range within them where some do,
    else those that are nearest to the seed.
    """
    chain = asked.chain
    q = asked.start.copy()
    q[chain.columns] = middle
    shift = turned(asked.robot, q, asked.start, chain)[chain.columns] - middle
    shift = np.round(shift / TURN) * TURN
    for k in np.flatnonzero(chain.is_periodic):
        fits = [
            turn
            for turn in shift[k] + TURN * np.arange(-2, 3)
            if chain.lower[k] - 1e-9 <= lower[k] + turn and upper[k] + turn <= chain.upper[k] + 1e-9
        ]
        if fits:
            shift[k] = fits[int(np.argmin(np.abs(np.array(fits) - shift[k])))]
    return np.asarray(shift)


def _ends(asked: _Asked, met: tuple[LimitMet, ...], stop: Stop | None) -> tuple[CurveEnd, ...]:
    found = tuple(
        CurveEnd("limit", asked.chain.names[one.joint], "upper" if one.upper else "lower")
        for one in met
    )
    if found or stop is None:
        return found
    return (CurveEnd(stop.value),)
