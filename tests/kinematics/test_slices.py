"""Slices change no bit of a result, and cover each row once."""

import numpy as np
import pytest

from kinematics import slices
from kinematics.manipulability_map import manipulability_map
from kinematics.task import POSE
from kinematics.workspace import workspace
from robots.shipped import shipped_robot

ROBOT = shipped_robot("panda")
Q = np.random.default_rng(0).uniform(-1, 1, ROBOT.dof)


def over_two_joints():
    names = [joint.name for joint in ROBOT.joints]
    found = manipulability_map(ROBOT, Q, (names[1], names[3]), 37, POSE)
    return found.manipulability, found.inverse_condition


COMPUTED = {
    "map": over_two_joints,
    "cloud": lambda: (workspace(ROBOT, 1001).points,),
}


@pytest.mark.parametrize("name", COMPUTED)
def test_the_size_of_a_slice_changes_no_bit(name, monkeypatch):
    monkeypatch.setattr(slices, "NUMBERS", 10**9)
    whole = COMPUTED[name]()
    monkeypatch.setattr(slices, "NUMBERS", 999)
    for one, other in zip(whole, COMPUTED[name](), strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(("rows", "numbers"), [(0, 1), (1, 10**9), (10, 1), (10, 300_000)])
def test_every_row_is_in_one_slice(rows, numbers):
    covered = [k for part in slices.slices(rows, numbers) for k in range(part.start, part.stop)]
    assert covered == list(range(rows))
