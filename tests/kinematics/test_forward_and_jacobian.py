"""Batches and every base against Pinocchio and finite differences."""

import numpy as np
import pinocchio as pin
import pytest

from kinematics.errors import WrongConfiguration
from kinematics.forward import fk
from kinematics.jacobian import ReferenceFrame, analytic_jacobian, jacobian
from kinematics.kernels import sines_and_cosines
from kinematics.orientation import euler_angles
from robots.errors import UnknownFrame
from robots.robot import robot_from_urdf
from robots.shipped import shipped_ids, shipped_robot

SOME = ["scara", "stanford", "pa10", "kinova", "talos_arm", "tiago_no_hand", "baxter", "romeo_laas"]


def random_q(robot, n, seed=0):
    rng = np.random.default_rng(seed)
    low = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    high = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    return rng.uniform(low, high, (n, robot.dof))


def pinocchio_pose(robot, q, frame):
    """Straight from Pinocchio's functions, by the frame's name."""
    data = robot.model.createData()
    full = pin.neutral(robot.model)
    tangent = np.zeros(robot.model.nv)
    for value, joint in zip(robot.joint_values(q), robot.moving, strict=True):
        tangent[robot.model.joints[robot.model.getJointId(joint.name)].idx_v] = value
    pin.framesForwardKinematics(robot.model, data, pin.integrate(robot.model, full, tangent))
    body = pin.FrameType.BODY
    base = data.oMf[robot.model.getFrameId(robot.base_frame, body)]
    return (base.inverse() * data.oMf[robot.model.getFrameId(frame, body)]).homogeneous


@pytest.mark.parametrize("name", shipped_ids())
def test_single_and_batch_equal_pinocchio_in_every_frame(name):
    robot = shipped_robot(name)
    batch = random_q(robot, 3)
    frames = robot.frames
    many = fk(robot, batch, frames)
    for k, q in enumerate(batch):
        one = fk(robot, q, frames)
        for frame in frames:
            expected = pinocchio_pose(robot, q, frame)
            np.testing.assert_allclose(one[frame], expected, atol=1e-12, rtol=0)
            np.testing.assert_allclose(many[frame][k], expected, atol=1e-12, rtol=0)


@pytest.mark.parametrize("name", SOME)
@pytest.mark.parametrize("reference_frame", list(ReferenceFrame))
def test_jacobian_is_the_derivative_of_fk(name, reference_frame):
    robot = shipped_robot(name)
    q, h = random_q(robot, 1)[0], 1e-6
    J = jacobian(robot, q, None, reference_frame)
    tip = robot.tip_frame
    T = fk(robot, q)[tip]
    for column in range(robot.dof):
        step = np.zeros(robot.dof)
        step[column] = h
        after, before = fk(robot, q + step)[tip], fk(robot, q - step)[tip]
        v = (after[:3, 3] - before[:3, 3]) / (2 * h)
        w = pin.log3(after[:3, :3] @ before[:3, :3].T) / (2 * h)
        if reference_frame is ReferenceFrame.WORLD:
            v = v - np.cross(w, T[:3, 3])
        if reference_frame is ReferenceFrame.LOCAL:
            v, w = T[:3, :3].T @ v, T[:3, :3].T @ w
        np.testing.assert_allclose(J[:, column], [*v, *w], atol=2e-8)


@pytest.mark.parametrize("name", SOME)
@pytest.mark.parametrize("reference_frame", list(ReferenceFrame))
def test_batch_jacobian_equals_the_single_one(name, reference_frame):
    robot = shipped_robot(name)
    batch = random_q(robot, 5)
    many = jacobian(robot, batch, None, reference_frame)
    for k, q in enumerate(batch):
        np.testing.assert_allclose(many[k], jacobian(robot, q, None, reference_frame), atol=1e-12)


def test_a_base_that_moves_is_no_fixed_one_where_its_pose_is_the_root_s():
    """At q = 0 the base link stands in the root's axes; a turn of its own joint moves no tip."""
    joint = (
        '<joint name="j{0}" type="revolute"><parent link="{1}"/><child link="{2}"/>'
        '<origin xyz="{3} 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>'
    )
    links = "".join(f'<link name="{name}"/>' for name in ("root", "turned", "tip"))
    joints = joint.format(1, "root", "turned", 0) + joint.format(2, "turned", "tip", 1)
    robot = robot_from_urdf(f'<robot name="r">{links}{joints}</robot>', base="turned", tip="tip")
    q = np.zeros(2)
    np.testing.assert_array_equal(jacobian(robot, q), [[0, 0]] * 5 + [[0, 1]])
    np.testing.assert_allclose(jacobian(robot, q[None])[0], jacobian(robot, q), atol=1e-15)


def test_jacobian_between_two_branches():
    """Base on one arm of a two-armed robot, tip on the other: both arms' joints count."""
    text = shipped_robot("baxter").urdf
    robot = robot_from_urdf(text, base="left_gripper", tip="right_gripper")
    q, h = random_q(robot, 1)[0], 1e-6
    J = jacobian(robot, q)
    np.testing.assert_allclose(jacobian(robot, q[None])[0], J, atol=1e-12)
    for column in range(robot.dof):
        step = np.zeros(robot.dof)
        step[column] = h
        after, before = (fk(robot, q + s * step)["right_gripper"] for s in (1, -1))
        np.testing.assert_allclose(
            J[:3, column], (after[:3, 3] - before[:3, 3]) / (2 * h), atol=2e-8
        )
    assert (np.abs(J).max(axis=0) > 1e-6).sum() == 14


@pytest.mark.parametrize("sequence", ["ZXZ", "ZYX", "xyz"])
def test_analytic_jacobian_is_the_derivative_of_the_euler_angles(sequence):
    robot = shipped_robot("puma560")
    q, h = np.array([0.3, -0.5, 1.7, 0.7, 0.9, 1.0]), 1e-6
    J = analytic_jacobian(robot, q, sequence)
    for column in range(robot.dof):
        step = np.zeros(robot.dof)
        step[column] = h
        after, before = (
            euler_angles(fk(robot, q + s * step)["tool"][:3, :3], sequence).solutions[0]
            for s in (1, -1)
        )
        np.testing.assert_allclose(J[3:, column], (after - before) / (2 * h), atol=1e-7)
    np.testing.assert_allclose(analytic_jacobian(robot, q[None], sequence)[0], J, atol=1e-12)


def test_batches_longer_than_a_chunk_are_whole():
    robot = shipped_robot("pa10")
    batch = random_q(robot, 5000)
    poses = fk(robot, batch)["tool"]
    for k in (0, 2047, 2048, 4999):
        np.testing.assert_allclose(poses[k], fk(robot, batch[k])["tool"], atol=1e-13)


@pytest.mark.parametrize(
    ("q", "where"),
    [
        ([0.1], "2 joints"),
        ([0.1, np.nan], "j2"),
        ([[0, 0], [0, np.inf]], "j2"),
        ([1e7, 0], "j1"),
        (0.3, "dimensions"),
        ([[[0, 0]]], "dimensions"),
        (["a", "b"], "numbers"),
    ],
)
def test_bad_configurations_are_refused(q, where):
    with pytest.raises(WrongConfiguration, match=where):
        fk(shipped_robot("planar_2r"), q)


def test_unknown_frames_name_the_valid_ones():
    robot = shipped_robot("planar_2r")
    with pytest.raises(UnknownFrame, match="frame_1"):
        fk(robot, np.zeros(2), ["frame_9"])
    with pytest.raises(UnknownFrame):
        jacobian(robot, np.zeros(2), "nothing")


def test_sines_and_cosines_keep_their_digits():
    rng = np.random.default_rng(8)
    quarters = np.arange(-20, 21) * (np.pi / 4)
    near = (quarters[:, None] + np.array([0.0, 1e-15, -1e-15, 1e-9, -1e-9])).ravel()
    for q in (rng.uniform(-7, 7, 100_000), rng.uniform(-1e6, 1e6, 100_000), near):
        trig = np.empty(2 * len(q))
        sines_and_cosines(q, trig)
        np.testing.assert_allclose(trig[: len(q)], np.sin(q), atol=3e-16, rtol=0)
        np.testing.assert_allclose(trig[len(q) :], np.cos(q), atol=3e-16, rtol=0)
