"""How three joints place a point: which of the ways of ``regional`` and ``sliding`` solves them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dh_to_urdf.messages import say
from kinematics.inverse.closed_form import regional, sliding
from kinematics.inverse.closed_form.form import (
    ELBOW,
    EXTENDED,
    FRONT,
    ONE,
    RANKS,
    SIGN,
    Names,
    types_of,
)
from kinematics.inverse.closed_form.geometry import ANGLE, LENGTH, AxisLines
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class Placing:
    """How three joints place a point.

    Attributes:
        variant: Of :mod:`regional` or :mod:`sliding`.
        points: Of each axis, m, shape (3, 3).
        description: For people.
        postures: The two choices.
        forward: Direction of the front side, or its sign in the first entry; shape (3,).
        middle: Value of the slide where the point is nearest to the shoulder, m.
        slides: Whether the third joint slides, counted from the end where the arm begins with its
            slide.
        back: Whether it is solved from the tip.
        turning: Which joint turns, where one does.
        ranked: The joint by whose values solutions are named.
    """

    variant: int
    points: FloatArray
    description: str
    postures: tuple[Names, Names]
    forward: FloatArray
    middle: float = 0.0
    slides: bool = False
    back: bool = False
    turning: int = 0
    ranked: int | None = None

    def constants(self, lines: AxisLines) -> FloatArray:
        """Return the numbers from ``H1`` on, with those before them left to the caller."""
        return np.concatenate(
            (
                *lines.directions[:3],
                *self.points,
                self.forward,
                [self.middle, float(self.slides), float(self.back), float(self.turning)],
            )
        )


def placing(lines: AxisLines, point: FloatArray) -> Placing | None:
    """Classify how the first three joints place a point that they move; None where they do not."""
    first = replace(
        lines,
        directions=lines.directions[:3],
        points=lines.points[:3],
        is_revolute=lines.is_revolute[:3],
    )
    if not first.are_independent(point, slice(0, 3)):
        return None
    types = types_of(first.is_revolute.tolist())
    if types in ("RRR", "RRP"):
        return _forwards(first, point, types)
    if types == "PRR":
        return _backwards(first, point)
    if types == "RPR":
        return _slide_between(first)
    if types == "PPP":
        text = say("joints 1, 2 and 3 slide")
        return Placing(sliding.SLIDES_ALONE, first.points, text, (ONE, ONE), np.zeros(3))
    return _one_turn(first)


def _common(lines: AxisLines, point: FloatArray) -> tuple[int, FloatArray] | None:
    """Return what the first two axes and the third joint have in common, and points of the axes."""
    small, slides = LENGTH * lines.size, not lines.is_revolute[2]
    if not slides and lines.lever(2, point) <= small:
        return None
    p1, p2 = lines.feet(0, 1)
    if lines.parallel(0, 1):
        return regional.COLUMN, np.array([p1, p2, lines.foot(2, p2)])
    if not slides and lines.parallel(1, 2):
        return regional.ELBOW, np.array([p1, p2, lines.foot(2, p2)])
    p = lines.meeting_point(0, 1)
    if p is not None:
        if not slides and lines.lever(2, p) <= small:
            return None
        return regional.SHOULDER, np.array([p, p, lines.foot(2, p)])
    across = slides and abs(lines.directions[1] @ lines.directions[2]) <= ANGLE
    variant = regional.ELBOW if across else regional.GENERAL
    return variant, np.array([p1, p2, lines.foot(2, p2)])


def _forwards(lines: AxisLines, point: FloatArray, types: str) -> Placing | None:
    found = _common(lines, point)
    if found is None:
        return None
    variant, p = found
    h, slides = lines.directions, types == "RRP"
    offset = p[1] - p[0]
    shifted = variant != regional.COLUMN and np.linalg.norm(offset) > LENGTH * lines.size
    forward = offset if shifted else np.cross(_upwards(h[0]), h[1])
    postures, text = {
        (regional.ELBOW, False): ((FRONT, ELBOW), say("axes 2 and 3 parallel")),
        (regional.SHOULDER, False): ((FRONT, SIGN), say("axes 1 and 2 meet")),
        (regional.COLUMN, False): ((ELBOW, SIGN), say("axes 1 and 2 parallel")),
        (regional.GENERAL, False): (
            (RANKS, ONE),
            say("axes 1, 2 and 3 in general position"),
        ),
        (regional.ELBOW, True): ((FRONT, EXTENDED), say("joint 3 slides across axis 2")),
        (regional.SHOULDER, True): ((FRONT, EXTENDED), say("axes 1 and 2 meet, joint 3 slides")),
        (regional.COLUMN, True): ((ELBOW, ONE), say("axes 1 and 2 parallel, joint 3 slides")),
        (regional.GENERAL, True): (
            (RANKS, ONE),
            say("axes 1 and 2 in general position, joint 3 slides"),
        ),
    }[variant, slides]
    middle = -float(h[2] @ (point - p[1]))
    ranked = 2 if variant == regional.GENERAL else None
    return Placing(variant, p, text, postures, forward, middle, slides, ranked=ranked)


def _backwards(lines: AxisLines, point: FloatArray) -> Placing | None:
    mirrored = replace(
        lines,
        directions=lines.directions[::-1],
        points=lines.points[::-1],
        is_revolute=lines.is_revolute[::-1],
    )
    found = _common(mirrored, point)
    if found is None:
        return None
    variant, p = found
    postures, text = {
        regional.ELBOW: ((FRONT, EXTENDED), say("joint 1 slides across axis 2")),
        regional.SHOULDER: ((FRONT, EXTENDED), say("joint 1 slides, axes 2 and 3 meet")),
        regional.COLUMN: ((ELBOW, ONE), say("joint 1 slides, axes 2 and 3 parallel")),
        regional.GENERAL: (
            (RANKS, ONE),
            say("joint 1 slides, axes 2 and 3 in general position"),
        ),
    }[variant]
    h = lines.directions
    forward = np.cross(_upwards(h[1]), h[2])
    ranked = 0 if variant == regional.GENERAL else None
    return Placing(variant, p[::-1], text, postures, forward, slides=True, back=True, ranked=ranked)


def _slide_between(lines: AxisLines) -> Placing:
    h = lines.directions
    first, last = abs(h[0] @ h[1]), abs(h[2] @ h[1])
    if first <= ANGLE and last <= ANGLE:
        text = say("joint 2 slides across axes 1 and 3")
        return Placing(sliding.CROSSED, lines.points, text, (SIGN, EXTENDED), np.zeros(3))
    if lines.parallel(0, 1) and lines.parallel(0, 2):
        text = say("axes 1 and 3 parallel, joint 2 slides along them")
        return Placing(sliding.LIFTED, lines.points, text, (ELBOW, ONE), np.zeros(3))
    back = bool(last > first)
    return Placing(
        sliding.BETWEEN,
        lines.points,
        say("joint 2 slides between axes 1 and 3"),
        (RANKS, ONE),
        np.zeros(3),
        back=back,
        ranked=0 if back else 2,
    )


def _one_turn(lines: AxisLines) -> Placing:
    turning = int(np.flatnonzero(lines.is_revolute)[0])
    first, second = (int(k) for k in np.flatnonzero(~lines.is_revolute))
    h = lines.directions
    a, b = float(h[turning] @ h[first]), float(h[turning] @ h[second])
    # Across the axis, in the plane of the slides: a times the second less b times the first.
    sign, less = (-np.sign(a), second) if abs(a) >= abs(b) - ANGLE else (np.sign(b), first)
    if less < turning:
        sign = -sign
    text = say("joint {turning} turns, the others slide", turning=turning + 1)
    return Placing(
        sliding.ONE_TURN,
        lines.points,
        text,
        (EXTENDED, ONE),
        np.array([sign, 0.0, 0.0]),
        turning=turning,
    )


def _upwards(h: FloatArray) -> FloatArray:
    return -h if h[2] < -ANGLE else h
