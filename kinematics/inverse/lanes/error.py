"""Compiled: the error of poses in a task; the lanes of :mod:`kinematics.inverse.task_error`."""

from __future__ import annotations

import math

from kinematics.compiled import inner
from kinematics.lanes.memory import Pointer, load
from kinematics.lanes.trigonometry import angle, angle_over_sine
from kinematics.lanes.vector import Vector, bits, larger, select, splat, square_root
from kinematics.lanes.walk import Pose

Error = tuple[Vector, Vector, Vector, Vector, Vector, Vector]
"""Position error, m, then a rotation vector, rad; both in base axes."""


@inner
def task_error(pose: Pose, target: Pointer, mask: Pointer, like: Vector) -> Error:
    """Return the errors of poses, rows that a task does not count being 0.

    Args:
        pose: Of the frame.
        target: Where it is to be: lane memory of twelve rows.
        mask: See :attr:`kinematics.task.Task.mask`; shape (7,).
        like: A vector of the width.
    """
    if mask[6] != 0.0:
        x, y, z = _to_axis(pose, target, like)
    else:
        x, y, z = _rotation_vector(pose, target, like)
    return (
        (load(target, 3, like) - pose[3]) * mask[0],
        (load(target, 7, like) - pose[7]) * mask[1],
        (load(target, 11, like) - pose[11]) * mask[2],
        x * mask[3],
        y * mask[4],
        z * mask[5],
    )


@inner
def _rotation_vector(pose: Pose, target: Pointer, like: Vector) -> tuple[Vector, Vector, Vector]:
    """Return the rotation vector of ``R_G R_Tᵀ``, rad, exact to rounding from 0 to half a turn."""
    a0, a1, a2 = load(target, 0, like), load(target, 1, like), load(target, 2, like)
    b0, b1, b2 = load(target, 4, like), load(target, 5, like), load(target, 6, like)
    c0, c1, c2 = load(target, 8, like), load(target, 9, like), load(target, 10, like)
    d00 = a0 * pose[0] + a1 * pose[1] + a2 * pose[2]
    d01 = a0 * pose[4] + a1 * pose[5] + a2 * pose[6]
    d02 = a0 * pose[8] + a1 * pose[9] + a2 * pose[10]
    d10 = b0 * pose[0] + b1 * pose[1] + b2 * pose[2]
    d11 = b0 * pose[4] + b1 * pose[5] + b2 * pose[6]
    d12 = b0 * pose[8] + b1 * pose[9] + b2 * pose[10]
    d20 = c0 * pose[0] + c1 * pose[1] + c2 * pose[2]
    d21 = c0 * pose[4] + c1 * pose[5] + c2 * pose[6]
    d22 = c0 * pose[8] + c1 * pose[9] + c2 * pose[10]
    x, y, z = 0.5 * (d21 - d12), 0.5 * (d02 - d20), 0.5 * (d10 - d01)
    s = square_root(x * x + y * y + z * z)
    c = 0.5 * (d00 + d11 + d22 - 1.0)
    half = (c <= 0.0) & (s <= 1e-3)
    f = angle_over_sine(s, c)
    e3, e4, e5 = f * x, f * y, f * z
    if bits(half) == 0:
        return e3, e4, e5
    # Near half a turn the antisymmetric part vanishes; the axis is in the symmetric one.
    none, b = splat(0.0, like), select(half, 1.0 - c, 1.0)
    u = square_root(larger(none, (d00 - c) / b))
    v = square_root(larger(none, (d11 - c) / b))
    w = square_root(larger(none, (d22 - c) / b))
    first = (u >= v) & (u >= w)
    second = ~first & (v >= w)
    largest = select(first, u, select(second, v, w))
    largest = select(select(first, x, select(second, y, z)) < 0.0, -largest, largest)
    scale = b * select(largest == 0.0, 1.0, largest)
    xy, xz, yz = 0.5 * (d01 + d10) / scale, 0.5 * (d02 + d20) / scale, 0.5 * (d12 + d21) / scale
    turn = angle(s, c)
    u = turn * select(first, largest, select(second, xy, xz))
    v = turn * select(first, xy, select(second, largest, yz))
    w = turn * select(first, xz, select(second, yz, largest))
    return select(half, u, e3), select(half, v, e4), select(half, w, e5)


@inner
def _to_axis(pose: Pose, target: Pointer, like: Vector) -> tuple[Vector, Vector, Vector]:
    """Return the rotation vector that turns z_T to z_G, rad; perpendicular to both."""
    x, y, z = pose[2], pose[6], pose[10]
    u, v, w = load(target, 2, like), load(target, 6, like), load(target, 10, like)
    a, b, c = y * w - z * v, z * u - x * w, x * v - y * u
    s, along = square_root(a * a + b * b + c * c), x * u + y * v + z * w
    f = angle_over_sine(s, along)
    back = (along < 0.0) & (s < 1e-9)  # half a turn, about any axis across: the frame's x
    return (
        select(back, math.pi * pose[0], f * a),
        select(back, math.pi * pose[4], f * b),
        select(back, math.pi * pose[8], f * c),
    )
