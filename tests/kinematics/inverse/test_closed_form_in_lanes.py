"""Closed forms of many targets at once: the nearest solution, as among all that there are."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, Tolerance, solve_ik, solve_ik_batch
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.closed_form import closed_form_of, solutions
from kinematics.inverse.closed_solve import KINDS
from kinematics.inverse.criteria import CONVERGED
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.many_closed import solve_closed
from kinematics.inverse.solver_constants import SolverConstants, packed
from kinematics.inverse.starts import starts
from kinematics.inverse.task_error import task_chain
from kinematics.task import TASKS
from robots.shipped import shipped_robot
from tests.kinematics.inverse.test_closed_form_geometry import arm as six_turns
from tests.kinematics.inverse.test_closed_form_geometry import walk
from tests.kinematics.inverse.test_textbook_arms import SHORT, STYLES, WRISTED, arm, missed

SHIPPED = (
    *("ur5", "ur10_limited", "z1", "puma560", "kr6_r900", "rx90", "stanford", "kinova"),
    *("scara", "planar_3r"),
)
TASK_OF = {"scara": "xyz_phi", "planar_3r": "xy_phi"}
EXACT = 1e-12


def answers(chain, form, task, targets, seed, lower, upper):
    """q and whether it was found, of each target."""
    K = chain.length
    P = packed(
        SolverConstants(
            task_chain(chain, task),
            np.array([lower, upper, np.zeros(K)]),
            starts(0, np.full(K, -3.0), np.full(K, 3.0)),
            np.inf,
            chain.links,
            KINDS[form.kind],
            form.constants,
        )
    )
    found, ends = np.zeros((len(targets), 2 * K + 5)), np.zeros((len(targets), 3), np.int64)
    solve_closed(P, targets, seed, IKOptions(Tolerance(1e-9, 1e-9)).criteria, found, ends)
    return found[:, :K], ends[:, 2] == CONVERGED


def choices(chain, form, task, target, seed, lower, upper):
    """All solutions within the limits, turned towards the seed, and their distances from it."""
    q = solutions(form, chain, target, task=task, given=seed).q
    turns = chain.is_revolute
    q[:, turns] += TURN * np.round((seed - q)[:, turns] / TURN)
    for step in (-TURN, TURN):
        other = q + np.where(turns, step, 0.0)
        out = (q > upper + EXACT) | (q < lower - EXACT)
        into = (other <= upper + EXACT) & (other >= lower - EXACT)
        q = np.where(out & into & turns, other, q)
    q = q[((q <= upper + EXACT) & (q >= lower - EXACT)).all(axis=1)]
    return q, np.linalg.norm(q - seed, axis=1)


def assert_nearest(chain, form, task, targets, seed, lower, upper):
    """Return how many were found, each the nearest that there is."""
    found, is_found = answers(chain, form, task, targets, seed, lower, upper)
    for q, one, target in zip(found, is_found, targets, strict=True):
        all_q, away = choices(chain, form, task, target, seed, lower, upper)
        if not one:
            assert len(all_q) == 0
            continue
        assert missed(chain, q, target, task) < 1e-9
        assert (q <= upper).all()
        assert (q >= lower).all()
        distance = np.linalg.norm(q - seed)
        assert distance <= away.min(initial=np.inf) + 1e-6 or len(all_q) == 0
        ranked = np.sort(away)
        alone = len(away) == 1 or (len(away) > 1 and ranked[1] > ranked[0] + 1e-3)
        if alone and distance == pytest.approx(ranked[0], abs=1e-9):
            off = q - all_q[np.argmin(away)]
            off[chain.is_revolute] -= TURN * np.round(off[chain.is_revolute] / TURN)
            assert np.abs(off).max() < 1e-9
    return int(is_found.sum())


def limits(random, q, width):
    """Limits that hold q, some of them near."""
    return q - random.uniform(0.0, width, q.shape), q + random.uniform(0.0, width, q.shape)


def arms(types, count):
    random = np.random.default_rng([5, *types.encode()])
    for style in STYLES:
        for _ in range(count):
            chain = arm(random, types, style)
            form = closed_form_of(chain)
            if form is not None and form.kind in KINDS:
                yield chain, form, TASKS[form.tasks[0]], random


@pytest.mark.parametrize("types", [*SHORT, *WRISTED])
def test_the_nearest_solution_of_any_arm(types):
    for chain, form, task, random in arms(types, 1):
        q = random.uniform(-2.5, 2.5, (13, chain.length))
        targets = np.array([walk(chain, one)[2] for one in q])
        seed = random.uniform(-1.0, 1.0, chain.length)
        none = np.full(chain.length, np.inf)
        assert assert_nearest(chain, form, task, targets, seed, -none, none) == len(q)
        lower, upper = limits(random, q[0], 2.0)
        assert assert_nearest(chain, form, task, targets, seed, lower, upper) >= 1


@pytest.mark.parametrize("types", ["RRR", "RRP", "PRR", "RRRRRR", "RRPRRR", "PRRRRR"])
def test_targets_at_right_angles_where_solutions_meet_and_joints_are_free(types):
    for chain, form, task, random in arms(types, 1):
        q = 0.5 * np.pi * random.integers(-2, 3, (17, chain.length))
        targets = np.array([walk(chain, one)[2] for one in q])
        seed, none = np.zeros(chain.length), np.full(chain.length, np.inf)
        assert assert_nearest(chain, form, task, targets, seed, -none, none) == len(q)
        half = np.full(chain.length, np.pi + 1e-9)
        assert_nearest(chain, form, task, targets, seed, -half, half)


@pytest.mark.parametrize(
    "kind",
    [
        *("1 and 2 meeting", "1 and 2 parallel", "2 and 3 parallel", "2 and 3 meeting"),
        *("general", "parallel", "parallel, 5 and 6 meeting"),
    ],
)
def test_the_nearest_solution_of_six_turns(kind):
    random = np.random.default_rng(6)
    for _ in range(6):
        chain = six_turns(kind, random)
        form = closed_form_of(chain)
        q = random.uniform(-2.5, 2.5, (13, 6))
        targets = np.array([walk(chain, one)[2] for one in q])
        none, seed = np.full(6, np.inf), q[0] + 0.1
        task = TASKS["pose"]
        assert assert_nearest(chain, form, task, targets, seed, -none, none) == len(q)


@pytest.mark.parametrize("name", SHIPPED)
def test_many_targets_are_answered_as_one_is(name):
    """To 1e-12, reachable or not, also where the arm is singular or at a limit."""
    robot, task = shipped_robot(name), TASKS[TASK_OF.get(name, "pose")]
    random, bounds = np.random.default_rng(3), JointBounds.of(robot)
    low, high = bounds.ranges(1.0)
    q = random.uniform(low, high, (403, robot.dof))
    q[40:60] = bounds.middle()
    q[50:60] += 10.0 ** random.uniform(-14, -3, (10, robot.dof))
    q[60:80, -1] = high[-1]
    q[80:90] = np.where(random.random((10, robot.dof)) < 0.5, low, high)
    targets = fk(robot, q)[robot.tip_frame]
    targets[90:100, :3, 3] *= 3.0
    options = IKOptions(max_restarts=3)
    for seed in (None, random.uniform(low, high)):
        many = solve_ik_batch(robot, targets, task=task, seed=seed, options=options, threads=2)
        for i, target in enumerate(targets):
            one = solve_ik(robot, target, task=task, seed=seed, options=options)
            assert many.statuses[i] is one.status
            assert (many.restarts[i], many.iterations[i]) == (one.restarts, one.iterations)
            reached = one.status is IKStatus.CONVERGED and one.iterations == 0
            np.testing.assert_allclose(many.q[i], one.q, rtol=0, atol=EXACT if reached else 1e-9)


@pytest.mark.parametrize("name", ["ur5", "puma560", "scara"])
def test_an_answer_in_closed_form_does_not_depend_on_the_targets_beside_it(name):
    robot, task = shipped_robot(name), TASKS[TASK_OF.get(name, "pose")]
    low, high = JointBounds.of(robot).ranges(1.0)
    q = np.random.default_rng(4).uniform(low, high, (61, robot.dof))
    q[7] = 0.0
    targets = fk(robot, q)[robot.tip_frame]
    whole = solve_ik_batch(robot, targets, task=task)
    order = np.random.default_rng(8).permutation(len(q))
    mixed = solve_ik_batch(robot, targets[order], task=task)
    np.testing.assert_array_equal(mixed.q, whole.q[order])
    np.testing.assert_array_equal(mixed.position_error, whole.position_error[order])
    for i in range(12):
        alone = solve_ik_batch(robot, targets[i : i + 1], task=task)
        np.testing.assert_array_equal(alone.q[0], whole.q[i])
