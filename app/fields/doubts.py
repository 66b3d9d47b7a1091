"""Values of a request that are read as they stand and are probably meant otherwise."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from app.http.units import Units
from dh_to_urdf.cells.doubts import (
    TURN,
    Doubts,
    Kind,
    Remedies,
    as_radians,
    in_turns,
    is_like_degrees,
    is_like_radians,
)
from dh_to_urdf.messages import say
from robots.robot import FloatArray, Robot

IN_REQUEST = Remedies(
    say("then angle=deg"),
    say("then leave angle=deg out"),
    say("then length=mm"),
    say("then leave length=mm out"),
)
TOUCH = 1e-9
"""Excess of a limit, rad or m, that is rounding."""
TURNS = 3
"""Turns of a joint without limits that nobody wonders at, unless the value has few digits."""
FAR, FAR_THING = 10.0, 100.0
"""Distances of targets and of other things, relative to the robot's span, that look like mm."""
FARTHEST = 1e9
"""Coordinates beyond this, m, are taken as this, so that no square overflows."""
ROUNDED = 1e-7
"""Difference of a matrix from the nearest rotation that is worth a word."""
TRAVELS = 20.0
"""A slide beyond so many times its travel looks like millimetres."""
NEAR = 1e-3
"""Distances of targets in mm, relative to the robot's span, that look like m."""
SLIDE = 50.0
"""A slide beyond this, m, looks like millimetres."""


class RequestDoubts:
    """Collects what is doubtful in one request, while its values are read.

    Args:
        robot: The robot of the request.
        units: Its units.
        told: What the reading of the robot's own document found, for the answer.
    """

    __slots__ = ("_found", "_outside", "robot", "told", "units")

    def __init__(self, robot: Robot, units: Units, told: Sequence[str] = ()) -> None:
        self.robot, self.units, self.told = robot, units, told
        self._found: Doubts | None = None
        self._outside: list[str] = []

    def about(self, robot: Robot) -> None:
        """Go on with a robot as the request has it installed, and tell its own doubts too."""
        self.told = (*self.told, *(one for one in robot.doubts if one not in self.robot.doubts))
        self.robot = robot

    @property
    def warnings(self) -> list[str]:
        """Warnings for the answer, the gravest first."""
        own = () if self._found is None else self._found.sentences()
        return [*own, *self.told, *self._outside]

    def configuration(self, given: FloatArray, q: FloatArray, name: str) -> None:
        """Look at joint values.

        Args:
            given: As the request has them, shape (dof,) or (n, dof).
            q: The same in rad and m.
            name: The field.
        """
        lower, upper = self.robot.expected
        if q.ndim == 1:
            values = q.tolist()
            for low, value, high in zip(lower, values, upper, strict=True):
                if not low <= value <= high:
                    self._look(np.array([values]), name)
                    break
            if self.units.degrees:
                self._digits(given.tolist(), name)
        elif not bool(((q >= lower) & (q <= upper)).all()):
            self._look(q, name)
        elif self.units.degrees and len(given):
            self._digits(given[0].tolist(), name)

    def angles(self, values: Iterable[float], what: str) -> None:
        """Look at angles in the unit of the request, such as those of a target."""
        for value in values:
            if self.units.degrees:
                if is_like_radians(value):
                    self._add(
                        Kind.RADIANS, say("{what} is {value}", what=what, value=as_radians(value))
                    )
            elif is_like_degrees(value):
                self._add(Kind.DEGREES, say("{what} has {value}", what=what, value=in_turns(value)))

    def place(
        self, points: FloatArray, what: str, far: float = FAR, *, may_be_near: bool = True
    ) -> None:
        """Look at places in the axes of the robot's base, m.

        Args:
            points: Shape (3,) or (n, 3).
            what: What they are of.
            far: Distance, relative to the robot's span, beyond which they look like mm.
            may_be_near: Whether they may be within a thousandth of it.
        """
        most = far * self.robot.span
        if not 0.0 < most < math.inf:
            return
        if points.ndim == 1:
            distance = math.hypot(*points.tolist())
        else:
            near = np.minimum(np.abs(points), FARTHEST)
            distance = float(np.sqrt(np.square(near).sum(axis=-1)).max(initial=0.0))
        span = self.robot.span
        if self.units.millimetres and not may_be_near and 0.0 < distance < NEAR * span:
            reach = say("the robot spans {span:.3g} mm", span=1000 * span)
            self._add(
                Kind.METRES,
                say(
                    "{what} is {distance:.4g} mm away, and {reach}",
                    what=what,
                    distance=1000 * distance,
                    reach=reach,
                ),
            )
        if distance > most and not self.units.millimetres:
            reach = say("the robot spans {span:.3g} m", span=self.robot.span)
            self._add(
                Kind.MILLIMETRES,
                say(
                    "{what} is {distance:.4g} m away, and {reach}",
                    what=what,
                    distance=distance,
                    reach=reach,
                ),
            )

    def mended(self, distance: float, what: str) -> None:
        """Tell that a matrix was no rotation, but this far from the one that was taken."""
        if distance > ROUNDED:
            self._outside.append(
                say(
                    "{what} was taken as the nearest rotation, from which it differs by"
                    " {distance:.2g} at most, as it is when few decimals are printed",
                    what=what,
                    distance=distance,
                )
            )

    def _add(self, kind: Kind, text: str) -> None:
        if self._found is None:
            self._found = Doubts(IN_REQUEST)
        self._found.add(kind, text)

    def _digits(self, given: Sequence[float], name: str) -> None:
        """Look for digits of rad among joint values that were read in degrees."""
        for joint, value in zip(self.robot.joints, given, strict=True):
            if is_like_radians(value) and joint.type.is_revolute:
                self._add(
                    Kind.RADIANS,
                    say(
                        "{name} of joint {joint} is {value}",
                        name=name,
                        joint=joint.name,
                        value=as_radians(value),
                    ),
                )

    def _look(self, q: FloatArray, name: str) -> None:
        """Look at rows of which one at least holds an unexpected value, rad and m."""
        lower, upper = self.robot.lower, self.robot.upper
        first, count = "", 0
        for k, joint in enumerate(self.robot.joints):
            column, place = q[:, k], say("{name} of joint {joint}", name=name, joint=joint.name)
            outside = (column < lower[k] - TOUCH) | (column > upper[k] + TOUCH)
            odd = outside if np.isfinite(upper[k] - lower[k]) else np.abs(column) > TURN
            values = column[odd]
            if not values.size:
                continue
            worst = float(values[int(np.argmax(np.abs(values)))])
            if joint.type.is_revolute:
                if not self.units.degrees and _is_degrees(worst, bool(outside.any())):
                    self._add(
                        Kind.DEGREES, say("{place} is {worst}", place=place, worst=in_turns(worst))
                    )
                    continue
            elif not self.units.millimetres and _is_millimetres(
                worst, float(lower[k]), float(upper[k])
            ):
                self._add(Kind.MILLIMETRES, say("{place} is {worst:g} m", place=place, worst=worst))
                continue
            if outside.any():
                count += int(outside.sum())
                first = first or self._beyond(k, column, outside, place, len(q))
        if count:
            more = say(" (and {count} more values outside)", count=count - 1) if count > 1 else ""
            self._outside.append(
                say("{first}{more}; the robot cannot be there", first=first, more=more)
            )

    def _beyond(
        self, k: int, column: FloatArray, outside: FloatArray, place: str, rows: int
    ) -> str:
        """Name a value outside the limits, in the units of the request."""
        turns = self.robot.is_revolute[k]
        row = int(np.argmax(outside))
        numbers = np.array([column[row], self.robot.lower[k], self.robot.upper[k]])
        out = self.units.angles_out if turns else self.units.lengths_out
        value, low, high = out(numbers)
        unit = self.units.named["angle" if turns else "length"]
        where = say(" in row {row}", row=row) if rows > 1 else ""
        return say(
            "{place} is {value:.6g} {unit}{where}, outside its limits {low:.6g} to {high:.6g}",
            place=place,
            value=value,
            unit=unit,
            where=where,
            low=low,
            high=high,
        )


def _is_degrees(angle: float, outside: bool) -> bool:
    """Return whether a joint value, rad, looks like one in degrees."""
    if not is_like_degrees(angle):
        return False
    short = abs(angle * 10 - round(angle * 10)) < 1e-9
    return outside or short or abs(angle) > TURNS * TURN


def _is_millimetres(length: float, lower: float, upper: float) -> bool:
    """Return whether the value of a slide, m, looks like one in mm."""
    within = lower <= length / 1000 <= upper
    return within and abs(length) > (
        TRAVELS * (upper - lower) if upper - lower < math.inf else SLIDE
    )
