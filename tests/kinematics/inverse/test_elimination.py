"""Solutions found at once: those of continuation, which shares no equations with it, and those of
many starts; arms that are special but for rounding are not said to be complete where it matters."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.continuation.real import chain_elimination, chain_fibre, real_solutions
from kinematics.jacobian import jacobian
from kinematics.task import POSE
from tests.kinematics.inverse.test_continuation import ARMS, apart, holds, named_arm, robot_of
from tests.torture.six_joints import compared, random_case


@pytest.mark.parametrize("name", ARMS)
def test_continuation_finds_the_same(name):
    robot, rng = named_arm(name), np.random.default_rng(13)
    chain = chain_of(robot, robot.tip_frame)
    for q in rng.uniform(-3, 3, (5, 6)):
        target = fk(robot, q)[robot.tip_frame]
        at_once = chain_elimination(chain, POSE).solutions(target)
        assert at_once is not None
        assert len(at_once) == 16
        ours = all_solutions(robot, target)
        theirs = real_solutions(chain_fibre(chain, POSE), chain, POSE, target, np.zeros(6))
        assert ours.complete
        assert holds(robot, ours, q)
        assert len(ours.solutions) == len(theirs.solutions)
        for one in theirs.solutions:
            assert holds(robot, ours, one.q)


def test_complex_solutions_are_all_different_and_come_in_pairs():
    robot = named_arm("crx")
    chain = chain_of(robot, robot.tip_frame)
    target = fk(robot, np.array([0.3, -0.7, 1.1, 0.4, -1.3, 2.0]))[robot.tip_frame]
    q = chain_elimination(chain, POSE).solutions(target)
    for k, one in enumerate(q):
        others = [np.abs(np.exp(1j * one) - np.exp(1j * other)).max() for other in q[:k]]
        assert min(others, default=1.0) > 1e-5
        assert min(np.abs(np.exp(1j * one.conj()) - np.exp(1j * z)).max() for z in q) < 1e-6


@pytest.mark.slow
def test_random_arms_have_the_solutions_of_many_starts():
    for number in range(12):
        table, q = random_case(number, 1)
        one = compared(table, q, np.random.default_rng((1, number)))
        assert one.complete
        assert (one.missing, one.false) == (0, 0)


def nearly_parallel():
    """Three axes parallel but for 4e-6 rad, as files have it that write quarter turns short."""
    return robot_of(
        [0, 0.264, 0.236, 0.075, 0, 0],
        [np.pi / 2, 4e-6, -5e-6, np.pi / 2, -np.pi / 2 + 3e-6, 0],
        [0.067, 0, 0, 0.0001, 0, 0.1],
    )


def test_nearly_special_arms_are_not_complete_where_solutions_meet():
    robot, rng, tried = nearly_parallel(), np.random.default_rng(4), 0
    while tried < 4:
        q, way = rng.uniform(-2, 2, 6), rng.normal(size=6)
        ends = [np.linalg.det(jacobian(robot, q + t * way)) for t in (0.0, 1.0)]
        if ends[0] * ends[1] > 0:
            continue
        tried += 1
        t = brentq(
            lambda t, q=q, way=way: np.linalg.det(jacobian(robot, q + t * way)), 0, 1, xtol=1e-15
        )
        q = q + t * way
        found = all_solutions(robot, fk(robot, q)[robot.tip_frame], seed=q)
        assert not found.complete
        assert "there may be others" in found.description
        assert min(apart(robot, one.q, q) for one in found.solutions) < 1e-2
    found = all_solutions(robot, fk(robot, np.array([0.3, 0.8, -1.1, 0.4, 1.0, 0.2]))["tool"])
    assert found.complete
