"""A chain of frames as elementary steps, and the frames' poses as polynomials.

Rotations about parallel axes are added before their cosine is taken, which yields C23 directly.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from kinematics.symbolic.angles import Angle, twelfths
from kinematics.symbolic.names import Names
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial

Vector: TypeAlias = tuple[Polynomial, Polynomial, Polynomial]
Rotation: TypeAlias = tuple[Vector, Vector, Vector]
"""Columns: the axes x, y, z."""

NOWHERE: Vector = (ZERO, ZERO, ZERO)
UNTURNED: Rotation = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))


@dataclass(frozen=True)
class AboutZ:
    """A rotation about z by an angle with joint variables."""

    angle: Angle


@dataclass(frozen=True)
class AboutX:
    """A rotation about x by a constant angle, rad."""

    angle: float


@dataclass(frozen=True)
class Shift:
    """A translation in the frame's own axes."""

    by: Vector


@dataclass(frozen=True)
class Turn:
    """A constant rotation (of a base or a tool)."""

    by: Rotation


Step: TypeAlias = AboutZ | AboutX | Shift | Turn


@dataclass(frozen=True)
class Pose:
    """Pose of a frame as polynomials.

    Attributes:
        axes: Its axes x, y, z as columns.
        origin: Its origin.
    """

    axes: Rotation = UNTURNED
    origin: Vector = NOWHERE

    def matrix(self) -> list[list[Polynomial]]:
        """Return the 4x4 matrix."""
        rows = [[*(axis[i] for axis in self.axes), self.origin[i]] for i in range(3)]
        return [*rows, [ZERO, ZERO, ZERO, ONE]]


def backwards(steps: Iterable[Step]) -> list[Step]:
    """Return the inverse steps."""
    found: list[Step] = []
    for step in steps:
        if isinstance(step, AboutZ):
            found.append(AboutZ(-step.angle))
        elif isinstance(step, AboutX):
            found.append(AboutX(-step.angle))
        elif isinstance(step, Shift):
            found.append(Shift(negated(step.by)))
        else:
            x, y, z = step.by
            found.append(Turn(((x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2]))))
    return found[::-1]


def negated(v: Vector) -> Vector:
    """Return ``-v``."""
    return (-v[0], -v[1], -v[2])


def added(v: Vector, w: Vector) -> Vector:
    """Return ``v + w``."""
    return (v[0] + w[0], v[1] + w[1], v[2] + w[2])


def times(v: Vector, factor: Polynomial) -> Vector:
    """Return ``factor v``."""
    if not factor:
        return NOWHERE
    return (v[0] * factor, v[1] * factor, v[2] * factor)


def cross(v: Vector, w: Vector) -> Vector:
    """Return ``v x w``."""
    return (
        v[1] * w[2] - v[2] * w[1],
        v[2] * w[0] - v[0] * w[2],
        v[0] * w[1] - v[1] * w[0],
    )


def combination(axes: Rotation, v: Vector) -> Vector:
    """Return ``R v``."""
    return added(added(times(axes[0], v[0]), times(axes[1], v[1])), times(axes[2], v[2]))


@dataclass
class Walker:
    """Accumulates steps; ``R = outer Rz(angle) F`` with F the identity or a half turn about x.

    Attributes:
        names: Symbols of the computation.
        outer: Rotation up to the last axis that was not parallel.
        angle: Rotation about it since, rad.
        flipped: Whether z points against that axis.
        origin: The current origin.
    """

    names: Names
    outer: Rotation = UNTURNED
    angle: Angle = field(default_factory=Angle)
    flipped: bool = False
    origin: Vector = NOWHERE

    def go(self, steps: Iterable[Step]) -> Pose:
        """Take steps and return the pose."""
        for step in steps:
            self._take(step)
        return Pose(self._axes(), self.origin)

    def _take(self, step: Step) -> None:
        if isinstance(step, AboutZ):
            self.angle += -step.angle if self.flipped else step.angle
        elif isinstance(step, AboutX):
            self._about_x(step.angle)
        elif isinstance(step, Shift):
            self.origin = added(self.origin, self._shifted(step.by))
        else:
            self._close(tuple(combination(self._axes(), axis) for axis in step.by))

    def _about_x(self, angle: float) -> None:
        steps = twelfths(angle)
        if steps == 0:
            return
        if steps == 12:
            self.flipped = not self.flipped
            return
        x, y, z = self._axes()
        cosine, sine = self.names.cos_sin(Angle((), angle))
        self._close(
            (x, added(times(y, cosine), times(z, sine)), added(times(z, cosine), times(y, -sine)))
        )

    def _close(self, axes: Sequence[Vector]) -> None:
        self.outer, self.angle, self.flipped = (axes[0], axes[1], axes[2]), Angle(), False

    def _shifted(self, by: Vector) -> Vector:
        if not by[0] and not by[1]:
            along = times(self.outer[2], by[2])
            return negated(along) if self.flipped else along
        return combination(self._axes(), by)

    def _axes(self) -> Rotation:
        cosine, sine = self.names.cos_sin(self.angle)
        x, y, z = self.outer
        turned_x = added(times(x, cosine), times(y, sine))
        turned_y = added(times(y, cosine), times(x, -sine))
        if self.flipped:
            return turned_x, negated(turned_y), negated(z)
        return turned_x, turned_y, z


def about_z(angle: float, joint: int | None = None, sign: int = 1) -> list[Step]:
    """Return the rotation about z by ``sign q + angle``; nothing for a constant 0."""
    if joint is None and twelfths(angle) == 0:
        return []
    return [AboutZ(Angle(((joint, sign),) if joint else (), math.remainder(angle, 2 * math.pi)))]


def along(x: Polynomial = ZERO, z: Polynomial = ZERO) -> list[Step]:
    """Return the translation along x and z; nothing for 0."""
    return [Shift((x, ZERO, z))] if x or z else []
