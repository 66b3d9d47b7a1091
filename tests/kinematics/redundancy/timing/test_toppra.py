"""Paths in the shortest time: limits and deviations measured with Pinocchio, optima by formula."""

import logging
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from kinematics.errors import InvalidOption, MethodUnavailable
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.obstacles import CircleObstacle, Sphere, encoded
from kinematics.redundancy.follow import followed
from kinematics.redundancy.measure import clearances_at
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Circle, Sampling, circle, polyline
from kinematics.redundancy.path.time_law import TimeLaw
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.redundancy.timing import toppra as retiming
from kinematics.redundancy.timing.result import RetimeStatus, retimed
from kinematics.redundancy.timing.toppra import RetimeOptions, fastest, spline_through
from kinematics.task import task_from
from robots.shipped import shipped_robot

PANDA = np.deg2rad([0, -29, 0, -115, 0, 92, 45])


def limits(problem, acceleration, velocity=None, **more):
    K = problem.arm.K
    return RetimeOptions(
        np.broadcast_to(np.asarray(acceleration, dtype=float), (K,)).copy(),
        None if velocity is None else np.broadcast_to(np.asarray(velocity, dtype=float), (K,)),
        **more,
    )


def timed(problem, acceleration, velocity=None, method="qp", more=None, **options):
    result = followed(problem, METHODS[method], PathOptions(**options))
    return result, retimed(result, limits(problem, acceleration, velocity, **(more or {})))


def lines(*shifts, samples=101, law=TimeLaw.CUBIC, task="pose", obstacles=(), **more):
    robot, space = shipped_robot("panda"), task_from(task)
    start = fk(robot, PANDA)[robot.tip_frame]
    goals = []
    for shift in shifts:
        goals.append(start.copy())
        goals[-1][:3, 3] += shift
    path = polyline(start, goals, space, Sampling(law, 2.0, samples))
    return PathProblem(Arm.of(robot, None, space), PANDA, path, encoded(obstacles), **more)


@pytest.mark.parametrize(
    ("acceleration", "velocity", "expected"),
    [(2.0, None, 2 * np.sqrt(0.5 / 2.0)), (4.0, 0.5, 0.5 / 0.5 + 0.5 / 4.0)],
    ids=["triangle", "trapezoid"],
)
def test_one_joint_is_as_fast_as_can_be(planar, acceleration, velocity, expected):
    """From rest to rest by 0.5 rad: half the way speeding up, and with a speed limit in between."""
    robot = planar([1.0])
    arm = Arm.of(robot, None, task_from("xy"))
    start, goal = fk(robot, np.array([[0.0], [0.5]]))["tool"]
    about = Circle(np.zeros(3), np.array([0.0, 0, 1]), 0.5 / (2 * np.pi))
    path = circle(start, about, arm.task, Sampling(samples=51))
    problem = PathProblem(arm, np.zeros(1), path, encoded([]))
    result = followed(problem, METHODS["qp"], PathOptions())
    assert result.q[-1, 0] == pytest.approx(0.5)
    motion = retimed(result, limits(problem, acceleration, velocity, samples=1001))
    assert motion.success, motion.message
    assert motion.duration == pytest.approx(expected, rel=2e-3)
    assert motion.duration >= expected * (1 - 1e-9)
    assert motion.q[-1, 0] == pytest.approx(0.5)
    np.testing.assert_allclose(goal, fk(robot, motion.q[-1])["tool"], atol=1e-8)
    v = np.gradient(motion.q[:, 0], motion.t)
    np.testing.assert_allclose(motion.velocity[1:-1, 0], v[1:-1], atol=5e-3)
    assert motion.velocity[[0, -1]] == pytest.approx(0, abs=1e-9)
    speed_up = motion.acceleration[(motion.t > 0.01 * expected) & (motion.t < 0.1 * expected)]
    np.testing.assert_allclose(speed_up, acceleration, rtol=1e-2)


BALL = Sphere((0.2, 0.5, 0.7), 0.1)


@pytest.mark.parametrize("law", list(TimeLaw))
def test_limits_and_task_hold_between_samples(law):
    problem = lines((0, 0.2, -0.1), law=law, samples=201, obstacles=[BALL], link_radius=0.05)
    acceleration = np.array([5.0, 4, 6, 5, 10, 12, 15])
    result, motion = timed(problem, acceleration, more={"samples": 5001})
    assert motion.success, motion.message
    assert motion.status is RetimeStatus.RETIMED
    robot = problem.arm.robot
    speeds = np.array([joint.velocity for joint in robot.joints])
    assert np.abs(motion.velocity / speeds).max() <= 1 + 1e-9
    assert np.abs(motion.acceleration / acceleration).max() <= 1 + 1e-9
    assert 0.99 < motion.acceleration_ratio <= 1 + 1e-9
    # differences of the samples that are given, not what is said of them
    step = motion.t[1]
    v = np.diff(motion.q, axis=0) / step
    assert np.abs(v / speeds).max() <= 1 + 1e-6
    a = np.diff(motion.q, 2, axis=0) / step**2
    assert np.abs(a / acceleration).max() <= 1 + 1e-3
    np.testing.assert_allclose(v, (motion.velocity[1:] + motion.velocity[:-1]) / 2, atol=1e-3)
    # the frame keeps the line and its orientation, by Pinocchio
    poses = fk(robot, motion.q)[robot.tip_frame]
    start, line = poses[0], np.array([0, 0.2, -0.1])
    along = (poses[:, :3, 3] - start[:3, 3]) @ line / (line @ line)
    off = np.linalg.norm(poses[:, :3, 3] - start[:3, 3] - along[:, None] * line, axis=1)
    assert off.max() <= motion.position_deviation + 1e-9
    assert off.max() >= 0.3 * motion.position_deviation
    assert (np.diff(along) > -1e-9).all()
    np.testing.assert_allclose(poses[:, :3, :3], start[None, :3, :3].repeat(5001, 0), atol=1e-4)
    least = clearances_at(problem, motion.q)[0].min()
    assert least - 5e-5 <= motion.clearance <= least + 1e-12
    np.testing.assert_allclose(motion.q[[0, -1]], result.q[[0, -1]], atol=1e-12)


def test_it_is_the_fastest_whatever_the_time_law_was():
    motions = [timed(lines((0, 0.2, -0.1), law=law, samples=401), 5.0)[1] for law in TimeLaw]
    durations = np.array([motion.duration for motion in motions])
    assert np.ptp(durations) < 0.01 * durations[0]
    quick = timed(lines((0, 0.2, -0.1), samples=401), 20.0)[1].duration
    assert quick == pytest.approx(durations[1] / 2, rel=0.1)


def test_a_spline_that_leaves_the_path_is_found_out():
    """Three samples of a line: the spline bends away, as the frame does by Pinocchio."""
    problem = lines((0, 0.2, -0.1), samples=3)
    result, motion = timed(problem, 5.0, more={"samples": 2001})
    assert result.verdict.success
    assert not motion.success
    assert motion.violations == ("tracking",)
    assert "more samples" in motion.message
    poses = fk(problem.arm.robot, motion.q)[problem.arm.robot.tip_frame]
    line = np.array([0, 0.2, -0.1])
    away = poses[:, :3, 3] - poses[0, :3, 3]
    off = np.linalg.norm(np.cross(away, line), axis=1) / np.linalg.norm(line)
    assert off.max() > problem.tolerance.position
    assert off.max() <= motion.position_deviation + 1e-6
    assert motion.position_deviation < 3 * off.max()


def test_a_spline_that_comes_too_near_is_found_out(line):
    robot = shipped_robot("planar_8r")
    q = np.deg2rad([110.0, -15, -25, -30, -30, -20, 0, 10])
    start = fk(robot, q)[robot.tip_frame][:3, 3]
    discs = [CircleObstacle((0.73, 0.22), 0.08), CircleObstacle((0.91, -0.04), 0.08)]
    shift = np.array([1.15, -0.15, 0]) - start
    problem = line(robot, q, shift, "xy", discs, link_radius=0.02, d_safe=0.02)
    result, motion = timed(problem, 2.0, 1.0, margin=0.0, more={"samples": 10_000})
    assert result.verdict.success
    least = clearances_at(problem, motion.q)[0].min()
    assert least < 0.02
    assert least - 5e-5 <= motion.clearance <= least + 1e-12
    assert motion.violations == ("clearance",)
    assert timed(problem, 2.0, 1.0, margin=0.004)[1].success


def test_corners_and_loops():
    corner = lines((0, 0.2, -0.1), (0.1, 0.2, -0.2), samples=401)
    _, motion = timed(corner, 5.0)
    assert motion.success, motion.message
    assert motion.slowed < 1.05
    robot, space = shipped_robot("panda"), task_from("position")
    start = fk(robot, PANDA)[robot.tip_frame]
    about = Circle(start[:3, 3] - [0, 0.1, 0], np.array([0.0, 0, 1]), 2.0)
    path = circle(start, about, space, Sampling(samples=401))
    problem = PathProblem(Arm.of(robot, None, space), PANDA, path, encoded([]))
    _, motion = timed(problem, 5.0, more={"samples": 2001})
    assert motion.success, motion.message
    p = fk(robot, motion.q)[robot.tip_frame][:, :3, 3] - about.center
    off = np.hypot(np.linalg.norm(p[:, :2], axis=1) - 0.1, p[:, 2])
    # chords of the circle are 1e-4 m off it; what is measured is the circle itself
    assert off.max() <= 1.3 * motion.position_deviation
    assert motion.position_deviation < 1e-6


@pytest.mark.parametrize("samples", [2, 3, 4])
def test_few_samples(samples):
    _, motion = timed(lines((0, 0.02, -0.01), samples=samples), 5.0)
    assert motion.status is RetimeStatus.RETIMED
    assert motion.acceleration_ratio <= 1 + 1e-9
    assert motion.q.shape == (101, 7)


def test_an_arm_that_does_not_move():
    _, motion = timed(lines((0, 0, 0)), 5.0)
    assert (motion.status, motion.success, motion.duration) == (RetimeStatus.NO_MOTION, True, 0.0)
    assert motion.q.shape == (1, 7)
    robot = shipped_robot("planar_3r")
    arm = Arm.of(robot, None, task_from("xy"))
    start = fk(robot, np.zeros(3))["tool"]
    goal = start.copy()
    goal[0, 3] -= 0.3
    path = polyline(start, [goal], arm.task, Sampling())
    stretched = PathProblem(arm, np.zeros(3), path, encoded([]))
    for method in ("pseudo_inverse", "damped", "qp"):
        _, motion = timed(stretched, 5.0, method=method)
        assert motion.status is RetimeStatus.NO_MOTION
        assert motion.violations == ("completeness",)
        assert not motion.success


@pytest.mark.parametrize("method", ["qp", "pseudo_inverse", "damped"])
def test_a_path_that_was_not_followed_is_no_success(method):
    problem = lines((3.0, 0, 0))
    result, motion = timed(problem, 5.0, method=method)
    assert not result.verdict.success
    assert not motion.success
    assert {"tracking", "completeness"} <= set(motion.violations)
    assert "samples" not in motion.message
    assert motion.velocity_ratio <= 1 + 1e-9


def test_joints_without_a_speed_limit_are_told(line):
    robot = shipped_robot("planar_8r")
    q = np.deg2rad([110.0, -15, -25, -30, -30, -20, 0, 10])
    problem = line(robot, q, (0.1, 0, 0), "xy")
    _, free = timed(problem, 2.0)
    assert free.velocity_ratio == 0.0
    assert "no speed limit is known of j1, j2" in free.warnings[0]
    assert np.isinf(free.velocity_limits).all()
    _, bound = timed(problem, 2.0, 0.05)
    assert not bound.warnings
    assert bound.velocity_ratio == pytest.approx(1, abs=1e-3)
    assert bound.duration > free.duration
    _, mixed = timed(problem, 2.0, [0.05] + [1e9] * 7)
    assert free.duration < mixed.duration <= bound.duration


def test_given_speeds_do_not_raise_the_robots_own():
    problem = lines((0, 0.2, -0.1))
    _, own = timed(problem, 100.0)
    _, given = timed(problem, 100.0, 50.0)
    assert given.duration == own.duration
    np.testing.assert_array_equal(given.velocity_limits, problem.arm.velocity)


@pytest.mark.parametrize("acceleration", [1e-6, 1e-3, 1e3, 1e9])
@pytest.mark.parametrize("velocity", [1e-6, 1.0, 1e9])
def test_limits_of_any_size(acceleration, velocity):
    _, motion = timed(lines((0, 0.2, -0.1)), acceleration, velocity)
    assert motion.success, motion.message
    assert max(motion.velocity_ratio, motion.acceleration_ratio) == pytest.approx(1, abs=1e-2)


def test_what_toppra_cannot_time_is_named(monkeypatch):
    problem = lines((0, 0.2, -0.1))
    result = followed(problem, METHODS["qp"], PathOptions())
    spline = spline_through(problem.arm.reduced(result.q))
    broken = replace(spline, unit=lambda s, order=0: np.nan * spline.unit(s, order))
    most = np.full(7, 5.0)
    found = fastest(broken, most, most)
    assert isinstance(found, str)
    assert found.startswith("no timing ")
    monkeypatch.setattr("kinematics.redundancy.timing.result.fastest", lambda *_: found)
    motion = retimed(result, limits(problem, 5.0))
    assert motion.status is RetimeStatus.NO_PARAMETRISATION
    assert not motion.success
    assert motion.message == found
    assert motion.duration is None
    assert motion.q.shape == (0, 7)


@pytest.mark.parametrize("method", ["qp", "damped", "sqp"])
@pytest.mark.parametrize("size", [1e-12, 1e-9, 1e-8, 1e-7, 2e-7, 5e-7, 1e-6, 1e-5])
def test_a_tiny_motion_is_timed_or_none(size, method):
    problem = lines((size, 0, 0))
    motion = retimed(followed(problem, METHODS[method], PathOptions()), limits(problem, 5.0))
    assert motion.success, motion.message
    assert "toppra" not in motion.message
    assert motion.status is (RetimeStatus.RETIMED if size > 1e-8 else RetimeStatus.NO_MOTION)
    if size > 1e-7:
        # The time grows with the root of the way.
        _, other = timed(lines((4 * size, 0, 0)), 5.0)
        assert other.duration == pytest.approx(2 * motion.duration, rel=0.01)


def test_without_toppra_it_is_refused(monkeypatch):
    retiming._toppra.cache_clear()
    monkeypatch.setitem(sys.modules, "toppra", None)
    with pytest.raises(MethodUnavailable, match="retiming") as caught:
        timed(lines((0, 0.2, -0.1)), 5.0)
    assert caught.value.location == ("retime",)
    assert (caught.value.package, caught.value.extra) == ("toppra", "retiming")


def test_it_is_quiet(capfd, caplog):
    caplog.set_level(logging.DEBUG)
    timed(lines((0, 0.2, -0.1)), 5.0)
    captured = capfd.readouterr()
    assert captured.out == captured.err == ""
    assert not [r for r in caplog.records if r.name.startswith(("toppra", "matplotlib"))]


def test_its_import_is_quiet():
    # In a process of its own: elsewhere another test may have imported it.
    code = (
        "import logging; logging.basicConfig(level=logging.DEBUG);"
        "from kinematics.redundancy.timing.toppra import require_toppra; require_toppra()"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not [line for line in ran.stderr.splitlines() if "toppra" in line]
    assert ran.stdout == ""


def test_bad_limits_are_named():
    problem = lines((0, 0, 0))
    for value in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InvalidOption) as caught:
            limits(problem, value)
        assert caught.value.location == ("retime", "acceleration")
        with pytest.raises(InvalidOption) as caught:
            limits(problem, 1.0, value)
        assert caught.value.location == ("retime", "velocity")
    with pytest.raises(InvalidOption) as caught:
        limits(problem, 1.0, samples=1)
    assert caught.value.location == ("retime", "samples")
