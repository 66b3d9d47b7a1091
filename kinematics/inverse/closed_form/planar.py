"""All axes parallel, compiled: planar 2R, planar 3R and SCARA.

A plane 2R arm (subproblems 3 and 1), where there is a third turn at the end whose angle the
target fixes, and a slide anywhere along the axes that sets the height. The base may stand in any
way; u is the common direction, upwards (u · z_base > 0 where it is not across z_base).
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
from kinematics.inverse.closed_form.subproblems import align, distance
from kinematics.inverse.closed_form.vectors import (
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

SIZE = 0
U = 1
A1, A2, A3 = 4, 7, 10
"""Points of the turning axes in one plane across them, at q = 0; A3 is the tip without third."""
TIP = 13
"""The frame's origin at q = 0, in that plane."""
HEIGHT = 16
"""Its component along u at q = 0."""
SIGNS = 17
"""Of each turning joint and of the slide: 1 where its axis is u, -1 where it is -u."""
JOINTS = 21
"""Indices of the turning joints and of the slide, -1 for those that are missing."""
FRAME = 25
"""Rotation of the frame at q = 0, transposed, row by row."""

MOST = 2


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
    size, u = numbers[SIZE], vector(numbers, U)
    a1, a2, a3 = vector(numbers, A1), vector(numbers, A2), vector(numbers, A3)
    end = (target[0, 3], target[1, 3], target[2, 3])
    height = dot(u, end) - numbers[HEIGHT]
    third, slide = int(numbers[JOINTS + 2]), int(numbers[JOINTS + 3])
    heading, bits = 0.0, 0
    if third >= 0:
        heading, known = _heading(numbers, target, work)
        if not known:
            heading, bits = numbers[SIGNS + 2] * given[third], 1 << third
        lever = sub(a3, vector(numbers, TIP))
        end = add(end, turn(u, math.cos(heading), math.sin(heading), lever))
    goal = sub(end, a1)
    found, a, b = distance(u, sub(a3, a2), sub(a1, a2), norm(cross(u, goal)), size)
    first, second = int(numbers[JOINTS]), int(numbers[JOINTS + 1])
    n = none_yet()
    for i in range(found):
        bend = a if i == 0 else b
        reached = sub(turn_about(u, a2, math.cos(bend), math.sin(bend), a3), a1)
        determined, swing = align(u, reached, goal, size)
        free[n] = bits
        if not determined:
            swing = numbers[SIGNS] * given[first]
            free[n] = bits | (1 << first)
        q[n, first] = numbers[SIGNS] * swing
        q[n, second] = numbers[SIGNS + 1] * bend
        if third >= 0:
            q[n, third] = numbers[SIGNS + 2] * (heading - swing - bend)
        if slide >= 0:
            q[n, slide] = numbers[SIGNS + 3] * height
        elbow = turn(u, math.cos(swing), math.sin(swing), sub(a2, a1))
        codes[n, 0] = elbow_code(u, goal, elbow)
        n = keep(form, target, measured, candidates, n, work)
    return n


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
