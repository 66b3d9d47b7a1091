"""Three joints that place the tip, or six, the last three axes through one point, compiled.

The wrist centre fixes the first three joints (:mod:`regional`, :mod:`sliding`), the rotation that
remains the last three (Pieper, Stanford AIM-72, 1968). Of an arm of three joints the tip stands for
the wrist centre.

Directions and points are those at q = 0 in base axes; a product of exponentials moves them.
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
    pose_parts,
    put,
)
from kinematics.inverse.closed_form.elbow import elbow_code
from kinematics.inverse.closed_form.regional import (
    COLUMN,
    FORWARD,
    GENERAL,
    MIDDLE,
    REVERSED,
    SHOULDER,
    SLIDES,
    VARIANT,
    geometry,
    two_turns_and_one,
)
from kinematics.inverse.closed_form.sliding import (
    BETWEEN,
    CROSSED,
    LIFTED,
    ONE_TURN,
    SLIDES_ALONE,
    is_extended,
    one_turn,
    slides_alone,
    turn_slide_across,
    turn_slide_turn,
)
from kinematics.inverse.closed_form.spherical import bend, three_turns
from kinematics.inverse.closed_form.vectors import (
    Vector,
    add,
    cross,
    dot,
    scale,
    sub,
    turn,
    turn_about,
    turned,
    vector,
)
from kinematics.kernels import Array

WRIST_IN_TIP, AXIS6_IN_TIP, SIDE6_IN_TIP = 5, 8, 11
"""Wrist centre, axis 6 and the vector perpendicular to it, in the axes of the frame."""
TRIPLE = 39
"""Axes 4, 5, 6 as in :mod:`spherical`."""

MOST = 8
MOST_OF_THREE = 4


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
    found = _positions(numbers, w, given, arms, work)
    has_wrist, n = len(form.chain.is_revolute) > 3, none_yet()
    for i in range(found):
        shoulder, elbow = _posture(numbers, w, arms[i])
        if has_wrist:
            codes = (shoulder, elbow)
            n = _wrist(form, target, rotation, given, arms[i], codes, measured, candidates, n, work)
        else:
            values = (arms[i, 0], arms[i, 1], arms[i, 2])
            put(candidates, n, values, (shoulder, elbow, 0), int(arms[i, 3]))
            n = keep(form, target, measured, candidates, n, work)
    return n


@inner
def _wrist(
    form: FormConstants,
    target: Array,
    rotation: Array,
    given: Array,
    arm: Array,
    codes: tuple[int, int],
    measured: bool,
    candidates: Candidates,
    n: int,
    work: Array,
) -> int:
    """Add the solutions of joints 4, 5, 6 for one choice of the others: two, or none."""
    numbers, turns = form.numbers, form.chain.is_revolute
    wrist_c = turned(rotation, vector(numbers, AXIS6_IN_TIP))
    wrist_v = turned(rotation, vector(numbers, SIDE6_IN_TIP))
    h, _, _ = geometry(numbers)
    for k in range(3):
        if turns[k] != 0.0:
            c, s = math.cos(arm[k]), math.sin(arm[k])
            wrist_c, wrist_v = turn(h[k], c, -s, wrist_c), turn(h[k], c, -s, wrist_v)
    exists, bent = bend(numbers, TRIPLE, wrist_c)
    if exists:
        for side in range(2):
            loose, q4, q5, q6 = three_turns(
                numbers, TRIPLE, wrist_c, wrist_v, bent if side else -bent, given[3]
            )
            values = (arm[0], arm[1], arm[2], q4, q5, q6)
            free = int(arm[3]) + (8 if loose else 0)
            put(candidates, n, values, (codes[0], codes[1], side), free)
            n = keep(form, target, measured, candidates, n, work)
    return n


@inner
def _positions(numbers: Array, w: Vector, given: Array, arms: Array, work: Array) -> int:
    """Fill rows of arms with q1, q2, q3 that bring the point to w, and their free bits."""
    variant = numbers[VARIANT]
    if variant <= GENERAL:
        return two_turns_and_one(numbers, w, given, arms, work)
    if variant == ONE_TURN:
        return one_turn(numbers, w, given, arms)
    if variant == SLIDES_ALONE:
        return slides_alone(numbers, w, arms)
    if variant == CROSSED:
        return turn_slide_across(numbers, w, given, arms)
    return turn_slide_turn(numbers, w, given, arms, work)


@inner
def _posture(numbers: Array, w: Vector, arm: Array) -> tuple[int, int]:
    """Return the codes of shoulder and elbow of joint values q1, q2, q3; see :mod:`classify`."""
    variant = numbers[VARIANT]
    (h1, h2, h3), (p1, p2, p3), w0 = geometry(numbers)
    q1, q2, q3 = arm[0], arm[1], arm[2]
    c1, s1, c3, s3 = math.cos(q1), math.sin(q1), math.cos(q3), math.sin(q3)
    if variant in (GENERAL, BETWEEN, SLIDES_ALONE):
        return 0, 0
    if variant == ONE_TURN:
        return 0 if is_extended(numbers, w, arm) else 1, 0
    if variant == LIFTED:
        return elbow_code(h1, sub(w, p1), turn(h1, c1, s1, sub(p3, p1))), 0
    slides = numbers[SLIDES] == 1.0
    c2, s2 = math.cos(q2), math.sin(q2)
    if numbers[REVERSED] == 1.0:
        pivot = add(p2, scale(q1, h1))
        if variant == COLUMN:
            return elbow_code(h2, sub(w, pivot), turn(h2, c2, s2, sub(p3, p2))), 0
        ahead = dot(vector(numbers, FORWARD), turn(h3, c3, s3, sub(w0, p3)))
        return 0 if ahead >= 0.0 else 1, 0 if dot(h1, sub(w, pivot)) <= 0.0 else 1
    reached = add(w0, scale(q3, h3)) if slides else turn_about(h3, p3, c3, s3, w0)
    if variant == CROSSED:
        bent = 0 if dot(h1, cross(h3, sub(reached, p3))) >= 0.0 else 1
        return bent, 0 if q2 + dot(h2, sub(reached, p1)) >= 0.0 else 1
    if variant == COLUMN:
        bent = elbow_code(h1, sub(w, p1), turn(h1, c1, s1, sub(p2, p1)))
        side = dot(sub(reached, p3), cross(h1, h3))
        return bent, 0 if slides or side >= 0.0 else 1
    ahead = dot(vector(numbers, FORWARD), sub(turn_about(h2, p2, c2, s2, reached), p1))
    front = 0 if ahead >= 0.0 else 1
    if slides:
        return front, 0 if q3 >= numbers[MIDDLE] else 1
    if variant == SHOULDER:
        side = dot(h3, cross(sub(p3, p1), sub(reached, p3)))
        return front, 0 if side >= 0.0 else 1
    line = sub(w, add(p1, turn(h1, c1, s1, sub(p2, p1))))
    knee = turn(h2, c2, s2, sub(p3, p2))
    return front, elbow_code(turn(h1, c1, s1, h2), line, turn(h1, c1, s1, knee))
