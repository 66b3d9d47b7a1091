"""Self-motions of redundant arms: every solution is on a curve, every curve within the limits, ends
exact; the feasible swivel intervals against a fine sweep of the closed form."""

from __future__ import annotations

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.chain import chain_of
from kinematics.errors import InvalidOption
from kinematics.forward import fk
from kinematics.inverse import IKStatus, solve_ik
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.closed_form import closed_form_of, solutions
from kinematics.inverse.self_motion.families import joint_family
from kinematics.inverse.self_motion.parameter import parameter_of, points, slice_values
from kinematics.inverse.self_motion.pieces import Limits
from kinematics.inverse.self_motion.tracing import Motion, is_on, trace
from kinematics.task import POSE, TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot

# KUKA LBR iiwa 14: lengths, m, and quarter turns; narrow ranges about a bent arm.
IIWA = ([0.36, 0, 0.42, 0, 0.4, 0, 0.126], [-1, 1, 1, -1, -1, 1, 0])
# Kinova Gen3, seven joints: its D-H table, base turned over.
GEN3 = ([-0.2848, -0.0118, -0.4208, -0.0128, -0.3143, 0.0, -0.1674], [1, 1, 1, 1, 1, 1, 2])
TIGHT = [(-0.5, 0.5), (0.2, 1.0), (-0.5, 0.5), (-1.6, -0.7), (-0.5, 0.5), (0.3, 1.4), (-0.5, 0.5)]


def robot_of(d, quarters, limits=None, offsets=None):
    joints = []
    for k, (length, quarter) in enumerate(zip(d, quarters, strict=True)):
        row = {"name": f"j{k + 1}", "type": "R", "a": 0.0, "alpha": quarter * np.pi / 2}
        row |= {"d": float(length), "offset": 0.0 if offsets is None else offsets[k]}
        if limits is not None and limits[k] is not None:
            row["limits"] = dict(zip(("lower", "upper"), limits[k], strict=True))
        joints.append(row)
    return robot_from_table(
        read_mapping({"name": "arm", "convention": "standard", "joints": joints})
    )


def gen3():
    bent = [None, (-2.24, 2.24), None, (-2.57, 2.57), None, (-2.09, 2.09), None]
    return robot_of(*GEN3, bent, [0.0, *[np.pi] * 6])


ARMS = {
    "panda": lambda: shipped_robot("panda"),
    "xarm7": lambda: shipped_robot("xarm7"),
    "gen3": gen3,
}


def ranges(robot):
    return np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)


def all_curves(robot, target):
    chain = chain_of(robot, robot.tip_frame)
    joint, fibre = parameter_of(chain, POSE)
    motion = Motion(chain, POSE, target)
    limits = Limits(chain.lower, chain.upper, chain.is_periodic)
    values, curves = slice_values(motion, joint, limits, 0.0), []
    for point in points(motion, joint, fibre, values, (np.zeros(7),)):
        if not any(is_on(motion, curve, point) for curve in curves):
            curves.append(trace(motion, point))
    return motion, curves


@pytest.mark.parametrize("name", ARMS)
def test_every_answer_is_on_a_curve(name):
    """Of the numeric solver, from many starts; and the q that the target was made of."""
    robot, rng = ARMS[name](), np.random.default_rng(5)
    for _ in range(6):
        known = rng.uniform(*ranges(robot))
        target = fk(robot, known)[robot.tip_frame]
        motion, curves = all_curves(robot, target)
        assert all(curve.closed for curve in curves)
        for seed in rng.uniform(*ranges(robot), (12, 7)):
            result = solve_ik(robot, target, seed=seed)
            if result.status is IKStatus.CONVERGED:
                on = motion.settled(result.q)
                assert np.abs(on - result.q).max() < 1e-4
                assert any(is_on(motion, curve, on) for curve in curves)
        assert any(is_on(motion, curve, known) for curve in curves)


@pytest.mark.parametrize("name", [*ARMS, "iiwa"])
def test_curves_are_within_the_limits_to_their_ends(name):
    robot = robot_of(*IIWA, TIGHT) if name == "iiwa" else ARMS[name]()
    rng = np.random.default_rng(8)
    for _ in range(3):
        target = fk(robot, rng.uniform(*ranges(robot)))[robot.tip_frame]
        found = all_solutions(robot, target)
        motion = found.self_motion
        assert motion.dimension == 1
        assert motion.curves
        for curve in motion.curves:
            for q in curve.q:
                np.testing.assert_allclose(fk(robot, q)[robot.tip_frame], target, atol=1e-9)
            periodic = robot.is_periodic & (robot.upper - robot.lower >= 2 * np.pi - 1e-9)
            assert ((curve.q >= robot.lower) | periodic).all()
            assert ((curve.q <= robot.upper) | periodic).all()
            assert (curve.lower <= curve.q.min(axis=0) + 1e-9).all()
            assert (curve.upper >= curve.q.max(axis=0) - 1e-9).all()
            if curve.closed:
                np.testing.assert_allclose(
                    curve.q[-1] - curve.q[0], 2 * np.pi * np.array(curve.turns), atol=1e-7
                )
            for q, ends in zip(curve.q[[0, -1]], curve.ends, strict=False):
                assert ends
                for end in ends:
                    k = [joint.name for joint in robot.joints].index(end.joint)
                    limit = robot.lower[k] if end.limit == "lower" else robot.upper[k]
                    assert q[k] == pytest.approx(limit, abs=1e-9)
        within = [one for one in found.solutions if one.within_limits]
        assert within
        for one in within:
            np.testing.assert_allclose(fk(robot, one.q)[robot.tip_frame], target, atol=1e-9)


def swept(robot, target, codes, swivels):
    """Whether a branch is within the limits at each swivel angle, by the closed form alone."""
    chain = chain_of(robot, robot.tip_frame)
    form = closed_form_of(chain)
    inside = []
    for swivel in swivels:
        found = solutions(form, chain, target, swivel=float((swivel + np.pi) % (2 * np.pi) - np.pi))
        for names, q in zip(found.postures(form), found.q, strict=True):
            if names == codes:
                turned = q + 2 * np.pi * np.round(((robot.lower + robot.upper) / 2 - q) / 2 / np.pi)
                inside.append(bool(((turned >= robot.lower) & (turned <= robot.upper)).all()))
    return np.array(inside)


@pytest.mark.parametrize("limits", [TIGHT, [(-2.9, 2.9)] * 7, [(-1.2, 1.2)] * 7])
def test_swivel_intervals_are_those_of_a_fine_sweep(limits):
    robot, rng = robot_of(*IIWA, limits), np.random.default_rng(3)
    swivels = np.linspace(-np.pi, np.pi, 721)[:-1] + 1e-3
    for _ in range(2):
        target = fk(robot, rng.uniform(robot.lower, robot.upper))[robot.tip_frame]
        motion = all_solutions(robot, target).self_motion
        assert motion.complete
        assert motion.unlimited == 8
        for names in {curve.posture for curve in motion.curves}:
            expected = swept(robot, target, names, swivels)
            told = np.zeros(len(swivels), dtype=bool)
            for curve in motion.curves:
                if curve.posture == names:
                    a, b = curve.parameter[[0, -1]]
                    told |= curve.closed | ((swivels - a) % (2 * np.pi) <= b - a)
            assert (told == expected).all()


def test_a_target_at_the_corner_of_the_limits_has_its_point():
    """Joints on their limits: the interval may have no length."""
    robot, rng = robot_of(*IIWA, TIGHT), np.random.default_rng(4)
    for _ in range(12):
        ends = np.where(rng.random(7) < 0.5, robot.lower, robot.upper)
        target = fk(robot, ends)[robot.tip_frame]
        found = [one for one in all_solutions(robot, target).solutions if one.within_limits]
        assert any(np.abs(one.q - ends).max() < 1e-6 for one in found)


def test_tight_limits_have_a_solution_wherever_the_solver_has_one():
    robot, rng = (
        robot_of(*IIWA, [(q - 0.05, q + 0.1) for q in (0.1, 0.6, -0.3, -1.2, 0.2, 0.9, 1)]),
        0,
    )
    rng = np.random.default_rng(6)
    for _ in range(12):
        target = fk(robot, rng.uniform(robot.lower, robot.upper))[robot.tip_frame]
        assert any(one.within_limits for one in all_solutions(robot, target).solutions)


def test_a_wished_swivel_and_the_nearest_that_limits_allow():
    robot = robot_of(*IIWA, TIGHT)
    target = fk(robot, np.array([0.1, 0.6, -0.2, -1.1, 0.3, 0.8, 0.1]))[robot.tip_frame]
    intervals = all_solutions(robot, target).self_motion.curves
    for wish in (-2.0, 0.0, 0.3, 3.0):
        found = all_solutions(robot, target, swivel=wish)
        within = [one for one in found.solutions if one.within_limits]
        assert within
        for one in found.solutions:
            if not one.within_limits:
                assert one.swivel == pytest.approx(wish)
        for one in within:
            own = [curve for curve in intervals if curve.posture == one.posture]
            gaps = [
                0.0
                if (wish - curve.parameter[0]) % (2 * np.pi) <= np.ptp(curve.parameter[[0, -1]])
                else np.abs((curve.parameter[[0, -1]] - wish + np.pi) % (2 * np.pi) - np.pi).min()
                for curve in own
            ]
            gap = abs((one.swivel - wish + np.pi) % (2 * np.pi) - np.pi)
            assert gap == pytest.approx(min(gaps), abs=1e-8)


def test_a_swivel_is_refused_where_there_is_none():
    with pytest.raises(InvalidOption, match="spherical shoulder"):
        all_solutions(shipped_robot("puma560"), np.eye(4), swivel=0.1)
    with pytest.raises(InvalidOption, match="spherical shoulder"):
        all_solutions(shipped_robot("panda"), np.eye(4), swivel=0.1)


def test_a_stretched_arm_turns_about_its_line():
    robot = robot_of(*IIWA, [(-2.9, 2.9)] * 7)
    target = fk(robot, np.array([0.3, 0.5, 0.2, 0.0, 0.4, -0.6, 0.2]))[robot.tip_frame]
    found = all_solutions(robot, target)
    assert found.self_motion.curves
    assert any(one.within_limits for one in found.solutions)


def test_four_bars_have_the_curves_of_their_mechanism():
    """Three joints in a plane, two rows: the third turns around, or to and fro, by Grashof."""
    joints = [
        {"name": f"j{k}", "type": "R", "a": a, "alpha": 0.0, "d": 0.0}
        for k, a in enumerate((0.3, 1.0, 0.9))
    ]
    table = read_mapping({"name": "bars", "convention": "standard", "joints": joints})
    robot, target = robot_from_table(table), np.eye(4)
    # Ground 0.8, crank 0.3, coupler 1.0, rocker 0.9: 0.3 + 1.0 < 0.8 + 0.9, two closed curves.
    target[0, 3] = 0.8
    motion = all_solutions(robot, target, task=TASKS["xy"]).self_motion
    assert motion.unlimited == 2
    assert all(curve.closed and abs(curve.turns[0]) == 1 for curve in motion.curves)
    # Ground 1.9: 0.3 + 1.9 > 1.0 + 0.9, one closed curve, on which the crank does not go around.
    target[0, 3] = 1.9
    motion = all_solutions(robot, target, task=TASKS["xy"]).self_motion
    assert motion.unlimited == 1
    assert motion.curves[0].closed
    assert motion.curves[0].turns == (0, 0, 0)


def test_a_joint_that_the_task_does_not_see_is_free():
    robot = shipped_robot("puma560")
    q = np.array([0.3, -0.4, 0.5, 0.7, 0.6, 0.2])
    found = all_solutions(
        robot, fk(robot, q)[robot.tip_frame], task=TASKS["position_direction"], seed=q
    )
    assert found.self_motion is None or found.self_motion.dimension == 1
    assert any(np.abs(one.q - q).max() < 1e-6 for one in found.solutions)


def test_two_joints_more_say_so_and_have_the_solvers_answer():
    robot = shipped_robot("planar_8r")
    target = fk(robot, np.full(robot.dof, 0.2))[robot.tip_frame]
    found = all_solutions(robot, target, task=TASKS["xy"])
    assert found.method == "search"
    assert found.self_motion.dimension == 6
    assert found.self_motion.curves == ()
    own = solve_ik(robot, target, task=TASKS["xy"])
    assert any(np.abs(one.q - own.q).max() < 1e-3 for one in found.solutions)


def test_arms_of_another_kind_have_no_curves():
    robot = shipped_robot("ur5")
    chain = chain_of(robot, robot.tip_frame)
    assert joint_family(robot, chain, POSE, np.eye(4), np.zeros(6)) is None
    assert parameter_of(chain, POSE) is None
