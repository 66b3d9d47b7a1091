"""Fields with a value for each joint: one number for all, a list, or an object by joint name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.configuration import joint_names
from kinematics.errors import InvalidOption, dotted
from kinematics.redundancy.arm import Arm
from robots.errors import hint
from robots.robot import FloatArray

PerJoint: TypeAlias = float | list[float] | dict[str, float]


def read_per_joint(
    value: PerJoint,
    arm: Arm,
    lowest: float,
    highest: float,
    argument: str,
    index: Location = (),
) -> FloatArray:
    """The values of all joints of the robot, shape (dof,), as they are given.

    An object may leave out joints that do not belong to the arm, which are not looked at; they
    get the lowest value.

    Raises:
        InvalidOption: A joint is missing or unknown, or a value out of range.
    """
    names = tuple(joint_names(arm.robot))
    field = dotted(argument, index)
    if isinstance(value, dict):
        for name in value:
            if name not in names:
                raise InvalidOption(
                    say(
                        "{field} names joint {name}, which is unknown; {hint}",
                        field=field,
                        name=quoted(name),
                        hint=hint(name, names),
                    ),
                    argument=argument,
                    index=(*index, name),
                    value=name,
                    known=names,
                )
        for name in arm.names:
            if name not in value:
                raise InvalidOption(
                    say("{field} lacks joint {name}; give every joint", field=field, name=name),
                    argument=argument,
                    index=index,
                    known=names,
                )
    elif isinstance(value, list) and len(value) != len(names):
        raise InvalidOption(
            say(
                "{field} has {count} values; give {count_2}, one a joint",
                field=field,
                count=len(value),
                count_2=len(names),
            ),
            argument=argument,
            index=index,
            known=names,
        )
    found = np.full(len(names), lowest)
    for k, one, place in _entries(value, names):
        if not lowest <= one <= highest:
            raise InvalidOption(
                say(
                    "{field} is {one:g} for joint {name}; give {lowest:g} to {highest:g}",
                    field=field,
                    one=one,
                    name=names[k],
                    lowest=lowest,
                    highest=highest,
                ),
                argument=argument,
                index=(*index, *place),
                value=one,
                lower=lowest,
                upper=highest,
            )
        found[k] = one
    return found


def _entries(value: PerJoint, names: tuple[str, ...]) -> Iterator[tuple[int, float, Location]]:
    """Column, value and place of each value that is given."""
    if isinstance(value, dict):
        for name, one in value.items():
            yield names.index(name), one, (name,)
    elif isinstance(value, list):
        for k, one in enumerate(value):
            yield k, one, (k,)
    else:
        for k in range(len(names)):
            yield k, value, ()
