"""Distances against coal; swept clearances against dense sampling."""

import coal
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kinematics.errors import InvalidOption
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.distances import Scene, clearances, pair_distance
from kinematics.redundancy.clearance.links import skeleton
from kinematics.redundancy.clearance.obstacles import (
    Box,
    Capsule,
    CircleObstacle,
    HalfSpace,
    Sphere,
    encoded,
)
from kinematics.redundancy.clearance.sweep import RESOLUTION, swept_clearance
from kinematics.redundancy.kernel import workspace
from kinematics.task import task_from
from robots.shipped import shipped_robot

coordinate = st.floats(-1, 1, allow_subnormal=False)
point = st.tuples(coordinate, coordinate, coordinate).map(np.array)
radius = st.floats(0.01, 0.5)
edge = st.floats(0.05, 1.0)


def placed(a, b):
    """Length and coal placement of a capsule from a to b."""
    d = b - a
    length = float(np.linalg.norm(d))
    T = coal.Transform3s()
    if length > 1e-9:
        rotation, _ = Rotation.align_vectors([d / length], [[0, 0, 1]])
        T.setRotation(rotation.as_matrix())
    T.setTranslation((a + b) / 2)
    return length, T


def oracle(a, b, shape, where):
    length, T = placed(a, b)
    thickness = 1e-3
    result = coal.DistanceResult()
    request = coal.DistanceRequest()
    request.gjk_tolerance = 1e-10
    coal.distance(coal.Capsule(thickness, length), T, shape, where, request, result)
    return result.min_distance + thickness


def ours(a, b, obstacle):
    out = np.empty(4)
    d = pair_distance(a, b, encoded([obstacle])[0], out)
    assert 0 <= out[0] <= 1
    assert np.linalg.norm(out[1:]) == pytest.approx(1)
    return d, out


def at(center, rotation=None):
    T = coal.Transform3s()
    T.setTranslation(center)
    if rotation is not None:
        T.setRotation(rotation)
    return T


@settings(max_examples=150, deadline=None)
@given(point, point, point, radius)
def test_spheres(a, b, c, r):
    d, _ = ours(a, b, Sphere(c, r))
    if d > -r + 1e-3:
        assert d == pytest.approx(oracle(a, b, coal.Sphere(r), at(c)), abs=1e-6)


@settings(max_examples=150, deadline=None)
@given(point, point, point, point, radius)
def test_capsules(a, b, c, e, r):
    d, _ = ours(a, b, Capsule(c, e, r))
    if d > -r + 1e-3:
        length, T = placed(c, e)
        assert d == pytest.approx(oracle(a, b, coal.Capsule(r, length), T), abs=1e-5)


@settings(max_examples=300, deadline=None)
@given(point, point, point, st.tuples(edge, edge, edge), st.integers(0, 1000))
def test_boxes(a, b, c, size, seed):
    R = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    d, out = ours(a, b, Box(c, size, R))
    expected = oracle(a, b, coal.Box(*size), at(c, R))
    if d > 1e-6:
        assert d == pytest.approx(expected, abs=1e-6)
        witness = a + out[0] * (b - a) - d * out[1:]
        assert np.abs(R.T @ (witness - c)).max() <= max(size) / 2 + 1e-9
    elif np.linalg.norm(b - a) > 1e-3:
        # penetration: moving out by it along the direction makes them touch
        away = (1e-9 - d) * out[1:]
        assert ours(a + away, b + away, Box(c, size, R))[0] >= -1e-9
        assert d == pytest.approx(expected, abs=2e-3)


@settings(max_examples=100, deadline=None)
@given(point, point, point.filter(lambda n: np.linalg.norm(n) > 0.1), coordinate)
def test_half_spaces(a, b, n, offset):
    d, _ = ours(a, b, HalfSpace(n, offset))
    unit = n / np.linalg.norm(n)
    shape = coal.Halfspace(unit, offset)
    assert d == pytest.approx(oracle(a, b, shape, coal.Transform3s()), abs=1e-6)


@settings(max_examples=100, deadline=None)
@given(point, point, point, radius)
def test_circles_do_not_look_at_the_height(a, b, c, r):
    d, _ = ours(a, b, CircleObstacle(c[:2], r))
    flat = np.array([1.0, 1.0, 0.0])
    assert d == pytest.approx(ours(a * flat, b * flat, Sphere(c * flat, r))[0], abs=1e-12)


def test_bad_obstacles_are_named():
    for bad, field in (
        (Sphere((0, 0), 1), "center"),
        (Sphere((0, 0, np.nan), 1), "center"),
        (Sphere((0, 0, 0), -1), "radius"),
        (HalfSpace((0, 0, 0), 1), "normal"),
        (Box((0, 0, 0), (1, 0, 1)), "size"),
    ):
        with pytest.raises(InvalidOption) as caught:
            encoded([Sphere((0, 0, 0), 1), bad])
        assert caught.value.location == ("obstacles", 1, field)


@pytest.mark.parametrize("name", ["planar_8r", "pa10", "scara"])
def test_nothing_is_missed_between_samples(name):
    arm = Arm.of(shipped_robot(name), None, task_from("position"))
    chain = arm.constants.chain
    rng, tight = np.random.default_rng(3), 0
    S = skeleton(arm, 0.03).rows
    W = workspace(arm.K, len(S))
    for k in range(60):
        a = rng.uniform(-1.5, 1.5, arm.K)
        b = a + rng.normal(size=arm.K) * (0.3, 0.03, 1.0)[k % 3]
        world = encoded(
            [
                Sphere(rng.uniform(-1, 1, 3), 0.1),
                Box(rng.uniform(-1, 1, 3), (0.1, 0.2, 0.3)),
                CircleObstacle(rng.uniform(-1, 1, 2), 0.1),
            ]
        )
        scene = Scene(world, S)
        bound = swept_clearance(chain, a, b, scene, np.inf, W)
        Q = a + np.linspace(0, 1, 2001)[:, None] * (b - a)
        dense, whose = np.empty(len(Q)), np.empty((len(Q), 2), dtype=np.int64)
        clearances(chain, Q, scene, W, dense, whose)
        assert bound <= dense.min() + 1e-12
        tight += bound >= dense.min() - 2 * RESOLUTION
        enough = dense.min() - 0.01
        assert swept_clearance(chain, a, b, scene, enough, W) >= enough
    assert tight >= 50
