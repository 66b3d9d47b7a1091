"""Arms that turn about one direction and slide across it, compiled: planar arms and SCARA.

A pair of joints brings a point to a goal in the plane: two turns (subproblems 3 and 1), a turn and
a slide, a slide and a turn, or two slides. A third joint, where there is one, is a turn that the
target's heading fixes together with the turns of the pair; the pair is then what remains of the
three in their order, and its slides turn with the heading where they come after the third. A slide
along the common direction, anywhere, sets the height. The base may stand in any way; u is the
common direction, upwards (u · z_base > 0 where it is not across z_base).
"""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_form.candidates import (
    WORK,
    Candidates,
    FormConstants,
    keep,
    none_yet,
)
from kinematics.inverse.closed_form.elbow import elbow_code
from kinematics.inverse.closed_form.regional import slid_to
from kinematics.inverse.closed_form.subproblems import FREE, align, component, distance
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
    turned,
    vector,
)
from kinematics.kernels import Array

TURN_TURN, TURN_SLIDE, SLIDE_TURN, SLIDE_SLIDE = 0, 1, 2, 3

SIZE = 0
U = 1
PIVOT, ELBOW, END = 4, 7, 10
"""Points in one plane across u, at q = 0: of the pair's first turn and of its second, and the point
that the pair places."""
TIP = 13
"""The frame's origin at q = 0, in that plane."""
HEIGHT = 16
"""Its component along u at q = 0."""
SIGNS = 17
"""Of the pair, of the third joint and of the slide along u: of a turn or that slide 1 where its
axis is u, -1 where it is -u; of the pair's slides 1."""
JOINTS = 21
"""Indices of the pair, of the third joint and of the slide, -1 for those that are missing."""
FRAME = 25
"""Rotation of the frame at q = 0, transposed, row by row."""
PAIR = 34
D1, D2 = 35, 38
"""Directions of the pair's slides at q = 0."""
HEADED1, HEADED2 = 41, 42
"""1 where these turn with the heading."""

MOST = 2
PARALLEL = 1e-9
"""Sine of the angle of two slides below which they count as parallel."""


@jit
def solve(
    form: FormConstants,
    target: Array,
    given: Array,
    swivel: float,  # noqa: ARG001 - the same arguments for every class
    measured: bool,
    candidates: Candidates,
) -> int:
    """Find all solutions of one target; arguments as of :func:`spherical_wrist.solve`.

    Where the target is tilted against what the arm can do, its turn about u counts (as a
    rotation vector's component along u does).
    """
    numbers, q, codes, free = form.numbers, candidates.q, candidates.codes, candidates.free
    work = np.empty((WORK, 6))
    pairs = work[WORK - 24 : WORK - 22]
    u = vector(numbers, U)
    goal = (target[0, 3], target[1, 3], target[2, 3])
    height = dot(u, goal) - numbers[HEIGHT]
    first, second = int(numbers[JOINTS]), int(numbers[JOINTS + 1])
    third, lift = int(numbers[JOINTS + 2]), int(numbers[JOINTS + 3])
    pair = numbers[PAIR]
    heading, bits = 0.0, 0
    if third >= 0:
        heading, known = _heading(numbers, target, work)
        if not known:
            heading, bits = numbers[SIGNS + 2] * given[third], 1 << third
        lever = sub(vector(numbers, END), vector(numbers, TIP))
        goal = add(goal, turn(u, math.cos(heading), math.sin(heading), lever))
    found = _placed(numbers, goal, heading, given, pairs)
    n = none_yet()
    for i in range(found):
        a, b = pairs[i, 0], pairs[i, 1]
        q[n, first], q[n, second] = numbers[SIGNS] * a, numbers[SIGNS + 1] * b
        free[n], codes[n, 0] = bits | int(pairs[i, 2]), int(pairs[i, 3])
        if third >= 0:
            turned_by = (a if pair <= TURN_SLIDE else 0.0) + (
                b if pair in (TURN_TURN, SLIDE_TURN) else 0.0
            )
            q[n, third] = numbers[SIGNS + 2] * (heading - turned_by)
        if lift >= 0:
            q[n, lift] = numbers[SIGNS + 3] * height
        n = keep(form, target, measured, candidates, n, work)
    return n


@inner
def _placed(numbers: Array, goal: Vector, heading: float, given: Array, pairs: Array) -> int:
    """Fill rows with the values of the pair that bring its end to a goal; return their number.

    A row holds both values, bits of joints that are free, and the code of the posture; turns count
    about u.
    """
    u, pair, size = vector(numbers, U), numbers[PAIR], numbers[SIZE]
    pivot, end = vector(numbers, PIVOT), vector(numbers, END)
    if pair == TURN_TURN:
        return _two_turns(numbers, sub(goal, pivot), given, pairs)
    d1, d2 = vector(numbers, D1), vector(numbers, D2)
    c, s = math.cos(heading), math.sin(heading)
    if numbers[HEADED1] == 1.0:
        d1 = turn(u, c, s, d1)
    if numbers[HEADED2] == 1.0:
        d2 = turn(u, c, s, d2)
    if pair == SLIDE_SLIDE:
        return _two_slides(numbers, d1, d2, sub(goal, end), given, pairs)
    first = int(numbers[JOINTS])
    goal, lever = sub(goal, pivot), sub(end, pivot)
    goal = sub(goal, scale(dot(u, goal), u))
    if pair == TURN_SLIDE:
        found, one, other = slid_to(d2, lever, norm(goal), size)
    else:
        aside = cross(u, d1)
        found, one, other = component(aside, u, lever, dot(aside, goal), size)
    if found == FREE:
        found, one, other = 0, 0.0, 0.0
    for i in range(found):
        value, bits = one if i == 0 else other, 0
        if pair == TURN_SLIDE:
            determined, swing = align(u, add(lever, scale(value, d2)), goal, size)
            if not determined:
                swing, bits = numbers[SIGNS] * given[first], 1 << first
            pairs[i, 0], pairs[i, 1] = swing, value
            ahead = value + dot(d2, lever)
        else:
            reached = turn(u, math.cos(value), math.sin(value), lever)
            pairs[i, 0], pairs[i, 1] = dot(d1, sub(goal, reached)), value
            ahead = -dot(d1, reached)
        pairs[i, 2], pairs[i, 3] = bits, 0 if ahead >= 0.0 else 1
    return found


@inner
def _two_turns(numbers: Array, goal: Vector, given: Array, pairs: Array) -> int:
    u, size = vector(numbers, U), numbers[SIZE]
    a1, a2, a3 = vector(numbers, PIVOT), vector(numbers, ELBOW), vector(numbers, END)
    first = int(numbers[JOINTS])
    found, a, b = distance(u, sub(a3, a2), sub(a1, a2), norm(cross(u, goal)), size)
    for i in range(found):
        bend, bits = a if i == 0 else b, 0
        reached = sub(turn_about(u, a2, math.cos(bend), math.sin(bend), a3), a1)
        determined, swing = align(u, reached, goal, size)
        if not determined:
            swing, bits = numbers[SIGNS] * given[first], 1 << first
        elbow = turn(u, math.cos(swing), math.sin(swing), sub(a2, a1))
        pairs[i, 0], pairs[i, 1], pairs[i, 2] = swing, bend, bits
        pairs[i, 3] = elbow_code(u, goal, elbow)
    return found


@inner
def _two_slides(
    numbers: Array, d1: Vector, d2: Vector, goal: Vector, given: Array, pairs: Array
) -> int:
    u, bits = vector(numbers, U), 0
    across = dot(u, cross(d1, d2))
    goal = sub(goal, scale(dot(u, goal), u))
    if abs(across) > PARALLEL:
        a, b = dot(u, cross(goal, d2)) / across, dot(u, cross(d1, goal)) / across
    else:
        # The slides are parallel: no solution, or a family of them.
        if norm(cross(d1, goal)) > 1e-7 * numbers[SIZE]:
            return 0
        first = int(numbers[JOINTS])
        a, bits = given[first], 1 << first
        b = dot(d2, sub(goal, scale(a, d1)))
    pairs[0, 0], pairs[0, 1], pairs[0, 2], pairs[0, 3] = a, b, bits, 0
    return 1


@inner
def _heading(numbers: Array, target: Array, work: Array) -> tuple[float, bool]:
    """Return the turn about u from the frame at q = 0 to the target, rad, if it has one."""
    u = vector(numbers, U)
    inverse = numbers[FRAME : FRAME + 9]
    rotation = work[0:2].reshape(-1)
    for i in range(3):
        for j in range(3):
            rotation[3 * i + j] = (
                target[i, 0] * inverse[j]
                + target[i, 1] * inverse[3 + j]
                + target[i, 2] * inverse[6 + j]
            )
    image = turned(rotation, u)
    if norm(sub(image, u)) < 1e-6:
        v = cross(u, (1.0, 0.0, 0.0) if abs(u[0]) < 0.9 else (0.0, 1.0, 0.0))
        image = turned(rotation, v)
        return math.atan2(dot(u, cross(v, image)), dot(v, image)), True
    if dot(image, u) < -1.0 + 1e-9:
        return 0.0, False
    # Rotation about a by t: trace = 1 + 2 cos t and twist = 2 sin t a. The part about u turns by
    # 2 atan2(sin(t/2) a·u, cos(t/2)).
    trace = rotation[0] + rotation[4] + rotation[8]
    twist = (rotation[7] - rotation[5], rotation[2] - rotation[6], rotation[3] - rotation[1])
    if 1.0 + trace < 1e-12:
        return math.pi, True
    return 2.0 * math.atan2(dot(twist, u), 1.0 + trace), True
