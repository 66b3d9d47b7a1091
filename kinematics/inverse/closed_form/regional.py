"""Three joints that place a point, in any order of turns and slides, compiled.

The point is the tip of an arm of three joints, or the wrist centre of one with a spherical wrist.
By what the axes have in common (Elias and Wen, *IK-Geo*, arXiv 2211.05737; Pieper, Stanford
AIM-72, 1968), where joint 3 turns or slides:

``ELBOW``: axes 2 and 3 parallel, or joint 3 slides across axis 2. ``SHOULDER``: axes 1 and 2 meet.
``COLUMN``: axes 1 and 2 parallel. ``GENERAL``: none of these; a quartic. The others, with slides
elsewhere, are those of :mod:`sliding`.

Arms that begin with their slide are solved from the tip: ``M1 M2 M3 w0 = w`` is the same as
``M3⁻¹ M2⁻¹ M1⁻¹ w = w0``. Directions and points are those at q = 0 in base axes.
"""

from __future__ import annotations

import math
from typing import TypeAlias

from kinematics.compiled import inner
from kinematics.inverse.closed_form.quartic import roots, times
from kinematics.inverse.closed_form.subproblems import (
    FREE,
    align,
    component,
    dihedral,
    distance,
)
from kinematics.inverse.closed_form.vectors import (
    Vector,
    add,
    angle_between,
    cross,
    dot,
    norm,
    scale,
    sub,
    turn,
    turn_about,
    vector,
)
from kinematics.kernels import Array

Triple: TypeAlias = tuple[Vector, Vector, Vector]

ELBOW, SHOULDER, COLUMN, GENERAL = 0, 1, 2, 3

VARIANT, SIZE = 0, 1
WRIST = 2
"""The point at q = 0."""
H1, H2, H3 = 14, 17, 20
P1, P2, P3 = 23, 26, 29
FORWARD, MIDDLE = 32, 35
"""Direction of the front side, or its sign; the slide's value at the point nearest to the
shoulder."""
SLIDES = 36
"""1 where the third joint slides, counted from the end where that is so."""
REVERSED = 37
"""1 where the arm is solved from the tip."""
NOTHING = 1e-14
"""Factors of an equation, in parts of the size squared, that are rounding: any value solves it."""


@inner
def geometry(numbers: Array) -> tuple[Triple, Triple, Vector]:
    """Return directions and points of the first three axes, and the point, at q = 0."""
    h = vector(numbers, H1), vector(numbers, H2), vector(numbers, H3)
    p = vector(numbers, P1), vector(numbers, P2), vector(numbers, P3)
    return h, p, vector(numbers, WRIST)


@inner
def row(arms: Array, n: int, q1: float, q2: float, q3: float, bits: int) -> int:
    """Write q1, q2, q3 and the bits of free joints into row n; return n + 1."""
    arms[n, 0], arms[n, 1], arms[n, 2], arms[n, 3] = q1, q2, q3, bits
    return n + 1


@inner
def turned_back(arms: Array, n: int) -> None:
    """Turn rows of values counted from the tip into q1, q2, q3."""
    for i in range(n):
        bits = int(arms[i, 3])
        arms[i, 0], arms[i, 1], arms[i, 2] = -arms[i, 2], -arms[i, 1], -arms[i, 0]
        arms[i, 3] = ((bits & 1) << 2) | (bits & 2) | (bits >> 2)


@inner
def two_turns_and_one(numbers: Array, w: Vector, given: Array, arms: Array, work: Array) -> int:
    """Fill rows of arms with q1, q2, q3 that bring the point to w; return their number."""
    h, p, w0 = geometry(numbers)
    values = work[6, 0:3]
    back = numbers[REVERSED] == 1.0
    if back:
        h, p, w0, w = (h[2], h[1], h[0]), (p[2], p[1], p[0]), w, w0
    for k in range(3):
        values[k] = -given[2 - k] if back else given[k]
    variant, slides = numbers[VARIANT], numbers[SLIDES] == 1.0
    size = numbers[SIZE]
    if variant == ELBOW:
        n = _elbow(h, p, w0, w, slides, size, values, arms)
    elif variant == COLUMN:
        n = _column(h, p, w0, w, slides, size, values, arms)
    elif variant == SHOULDER:
        n = _shoulder(h, p, w0, w, slides, size, values, arms)
    else:
        n = _general(h, p, w0, w, slides, size, values, arms, work)
    if back:
        turned_back(arms, n)
    return n


@inner
def largest(k: Array) -> float:
    """Return the largest magnitude of the factors of an equation of degree two, shape (5,)."""
    most = 0.0
    for i in range(5):
        most = max(most, abs(k[i]))
    return most


@inner
def slid_to(d: Vector, x: Vector, length: float, size: float) -> tuple[int, float, float]:
    """Solve ``|x + t d| = length`` for t: two values, equal at the boundary, or none."""
    along = dot(d, x)
    inside = along * along - dot(x, x) + length * length
    if inside < -1e-9 * size * size:
        return 0, 0.0, 0.0
    half = math.sqrt(max(inside, 0.0))
    return 2, half - along, -half - along


@inner
def _third(
    h3: Vector, p3: Vector, w0: Vector, slides: bool, centre: Vector, length: float, size: float
) -> tuple[int, float, float]:
    """Solve joint 3 for the distance of the point from a centre."""
    if slides:
        return slid_to(h3, sub(w0, centre), length, size)
    return distance(h3, sub(w0, p3), sub(centre, p3), length, size)


@inner
def _moved(h3: Vector, p3: Vector, w0: Vector, slides: bool, q3: float) -> Vector:
    """Return the point, moved by joint 3."""
    if slides:
        return add(w0, scale(q3, h3))
    return turn_about(h3, p3, math.cos(q3), math.sin(q3), w0)


@inner
def _elbow(
    h: Triple,
    p: Triple,
    w0: Vector,
    w: Vector,
    slides: bool,
    size: float,
    given: Array,
    arms: Array,
) -> int:
    """Solve joint 1 from the component along axis 2, then a plane arm of two joints."""
    (h1, h2, h3), (p1, p2, p3) = h, p
    x = sub(w, p1)
    n1, a, b = component(h2, (-h1[0], -h1[1], -h1[2]), x, dot(h2, sub(w0, p1)), size)
    bits = 0
    if n1 == FREE:
        a, n1, bits = given[0], 1, 1
    n = 0
    for i in range(n1):
        q1 = a if i == 0 else b
        y = sub(add(p1, turn(h1, math.cos(q1), -math.sin(q1), x)), p2)
        n3, c, d = _third(h3, p3, w0, slides, p2, norm(y), size)
        for j in range(n3):
            q3 = c if j == 0 else d
            reached = sub(_moved(h3, p3, w0, slides, q3), p2)
            determined, q2 = align(h2, reached, y, size)
            if determined:
                n = row(arms, n, q1, q2, q3, bits)
            else:
                n = row(arms, n, q1, given[1], q3, bits + 2)
    return n


@inner
def _shoulder(
    h: Triple,
    p: Triple,
    w0: Vector,
    w: Vector,
    slides: bool,
    size: float,
    given: Array,
    arms: Array,
) -> int:
    """Solve axes 1 and 2 that meet: joint 3 from the distance to that point, then two turns."""
    (h1, h2, h3), (centre, _, p3) = h, p
    goal = sub(w, centre)
    n3, c, d = _third(h3, p3, w0, slides, centre, norm(goal), size)
    if n3 > 0 and norm(goal) <= 1e-11 * size:
        # The point is where the axes meet, whatever joints 1 and 2 do.
        return row(arms, 0, given[0], given[1], 0.5 * (c + d), 3)
    n = 0
    to_goal = angle_between(h1, goal)
    tilt = angle_between(h1, h2)
    for i in range(n3):
        q3 = c if i == 0 else d
        x = sub(_moved(h3, p3, w0, slides, q3), centre)
        across = sub(x, scale(dot(h2, x), h2))
        if norm(across) <= 1e-12 * size:
            determined, q1 = align(h1, x, goal, size)
            if determined:
                n = row(arms, n, q1, given[1], q3, 2)
            continue
        exists, angle = dihedral(tilt, angle_between(h2, x), to_goal)
        if not exists:
            continue
        before = sub(h1, scale(dot(h1, h2), h2))
        zero = math.atan2(dot(h2, cross(before, across)), dot(before, across))
        for j in range(2):
            q2 = (angle if j == 0 else -angle) - zero
            determined, q1 = align(h1, turn(h2, math.cos(q2), math.sin(q2), x), goal, size)
            if determined:
                n = row(arms, n, q1, q2, q3, 0)
            elif j == 0:
                n = row(arms, n, given[0], q2, q3, 1)
    return n


@inner
def _column(
    h: Triple,
    p: Triple,
    w0: Vector,
    w: Vector,
    slides: bool,
    size: float,
    given: Array,
    arms: Array,
) -> int:
    """Solve axes 1 and 2 parallel: joint 3 from the component along them, then a plane 2R."""
    (h1, h2, h3), (p1, p2, p3) = h, p
    goal = sub(w, p1)
    if slides:
        n3, c, d = 1, dot(h1, sub(w, w0)) / dot(h1, h3), 0.0
    else:
        n3, c, d = component(h1, h3, sub(w0, p3), dot(h1, sub(w, p3)), size)
    n = 0
    for i in range(n3):
        q3 = c if i == 0 else d
        x = _moved(h3, p3, w0, slides, q3)
        n2, e, f = distance(h2, sub(x, p2), sub(p1, p2), norm(goal), size)
        bits = 0
        if n2 == FREE:
            n2, e, bits = 1, given[1], 2
        for j in range(n2):
            q2 = e if j == 0 else f
            reached = sub(turn_about(h2, p2, math.cos(q2), math.sin(q2), x), p1)
            determined, q1 = align(h1, reached, goal, size)
            if determined:
                n = row(arms, n, q1, q2, q3, bits)
            else:
                n = row(arms, n, given[0], q2, q3, bits + 1)
    return n


@inner
def _general(
    h: Triple,
    p: Triple,
    w0: Vector,
    w: Vector,
    slides: bool,
    size: float,
    given: Array,
    arms: Array,
    work: Array,
) -> int:
    """Solve axes 1 and 2 skew: eliminating joint 2 leaves a quartic for joint 3.

    With y the point from axis 2, b the common normal of axes 1 and 2 and r what joint 2 makes of y
    across axis 2: ``2 b · r = |w|² - |b|² - |y|²`` and ``h1 · r`` from the component along axis 1.
    b and h1 across h2 are perpendicular, and r is as long as y across axis 2.
    """
    (h1, h2, h3), (p1, p2, p3) = h, p
    goal, b = sub(w, p1), sub(p2, p1)
    up = sub(h1, scale(dot(h1, h2), h2))
    length, rise, slant = norm(b), norm(up), dot(h1, h2)
    total, angles = work[3, 0:5], work[5, 0:4]
    if slides:
        _slide_quartic(h3, sub(w0, p2), h2, goal, h1, length, rise, slant, size, work)
    else:
        _turn_quartic(h3, p3, w0, p2, h2, goal, h1, length, rise, slant, work)
    n3 = roots(total, angles) if largest(total) > NOTHING * size * size else FREE
    n, loose = 0, 0
    if n3 == FREE:
        n3, angles[0], loose = 1, given[2], 4
    for i in range(n3):
        q3 = size * math.tan(0.5 * angles[i]) if slides else angles[i]
        y = sub(_moved(h3, p3, w0, slides, q3), p2)
        along_b = 0.5 * (dot(goal, goal) - length * length - dot(y, y)) / length
        along_up = (dot(h1, goal) - slant * dot(h2, y)) / rise
        r = add(scale(along_b / length, b), scale(along_up / rise, up))
        determined, q2 = align(h2, y, r, size)
        bits = loose if determined else loose + 2
        q2 = q2 if determined else given[1]
        reached = add(b, turn(h2, math.cos(q2), math.sin(q2), y))
        determined, q1 = align(h1, reached, goal, size)
        n = row(arms, n, q1 if determined else given[0], q2, q3, bits + (0 if determined else 1))
    return n


@inner
def _turn_quartic(
    h3: Vector,
    p3: Vector,
    w0: Vector,
    p2: Vector,
    h2: Vector,
    goal: Vector,
    h1: Vector,
    length: float,
    rise: float,
    slant: float,
    work: Array,
) -> None:
    """Put the equation for the values of a joint 3 that turns into ``work[3]``."""
    y0 = sub(w0, p3)
    fixed = add(sub(p3, p2), scale(dot(h3, y0), h3))
    cosine, sine = sub(y0, scale(dot(h3, y0), h3)), cross(h3, y0)
    k1, k2, along = work[0, 0:3], work[1, 0:3], work[2, 0:3]
    total = work[3, 0:5]
    along[0], along[1], along[2] = dot(h2, fixed), dot(h2, cosine), dot(h2, sine)
    square0 = dot(fixed, fixed) + dot(cosine, cosine)
    square1, square2 = 2.0 * dot(fixed, cosine), 2.0 * dot(fixed, sine)
    k1[0] = (dot(goal, goal) - length * length - square0) / (2.0 * length)
    k1[1], k1[2] = -square1 / (2.0 * length), -square2 / (2.0 * length)
    k2[0] = (dot(h1, goal) - slant * along[0]) / rise
    k2[1], k2[2] = -slant * along[1] / rise, -slant * along[2] / rise
    for i in range(5):
        total[i] = 0.0
    times(k1, k1, 1.0, total)
    times(k2, k2, 1.0, total)
    times(along, along, 1.0, total)
    total[0] -= square0
    total[1] -= square1
    total[2] -= square2


@inner
def _slide_quartic(
    h3: Vector,
    x: Vector,
    h2: Vector,
    goal: Vector,
    h1: Vector,
    length: float,
    rise: float,
    slant: float,
    size: float,
    work: Array,
) -> None:
    """Put the equation for φ, of a joint 3 that slides by ``size · tan(φ/2)``, into ``work[3]``.

    A quartic in t is one in the cosine and sine of φ: ``times cos⁴(φ/2)``.
    """
    y0, y1 = dot(x, x), size * dot(x, h3)
    a0, a1 = dot(h2, x), size * dot(h2, h3)
    b0, b1 = (dot(h1, goal) - slant * a0) / rise, -slant * a1 / rise
    e0, e1, e2 = dot(goal, goal) - length * length - y0, -2.0 * y1, -size * size
    four = 4.0 * length * length
    c0 = e0 * e0 + four * (b0 * b0 + a0 * a0 - y0)
    c1 = 2.0 * e0 * e1 + four * 2.0 * (b0 * b1 + a0 * a1 - y1)
    c2 = e1 * e1 + 2.0 * e0 * e2 + four * (b1 * b1 + a1 * a1 - size * size)
    c3, c4 = 2.0 * e1 * e2, e2 * e2
    more, less, sine, total = work[0, 0:3], work[1, 0:3], work[2, 0:3], work[3, 0:5]
    more[0], more[1], more[2] = 1.0, 1.0, 0.0
    less[0], less[1], less[2] = 1.0, -1.0, 0.0
    sine[0], sine[1], sine[2] = 0.0, 0.0, 1.0
    for i in range(5):
        total[i] = 0.0
    times(more, more, c0, total)
    times(sine, more, c1, total)
    times(sine, sine, c2, total)
    times(sine, less, c3, total)
    # Of the order of lengths squared, as that of a joint that turns.
    times(less, less, c4, total)
    for i in range(5):
        total[i] /= size * size
