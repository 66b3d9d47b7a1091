"""Closed forms: every solution is one, none is missing, and each bears its name."""

import dataclasses

import numpy as np
import pytest

from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse.closed_form import closed_form_of, solutions, swivel_of
from kinematics.task import TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_ids, shipped_robot

KINDS = {
    "puma560": "spherical_wrist",
    "rx90": "spherical_wrist",
    "kr6_r900": "spherical_wrist",
    "abb_irb140": "spherical_wrist",
    "stanford": "spherical_wrist",
    "kinova": "spherical_wrist",
    "anymal_b_kinova": "spherical_wrist",
    "talos_left_arm": "spherical_wrist",
    "ur3": "parallel_axes",
    "ur5": "parallel_axes",
    "ur10": "parallel_axes",
    "ur3e": "parallel_axes",
    "ur5e": "parallel_axes",
    "ur10e": "parallel_axes",
    "ur3_urdf": "parallel_axes",
    "ur5_urdf": "parallel_axes",
    "ur10_urdf": "parallel_axes",
    "ur3_limited": "parallel_axes",
    "ur5_limited": "parallel_axes",
    "ur10_limited": "parallel_axes",
    "ur3_gripper": "parallel_axes",
    "ur5_gripper": "parallel_axes",
    "z1": "parallel_axes",
    "b1_z1": "parallel_axes",
    "scara": "scara",
    "planar_2r": "planar_2r",
    "planar_3r": "planar_3r",
    "asr_twodof": "planar_2r",
    "a1": "three_joints",
    "anymal_b": "three_joints",
    "anymal_c": "three_joints",
    "b1": "three_joints",
    "bolt": "three_joints",
    "borinot": "planar_2r",
    "double_pendulum_simple": "planar_2r",
    "finger_edu": "three_joints",
    "go1": "three_joints",
    "go2": "three_joints",
    "hyq": "three_joints",
    "laikago": "three_joints",
    "solo12": "three_joints",
    "solo8": "planar_2r",
    "pa10": "srs",
    "iiwa14": "srs",
}
ARMS = [name for name in KINDS if not name.endswith(("_limited", "_gripper"))]


def case(name):
    robot = shipped_robot(name)
    chain = chain_of(robot, robot.tip_frame)
    return robot, chain, closed_form_of(chain)


def poses(robot, chain, q):
    full = np.zeros((len(q), robot.dof))
    full[:, chain.columns] = q
    return fk(robot, full)[robot.tip_frame]


def differences(chain, a, b):
    d = a - b
    d[..., chain.is_revolute] = (d[..., chain.is_revolute] + np.pi) % (2 * np.pi) - np.pi
    return np.abs(d).max(axis=-1)


def errors(robot, chain, q, target, task):
    """Apart from the solver: largest error of the poses of q in the rows of a task."""
    T = poses(robot, chain, q)
    R = target[:3, :3] @ np.swapaxes(T[:, :3, :3], 1, 2)
    vee = np.stack((R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]), 1)
    half_turned = np.trace(R, axis1=1, axis2=2) < 0 if task.name == "pose" else np.zeros(len(q))
    twist = np.concatenate((target[:3, 3] - T[:, :3, 3], vee / 2), axis=1)[:, list(task.rows)]
    return np.abs(twist).max(initial=0) + np.any(half_turned)


def solve(robot, chain, form, target, q, **more):
    """Solutions of the pose at q, whose swivel and free values are those of q."""
    psi = swivel_of(form, q) if form.kind == "srs" else 0.0
    return solutions(form, chain, target, swivel=psi, given=q, **more)


def test_the_shipped_robots():
    for name in shipped_ids():
        robot = shipped_robot(name)
        if chain_of(robot, robot.tip_frame).is_coupled:
            continue
        form = closed_form_of(chain_of(robot, robot.tip_frame))
        assert (form.kind if form else None) == KINDS.get(name), name


@pytest.mark.parametrize("name", ARMS)
def test_random_poses(name):
    robot, chain, form = case(name)
    for task_name in form.tasks:
        task = TASKS[task_name]
        q = np.random.default_rng(2026).uniform(-np.pi, np.pi, (80, chain.length))
        for generating, target in zip(q, poses(robot, chain, q), strict=True):
            found = solve(robot, chain, form, target, generating, task=task)
            assert differences(chain, found.q, generating).min() < 1e-6
            assert errors(robot, chain, found.q, target, task) < 1e-12
            assert found.position_errors.max() + found.orientation_errors.max() < 1e-12
            angles = found.q[:, chain.is_revolute]
            assert ((angles > -np.pi) & (angles <= np.pi)).all()
            assert len(found.q) <= form.most
            apart = differences(chain, found.q[:, None], found.q[None])
            assert (apart[~np.eye(len(found.q), dtype=bool)] > 1e-7).all()
            assert len(set(found.postures(form))) == len(found.q)


COUNTS = {
    "puma560": {8},
    "rx90": {8},
    "stanford": {8},
    "kr6_r900": {4, 8},
    "abb_irb140": {4, 8},
    "ur5": {2, 4, 6, 8},
    "pa10": {8},
    "iiwa14": {8},
    "scara": {2},
    "planar_2r": {2},
    "planar_3r": {2},
}


@pytest.mark.parametrize("name", COUNTS)
def test_the_number_of_solutions(name):
    robot, chain, form = case(name)
    q = np.random.default_rng(7).uniform(-np.pi, np.pi, (200, chain.length))
    task = TASKS[form.tasks[0]]
    targets = poses(robot, chain, q)
    numbers = {len(solutions(form, chain, T, task=task, swivel=0.4).q) for T in targets}
    assert numbers == COUNTS[name]


def variant(name, **changes):
    table = shipped_robot(name).table
    if "d1" in changes:
        first = dataclasses.replace(table.rows[0], d=changes.pop("d1"))
        changes["rows"] = (first, *table.rows[1:])
    robot = robot_from_table(dataclasses.replace(table, **changes))
    chain = chain_of(robot, robot.tip_frame)
    return robot, chain, closed_form_of(chain)


def same_set(found, form, expected):
    """Each expected solution is there once, with its names."""
    assert len(found.q) == len(expected)
    for want in expected:
        d = (np.rad2deg(found.q) - want["q_deg"] + 180) % 360 - 180
        k = int(np.abs(d).max(axis=1).argmin())
        assert np.abs(d[k]).max() < 1e-4
        assert list(found.postures(form)[k]) == want["posture"]


def test_the_eight_solutions_of_the_puma(exercises):
    robot, chain, form = variant("puma560", d1=0.0)
    target = poses(robot, chain, np.deg2rad([[0, 45, 180, 0, 45, 0]]))[0]
    value = next(v for k, v in exercises.items() if k.startswith("E14_"))["value"]
    same_set(solutions(form, chain, target), form, value)


def test_the_eight_solutions_of_the_ur5(exercises):
    robot, chain, form = variant("ur5", base=np.eye(4))
    target = poses(robot, chain, np.deg2rad([[30, -60, 80, -40, 50, 20]]))[0]
    value = next(v for k, v in exercises.items() if k.startswith("E17_"))["value"]
    np.testing.assert_allclose(target[:3, 3], value["p"], atol=1e-9)
    same_set(solutions(form, chain, target), form, value["sols"])


def test_both_solutions_of_the_planar_2r(exercises):
    _, chain, form = case("planar_2r")
    target = np.eye(4)
    target[:2, 3] = 1.2, 0.8
    value = next(v for k, v in exercises.items() if k.startswith("E5_"))["value"]
    names = [{"q_deg": q, "posture": ["up" if q[1] < 0 else "down"]} for q in value]
    same_set(solutions(form, chain, target, task=TASKS["xy"]), form, names)


SMALL = (1e-1, 1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 0.0)
SINGULAR = [
    ("puma560", {4: 0.0}, 7),
    ("puma560", {4: np.pi}, 7),
    ("puma560", {2: -np.pi / 2 + np.arctan2(0.0203, 0.4318)}, 1),
    ("kr6_r900", {2: np.pi / 2 - np.arctan2(0.035, 0.42)}, 1),
    ("kr6_r900", {4: 0.0}, 3),
    ("ur5", {4: 0.0}, 1),
    ("ur5", {4: np.pi}, 1),
    ("ur5", {2: 0.0}, 1),
    ("ur5", {2: 0.0, 4: 0.0}, 1),
    ("ur5_gripper", {4: 0.0}, 1),
    ("z1", {4: np.pi / 2}, 1),
    ("stanford", {4: 0.0}, 2),
    ("stanford", {1: 0.0}, 2),
    ("iiwa14", {3: 0.0}, 4),
    ("iiwa14", {1: 0.0}, 4),
    ("iiwa14", {5: 0.0}, 4),
    ("iiwa14", {1: 0.0, 3: 0.0, 5: 0.0}, 1),
    ("planar_3r", {1: 0.0}, 1),
    ("scara", {1: 0.0}, 1),
]


@pytest.mark.parametrize(("name", "joints", "least"), SINGULAR)
def test_towards_a_singularity(name, joints, least):
    robot, chain, form = case(name)
    task = TASKS[form.tasks[0]]
    generator = np.random.default_rng(11)
    for small in SMALL:
        q = generator.uniform(-np.pi, np.pi, (8, chain.length))
        for joint, value in joints.items():
            q[:, joint] = value + small
        for generating, target in zip(q, poses(robot, chain, q), strict=True):
            found = solve(robot, chain, form, target, generating, task=task)
            assert len(found.q) >= least
            assert errors(robot, chain, found.q, target, task) < 2e-9
            assert (found.position_errors + found.orientation_errors).min() < 1e-12
            if small >= 1e-6 and len(joints) == 1:
                assert differences(chain, found.q, generating).min() < 1e-4


@pytest.mark.parametrize("name", ["rx90", "kr6_r900", "abb_irb140"])
def test_the_wrist_above_axis_1(name):
    """Every solution of a target whose wrist centre is on axis 1, or near it."""
    robot, chain, form = case(name)
    generator = np.random.default_rng(4)
    for offset in (0.0, 1e-12, 1e-10, 1e-8, 1e-5):
        q = generator.uniform(-np.pi, np.pi, (40, 6))
        for T in poses(robot, chain, q):
            wrist = T[:3, 3] + T[:3, :3] @ form.constants[5:8]
            target = T.copy()
            target[:2, 3] -= wrist[:2] - [0.6 * offset, 0.8 * offset]
            found = solutions(form, chain, target, given=np.full(6, 0.5))
            if len(found.q) == 0:  # beyond the reach at this height
                assert not len(solutions(form, chain, target + 1e-3 * np.eye(4, k=3)).q)
                continue
            assert len(found.q) in ((4,) if found.free.any() else (4, 8))
            assert errors(robot, chain, found.q, target, TASKS["pose"]) < 2e-9
            if offset == 0.0:
                assert found.free[:, 0].all()
                assert (found.q[:, 0] == 0.5).all()


def test_a_straight_wrist_takes_the_given_value_and_says_so():
    robot, chain, form = case("puma560")
    q = np.array([0.3, 0.4, -0.5, 0.7, 0.0, -0.2])
    target = poses(robot, chain, q[None])[0]
    found = solutions(form, chain, target, given=q)
    k = int(differences(chain, found.q, q).argmin())
    np.testing.assert_allclose(found.q[k], q, atol=1e-9)
    assert found.free[k].tolist() == [False, False, False, True, False, False]
    assert found.free.sum() == 1


def test_no_solution_out_of_reach():
    for name in ("puma560", "ur5", "iiwa14", "scara", "planar_2r", "planar_3r"):
        _, chain, form = case(name)
        target = np.eye(4)
        target[:3, 3] = 5.0, 0.0, 0.0
        assert len(solutions(form, chain, target, task=TASKS[form.tasks[0]]).q) == 0


def test_a_tilted_target_of_a_scara():
    robot, chain, form = case("scara")
    target = poses(robot, chain, np.array([[0.3, 0.5, 0.1, 0.2]]))[0]
    tilt = np.eye(4)
    tilt[1:3, 1:3] = [[np.cos(0.1), -np.sin(0.1)], [np.sin(0.1), np.cos(0.1)]]
    tilted = target @ tilt
    assert len(solutions(form, chain, target).q) == 2
    assert len(solutions(form, chain, tilted).q) == 0
    found = solutions(form, chain, tilted, task=TASKS["xyz_phi"])
    assert len(found.q) == 2
    assert errors(robot, chain, found.q, tilted, TASKS["xyz_phi"]) < 1e-9


def test_a_task_that_it_does_not_solve():
    _, chain, form = case("planar_3r")
    with pytest.raises(ValueError, match="xy_phi"):
        solutions(form, chain, np.eye(4), task=TASKS["position"])


@pytest.mark.parametrize("name", ["pa10", "iiwa14"])
def test_the_swivel_angle(name):
    """All solutions of an angle have it, and their elbow at the same place."""
    robot, chain, form = case(name)
    generator = np.random.default_rng(3)
    shoulder = poses_of_frames(robot, np.zeros(7))
    assert shoulder.shape == (3,)
    for q in generator.uniform(-2.5, 2.5, (60, 7)):
        target = poses(robot, chain, q[None])[0]
        psi = generator.uniform(-np.pi, np.pi)
        found = solutions(form, chain, target, swivel=psi)
        assert len(found.q) == 8
        for row in found.q:
            assert np.exp(1j * swivel_of(form, row)) == pytest.approx(np.exp(1j * psi), abs=1e-9)
        elbows = np.array([poses_of_frames(robot, row) for row in found.q])
        np.testing.assert_allclose(elbows, np.broadcast_to(elbows[0], elbows.shape), atol=1e-9)
    with pytest.raises(ValueError, match="no swivel"):
        swivel_of(case("puma560")[2], np.zeros(6))


def poses_of_frames(robot, q):
    """Where axes 3 and 4 cross: the elbow, in base axes."""
    frame = {"pa10": "frame_3", "iiwa14": "frame_3"}[robot.name]
    return fk(robot, q, [frame])[frame][:3, 3]
