"""Arms of one and two joints: each task solved or refused, whatever its rows are to the joints."""

from __future__ import annotations

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.forward import fk
from kinematics.inverse import IKOptions, solve_ik
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.forbidden import Forbids
from kinematics.inverse.unreached import why_unreached
from kinematics.task import TASKS, task_from
from robots.robot import robot_from_table
from robots.shipped import shipped_robot

LONGER = IKOptions(time_budget=0.6)
OPTIONS = IKOptions(time_budget=0.1)


def joint(kind, **numbers):
    lower = -2.5 if kind == "R" else 0.0
    fixed = {"d" if kind == "R" else "theta": 0.0}
    limits = {"lower": lower, "upper": lower + (5.0 if kind == "R" else 1.0)}
    return {"type": kind, "a": 0.0, "alpha": 0.0, **fixed, **numbers, "limits": limits}


ARMS = {
    "1R": [joint("R", a=1.0)],
    "1R_on_its_axis": [joint("R")],
    "1P": [joint("P")],
    "1P_tilted": [joint("P", alpha=0.6, theta=0.3, a=0.2)],
    "2R": [joint("R", a=1.0), joint("R", a=0.7)],
    "2R_skew": [joint("R", a=0.3, alpha=1.1, d=0.1), joint("R", a=0.4, d=0.2)],
    "RP": [joint("R", a=0.4, alpha=np.pi / 2), joint("P", a=0.3)],
    "PP": [joint("P", alpha=np.pi / 2), joint("P")],
    "PR": [joint("P", alpha=0.4), joint("R", a=0.5)],
}
MASKS = ([1, 0, 1, 0, 0, 1], [0, 1, 0, 0, 0, 0], [1, 0, 0, 1, 0, 0], [0, 0, 1, 1, 1, 0])
EVERY = {**TASKS, **{str(mask): task_from(mask) for mask in MASKS}}


def arm(name):
    rows = [{**row, "name": f"j{k}"} for k, row in enumerate(ARMS[name])]
    return robot_from_table(read_mapping({"name": name, "convention": "standard", "joints": rows}))


def tool(robot, q):
    return fk(robot, q)[robot.tip_frame]


def agrees(why):
    """Check that nothing that is reached misses less than is told to be missed."""
    for one in why.reachable if why.forbidden else ():
        position, angle = why.forbidden.position_miss, why.forbidden.orientation_miss
        if why.forbidden.by is Forbids.POSITION:
            assert position <= one.position_error
        if angle is not None and one.position_error < 1e-6:
            assert angle <= one.orientation_error


@pytest.mark.parametrize("name", ARMS)
def test_targets_within_and_out_of_reach_are_told(name):
    robot = arm(name)
    near = tool(robot, np.full(robot.dof, 0.4))
    far, turned = near.copy(), near.copy()
    far[:3, 3] = 0.0, 0.0, 2.5
    turned[:3, :3] = turned[:3, :3] @ [[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]
    for target in (near, far, turned, tool(robot, np.zeros(robot.dof))):
        for task in EVERY.values():
            found = all_solutions(robot, target, task=task, options=OPTIONS)
            for one in found.solutions:
                assert max(one.position_error, one.orientation_error) < 1e-8
            if not any(one.within_limits for one in found.solutions):
                why = why_unreached(robot, target, task=task, options=LONGER, found=found)
                agrees(why)
                if found.complete:
                    own = solve_ik(robot, target, task=task, options=OPTIONS)
                    assert own.status.value != "converged"


def test_a_slide_that_is_too_short_is_proved_too_short():
    robot, target = arm("1P"), np.eye(4)
    target[2, 3] = 2.5
    result = solve_ik(robot, target, task=TASKS["z"])
    why = why_unreached(robot, target, task=TASKS["z"], options=OPTIONS)
    assert result.status.value == "unreachable"
    assert why.forbidden.proven


@pytest.mark.parametrize(
    ("name", "task"),
    [
        *(
            (name, task)
            for name in ("1R", "1R_on_its_axis", "2R")
            for task in ("xy_phi", "xyz_phi")
        ),
        *((name, "xyz_phi") for name in ("1P", "1P_tilted", "PP", "RP")),
    ],
)
def test_an_angle_with_more_rows_than_joints_is_reached(name, task):
    robot = arm(name)
    for q in (np.full(robot.dof, 0.3), np.linspace(0.9, 0.2, robot.dof), np.zeros(robot.dof)):
        found = all_solutions(robot, tool(robot, q), task=TASKS[task])
        assert found.complete
        assert [one.q for one in found.solutions] == [pytest.approx(q, abs=1e-7)]


@pytest.mark.parametrize("name", ["RP", "PR", "2R_skew"])
def test_an_angle_of_joints_about_other_axes_is_reached(name):
    robot, q = arm(name), np.array([0.5, 0.3])
    found = all_solutions(robot, tool(robot, q), task=TASKS["xyz_phi"])
    assert any(np.abs(one.q - q).max() < 1e-6 for one in found.solutions)


def test_an_angle_is_that_of_a_target_that_is_tilted():
    robot, q = shipped_robot("planar_2r"), np.array([0.5, 0.3])
    target = tool(robot, q)
    c, s = np.cos(0.7), np.sin(0.7)
    target[:3, :3] = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ target[:3, :3]
    (own,) = all_solutions(robot, target, task=task_from([0, 0, 0, 0, 0, 1])).solutions[:1]
    angle = own.q.sum()
    both = np.array([0.5, angle - 0.5])
    target[:3, 3] = tool(robot, both)[:3, 3]
    found = all_solutions(robot, target, task=TASKS["xy_phi"])
    assert found.complete
    assert [one.q for one in found.solutions] == [pytest.approx(both, abs=1e-8)]
    target[0, 3] -= 0.01
    missed = all_solutions(robot, target, task=TASKS["xy_phi"])
    assert (missed.complete, missed.solutions) == (True, ())
