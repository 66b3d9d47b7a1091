"""Whole prints of robots of the Robotics Toolbox for Python 1.5, with its forward kinematics.

``prints/robots.json`` was made by ``print(robot)`` and ``robot.fkine(q)`` of the robots that the
Toolbox ships; the prints round offsets to 3 digits, lengths to 4, tools to 2.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from dh_to_urdf import DHError, dh_matrices, read_pasted

ROBOTS = json.loads((Path(__file__).parent / "prints" / "robots.json").read_text())
IDENTITY = np.eye(4).tolist()
BASED = [robot for robot in ROBOTS if robot["base"] != IDENTITY]
OTHERS = [robot for robot in ROBOTS if robot["base"] == IDENTITY]


def assert_near(table, robot, tolerance):
    for q, T in zip(robot["q"], robot["T"], strict=True):
        assert np.allclose(dh_matrices(table, q).T, T, atol=tolerance)


@pytest.mark.parametrize("robot", OTHERS, ids=lambda robot: robot["name"])
def test_a_whole_print_is_read(robot):
    table = read_pasted(robot["text"], None)
    assert table.convention.value == robot["convention"]
    tool = robot["tool"] != IDENTITY
    assert_near(table, robot, 5e-3 if tool else 1e-4)
    assert any("named configurations" in warning for warning in table.warnings) or (
        "name" not in robot["text"]
    )
    assert any("rounded" in warning for warning in table.warnings) is tool


@pytest.mark.parametrize("robot", BASED, ids=lambda robot: robot["name"])
def test_a_base_that_the_toolbox_leaves_empty_is_asked_for(robot):
    with pytest.raises(DHError, match=r"the base nothing, .*as base = \["):
        read_pasted(robot["text"], None)
    rows = "; ".join(" ".join(map(repr, row)) for row in robot["base"])
    table = read_pasted(f"{robot['text']}\nbase = [{rows}]", None)
    assert_near(table, robot, 1e-4)


def test_another_convention_than_the_print_states_is_refused():
    robot = OTHERS[0]
    other = {"standard": "modified", "modified": "standard"}[robot["convention"]]
    with pytest.raises(DHError, match=f"give convention={robot['convention']}"):
        read_pasted(robot["text"], other)
