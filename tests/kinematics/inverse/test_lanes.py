"""Many targets in lanes, and many starts of one: the answers are those of one at a time."""

import json
import os
import subprocess
import sys
import threading
import time

import numpy as np
import pinocchio as pin
import pytest

from dh_to_urdf import read_mapping
from kinematics.deadline import Cancelled, Deadline, under
from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, Tolerance, solve_ik, solve_ik_batch
from kinematics.inverse.bounds import JointBounds
from kinematics.jacobian import jacobian
from kinematics.task import TASKS
from robots.robot import robot_from_table, robot_from_urdf
from robots.shipped import shipped_robot

LIMIT = '<limit lower="-2.5" upper="2.5" effort="9" velocity="9"/>'
FOLLOWER = '<mimic joint="j2" multiplier="-0.5" offset="0.2"/>'


def coupled_arm():
    """Seven joints about axes that turn by turn are across, the fourth a follower of the second."""
    text = ['<robot name="c"><link name="l0"/>']
    for k in range(1, 8):
        axis = ("0 0 1", "0 1 0")[k % 2]
        mimic = FOLLOWER if k == 4 else ""
        text.append(
            f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="l{k - 1}"/>'
            f'<child link="l{k}"/><origin xyz="0.05 0.1 0.3"/><axis xyz="{axis}"/>{LIMIT}{mimic}'
            "</joint>"
        )
    return robot_from_urdf("".join(text) + "</robot>")


def skewed_arm():
    """Axes that a hand wrote: nearly parallel, and nearly at right angles."""
    rows = [
        {
            "type": kind,
            "theta": 0.1,
            "d": 0.3,
            "a": 0.2,
            "alpha": alpha,
            "limits": {"lower": low, "upper": high},
        }
        for kind, alpha, (low, high) in (
            ("revolute", 1.5708, [-2.9, 2.9]),
            ("revolute", 1e-7, [-2.0, 2.0]),
            ("prismatic", 0.3, [0.1, 0.8]),
            ("revolute", -1.5708, [-3.2, 3.2]),
            ("revolute", 1.57, [-2.0, 2.0]),
            ("revolute", 3.14159, [-3.0, 3.0]),
            ("revolute", 1.2, [-3.0, 3.0]),
        )
    ]
    return robot_from_table(read_mapping({"convention": "standard", "joints": rows}))


def arm_of(name):
    return {"coupled": coupled_arm, "skewed": skewed_arm}.get(name, lambda: shipped_robot(name))()


def targets_of(robot, n, seed=0):
    """Reachable poses, some with another orientation, some far away."""
    rng = np.random.default_rng(seed)
    low, high = JointBounds.of(robot).ranges(1.0)
    T = fk(robot, rng.uniform(low, high, (n, robot.dof)))[robot.tip_frame]
    T[3::10, :3, :3] = T[2::10, :3, :3][: len(T[3::10])]
    T[5::20, :3, 3] *= 30.0
    return T


CASES = [
    ("panda", "pose"),
    ("panda", "position"),
    ("iiwa14", "direction"),
    ("xarm7", "position_direction"),
    ("planar_8r", "xy_phi"),
    ("planar_8r", "xy"),
    ("kinova", "pose"),
    ("ur5", "pose"),
    ("scara", "xyz_phi"),
    ("talos_arm", "orientation"),
    ("coupled", "pose"),
    ("coupled", "position_direction"),
    ("skewed", "pose"),
    ("skewed", "position"),
]


@pytest.mark.parametrize(("name", "task"), CASES)
def test_a_batch_answers_as_single_targets_do(name, task):
    robot, space, options = arm_of(name), TASKS[task], IKOptions(max_restarts=12)
    T = targets_of(robot, 60)
    batch = solve_ik_batch(robot, T, task=space, options=options, threads=2)
    for i, target in enumerate(T):
        one = solve_ik(robot, target, task=space, options=options)
        assert batch.statuses[i] is one.status
        assert batch.restarts[i] == one.restarts
        assert abs(batch.iterations[i] - one.iterations) <= (one.status != IKStatus.CONVERGED) * 9
        np.testing.assert_allclose(batch.q[i], one.q, rtol=0, atol=1e-9)
        assert batch.position_error[i] == pytest.approx(one.position_error, abs=1e-12, rel=1e-6)
        assert batch.orientation_error[i] == pytest.approx(
            one.orientation_error, abs=1e-12, rel=1e-6
        )


def long_arm(count=27):
    """More joints than the memory of a quick start has room for."""
    joints = "".join(
        f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="l{k - 1}"/>'
        f'<child link="l{k}"/><origin xyz="0 0 0.1" rpy="{k % 3} 0 0"/>'
        f'<axis xyz="0 {k % 2} {(k + 1) % 2}"/>{LIMIT}</joint>'
        for k in range(1, count + 1)
    )
    return robot_from_urdf(f'<robot name="long"><link name="l0"/>{joints}</robot>')


def test_more_joints_than_the_stack_has_room_for():
    robot = long_arm()
    T = targets_of(robot, 12)[:3]
    batch = solve_ik_batch(robot, T)
    for i, target in enumerate(T):
        one = solve_ik(robot, target)
        assert one.status is batch.statuses[i] is IKStatus.CONVERGED
        np.testing.assert_allclose(batch.q[i], one.q, rtol=0, atol=1e-9)
        away = fk(robot, one.q)[robot.tip_frame] - target
        assert np.abs(away).max() < 2e-6


def test_a_target_that_takes_many_starts_is_answered_as_in_a_batch():
    """Longer than the first part of a solve, which then begins anew."""
    robot, options = shipped_robot("panda"), IKOptions(max_restarts=150, time_budget=20.0)
    low, high = JointBounds.of(robot).ranges(1.0)
    q = np.random.default_rng(0).uniform(low, high, (2000, robot.dof))
    T = fk(robot, q)[robot.tip_frame]
    T[:4, 2, 3] += 5.0
    T[4:8, :3, :3] = T[4:8, :3, :3] @ np.diag([-1.0, 1.0, -1.0])
    batch = solve_ik_batch(robot, T, options=options)
    long = np.flatnonzero(batch.iterations > 256)
    assert len(long) >= 3
    for seed in (None, batch.seed.copy()):
        for i in (*long[:12], *range(8)):
            one = solve_ik(robot, T[i], seed=seed, options=options)
            assert one.status is batch.statuses[i]
            assert one.restarts == batch.restarts[i]
            np.testing.assert_allclose(batch.q[i], one.q, rtol=0, atol=1e-9)
            np.testing.assert_array_equal(one.seed, batch.seed)


def test_what_was_asked_before_does_not_count():
    """Seeds, tolerances and random seeds in turns, of whole robots and of parts of them."""
    robot = shipped_robot("panda")
    frames = [None, "frame_5"]
    T, seed = targets_of(robot, 12), JointBounds.of(robot).middle() + 0.2
    asked = [
        (frame, options, start)
        for frame in frames
        for options in (IKOptions(), IKOptions(random_seed=3), IKOptions(max_iterations=4))
        for start in (None, seed)
    ]
    fresh = [
        (*each, solve_ik_batch(robot, T[:1], frame=each[0], options=each[1], seed=each[2]))
        for each in asked
    ]
    for _ in range(2):
        for frame, options, start, batch in fresh:
            one = solve_ik(robot, T[0], frame=frame, options=options, seed=start)
            assert one.status is batch.statuses[0]
            np.testing.assert_allclose(one.q, batch.q[0], rtol=0, atol=1e-9)
            np.testing.assert_array_equal(one.seed, batch.seed)
            again = solve_ik(robot, T[1], frame=frame, options=options, seed=start)
            assert not np.shares_memory(one.q, again.q)
    np.testing.assert_array_equal(seed, JointBounds.of(robot).middle() + 0.2)


@pytest.mark.parametrize("name", ["panda", "planar_8r", "coupled"])
def test_an_answer_does_not_depend_on_the_targets_beside_it(name):
    robot = arm_of(name)
    T = targets_of(robot, 40, seed=7)
    options = IKOptions(max_restarts=12)
    whole = solve_ik_batch(robot, T, options=options)
    order = np.random.default_rng(8).permutation(len(T))
    mixed = solve_ik_batch(robot, T[order], options=options)
    for part, rows in ((mixed, order), *((alone(robot, T, i, options), [i]) for i in range(12))):
        for key in ("codes", "q", "position_error", "orientation_error", "iterations", "restarts"):
            np.testing.assert_array_equal(getattr(part, key), getattr(whole, key)[rows])


def alone(robot, T, i, options):
    return solve_ik_batch(robot, T[i : i + 1], options=options)


@pytest.mark.parametrize("task", ["pose", "orientation", "position_direction", "direction"])
def test_targets_half_a_turn_away_are_solved(task):
    """The seed's error is at, or next to, half a turn about axes of all sorts."""
    robot, space = shipped_robot("iiwa14"), TASKS[task]
    seed = JointBounds.of(robot).middle() + 0.3
    here = fk(robot, seed)[robot.tip_frame]
    axes = np.vstack((np.eye(3), [[0.6, 0.8, 0], [-0.6, 0, 0.8], [0.48, -0.6, 0.64]]))
    axes = np.vstack((axes, -axes, here[:3, :3].T))
    T = np.repeat(here[None], 3 * len(axes), axis=0)
    for k, u in enumerate(np.repeat(axes, 3, axis=0)):
        T[k, :3, :3] = pin.AngleAxis(np.pi - (0.0, 1e-4, 3e-3)[k % 3], u).matrix() @ here[:3, :3]
    options = IKOptions(max_restarts=20)
    batch = solve_ik_batch(robot, T, seed=seed, task=space, options=options)
    for i, target in enumerate(T):
        one = solve_ik(robot, target, seed=seed, task=space, options=options)
        assert batch.statuses[i] is one.status
        assert batch.restarts[i] == one.restarts
    if space.positions:
        return
    assert set(batch.statuses) == {IKStatus.CONVERGED}


@pytest.mark.parametrize("name", ["panda", "ur5"])
def test_without_time_the_seed_is_measured(name):
    robot = shipped_robot(name)
    T = targets_of(robot, 2100)
    batch = solve_ik_batch(robot, T, seconds=0.0, threads=2)
    far = np.array([status is IKStatus.UNREACHABLE for status in batch.statuses])
    assert {batch.statuses[i] for i in np.flatnonzero(~far)} == {IKStatus.TIMEOUT}
    np.testing.assert_array_equal(batch.q, np.repeat(batch.seed[None], len(T), axis=0))
    here = fk(robot, batch.seed)[robot.tip_frame]
    away = np.linalg.norm(T[:, :3, 3] - here[:3, 3], axis=1)
    np.testing.assert_allclose(batch.position_error, away, rtol=1e-12, atol=1e-12)
    assert not batch.iterations.any()


def test_time_that_ends_in_between_leaves_measured_timeouts():
    """Poses within reach whose orientation is not: every start is tried, which takes its time."""
    robot = shipped_robot("planar_8r")
    T = targets_of(robot, 3000)
    T[:, :3, :3] = T[:, :3, :3] @ np.diag([1.0, -1.0, -1.0])
    options = IKOptions(max_restarts=10_000, time_budget=60.0)
    began = time.perf_counter()
    batch = solve_ik_batch(robot, T, options=options, seconds=0.3)
    assert time.perf_counter() - began < 30.0
    assert IKStatus.TIMEOUT in batch.statuses
    assert np.isfinite(batch.q).all()
    poses = fk(robot, batch.q)[robot.tip_frame]
    away = np.linalg.norm(poses[:, :3, 3] - T[:, :3, 3], axis=1)
    np.testing.assert_allclose(batch.position_error, away, rtol=1e-9, atol=1e-9)


def test_a_batch_that_is_not_wanted_any_more_stops():
    robot = shipped_robot("planar_8r")
    T = targets_of(robot, 3000)
    T[:, :3, :3] = T[:, :3, :3] @ np.diag([1.0, -1.0, -1.0])
    deadline = Deadline()
    threading.Timer(0.2, deadline.drop).start()
    options = IKOptions(max_restarts=10_000, time_budget=60.0)
    with under(deadline), pytest.raises(Cancelled):
        solve_ik_batch(robot, T, options=options, threads=2)


def test_the_budget_of_a_target_ends_its_starts():
    robot = shipped_robot("planar_8r")
    T = targets_of(robot, 20)
    T[:, :3, :3] = T[:, :3, :3] @ np.diag([1.0, -1.0, -1.0])
    near = np.linalg.norm(T[:, :3, 3], axis=1) < 1.0
    batch = solve_ik_batch(robot, T, options=IKOptions(max_restarts=10_000, time_budget=1e-4))
    assert {batch.statuses[i] for i in np.flatnonzero(near)} == {IKStatus.TIMEOUT}
    assert (batch.iterations <= 400).all()


def test_a_tolerance_at_the_edge_of_rounding_is_met():
    robot = shipped_robot("panda")
    T = targets_of(robot, 64)[:3]
    options = IKOptions(tolerance=Tolerance(1e-12, 1e-12))
    batch = solve_ik_batch(robot, T, options=options)
    assert set(batch.statuses) == {IKStatus.CONVERGED}
    assert (batch.position_error <= 1e-12).all()


def answers():
    """What a processor computes, in plain numbers."""
    found = {}
    for name in ("panda", "planar_8r", "scara"):
        robot = shipped_robot(name)
        T = targets_of(robot, 24)
        Q = np.random.default_rng(1).uniform(-2, 2, (11, robot.dof))
        batch = solve_ik_batch(robot, T, options=IKOptions(max_restarts=8))
        ones = [solve_ik(robot, target, options=IKOptions(max_restarts=8)) for target in T[:8]]
        found[name] = {
            "fk": fk(robot, Q)[robot.tip_frame].tolist(),
            "jacobian": jacobian(robot, Q).tolist(),
            "codes": batch.codes.tolist(),
            "restarts": batch.restarts.tolist(),
            "q": batch.q.tolist(),
            "statuses": [str(one.status) for one in ones],
            "one": [one.q.tolist() for one in ones],
        }
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cpu", "features"),
    [
        ("x86-64", ""),
        ("haswell", "+avx,+avx2,+fma,+bmi,+bmi2"),
    ],
)
def test_other_processors_answer_the_same(cpu, features, tmp_path):
    """Registers of two or four lanes of eight; products and sums fused or not."""
    environment = {
        **os.environ,
        "NUMBA_CPU_NAME": cpu,
        "NUMBA_CPU_FEATURES": features,
        "NUMBA_CACHE_DIR": str(tmp_path),
    }
    command = [sys.executable, __file__]
    run = subprocess.run(command, env=environment, capture_output=True, check=True, timeout=1800)
    theirs, ours = json.loads(run.stdout), answers()
    for name, mine in ours.items():
        for key, value in mine.items():
            if key in ("codes", "statuses", "restarts"):
                assert theirs[name][key] == value, (name, key)
            elif key in ("fk", "jacobian"):
                np.testing.assert_allclose(theirs[name][key], value, rtol=0, atol=1e-14)
        reached = np.array(mine["codes"]) == 0
        for key, rows in (("q", reached), ("one", reached[:8])):
            robot = shipped_robot(name)
            poses = [fk(robot, np.array(q[key]))[robot.tip_frame] for q in (mine, theirs[name])]
            assert np.abs(poses[0] - poses[1])[rows].max(initial=0.0) <= 3e-6


if __name__ == "__main__":
    sys.stdout.write(json.dumps(answers()))
