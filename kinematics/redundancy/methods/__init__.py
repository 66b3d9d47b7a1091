"""The methods by name, each with the same interface."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TypeAlias

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.errors import InvalidOption
from kinematics.redundancy.methods import (
    damped,
    null_space,
    pseudo_inverse,
    qp,
    sqp,
    task_priority,
    whole_path,
)
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.redundancy.stop import Stop
from robots.errors import hint
from robots.robot import FloatArray

Following: TypeAlias = Generator[int, None, Stop | None]


@dataclass(frozen=True)
class Method:
    """A way to follow a path.

    Attributes:
        name: Its name.
        follow: Fills joint values, shape (N, K), whose row 0 is given, sample by sample; gives
            how many are done, every now and then, and at last why it stopped before the end.
        constrained: Whether it keeps limits and clearance, as far as it can.
    """

    name: str
    follow: Callable[[PathProblem, PathOptions, FloatArray], Following]
    constrained: bool = False


METHODS = {
    method.name: method
    for method in (
        Method("pseudo_inverse", pseudo_inverse.follow),
        Method("damped", damped.follow),
        Method("null_space", null_space.follow),
        Method("task_priority", task_priority.follow),
        Method("sqp", sqp.follow, constrained=True),
        Method("qp", qp.follow, constrained=True),
        Method("whole_path", whole_path.follow, constrained=True),
    )
}


def method_from(name: str, argument: str = "method", index: Location = ()) -> Method:
    """Return a method by name.

    Raises:
        InvalidOption: There is no such method.
    """
    if name not in METHODS:
        raise InvalidOption(
            say(
                "method {name!r} is unknown; {hint}",
                name=name[:32],
                hint=hint(name, tuple(METHODS)),
            ),
            argument=argument,
            index=index,
            value=name,
            known=tuple(METHODS),
        )
    return METHODS[name]
