"""Fields of requests about arms with many solutions: swivel angle, whole turns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any, TypeAlias

from app.fields import texts
from app.fields.bounds import within
from app.fields.field import Field, Parameter, Reading, declared
from app.fields.names import one_of
from app.http.problems import INVALID_REQUEST, RequestProblem
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.bounds import MAX_VALUE


class Windings(StrEnum):
    """Which whole turns of joints are listed."""

    NEAREST = "nearest"
    ALL = "all"


@dataclass(frozen=True)
class OneAngle(Field):
    """One angle, in the unit of the request."""

    def resolve(self, value: Any, location: Location, reading: Reading) -> float | None:
        """Return the angle, rad; None where it is left out."""
        if value is None:
            return None
        name = ".".join(map(str, location))
        reading.doubts.angles([value], name)
        return math.radians(value) if reading.units.degrees else float(value)


@dataclass(frozen=True)
class WindingsName(Field):
    """A name of :class:`Windings`."""

    def resolve(self, value: Any, location: Location, reading: Reading) -> Windings:
        """Return which are listed.

        Raises:
            RequestProblem: There is no such name.
        """
        del reading
        if value not in tuple(Windings):
            message = say(
                "windings is {value}; give {choice}",
                value=quoted(value),
                choice=", ".join(Windings),
            )
            raise RequestProblem(INVALID_REQUEST, message, f"/{location[-1]}")
        return Windings(value)

    def written(self, default: Any) -> str:
        """Return the name."""
        return str(default)

    @property
    def wire(self) -> Any:
        """A text."""
        return str


SwivelAngle: TypeAlias = Annotated[
    float | None,
    within(-MAX_VALUE, MAX_VALUE),
    declared(
        OneAngle((Parameter(texts.angle, "Swivel angle of a 7R arm, to which to be nearest."),)),
        "Swivel angle that is wished, of an arm with a spherical shoulder and wrist: each branch is"
        " shown there and, where limits forbid it, at the nearest swivel that they allow.",
    ),
]
WindingsChoice: TypeAlias = Annotated[
    Windings,
    declared(
        WindingsName((Parameter(texts.text, "nearest, or all whole turns within the limits."),)),
        "Of joints of more than a turn: nearest (to the seed; default), or all equivalents by whole"
        " turns within the limits, at most 4096.",
        one_of(Windings),
    ),
]
