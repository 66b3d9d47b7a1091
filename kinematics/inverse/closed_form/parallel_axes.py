"""Six joints, axes 2, 3 and 4 parallel (Universal Robots and alike), compiled.

The component along the parallel axes and the angle between them and axis 6 do not depend on
joints 2, 3 and 4: two equations for joints 1 and 5 (Elias and Wen, *IK-Geo*, arXiv 2211.05737,
section on three parallel axes; Hawkins, *Analytic Inverse Kinematics for the Universal Robots
UR-5/UR-10 Arms*, 2013). Where axes 5 and 6 meet, joint 1 follows from the first alone; else both
together are a quartic. Then the sum of joints 2, 3, 4 with joints 5 and 6 are three turns about
known directions, and joints 2 and 3 a plane arm.

Directions and points are those at q = 0 in base axes; a product of exponentials moves them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

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
from kinematics.inverse.closed_form.subproblems import FREE, align, component, distance
from kinematics.inverse.closed_form.vectors import (
    Vector,
    add,
    cross,
    dot,
    norm,
    sub,
    turn,
    turn_about,
    turned,
    vector,
)
from kinematics.kernels import Array

MEETS = 0
"""1 where axes 5 and 6 meet."""
SIZE = 1
POINT = 2
"""The point of axis 6 nearest to axis 5, at q = 0."""
POINT_IN_TIP, AXIS6_IN_TIP, SIDE6_IN_TIP = 5, 8, 11
H1, P1 = 14, 17
P2, P3, P4, P5 = 20, 23, 26, 29
"""Points of axes 2, 3, 4 in one plane across them, and of axis 5 nearest to axis 6."""
SIGN3, SIGN4 = 32, 33
"""1 where the axis points as axis 2 does, -1 where it points the other way."""
FORWARD = 34
TRIPLE = 37
"""Axes 2, 5, 6 as in :mod:`spherical`."""

MOST = 16
NEARLY_STRAIGHT = 1e-9


class Branch(NamedTuple):
    """One choice of joints 1, 5 and 6.

    Attributes:
        goal: Where axes 5 and 6 meet (or the point of axis 6 is) at the target, joint 1 turned
            back; m.
        point: That point with joint 5 turned, joints 2, 3, 4 at 0; m.
        total: Sum of joints 2, 3, 4, counted about axis 2, rad.
        q1: Joint 1, rad.
        q5: Joint 5, rad.
        q6: Joint 6, rad.
        shoulder: Code of the shoulder; 0 where axes 5 and 6 do not meet.
        side: Code of the wrist.
        free: Bits of the joints that the branch leaves free.
    """

    goal: Vector
    point: Vector
    total: float
    q1: float
    q5: float
    q6: float
    shoulder: int
    side: int
    free: int


@jit
def solve(
    form: FormConstants,
    target: Array,
    given: Array,
    swivel: float,  # noqa: ARG001 - the same arguments for every class
    measured: bool,
    candidates: Candidates,
) -> int:
    """Find all solutions of one target; arguments as of :func:`spherical_wrist.solve`."""
    numbers, work = form.numbers, np.empty((WORK, 6))
    first = work[WORK - 13, 0:4]
    position, rotation = pose_parts(target, work)
    h1, p1 = vector(numbers, H1), vector(numbers, P1)
    h, h5 = vector(numbers, TRIPLE), vector(numbers, TRIPLE + 3)
    p5, p6 = vector(numbers, P5), vector(numbers, POINT)
    x = sub(add(position, turned(rotation, vector(numbers, POINT_IN_TIP))), p1)
    image_c = turned(rotation, vector(numbers, AXIS6_IN_TIP))
    image_v = turned(rotation, vector(numbers, SIDE6_IN_TIP))
    size = numbers[SIZE]
    meets = numbers[MEETS] == 1.0
    if meets:
        back = (-h1[0], -h1[1], -h1[2])
        n1, first[0], first[1] = component(h, back, x, dot(h, sub(p6, p1)), size)
    else:
        n1 = _first_joint(numbers, x, image_c, first, work)
    bits = 0
    if n1 == FREE:
        n1, first[0], bits = 1, given[0], 1
    n = none_yet()
    for i in range(n1):
        c1, s1 = math.cos(first[i]), math.sin(first[i])
        y = turn(h1, c1, -s1, x)
        shoulder = 0 if not meets or dot(vector(numbers, FORWARD), y) < 0.0 else 1
        goal = add(p1, y)
        wrist_c, wrist_v = turn(h1, c1, -s1, image_c), turn(h1, c1, -s1, image_v)
        exists, bent = bend(numbers, TRIPLE, wrist_c)
        if not exists:
            continue
        for side in range(2):
            loose, total, q5, q6 = three_turns(
                numbers, TRIPLE, wrist_c, wrist_v, bent if side else -bent, 0.0
            )
            c5, s5 = math.cos(q5), math.sin(q5)
            point = turn_about(h5, p5, c5, s5, p6)
            if not meets and abs(dot(h, sub(goal, point))) > 1e-4 * size:
                continue
            before = n
            if not loose:
                branch = Branch(goal, point, total, first[i], q5, q6, shoulder, 1 - side, bits)
                n = _plane(form, branch, target, given, measured, candidates, n, work)
            straight = abs(dot(h5, cross(h, turn(h5, c5, s5, vector(numbers, TRIPLE + 6)))))
            if loose or ((n == before or not measured) and straight < NEARLY_STRAIGHT):
                total, q6 = _straight(numbers, wrist_v, q5, given[5], goal, point)
                bits5 = bits + 32
                branch = Branch(goal, point, total, first[i], q5, q6, shoulder, 1 - side, bits5)
                n = _plane(form, branch, target, given, measured, candidates, n, work)
    return n


@inner
def _first_joint(numbers: Array, x: Vector, image_c: Vector, first: Array, work: Array) -> int:
    """Solve joint 1 where axes 5 and 6 do not meet: joint 5 eliminated, a quartic."""
    h1, p1 = vector(numbers, H1), vector(numbers, P1)
    h, h5 = vector(numbers, TRIPLE), vector(numbers, TRIPLE + 3)
    h6, p5 = vector(numbers, TRIPLE + 6), vector(numbers, P5)
    b = sub(vector(numbers, POINT), p5)
    k1, k2, r, total = work[0, 0:3], work[1, 0:3], work[2, 0:3], work[3, 0:5]
    # g · R1ᵀ v = g·h1 h1·v + c (…) - s g·(h1 × v), for the point and for axis 6.
    along = dot(h, h1) * dot(h1, x)
    k1[0] = along - dot(h, sub(p5, p1)) - dot(h, h5) * dot(h5, b)
    k1[1], k1[2] = dot(h, x) - dot(h, h1) * dot(h1, x), -dot(h, cross(h1, x))
    along = dot(h, h1) * dot(h1, image_c)
    k2[0] = along - dot(h, h5) * dot(h5, h6)
    k2[1], k2[2] = dot(h, image_c) - along, -dot(h, cross(h1, image_c))
    # What joint 5 can make of them: rows (cos, sin) of the two equations.
    a11, a12 = dot(h, b) - dot(h, h5) * dot(h5, b), dot(h, cross(h5, b))
    a21, a22 = dot(h, h6) - dot(h, h5) * dot(h5, h6), dot(h, cross(h5, h6))
    determinant = a11 * a22 - a12 * a21
    for i in range(5):
        total[i] = 0.0
    for i in range(3):
        r[i] = (a22 * k1[i] - a12 * k2[i]) / determinant
    times(r, r, 1.0, total)
    for i in range(3):
        r[i] = (a11 * k2[i] - a21 * k1[i]) / determinant
    times(r, r, 1.0, total)
    total[0] -= 1.0
    return roots(total, first)


@inner
def _plane(
    form: FormConstants,
    branch: Branch,
    target: Array,
    given: Array,
    measured: bool,
    candidates: Candidates,
    n: int,
    work: Array,
) -> int:
    """Add the solutions of joints 2, 3, 4 for one choice of the others: up to two."""
    numbers, goal, point, total = form.numbers, branch.goal, branch.point, branch.total
    size, sign3, sign4 = numbers[SIZE], numbers[SIGN3], numbers[SIGN4]
    h, h1 = vector(numbers, TRIPLE), vector(numbers, H1)
    c1, s1 = math.cos(branch.q1), math.sin(branch.q1)
    p2, p3, p4 = vector(numbers, P2), vector(numbers, P3), vector(numbers, P4)
    end = sub(add(goal, turn(h, math.cos(total), math.sin(total), sub(p4, point))), p2)
    across = norm(cross(h, end))
    found, a, b = distance(h, sub(p4, p3), sub(p2, p3), across, size)
    for i in range(found):
        elbow = a if i == 0 else b
        reached = sub(turn_about(h, p3, math.cos(elbow), math.sin(elbow), p4), p2)
        determined, q2 = align(h, reached, end, size)
        if not determined:
            q2 = given[1]
        q3, q4 = sign3 * elbow, sign4 * (total - q2 - elbow)
        knee = turn(h, math.cos(q2), math.sin(q2), sub(p3, p2))
        bent = elbow_code(turn(h1, c1, s1, h), turn(h1, c1, s1, end), turn(h1, c1, s1, knee))
        values = (branch.q1, q2, q3, q4, branch.q5, branch.q6)
        codes = (branch.shoulder, bent, branch.side)
        put(candidates, n, values, codes, branch.free if determined else branch.free | 2)
        n = keep(form, target, measured, candidates, n, work)
    return n


@inner
def _straight(
    numbers: Array,
    wrist_v: Vector,
    q5: float,
    given: float,
    goal: Vector,
    point: Vector,
) -> tuple[float, float]:
    """Solve where axis 6 is parallel to axes 2, 3, 4: joint 6 as given, or the nearest in reach.

    Returns:
        The sum of joints 2, 3, 4 (counted about axis 2), and joint 6, rad.
    """
    h, h5 = vector(numbers, TRIPLE), vector(numbers, TRIPLE + 3)
    h6, v = vector(numbers, TRIPLE + 6), vector(numbers, TRIPLE + 12)
    p2, p3, p4 = vector(numbers, P2), vector(numbers, P3), vector(numbers, P4)
    c5, s5 = math.cos(q5), math.sin(q5)
    turned_v = turn(h5, c5, s5, turn(h6, math.cos(given), math.sin(given), v))
    _, total = align(h, turned_v, wrist_v, 1.0)
    # The end of the plane arm lies on a circle: |base + R(h, total) lever| between two radii.
    base, lever = sub(goal, p2), sub(p4, point)
    base, lever = cross(base, h), cross(lever, h)
    upper, fore = norm(cross(h, sub(p3, p2))), norm(cross(h, sub(p4, p3)))
    product = norm(base) * norm(lever)
    if product > 0.0:
        _, opposite = align(h, lever, base, 1e-300)
        square = dot(base, base) + dot(lever, lever)
        # |…|² = square + 2 product cos(total - opposite)
        most = max(-1.0, min(1.0, ((upper + fore) ** 2 - square) / (2.0 * product)))
        least = max(-1.0, min(1.0, ((upper - fore) ** 2 - square) / (2.0 * product)))
        away = total - opposite
        away -= 2.0 * math.pi * math.floor((away + math.pi) / (2.0 * math.pi))
        bounded = min(max(abs(away), math.acos(most)), math.acos(least))
        total = opposite + (bounded if away >= 0.0 else -bounded)
    w = turn(h5, c5, -s5, turn(h, math.cos(total), -math.sin(total), wrist_v))
    return total, math.atan2(dot(h6, cross(v, w)), dot(v, w))
