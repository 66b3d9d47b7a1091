"""Seven joints, axes 1, 2, 3 through one point and axes 5, 6, 7 through another, compiled.

Shoulder, elbow, wrist as in a human arm. The distance from shoulder to wrist fixes joint 4; what
remains is one turn about the line between them, the swivel angle psi, which the caller chooses
(Kreutz-Delgado, Long and Seraji, *Kinematic Analysis of 7-DOF Manipulators*, IJRR 11(5), 1992;
Shimizu et al., IEEE T-RO 24(5), 2008). For each psi two elbows, two shoulders, two wrists.

psi turns about n, from the shoulder S to the wrist W, from the half-plane of S, W and the
direction of axis 1 (where that is along n: of the x axis of the base, or of y) to the half-plane
of S, W and the elbow E, the foot of S on axis 4. Where E is on the line SW, the direction of
axis 4 crossed with n stands for it, so that psi still counts the arm's turn about the line.

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
from kinematics.inverse.closed_form.spherical import bend, three_turns
from kinematics.inverse.closed_form.subproblems import distance
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

SIZE = 0
SHOULDER, ELBOW, WRIST = 1, 4, 7
WRIST_IN_TIP, AXIS7_IN_TIP, SIDE7_IN_TIP = 10, 13, 16
H4 = 19
FIRST = 22
"""Axes 1, 2, 3 as in :mod:`spherical`."""
LAST = 37
"""Axes 5, 6, 7."""

MOST = 8
STRETCHED = 1e-7
"""Distance of the elbow from the line, as a share of the arm, below which axis 4 stands for it."""
UPRIGHT = 1e-6
"""Sine of the angle between n and axis 1 below which the base's x axis gives the plane."""


@jit
def solve(
    form: FormConstants,
    target: Array,
    given: Array,
    swivel: float,
    measured: bool,
    candidates: Candidates,
) -> int:
    """Find all solutions of one target and swivel angle; arguments as in the other classes.

    The postures are those of shoulder, elbow and wrist. At most 8 solutions.
    """
    numbers, work = form.numbers, np.empty((WORK, 6))
    position, rotation = pose_parts(target, work)
    size = numbers[SIZE]
    s, e, w0 = vector(numbers, SHOULDER), vector(numbers, ELBOW), vector(numbers, WRIST)
    h4 = vector(numbers, H4)
    line = sub(add(position, turned(rotation, vector(numbers, WRIST_IN_TIP))), s)
    length = norm(line)
    if length <= 1e-9 * size:
        return 0
    image_c = turned(rotation, vector(numbers, AXIS7_IN_TIP))
    image_v = turned(rotation, vector(numbers, SIDE7_IN_TIP))
    axis = scale(1.0 / length, line)
    upright = _reference(vector(numbers, FIRST), axis)
    ahead = turn(axis, math.cos(swivel), math.sin(swivel), upright)
    third = cross(axis, ahead)
    c3, v3 = vector(numbers, FIRST + 6), vector(numbers, FIRST + 12)
    found, a, b = distance(h4, sub(w0, e), sub(s, e), length, size)
    n = none_yet()
    for i in range(found):
        q4 = a if i == 0 else b
        c4, s4 = math.cos(q4), math.sin(q4)
        along, outward = _arm_plane(numbers, c4, s4)
        side = cross(along, outward)
        # R1 R2 R3 turns (along, outward, side) to (axis, ahead, third).
        shoulder_c = _mapped(along, outward, side, axis, ahead, third, c3)
        shoulder_v = _mapped(along, outward, side, axis, ahead, third, v3)
        wrist_c = turn(h4, c4, -s4, _mapped(axis, ahead, third, along, outward, side, image_c))
        wrist_v = turn(h4, c4, -s4, _mapped(axis, ahead, third, along, outward, side, image_v))
        fold = dot(h4, cross(sub(s, e), sub(turn_about(h4, e, c4, s4, w0), e)))
        exists1, bent1 = bend(numbers, FIRST, shoulder_c)
        exists5, bent5 = bend(numbers, LAST, wrist_c)
        if not (exists1 and exists5):
            continue
        for j in range(2):
            loose1, q1, q2, q3 = three_turns(
                numbers, FIRST, shoulder_c, shoulder_v, -bent1 if j else bent1, given[0]
            )
            for k in range(2):
                loose5, q5, q6, q7 = three_turns(
                    numbers, LAST, wrist_c, wrist_v, -bent5 if k else bent5, given[4]
                )
                values, codes = (q1, q2, q3, q4, q5, q6, q7), (j, 0 if fold <= 0.0 else 1, k)
                put(candidates, n, values, codes, (1 if loose1 else 0) + (16 if loose5 else 0))
                n = keep(form, target, measured, candidates, n, work)
    return n


@jit
def swivel_of(numbers: Array, q: Array) -> float:
    """Return the swivel angle psi of a configuration, rad, in (-pi, pi].

    Args:
        numbers: See the places above.
        q: Shape (7,), rad.
    """
    along, outward = _arm_plane(numbers, math.cos(q[3]), math.sin(q[3]))
    for i in range(2, -1, -1):
        h = vector(numbers, FIRST + 3 * i)
        along = turn(h, math.cos(q[i]), math.sin(q[i]), along)
        outward = turn(h, math.cos(q[i]), math.sin(q[i]), outward)
    upright = _reference(vector(numbers, FIRST), along)
    return math.atan2(dot(along, cross(upright, outward)), dot(upright, outward))


@inner
def _reference(h1: Vector, n: Vector) -> Vector:
    """Return the unit vector across n in the reference half-plane."""
    r = sub(h1, scale(dot(h1, n), n))
    if norm(r) <= UPRIGHT:
        x = (1.0, 0.0, 0.0) if abs(n[0]) < 0.9 else (0.0, 1.0, 0.0)
        r = sub(x, scale(dot(x, n), n))
    return _across(r, n)


@inner
def _arm_plane(numbers: Array, c4: float, s4: float) -> tuple[Vector, Vector]:
    """Return the unit vectors from S to W and across it towards E, at q1 = q2 = q3 = 0."""
    s, e, w0 = vector(numbers, SHOULDER), vector(numbers, ELBOW), vector(numbers, WRIST)
    h4 = vector(numbers, H4)
    line = sub(turn_about(h4, e, c4, s4, w0), s)
    along = scale(1.0 / norm(line), line)
    outward = sub(sub(e, s), scale(dot(sub(e, s), along), along))
    if norm(outward) <= STRETCHED * numbers[SIZE]:
        outward = cross(h4, along)
    return along, _across(outward, along)


@inner
def _across(v: Vector, n: Vector) -> Vector:
    """Return a vector almost across the unit vector n as a unit vector across it, to rounding."""
    v = scale(1.0 / norm(v), v)
    v = sub(v, scale(dot(v, n), n))
    return scale(1.0 / norm(v), v)


@inner
def _mapped(a: Vector, b: Vector, c: Vector, x: Vector, y: Vector, z: Vector, v: Vector) -> Vector:
    """Apply the rotation that turns the triad a, b, c to x, y, z to v."""
    return add(add(scale(dot(a, v), x), scale(dot(b, v), y)), scale(dot(c, v), z))
