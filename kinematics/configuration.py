"""Joint values as callers give them: conversion to arrays, and checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.bounds import MAX_VALUE
from kinematics.errors import WrongConfiguration
from robots.errors import hint
from robots.robot import FloatArray, Robot


def configuration(
    robot: Robot, q: ArrayLike, argument: str = "q", index: Location = ()
) -> FloatArray:
    """Check one q or a batch and return it as an array.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m, in the order of ``robot.joints``.
        argument: Name of the argument in errors.
        index: Place of q within that argument, for errors.

    Returns:
        A float array of the same shape.

    Raises:
        WrongConfiguration: Wrong shape, not finite, or beyond ±1e6.
    """
    if isinstance(q, list) and len(q) == robot.dof and _are_bounded(q):
        return np.array(q)
    try:
        array = np.asarray(q, dtype=np.float64)
    except (TypeError, ValueError):
        raise WrongConfiguration(
            say(
                "{argument} is no array of numbers; give one number a joint, or a list"
                " of such lists of equal length",
                argument=argument,
            ),
            argument=argument,
            index=index,
            expected=robot.dof,
        ) from None
    if array.ndim not in (1, 2):
        raise WrongConfiguration(
            say(
                "{argument} has {ndim} dimensions; give one q or a list of q",
                argument=argument,
                ndim=array.ndim,
            ),
            argument=argument,
            index=index,
            expected=robot.dof,
        )
    if array.shape[-1] != robot.dof:
        names = ", ".join(joint.name for joint in robot.joints[:12])
        raise WrongConfiguration(
            say(
                "{argument} has {shape} values, but the robot has {dof} joints"
                " ({names}{which}); give one value a joint",
                argument=argument,
                shape=array.shape[-1],
                dof=robot.dof,
                names=names,
                which=", …" if robot.dof > 12 else "",
            ),
            argument=argument,
            index=index,
            expected=robot.dof,
            known=tuple(joint_names(robot)),
        )
    if not _is_bounded(array):
        first = tuple(int(i) for i in np.argwhere(~(np.abs(array) <= MAX_VALUE))[0])
        joint = robot.joints[first[-1]].name
        value = array[first]
        what = (
            say("not a finite number")
            if not np.isfinite(value)
            else say("{value:g}, beyond ±1e6", value=value)
        )
        raise WrongConfiguration(
            say(
                "{argument} of joint {joint} is {what}; give a finite value",
                argument=argument,
                joint=joint,
                what=what,
            ),
            argument=argument,
            index=(*index, *first),
            joint=joint,
            value=float(value),
            lower=-MAX_VALUE,
            upper=MAX_VALUE,
        )
    return array


def _are_bounded(values: list[Any]) -> bool:
    """Return whether all values are floats within ±1e6; NaN is not."""
    for value in values:
        if type(value) is not float or not -MAX_VALUE <= value <= MAX_VALUE:
            return False
    return True


def _is_bounded(array: FloatArray) -> bool:
    """Return whether all entries of an array are within ±1e6."""
    if array.ndim == 1:
        # For a few numbers a loop takes a fifth of the overhead of NumPy.
        return _are_bounded(array.tolist())
    return not array.size or bool(np.abs(array).max() <= MAX_VALUE)


CONSISTENT = 1e-6
"""Largest difference, rad or m, of a follower's value from what it follows."""


class Given(StrEnum):
    """What values by joint name are: where a joint is, how fast it moves, or what moves it."""

    VALUE = "value"
    RATE = "rate"
    EFFORT = "effort"


def configuration_by_name(
    robot: Robot,
    values: Mapping[str, float],
    argument: str = "q",
    *,
    given: Given = Given.VALUE,
    angle: float = 1.0,
) -> FloatArray:
    """Return q from values by joint name, in the order of ``robot.joints``.

    Joints that follow others may be named too, with the value that they have then.

    Args:
        robot: The robot.
        values: A value for every joint, in the unit of angles or m.
        argument: Name of the argument in errors.
        given: What the values are.
        angle: Unit of the angles, rad.

    Returns:
        Shape (dof,), in the unit of the values.

    Raises:
        WrongConfiguration: A joint is missing or unknown, a value is not finite, or that of a
            follower is another than what it follows gives.
    """
    names = tuple(joint.name for joint in robot.joints)
    followers = set[str]()
    if robot.coupled is not None and given is not Given.EFFORT:
        followers = {joint.name for joint in robot.coupled.followers}
    for name in values:
        if name not in names and name not in followers:
            raise WrongConfiguration(
                say("there is no joint {name!r}; {hint}", name=name[:64], hint=hint(name, names)),
                argument=argument,
                index=(name,),
                value=name,
                known=names,
            )
    missing = [name for name in names if name not in values]
    if missing:
        shown = ", ".join(missing[:12])
        raise WrongConfiguration(
            say(
                "{argument} lacks the joint(s) {shown}; give all of them",
                argument=argument,
                shown=shown,
            ),
            argument=argument,
            missing=tuple(missing),
            known=names,
        )
    q = configuration(robot, [values[name] for name in names], argument)
    for name in values:
        if name in followers:
            _check_follower(robot, q, name, values[name], argument, given, angle)
    return q


def _check_follower(
    robot: Robot,
    q: FloatArray,
    name: str,
    value: float,
    argument: str,
    given: Given,
    angle: float,
) -> None:
    """Refuse a value of a follower that is not what the joints that it follows give."""
    coupled = robot.coupled
    assert coupled is not None
    k = next(k for k, joint in enumerate(coupled.joints) if joint.name == name)
    in_si = q * np.where(robot.is_revolute, angle, 1.0)
    expected = float(coupled.matrix[k] @ in_si)
    if given is Given.VALUE:
        expected += float(coupled.map.offset[k])
    unit = angle if coupled.joints[k].type.is_revolute else 1.0
    if abs(value * unit - expected) <= CONSISTENT * max(1.0, abs(expected)):
        return
    relation = coupled.relations[k]
    assert relation.mimic is not None
    raise WrongConfiguration(
        say(
            "{argument} of joint {name} is {value:g}, but it follows {joint}, which"
            " makes it {expected:.9g}; give that, or leave {name} out",
            argument=argument,
            name=name,
            value=value,
            joint=relation.mimic.joint,
            expected=expected / unit,
        ),
        argument=argument,
        index=(name,),
        joint=name,
        value=float(value),
    )


def joint_values_of(robot: Robot, q: FloatArray) -> dict[str, FloatArray]:
    """Return the values of all joints that move by name, at q of shape (dof,) or (n, dof).

    Rad and m; shape () or (n,). Of a coupled joint it is what its geometry turns by.
    """
    values = robot.joint_values(q)
    return {joint.name: values[..., k] for k, joint in enumerate(robot.moving)}


def joint_names(robot: Robot) -> Sequence[str]:
    """Return the joint names in the order of q."""
    return [joint.name for joint in robot.joints]
