"""Singular targets that leave a joint free: the solution shown is within the limits if one is."""

import json

import numpy as np
import pytest
from scipy.optimize import brentq

from dh_to_urdf import read_json
from kinematics.forward import fk
from kinematics.inverse.all_solutions import all_solutions
from robots.robot import robot_from_table

LIMITS = np.deg2rad([[-165, 165], [-110, 110], [-110, 70], [-160, 160], [-120, 120], [-400, 400]])
ROWS = [
    *((0, -90, 0.29, 0), (0.27, 0, 0, -90), (0.07, -90, 0, 0)),
    *((0, 90, 0.302, 0), (0, -90, 0, 0), (0, 0, 0.072, 0)),
]


@pytest.fixture(scope="module")
def robot():
    joints = [
        {
            "name": f"j{k}",
            "type": "R",
            "a": a,
            "alpha": float(np.deg2rad(alpha)),
            "d": d,
            "offset": float(np.deg2rad(offset)),
            "limits": {"lower": float(low), "upper": float(high)},
        }
        for k, ((a, alpha, d, offset), (low, high)) in enumerate(
            zip(ROWS, LIMITS, strict=True), start=1
        )
    ]
    return robot_from_table(
        read_json(json.dumps({"name": "elbow", "convention": "standard", "joints": joints}))
    )


def on_the_first_axis(robot, rng):
    """A q within the limits whose wrist centre is on axis 1."""
    while True:
        q = rng.uniform(*LIMITS.T)

        def away(third, q=q):
            at = np.array([0.0, q[1], third, 0.0, 0.0, 0.0])
            return fk(robot, at, ["frame_4"])["frame_4"][0, 3]

        if away(LIMITS[2, 0]) * away(LIMITS[2, 1]) < 0:
            q[2] = brentq(away, *LIMITS[2], xtol=1e-15)
            return q


def test_the_free_first_joint_is_chosen_within_the_limits(robot):
    rng = np.random.default_rng(2)
    for _ in range(40):
        q = on_the_first_axis(robot, rng)
        target = fk(robot, q)["tool"]
        found = all_solutions(robot, target)
        free = [one for one in found.solutions if one.free]
        assert free, q
        inside = [one for one in free if one.within_limits]
        for one in inside:
            assert np.abs(fk(robot, one.q)["tool"] - target).max() < 1e-9
        near = [one for one in inside if np.allclose(one.q[1:3], q[1:3], atol=1e-6)]
        assert near or widest(robot, q, target) < np.deg2rad(10), q


def widest(robot, q, target):
    """The widest interval of the first joint in which q2 and q3 reach the target within limits."""
    step = np.deg2rad(0.5)
    longest = run = 0
    for first in np.arange(*LIMITS[0], step):
        forearm = fk(robot, np.array([first, q[1], q[2], 0, 0, 0]), ["frame_3"])["frame_3"]
        R = forearm[:3, :3].T @ target[:3, :3]
        # Of z-y-z angles with these twists: R = Rz(q4) Ry(-q5) Rz(q6) up to signs.
        bend, spin = np.arccos(np.clip(R[2, 2], -1, 1)), np.arctan2(R[1, 2], R[0, 2])
        spins = np.array([spin, spin + np.pi])
        spins = (spins + np.pi) % (2 * np.pi) - np.pi
        fits = bend <= LIMITS[4, 1] and (np.abs(spins) <= LIMITS[3, 1]).any()
        run = run + 1 if fits else 0
        longest = max(longest, run)
    return longest * step
