"""The pieces of a curve on which every joint is within its limits, with exact ends."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from kinematics.inverse.self_motion.curve import Curve, Stop
from robots.robot import FloatArray

TURN = 2.0 * np.pi
EXACT = 1e-13
"""Difference from a limit, rad or m, that is none."""
ROUND = 1e-9
"""Excess of a limit, rad or m, that is rounding."""
TOGETHER = 1e-9
"""Difference of places on a curve, in steps, that are one."""
NEARBY = 0.05
"""Distance from a limit, rad or m, within which a joint's turning point is sought exactly."""


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of the joints of a chain.

    Attributes:
        lower: Shape (K,), rad and m; -inf where none.
        upper: Likewise.
        is_periodic: True where whole turns change nothing, shape (K,).
    """

    lower: FloatArray
    upper: FloatArray
    is_periodic: NDArray[np.bool_]

    @property
    def matters(self) -> NDArray[np.bool_]:
        """True where a joint cannot have every value, turns aside; shape (K,)."""
        whole = self.is_periodic & (self.upper - self.lower >= TURN - ROUND)
        limited = np.isfinite(self.lower) | np.isfinite(self.upper)
        return np.asarray(limited & ~whole)

    def turns(self, q: FloatArray) -> FloatArray:
        """Return the angle to add to each joint so that it is nearest to its range; shape (K,)."""
        with np.errstate(invalid="ignore"):
            middle = np.where(self.matters, 0.5 * (self.lower + self.upper), q)
        middle = np.where(np.isfinite(middle), middle, q)
        turns = np.round((middle - q) / TURN) * TURN
        return np.asarray(np.where(self.is_periodic & self.matters, turns, 0.0))

    def excess(self, q: FloatArray) -> FloatArray:
        """Return by how much each joint is beyond its limits, turns aside; 0 where it is not."""
        there = q + self.turns(q)
        over = np.maximum(np.maximum(self.lower - there, there - self.upper), 0.0)
        return np.asarray(np.where(self.matters, over, 0.0))


@dataclass(frozen=True)
class LimitMet:
    """A joint that is at its limit where a piece ends.

    Attributes:
        joint: Number in the chain.
        upper: Whether it is the upper one.
    """

    joint: int
    upper: bool


@dataclass(frozen=True)
class Piece:
    """A piece of a curve.

    Attributes:
        start: Place of its start on the curve.
        end: Place of its end, not before the start.
        whole: Whether it is a whole closed curve.
        met: Limits that are met at the start, and at the end; none where the curve itself ends.
        stops: Why the curve itself ends there.
    """

    start: float
    end: float
    whole: bool = False
    met: tuple[tuple[LimitMet, ...], tuple[LimitMet, ...]] = ((), ())
    stops: tuple[Stop | None, Stop | None] = (None, None)


def pieces(curve: Curve, limits: Limits) -> tuple[Piece, ...]:
    """Return the pieces of a curve within limits, in the order of the curve.

    Every place where a joint passes a limit is bracketed, between nodes and turning points of the
    joint, and found by Brent's method. Where limits allow a single point, the piece has length 0.

    Args:
        curve: The curve.
        limits: Of its joints.
    """
    cuts: list[tuple[float, LimitMet]] = []
    for k in np.flatnonzero(limits.matters):
        cuts += _cuts(curve, limits, int(k))
    cuts.sort(key=lambda cut: cut[0])
    places = _distinct([u for u, _ in cuts])
    if not places:
        if limits.excess(curve.at(0.5)).any():
            return ()
        return (Piece(0.0, curve.last, curve.closed, stops=_stops(curve, 0.0, curve.last)),)
    if curve.closed:
        edges = [*places, places[0] + curve.last]
    else:
        edges = _distinct([0.0, *places, float(curve.last)])
    inside = [not limits.excess(curve.at(0.5 * (a + b))).any() for a, b in pairwise(edges)]
    if curve.closed and all(inside):
        return (Piece(0.0, curve.last, True),)
    found = _joined(edges, inside, curve.closed, curve.last)
    for u in places:
        alone = not any(_holds(one, u, curve) for one in found)
        if alone and (limits.excess(curve.at(u)) <= ROUND).all():
            found.append((u, u))
    return tuple(
        Piece(
            a,
            b,
            False,
            (_met(cuts, a, curve), _met(cuts, b, curve)),
            _stops(curve, a, b),
        )
        for a, b in sorted(found)
    )


def _distinct(places: list[float]) -> list[float]:
    kept: list[float] = []
    for u in sorted(places):
        if not kept or u - kept[-1] > TOGETHER:
            kept.append(u)
    return kept


def _joined(
    edges: list[float], inside: list[bool], closed: bool, last: float
) -> list[tuple[float, float]]:
    """Return intervals of which adjacent ones are one; around the seam of a closed curve too."""
    found: list[tuple[float, float]] = []
    for (a, b), within in zip(pairwise(edges), inside, strict=True):
        if not within:
            continue
        if found and found[-1][1] == a:
            found[-1] = found[-1][0], b
        else:
            found.append((a, b))
    if closed and len(found) > 1 and found[0][0] == edges[0] and found[-1][1] == edges[-1]:
        first = found.pop(0)
        found[-1] = found[-1][0], first[1] + last
    return found


def _holds(piece: tuple[float, float], u: float, curve: Curve) -> bool:
    rounds = (0.0, float(curve.last)) if curve.closed else (0.0,)
    return any(piece[0] - TOGETHER <= u + more <= piece[1] + TOGETHER for more in rounds)


def _met(cuts: list[tuple[float, LimitMet]], u: float, curve: Curve) -> tuple[LimitMet, ...]:
    places = {u, u - curve.last} if curve.closed else {u}
    met = {one for at, one in cuts if any(abs(at - place) <= 2.0 * TOGETHER for place in places)}
    return tuple(sorted(met, key=lambda one: one.joint))


def _stops(curve: Curve, start: float, end: float) -> tuple[Stop | None, Stop | None]:
    if curve.closed:
        return None, None
    return (
        curve.stops[0] if start <= TOGETHER else None,
        curve.stops[1] if end >= curve.last - TOGETHER else None,
    )


def _cuts(curve: Curve, limits: Limits, k: int) -> list[tuple[float, LimitMet]]:
    """Return the places where a joint is at a limit."""
    values = curve.q[:, k]
    lowest, highest = float(values.min()) - NEARBY, float(values.max()) + NEARBY
    found: list[tuple[float, LimitMet]] = []
    for upper, limit in ((False, float(limits.lower[k])), (True, float(limits.upper[k]))):
        if not np.isfinite(limit):
            continue
        turns = [0.0]
        if limits.is_periodic[k]:
            first, last = np.ceil((lowest - limit) / TURN), np.floor((highest - limit) / TURN)
            turns = [TURN * m for m in np.arange(first, last + 1)]
        for turn in turns:
            if lowest <= limit + turn <= highest:
                met = LimitMet(k, upper)
                found += [(u, met) for u in _crossings(curve, k, limit + turn)]
    return found


def _crossings(curve: Curve, k: int, value: float) -> list[float]:
    """Return the places where joint k has a value; of a closed curve those before its last."""

    def over(u: float) -> float:
        return float(curve.at(u)[k]) - value

    gaps = curve.q[:, k] - value
    turning = [(u, over(u)) for u in _turning_points(curve, k, gaps)]
    known = sorted([*((float(i), float(gap)) for i, gap in enumerate(gaps)), *turning])
    # A joint that turns back on its limit meets it, though rounding may say that it does not.
    found = [u for u, gap in turning if abs(gap) <= ROUND]
    for (a, f), (b, g) in pairwise(known):
        if abs(f) <= EXACT:
            found.append(a)
        elif f * g < 0.0 and abs(g) > EXACT:
            found.append(float(brentq(over, a, b, xtol=1e-15, rtol=1e-15)))
    if abs(known[-1][1]) <= EXACT:
        found.append(known[-1][0])
    return [u % curve.last for u in found] if curve.closed else found


def _turning_points(curve: Curve, k: int, gaps: FloatArray) -> list[float]:
    """Return places where joint k turns back beside a value that it may touch or pass there."""
    first, last = gaps[:1], gaps[-1:]
    if curve.closed:
        whole = gaps[-1] - gaps[0]
        first, last = gaps[-2:-1] - whole, gaps[1:2] + whole
    here = gaps
    before, after = np.concatenate((first, gaps[:-1])), np.concatenate((gaps[1:], last))
    # Turning away from the value never meets it: only a minimum above or a maximum below does.
    sign = np.sign(here)
    steps = np.maximum(np.abs(before - here), np.abs(after - here))
    turns = (sign * (before - here) >= 0.0) & (sign * (after - here) >= 0.0) & (steps > 0.0)
    found = []
    for i in np.flatnonzero(turns & (np.abs(here) < NEARBY + 2.0 * steps)):
        u = float(i)
        result = minimize_scalar(
            lambda x, s=sign[i]: s * float(curve.at(x)[k]),
            bounds=(max(u - 1.0, 0.0), min(u + 1.0, float(curve.last))),
            method="bounded",
            options={"xatol": 1e-9},
        )
        found.append(float(result.x))
    return found
