"""Hessian, dJ/dt and the gradient of manipulability against finite differences."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.chain import chain_of
from kinematics.derivatives import hessian, jacobian_derivative
from kinematics.errors import InvalidOption, WrongConfiguration
from kinematics.jacobian import ReferenceFrame, jacobian, task_jacobian
from kinematics.manipulability import manipulability_gradient
from kinematics.task import TASKS
from kinematics.velocity import joint_velocities
from robots.robot import robot_from_urdf
from robots.shipped import shipped_robot

ROBOTS = ["scara", "stanford", "pa10", "kinova", "talos_arm", "tiago_no_hand", "planar_8r", "pr2"]


def sampled(robot, seed, n=1):
    rng = np.random.default_rng(seed)
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return rng.uniform(low, high, (n, robot.dof)), rng.uniform(-2, 2, (n, robot.dof))


def difference(function, q, direction, h=2e-3):
    """Central difference of order eight along a direction: its error is far below 1e-10."""
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    return sum(
        weight * (function(q + k * h * direction) - function(q - k * h * direction)) / h
        for k, weight in weights.items()
    )


def assert_close(found, expected, relative=1e-9):
    scale = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(found, expected, atol=relative * scale, rtol=0)


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("reference_frame", list(ReferenceFrame))
def test_hessian_is_the_derivative_of_the_jacobian(name, reference_frame):
    robot = shipped_robot(name)
    q = sampled(robot, 1)[0][0]
    H = hessian(robot, q, None, reference_frame)
    for k, unit in enumerate(np.eye(robot.dof)):
        expected = difference(lambda x: jacobian(robot, x, None, reference_frame), q, unit)
        assert_close(H[:, :, k], expected)


@pytest.mark.parametrize("reference_frame", list(ReferenceFrame))
def test_hessian_from_one_branch_to_another(reference_frame):
    text = shipped_robot("baxter").urdf
    robot = robot_from_urdf(text, base="left_gripper", tip="right_gripper")
    q, qd = (x[0] for x in sampled(robot, 2))
    H = hessian(robot, q, None, reference_frame)
    moving = chain_of(robot, "right_gripper").columns
    for k in moving:
        unit = np.eye(robot.dof)[k]
        expected = difference(lambda x: jacobian(robot, x, None, reference_frame), q, unit)
        assert_close(H[:, :, k], expected)
    rest = np.setdiff1d(np.arange(robot.dof), moving)
    assert not H[:, rest].any()
    assert not H[:, :, rest].any()
    assert_close(jacobian_derivative(robot, q, qd, None, reference_frame), H @ qd, 1e-12)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(ROBOTS),
    st.sampled_from(list(ReferenceFrame)),
    st.integers(0, 10**6),
    st.data(),
)
def test_derivative_along_a_motion(name, reference_frame, seed, data):
    robot = shipped_robot(name)
    frame = data.draw(st.sampled_from(robot.frames))
    q, qd = (x[0] for x in sampled(robot, seed))
    Jd = jacobian_derivative(robot, q, qd, frame, reference_frame)
    expected = difference(lambda x: jacobian(robot, x, frame, reference_frame), q, qd)
    assert_close(Jd, expected, 1e-8)
    assert_close(Jd, hessian(robot, q, frame, reference_frame) @ qd, 1e-12)


@pytest.mark.parametrize("reference_frame", list(ReferenceFrame))
def test_batches_are_the_single_ones_stacked(reference_frame, monkeypatch):
    monkeypatch.setattr("kinematics.derivatives._NUMBERS_AT_ONCE", 1500)
    robot = shipped_robot("tiago_no_hand")
    q, qd = sampled(robot, 3, 7)
    H = hessian(robot, q, None, reference_frame)
    Jd = jacobian_derivative(robot, q, qd, None, reference_frame)
    at_one = jacobian_derivative(robot, q[0], qd, None, reference_frame)
    for k in range(7):
        assert_close(H[k], hessian(robot, q[k], None, reference_frame), 1e-12)
        assert_close(Jd[k], H[k] @ qd[k], 1e-12)
        assert_close(at_one[k], H[0] @ qd[k], 1e-12)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(ROBOTS),
    st.sampled_from(["pose", "position", "xy", "xy_phi", "orientation"]),
    st.integers(0, 10**6),
)
def test_gradient_of_manipulability(name, task, seed):
    robot = shipped_robot(name)
    q = sampled(robot, seed)[0][0]
    rows = list(TASKS[task].rows)

    def w(x):
        return np.prod(np.linalg.svd(jacobian(robot, x)[rows], compute_uv=False))

    found = manipulability_gradient(robot, q, TASKS[task])
    assert found.manipulability == pytest.approx(w(q), rel=1e-12, abs=1e-15)
    if not found.differentiable or found.manipulability < 1e-3:
        return
    for k, unit in enumerate(np.eye(robot.dof)):
        expected = difference(w, q, unit, h=1e-4)
        assert found.gradient[k] == pytest.approx(expected, rel=1e-7, abs=1e-8)


def test_gradient_at_singularities_is_finite_and_flagged():
    robot = shipped_robot("puma560")
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.0, 0.6])
    at = manipulability_gradient(robot, q)
    assert not at.differentiable
    assert not at.gradient.any()
    assert at.determinant == pytest.approx(0, abs=1e-15)
    unit = np.eye(6)[4]
    slope = difference(lambda x: np.linalg.det(jacobian(robot, x)), q, unit)
    np.testing.assert_allclose(at.determinant_gradient, slope * unit, atol=1e-12)
    for distance in (1e-3, 1e-6, 1e-9):
        near = manipulability_gradient(robot, q + distance * unit)
        assert near.differentiable
        assert near.gradient[4] == pytest.approx(abs(slope), rel=1e-5)
    # Wrist and elbow at once: the determinant has no slope, and nothing divides by zero.
    doubly = manipulability_gradient(shipped_robot("pa10"), np.zeros(7))
    assert np.isfinite(doubly.gradient).all()


def test_gradient_batches_and_refusals():
    robot = shipped_robot("stanford")
    q = sampled(robot, 5, 6)[0]
    many = manipulability_gradient(robot, q)
    for k, row in enumerate(q):
        one = manipulability_gradient(robot, row)
        np.testing.assert_allclose(many.gradient[k], one.gradient, atol=1e-12)
        assert many.determinant[k] == pytest.approx(np.linalg.det(jacobian(robot, row)), rel=1e-10)
        assert many.determinant_gradient[k] == pytest.approx(one.determinant_gradient, abs=1e-12)
    with pytest.raises(InvalidOption):
        manipulability_gradient(robot, q, tolerance=2)
    with pytest.raises(WrongConfiguration, match="qd"):
        jacobian_derivative(robot, q, np.zeros(3))


@pytest.mark.parametrize("name", ["puma560", "panda", "ur5"])
@pytest.mark.parametrize("task", ["direction", "position_direction"])
def test_tasks_in_the_frames_own_axes(name, task):
    """No turn about the frame's own z changes anything, and the gradient is that of w."""
    robot, task, rng = shipped_robot(name), TASKS[task], np.random.default_rng(3)
    q = rng.uniform(-1, 1, robot.dof)
    found, step = manipulability_gradient(robot, q, task), 1e-5
    for k in range(robot.dof):
        ahead, behind = q.copy(), q.copy()
        ahead[k] += step
        behind[k] -= step
        change = (
            manipulability_gradient(robot, ahead, task).manipulability
            - manipulability_gradient(robot, behind, task).manipulability
        )
        assert found.gradient[k] == pytest.approx(change / (2 * step), rel=1e-6, abs=1e-8)
    last = q.copy()
    last[-1] += 1.0  # the tip's z is the last axis
    turned = manipulability_gradient(robot, last, task).manipulability
    assert turned == pytest.approx(found.manipulability, abs=1e-12)
    wanted = rng.uniform(-1, 1, len(task.rows))
    moved = joint_velocities(robot, q, wanted, task)
    np.testing.assert_allclose(task_jacobian(robot, q, task) @ moved.qd, wanted, atol=1e-9)
