"""Obstacles: checks, and the rows of numbers that the compiled distances read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from dh_to_urdf.messages import say
from kinematics.bounds import MAX_VALUE, Bounds
from kinematics.errors import InvalidOption
from robots.robot import FloatArray

SPHERE, CIRCLE, CAPSULE, HALF_SPACE, BOX = 0.0, 1.0, 2.0, 3.0, 4.0
WIDTH = 16
RADIUS = Bounds(0.0, MAX_VALUE)
"""Bounds of the radius of an obstacle, m."""


@dataclass(frozen=True)
class Sphere:
    """A ball: center (3,) and radius, m, in base axes."""

    center: Sequence[float]
    radius: float


@dataclass(frozen=True)
class CircleObstacle:
    """A disc of the plane xy, at every height: center (2 or 3 numbers) and radius, m."""

    center: Sequence[float]
    radius: float


@dataclass(frozen=True)
class Capsule:
    """The points nearer than radius to the segment from start to end, m."""

    start: Sequence[float]
    end: Sequence[float]
    radius: float


@dataclass(frozen=True)
class HalfSpace:
    """The points p behind a plane, normal · p < offset (m, along the unit normal)."""

    normal: Sequence[float]
    offset: float


@dataclass(frozen=True)
class Box:
    """A box: center (3,), edge lengths (3,), m, and the rotation of its axes, 3x3."""

    center: Sequence[float]
    size: Sequence[float]
    rotation: FloatArray | None = None


Obstacle: TypeAlias = Sphere | CircleObstacle | Capsule | HalfSpace | Box
_Place: TypeAlias = tuple[str, int]


def encoded(obstacles: Sequence[Obstacle], argument: str = "obstacles") -> FloatArray:
    """Return obstacles as the compiled distances read them, shape (n, 16).

    A row holds the kind; then of a sphere and circle center and radius, of a capsule start, end
    and radius, of a half-space unit normal and offset, of a box center, half lengths and axes
    (the columns of its rotation, one after the other). Lengths in m, in base axes.

    Args:
        obstacles: The obstacles.
        argument: Name of the argument in errors.

    Raises:
        InvalidOption: A value is not finite, a radius negative, a size or normal zero.
    """
    rows = np.zeros((len(obstacles), WIDTH))
    for index, obstacle in enumerate(obstacles):
        _fill(rows[index], obstacle, (argument, index))
    return rows


def _fill(row: FloatArray, obstacle: Obstacle, where: _Place) -> None:
    if isinstance(obstacle, Sphere):
        row[0], row[1:4] = SPHERE, _vector(obstacle.center, "center", where)
        row[4] = _length(obstacle.radius, "radius", where)
    elif isinstance(obstacle, CircleObstacle):
        row[0] = CIRCLE
        flat = 2 if len(obstacle.center) < 3 else 3
        row[1 : 1 + flat] = _vector(obstacle.center, "center", where, flat, say("2 or 3"))
        row[4] = _length(obstacle.radius, "radius", where)
    elif isinstance(obstacle, Capsule):
        row[0], row[1:4] = CAPSULE, _vector(obstacle.start, "start", where)
        row[4:7] = _vector(obstacle.end, "end", where)
        row[7] = _length(obstacle.radius, "radius", where)
    elif isinstance(obstacle, HalfSpace):
        normal = _vector(obstacle.normal, "normal", where)
        length = np.linalg.norm(normal)
        if not length > 1e-9:
            raise InvalidOption(
                say("the normal is zero; give a direction"),
                argument=where[0],
                index=(where[1], "normal"),
            )
        row[0], row[1:4] = HALF_SPACE, normal / length
        row[4] = _vector([obstacle.offset], "offset", where, 1)[0]
    else:
        row[0], row[1:4] = BOX, _vector(obstacle.center, "center", where)
        size = _vector(obstacle.size, "size", where)
        if not size.min() > 0:
            raise InvalidOption(
                say("the size has a value that is not positive; give lengths of edges"),
                value=float(size.min()),
                lower=0.0,
                argument=where[0],
                index=(where[1], "size"),
            )
        row[4:7] = size / 2
        R = np.eye(3) if obstacle.rotation is None else obstacle.rotation
        row[7:16] = R.T.reshape(9)


def _vector(
    values: Sequence[float], name: str, where: _Place, size: int = 3, sizes: str = ""
) -> FloatArray:
    if len(values) != size:
        raise InvalidOption(
            say(
                "{name} has {count} values; give {sizes}",
                name=name,
                count=len(values),
                sizes=sizes or size,
            ),
            argument=where[0],
            index=(where[1], name),
        )
    if not all(-MAX_VALUE <= value <= MAX_VALUE for value in values):
        raise InvalidOption(
            say("{name} has a value that is not finite or beyond ±1e6", name=name),
            lower=-MAX_VALUE,
            upper=MAX_VALUE,
            argument=where[0],
            index=(where[1], name),
        )
    return np.array(values, dtype=np.float64)


def _length(value: float, name: str, where: _Place) -> float:
    if value not in RADIUS:
        argument, number = where
        raise RADIUS.refusal(
            say("{name} is {value:g}; give 0 to 1e6", name=name, value=value),
            value,
            argument,
            (number, name),
        )
    return value
