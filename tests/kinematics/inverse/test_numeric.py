"""Inverse kinematics: reachable targets are reached, others are told honestly."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import read_mapping
from kinematics.errors import InvalidOption, InvalidTarget
from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, Tolerance, solve_ik
from kinematics.inverse.target import Targets, target_poses
from kinematics.task import POSE, TASKS
from robots.robot import robot_from_table, robot_from_urdf
from robots.shipped import shipped_robot


def reachable(robot, n, seed):
    rng = np.random.default_rng(seed)
    low = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    high = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    return fk(robot, rng.uniform(low, high, (n, robot.dof)))[robot.tip_frame]


def errors(robot, q, target, task=POSE):
    """Measured apart from the solver: norms of the position and rotation errors in the task."""
    T = fk(robot, q)[robot.tip_frame]
    position = np.linalg.norm((T - target)[list(task.positions), 3])
    cosine = (np.trace(T[:3, :3].T @ target[:3, :3]) - 1) / 2
    sine = np.linalg.norm(T[:3, :3] - target[:3, :3]) / np.sqrt(8)
    angle = 2 * np.arcsin(min(1.0, sine)) if cosine > 0 else np.arccos(max(-1.0, cosine))
    return position, angle if task.rotations else 0.0


def within(robot, q):
    return bool(((q >= robot.lower) & (q <= robot.upper)).all())


@pytest.mark.parametrize("name", ["puma560", "ur5", "panda", "pa10", "xarm7"])
def test_reachable_poses_are_reached_within_limits(name):
    robot = shipped_robot(name)
    targets = reachable(robot, 1000, seed=2026)
    solved = 0
    for target in targets:
        result = solve_ik(robot, target)
        if result.status is IKStatus.CONVERGED:
            position, orientation = errors(robot, result.q, target)
            assert position <= 1.01e-6
            assert orientation <= 1.01e-6
            assert within(robot, result.q)
            solved += 1
    assert solved >= 995


@pytest.mark.parametrize(
    ("name", "task"),
    [
        ("planar_2r", "xy"),
        ("planar_3r", "xy_phi"),
        ("planar_8r", "xy"),
        ("scara", "xyz_phi"),
        ("stanford", "pose"),
        ("kinova", "pose"),
        ("iiwa14", "position"),
        ("talos_arm", "pose"),
    ],
)
def test_other_tasks_arms_and_bases(name, task):
    robot, task = shipped_robot(name), TASKS[task]
    for target in reachable(robot, 50, seed=1):
        result = solve_ik(robot, target, task=task)
        assert result.status is IKStatus.CONVERGED
        assert within(robot, result.q)
        assert errors(robot, result.q, target, task)[0] <= 1.01e-6


def test_joints_off_the_chain_stay_at_the_seed():
    robot = shipped_robot("tiago_no_hand")
    seed = np.zeros(robot.dof)
    names = [joint.name for joint in robot.joints]
    seed[names.index("head_1_joint")] = 0.3
    target = fk(robot, np.clip(seed + 0.2, robot.lower, robot.upper))[robot.tip_frame]
    result = solve_ik(robot, target, seed=seed)
    assert result.status is IKStatus.CONVERGED
    assert result.q[names.index("head_1_joint")] == 0.3


def test_any_frame_and_a_base_on_another_branch():
    robot = robot_from_urdf(shipped_robot("baxter").urdf, base="left_wrist", tip="right_gripper")
    rng = np.random.default_rng(3)
    q = rng.uniform(np.maximum(robot.lower, -3), np.minimum(robot.upper, 3))
    target = fk(robot, q)["right_gripper"]
    result = solve_ik(robot, target)
    assert result.status is IKStatus.CONVERGED
    np.testing.assert_allclose(fk(robot, result.q)["right_gripper"], target, atol=1e-5)


def test_too_far_is_proven_unreachable_and_the_best_is_near():
    robot = shipped_robot("planar_2r")
    target = np.eye(4)
    target[:3, 3] = (5, 0, 0)
    result = solve_ik(robot, target, task=TASKS["xy"], seed=np.array([0.4, 0.4]))
    assert result.status is IKStatus.UNREACHABLE
    assert result.position_error == pytest.approx(3.2, abs=1e-3)
    assert within(robot, result.q)


def test_inside_the_hole_is_unreachable_where_a_closed_form_proves_it():
    robot, target = shipped_robot("planar_2r"), np.eye(4)
    target[:3, 3] = (0.1, 0, 0)
    result = solve_ik(robot, target, task=TASKS["xy"])
    assert result.status is IKStatus.UNREACHABLE
    assert result.position_error == pytest.approx(0.1, abs=1e-3)


def test_inside_the_hole_is_not_converged_where_nothing_proves_it():
    lengths = [0.0, 1.0, 0.2]
    rows = [{"type": "R", "alpha": 0, "a": a, "d": 0} for a in lengths]
    table = {"convention": "modified", "tool": {"xyz": [0.2, 0, 0]}, "joints": rows}
    robot, target = robot_from_table(read_mapping(table)), np.eye(4)
    target[:3, 3] = (0.1, 0, 0)
    result = solve_ik(robot, target, task=TASKS["xy"])
    assert result.status is IKStatus.NOT_CONVERGED
    assert result.restarts == 200
    assert result.position_error == pytest.approx(0.5, abs=1e-3)


def test_no_time_is_a_timeout():
    robot = shipped_robot("panda")
    target = reachable(robot, 1, 7)[0]
    result = solve_ik(robot, target, options=IKOptions(time_budget=0.0))
    assert result.status is IKStatus.TIMEOUT
    assert np.isfinite(result.q).all()


def test_the_same_request_gives_the_same_answer():
    robot = shipped_robot("panda")
    for target in reachable(robot, 20, 5):
        first, second = solve_ik(robot, target), solve_ik(robot, target)
        assert (first.q == second.q).all()
        assert first.restarts == second.restarts


def test_a_tight_tolerance_is_met():
    robot = shipped_robot("ur5")
    options = IKOptions(tolerance=Tolerance(1e-10, 1e-10))
    for target in reachable(robot, 20, 5):
        result = solve_ik(robot, target, options=options)
        assert result.status is IKStatus.CONVERGED
        assert max(errors(robot, result.q, target)) < 1e-9


def test_the_answer_is_the_turn_nearest_to_the_seed():
    robot = shipped_robot("ur5")
    seed = np.array([5.5, -1.0, 1.0, -5.5, 1.2, 6.0])
    target = fk(robot, seed + 0.01)["tool"]
    result = solve_ik(robot, target, seed=seed)
    assert result.status is IKStatus.CONVERGED
    np.testing.assert_allclose(result.q, seed + 0.01, atol=1e-4)


@settings(max_examples=200, deadline=None)
@given(
    st.tuples(*[st.floats(-3, 3)] * 3),
    st.tuples(*[st.floats(-4, 4)] * 3),
    st.sampled_from(["puma560", "ur5", "pa10", "scara", "planar_3r", "stanford"]),
    st.sampled_from(sorted(TASKS)),
)
def test_an_answer_is_never_a_lie(position, rpy, name, task):
    robot, task = shipped_robot(name), TASKS[task]
    target = target_poses(Targets(position=[position], rpy=[rpy]), task)[0]
    result = solve_ik(robot, target, task=task, options=IKOptions(max_restarts=2))
    assert within(robot, result.q)
    assert np.isfinite([result.position_error, result.orientation_error]).all()
    reached = result.position_error <= 1e-6 and result.orientation_error <= 1e-6
    assert (result.status is IKStatus.CONVERGED) == reached
    assert errors(robot, result.q, target, task)[0] == pytest.approx(
        result.position_error, abs=1e-9
    )


@pytest.mark.parametrize(
    "options",
    [
        {"max_restarts": -1},
        {"time_budget": -1.0},
        {"random_seed": -5},
        {"max_iterations": 0},
        {"tolerance": Tolerance(0.0, 1e-6)},
        {"tolerance": Tolerance(float("nan"), 1e-6)},
    ],
)
def test_options_out_of_range_are_refused(options):
    with pytest.raises(InvalidOption, match="give"):
        IKOptions(**options)


@pytest.mark.parametrize(
    ("spec", "task", "message"),
    [
        (Targets(), "pose", "position"),
        (Targets(position=[[0, 0, 0]]), "pose", "orientation"),
        (Targets(position=[[0, 0]]), "position", "give 3"),
        (Targets(position=[[0, 0, float("nan")]]), "position", "finite"),
        (Targets(position=[[0, 0, 0]], rpy=[[0, 0, 0]], phi=[1]), "pose", "one orientation"),
        (Targets(matrix=[np.eye(4).tolist()], position=[[0, 0, 0]]), "pose", "one form"),
        (Targets(matrix=[(2 * np.eye(4)).tolist()]), "pose", "0 0 0 1"),
        (Targets(matrix=[np.diag([1, 1, -1, 1]).tolist()]), "pose", "right-handed"),
        (Targets(position=[[0, 0, 0]], quaternion_xyzw=[[0, 0, 0, 2]]), "pose", "norm"),
    ],
)
def test_targets_that_are_no_poses_are_refused(spec, task, message):
    with pytest.raises(InvalidTarget, match=message):
        target_poses(spec, TASKS[task])


def test_every_form_of_a_target_is_the_same_pose():
    half = np.sqrt(0.5)
    expected = np.array([[0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.0], [0, 0, 0, 1]])
    forms = [
        Targets(matrix=[expected.tolist()]),
        Targets(position=[[0.1, 0.2, 0]], rpy=[[0, 0, np.pi / 2]]),
        Targets(position=[[0.1, 0.2, 0]], quaternion_xyzw=[[0, 0, half, half]]),
        Targets(position=[[0.1, 0.2, 0]], euler=("ZXZ", [[np.pi / 4, 0, np.pi / 4]])),
        Targets(position=[[0.1, 0.2]], phi=[np.pi / 2]),
    ]
    for form in forms:
        np.testing.assert_allclose(target_poses(form, TASKS["xy_phi"])[0], expected, atol=1e-15)
