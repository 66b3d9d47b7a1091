"""Three joints that place a point, with a slide between two turns or more than one, compiled.

``BETWEEN``: joint 2 slides between two turns; a quartic. ``LIFTED``: the same with all axes
parallel. ``CROSSED``: the same, joint 2 across both axes. ``ONE_TURN``: two slides. ``SLIDES``: no
turn. Directions and points are those at q = 0 in base axes.
"""

from __future__ import annotations

import math

from kinematics.compiled import inner
from kinematics.inverse.closed_form.quartic import roots, times
from kinematics.inverse.closed_form.regional import (
    FORWARD,
    NOTHING,
    REVERSED,
    SIZE,
    Triple,
    geometry,
    largest,
    row,
    slid_to,
    turned_back,
)
from kinematics.inverse.closed_form.subproblems import FREE, align, component, harmonic
from kinematics.inverse.closed_form.vectors import (
    Vector,
    add,
    cross,
    dot,
    norm,
    scale,
    sub,
    turn,
    turn_about,
)
from kinematics.kernels import Array

BETWEEN, LIFTED, CROSSED, ONE_TURN, SLIDES_ALONE = 4, 5, 6, 7, 8

TURN = 38
"""Which joint turns, where one does."""
PARALLEL = 1e-9
"""Sine of the angle of two slides below which they count as parallel."""


@inner
def turn_slide_turn(numbers: Array, w: Vector, given: Array, arms: Array, work: Array) -> int:
    """Fill rows of arms with q1, q2, q3, where joint 2 slides between two turns.

    What joint 3 makes of the point, and joint 2 shifts, is as far along axis 1 as the goal and as
    far from a point of it: joint 2 from the first, a quartic for joint 3 from the second.
    """
    h, p, w0 = geometry(numbers)
    back, size = numbers[REVERSED] == 1.0, numbers[SIZE]
    if back:
        h, p, w0, w = (h[2], h[1], h[0]), (p[2], p[1], p[0]), w, w0
    (h1, h2, h3), (p1, _, p3) = h, p
    goal, y0 = sub(w, p1), sub(w0, p3)
    fixed = add(sub(p3, p1), scale(dot(h3, y0), h3))
    cosine, sine = sub(y0, scale(dot(h3, y0), h3)), cross(h3, y0)
    rise, along, total, angles = work[0, 0:3], work[1, 0:3], work[2, 0:5], work[5, 0:4]
    k = dot(h1, h2)
    rise[0] = dot(h1, goal) - dot(h1, fixed)
    rise[1], rise[2] = -dot(h1, cosine), -dot(h1, sine)
    along[0], along[1], along[2] = dot(h2, fixed), dot(h2, cosine), dot(h2, sine)
    total[0] = k * k * (dot(fixed, fixed) + dot(cosine, cosine) - dot(goal, goal))
    total[1] = 2.0 * k * k * dot(fixed, cosine)
    total[2] = 2.0 * k * k * dot(fixed, sine)
    total[3] = total[4] = 0.0
    times(along, rise, 2.0 * k, total)
    times(rise, rise, 1.0, total)
    n3 = roots(total, angles) if largest(total) > NOTHING * size * size else FREE
    n, bits = 0, 0
    if n3 == FREE:
        n3, angles[0], bits = 1, -given[0] if back else given[2], 4
    for i in range(n3):
        q3 = angles[i]
        c, s = math.cos(q3), math.sin(q3)
        x = add(fixed, add(scale(c, cosine), scale(s, sine)))
        q2 = (dot(h1, goal) - dot(h1, x)) / k
        determined, q1 = align(h1, add(x, scale(q2, h2)), goal, size)
        if not determined:
            q1 = -given[2] if back else given[0]
        n = row(arms, n, q1, q2, q3, bits + (0 if determined else 1))
    if back:
        turned_back(arms, n)
    return n


@inner
def turn_slide_across(numbers: Array, w: Vector, given: Array, arms: Array) -> int:
    """Fill rows of arms with q1, q2, q3, where joint 2 slides across both axes.

    Joint 3 from the component along axis 1, joint 2 from the distance to it.
    """
    (h1, h2, h3), (p1, _, p3), w0 = geometry(numbers)
    size, goal = numbers[SIZE], sub(w, p1)
    n3, a, b = component(h1, h3, sub(w0, p3), dot(h1, sub(w, p3)), size)
    bits = 0
    if n3 == FREE:
        n3, a, bits = 1, given[2], 4
    n = 0
    for i in range(n3):
        q3 = a if i == 0 else b
        x = sub(turn_about(h3, p3, math.cos(q3), math.sin(q3), w0), p1)
        n2, c, d = slid_to(h2, x, norm(goal), size)
        for j in range(n2):
            q2 = c if j == 0 else d
            determined, q1 = align(h1, add(x, scale(q2, h2)), goal, size)
            if determined:
                n = row(arms, n, q1, q2, q3, bits)
            else:
                n = row(arms, n, given[0], q2, q3, bits + 1)
    return n


@inner
def _slides(h: Triple, turning: int, angle: float) -> tuple[Vector, Vector]:
    """Return the directions of the two slides, in base axes, where the turning joint is turned."""
    first, second = (1, 2) if turning == 0 else ((0, 2) if turning == 1 else (0, 1))
    axis, c, s = h[turning], math.cos(angle), math.sin(angle)
    a, b = h[first], h[second]
    if first > turning:
        a = turn(axis, c, s, a)
    if second > turning:
        b = turn(axis, c, s, b)
    return a, b


@inner
def _rest(h: Triple, p: Triple, w0: Vector, w: Vector, turning: int, angle: float) -> Vector:
    """Return what slides must do for the point, with the turning joint turned."""
    axis, point = h[turning], p[turning]
    return sub(w, turn_about(axis, point, math.cos(angle), math.sin(angle), w0))


@inner
def _out_of_plane(h: Triple, p: Triple, w0: Vector, w: Vector, turning: int, angle: float) -> float:
    a, b = _slides(h, turning, angle)
    return dot(cross(a, b), _rest(h, p, w0, w, turning, angle))


@inner
def one_turn(numbers: Array, w: Vector, given: Array, arms: Array) -> int:
    """Fill rows of arms with q1, q2, q3, where one joint turns and two slide.

    The turn brings what is left into the plane of the slides: ``a + b cos q + c sin q = 0``, known
    from three angles.
    """
    h, p, w0 = geometry(numbers)
    size, turning = numbers[SIZE], int(numbers[TURN])
    first = 1 if turning == 0 else 0
    ahead = _out_of_plane(h, p, w0, w, turning, 0.0)
    behind = _out_of_plane(h, p, w0, w, turning, math.pi)
    aside = _out_of_plane(h, p, w0, w, turning, 0.5 * math.pi)
    middle = 0.5 * (ahead + behind)
    found, one, other = harmonic(0.5 * (ahead - behind), aside - middle, -middle, size)
    bits = 0
    if found == FREE:
        found, one, bits = 1, given[turning], 1 << turning
    n = 0
    for i in range(found):
        angle = one if i == 0 else other
        a, b = _slides(h, turning, angle)
        rest, normal = _rest(h, p, w0, w, turning, angle), cross(a, b)
        square, free = dot(normal, normal), bits
        if square > PARALLEL * PARALLEL:
            t = dot(cross(rest, b), normal) / square
            u = dot(cross(a, rest), normal) / square
        else:
            # The slides are parallel: no solution, or a family of them.
            if norm(cross(a, rest)) > 1e-7 * size:
                continue
            t, free = given[first], bits | (1 << first)
            u = dot(b, sub(rest, scale(t, a)))
        if turning == 0:
            n = row(arms, n, angle, t, u, free)
        elif turning == 1:
            n = row(arms, n, t, angle, u, free)
        else:
            n = row(arms, n, t, u, angle, free)
    return n


@inner
def slides_alone(numbers: Array, w: Vector, arms: Array) -> int:
    """Fill the one row of arms with q1, q2, q3, where all joints slide."""
    (a, b, c), _, w0 = geometry(numbers)
    rest, volume = sub(w, w0), dot(cross(a, b), c)
    q1 = dot(cross(rest, b), c) / volume
    q2 = dot(cross(a, rest), c) / volume
    return row(arms, 0, q1, q2, dot(cross(a, b), rest) / volume, 0)


@inner
def is_extended(numbers: Array, w: Vector, arm: Array) -> bool:
    """Return whether the point of an arm with one turn is on the forward side of the turn."""
    h, p, _ = geometry(numbers)
    turning = int(numbers[TURN])
    angle = arm[turning]
    a, b = _slides(h, turning, angle)
    forward = scale(numbers[FORWARD], cross(h[turning], cross(a, b)))
    pivot = p[turning]
    if turning > 0:
        pivot = add(pivot, scale(arm[0], h[0]))
    if turning > 1:
        pivot = add(pivot, scale(arm[1], h[1]))
    return dot(sub(w, pivot), forward) >= 0.0
