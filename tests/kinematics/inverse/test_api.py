"""The compiled solver beside its oracle on Pinocchio, one target and many: the same answers."""

import numpy as np
import pytest

from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, solve_ik, solve_ik_batch
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.solutions import Choice, choose
from kinematics.singularity import singularity_report
from robots.shipped import shipped_robot
from tests.oracles.pinocchio_ik import solve_on_pinocchio


def targets(robot, n, seed=0):
    rng = np.random.default_rng(seed)
    low, high = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
    return fk(robot, rng.uniform(low, high, (n, robot.dof)))[robot.tip_frame]


@pytest.mark.parametrize("name", ["panda", "xarm7", "baxter", "talos_arm"])
def test_solver_and_oracle_take_the_same_steps(name):
    """Rounding may part them on a long way; on nearly all targets they stay together."""
    robot, together = shipped_robot(name), 0
    for target in targets(robot, 40):
        compiled = solve_ik(robot, target)
        plain = solve_on_pinocchio(robot, target, frame=robot.tip_frame)
        assert compiled.status is plain.status is IKStatus.CONVERGED
        same = np.abs(compiled.q - plain.q).max() < 1e-6
        together += same and compiled.restarts == plain.restarts
    assert together >= 36


@pytest.mark.parametrize("name", ["panda", "puma560", "planar_8r"])
@pytest.mark.parametrize("threads", [1, 3])
def test_a_batch_reaches_what_single_solves_reach(name, threads):
    robot = shipped_robot(name)
    poses = targets(robot, 300)
    batch = solve_ik_batch(robot, poses, threads=threads)
    assert set(batch.statuses) == {IKStatus.CONVERGED}
    reached = fk(robot, batch.q)[robot.tip_frame]
    np.testing.assert_allclose(reached[:, :3, 3], poses[:, :3, 3], atol=1.1e-6)
    assert ((batch.q >= robot.lower) & (batch.q <= robot.upper)).all()


def test_a_batch_without_time_says_so():
    robot = shipped_robot("panda")
    batch = solve_ik_batch(robot, targets(robot, 10), seconds=0.0)
    assert set(batch.statuses) <= {IKStatus.TIMEOUT, IKStatus.CONVERGED}
    assert IKStatus.TIMEOUT in batch.statuses


@pytest.mark.parametrize("budget", [0.0, 0.002])
def test_the_time_budget_is_kept(budget):
    robot = shipped_robot("panda")
    target = np.eye(4)
    target[:3, 3] = (0.0, 0.0, -0.35)
    options = IKOptions(time_budget=budget, max_restarts=10_000)
    found = [solve_ik(robot, target, options=options) for _ in range(20)]
    assert {result.status for result in found} == {IKStatus.TIMEOUT}
    # Neither its restarts nor its steps were used up.
    assert all(result.restarts < 10_000 for result in found)


@pytest.mark.parametrize("name", ["puma560", "ur5", "scara", "pa10", "panda"])
def test_all_solutions_are_solutions(name):
    robot = shipped_robot(name)
    for target in targets(robot, 5):
        found = all_solutions(robot, target)
        assert found.method == ("algebraic" if name == "panda" else "closed_form")
        assert any(one.within_limits for one in found.solutions)
        for one in found.solutions:
            reached = fk(robot, one.q)[robot.tip_frame]
            np.testing.assert_allclose(reached, target, atol=1e-8)
            inside = ((one.q >= robot.lower) & (one.q <= robot.upper)).all()
            assert one.within_limits == inside


def test_choices():
    robot = shipped_robot("ur5")
    target = targets(robot, 1)[0]
    found = all_solutions(robot, target)
    picked = {c: choose(robot, found, robot.tip_frame, c) for c in Choice}
    within = [one for one in found.solutions if one.within_limits]
    nearest = min(within, key=lambda one: np.linalg.norm(one.q - found.seed))
    assert picked[Choice.CLOSEST] is nearest
    best = max(singularity_report(robot, one.q).manipulability for one in within)
    chosen = singularity_report(robot, picked[Choice.MOST_MANIPULABLE].q).manipulability
    assert chosen == pytest.approx(best)
    rest = [one.q for one in within]
    far = picked[Choice.FARTHEST_FROM_LIMITS].q
    span = robot.upper - robot.lower
    margins = [(np.minimum(q - robot.lower, robot.upper - q) / span).min() for q in (far, *rest)]
    assert margins[0] == max(margins)
