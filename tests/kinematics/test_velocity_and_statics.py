"""Twists, joint velocities and their duals."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.errors import InvalidOption, WrongConfiguration, WrongVector
from kinematics.forward import fk
from kinematics.jacobian import ReferenceFrame, jacobian
from kinematics.statics import joint_torques, wrench_of
from kinematics.task import TASKS
from kinematics.velocity import joint_velocities, twist_of
from robots.shipped import shipped_ids, shipped_robot

SOME = ["planar_2r", "scara", "stanford", "puma560", "pa10", "kinova", "tiago_no_hand", "baxter"]


def sampled(robot, seed, n=1):
    rng = np.random.default_rng(seed)
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return rng.uniform(low, high, (n, robot.dof)), rng.uniform(-2, 2, (n, robot.dof))


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(shipped_ids()), st.integers(0, 10**6), st.data())
def test_power_is_the_same_at_tip_and_joints(name, seed, data):
    """w · twist = τ · qd in every frame and reference frame."""
    robot = shipped_robot(name)
    frame = data.draw(st.sampled_from(robot.frames))
    (q,), (qd,) = sampled(robot, seed)
    wrench = np.random.default_rng(seed).uniform(-3, 3, 6)
    for reference_frame in ReferenceFrame:
        twist = twist_of(robot, q, qd, frame, reference_frame)
        tau = joint_torques(robot, q, wrench, frame, reference_frame)
        scale = max(1.0, np.abs(tau) @ np.abs(qd))
        assert abs(wrench @ twist - tau @ qd) <= 1e-12 * scale


@pytest.mark.parametrize("name", SOME)
def test_twist_is_the_velocity_of_the_frame(name):
    robot = shipped_robot(name)
    (q,), (qd,) = sampled(robot, 4)
    frame, h = robot.tip_frame, 1e-5
    T = fk(robot, q)[frame]
    after, before = (fk(robot, q + s * h * qd)[frame] for s in (1, -1))
    v = (after[:3, 3] - before[:3, 3]) / (2 * h)
    w = pin.log3(after[:3, :3] @ before[:3, :3].T) / (2 * h)
    R, p = T[:3, :3], T[:3, 3]
    expected = {
        "local_world_aligned": [*v, *w],
        "local": [*R.T @ v, *R.T @ w],
        "world": [*v - np.cross(w, p), *w],
    }
    for reference_frame in ReferenceFrame:
        twist = twist_of(robot, q, qd, None, reference_frame)
        np.testing.assert_allclose(twist, expected[reference_frame], atol=1e-7)


def test_wrenches_in_the_three_reference_frames_are_one_wrench():
    """A force at the tip, seen at the base's origin with its moment, costs the same torques."""
    robot = shipped_robot("puma560")
    (q,), _ = sampled(robot, 1)
    T = fk(robot, q)["tool"]
    f, m = np.array([1.0, -2.0, 3.0]), np.array([0.3, 0.2, -0.1])
    R, p = T[:3, :3], T[:3, 3]
    tau = joint_torques(robot, q, [*f, *m])
    at_base = joint_torques(robot, q, [*f, *(m + np.cross(p, f))], None, ReferenceFrame.WORLD)
    local = joint_torques(robot, q, [*R.T @ f, *R.T @ m], None, ReferenceFrame.LOCAL)
    np.testing.assert_allclose(at_base, tau, atol=1e-12)
    np.testing.assert_allclose(local, tau, atol=1e-12)


@settings(max_examples=80, deadline=None)
@given(
    st.sampled_from(SOME),
    st.sampled_from(["pose", "position", "xy", "xy_phi", "orientation"]),
    st.sampled_from(list(ReferenceFrame)),
    st.integers(0, 10**6),
)
def test_joint_velocities_invert_the_twist(name, task, reference_frame, seed):
    robot, task = shipped_robot(name), TASKS[task]
    (q,), (qd,) = sampled(robot, seed)
    rows = list(task.rows)
    J = jacobian(robot, q, None, reference_frame)[rows]
    twist = J @ qd
    found = joint_velocities(robot, q, twist, task, None, reference_frame)
    np.testing.assert_allclose(found.qd, np.linalg.pinv(J, rcond=1e-10) @ twist, atol=1e-6)
    np.testing.assert_allclose(found.residual, 0, atol=1e-9)
    np.testing.assert_allclose(J @ found.null_motions[0].T, 0, atol=1e-9)
    assert len(found.null_motions[0]) == robot.dof - found.rank
    assert np.linalg.norm(found.qd) <= np.linalg.norm(qd) + 1e-9
    assert found.determined == (found.rank == len(rows))


@settings(max_examples=80, deadline=None)
@given(
    st.sampled_from(SOME),
    st.sampled_from(["pose", "position", "xy"]),
    st.sampled_from(list(ReferenceFrame)),
    st.integers(0, 10**6),
)
def test_torques_give_the_wrench_back(name, task, reference_frame, seed):
    robot, task = shipped_robot(name), TASKS[task]
    (q,), (other,) = sampled(robot, seed)
    J = jacobian(robot, q, None, reference_frame)[list(task.rows)]
    wrench = np.random.default_rng(seed).uniform(-3, 3, len(J))
    found = wrench_of(robot, q, J.T @ wrench, task, None, reference_frame)
    np.testing.assert_allclose(found.residual, 0, atol=1e-9)
    off = found.wrench - wrench
    lost = found.lost_directions[0]
    if found.determined:
        sigma = np.linalg.svd(J, compute_uv=False)
        np.testing.assert_allclose(off, 0, atol=1e-13 * max(1, sigma[0]) / sigma[-1] + 1e-12)
    np.testing.assert_allclose(lost @ J, 0, atol=1e-9)
    assert np.linalg.norm(found.wrench) <= np.linalg.norm(wrench) + 1e-9
    # Torques that no wrench holds show as a residual: the torques' part along null motions.
    general = wrench_of(robot, q, other, task, None, reference_frame)
    np.testing.assert_allclose(J @ general.residual, 0, atol=1e-8)


def test_a_stretched_arm_cannot_follow_along_itself():
    robot, q = shipped_robot("planar_2r"), np.array([np.pi / 6, 0.0])
    along, across = np.array([np.sqrt(3) / 2, 0.5]), np.array([-0.5, np.sqrt(3) / 2])
    twist = 0.3 * along + 0.2 * across
    found = joint_velocities(robot, q, twist, TASKS["xy"])
    assert found.rank == 1
    assert not found.determined
    np.testing.assert_allclose(found.residual, -0.3 * along, atol=1e-12)
    held = wrench_of(robot, q, np.zeros(2), TASKS["xy"])
    np.testing.assert_allclose(held.lost_directions[0], [along], atol=1e-12)
    # A force along the stretched arm needs no torque.
    np.testing.assert_allclose(joint_torques(robot, q, [*along, 0, 0, 0, 0]), 0, atol=1e-15)


def test_damping_bounds_the_velocities_near_a_singularity():
    robot, damping = shipped_robot("planar_2r"), 0.05
    for bend in (0.0, 1e-9, 1e-4, 0.02):
        q = np.array([0.3, bend])
        twist = np.array([np.cos(0.3), np.sin(0.3)])
        found = joint_velocities(robot, q, twist, TASKS["xy"], damping=damping)
        assert np.linalg.norm(found.qd) <= 1 / (2 * damping) + 1e-12
        J = jacobian(robot, q)[:2]
        expected = J.T @ np.linalg.solve(J @ J.T + damping**2 * np.eye(2), twist)
        np.testing.assert_allclose(found.qd, expected, atol=1e-9)
        np.testing.assert_allclose(found.residual, J @ expected - twist, atol=1e-9)


def test_velocity_limits_are_watched():
    robot = shipped_robot("ur5")
    q = np.array([0.1, -1.0, 1.2, 0.3, 0.5, 0.6])
    slow = joint_velocities(robot, q, np.full(6, 0.01))
    fast = joint_velocities(robot, q, np.full(6, 10.0))
    assert slow.within_velocity_limits
    assert not fast.within_velocity_limits


@pytest.mark.parametrize("name", ["puma560", "pa10", "scara"])
def test_batches_are_the_single_ones_stacked(name):
    robot = shipped_robot(name)
    q, qd = sampled(robot, 3, 5)
    twist = twist_of(robot, q, qd)
    many = joint_velocities(robot, q, twist)
    held = wrench_of(robot, q, qd)
    tau = joint_torques(robot, q, twist)
    at_one = joint_velocities(robot, q[0], twist)
    for k in range(5):
        np.testing.assert_allclose(twist[k], twist_of(robot, q[k], qd[k]), atol=1e-12)
        np.testing.assert_allclose(tau[k], joint_torques(robot, q[k], twist[k]), atol=1e-12)
        one = joint_velocities(robot, q[k], twist[k])
        np.testing.assert_allclose(many.qd[k], one.qd, atol=1e-9)
        assert many.rank[k] == one.rank
        assert len(many.null_motions[k]) == len(one.null_motions[0])
        np.testing.assert_allclose(
            held.wrench[k], wrench_of(robot, q[k], qd[k]).wrench, atol=1e-9, rtol=1e-9
        )
        again = joint_velocities(robot, q[0], twist[k]).qd
        np.testing.assert_allclose(at_one.qd[k], again, atol=1e-12)
    np.testing.assert_allclose(twist_of(robot, q[0], qd)[2], twist_of(robot, q[0], qd[2]))
    np.testing.assert_allclose(twist_of(robot, q, qd[0])[2], twist_of(robot, q[2], qd[0]))


def test_what_does_not_fit_is_refused():
    robot, q = shipped_robot("planar_2r"), np.zeros(2)
    for twist in ([1.0], [1.0, np.nan], [[[1.0, 2.0]]], 3.0, ["a", "b"], [1e7, 0]):
        with pytest.raises(WrongVector, match="twist"):
            joint_velocities(robot, q, twist, TASKS["xy"])
    with pytest.raises(WrongVector, match="vx, vy, vz"):
        joint_velocities(robot, q, [0.0, 0.0])
    with pytest.raises(WrongVector, match="3 rows for 2 of q"):
        joint_velocities(robot, np.zeros((2, 2)), np.zeros((3, 2)), TASKS["xy"])
    for damping in (-1, np.nan, 1e9):
        with pytest.raises(InvalidOption, match="damping"):
            joint_velocities(robot, q, [0, 0], TASKS["xy"], damping=damping)
    with pytest.raises(WrongConfiguration, match="qd"):
        twist_of(robot, q, [1.0])
    with pytest.raises(WrongConfiguration, match="tau"):
        wrench_of(robot, q, [1.0])
    with pytest.raises(WrongVector, match="fx, fy, fz, mx, my, mz"):
        joint_torques(robot, q, [1.0])
