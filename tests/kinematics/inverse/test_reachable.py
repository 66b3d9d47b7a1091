"""What of a pose is within reach where the whole is not: against SLSQP on Pinocchio's poses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from dh_to_urdf import read_mapping
from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse import IKOptions, Tolerance
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.motion_of_many import ManyPoses
from kinematics.inverse.reachable import GivenUp, reachable_parts
from kinematics.inverse.unreached import why_unreached
from kinematics.jacobian import jacobian
from kinematics.task import POSE, TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot

HALF = np.pi / 2


def joint(name, kind="R", lower=-2.6, upper=2.6, **numbers):
    row = {"name": name, "type": kind, "a": 0.0, "alpha": 0.0, **numbers}
    row.setdefault("d" if kind == "R" else "theta", 0.0)
    return {**row, "limits": {"lower": lower, "upper": upper}}


def five_axes():
    """A desk-top arm: base, shoulder, elbow, wrist pitch and roll."""
    return [
        joint("j1", alpha=-HALF, a=0.06, d=0.17),
        joint("j2", a=0.3, lower=-1.9, upper=0.8),
        joint("j3", alpha=HALF, a=0.04, lower=-1.2, upper=2.4),
        joint("j4", alpha=-HALF, d=0.22, lower=-1.8, upper=1.8),
        joint("j5", d=0.08, lower=-3.0, upper=3.0),
    ]


def four_axes():
    """A pick arm: base, shoulder, elbow, wrist pitch."""
    return [
        joint("j1", alpha=HALF, d=0.1),
        joint("j2", a=0.2, lower=-0.3, upper=2.2),
        joint("j3", a=0.2, lower=-2.4, upper=0.2),
        joint("j4", a=0.08, lower=-1.8, upper=1.8),
    ]


def palletiser():
    """A parallelogram keeps the flange level: its last pitch follows shoulder and elbow."""
    level = joint("level", alpha=HALF, a=0.1)
    level = {**{k: v for k, v in level.items() if k != "limits"}, "theta": "-q2-q3"}
    return [
        joint("j1", alpha=HALF, d=0.3),
        joint("j2", a=0.5, lower=-0.2, upper=1.9),
        joint("j3", a=0.5, lower=-2.2, upper=-0.1),
        level,
        joint("j4", d=-0.1, lower=-3.1, upper=3.1),
    ]


def robot_of(rows):
    return robot_from_table(read_mapping({"name": "arm", "convention": "standard", "joints": rows}))


ARMS = {
    "so101": lambda: shipped_robot("so101"),
    "five_axes": lambda: robot_of(five_axes()),
    "four_axes": lambda: robot_of(four_axes()),
    "palletiser": lambda: robot_of(palletiser()),
    "scara": lambda: shipped_robot("scara"),
}


def within(robot, random):
    return random.uniform(np.maximum(robot.lower, -3.2), np.minimum(robot.upper, 3.2))


def tool(robot, q):
    return fk(robot, q)[robot.tip_frame]


def turn(R):
    return Rotation.from_matrix(R).magnitude()


def best_by_slsqp(robot, target, random, starts):
    """The least orientation error at the position, from starts all over the limits."""
    best = np.inf

    def missed(q):
        return 10.0 * (tool(robot, q)[:3, 3] - target[:3, 3])

    def slope(q):
        return 10.0 * jacobian(robot, q)[:3]

    def unlike(q):
        return -np.trace(target[:3, :3].T @ tool(robot, q)[:3, :3])

    def unlike_slope(q):
        M = tool(robot, q)[:3, :3] @ target[:3, :3].T
        v = np.array([M[2, 1] - M[1, 2], M[0, 2] - M[2, 0], M[1, 0] - M[0, 1]])
        return v @ jacobian(robot, q)[3:]

    for _ in range(starts):
        found = minimize(
            unlike,
            within(robot, random),
            jac=unlike_slope,
            method="SLSQP",
            bounds=list(zip(robot.lower, robot.upper, strict=True)),
            constraints=[{"type": "eq", "fun": missed, "jac": slope}],
            options={"ftol": 1e-13, "maxiter": 200},
        )
        inside = np.clip(found.x, robot.lower, robot.upper)
        T = tool(robot, inside)
        if np.abs(T[:3, 3] - target[:3, 3]).max() < 1e-8:
            best = min(best, turn(target[:3, :3] @ T[:3, :3].T))
    return best


def compare(name, targets, starts, seed):
    robot, random = ARMS[name](), np.random.default_rng(seed)
    for _ in range(targets):
        target = tool(robot, within(robot, random))
        target[:3, :3] = Rotation.random(random_state=random).as_matrix() @ target[:3, :3]
        parts = reachable_parts(robot, target, task=POSE, tolerance=Tolerance())
        assert parts
        for one in parts:
            T = tool(robot, one.q)
            assert ((one.q >= robot.lower) & (one.q <= robot.upper)).all()
            assert np.linalg.norm(T[:3, 3] - target[:3, 3]) < 1e-8
            error = turn(target[:3, :3] @ T[:3, :3].T)
            assert one.orientation_error == pytest.approx(error, abs=1e-7)
            assert GivenUp.POSITION not in one.given_up
        errors = [one.orientation_error for one in parts]
        assert errors == sorted(errors)
        assert errors[0] < best_by_slsqp(robot, target, random, starts) + 1e-6


@pytest.mark.parametrize("name", ARMS)
def test_no_better_orientation_at_the_position(name):
    compare(name, 5, 6, 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_no_better_orientation_at_20_positions(name):
    compare(name, 20, 12, 2)


@pytest.mark.parametrize("name", ARMS)
def test_a_pose_within_reach_comes_whole(name):
    robot, random = ARMS[name](), np.random.default_rng(3)
    for _ in range(5):
        target = tool(robot, within(robot, random))
        best = reachable_parts(robot, target, task=POSE, tolerance=Tolerance())[0]
        assert best.given_up == ()
        if not chain_of(robot, robot.tip_frame).is_coupled:
            assert any(one.within_limits for one in all_solutions(robot, target).solutions)


def test_the_direction_of_the_tool_alone():
    """Turned about its own axis, a reachable pose is reached but for that turn."""
    robot, random, tried = ARMS["five_axes"](), np.random.default_rng(4), 0
    # The roll about the tool's axis is the last joint: beyond its limits it is given up.
    while tried < 5:
        q = within(robot, random)
        target = tool(robot, q)
        roll = Rotation.from_rotvec([0.0, 0.0, 3.05 - q[4]]).as_matrix()
        target[:3, :3] = target[:3, :3] @ roll
        parts = reachable_parts(robot, target, task=POSE, tolerance=Tolerance())
        if not parts[0].given_up:
            continue
        tried += 1
        alone = [one for one in parts if one.given_up == (GivenUp.ROTATION,)]
        assert alone
        for one in alone:
            T = tool(robot, one.q)
            np.testing.assert_allclose(T[:3, 2], target[:3, 2], atol=1e-7)
            assert one.direction_error < 1e-6
            assert abs(one.rotation_error) == pytest.approx(one.orientation_error, abs=1e-6)


def test_a_direction_is_missed_by_its_angle():
    robot, random = ARMS["four_axes"](), np.random.default_rng(5)
    task = TASKS["position_direction"]
    target = tool(robot, within(robot, random))
    target[:3, :3] = Rotation.from_euler("xyz", [0.4, 0.5, 0.6]).as_matrix() @ target[:3, :3]
    parts = reachable_parts(robot, target, task=task, tolerance=Tolerance())
    assert parts[0].given_up == (GivenUp.DIRECTION,)
    assert parts[0].rotation_error is None
    T = tool(robot, parts[0].q)
    angle = np.arccos(np.clip(T[:3, 2] @ target[:3, 2], -1, 1))
    assert parts[0].orientation_error == pytest.approx(angle, abs=1e-7)


def test_out_of_reach_comes_as_near_as_it_can():
    robot = ARMS["four_axes"]()
    target = tool(robot, np.array([0.3, 0.6, -0.4, 0.2]))
    target[:3, 3] *= 4.0
    (best,) = reachable_parts(robot, target, task=POSE, tolerance=Tolerance())
    assert GivenUp.POSITION in best.given_up
    least = min(
        minimize(
            lambda q: np.linalg.norm(tool(robot, q)[:3, 3] - target[:3, 3]),
            within(robot, np.random.default_rng(k)),
            bounds=list(zip(robot.lower, robot.upper, strict=True)),
        ).fun
        for k in range(8)
    )
    assert best.position_error < least + 1e-6


def test_reasons_tell_it():
    robot = ARMS["five_axes"]()
    target = tool(robot, np.full(5, 0.2))
    target[:3, :3] = Rotation.from_euler("xyz", [0.4, -0.5, 0.6]).as_matrix() @ target[:3, :3]
    why = why_unreached(robot, target, task=POSE, options=IKOptions())
    assert why.reachable[0].orientation_error == pytest.approx(
        why.forbidden.orientation_miss, abs=1e-4
    )
    degrees = f"{np.rad2deg(why.reachable[0].orientation_error):.6g}°"
    assert any(degrees in str(one) for one in why.sentences)


@pytest.mark.parametrize("name", ARMS)
def test_derivatives_against_differences(name):
    robot, random = ARMS[name](), np.random.default_rng(6)
    chain = chain_of(robot, robot.tip_frame)
    q = random.uniform(-1.0, 1.0, (4, chain.dof))
    B, along = random.normal(size=(3, 3)), random.normal(size=(4, 3))
    here, step = ManyPoses.at(chain, q), 1e-6

    def slope(poses):
        return poses.trace_gradient(B) + np.einsum("nk,nki->ni", along, poses.jacobian())

    for k in range(chain.dof):
        d = step * np.eye(chain.dof)[k]
        up, down = ManyPoses.at(chain, q + d), ManyPoses.at(chain, q - d)
        by_difference = (up.position - down.position) / (2 * step)
        np.testing.assert_allclose(here.jacobian()[:, :, k], by_difference, atol=1e-8)
        by_difference = (up.trace(B) - down.trace(B)) / (2 * step)
        np.testing.assert_allclose(here.trace_gradient(B)[:, k], by_difference, atol=1e-8)
        by_difference = (slope(up) - slope(down)) / (2 * step)
        second = here.second_derivative(B, along)[:, k]
        np.testing.assert_allclose(second, by_difference, atol=1e-7)
