"""Compiled: six joints, axes 2, 3 and 4 parallel, axes 5 and 6 meeting, in lanes.

The lanes of :mod:`kinematics.inverse.closed_form.parallel_axes`.
"""

from __future__ import annotations

from kinematics.compiled import inner
from kinematics.inverse.closed_form.lanes.nearest import Chosen, Joints, consider
from kinematics.inverse.closed_form.lanes.subproblems import align, component, distance
from kinematics.inverse.closed_form.lanes.wrist import bend, one_of, point_of, rotated, three_turns
from kinematics.inverse.closed_form.parallel_axes import (
    AXIS6_IN_TIP,
    H1,
    P1,
    P2,
    P3,
    P4,
    P5,
    POINT,
    POINT_IN_TIP,
    SIDE6_IN_TIP,
    SIGN3,
    SIGN4,
    SIZE,
    TRIPLE,
)
from kinematics.inverse.closed_form.vectors import add, cross, dot, sub, turn, vector
from kinematics.lanes.memory import Pointer, store
from kinematics.lanes.trigonometry import sine_cosine
from kinematics.lanes.vector import Vector


@inner
def parallel_forms(
    joints: Joints, numbers: Pointer, target: Pointer, chosen: Chosen, like: Vector
) -> Chosen:
    """Choose among the solutions of six joints; arguments as of :func:`.wrist.wrist_forms`."""
    h1, p1 = vector(numbers, H1), vector(numbers, P1)
    h, h5 = vector(numbers, TRIPLE), vector(numbers, TRIPLE + 3)
    p2, p3, p4 = vector(numbers, P2), vector(numbers, P3), vector(numbers, P4)
    p5, p6, size = vector(numbers, P5), vector(numbers, POINT), numbers[SIZE]
    x = sub(point_of(target, vector(numbers, POINT_IN_TIP), like), p1)
    image_c = rotated(target, vector(numbers, AXIS6_IN_TIP), like)
    image_v = rotated(target, vector(numbers, SIDE6_IN_TIP), like)
    back, q = (-h1[0], -h1[1], -h1[2]), joints.q
    first, unsure, sharp1, middle1, half1 = component(h, back, x, dot(h, sub(p6, p1)) + like, size)
    for i in range(2):
        q1 = one_of(middle1, half1, i)
        s1, c1 = sine_cosine(q1, 0.0)
        goal = add(turn(h1, c1, -s1, x), p1)
        wrist_c, wrist_v = turn(h1, c1, -s1, image_c), turn(h1, c1, -s1, image_v)
        there, doubt, sharp5, bent = bend(numbers, TRIPLE, wrist_c)
        unsure = unsure | (first & doubt)
        there = first & there
        for side in range(2):
            loose, sharp_sum, total, q5, q6 = three_turns(
                numbers, TRIPLE, wrist_c, wrist_v, bent if side else -bent
            )
            s5, c5 = sine_cosine(q5, 0.0)
            point = add(turn(h5, c5, s5, sub(p6, p5)), p5)
            sine, cosine = sine_cosine(total, 0.0)
            lever = turn(h, cosine, sine, (p4[0] - point[0], p4[1] - point[1], p4[2] - point[2]))
            end = sub(add(goal, lever), p2)
            across = cross(h, end)
            third, doubt, sharp3, middle, half = distance(
                h, sub(p4, p3), sub(p2, p3), dot(across, across), size
            )
            exists = there & third
            unsure = unsure | (there & (loose | doubt))
            for j in range(2):
                elbow = one_of(middle, half, j)
                s, c = sine_cosine(elbow, 0.0)
                reached = sub(add(turn(h, c, s, sub(p4, p3)), p3), p2)
                loose, sharp2, q2 = align(h, reached, end, size)
                unsure = unsure | (exists & loose)
                store(q, 0, q1)
                store(q, 1, q2)
                store(q, 2, numbers[SIGN3] * elbow)
                store(q, 3, numbers[SIGN4] * (total - q2 - elbow))
                store(q, 4, q5)
                store(q, 5, q6)
                sharp = sharp1 * sharp5 * sharp_sum * sharp3 * sharp2
                chosen = Chosen(chosen.distance, chosen.sharp, chosen.unsure | unsure)
                chosen = consider(joints, exists, sharp, chosen, like)
    return chosen
