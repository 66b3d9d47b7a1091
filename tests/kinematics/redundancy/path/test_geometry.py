"""Time laws and sampled paths."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from kinematics.errors import InvalidOption
from kinematics.redundancy.path.geometry import Circle, Sampling, circle, polyline
from kinematics.redundancy.path.time_law import TimeLaw
from kinematics.task import task_from

POSE, XY, POSITION = task_from("pose"), task_from("xy"), task_from("position")


@pytest.mark.parametrize("law", list(TimeLaw))
def test_rates_are_the_derivatives(law):
    s = np.linspace(0.001, 0.999, 997)
    h = 1e-6
    r, rate, acceleration = law.at(s)
    ahead, behind = law.at(s + h), law.at(s - h)
    np.testing.assert_allclose(rate, (ahead[0] - behind[0]) / (2 * h), atol=1e-8)
    away = np.abs(np.abs(s - 0.5) - 0.25) > 2 * h  # the trapezoid's acceleration jumps there
    numeric = (ahead[1] - behind[1]) / (2 * h)
    np.testing.assert_allclose(acceleration[away], numeric[away], atol=1e-7)
    np.testing.assert_allclose(law.at(np.array([0.0, 1.0]))[0], [0, 1], atol=1e-15)
    assert (np.diff(r) > 0).all()
    if law is not TimeLaw.LINEAR:
        np.testing.assert_allclose(law.at(np.array([0.0, 1.0]))[1], 0, atol=1e-14)


def test_the_cubic_law_of_the_course(exercises):
    expected = next(e["value"] for k, e in exercises.items() if k.startswith("E9_"))
    path = polyline(np.eye(4), [np.eye(4)], POSE, Sampling(TimeLaw.CUBIC, 2.0, 401))
    assert path.r[100] == expected["r"]
    assert path.t[100] == 0.5
    assert path.r_dot.max() == pytest.approx(expected["rdot_max"])
    assert np.abs(path.r_ddot).max() == pytest.approx(expected["rddot_max"])


def test_a_line_turns_by_slerp():
    rng = np.random.default_rng(0)
    for _ in range(20):
        start, goal = np.eye(4), np.eye(4)
        ends = Rotation.random(2, rng)
        start[:3, :3], goal[:3, :3] = ends.as_matrix()
        start[:3, 3], goal[:3, 3] = rng.normal(size=(2, 3))
        path = polyline(start, [goal], POSE, Sampling(samples=11))
        T = path.targets.reshape(-1, 3, 4)
        expected = Slerp([0, 1], ends)(path.r).as_matrix()
        np.testing.assert_allclose(T[:, :, :3], expected, atol=1e-12)
        line = start[:3, 3] + path.r[:, None] * (goal - start)[:3, 3]
        np.testing.assert_allclose(T[:, :, 3], line, atol=1e-12)
        assert not path.closed


def test_a_frame_that_points_down_turns_about_z_like_any_other():
    """What an angle about z alone asks of it: its tilt stays, its heading becomes the angle."""
    task = task_from("xy_phi")
    for heading, wanted, turn in ((0.4, -0.9, -1.3), (3.0, -3.0, 2 * np.pi - 6.0)):
        start, goal = np.eye(4), np.eye(4)
        start[:3, :3] = Rotation.from_euler("ZX", (heading, np.pi)).as_matrix()
        goal[:3, :3] = Rotation.from_euler("z", wanted).as_matrix()
        path = polyline(start, [goal], task, Sampling(samples=11))
        T = path.targets.reshape(-1, 3, 4)
        turned = Rotation.from_euler("z", turn * path.r[:, None]).as_matrix()
        np.testing.assert_allclose(T[:, :, :3], turned @ start[:3, :3], atol=1e-12)


def test_waypoints_are_samples_and_a_loop_is_closed():
    corners = [np.eye(4) for _ in range(4)]
    for T, xy in zip(corners, [(1, 0), (1, 2), (0, 2), (0, 0)], strict=True):
        T[:2, 3] = xy
    path = polyline(np.eye(4), corners, XY, Sampling(TimeLaw.LINEAR, 6.0, 61))
    points = path.targets[:, [3, 7]]
    for T in corners:
        assert (np.abs(points - T[:2, 3]).max(axis=1) < 1e-12).any()
    np.testing.assert_allclose(np.linalg.norm(np.diff(points, axis=0), axis=1), 0.1, atol=1e-12)
    assert path.closed
    with pytest.raises(InvalidOption, match="waypoints"):
        polyline(np.eye(4), corners, XY, Sampling(samples=4))


def test_a_circle_keeps_its_distance_and_closes_after_whole_turns():
    start = np.eye(4)
    start[:3, 3] = 1.0, 2.0, 3.0
    about = Circle(np.array([0.5, 0.0, 0.0]), np.array([1.0, 1.0, 2.0]), 2.0)
    path = circle(start, about, POSITION, Sampling(samples=201))
    p = path.targets[:, [3, 7, 11]]
    n = about.normal / np.linalg.norm(about.normal)
    across = np.cross(p - about.center, n)
    np.testing.assert_allclose(np.linalg.norm(across, axis=1), np.linalg.norm(across[0]))
    np.testing.assert_allclose(p @ n, p[0] @ n)
    np.testing.assert_allclose(p[100], p[0], atol=1e-12)
    assert path.closed
    half = circle(start, Circle(about.center, n, 0.5), POSITION, Sampling(samples=5))
    assert not half.closed
    with pytest.raises(InvalidOption, match="plane"):
        circle(start, about, XY, Sampling())
