"""Closed forms go by the geometry: not by names, zero positions, directions, base or tool."""

from itertools import pairwise

import numpy as np
import pytest

from kinematics.chain import Chain, chain_of
from kinematics.inverse.closed_form import closed_form_of, solutions, swivel_of
from kinematics.inverse.closed_form.geometry import axis_lines
from kinematics.inverse.closed_form.quartic import roots
from kinematics.inverse.closed_form.subproblems import FREE, component, dihedral, distance
from kinematics.task import TASKS
from robots.shipped import shipped_robot


def unit(generator):
    v = generator.normal(size=3)
    return v / np.linalg.norm(v)


def rotation(h, angle):
    K = np.array([[0, -h[2], h[1]], [h[2], 0, -h[0]], [-h[1], h[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def placement(generator):
    T = np.eye(4)
    T[:3, :3] = rotation(unit(generator), generator.uniform(-np.pi, np.pi))
    T[:3, 3] = generator.uniform(-0.3, 0.3, 3)
    return T


def upright(generator):
    """A base that leaves vertical axes vertical, perhaps upside down."""
    T = placement(generator)
    T[:3, :3] = rotation(np.array([0.0, 0.0, 1.0]), generator.uniform(-np.pi, np.pi))
    if generator.random() < 0.5:
        T[:3, :3] = T[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    return T


def chain_from(directions, points, pose, turns):
    """The chain with given axes and a given pose of the frame at q = 0."""
    frames = [np.eye(4)]
    for h, p in zip(directions, points, strict=True):
        x = np.cross(h, np.eye(3)[int(np.argmin(np.abs(h)))])
        x /= np.linalg.norm(x)
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = np.column_stack((x, np.cross(h, x), h)), p
        frames.append(T)
    frames.append(pose)
    steps = [np.linalg.solve(a, b) for a, b in pairwise(frames)]
    count = len(directions)
    return Chain(
        np.array([step[:3].reshape(12) for step in steps]),
        np.asarray(turns, dtype=bool),
        np.arange(count),
        np.full(count, -np.inf),
        np.full(count, np.inf),
    )


def walk(chain, q):
    """Directions and points of the axes, and the pose of the frame, at q."""
    T, directions, points = np.eye(4), [], []
    for constant, turns, value in zip(chain.placements, chain.is_revolute, q, strict=False):
        T = T @ np.vstack((constant.reshape(3, 4), [0, 0, 0, 1]))
        directions.append(T[:3, 2])
        points.append(T[:3, 3])
        M = np.eye(4)
        if turns:
            M[:3, :3] = rotation(np.array([0.0, 0.0, 1.0]), value)
        else:
            M[2, 3] = value
        T = T @ M
    T = T @ np.vstack((chain.placements[-1].reshape(3, 4), [0, 0, 0, 1]))
    return np.array(directions), np.array(points), T


def differences(turns, a, b):
    d = a - b
    d[..., turns] = (d[..., turns] + np.pi) % (2 * np.pi) - np.pi
    return np.abs(d).max(axis=-1)


def solved(chain, target, q, swivel=None):
    form = closed_form_of(chain)
    psi = 0.0
    if form.kind == "srs":
        psi = swivel_of(form, q) if swivel is None else swivel
    return solutions(form, chain, target, task=TASKS[form.tasks[-1]], swivel=psi)


@pytest.mark.parametrize(
    "name",
    [
        "puma560",
        "rx90",
        "kr6_r900",
        "abb_irb140",
        "stanford",
        "kinova",
        "ur5",
        "ur10e",
        "z1",
        "scara",
        "planar_2r",
        "planar_3r",
        "pa10",
        "iiwa14",
    ],
)
def test_the_same_arm_described_otherwise(name):
    """Another base, tool, zero, direction of rotation and origin on each axis."""
    robot = shipped_robot(name)
    chain = chain_of(robot, robot.tip_frame)
    form = closed_form_of(chain)
    generator = np.random.default_rng(8)
    for _ in range(6):
        zero = generator.uniform(-1.5, 1.5, chain.length)
        directions, points, pose = walk(chain, zero)
        flat = form.kind.startswith("planar") or form.kind == "scara"
        base = upright(generator) if flat else placement(generator)
        signs = generator.choice([-1.0, 1.0], chain.length)
        slid = points + generator.uniform(-0.2, 0.2, (chain.length, 1)) * directions
        copy = chain_from(
            signs[:, None] * directions @ base[:3, :3].T,
            slid @ base[:3, :3].T + base[:3, 3],
            base @ pose,
            chain.is_revolute,
        )
        assert closed_form_of(copy).kind == form.kind
        for q in generator.uniform(-np.pi, np.pi, (4, chain.length)):
            target = walk(chain, q)[2]
            one = solved(chain, target, q)
            other = solved(copy, base @ target, signs * (q - zero))
            if form.kind == "srs":  # the reference plane moves with axis 1 alone
                assert len(other.q) == len(one.q)
                assert differences(chain.is_revolute, other.q, signs * (q - zero)).min() < 1e-6
                continue
            assert len(other.q) == len(one.q)
            for row in one.q:
                assert differences(chain.is_revolute, other.q, signs * (row - zero)).min() < 1e-6


def arm(kind, generator):
    """A random arm of a class, in general position otherwise."""
    h = [unit(generator) for _ in range(6)]
    p = [generator.normal(size=3) for _ in range(6)]
    if kind.startswith("parallel"):
        h[2], h[3] = h[1], -h[1]
        if kind == "parallel, 5 and 6 meeting":
            p[5] = p[4] + 0.3 * h[4] - 0.2 * h[5]
    else:
        p[3], p[4] = p[5] + 0.3 * h[3], p[5] - 0.1 * h[4]
        if kind == "1 and 2 meeting":
            p[1] = p[0] + 0.2 * h[0] - 0.4 * h[1]
        elif kind == "1 and 2 parallel":
            h[1] = -h[0]
        elif kind == "2 and 3 parallel":
            h[2] = -h[1]
        elif kind == "2 and 3 meeting":
            p[2] = p[1] + 0.2 * h[1] - 0.4 * h[2]
    return chain_from(h, p, placement(generator), np.ones(6))


@pytest.mark.parametrize(
    ("kind", "most"),
    [
        ("1 and 2 meeting", 8),
        ("1 and 2 parallel", 8),
        ("2 and 3 parallel", 8),
        ("2 and 3 meeting", 8),
        ("general", 8),
        ("parallel", 16),
        ("parallel, 5 and 6 meeting", 8),
    ],
)
def test_random_arms(kind, most):
    generator = np.random.default_rng(5)
    for _ in range(8):
        chain = arm(kind, generator)
        form = closed_form_of(chain)
        assert form.kind == ("parallel_axes" if kind.startswith("par") else "spherical_wrist")
        for q in generator.uniform(-np.pi, np.pi, (10, 6)):
            target = walk(chain, q)[2]
            found = solutions(form, chain, target)
            assert len(found.q) <= most
            assert len(found.q) % 2 == 0
            assert differences(chain.is_revolute, found.q, q).min() < 1e-6
            for row in found.q:
                np.testing.assert_allclose(walk(chain, row)[2], target, atol=1e-11)


def test_arms_without_a_closed_form():
    generator = np.random.default_rng(6)
    axes = [unit(generator) for _ in range(7)]
    points = [generator.normal(size=3) for _ in range(7)]
    for count in (1, 2, 5, 6, 7):
        chain = chain_from(axes[:count], points[:count], np.eye(4), np.ones(count))
        assert closed_form_of(chain) is None
    z = [np.array([0.0, 0.0, 1.0])] * 4
    assert closed_form_of(chain_from(z, points[:4], np.eye(4), np.ones(4))) is None
    assert closed_form_of(chain_from(z, points[:4], np.eye(4), [1, 0, 0, 1])) is None
    lying = [np.array([1.0, 0.0, 0.0])] * 3
    # Two joints on one axis.
    assert closed_form_of(chain_from(lying, [points[0]] * 3, np.eye(4), np.ones(3))) is None


def test_a_scara_in_any_order_and_on_the_wall():
    generator = np.random.default_rng(9)
    for slide in range(4):
        u, turns = unit(generator), np.arange(4) != slide
        points = generator.uniform(-0.5, 0.5, (4, 3))
        chain = chain_from([u, -u, u, u], points, placement(generator), turns)
        form = closed_form_of(chain)
        assert form.kind == "scara"
        assert form.tasks == ("pose",)
        for q in generator.uniform(-2, 2, (10, 4)):
            target = walk(chain, q)[2]
            found = solutions(form, chain, target)
            assert len(found.q) == 2
            assert differences(turns, found.q, q).min() < 1e-7
            for row in found.q:
                np.testing.assert_allclose(walk(chain, row)[2], target, atol=1e-12)


def test_rounded_angles_are_recognised():
    robot = shipped_robot("puma560")
    chain = chain_of(robot, robot.tip_frame)
    generator = np.random.default_rng(1)
    lines = axis_lines(chain)
    for _ in range(10):
        h = lines.directions + generator.normal(scale=5e-10, size=(6, 3))
        h /= np.linalg.norm(h, axis=1, keepdims=True)
        rounded = chain_from(h, lines.points, lines.pose, chain.is_revolute)
        form = closed_form_of(rounded)
        assert form is not None
        for q in generator.uniform(-np.pi, np.pi, (10, 6)):
            found = solutions(form, rounded, walk(rounded, q)[2])
            assert len(found.q) == 8
            assert found.position_errors.max() + found.orientation_errors.max() < 1e-12


def test_subproblems_against_what_they_undo():
    generator = np.random.default_rng(2)
    for _ in range(100):
        h, y, c, q = unit(generator), unit(generator), unit(generator), generator.uniform(-3, 3)
        v = rotation(h, q) @ y
        found, *angles = component(tuple(c), tuple(h), tuple(y), float(c @ v), 1.0)
        assert found == 2
        assert np.abs(np.exp(1j * np.array(angles)) - np.exp(1j * q)).min() < 1e-7
        for angle in angles:
            assert c @ rotation(h, angle) @ y == pytest.approx(c @ v, abs=1e-14)
        length = float(np.linalg.norm(v - c))
        found, *angles = distance(tuple(h), tuple(y), tuple(c), length, 1.0)
        assert found == 2
        for angle in angles:
            assert np.linalg.norm(rotation(h, angle) @ y - c) == pytest.approx(length, abs=1e-12)
    z = (0.0, 0.0, 1.0)
    assert component(z, z, (1.0, 0.0, 0.0), 0.0, 1.0)[0] == FREE
    assert component(z, z, (1.0, 0.0, 0.0), 0.1, 1.0)[0] == 0
    assert component((1.0, 0.0, 0.0), z, (1.0, 0.0, 0.0), 1.0 + 1e-12, 1.0) == (2, 0.0, 0.0)
    assert component((1.0, 0.0, 0.0), z, (1.0, 0.0, 0.0), 1.01, 1.0)[0] == 0


def test_a_spherical_triangle_keeps_its_digits():
    for small in (1e-1, 1e-8, 1e-15):
        found, angle = dihedral(np.pi / 2, np.pi / 2, small)
        assert found
        assert angle == pytest.approx(small, rel=1e-12)
    assert not dihedral(0.5, 0.5, 1.1)[0]


def test_roots_of_trigonometric_equations():
    generator = np.random.default_rng(3)
    found = np.empty(4)
    for _ in range(200):
        a, b = generator.uniform(-np.pi, np.pi, 2)
        # (cos(q - a) - cos b)(cos(q - a) + 2) has the roots a ± b.
        k = np.array([-2 * np.cos(b) + 0.5, 0, 0, 0.5 * np.cos(2 * a), 0.5 * np.sin(2 * a)])
        k[1:3] = (2 - np.cos(b)) * np.array([np.cos(a), np.sin(a)])
        n = roots(k, found)
        assert n == 2
        z = np.exp(1j * found[:2])
        for root in (a + b, a - b):
            assert np.abs(z - np.exp(1j * root)).min() < 1e-6
    assert roots(np.zeros(5), found) == FREE
    assert roots(np.array([0.0, 0.0, 1.0, 0.0, 0.0]), found) == 2
