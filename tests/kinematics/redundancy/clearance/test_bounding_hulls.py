"""Capsules about the hulls of meshes: they hold them, and stick out by no more than is said."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from kinematics.meshes.hulls import hull_of
from kinematics.redundancy.clearance.bounding import bounding_capsule
from robots.shapes import Shape
from robots.uploaded_mesh import Hull
from tests.torture.mesh_files import BOX


def clouds():
    rng = np.random.default_rng(3)
    for _ in range(12):
        yield rng.normal(size=(rng.integers(4, 200), 3)) * 10 ** rng.uniform(-2, 0, 3)
    yield BOX
    yield BOX[:4]  # flat
    yield np.array([[0, 0, 0], [0.3, 0.1, 0.2]])
    yield np.array([[0.1, 0.2, 0.3]])


@pytest.mark.parametrize("points", list(clouds()), ids=lambda p: str(len(p)))
def test_the_capsule_holds_the_mesh_and_its_excess_bounds_what_is_outside(points):
    rng = np.random.default_rng(0)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3)
    found = bounding_capsule(Shape("a", "mesh", (), T, hull_of(points)))
    placed = points @ T[:3, :3].T + T[:3, 3]
    d = found.end - found.start
    t = np.clip((placed - found.start) @ d / max(d @ d, 1e-300), 0, 1)
    away = np.linalg.norm(placed - found.start - t[:, None] * d, axis=1)
    assert away.max() <= found.radius * (1 + 1e-9) + 1e-15
    assert away.max() >= found.radius * (1 - 1e-6) - 1e-15
    assert 0 <= found.excess <= 2 * found.radius + 1e-12
    if np.linalg.matrix_rank(points - points.mean(axis=0)) == 3:
        u = rng.normal(size=(20_000, 3))
        u /= np.linalg.norm(u, axis=1)[:, None]
        surface = found.start + rng.choice([0.0, 1.0], (20_000, 1)) * d + found.radius * u
        equations = ConvexHull(placed).equations
        beyond = (surface @ equations[:, :3].T + equations[:, 3]).max(axis=1)
        assert beyond.max() <= found.excess + 1e-9
        assert beyond.max() >= 0.6 * found.excess


def test_a_long_box_gets_a_capsule_along_it():
    long = BOX * [0.1, 0.1, 10]
    found = bounding_capsule(Shape("a", "mesh", (), np.eye(4), hull_of(long)))
    assert np.linalg.norm(found.end - found.start) > 3.9
    assert found.radius < 0.03


def test_a_mesh_without_a_hull_has_none():
    with pytest.raises(TypeError, match="without a hull"):
        bounding_capsule(Shape("a", "mesh", (), np.eye(4)))


def test_the_excess_of_a_simpler_solid_adds_up():
    exact = hull_of(BOX)
    coarse = Hull(exact.vertices, exact.triangles, 0.5)
    shapes = (Shape("a", "mesh", (), np.eye(4), hull) for hull in (exact, coarse))
    one, other = (bounding_capsule(shape).excess for shape in shapes)
    assert other == pytest.approx(one + 0.5)
