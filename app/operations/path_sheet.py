"""A followed path as a table, one row a sample, with what is violated there."""

from __future__ import annotations

import numpy as np

from app.http.units import Units
from app.sheets import columns
from app.sheets.headings import Heading
from app.sheets.sheet import Column, Sheet
from kinematics.forward import fk
from kinematics.redundancy.follow import PathResult
from kinematics.redundancy.judging.verdict import violated_at
from kinematics.redundancy.measure import manipulability_at
from robots.robot import Robot

OK = "ok"


def path_sheet(robot: Robot, result: PathResult, units: Units) -> Sheet:
    """Return the table of a path, as far as it was computed.

    Args:
        robot: The robot.
        result: The followed path.
        units: Those of the answer.
    """
    problem, measures, q = result.problem, result.measures, result.q
    frame, count = problem.arm.frame, len(result.q)
    tip = fk(robot, q, [frame])[frame][:, :3, 3]
    found = [
        columns.samples(count),
        Column(Heading.TIME, problem.path.t[:count], "s"),
        Column(Heading.PART, problem.path.r[:count]),
        Column(Heading.STATUS, [" ".join(one) or OK for one in violated_at(problem, measures)]),
        *columns.joints(robot, q, units),
        *columns.joint_values(robot, q, units),
        *columns.joints(robot, result.velocity, units, Heading.VELOCITY, "/s"),
        *columns.joints(robot, result.acceleration, units, Heading.ACCELERATION, "/s^2"),
        *columns.position(tip, units),
        *columns.errors(measures.position_error, measures.orientation_error, units),
    ]
    if len(problem.obstacles):
        swept = np.append(measures.swept, np.nan)[:count]
        found += [
            Column(Heading.CLEARANCE, units.lengths_out(measures.clearance), units.length),
            Column(Heading.CLEARANCE_SWEPT, units.lengths_out(swept), units.length),
        ]
    found.append(Column(Heading.MANIPULABILITY, manipulability_at(problem, result.q)))
    return Sheet(tuple(found))
