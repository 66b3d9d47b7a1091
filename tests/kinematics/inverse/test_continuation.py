"""All solutions by continuation: nothing missing, nothing false, against configurations that are
known, closed forms, a published arm and Pinocchio's poses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from dh_to_urdf import read_mapping
from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, solve_ik
from kinematics.inverse.all_solutions import all_solutions, exact_solutions
from kinematics.inverse.closed_form import closed_form_of, solutions
from kinematics.inverse.continuation.fibre import fibre_of, moved_fibre
from kinematics.inverse.continuation.real import chain_fibre, real_solutions
from kinematics.jacobian import jacobian
from kinematics.task import POSE, TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot

QUARTERS = (0.0, np.pi / 2, -np.pi / 2, np.pi / 3, np.pi)
LENGTHS = (0.0, 0.0, 0.2, 0.4, 0.7)
# Kinova JACO 2, xArm 6, CRX-10iA, Gen3 lite: makers' lengths, m; a wrist that is no sphere.
JACO2 = (
    [0, 0.41, 0, 0, 0, 0],
    [1, 2, 1, 0.611, 0.611, 2],
    [0.2755, 0, -0.0098, -0.2502, -0.0858, -0.2116],
)
CRX = ([0, 0.54, 0, 0, 0, 0], [-1, 2, -1, 1, -1, 0], [0, 0, 0, -0.54, 0.15, -0.16])
XARM6 = ([0, 0.28949, 0.0775, 0, 0.076, 0], [-1, 0, -1, 1, -1, 0], [0.267, 0, 0, 0.3425, 0, 0.097])
GEN3_LITE = (
    [0, 0.28, 0, 0, 0, 0],
    [1, 2, 1, 1, 1, 0],
    [0.2433, 0.03, 0.02, 0.245, 0.057, 0.235],
)
ARMS = {"jaco2": JACO2, "crx": CRX, "xarm6": XARM6, "gen3_lite": GEN3_LITE}


def robot_of(a, alpha, d, *, types=None, limits=None, convention="standard"):
    """Return a robot of a table, its alphas in rad."""
    types = types or ["R"] * len(a)
    joints = []
    for k, kind in enumerate(types):
        row = {"name": f"j{k + 1}", "type": kind, "a": float(a[k]), "alpha": float(alpha[k])}
        row["d" if kind == "R" else "theta"] = float(d[k])
        if limits is not None:
            row["limits"] = {"lower": -limits, "upper": limits}
        elif kind == "P":
            row["limits"] = {"lower": -50.0, "upper": 50.0}
        joints.append(row)
    table = read_mapping({"name": "arm", "convention": convention, "joints": joints})
    return robot_from_table(table)


def named_arm(name, **options):
    a, quarters, d = ARMS[name]
    return robot_of(a, np.array(quarters) * np.pi / 2, d, **options)


def apart(robot, q, other):
    difference = np.where(
        [joint.type.is_revolute for joint in robot.joints],
        (q - other + np.pi) % (2 * np.pi) - np.pi,
        q - other,
    )
    return float(np.abs(difference).max())


def holds(robot, found, q, within=1e-6):
    return any(apart(robot, one.q, q) < within for one in found.solutions)


def pose_by_hand(a, alpha, d, q, types=None):
    """Return the product of the textbook's matrices of a standard table."""
    T = np.eye(4)
    for k, value in enumerate(q):
        slides = types is not None and types[k] == "P"
        theta, shift = (d[k], value) if slides else (value, d[k])
        c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha[k]), np.sin(alpha[k])
        T = T @ np.array(
            [
                [c, -s * ca, s * sa, a[k] * c],
                [s, c * ca, -c * sa, a[k] * s],
                [0, sa, ca, shift],
                [0, 0, 0, 1],
            ]
        )
    return T


def check(robot, found, target, table, types=None):
    """Every solution reaches the target, by hand, and none comes twice."""
    for k, one in enumerate(found.solutions):
        reached = pose_by_hand(*table, one.q, types)
        np.testing.assert_allclose(reached, target, atol=1e-8)
        assert all(apart(robot, one.q, other.q) > 1e-6 for other in found.solutions[:k])


@pytest.mark.parametrize("seed", range(12))
def test_random_arms_have_all_solutions(seed):
    """In general position, with right angles and zeros, and with slides."""
    rng = np.random.default_rng(seed)
    kind, tried = seed % 3, 0
    while tried < 3:
        types = ["R"] * 6
        if kind == 0:
            table = rng.uniform(-1, 1, 6), rng.uniform(-np.pi, np.pi, 6), rng.uniform(-1, 1, 6)
        else:
            table = rng.choice(LENGTHS, 6), rng.choice(QUARTERS, 6), rng.choice(LENGTHS, 6)
        if kind == 2:
            types = list(rng.choice(["R", "P"], 6, p=[0.75, 0.25]))
        robot = robot_of(*table, types=types)
        if exact_solutions(robot, np.eye(4)) is None:
            continue
        tried += 1
        for q in rng.uniform(-3, 3, (6, 6)):
            target = pose_by_hand(*table, q, types)
            found = all_solutions(robot, target)
            assert found.complete
            assert holds(robot, found, q, 1e-5)
            check(robot, found, target, table, types)


def test_the_published_arm_has_its_sixteen_solutions():
    """R. Manseur and K. Doty, A robot manipulator with 16 real inverse kinematic solution sets,
    International Journal of Robotics Research 8(5), 1989; target as printed, made orthogonal."""
    table = (
        [0.3, 1, 0, 1.5, 0, 0],
        np.deg2rad([90, 1, 90, 1, 90, 1]),
        [0, 0, 0.2, 0, 0, 0],
    )
    target = np.array(
        [
            [-0.760117, -0.641689, 0.102262, -1.140175],
            [0.133333, 0, 0.991071, 0],
            [-0.635959, 0.766965, 0.085558, 0],
            [0, 0, 0, 1],
        ]
    )
    u, _, v = np.linalg.svd(target[:3, :3])
    target[:3, :3] = u @ v
    robot = robot_of(*table)
    found = all_solutions(robot, target)
    assert found.complete
    assert len(found.solutions) == 16
    check(robot, found, target, table)


@pytest.mark.parametrize("limits", [None, np.pi, 3.14159265, 2.0])
@pytest.mark.parametrize("name", ARMS)
def test_wrists_that_are_no_spheres(name, limits):
    """Limits of a hair under a turn are no walls: solutions beyond them are given too."""
    rng = np.random.default_rng(3)
    robot = named_arm(name, limits=limits)
    table = ARMS[name][0], np.array(ARMS[name][1]) * np.pi / 2, ARMS[name][2]
    for q in rng.uniform(-2, 2, (15, 6)):
        target = pose_by_hand(*table, q)
        found = all_solutions(robot, target)
        assert found.method == "algebraic"
        assert found.complete
        assert any(one.within_limits and apart(robot, one.q, q) < 1e-6 for one in found.solutions)
        check(robot, found, target, table)


def test_many_starts_find_nothing_else():
    rng = np.random.default_rng(7)
    for name in ARMS:
        robot = named_arm(name)
        target = fk(robot, rng.uniform(-2, 2, 6))[robot.tip_frame]
        found = all_solutions(robot, target)
        once = IKOptions(max_restarts=0)
        for seed in rng.uniform(-np.pi, np.pi, (150, 6)):
            result = solve_ik(robot, target, seed=seed, options=once)
            if result.status is IKStatus.CONVERGED:
                assert holds(robot, found, result.q, 1e-3)


@pytest.mark.parametrize("name", ["puma560", "ur5", "stanford", "kr6_r900", "scara", "planar_3r"])
def test_closed_forms_agree(name):
    robot, rng = shipped_robot(name), np.random.default_rng(11)
    chain = chain_of(robot, robot.tip_frame)
    form = closed_form_of(chain)
    task = TASKS[form.tasks[0]]
    fibre = chain_fibre(chain, task)
    for _ in range(20):
        q = rng.uniform(-2, 2, robot.dof)
        target = fk(robot, q)[robot.tip_frame]
        ours = real_solutions(fibre, chain, task, target, np.zeros(robot.dof))
        theirs = solutions(form, chain, target, task=task).q
        assert ours.is_complete
        assert len(ours.solutions) == len(theirs)
        for one in theirs:
            assert min(apart(robot, one, other.q) for other in ours.solutions) < 1e-6


@pytest.mark.parametrize("name", ["jaco2", "crx"])
def test_where_two_solutions_meet(name):
    """On the way between two joint positions where the Jacobian's determinant changes its sign."""
    robot, rng = named_arm(name), np.random.default_rng(5)
    tried = 0
    while tried < 12:
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
        there = [one for one in found.solutions if apart(robot, one.q, q) < 2e-3]
        assert sum(one.multiplicity for one in there) > 1 or any(one.free for one in there)


def test_a_family_of_solutions_is_shown_at_the_seed():
    """Two axes of the wrist in line: what the fourth joint gains, the sixth loses."""
    robot = shipped_robot("puma560")
    chain = chain_of(robot, robot.tip_frame)
    q = np.array([0.3, 0.4, -0.5, 0.7, 0.0, 0.2])
    target = fk(robot, q)[robot.tip_frame]
    fibre = chain_fibre(chain, POSE)
    found = real_solutions(fibre, chain, POSE, target, q)
    family = [one for one in found.solutions if one.free.any()]
    assert any(apart(robot, one.q, q) < 1e-6 for one in family)
    assert all(list(np.flatnonzero(one.free)) == [3, 5] for one in family)


@pytest.mark.parametrize(
    ("task", "joints"),
    [("pose", 5), ("pose", 4), ("pose", 3), ("position", 3), ("position_direction", 5)],
)
def test_fewer_joints(task, joints):
    rng, tried = np.random.default_rng(joints), 0
    while tried < 4:
        lengths, angles = rng.uniform(0.2, 1, joints), rng.choice(QUARTERS[1:], joints)
        robot = robot_of(lengths, angles, rng.uniform(0, 0.5, joints))
        if exact_solutions(robot, np.eye(4), task=TASKS[task]) is None:
            continue
        tried += 1
        for q in rng.uniform(-3, 3, (6, joints)):
            found = all_solutions(robot, fk(robot, q)[robot.tip_frame], task=TASKS[task])
            assert found.complete
            assert holds(robot, found, q, 1e-5)


def test_out_of_reach_is_none_and_complete():
    robot = named_arm("jaco2")
    target = np.eye(4)
    target[:3, 3] = 5.0
    found = all_solutions(robot, target)
    assert found.complete
    assert found.solutions == ()


def test_another_general_target_has_as_many_solutions():
    chain = chain_of(named_arm("crx"), "tool")
    fibre = chain_fibre(chain, POSE)
    assert fibre.degree == fibre_of(fibre.system, 1).degree == moved_fibre(fibre, 2).degree == 16


def test_arms_without_a_general_target_have_none():
    """Four parallel axes turn in one plane: no six joints with them reach a general pose."""
    robot = robot_of([0.3] * 6, [0, 0, 0, np.pi / 2, 0, 0], [0.1] * 6)
    assert exact_solutions(robot, np.eye(4)) is None
