"""Compiled: planar arms and SCARA that place a point by two turns, in lanes.

The lanes of :mod:`kinematics.inverse.closed_form.planar`.
"""

from __future__ import annotations

from kinematics.compiled import inner
from kinematics.inverse.closed_form.lanes.nearest import Chosen, Joints, consider
from kinematics.inverse.closed_form.lanes.subproblems import Three, align, distance, signed_angle
from kinematics.inverse.closed_form.lanes.wrist import one_of, rotated
from kinematics.inverse.closed_form.planar import (
    ELBOW,
    END,
    FRAME,
    HEIGHT,
    JOINTS,
    PIVOT,
    SIGNS,
    SIZE,
    TIP,
    U,
)
from kinematics.inverse.closed_form.vectors import add, cross, dot, sub, turn, vector
from kinematics.lanes.memory import Pointer, load, store
from kinematics.lanes.trigonometry import sine_cosine
from kinematics.lanes.vector import Vector, splat


@inner
def _from_frame(numbers: Pointer, v: Three) -> Three:
    """Apply the transposed rotation of the frame at q = 0."""
    b = FRAME
    return (
        numbers[b] * v[0] + numbers[b + 1] * v[1] + numbers[b + 2] * v[2],
        numbers[b + 3] * v[0] + numbers[b + 4] * v[1] + numbers[b + 5] * v[2],
        numbers[b + 6] * v[0] + numbers[b + 7] * v[1] + numbers[b + 8] * v[2],
    )


@inner
def planar_forms(
    joints: Joints, numbers: Pointer, target: Pointer, chosen: Chosen, like: Vector
) -> Chosen:
    """Choose among the solutions of a pair of turns; arguments as of :func:`.wrist.wrist_forms`.

    A target that is tilted against what the arm can do is unsure.
    """
    u, size, q = vector(numbers, U), numbers[SIZE], joints.q
    a1, a2, a3 = vector(numbers, PIVOT), vector(numbers, ELBOW), vector(numbers, END)
    first, second = int(numbers[JOINTS]), int(numbers[JOINTS + 1])
    third, lift = int(numbers[JOINTS + 2]), int(numbers[JOINTS + 3])
    goal = (load(target, 3, like), load(target, 7, like), load(target, 11, like))
    height = dot(u, goal) - numbers[HEIGHT]
    heading, unsure = splat(0.0, like), chosen.unsure
    if third >= 0:
        off = sub(rotated(target, _from_frame(numbers, u), like), u)
        unsure = unsure | ~(dot(off, off) < 0.25e-12)
        v = cross(u, (1.0, 0.0, 0.0) if abs(u[0]) < 0.9 else (0.0, 1.0, 0.0))
        image = rotated(target, _from_frame(numbers, v), like)
        heading = signed_angle(dot(u, cross(v, image)), dot(v, image))
        sine, cosine = sine_cosine(heading, 0.0)
        goal = add(goal, turn(u, cosine, sine, sub(a3, vector(numbers, TIP))))
    goal = sub(goal, a1)
    across = cross(u, goal)
    exists, doubt, sharp, middle, half = distance(
        u, sub(a3, a2), sub(a1, a2), dot(across, across), size
    )
    unsure = unsure | doubt
    for i in range(2):
        bend = one_of(middle, half, i)
        sine, cosine = sine_cosine(bend, 0.0)
        reached = sub(add(turn(u, cosine, sine, sub(a3, a2)), a2), a1)
        loose, swing_sharp, swing = align(u, reached, goal, size)
        store(q, first, numbers[SIGNS] * swing)
        store(q, second, numbers[SIGNS + 1] * bend)
        if third >= 0:
            store(q, third, numbers[SIGNS + 2] * (heading - (swing + bend)))
        if lift >= 0:
            store(q, lift, numbers[SIGNS + 3] * height)
        unsure = unsure | (exists & loose)
        chosen = Chosen(chosen.distance, chosen.sharp, chosen.unsure | unsure)
        chosen = consider(joints, exists, sharp * swing_sharp, chosen, like)
    return chosen
