"""Vectors of three as tuples, compiled: no memory is taken for them."""

from __future__ import annotations

import math

from kinematics.compiled import inner
from robots.robot import FloatArray

Vector = tuple[float, float, float]


@inner
def vector(values: FloatArray, start: int) -> Vector:
    """Return three successive entries of an array."""
    return (values[start], values[start + 1], values[start + 2])


@inner
def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@inner
def add(a: Vector, b: Vector) -> Vector:
    """Return the sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@inner
def sub(a: Vector, b: Vector) -> Vector:
    """Return the difference."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inner
def scale(k: float, a: Vector) -> Vector:
    """Return a multiple."""
    return (k * a[0], k * a[1], k * a[2])


@inner
def norm(a: Vector) -> float:
    """Return the Euclidean length."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@inner
def turn(h: Vector, c: float, s: float, v: Vector) -> Vector:
    """Turn a vector about a unit vector by the angle of cosine c and sine s (Rodrigues)."""
    k = (1.0 - c) * dot(h, v)
    x = cross(h, v)
    return (
        c * v[0] + s * x[0] + k * h[0],
        c * v[1] + s * x[1] + k * h[1],
        c * v[2] + s * x[2] + k * h[2],
    )


@inner
def turn_about(h: Vector, p: Vector, c: float, s: float, v: Vector) -> Vector:
    """Turn a point about the line through p along the unit vector h."""
    return add(p, turn(h, c, s, sub(v, p)))


@inner
def turned(values: FloatArray, v: Vector) -> Vector:
    """Apply the rotation in the first nine entries of an array (row by row) to a vector."""
    return (
        values[0] * v[0] + values[1] * v[1] + values[2] * v[2],
        values[3] * v[0] + values[4] * v[1] + values[5] * v[2],
        values[6] * v[0] + values[7] * v[1] + values[8] * v[2],
    )


@inner
def angle_between(a: Vector, b: Vector) -> float:
    """Return the angle of two vectors, 0 to pi, exact to rounding near 0 and pi too."""
    return math.atan2(norm(cross(a, b)), dot(a, b))


@inner
def wrapped(angle: float) -> float:
    """Return the same angle in (-pi, pi]."""
    if -math.pi < angle <= math.pi:
        return angle
    angle -= 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))
    if angle <= -math.pi:
        angle += 2.0 * math.pi
    return min(angle, math.pi)
