"""The methods on arms and obstacles that no reference has: measured anew, with Pinocchio."""

import itertools
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from kinematics.errors import InvalidOption, MethodUnavailable, WrongConfiguration
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.obstacles import (
    Box,
    Capsule,
    CircleObstacle,
    HalfSpace,
    Sphere,
    encoded,
)
from kinematics.redundancy.follow import follow, followed, rates
from kinematics.redundancy.judging.verdict import Reason
from kinematics.redundancy.methods import METHODS, method_from, whole_path
from kinematics.redundancy.path.geometry import Circle, Sampling, circle
from kinematics.redundancy.path.time_law import TimeLaw
from kinematics.redundancy.problem import Gains, PathOptions, PathProblem, SecondaryTask
from kinematics.task import task_from
from robots.shipped import shipped_robot

CONSTRAINED = ("sqp", "qp", "whole_path")
EASY = PathOptions()


def run(problem, method, **options):
    return followed(problem, METHODS[method], PathOptions(**options))


def check_against_the_model(result):
    """Errors, with Pinocchio one by one; clearance of spheres and circles, by formula."""
    problem = result.problem
    arm, targets = problem.arm, problem.path.targets.reshape(-1, 3, 4)
    frames = [f for f in arm.robot.frames if f.startswith("frame_") and f != "frame_0"]
    for k in range(0, len(result.q), 10):
        poses = fk(arm.robot, result.q[k], [*frames, arm.frame])
        rows = list(arm.task.positions)
        error = np.linalg.norm((poses[arm.frame][:3, 3] - targets[k, :, 3])[rows])
        assert result.measures.position_error[k] == pytest.approx(error, abs=1e-12)
        points = np.array([poses[f][:3, 3] for f in (*frames, arm.frame)])
        least = np.inf
        for row in problem.obstacles:
            flat = np.array([1, 1, 0 if row[0] == 1 else 1])
            for a, b in zip(points * flat, points[1:] * flat, strict=False):
                t = np.clip((row[1:4] * flat - a) @ (b - a) / max((b - a) @ (b - a), 1e-18), 0, 1)
                away = np.linalg.norm(a + t * (b - a) - row[1:4] * flat) - row[4]
                least = min(least, away - problem.link_radius)
        if len(problem.obstacles):
            assert result.measures.clearance[k] == pytest.approx(least, abs=1e-12)


def holds(result, margin=0.0):
    """The task is done, limits exactly, clearance swept."""
    measures, problem = result.measures, result.problem
    assert result.verdict.success, result.verdict.message
    assert measures.position_error.max() < 1e-6
    assert measures.orientation_error.max() < 1e-6
    assert measures.limit_margin.min() >= 0.0
    assert measures.min_swept >= problem.d_safe + margin


@pytest.fixture(scope="module")
def ten(planar, line):
    """A 10R arm past three discs."""
    robot = planar([0.16] * 10, [(-180, 180)] + [(-50, 50)] * 9)
    q = np.deg2rad([120, -20, -25, -25, -20, -15, -10, 0, 10, 10])
    discs = [((0.73, 0.22), 0.08), ((0.93, -0.04), 0.06), ((0.52, 0.92), 0.06)]
    obstacles = [CircleObstacle(*disc) for disc in discs]
    start = fk(robot, q)["tool"][:3, 3]
    shift = np.array([1.1, -0.2, 0]) - start
    return lambda **more: line(
        robot, q, shift, "xy", obstacles, link_radius=0.02, d_safe=0.02, **more
    )


@pytest.mark.parametrize("method", CONSTRAINED)
def test_a_ten_joint_arm_past_three_discs(ten, method):
    result = run(ten(), method)
    holds(result)
    check_against_the_model(result)


def test_methods_that_see_no_obstacle_are_judged_by_what_they_did(ten):
    problem = ten()
    for method in ("pseudo_inverse", "damped"):
        result = run(problem, method)
        check_against_the_model(result)
        assert result.verdict.reason is Reason.COLLISION
        assert "obstacle 0" in result.verdict.message
    assert run(problem, "damped").measures.position_error.max() < 1e-9


def test_program_and_qp_find_the_same_and_the_whole_path_is_shorter(ten):
    problem = ten()
    sqp, qp, whole = (run(problem, m).measures.step for m in CONSTRAINED)
    assert qp.sum() == pytest.approx(sqp.sum(), rel=1e-4)
    assert (whole**2).sum() < (qp**2).sum()


def test_a_program_of_the_whole_path_that_is_cut_short_says_whose_samples_these_are(
    ten, monkeypatch
):
    problem = ten()
    assert run(problem, "whole_path").verdict.message == "the path is followed"
    monkeypatch.setattr(whole_path, "ITERATIONS", 1)
    monkeypatch.setattr(whole_path, "FEWER_ITERATIONS", 1)
    cut = run(problem, "whole_path")
    holds(cut)
    assert np.array_equal(cut.q, run(problem, "qp").q)
    assert "these are the samples of qp" in cut.verdict.message


def test_few_samples_are_swept_too(ten):
    for method in ("sqp", "qp"):
        holds(run(ten(samples=16), method))


@pytest.mark.parametrize(
    ("name", "q", "shift", "ball", "task"),
    [
        (
            "pa10",
            [10, 20, 30, 60, 20, 60, 10],
            (0, -0.45, -0.1),
            (0.142, -0.086, 0.861),
            "position",
        ),
        ("pa10", [10, 20, 30, 60, 20, 60, 10], (0, -0.45, -0.1), (0.142, -0.086, 0.861), "pose"),
        ("panda", [0, -29, 0, -115, 0, 92, 45], (-0.05, 0.4, -0.1), (0.2, 0.2, 0.7), "position"),
    ],
)
@pytest.mark.parametrize("method", CONSTRAINED)
def test_spatial_arms_follow_a_line_past_a_ball(line, name, q, shift, ball, task, method):
    robot = shipped_robot(name)
    obstacles = [Sphere(ball, 0.08)]
    problem = line(
        robot, np.deg2rad(q), shift, task, obstacles, link_radius=0.05, d_safe=0.02, samples=61
    )
    blind = run(problem, "damped")
    assert blind.verdict.reason in (Reason.COLLISION, Reason.CLEARANCE)
    result = run(problem, method)
    holds(result)
    check_against_the_model(result)


@pytest.mark.parametrize("method", CONSTRAINED)
def test_boxes_capsules_and_floors(planar, line, method):
    robot = planar([0.16] * 10, [(-180, 180)] + [(-50, 50)] * 9)
    q = np.deg2rad([120, -20, -25, -25, -20, -15, -10, 0, 10, 10])
    obstacles = [
        Box((0.73, 0.22, 0), (0.1, 0.1, 0.2)),
        Capsule((0.95, -0.1, 0), (0.95, 0, 0), 0.05),
        HalfSpace((0, 1, 0), -0.25),
    ]
    shift = np.array([1.1, -0.2, 0]) - fk(robot, q)["tool"][:3, 3]
    holds(run(line(robot, q, shift, "xy", obstacles, link_radius=0.02, d_safe=0.02), method))


def test_limits_and_speeds_hold(planar, line):
    limits = [(-180, 180)] + [(-32, 32)] * 7
    q = np.deg2rad([110, -15, -25, -30, -30, -20, 0, 10])
    shift = (0.35, -0.7, 0)
    slow = line(planar([0.2] * 8, limits, 20), q, shift, "xy", tf=2.0)
    for method in ("sqp", "qp", "whole_path"):
        result = run(slow, method)
        assert result.measures.limit_margin.min() >= 0
        assert result.measures.speed_ratio.max() <= 1 + 1e-9
    fast = run(slow, "damped")
    assert fast.measures.speed_ratio.max() > 1
    assert "velocity" in fast.verdict.violations


@pytest.mark.parametrize("method", CONSTRAINED)
@pytest.mark.parametrize("margin", [1e-3, 0.02])
def test_the_margin_gives_way_where_the_path_leaves_no_room_for_it(planar, line, method, margin):
    robot = planar([0.5, 0.4, 0.3], [(-150, 150)] * 3)
    q = np.deg2rad([110, -88, -96])
    start = fk(robot, q)["tool"][:3, 3]
    # the way of the tool passes the disc at d_safe and a third of the margin
    ball = CircleObstacle((start[0] + 0.15, start[1] - 0.12 - margin / 3), 0.08)
    problem = line(robot, q, (0.3, 0, 0), "xy", [ball], link_radius=0.02, d_safe=0.02, samples=41)
    result = run(problem, method, margin=margin)
    holds(result)
    check_against_the_model(result)


def test_an_infeasible_passage_is_named_with_how_far_it_got(planar, line):
    robot = planar([0.5, 0.4, 0.3], [(-150, 150)] * 3)
    q = np.deg2rad([110, -88, -96])
    ball = [CircleObstacle((0.45, 0.25), 0.1)]  # over the path itself
    problem = line(robot, q, (0.3, -0.1, 0), "xy", ball, link_radius=0.02, d_safe=0.02)
    for method in ("sqp", "qp"):
        result = run(problem, method)
        assert result.verdict.reason is Reason.INFEASIBLE
        assert 0 < result.verdict.tracked < 1
        assert result.measures.limit_margin.min() >= 0
        assert f"sample {result.verdict.first_lost}" in result.verdict.message
    near = line(robot, q, (0.01, 0, 0), "xy", [CircleObstacle((0, 0.3), 0.1)], d_safe=0.02)
    verdict = run(near, "qp").verdict
    assert verdict.reason is Reason.INFEASIBLE
    assert "start itself" in verdict.message


def test_samples_that_are_lost_only_on_the_way_are_counted(planar, line):
    problem = line(planar([0.5, 0.4, 0.3]), (0.4, 0.9, -0.7), (-0.3, 0.1, 0), "xy", samples=21)
    result = run(problem, "pseudo_inverse")
    error = result.measures.position_error
    lost = error > 1e-4
    assert lost.any()
    assert not lost[-1]
    message = result.verdict.message
    assert f"at {lost.sum()} of 21 samples, the first of them {np.argmax(lost)}" in message
    assert f"up to {error.max():.4g} m" in message
    open_loop = run(problem, "pseudo_inverse", closed_loop=False)
    assert f"from sample {open_loop.verdict.first_lost} on" in open_loop.verdict.message


@pytest.mark.parametrize("method", ["damped", "null_space", "sqp", "qp", "whole_path"])
def test_a_perturbed_start_leaves_the_singularity(planar, line, method):
    problem = line(planar([0.5, 0.4, 0.3], [(-150, 150)] * 3), np.zeros(3), (-0.3, 0, 0), "xy")
    stuck = run(problem, method).verdict
    assert stuck.reason is Reason.SINGULAR_START
    assert "rank(J) = 1 < 2" in stuck.message
    assert "perturb" in stuck.message
    assert run(problem, method, perturb=0.05).verdict.success


def test_one_large_step_from_which_the_path_is_found_again_is_no_divergence(planar, line):
    problem = line(planar([0.5, 0.4, 0.3]), np.zeros(3), (-0.3, 0, 0), "xy", samples=41)
    result = run(problem, "pseudo_inverse", perturb=1.0)
    assert result.measures.largest_step > 1
    assert result.measures.position_error[-1] < 1e-4
    assert result.verdict.reason is Reason.TRACKING


def test_a_task_that_the_arm_never_can_do_is_said_so(line):
    problem = line(shipped_robot("planar_3r"), [0.3, 0.4, 0.5], (-0.1, 0, 0), "pose")
    refused = run(problem, "pseudo_inverse").verdict
    assert refused.reason is Reason.SINGULAR_START
    assert "choose xy" in refused.message
    # rows that cannot and need not move are no obstacle to the others
    flat = line(shipped_robot("planar_3r"), [0.3, 0.4, 0.5], (-0.1, 0, 0), "position")
    for method in ("damped", *CONSTRAINED):
        assert run(flat, method).verdict.success


def test_loops_drift_as_the_equation_says(planar, exercises):
    robot, q = planar([0.5, 0.4, 0.3]), np.deg2rad([110, -88, -96])
    start, xy = fk(robot, q)["tool"], task_from("xy")
    about = Circle(start[:3, 3] + [-0.1, 0, 0], np.array([0.0, 0, 1]))
    expected = next(e["value"] for k, e in exercises.items() if k.startswith("E18_"))
    for turns, loop in ((1, "loop1_ode"), (2, "loop2"), (3, "loop3")):
        law = Sampling(TimeLaw.LINEAR, 2.0, 3000 * turns + 1)
        path = circle(start, Circle(about.center, about.normal, turns), xy, law)
        result = run(PathProblem(Arm.of(robot, None, xy), q, path, encoded([])), "pseudo_inverse")
        np.testing.assert_allclose(np.rad2deg(result.drift), expected[loop], atol=5e-3)
    cyclic = followed(
        result.problem, METHODS["null_space"], PathOptions(gains=Gains(posture=3000.0))
    )
    assert np.abs(cyclic.drift).max() < 0.1 * np.abs(result.drift).max()


def test_a_secondary_task_is_done_where_the_path_leaves_it_free(line):
    robot = shipped_robot("planar_8r")
    q = np.deg2rad([110, -15, -25, -30, -30, -20, 0, 10])
    poses = fk(robot, q, ["frame_5", "tool"])
    inwards = 0.2 * (poses["frame_5"] - poses["tool"])[:3, 3]
    problem = line(robot, q, inwards, "xy")
    elbow = Arm.of(robot, "frame_5", task_from("xy"))
    held = poses["frame_5"]
    pose = np.ascontiguousarray(held[:3].reshape(12))
    second = SecondaryTask(elbow, pose, 1.0)
    result = run(problem, "task_priority", secondary=(second,))
    assert result.verdict.success
    assert result.measures.position_error.max() < 1e-9

    def moved(found):
        return np.abs(fk(robot, found.q, ["frame_5"])["frame_5"][:, :2, 3] - held[:2, 3]).max()

    assert moved(result) < 1e-3
    assert moved(run(problem, "damped")) > 0.01
    with pytest.raises(InvalidOption, match="secondary"):
        run(problem, "task_priority")


def test_gradients_do_what_they_are_for(line):
    robot = shipped_robot("planar_8r")
    q = np.deg2rad([110, -15, -25, -30, -30, -20, 0, 10])
    problem = line(robot, q, (0.2, -0.4, 0), "xy")

    def end(**gains):
        return run(problem, "null_space", gains=Gains(**gains))

    plain = end()
    centred = end(limits=20.0)
    span = problem.arm.chain.upper
    assert np.sum((centred.q[-1] / span) ** 2) < np.sum((plain.q[-1] / span) ** 2)
    agile = end(manipulability=20.0)
    xy = task_from("xy")

    def w(found):
        _, J, _ = Arm.of(robot, None, xy).task_at(found.q[-1], problem.path.targets[-1])
        return np.linalg.det(J @ J.T)

    assert w(agile) > w(plain)
    wanted = np.linspace(1, -1, 8)
    posed = followed(
        problem, METHODS["null_space"], PathOptions(gains=Gains(posture=5.0), posture_q=wanted)
    )
    assert np.linalg.norm(posed.q[-1] - wanted) < np.linalg.norm(plain.q[-1] - wanted)
    for result in (plain, centred, agile, posed):
        assert result.measures.position_error.max() < 1e-9


def test_rates_are_differences_of_second_order():
    t = np.linspace(0, 1, 201)
    q = np.column_stack((np.sin(3 * t), t**2))
    v, a = rates(q, t[1])
    np.testing.assert_allclose(v, np.column_stack((3 * np.cos(3 * t), 2 * t)), atol=1e-3)
    np.testing.assert_allclose(a[1:-1, 0], -9 * np.sin(3 * t[1:-1]), atol=1e-2)
    np.testing.assert_allclose(a[:, 1], 2, atol=1e-9)


def test_work_stops_where_nobody_asks_for_more_and_at_the_time_limit(ten, monkeypatch):
    problem = ten(samples=2001)
    work = follow(problem, METHODS["qp"], EASY)
    assert next(work).last < 50
    work.close()
    # A clock by which every part of the work takes 300 s.
    clock = SimpleNamespace(perf_counter=itertools.count(step=300).__next__)
    monkeypatch.setattr("kinematics.redundancy.follow.time", clock)
    result = run(problem, "qp", seconds=1000.0)
    assert result.verdict.reason is Reason.TIMEOUT
    assert 1 < len(result.q) < 2001
    assert result.verdict.tracked < 1


def test_without_casadi_the_whole_path_is_refused(ten, monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(MethodUnavailable, match="whole-path"):
        run(ten(), "whole_path")


def test_bad_requests_are_named(ten, planar, line):
    with pytest.raises(InvalidOption, match="unknown"):
        method_from("magic")
    with pytest.raises(WrongConfiguration, match="outside its limits"):
        line(planar([0.5, 0.4], [(0, 90)] * 2), [-0.5, 0.5], (0, 0, 0), "xy")
    for field in ("damping", "margin", "perturb", "obstacle_weight"):
        with pytest.raises(InvalidOption) as caught:
            PathOptions(**{field: -1.0})
        assert caught.value.location == (field,)
        assert caught.value.value == -1.0 < caught.value.lower
    with pytest.raises(InvalidOption, match="d_safe"):
        run(ten(), "null_space", influence=0.001)
