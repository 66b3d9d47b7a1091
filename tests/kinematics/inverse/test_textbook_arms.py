"""Textbook arms in closed form: arms of two to four joints, in any order of turns and slides, and
before a spherical wrist; nothing missing, nothing false, names that stay."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse import IKStatus, solve_ik
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.closed_form import closed_form_of, solutions
from kinematics.inverse.continuation.real import chain_fibre, real_solutions
from kinematics.task import TASKS
from robots.robot import robot_from_table
from tests.kinematics.inverse.test_closed_form_geometry import (
    chain_from,
    differences,
    placement,
    unit,
    walk,
)

SHORT = ["".join(types) for count in (2, 3) for types in product("RP", repeat=count)]
FLAT = ["RRPR", "PRRR", "RRRP", "RPRR", "RPPR", "PRPR", "PPPR", "RPRP", "RRPP"]
WRISTED = ["".join(types) + "RRR" for types in product("RP", repeat=3)]
STYLES = ("skew", "grid", "mixed", "flat")
"""How axes lie: anyhow; along x, y, z through points of a grid; some parallel, perpendicular or
meeting; about, along or across one direction."""


def arm(random, types, style):
    """A chain of a style, in a base that stands anyhow."""
    count, turns = len(types), np.array([kind == "R" for kind in types])
    h = [unit(random) for _ in range(count)]
    p = [random.normal(size=3) for _ in range(count)]
    if style == "grid":
        h = [np.eye(3)[random.integers(3)] * random.choice([-1.0, 1.0]) for _ in range(count)]
        p = [0.5 * random.integers(-1, 2, 3) for _ in range(count)]
    elif style == "mixed":
        for k in range(1, count):
            if (chance := random.random()) < 0.3:
                h[k] = h[k - 1] * random.choice([-1.0, 1.0])
            elif chance < 0.6:
                h[k] = np.cross(h[k - 1], unit(random))
                h[k] /= np.linalg.norm(h[k])
            if random.random() < 0.4:
                p[k] = p[k - 1] + random.normal() * h[k - 1] + random.normal() * h[k]
    elif style == "flat":
        u = unit(random) if random.random() < 0.5 else np.array([0.0, 0.0, 1.0])
        for k in range(count):
            h[k] = np.cross(u, unit(random))
            h[k] /= np.linalg.norm(h[k])
            if turns[k] or random.random() < (0.5 if count > 3 else 0.15):
                h[k] = u * random.choice([-1.0, 1.0])
    if count == 6:
        centre = random.normal(size=3)
        for k in (3, 4, 5):
            h[k] = unit(random)
            p[k] = centre + random.normal() * h[k]
    pose = placement(random)
    if style == "grid" and random.random() < 0.7:
        pose[:3, 3] = 0.5 * random.integers(-1, 2, 3)
    return chain_from(h, p, pose, turns)


def cases(types, count, seed):
    """Arms of each style that have a closed form, each with its tasks and some q."""
    random = np.random.default_rng([seed, *types.encode()])
    for style in STYLES if len(types) != 4 else ("grid", "flat", "flat", "flat"):
        for _ in range(count):
            chain = arm(random, types, style)
            form = closed_form_of(chain)
            for task in () if form is None else form.tasks:
                for q in random.uniform(-2.5, 2.5, (3, len(types))):
                    yield chain, form, TASKS[task], q, random


def missed(chain, q, target, task):
    """Largest error of a configuration in the rows of a task, by another forward kinematics."""
    T = walk(chain, q)[2]
    R = target[:3, :3] @ T[:3, :3].T
    vee = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    away = np.abs(np.concatenate((target[:3, 3] - T[:3, 3], vee))[list(task.rows)]).max()
    return away + (task.name == "pose" and np.trace(R) < 0)


@pytest.mark.parametrize("types", [*SHORT, *FLAT, *WRISTED])
def test_every_solution_is_there_once_and_has_its_name(types):
    seen = 0
    for chain, form, task, q, random in cases(types, 6, 1):
        seen += 1
        target = walk(chain, q)[2]
        found = solutions(form, chain, target, task=task, given=q)
        assert 1 <= len(found.q) <= form.most, form.description
        assert differences(chain.is_revolute, found.q, q).min() < 1e-6, form.description
        assert (found.position_errors + found.orientation_errors).max() < 1e-9
        assert max(missed(chain, one, target, task) for one in found.q) < 1e-9
        names = found.postures(form)
        assert len(set(names)) == len(names), (form.description, names)
        near = q + 1e-5 * random.normal(size=len(q))
        moved = solutions(form, chain, walk(chain, near)[2], task=task, given=near)
        if len(moved.q) != len(found.q) or form.ranked is not None:
            continue
        for one, name in zip(found.q, names, strict=True):
            gaps = differences(chain.is_revolute, moved.q, one)
            if gaps.min() < 1e-2:
                assert moved.postures(form)[int(gaps.argmin())] == name, form.description
    assert seen


@pytest.mark.parametrize("types", [*SHORT, *FLAT])
def test_the_algebraic_way_finds_the_same(types):
    for number, (chain, form, task, q, random) in enumerate(cases(types, 2, 2)):
        if number % 3:
            continue
        fibre = chain_fibre(chain, task)
        if fibre is None:
            continue
        target = walk(chain, q)[2]
        if number % 2:
            target[:3, 3] += random.normal(scale=0.5, size=3) * [
                row in task.positions for row in range(3)
            ]
        theirs = real_solutions(fibre, chain, task, target, q)
        ours = solutions(form, chain, target, task=task, given=q)
        assert theirs.is_complete
        assert len(theirs.solutions) == len(ours.q), form.description
        for one in theirs.solutions:
            assert differences(chain.is_revolute, ours.q, one.q).min() < 1e-6, form.description


HALF = np.pi / 2
TOOL = {"tool": {"xyz": [0.2, 0.1, 0.3], "rpy": [0.0, 0.0, 0.0]}}
"""So that the tip is not on axis 3, wherever a convention puts the frames."""
TABLES = {
    # kind, alpha, a, d or theta: the textbook's figures in standard D-H.
    "spherical": (
        [("R", -HALF, 0, 0.3), ("R", HALF, 0, 0.2), ("P", 0, 0, 0)],
        ("front", "back"),
        ("extended", "retracted"),
    ),
    "cylindrical": (
        [("R", 0, 0, 0.2), ("P", -HALF, 0, 0), ("P", 0, 0, 0)],
        ("extended", "retracted"),
    ),
    "elbow": (
        [("R", HALF, 0, 0.4), ("R", 0, 0.5, 0.1), ("R", 0, 0.4, 0)],
        ("front", "back"),
        ("up", "down"),
    ),
    "elbow, shoulder offset": (
        [("R", HALF, 0.15, 0.4), ("R", 0, 0.5, 0.1), ("R", 0, 0.4, 0)],
        ("front", "back"),
        ("up", "down"),
    ),
    "gantry": ([("P", -HALF, 0, HALF), ("P", HALF, 0, -HALF), ("P", 0, 0, 0)],),
    "scara without wrist": (
        [("R", 0, 0.4, 0), ("R", np.pi, 0.3, 0), ("P", 0, 0, 0)],
        ("up", "down"),
    ),
}


def robot_of(rows, convention, lower=-3.0, upper=3.0, **more):
    joints = []
    for k, (kind, alpha, a, other) in enumerate(rows):
        joints.append(
            {
                "name": f"j{k + 1}",
                "type": kind,
                "alpha": float(alpha),
                "a": float(a),
                "d" if kind == "R" else "theta": float(other),
                "offset": 0.1 * (k + 1),
                "limits": {"lower": lower, "upper": upper},
            }
        )
    return robot_from_table(
        read_mapping({"name": "arm", "convention": convention, "joints": joints, **more})
    )


@pytest.mark.parametrize("name", TABLES)
def test_the_figures_of_textbooks(name):
    rows, *choices = TABLES[name]
    robot, random = robot_of(rows, "standard"), np.random.default_rng(3)
    most: set[tuple[str, ...]] = set()
    for _ in range(40):
        q = random.uniform(-2.6, 2.6, robot.dof)
        target = fk(robot, q)[robot.tip_frame]
        found = all_solutions(robot, target, task=TASKS["position"], seed=q)
        assert (found.method, found.complete) == ("closed_form", True)
        assert np.abs(found.solutions[0].q - q).max() < 1e-9
        names = {one.posture for one in found.solutions}
        assert len(names) == len(found.solutions)
        most |= names
        own = solve_ik(robot, target, task=TASKS["position"], seed=q)
        assert own.status is IKStatus.CONVERGED
        assert own.iterations == 0
        assert np.abs(own.q - q).max() < 1e-9
        assert own.position_error < 1e-9
    assert most == set(product(*choices))


@pytest.mark.parametrize("convention", ["standard", "modified", "khalil"])
@pytest.mark.parametrize("types", ["RRP", "RPP", "PRP", "RRR", "PRR", "RPR", "PPP", "PPR"])
def test_every_convention(types, convention):
    random = np.random.default_rng([7, *types.encode()])
    seen = 0
    for _ in range(30):
        rows = [
            (kind, HALF * random.integers(-1, 3), *(0.3 * random.integers(-1, 2, 2)))
            for kind in types
        ]
        if convention == "khalil":
            joints = [
                {"name": f"j{k}", "type": kind, "alpha": float(alpha), "d": float(a)}
                | {"r" if kind == "R" else "theta": float(other)}
                | {"limits": {"lower": -3.0, "upper": 3.0}}
                for k, (kind, alpha, a, other) in enumerate(rows)
            ]
            table = {"name": "arm", "convention": "khalil", "joints": joints, **TOOL}
            robot = robot_from_table(read_mapping(table))
        else:
            robot = robot_of(rows, convention, **TOOL)
        form = closed_form_of(chain_of(robot, robot.tip_frame))
        if form is None or "position" not in form.tasks:
            continue
        seen += 1
        q = random.uniform(-2.0, 2.0, robot.dof)
        target = fk(robot, q)[robot.tip_frame]
        found = all_solutions(robot, target, task=TASKS["position"], seed=q)
        assert found.method == "closed_form"
        for one in found.solutions:
            reached = fk(robot, one.q)[robot.tip_frame]
            np.testing.assert_allclose(reached[:3, 3], target[:3, 3], atol=1e-9)
        # The turn nearest to q within the limits.
        assert np.abs(found.solutions[0].q - q).max() < 1e-6 or found.solutions[0].free
    assert seen


def test_out_of_reach_is_proved():
    robot = robot_of(TABLES["spherical"][0], "standard")
    target = np.eye(4)
    # On axis 1, nearer to the shoulder than its offset lets the tip come.
    target[:3, 3] = 0.0, 0.05, 0.35
    found = all_solutions(robot, target, task=TASKS["position"])
    assert (found.method, found.complete, found.solutions) == ("closed_form", True, ())
    assert solve_ik(robot, target, task=TASKS["position"]).status is IKStatus.UNREACHABLE


def test_a_target_on_axis_1_leaves_joint_1_free():
    robot = robot_of([("R", HALF, 0, 0.4), ("R", 0, 0.5, 0), ("R", 0, 0.4, 0)], "standard")
    target = np.eye(4)
    target[:3, 3] = 0.0, 0.0, 0.9
    found = all_solutions(robot, target, task=TASKS["position"], seed=np.array([0.7, 0.0, 0.0]))
    assert len(found.solutions) == 2
    for one in found.solutions:
        assert one.free == ("j1",)
        assert one.q[0] == 0.7


def test_a_tip_where_the_axes_meet_leaves_both_joints_free():
    rows = [("R", -HALF, 0, 0.3), ("R", HALF, 0, 0.0), ("P", 0, 0, 0)]
    robot = robot_of(rows, "standard")
    target = np.eye(4)
    target[2, 3] = 0.3
    seed = np.array([0.4, -0.3, 0.2])
    (one,) = all_solutions(robot, target, task=TASKS["position"], seed=seed).solutions
    assert one.free == ("j1", "j2")
    np.testing.assert_allclose(one.q, [0.4, -0.3, -0.3], atol=1e-9)


def test_limits_are_fitted_by_whole_turns_and_touched():
    rows = TABLES["cylindrical"][0]
    robot = robot_of(rows, "standard", lower=1.0, upper=1.0 + 2 * np.pi)
    q = np.array([6.9, 1.2, 1.0])
    target = fk(robot, q)[robot.tip_frame]
    found = all_solutions(robot, target, task=TASKS["position"], seed=q)
    within = [one for one in found.solutions if one.within_limits]
    assert within
    np.testing.assert_allclose(within[0].q, q, atol=1e-9)
    result = solve_ik(robot, target, task=TASKS["position"])
    assert result.status is IKStatus.CONVERGED
    assert ((result.q >= robot.lower) & (result.q <= robot.upper)).all()
