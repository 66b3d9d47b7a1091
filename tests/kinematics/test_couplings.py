"""Joints that depend on others, against Pinocchio's own mimic joints and J C by hand."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from dh_to_urdf import read_mapping
from kinematics.chain import chain_of
from kinematics.configuration import Given, configuration_by_name, joint_values_of
from kinematics.derivatives import hessian, jacobian_derivative
from kinematics.errors import WrongConfiguration
from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, solve_ik, solve_ik_batch
from kinematics.inverse.all_solutions import all_solutions
from kinematics.jacobian import ReferenceFrame, jacobian
from kinematics.manipulability import manipulability_gradient
from kinematics.nearest_singularity import nearest_singularity
from kinematics.singularity import singularity_report
from kinematics.skeleton import skeleton_of
from kinematics.task import TASKS
from robots.robot import robot_from_table, robot_from_urdf

LIMIT = '<limit lower="{}" upper="{}" effort="9" velocity="9"/>'
MIMIC = """<robot name="m"><link name="base"/><link name="one"/><link name="two"/><link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="9" velocity="9"/></joint>
<joint name="j2" type="revolute"><parent link="one"/><child link="two"/><origin xyz="1 0 0"/>
<axis xyz="0 0 1"/><limit lower="-3" upper="1" effort="9" velocity="4"/>
<mimic joint="j1" multiplier="-2"/></joint>
<joint name="end" type="fixed"><parent link="two"/><child link="tip"/><origin xyz="1 0 0"/></joint>
</robot>"""


def random_tree(rng, joints):
    """Return the URDF of a random tree, and the mimics of its followers by name.

    Leaders are joints before, free or followers; of one level, as Pinocchio reads them, where the
    seed says so.
    """
    links = ["l0"]
    text, free, mimics = ['<link name="l0"/>'], [], {}
    for k in range(joints):
        name, link = f"a{k:02d}", f"l{k + 1}"
        parent = links[-1] if rng.random() < 0.7 else str(rng.choice(links))
        links.append(link)
        slides = rng.random() < 0.3
        xyz = " ".join(map(repr, rng.uniform(-0.5, 0.5, 3).tolist()))
        rpy = " ".join(map(repr, rng.uniform(-3, 3, 3).tolist()))
        axis = rng.normal(size=3) if rng.random() < 0.5 else np.eye(3)[rng.integers(3)]
        axis = " ".join(map(repr, (axis / np.linalg.norm(axis)).tolist()))
        mimic = ""
        if free and rng.random() < 0.45:
            leader = str(rng.choice(free))
            multiplier, offset = float(rng.uniform(-2, 2)), float(rng.uniform(-1, 1))
            mimics[name] = leader, multiplier, offset
            mimic = f'<mimic joint="{leader}" multiplier="{multiplier!r}" offset="{offset!r}"/>'
        else:
            free.append(name)
        kind = "prismatic" if slides else "revolute"
        text.append(
            f'<link name="{link}"/><joint name="{name}" type="{kind}">'
            f'<parent link="{parent}"/><child link="{link}"/><origin xyz="{xyz}" rpy="{rpy}"/>'
            f'<axis xyz="{axis}"/>{LIMIT.format(-50, 50)}{mimic}</joint>'
        )
    return f'<robot name="tree">{"".join(text)}</robot>', free, mimics


@pytest.mark.parametrize("seed", range(300))
def test_a_random_tree_is_that_of_pinocchio_and_j_c_by_hand(seed):
    rng = np.random.default_rng(seed)
    text, free, mimics = random_tree(rng, int(rng.integers(2, 12)))
    robot = robot_from_urdf(text)
    assert [joint.name for joint in robot.joints] == free
    q, qd = rng.uniform(-1, 1, (2, robot.dof))
    frame = str(rng.choice(robot.frames))
    loose = robot_from_urdf(without_mimic(text))
    C = np.zeros((loose.dof, robot.dof))
    for k, joint in enumerate(loose.joints):
        leader, multiplier, _ = mimics.get(joint.name, (joint.name, 1.0, 0.0))
        C[k, free.index(leader)] = multiplier
    values = robot.joint_values(q)
    # Where Pinocchio wants a leader to come before in its own order, by hand alone.
    T, J = fk(loose, values, [frame])[frame], jacobian(loose, values, frame) @ C
    with suppress(ValueError):
        T, J = by_pinocchio(text, free, q, frame)
    for found in (fk(robot, q, [frame])[frame], fk(robot, q[None], [frame])[frame][0]):
        np.testing.assert_allclose(found, T, rtol=0, atol=1e-12)
    for found in (jacobian(robot, q, frame), jacobian(robot, q[None], frame)[0]):
        np.testing.assert_allclose(found, J, rtol=0, atol=1e-12)
    for axes in ReferenceFrame:
        expected = jacobian_derivative(loose, values, C @ qd, frame, axes) @ C
        found = jacobian_derivative(robot, q, qd, frame, axes)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
        H = np.einsum("xjk,jf,kg->xfg", hessian(loose, values, frame, axes), C, C)
        np.testing.assert_allclose(hessian(robot, q, frame, axes), H, rtol=0, atol=1e-12)
        np.testing.assert_allclose(found, H @ qd, rtol=0, atol=1e-11)
        both = hessian(robot, q[None], frame, axes)[0]
        np.testing.assert_allclose(both, H, rtol=0, atol=1e-12)


def by_pinocchio(text, free, q, frame):
    """Return pose and Jacobian of a frame, columns in the order of the free joints."""
    model = pin.buildModelFromXML(text, mimic=True)
    data = model.createData()
    assert model.nv == len(free)
    order = [model.joints[model.getJointId(name)].idx_v for name in free]
    full = np.empty(model.nv)
    full[order] = q
    pin.computeJointJacobians(model, data, full)
    pin.framesForwardKinematics(model, data, full)
    number = model.getFrameId(frame)
    J = pin.computeFrameJacobian(model, data, full, number, pin.LOCAL_WORLD_ALIGNED)
    return data.oMf[number].homogeneous, J.reshape(6, -1)[:, order]


def without_mimic(text):
    return re.sub(r"<mimic[^>]*/>", "", text)


def coupled_arm(seed, *, limits=True):
    """Return a random arm of a table with followers of followers, of slides, and couplings."""
    rng = np.random.default_rng(seed)
    rows = []
    for k in range(int(rng.integers(4, 9))):
        slides = rng.random() < 0.25
        row = {"type": "P" if slides else "R", "sign": int(rng.choice([-1, 1]))}
        row |= {"alpha": float(rng.choice([0, np.pi / 2, -np.pi / 2, rng.uniform(-2, 2)]))}
        row |= {"a": float(rng.uniform(0, 0.4)), "d": float(rng.uniform(-0.3, 0.3))}
        row |= {"theta": 0.0 if not slides else float(rng.uniform(-1, 1))}
        row["offset"] = float(rng.uniform(-1, 1))
        others = [f"j{i + 1}" for i in range(k)]
        if others and rng.random() < 0.4:
            row["mimic"] = {
                "joint": str(rng.choice(others)),
                "multiplier": float(rng.uniform(-1.5, 1.5)),
                "offset": float(rng.uniform(-0.2, 0.2)),
            }
        elif others and rng.random() < 0.5:
            chosen = rng.choice(others, size=min(len(others), 2), replace=False)
            row["coupling"] = {str(name): float(rng.choice([1, -1, 0.5])) for name in chosen}
        if limits and "coupling" not in row:
            row["limits"] = (
                {"lower": -2.0, "upper": 2.2} if not slides else {"lower": -0.4, "upper": 0.5}
            )
        elif limits and slides:
            row["limits"] = {"lower": -0.4, "upper": 0.5}
        rows.append(row)
    convention = ["standard", "modified"][seed % 2]
    return robot_from_table(read_mapping({"convention": convention, "joints": rows}))


def by_hand(robot, q):
    """Return the values of all joints from the rows, one after the other."""
    table, rows = robot.table, {row.name: row for row in robot.table.rows}
    free = dict(zip((joint.name for joint in robot.joints), q, strict=True))

    def coordinate(name):
        mimic = rows[name].mimic
        if mimic is None:
            return free[name]
        return mimic.multiplier * coordinate(mimic.joint) + mimic.offset

    return {
        row.name: coordinate(row.name) + sum(c * coordinate(n) for n, c in row.coupling)
        for row in table.rows
    }


@pytest.mark.parametrize("seed", range(60))
def test_a_coupled_table_is_the_mechanism_at_the_values_by_hand(seed):
    robot = coupled_arm(seed)
    rng = np.random.default_rng(seed)
    q = rng.uniform(-0.5, 0.5, robot.dof)
    values = by_hand(robot, q)
    found = joint_values_of(robot, q)
    assert list(found) == list(values)
    np.testing.assert_allclose(list(found.values()), list(values.values()), rtol=0, atol=1e-13)
    rows = tuple(replace(row, mimic=None, coupling=()) for row in robot.table.rows)
    loose = robot_from_table(replace(robot.table, rows=rows))
    full = np.array(list(values.values()))
    for frame in robot.frames:
        expected = fk(loose, full, [frame])[frame]
        np.testing.assert_allclose(fk(robot, q, [frame])[frame], expected, rtol=0, atol=1e-13)
    h = 1e-6
    C = np.array(
        [(np.array(list(by_hand(robot, q + h * e).values())) - full) / h for e in np.eye(robot.dof)]
    ).T
    J = jacobian(loose, full) @ C
    np.testing.assert_allclose(jacobian(robot, q), J, rtol=0, atol=1e-8)
    exact = robot.coupled.matrix
    np.testing.assert_allclose(jacobian(robot, q), jacobian(loose, full) @ exact, atol=1e-12)
    np.testing.assert_allclose(jacobian(robot, q[None])[0], jacobian(robot, q), atol=1e-12)
    # The URDF that it writes is the same robot, read as a file with <mimic>.
    read = robot_from_urdf(robot.urdf, tip="tool")
    assert [joint.name for joint in read.joints] == [joint.name for joint in robot.joints]
    assert [(j.lower, j.upper) for j in read.joints] == [(j.lower, j.upper) for j in robot.joints]
    np.testing.assert_allclose(fk(read, q)["tool"], fk(robot, q)["tool"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(jacobian(read, q), jacobian(robot, q), rtol=0, atol=1e-12)
    seen = skeleton_of(robot, q)
    np.testing.assert_allclose(seen.origins, skeleton_of(loose, full).origins, atol=1e-12)
    gradient = manipulability_gradient(robot, q, TASKS["position"])
    if robot.dof >= 3 and gradient.differentiable:
        w = [
            float(manipulability_gradient(robot, q + s * h * e, TASKS["position"]).manipulability)
            for e in np.eye(robot.dof)
            for s in (1, -1)
        ]
        slopes = (np.array(w[::2]) - np.array(w[1::2])) / (2 * h)
        np.testing.assert_allclose(gradient.gradient, slopes, rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("seed", range(40))
def test_ik_obeys_relations_and_limits_of_followers(seed):
    robot = coupled_arm(seed)
    rng = np.random.default_rng(seed)
    lower = np.where(np.isfinite(robot.lower), robot.lower, -1.0)
    upper = np.where(np.isfinite(robot.upper), robot.upper, 1.0)
    q = rng.uniform(lower, upper)
    target = fk(robot, q)["tool"]
    options = IKOptions(max_restarts=100)
    batch = solve_ik_batch(robot, target[None], options=options)
    for result in (solve_ik(robot, target, options=options),):
        assert result.status is IKStatus.CONVERGED
        np.testing.assert_array_equal(batch.q[0], result.q)
        np.testing.assert_allclose(fk(robot, result.q)["tool"], target, atol=3e-6)
        values, by_name = by_hand(robot, result.q), joint_values_of(robot, result.q)
        for row in robot.table.rows:
            assert abs(values[row.name] - by_name[row.name]) <= 1e-12
            if row.coupling or row.limits.lower is None:
                continue
            assert row.limits.lower - 1e-12 <= values[row.name] <= row.limits.upper + 1e-12
    seeded = solve_ik(robot, target, seed=q, options=options)
    assert np.abs(seeded.q - q).max() < 1e-9


def test_a_mechanism_of_one_degree_of_freedom():
    robot = robot_from_urdf(MIMIC)
    assert robot.dof == 1
    assert (robot.joints[0].lower, robot.joints[0].upper) == (-0.5, 1.5)
    assert robot.joints[0].velocity == 2.0
    q = np.array([0.3])
    loose = robot_from_urdf(without_mimic(MIMIC))
    full = jacobian(loose, np.array([0.3, -0.6]))
    np.testing.assert_allclose(
        jacobian(robot, q), full[:, :1] - 2 * full[:, 1:], rtol=0, atol=1e-15
    )
    target = np.eye(4)
    target[:3, 3] = 1.5, 0.2, 0.0
    result = solve_ik(robot, target, task=TASKS["xy"])
    assert result.status is not IKStatus.CONVERGED
    assert not all_solutions(robot, target, task=TASKS["xy"]).solutions


def test_a_fanuc_like_coupling_has_all_its_solutions_in_closed_form():
    puma = [
        {"type": "R", "alpha": math.pi / 2, "a": 0, "d": 0.67},
        {"type": "R", "alpha": 0, "a": 0.43, "d": 0},
        {"type": "R", "alpha": -math.pi / 2, "a": 0.02, "d": 0.15, "theta": "q3 + q2"},
        {"type": "R", "alpha": math.pi / 2, "a": 0, "d": 0.43},
        {"type": "R", "alpha": -math.pi / 2, "a": 0, "d": 0},
        {"type": "R", "alpha": 0, "a": 0, "d": 0.1},
    ]
    for row in puma:
        row["limits"] = {"lower": -2.9, "upper": 2.9}
    robot = robot_from_table(read_mapping({"convention": "standard", "joints": puma}))
    q = np.array([0.4, -0.3, 0.9, 0.2, -0.7, 0.5])
    target = fk(robot, q)["tool"]
    found = all_solutions(robot, target, seed=q)
    assert (found.method, found.complete) == ("closed_form", True)
    assert len(found.solutions) == 8
    np.testing.assert_allclose(found.solutions[0].q, q, atol=1e-9)
    for one in found.solutions:
        np.testing.assert_allclose(fk(robot, one.q)["tool"], target, rtol=0, atol=1e-9)
        inside = ((one.q >= robot.lower) & (one.q <= robot.upper)).all()
        assert one.within_limits == inside
    assert sum(one.within_limits for one in found.solutions) >= 2
    assert solve_ik(robot, target).status is IKStatus.CONVERGED


def test_a_fraction_of_an_angle_without_limits_does_not_wrap():
    rows = [
        {"type": "R", "alpha": 0, "a": 0, "d": 0},
        {"type": "R", "alpha": 0, "a": 1, "d": 0, "mimic": {"joint": "j1", "multiplier": 0.5}},
    ]
    document = {"convention": "modified", "tool": {"xyz": [1, 0, 0]}, "joints": rows}
    robot = robot_from_table(read_mapping(document))
    assert robot.is_periodic.tolist() == [False]
    assert chain_of(robot, "tool").is_periodic.tolist() == [False]
    q = np.array([5.0])
    target = fk(robot, q)["tool"]
    result = solve_ik(robot, target, task=TASKS["xy"])
    assert result.status is IKStatus.CONVERGED
    np.testing.assert_allclose(fk(robot, result.q)["tool"][:2, 3], target[:2, 3], atol=1e-5)


def test_singular_values_of_a_leader():
    robot = robot_from_urdf(MIMIC)
    found = nearest_singularity(robot, np.array([0.4]), TASKS["xy"])
    assert not found.singular or singularity_report(robot, np.array([0.4]), TASKS["xy"]).rank == 1


def test_followers_may_be_named_where_they_are_consistent():
    robot = robot_from_urdf(MIMIC)
    assert configuration_by_name(robot, {"j1": 0.3}).tolist() == [0.3]
    assert configuration_by_name(robot, {"j1": 0.3, "j2": -0.6}).tolist() == [0.3]
    degrees = configuration_by_name(robot, {"j2": -60, "j1": 30}, angle=math.pi / 180)
    assert degrees.tolist() == [30]
    rates = configuration_by_name(robot, {"j1": 1.0, "j2": -2.0}, "qd", given=Given.RATE)
    assert rates.tolist() == [1.0]
    with pytest.raises(WrongConfiguration, match=r"j2 is 0\.5, but it follows j1.* -0\.6"):
        configuration_by_name(robot, {"j1": 0.3, "j2": 0.5})
    with pytest.raises(WrongConfiguration, match="lacks the joint"):
        configuration_by_name(robot, {"j2": 0.5})
