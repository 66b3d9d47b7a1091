"""Joint values as callers give them: conversion to arrays, and checks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dh_to_urdf.errors import Location
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
            f"{argument} is no array of numbers; give one number a joint, or a list of such lists"
            " of equal length",
            argument=argument,
            index=index,
            expected=robot.dof,
        ) from None
    if array.ndim not in (1, 2):
        raise WrongConfiguration(
            f"{argument} has {array.ndim} dimensions; give one q or a list of q",
            argument=argument,
            index=index,
            expected=robot.dof,
        )
    if array.shape[-1] != robot.dof:
        names = ", ".join(joint.name for joint in robot.joints[:12])
        raise WrongConfiguration(
            f"{argument} has {array.shape[-1]} values, but the robot has {robot.dof} joints"
            f" ({names}{', …' if robot.dof > 12 else ''}); give one value a joint",
            argument=argument,
            index=index,
            expected=robot.dof,
            known=tuple(joint_names(robot)),
        )
    if not _is_bounded(array):
        first = tuple(int(i) for i in np.argwhere(~(np.abs(array) <= MAX_VALUE))[0])
        joint = robot.joints[first[-1]].name
        value = array[first]
        what = "not a finite number" if not np.isfinite(value) else f"{value:g}, beyond ±1e6"
        raise WrongConfiguration(
            f"{argument} of joint {joint} is {what}; give a finite value",
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


def configuration_by_name(
    robot: Robot, values: Mapping[str, float], argument: str = "q"
) -> FloatArray:
    """Return q from values by joint name, in the order of ``robot.joints``.

    Args:
        robot: The robot.
        values: A value for every joint, rad or m.
        argument: Name of the argument in errors.

    Returns:
        Shape (dof,).

    Raises:
        WrongConfiguration: A joint is missing or unknown, or a value is not finite.
    """
    names = tuple(joint.name for joint in robot.joints)
    for name in values:
        if name not in names:
            raise WrongConfiguration(
                f"there is no joint {name[:64]!r}; {hint(name, names)}",
                argument=argument,
                index=(name,),
                value=name,
                known=names,
            )
    missing = [name for name in names if name not in values]
    if missing:
        shown = ", ".join(missing[:12])
        raise WrongConfiguration(
            f"{argument} lacks the joint(s) {shown}; give all of them",
            argument=argument,
            missing=tuple(missing),
            known=names,
        )
    return configuration(robot, [values[name] for name in names], argument)


def joint_names(robot: Robot) -> Sequence[str]:
    """Return the joint names in the order of q."""
    return [joint.name for joint in robot.joints]
