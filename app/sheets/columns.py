"""Columns that several tables have: joints, positions, orientations, errors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.http.units import Units
from app.sheets.headings import Heading, numbered
from app.sheets.sheet import Column
from kinematics.configuration import joint_names, joint_values_of
from kinematics.orientation import EulerAngles, is_locked, quaternion_xyzw, rpy
from kinematics.orientation_formats import FORMATS
from robots.robot import FloatArray, Robot

AXES = ("x", "y", "z")


def samples(count: int, rows_each: int = 1) -> Column:
    """Return the numbers of samples from 0, each ``rows_each`` times."""
    return Column(Heading.SAMPLE, np.repeat(np.arange(count), rows_each))


def joints(
    robot: Robot,
    q: FloatArray,
    units: Units,
    heading: Heading = Heading.Q,
    rate: str = "",
) -> list[Column]:
    """Return a column a joint.

    Args:
        robot: The robot.
        q: Values, or their rates, shape (n, dof), rad and m.
        units: Those of the answer.
        heading: What is before the names of the joints.
        rate: Ending of their units: ``/s`` of speeds.
    """
    shown = units.joints_out(robot, q)
    named = zip(joint_names(robot), joint_units(robot, units), strict=True)
    return [
        Column(numbered(heading, name), shown[:, k], f"{unit}{rate}")
        for k, (name, unit) in enumerate(named)
    ]


def joint_units(robot: Robot, units: Units) -> list[str]:
    """Return the unit of each entry of q."""
    angle = units.named["angle"]
    return [angle if turns else units.length for turns in robot.is_revolute.tolist()]


def joint_values(robot: Robot, q: FloatArray, units: Units) -> list[Column]:
    """Return a column for each joint of a robot whose joints depend on others; else none."""
    if robot.coupled is None:
        return []
    found = joint_values_of(robot, q)
    columns = []
    for joint in robot.moving:
        values, turns = np.atleast_1d(found[joint.name]), joint.type.is_revolute
        shown = units.angles_out(values) if turns else units.lengths_out(values)
        unit = units.named["angle"] if turns else units.length
        columns.append(Column(numbered(Heading.JOINT_VALUE, joint.name), shown, unit))
    return columns


def position(p: FloatArray, units: Units) -> list[Column]:
    """Return x, y and z of points, shape (n, 3), m."""
    shown = units.lengths_out(p)
    names = (Heading.X, Heading.Y, Heading.Z)
    return [Column(name, shown[:, k], units.length) for k, name in enumerate(names)]


def orientation(R: FloatArray, units: Units) -> list[Column]:
    """Return rotations, shape (n, 3, 3), as entries, quaternions and roll, pitch, yaw."""
    angle = units.named["angle"]
    quaternions, turns = quaternion_xyzw(R), units.angles_out(rpy(R))
    return [
        *(
            Column(numbered(Heading.ROTATION, f"{i + 1}{j + 1}"), R[:, i, j])
            for i in range(3)
            for j in range(3)
        ),
        *(
            Column(numbered(Heading.QUATERNION, letter), quaternions[:, k])
            for k, letter in enumerate("xyzw")
        ),
        *(
            Column(name, turns[:, k], angle)
            for k, name in enumerate((Heading.ROLL, Heading.PITCH, Heading.YAW))
        ),
        Column(Heading.RPY_DEGENERATE, is_locked(R)),
    ]


def written(R: FloatArray, units: Units) -> list[Column]:
    """Return rotations, shape (n, 3, 3), as ``?orientation=`` asks; none where it does not."""
    if not units.orientation:
        return []
    found = FORMATS[units.orientation]
    values = units.angles_out(found.values(R)) if found.is_angular else found.values(R)
    unit = units.named["angle"] if found.is_angular else ""
    return [
        Column(numbered(Heading.ORIENTATION, found.name, k + 1), values[:, k], unit)
        for k in range(found.size)
    ]


def euler(angles: EulerAngles, sequence: str, units: Units) -> list[Column]:
    """Return both triples of an Euler sequence, of rotations of shape (n, 3, 3)."""
    shown = units.angles_out(angles.solutions)
    return [
        *(
            Column(
                numbered(Heading.EULER, sequence, solution + 1, k + 1),
                shown[:, solution, k],
                units.named["angle"],
            )
            for solution in range(2)
            for k in range(3)
        ),
        Column(Heading.EULER_DEGENERATE, angles.degenerate),
    ]


def errors(position_error: FloatArray, orientation_error: FloatArray, units: Units) -> list[Column]:
    """Return errors of position, m, and of orientation, rad, shape (n,)."""
    return [
        Column(Heading.POSITION_ERROR, units.lengths_out(position_error), units.length),
        Column(Heading.ORIENTATION_ERROR, orientation_error, "rad"),
    ]


def words(heading: Heading, lists: Sequence[Sequence[str]]) -> Column:
    """Return a column of lists of words."""
    return Column(heading, [" ".join(one) for one in lists])
