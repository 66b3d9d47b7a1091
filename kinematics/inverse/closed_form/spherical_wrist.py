"""Six joints, the last three axes through one point (Pieper), compiled.

The wrist centre fixes the first three joints, the rotation that remains the last three. The first
three are solved in one of five ways, by what their axes have in common (Elias and Wen, *IK-Geo*,
arXiv 2211.05737, section on the spherical wrist; Pieper, Stanford AIM-72, 1968):

``ELBOW``: axes 2 and 3 parallel. ``SHOULDER``: axes 1 and 2 meet. ``COLUMN``: axes 1 and 2
parallel. ``GENERAL``: none of these; a quartic. ``TELESCOPE``: axes 1 and 2 meet, joint 3 slides.

Directions and points are those at q = 0 in base axes; a product of exponentials moves them.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_form.candidates import (
    WORK,
    Candidates,
    FormConstants,
    keep,
    none_yet,
    pose_parts,
    put,
)
from kinematics.inverse.closed_form.elbow import elbow_code
from kinematics.inverse.closed_form.quartic import roots, times
from kinematics.inverse.closed_form.spherical import bend, three_turns
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
    turned,
    vector,
)
from kinematics.kernels import Array

Triple: TypeAlias = tuple[Vector, Vector, Vector]

ELBOW, SHOULDER, COLUMN, GENERAL, TELESCOPE = 0, 1, 2, 3, 4

VARIANT = 0
SIZE = 1
WRIST = 2
"""Wrist centre at q = 0."""
WRIST_IN_TIP, AXIS6_IN_TIP, SIDE6_IN_TIP = 5, 8, 11
"""Wrist centre, axis 6 and the vector perpendicular to it, in the axes of the frame."""
H1, H2, H3 = 14, 17, 20
P1, P2, P3 = 23, 26, 29
FORWARD, MIDDLE = 32, 35
"""Direction of the front side; the slide's value at the point nearest to the shoulder."""
TRIPLE = 36

MOST = 8


@jit
def solve(
    form: FormConstants,
    target: Array,
    given: Array,
    swivel: float,  # noqa: ARG001 - the same arguments for every class
    measured: bool,
    candidates: Candidates,
) -> int:
    """Find all solutions of one target, regardless of joint limits.

    Args:
        form: Constants of the arm; its numbers in the places above.
        target: Pose of the frame in base axes, shape (4, 4).
        given: Values of joints that a singular branch leaves free, rad and m, shape (K,).
        swivel: Of redundant arms alone: the swivel angle, rad.
        measured: Whether to measure, improve and compare what is found, see :func:`keep`.
        candidates: Filled with the solutions; postures are shoulder, elbow and wrist.

    Returns:
        Number of solutions.
    """
    numbers, work = form.numbers, np.empty((WORK, 6))
    arms = work[WORK - 24 : WORK - 16]
    position, rotation = pose_parts(target, work)
    w = add(position, turned(rotation, vector(numbers, WRIST_IN_TIP)))
    image_c = turned(rotation, vector(numbers, AXIS6_IN_TIP))
    image_v = turned(rotation, vector(numbers, SIDE6_IN_TIP))
    found = _positions(numbers, w, given, arms, work)
    h1, h2, h3 = vector(numbers, H1), vector(numbers, H2), vector(numbers, H3)
    n = none_yet()
    for i in range(found):
        c1, s1 = math.cos(arms[i, 0]), math.sin(arms[i, 0])
        c2, s2 = math.cos(arms[i, 1]), math.sin(arms[i, 1])
        c3, s3, third_turns = 1.0, 0.0, form.chain.is_revolute[2] != 0.0
        if third_turns:
            c3, s3 = math.cos(arms[i, 2]), math.sin(arms[i, 2])
        wrist_c = turn(h3, c3, -s3, turn(h2, c2, -s2, turn(h1, c1, -s1, image_c)))
        wrist_v = turn(h3, c3, -s3, turn(h2, c2, -s2, turn(h1, c1, -s1, image_v)))
        shoulder, elbow = _posture(numbers, w, arms[i])
        exists, bent = bend(numbers, TRIPLE, wrist_c)
        if not exists:
            continue
        for side in range(2):
            loose, q4, q5, q6 = three_turns(
                numbers, TRIPLE, wrist_c, wrist_v, bent if side else -bent, given[3]
            )
            values = (arms[i, 0], arms[i, 1], arms[i, 2], q4, q5, q6)
            free = int(arms[i, 3]) + (8 if loose else 0)
            put(candidates, n, values, (shoulder, elbow, side), free)
            n = keep(form, target, measured, candidates, n, work)
    return n


@inner
def _geometry(numbers: Array) -> tuple[Triple, Triple, Vector]:
    """Return directions and points of the first three axes, and the wrist centre, at q = 0."""
    h = vector(numbers, H1), vector(numbers, H2), vector(numbers, H3)
    p = vector(numbers, P1), vector(numbers, P2), vector(numbers, P3)
    return h, p, vector(numbers, WRIST)


@inner
def _posture(numbers: Array, w: Vector, arm: Array) -> tuple[int, int]:
    """Return the codes of shoulder and elbow of joint values q1, q2, q3; see :mod:`classify`."""
    variant = numbers[VARIANT]
    (h1, h2, h3), (p1, p2, p3), w0 = _geometry(numbers)
    q1, q2, q3 = arm[0], arm[1], arm[2]
    c1, s1 = math.cos(q1), math.sin(q1)
    if variant == GENERAL:
        return 0, 0
    if variant == TELESCOPE:
        reached = add(w0, scale(q3, h3))
    else:
        reached = turn_about(h3, p3, math.cos(q3), math.sin(q3), w0)
    if variant == COLUMN:
        side = dot(sub(reached, p3), cross(h1, h3))
        bent = elbow_code(h1, sub(w, p1), turn(h1, c1, s1, sub(p2, p1)))
        return bent, 0 if side >= 0.0 else 1
    c2, s2 = math.cos(q2), math.sin(q2)
    ahead = dot(vector(numbers, FORWARD), sub(turn_about(h2, p2, c2, s2, reached), p1))
    front = 0 if ahead >= 0.0 else 1
    if variant == TELESCOPE:
        return front, 0 if q3 >= numbers[MIDDLE] else 1
    if variant == SHOULDER:
        side = dot(h3, cross(sub(p3, p1), sub(reached, p3)))
        return front, 0 if side >= 0.0 else 1
    line = sub(w, add(p1, turn(h1, c1, s1, sub(p2, p1))))
    knee = turn(h2, c2, s2, sub(p3, p2))
    return front, elbow_code(turn(h1, c1, s1, h2), line, turn(h1, c1, s1, knee))


@inner
def _put(arms: Array, n: int, q1: float, q2: float, q3: float, bits: int) -> int:
    arms[n, 0], arms[n, 1], arms[n, 2], arms[n, 3] = q1, q2, q3, bits
    return n + 1


@inner
def _positions(numbers: Array, w: Vector, given: Array, arms: Array, work: Array) -> int:
    """Fill rows of arms with q1, q2, q3 that bring the wrist centre to w, and their free bits."""
    variant = numbers[VARIANT]
    if variant == ELBOW:
        return _elbow(numbers, w, given, arms)
    if variant == COLUMN:
        return _column(numbers, w, given, arms)
    if variant == GENERAL:
        return _general(numbers, w, given, arms, work)
    return _shoulder(numbers, w, given, arms)


@inner
def _elbow(numbers: Array, w: Vector, given: Array, arms: Array) -> int:
    """Solve axes 2 and 3 parallel: joint 1 from the component along axis 2, then a plane 2R."""
    size = numbers[SIZE]
    (h1, h2, h3), (p1, p2, p3), w0 = _geometry(numbers)
    x = sub(w, p1)
    n1, a, b = component(h2, (-h1[0], -h1[1], -h1[2]), x, dot(h2, sub(w0, p1)), size)
    bits = 0
    if n1 == FREE:
        a, n1, bits = given[0], 1, 1
    n = 0
    for i in range(n1):
        q1 = a if i == 0 else b
        y = sub(add(p1, turn(h1, math.cos(q1), -math.sin(q1), x)), p2)
        n3, c, d = distance(h3, sub(w0, p3), sub(p2, p3), norm(y), size)
        for j in range(n3):
            q3 = c if j == 0 else d
            reached = sub(turn_about(h3, p3, math.cos(q3), math.sin(q3), w0), p2)
            determined, q2 = align(h2, reached, y, size)
            if determined:
                n = _put(arms, n, q1, q2, q3, bits)
            else:
                n = _put(arms, n, q1, given[1], q3, bits + 2)
    return n


@inner
def _shoulder(numbers: Array, w: Vector, given: Array, arms: Array) -> int:
    """Solve axes 1 and 2 that meet: joint 3 from the distance to that point, then two turns."""
    size = numbers[SIZE]
    (h1, h2, h3), (p, _, p3), w0 = _geometry(numbers)
    goal = sub(w, p)
    slides = numbers[VARIANT] == TELESCOPE
    if slides:
        along = dot(h3, sub(w0, p))
        inside = along * along - dot(sub(w0, p), sub(w0, p)) + dot(goal, goal)
        if inside < -1e-9 * size * size:
            return 0
        half = math.sqrt(max(inside, 0.0))
        n3, c, d = 2, half - along, -half - along
    else:
        n3, c, d = distance(h3, sub(w0, p3), sub(p, p3), norm(goal), size)
    n = 0
    to_goal = angle_between(h1, goal)
    tilt = angle_between(h1, h2)
    for i in range(n3):
        q3 = c if i == 0 else d
        if slides:
            x = sub(add(w0, scale(q3, h3)), p)
        else:
            x = sub(turn_about(h3, p3, math.cos(q3), math.sin(q3), w0), p)
        across = sub(x, scale(dot(h2, x), h2))
        if norm(across) <= 1e-12 * size:
            determined, q1 = align(h1, x, goal, size)
            if determined:
                n = _put(arms, n, q1, given[1], q3, 2)
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
                n = _put(arms, n, q1, q2, q3, 0)
            elif j == 0:
                n = _put(arms, n, given[0], q2, q3, 1)
    return n


@inner
def _column(numbers: Array, w: Vector, given: Array, arms: Array) -> int:
    """Solve axes 1 and 2 parallel: joint 3 from the component along them, then a plane 2R."""
    size = numbers[SIZE]
    (h1, h2, h3), (p1, p2, p3), w0 = _geometry(numbers)
    goal = sub(w, p1)
    n3, c, d = component(h1, h3, sub(w0, p3), dot(h1, sub(w, p3)), size)
    n = 0
    for i in range(n3):
        q3 = c if i == 0 else d
        x = turn_about(h3, p3, math.cos(q3), math.sin(q3), w0)
        n2, e, f = distance(h2, sub(x, p2), sub(p1, p2), norm(goal), size)
        bits = 0
        if n2 == FREE:
            n2, e, bits = 1, given[1], 2
        for j in range(n2):
            q2 = e if j == 0 else f
            reached = sub(turn_about(h2, p2, math.cos(q2), math.sin(q2), x), p1)
            determined, q1 = align(h1, reached, goal, size)
            if determined:
                n = _put(arms, n, q1, q2, q3, bits)
            else:
                n = _put(arms, n, given[0], q2, q3, bits + 1)
    return n


@inner
def _general(numbers: Array, w: Vector, given: Array, arms: Array, work: Array) -> int:
    """Solve axes 1 and 2 skew: eliminating joint 2 leaves a quartic for joint 3.

    With y the wrist centre from axis 2, b the common normal of axes 1 and 2 and r what joint 2
    makes of y across axis 2: ``2 b · r = |w|² - |b|² - |y|²`` and ``h1 · r`` from the component
    along axis 1. b and h1 across h2 are perpendicular, and r is as long as y across axis 2.
    """
    size = numbers[SIZE]
    (h1, h2, h3), (p1, p2, p3), w0 = _geometry(numbers)
    goal, b, lever = sub(w, p1), sub(p2, p1), sub(p3, p2)
    y0 = sub(w0, p3)
    fixed = add(lever, scale(dot(h3, y0), h3))
    cosine, sine = sub(y0, scale(dot(h3, y0), h3)), cross(h3, y0)
    up = sub(h1, scale(dot(h1, h2), h2))
    k1, k2, along = work[0, 0:3], work[1, 0:3], work[2, 0:3]
    total, one, angles = work[3, 0:5], work[4, 0:3], work[5, 0:4]
    along[0], along[1], along[2] = dot(h2, fixed), dot(h2, cosine), dot(h2, sine)
    square0 = dot(fixed, fixed) + dot(cosine, cosine)
    square1, square2 = 2.0 * dot(fixed, cosine), 2.0 * dot(fixed, sine)
    length = norm(b)
    k1[0] = (dot(goal, goal) - dot(b, b) - square0) / (2.0 * length)
    k1[1], k1[2] = -square1 / (2.0 * length), -square2 / (2.0 * length)
    rise, slant = norm(up), dot(h1, h2)
    k2[0] = (dot(h1, goal) - dot(h1, b) - slant * along[0]) / rise
    k2[1], k2[2] = -slant * along[1] / rise, -slant * along[2] / rise
    for i in range(5):
        total[i] = 0.0
    times(k1, k1, 1.0, total)
    times(k2, k2, 1.0, total)
    times(along, along, 1.0, total)
    total[0] -= square0
    total[1] -= square1
    total[2] -= square2
    one[0] = 1.0
    n3, n = roots(total, angles), 0
    for i in range(n3):
        q3 = angles[i]
        c, s = math.cos(q3), math.sin(q3)
        y = add(fixed, add(scale(c, cosine), scale(s, sine)))
        r = add(
            scale((k1[0] + k1[1] * c + k1[2] * s) / length, b),
            scale((k2[0] + k2[1] * c + k2[2] * s) / rise, up),
        )
        determined, q2 = align(h2, y, r, size)
        bits = 0 if determined else 2
        q2 = q2 if determined else given[1]
        reached = add(b, turn(h2, math.cos(q2), math.sin(q2), y))
        determined, q1 = align(h1, reached, goal, size)
        n = _put(arms, n, q1 if determined else given[0], q2, q3, bits + (0 if determined else 1))
    return n
