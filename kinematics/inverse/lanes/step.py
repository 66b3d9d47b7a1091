"""Compiled: damped least-squares steps; the lanes of :mod:`kinematics.inverse.damped_step`."""

from __future__ import annotations

from kinematics.compiled import inner
from kinematics.inverse.damped_step import LOWER, TURN, UPPER, WRAPS
from kinematics.inverse.lanes.error import Error
from kinematics.inverse.lanes.problem import Problem
from kinematics.lanes.memory import Pointer, load, store
from kinematics.lanes.vector import Vector, bits, floor, larger, mask_of, select, smaller, splat
from kinematics.lanes.walk import Pose


@inner
def counted(problem: Problem, J: Pointer, pose: Pose, sums: Pointer, like: Vector) -> None:
    """Leave of geometric columns what a task counts, by unknowns instead of joints.

    Args:
        problem: The chain and the task.
        J: Columns of its K joints, six rows of lane memory each; changed in place.
        pose: Of the frame.
        sums: Memory, six rows for each unknown.
        like: A vector of the width.
    """
    mask, n, K = problem.mask, problem.n, problem.K
    none = splat(0.0, like)
    for i in range(6):
        if mask[i] == 0.0:
            for k in range(K):
                store(J, 6 * k + i, none)
    if mask[6] != 0.0:  # without the turn about the frame's z axis
        ax, ay, az = pose[2], pose[6], pose[10]
        for k in range(K):
            b = 6 * k
            j3, j4, j5 = load(J, b + 3, like), load(J, b + 4, like), load(J, b + 5, like)
            about = j3 * ax + j4 * ay + j5 * az
            store(J, b + 3, j3 - about * ax)
            store(J, b + 4, j4 - about * ay)
            store(J, b + 5, j5 - about * az)
    if problem.is_coupled:
        for j in range(n):
            for i in range(6):
                total = splat(0.0, like)
                for k in range(K):
                    total = total + load(J, 6 * k + i, like) * problem.coupling[k * n + j]
                store(sums, 6 * j + i, total)
        for i in range(6 * n):
            store(J, i, load(sums, i, like))


@inner
def step(
    problem: Problem,
    J: Pointer,
    e: Error,
    damping: Vector,
    going: int,
    q: Pointer,
    moves: Pointer,
    like: Vector,
) -> None:
    """Take a damped step within the limits in the lanes that go on; the others stay.

    A joint at a limit that the step would push through it is held, and the others do without it.

    Args:
        problem: The chain, its limits, and the task.
        J: Jacobian columns, six rows of lane memory for each unknown; those that are held become 0.
        e: Task error.
        damping: λ, above 0.
        going: The lanes that go on, as bits.
        q: Unknowns, n rows; moved.
        moves: Memory, n rows.
        like: A vector of the width.
    """
    n, limits = problem.n, problem.limits
    none = splat(0.0, like)
    for _ in range(n):
        y0, y1, y2, y3, y4, y5 = damped(J, n, e, damping, like)
        again = 0
        for k in range(n):
            b = 6 * k
            d = load(J, b, like) * y0 + load(J, b + 1, like) * y1 + load(J, b + 2, like) * y2
            d = d + load(J, b + 3, like) * y3 + load(J, b + 4, like) * y4
            d = d + load(J, b + 5, like) * y5
            store(moves, k, d)
            if limits[WRAPS * n + k] == 0.0:
                value = load(q, k, like)
                below = (d < 0.0) & (value <= limits[LOWER * n + k])
                above = (d > 0.0) & (value >= limits[UPPER * n + k])
                held = bits(below | above) & going
                if held != 0:
                    again |= held
                    stopped = mask_of(held, like)
                    for i in range(6):
                        store(J, b + i, select(stopped, none, load(J, b + i, like)))
        if again == 0:
            break
    moving = mask_of(going, like)
    for k in range(n):
        old = load(q, k, like)
        lower, upper = splat(limits[LOWER * n + k], like), splat(limits[UPPER * n + k], like)
        value = old + load(moves, k, like)
        if limits[WRAPS * n + k] != 0.0:
            under, over = value < lower, value > upper
            if bits(under | over) & going != 0:
                up = -floor((value - lower) / TURN)
                down = -floor((upper - value) / TURN)
                value = select(under, value + TURN * up, select(over, value - TURN * down, value))
        store(q, k, select(moving, smaller(larger(value, lower), upper), old))


@inner
def damped(J: Pointer, n: int, e: Error, damping: Vector, like: Vector) -> Error:
    """Return the solution of ``(J Jᵀ + λ I) y = e`` by symmetric elimination (LDLᵀ).

    The elimination of :func:`kinematics.inverse.damped_step.damped`, in the same order.
    """
    a00 = a11 = a22 = a33 = a44 = a55 = damping
    none = splat(0.0, like)
    a10 = a20 = a30 = a40 = a50 = a21 = a31 = a41 = a51 = none
    a32 = a42 = a52 = a43 = a53 = a54 = none
    for k in range(n):
        b = 6 * k
        j0, j1, j2 = load(J, b, like), load(J, b + 1, like), load(J, b + 2, like)
        j3, j4, j5 = load(J, b + 3, like), load(J, b + 4, like), load(J, b + 5, like)
        a00 = a00 + j0 * j0
        a10, a11 = a10 + j1 * j0, a11 + j1 * j1
        a20, a21, a22 = a20 + j2 * j0, a21 + j2 * j1, a22 + j2 * j2
        a30, a31, a32, a33 = a30 + j3 * j0, a31 + j3 * j1, a32 + j3 * j2, a33 + j3 * j3
        a40, a41, a42 = a40 + j4 * j0, a41 + j4 * j1, a42 + j4 * j2
        a43, a44 = a43 + j4 * j3, a44 + j4 * j4
        a50, a51, a52 = a50 + j5 * j0, a51 + j5 * j1, a52 + j5 * j2
        a53, a54, a55 = a53 + j5 * j3, a54 + j5 * j4, a55 + j5 * j5
    y0, y1, y2, y3, y4, y5 = e

    r0 = 1.0 / a00
    f1, f2, f3, f4, f5 = a10 * r0, a20 * r0, a30 * r0, a40 * r0, a50 * r0
    a11 = a11 - f1 * a10
    a21, a22 = a21 - f2 * a10, a22 - f2 * a20
    a31, a32, a33 = a31 - f3 * a10, a32 - f3 * a20, a33 - f3 * a30
    a41, a42, a43, a44 = a41 - f4 * a10, a42 - f4 * a20, a43 - f4 * a30, a44 - f4 * a40
    a51, a52, a53 = a51 - f5 * a10, a52 - f5 * a20, a53 - f5 * a30
    a54, a55 = a54 - f5 * a40, a55 - f5 * a50
    y1, y2, y3, y4, y5 = y1 - f1 * y0, y2 - f2 * y0, y3 - f3 * y0, y4 - f4 * y0, y5 - f5 * y0

    r1 = 1.0 / larger(a11, damping)
    f2, f3, f4, f5 = a21 * r1, a31 * r1, a41 * r1, a51 * r1
    a22 = a22 - f2 * a21
    a32, a33 = a32 - f3 * a21, a33 - f3 * a31
    a42, a43, a44 = a42 - f4 * a21, a43 - f4 * a31, a44 - f4 * a41
    a52, a53, a54, a55 = a52 - f5 * a21, a53 - f5 * a31, a54 - f5 * a41, a55 - f5 * a51
    y2, y3, y4, y5 = y2 - f2 * y1, y3 - f3 * y1, y4 - f4 * y1, y5 - f5 * y1

    r2 = 1.0 / larger(a22, damping)
    f3, f4, f5 = a32 * r2, a42 * r2, a52 * r2
    a33 = a33 - f3 * a32
    a43, a44 = a43 - f4 * a32, a44 - f4 * a42
    a53, a54, a55 = a53 - f5 * a32, a54 - f5 * a42, a55 - f5 * a52
    y3, y4, y5 = y3 - f3 * y2, y4 - f4 * y2, y5 - f5 * y2

    r3 = 1.0 / larger(a33, damping)
    f4, f5 = a43 * r3, a53 * r3
    a44 = a44 - f4 * a43
    a54, a55 = a54 - f5 * a43, a55 - f5 * a53
    y4, y5 = y4 - f4 * y3, y5 - f5 * y3

    r4 = 1.0 / larger(a44, damping)
    f5 = a54 * r4
    a55 = a55 - f5 * a54
    y5 = y5 - f5 * y4

    y5 = y5 / larger(a55, damping)
    y4 = (y4 - a54 * y5) * r4
    y3 = (y3 - a43 * y4 - a53 * y5) * r3
    y2 = (y2 - a32 * y3 - a42 * y4 - a52 * y5) * r2
    y1 = (y1 - a21 * y2 - a31 * y3 - a41 * y4 - a51 * y5) * r1
    y0 = (y0 - a10 * y1 - a20 * y2 - a30 * y3 - a40 * y4 - a50 * y5) * r0
    return y0, y1, y2, y3, y4, y5
