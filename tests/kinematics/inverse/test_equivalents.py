"""Whole turns within the limits: all of them, counted by hand."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.chain import chain_of
from kinematics.errors import InvalidOption
from kinematics.forward import fk
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.equivalents import with_equivalents
from kinematics.task import TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot
from tests.kinematics.inverse.test_self_motion import robot_of


def listed(robot, q):
    found = all_solutions(robot, fk(robot, q)[robot.tip_frame], seed=q)
    chain = chain_of(robot, robot.tip_frame)
    return found, with_equivalents(robot, chain, found)


def test_five_joints_of_two_turns_have_32_of_each():
    robot, q = shipped_robot("ur5"), np.array([0.3, -1.1, 1.4, 0.5, 1.2, 0.7])
    found, every = listed(robot, q)
    # All but the elbow turn twice.
    np.testing.assert_allclose((robot.upper - robot.lower) / np.pi, [4, 4, 2, 4, 4, 4], atol=1e-6)
    assert len(every.solutions) == 32 * sum(one.within_limits for one in found.solutions)
    rows = np.array([one.q for one in every.solutions])
    assert len(np.unique(rows.round(9), axis=0)) == len(rows)
    for one in every.solutions[::31]:
        assert ((one.q >= robot.lower) & (one.q <= robot.upper)).all()
        np.testing.assert_allclose(
            fk(robot, one.q)[robot.tip_frame], fk(robot, q)[robot.tip_frame], atol=1e-9
        )
    far = [np.linalg.norm(one.q - every.seed) for one in every.solutions]
    assert all(a <= b + 1e-12 for a, b in pairwise(far))
    np.testing.assert_allclose(every.solutions[0].q, q, atol=1e-9)


def test_joints_of_less_than_a_turn_and_without_limits_have_one():
    robot = shipped_robot("puma560")
    found, every = listed(robot, np.array([0.3, -0.4, 0.5, 0.7, 0.6, 0.2]))
    within = sum(one.within_limits for one in every.solutions)
    assert within >= sum(one.within_limits for one in found.solutions)
    q = np.array([0.3, 0.4, 0.5, -0.7, 0.6, 0.8, 0.1])
    endless = robot_of([0.36, 0, 0.42, 0, 0.4, 0, 0.126], [-1, 1, 1, -1, -1, 1, 0])
    found, every = listed(endless, q)
    assert len(every.solutions) == len(found.solutions)


def test_too_many_are_refused_with_their_number():
    joints = [
        {
            "name": f"j{k}",
            "type": "R",
            "a": 0.4,
            "alpha": 0.0,
            "d": 0.0,
            "limits": {"lower": -400.0, "upper": 400.0},
        }
        for k in range(2)
    ]
    table = read_mapping({"name": "turns", "convention": "standard", "joints": joints})
    robot = robot_from_table(table)
    chain = chain_of(robot, robot.tip_frame)
    target = fk(robot, np.array([0.2, 0.9]))[robot.tip_frame]
    found = all_solutions(robot, target, task=TASKS["xy"])
    with pytest.raises(InvalidOption, match="at most 4096") as refusal:
        with_equivalents(robot, chain, found)
    assert refusal.value.argument == "windings"
