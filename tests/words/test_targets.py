"""Names of postures, limits that are touched, and why a target is not reached."""

import logging
import re
from dataclasses import replace

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, solve_ik
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.closed_form import closed_form_of
from kinematics.inverse.orientations import orientation_gap
from kinematics.inverse.unreached import why_unreached
from kinematics.task import TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot
from tests.words.arms import (
    CONVENTIONS,
    arm_from,
    axes_of,
    placement,
    random_arm,
    wrist_arm,
)


def above(h, line, elbow):
    """Whether a point is above a line seen along h, with z up, else y, else x."""
    n = np.cross(h, line)
    for k in (2, 1, 0):
        if abs(n[k]) > 1e-9 * np.linalg.norm(n):
            return bool((elbow @ n) * n[k] >= 0)
    return True


def elbow_of(kind, axes, names):
    """Direction, line from shoulder to wrist, and elbow of one configuration."""
    Z, O = axes.Z[0], axes.O[0]
    if kind in ("planar_2r", "planar_3r", "scara"):
        turning = np.flatnonzero(axes.turns)
        end = O[turning[2]] if len(turning) > 2 else axes.T[0, :3, 3]
        first, second = turning[:2]
        return Z[first], end - O[first], O[second] - O[first]
    if kind == "parallel_axes":
        return Z[1], O[3] - O[1], O[2] - O[1]
    wrist = axes.T[0, :3, 3]
    if kind == "spherical_wrist":
        n = np.cross(Z[3], Z[4])
        along = np.cross(O[4] - O[3], Z[4]) @ n / (n @ n)
        wrist = O[3] + along * Z[3]
    turning = np.flatnonzero(axes.turns[:3])
    first, second = turning[:2] if names[0] in ("up", "down") else turning[1:3]
    return Z[first], wrist - O[first], O[second] - O[first]


def check_names(robot, q):
    """Check the names of all solutions of the target at q; return how many there are."""
    form = closed_form_of(chain_of(robot, robot.tip_frame))
    if form is None:
        return 0
    task = TASKS[form.tasks[0]]
    found = all_solutions(robot, fk(robot, q)["tool"], task=task)
    assert found.method == "closed_form"
    names = [(one.posture, one.swivel) for one in found.solutions]
    assert len(set(names)) == len(names), (form.description, names)
    for one in found.solutions:
        reached = fk(robot, one.q)["tool"]
        rows = list(task.positions)
        np.testing.assert_allclose(reached[rows, 3], fk(robot, q)["tool"][rows, 3], atol=1e-8)
        if "up" in one.posture or "down" in one.posture:
            found_at = elbow_of(form.kind, axes_of(robot, one.q[None]), one.posture)
            h, line, elbow = found_at
            side = abs(elbow @ np.cross(h, line))
            if side > 1e-6:
                assert above(h, line, elbow) == ("up" in one.posture), (form.description, one)
    return len(found.solutions)


@pytest.mark.parametrize("number", range(60))
def test_names_of_postures(number):
    robot = random_arm(number)
    generator = np.random.default_rng(number)
    for _ in range(4):
        turns = generator.uniform(-3.1, 3.1, robot.dof)
        check_names(robot, np.where(robot.is_revolute, turns, generator.uniform(-0.4, 0.4)))


@pytest.mark.parametrize("number", range(60))
def test_names_of_postures_of_arms_with_a_wrist(number):
    """Three joints of any kind before it, so that every way to solve them comes."""
    generator = np.random.default_rng(50_000 + number)
    convention = CONVENTIONS[number % 3]
    robot = arm_from(wrist_arm(generator, convention), convention, placement(generator))
    for _ in range(3):
        turns = generator.uniform(-3.1, 3.1, robot.dof)
        check_names(robot, np.where(robot.is_revolute, turns, generator.uniform(-0.4, 0.4)))


@pytest.mark.slow
def test_names_of_postures_of_200_arms():
    total = 0
    for number in range(200):
        robot = random_arm(number)
        generator = np.random.default_rng(1000 + number)
        for _ in range(10):
            turns = generator.uniform(-3.1, 3.1, robot.dof)
            q = np.where(robot.is_revolute, turns, generator.uniform(-0.4, 0.4))
            total += check_names(robot, q)
    logging.getLogger(__name__).info(f"{total} solutions of 200 arms named")
    assert total > 5000


@pytest.mark.parametrize("name", ["ur5", "puma560", "planar_2r", "scara", "kr6_r900", "z1"])
def test_names_of_shipped_arms(name):
    robot = shipped_robot(name)
    if robot.table is None:
        robot = shipped_robot("ur10e")
    generator = np.random.default_rng(0)
    low, high = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
    for q in generator.uniform(low, high, (20, robot.dof)):
        assert check_names(robot, q) > 1


def scara(upper=0.01):
    """A SCARA whose slide goes from 0 to a limit."""
    rows = [
        {"type": "R", "alpha": 0, "a": 0.325, "d": 0.387},
        {"type": "R", "alpha": np.pi, "a": 0.275, "d": 0},
        {"type": "P", "alpha": 0, "a": 0, "theta": 0, "limits": {"lower": 0, "upper": upper}},
        {"type": "R", "alpha": 0, "a": 0, "d": 0.1},
    ]
    return robot_from_table(read_mapping({"name": "s", "convention": "standard", "joints": rows}))


def test_a_limit_that_is_touched_is_met():
    robot = scara()
    q = np.array([0.3, 0.5, 0.01, 0.2])
    found = all_solutions(robot, fk(robot, q)["tool"], task=TASKS["xyz_phi"])
    assert [one.within_limits for one in found.solutions] == [True, True]
    assert all(one.q[2] == 0.01 for one in found.solutions)
    assert min(np.abs(one.q - q).max() for one in found.solutions) < 1e-9
    beyond = all_solutions(scara(0.009), fk(robot, q)["tool"], task=TASKS["xyz_phi"])
    assert not any(one.within_limits for one in beyond.solutions)


@pytest.mark.parametrize("seed", range(40))
def test_solutions_of_poses_on_limits_are_within_them(seed):
    """Limits put on random values of an arm: the configuration on all of them is found within."""
    generator = np.random.default_rng(seed)
    name = ("puma560", "ur5", "scara", "stanford", "planar_3r")[seed % 5]
    table = shipped_robot(name).table
    q = generator.uniform(-1.2, 1.2, table.dof)
    rows = list(table.rows)
    for k, value in enumerate(q):
        low, high = sorted((float(value), float(value + generator.choice([-2.0, 2.0]))))
        rows[k] = replace(rows[k], limits=replace(rows[k].limits, lower=low, upper=high))
    robot = robot_from_table(replace(table, rows=tuple(rows)))
    form = closed_form_of(chain_of(robot, "tool"))
    found = all_solutions(robot, fk(robot, q)["tool"], task=TASKS[form.tasks[0]])
    within = [one for one in found.solutions if one.within_limits]
    assert min((np.abs(one.q - q).max() for one in within), default=1) < 1e-6
    for one in within:
        assert (one.q >= robot.lower).all()
        assert (one.q <= robot.upper).all()


def test_a_planar_arm_placed_by_position():
    rows = [("R", 0.0, 1.0, 0.0, 0.0, 1)] * 2
    robot = arm_from(rows)
    for task in ("xy", "position"):
        target = np.eye(4)
        found = all_solutions(robot, target, task=TASKS[task])
        assert found.method == "closed_form"
        assert found.complete
        assert [one.free for one in found.solutions] == [("j1",)]
        target[0, 3] = -2.0
        found = all_solutions(robot, target, task=TASKS[task])
        assert len(found.solutions) == 1
        np.testing.assert_allclose(np.abs(found.solutions[0].q), [np.pi, 0], atol=1e-7)
    target[2, 3] = 0.1
    assert not all_solutions(robot, target, task=TASKS["position"]).solutions


def test_a_joint_that_does_nothing_is_named():
    """A 3R arm whose end is on axis 1."""
    rows = [("R", np.pi / 2, 0.0, 0.3, 0.0, 1), ("R", 0.0, 0.4, 0.0, 0.0, 1)]
    rows += [("R", 0.0, 0.4, 0.0, 0.0, 1)]
    robot = arm_from(rows)
    target = np.eye(4)
    target[2, 3] = 0.8
    found = all_solutions(robot, target, task=TASKS["position"])
    assert found.method == "closed_form"
    assert {one.free for one in found.solutions} == {("j1",)}
    assert len(found.solutions) == 2
    assert all(abs(one.q[0] - found.seed[0]) < 1e-12 for one in found.solutions)


def rotation_error(robot, q, target):
    R = fk(robot, q)["tool"][..., :3, :3]
    cosine = (np.einsum("...ij,ij->...", R, target[:3, :3]) - 1) / 2
    return np.arccos(np.clip(cosine, -1, 1))


@pytest.mark.parametrize("number", range(60))
def test_what_the_structure_cannot_turn_to(number):
    robot = random_arm(5 * number + 4)  # of any joints, from three to six
    generator = np.random.default_rng(number)
    zero = axes_of(robot, np.zeros((1, robot.dof)))
    axes, R0 = zero.Z[0][zero.turns], zero.T[0, :3, :3]
    q = generator.uniform(-3.1, 3.1, (3000, robot.dof))
    reached = fk(robot, q)["tool"][:, :3, :3]
    for R in reached[:20]:
        assert orientation_gap(axes, None, R @ R0.T)[0] < 1e-6
        assert orientation_gap(axes, R0[:, 2], R[:, 2])[0] < 1e-6
    for _ in range(10):
        h = generator.normal(size=3)
        h /= np.linalg.norm(h)
        K = np.array([[0, -h[2], h[1]], [h[2], 0, -h[0]], [-h[1], h[0], 0]])
        angle = generator.uniform(0, np.pi)
        target = np.eye(4)
        target[:3, :3] = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        gap, free = orientation_gap(axes, None, target[:3, :3] @ R0.T)
        assert rotation_error(robot, q, target).min() >= gap - 1e-6
        if gap == 0.0 and free <= 3:
            found = solve_ik(
                robot, target, task=TASKS["orientation"], options=IKOptions(time_budget=5.0)
            )
            if np.isinf(robot.lower).all():
                assert found.status is IKStatus.CONVERGED
        elif gap > 1e-3:
            why = why_unreached(robot, target, task=TASKS["orientation"], options=IKOptions())
            assert why.proven
            least = float(re.search(r"it ([\d.e-]+)°|by ([\d.e-]+)°", why.sentences[0])[2])
            assert np.deg2rad(least) == pytest.approx(gap, rel=1e-4)


def test_a_scara_cannot_point_elsewhere():
    robot = shipped_robot("scara")
    q = np.array([0.3, 0.5, 0.1, 0.2])
    target = np.eye(4)
    target[:3, 3] = fk(robot, q)["tool"][:3, 3]
    why = why_unreached(robot, target, task=TASKS["pose"], options=IKOptions())
    assert why.proven
    assert (
        "turns the frame about (0, 0, 1) only, and misses it by 180° at least" in (why.sentences[0])
    )
    assert why.sentences[1] == "the position alone is within reach (task position)"


def test_the_joint_beyond_its_limits_is_named():
    q = np.array([0.3, 0.5, 0.01, 0.2])
    robot = scara(0.009)
    target = fk(robot, q)["tool"]
    why = why_unreached(robot, target, task=TASKS["pose"], options=IKOptions())
    assert why.sentences == (
        "all 2 solutions are beyond the limits; the nearest to them has j3 at 0.01 m, its limit is"
        " 0.009 m",
    )
    target[:2, 3] *= 4
    why = why_unreached(robot, target, task=TASKS["pose"], options=IKOptions())
    assert "m long" in why.sentences[0]
