"""Compiled: poses and Jacobian columns along a chain, as many at once as there are lanes."""

from __future__ import annotations

from typing import Any

from kinematics.compiled import inner
from kinematics.lanes.links import (
    ANGLE,
    COSINE,
    LENGTH,
    QUARTERS,
    REVOLUTE,
    SINE,
    WHOLE,
    WIDTH,
    A,
)
from kinematics.lanes.memory import Pointer, load, past, spread_out, store
from kinematics.lanes.trigonometry import sine_cosine
from kinematics.lanes.vector import LANES, Vector, eight_lanes, splat

Pose = tuple[Vector, ...]
"""The upper three rows of a 4x4 matrix, row by row: twelve vectors."""


@inner
def walk(links: Pointer, K: int, q: Pointer, trig: Any, axes: Any, like: Vector) -> Pose:
    """Return the poses of the frame at joint values.

    Args:
        links: Constants of the chain; see :func:`kinematics.lanes.links.links_of`.
        K: Number of joints.
        q: Joint values, rad and m: lane memory of K rows.
        trig: Their sines and cosines where they are known: lane memory of 2 K rows; else None.
        axes: Filled with axis and a point of the axis of each joint: lane memory of 6 K rows; None
            where they are not wanted.
        like: A vector of the width.
    """
    B = links
    x0, x1, x2 = splat(B[0], like), splat(B[4], like), splat(B[8], like)
    y0, y1, y2 = splat(B[1], like), splat(B[5], like), splat(B[9], like)
    z0, z1, z2 = splat(B[2], like), splat(B[6], like), splat(B[10], like)
    p0, p1, p2 = splat(B[3], like), splat(B[7], like), splat(B[11], like)
    for k in range(K):
        link = past(links, (k + 1) * WIDTH)
        value = load(q, k, like)
        if trig is not None:
            s, c = load(trig, k, like), load(trig, K + k, like)
        elif link[REVOLUTE] != 0.0:
            s, c = sine_cosine(value + link[ANGLE], link[QUARTERS])
        else:
            s, c = sine_cosine(splat(link[ANGLE], like), link[QUARTERS])
        d = splat(link[LENGTH], like) if link[REVOLUTE] != 0.0 else value + link[LENGTH]
        if axes is not None:
            store(axes, 6 * k, z0)
            store(axes, 6 * k + 1, z1)
            store(axes, 6 * k + 2, z2)
            store(axes, 6 * k + 3, p0)
            store(axes, 6 * k + 4, p1)
            store(axes, 6 * k + 5, p2)
        p0, p1, p2 = p0 + z0 * d, p1 + z1 * d, p2 + z2 * d
        t0, t1, t2 = c * x0 + s * y0, c * x1 + s * y1, c * x2 + s * y2
        y0, y1, y2 = c * y0 - s * x0, c * y1 - s * x1, c * y2 - s * x2
        x0, x1, x2 = t0, t1, t2
        if link[WHOLE] == 0.0:
            a, cosine, sine = link[A], link[COSINE], link[SINE]
            p0, p1, p2 = p0 + x0 * a, p1 + x1 * a, p2 + x2 * a
            t0, t1, t2 = y0 * cosine + z0 * sine, y1 * cosine + z1 * sine, y2 * cosine + z2 * sine
            z0, z1, z2 = z0 * cosine - y0 * sine, z1 * cosine - y1 * sine, z2 * cosine - y2 * sine
            y0, y1, y2 = t0, t1, t2
        else:
            x0, y0, z0, p0 = _placed(past(link, A), x0, y0, z0, p0)
            x1, y1, z1, p1 = _placed(past(link, A), x1, y1, z1, p1)
            x2, y2, z2, p2 = _placed(past(link, A), x2, y2, z2, p2)
    E = past(links, (K + 1) * WIDTH)
    x0, y0, z0, p0 = _placed(E, x0, y0, z0, p0)
    x1, y1, z1, p1 = _placed(E, x1, y1, z1, p1)
    x2, y2, z2, p2 = _placed(E, x2, y2, z2, p2)
    return x0, y0, z0, p0, x1, y1, z1, p1, x2, y2, z2, p2


@inner
def trigonometry_of(links: Pointer, K: int, q: Pointer, memory: Pointer, trig: Pointer) -> None:
    """Compute sines and cosines of one configuration, eight joints at once.

    The operations on each are those of :func:`walk`.

    Args:
        links: Constants of the chain.
        K: Number of joints.
        q: Joint values, rad and m, K numbers.
        memory: 32 numbers.
        trig: Filled: K sines, then K cosines.
    """
    like = eight_lanes()
    for first in range(0, K, LANES):
        count = min(LANES, K - first)
        for k in range(count):
            link = past(links, (first + k + 1) * WIDTH)
            angle = link[ANGLE]
            memory[2 * k] = q[first + k] + angle if link[REVOLUTE] != 0.0 else angle
            memory[2 * k + 1] = link[QUARTERS]
        for k in range(count, LANES):
            memory[2 * k] = memory[2 * k + 1] = 0.0
        angles, quarters = spread_out(memory, 2, like), spread_out(past(memory, 1), 2, like)
        s, c = sine_cosine(angles, quarters)
        store(past(memory, 16), 0, s)
        store(past(memory, 16), 1, c)
        for k in range(count):
            trig[first + k], trig[K + first + k] = memory[16 + k], memory[24 + k]


@inner
def _placed(C: Pointer, x: Vector, y: Vector, z: Vector, p: Vector) -> tuple[Vector, ...]:
    """Return a row of a pose after a constant placement, 12 numbers."""
    return (
        x * C[0] + y * C[4] + z * C[8],
        x * C[1] + y * C[5] + z * C[9],
        x * C[2] + y * C[6] + z * C[10],
        p + x * C[3] + y * C[7] + z * C[11],
    )


@inner
def columns(links: Pointer, K: int, axes: Pointer, pose: Pose, like: Vector) -> None:
    """Turn axes and points into columns of the geometric Jacobian at the frame's origin.

    Args:
        links: Constants of the chain.
        K: Number of joints.
        axes: As :func:`walk` filled it; then linear and angular part of each column, base axes.
        pose: What it returned.
        like: A vector of the width.
    """
    p0, p1, p2 = pose[3], pose[7], pose[11]
    none = splat(0.0, like)
    for k in range(K):
        b = 6 * k
        z0, z1, z2 = load(axes, b, like), load(axes, b + 1, like), load(axes, b + 2, like)
        if links[(k + 1) * WIDTH + REVOLUTE] != 0.0:
            d0 = p0 - load(axes, b + 3, like)
            d1 = p1 - load(axes, b + 4, like)
            d2 = p2 - load(axes, b + 5, like)
            store(axes, b, z1 * d2 - z2 * d1)
            store(axes, b + 1, z2 * d0 - z0 * d2)
            store(axes, b + 2, z0 * d1 - z1 * d0)
            store(axes, b + 3, z0)
            store(axes, b + 4, z1)
            store(axes, b + 5, z2)
        else:
            store(axes, b + 3, none)
            store(axes, b + 4, none)
            store(axes, b + 5, none)
