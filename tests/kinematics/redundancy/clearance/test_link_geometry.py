"""Links from the shapes of a URDF, against Pinocchio's geometry and coal's distances."""

import coal
import numpy as np
import pinocchio as pin
import pytest
from lxml import etree
from scipy.spatial.transform import Rotation

from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.bounding import bounding_capsule
from kinematics.redundancy.clearance.distances import Pairs, Scene, clearances, near_pairs
from kinematics.redundancy.clearance.link_geometry import link_geometry, too_near
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
from kinematics.redundancy.follow import followed
from kinematics.redundancy.kernel import workspace
from kinematics.redundancy.measure import clearances_at, ends_of_links
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.task import task_from
from robots.robot import robot_from_urdf
from robots.shapes import Shape
from robots.shipped import shipped_robot
from tests.kinematics.redundancy.steps.test_gradients import numeric

CAPSULE = '<capsule radius="{0}" length="{1}"/>'
SPHERE = '<sphere radius="{0}"/>'
CYLINDER = '<cylinder radius="{0}" length="{1}"/>'
BOX = '<box size="{0} {1} {2}"/>'


def link(name, *shapes, kind="collision"):
    found = "".join(
        f'<{kind}><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{form}</geometry></{kind}>'
        for xyz, rpy, form in shapes
    )
    return f'<link name="{name}">{found}</link>'


def joint(name, kind, parent, child, xyz, rpy, axis="0 0 1"):
    limit = "" if kind == "fixed" else '<limit lower="-3" upper="3" effort="9" velocity="2"/>'
    turn = "" if kind == "fixed" else f'<axis xyz="{axis}"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/>{turn}{limit}</joint>'
    )


def tree(round_only):
    """An arm with a slide, a hand with a finger beyond the frame, and a branch with a joint."""
    boxy = () if round_only else (("0.1 0.02 0", "0.3 0.4 0.5", BOX.format(0.3, 0.1, 0.06)),)
    disc = () if round_only else (("0 0 0.01", "0.2 0 0", CYLINDER.format(0.09, 0.03)),)
    rod = () if round_only else (("0 0.1 0", "1.2 0.1 0", CYLINDER.format(0.03, 0.3)),)
    parts = [
        link("base", ("0 0 0.05", "0 0 0", SPHERE.format(0.1))),
        link("shoulder", ("0.02 0 0.1", "0 0.4 0", CAPSULE.format(0.05, 0.2)), *disc),
        link("upper", ("0.1 0.01 0.02", "0.1 1.5 0.3", CAPSULE.format(0.04, 0.3)), *boxy),
        link("slide", ("0 0 -0.05", "0 0 0", SPHERE.format(0.05)), *rod),
        link("hand", ("0 0.01 0.05", "1 0 0", CAPSULE.format(0.02, 0.1)), kind="visual"),
        link("finger", ("0.01 0 0.03", "0 0.2 0", CAPSULE.format(0.01, 0.05))),
        link("horn", ("0 0 0.1", "0.5 0 0", CAPSULE.format(0.02, 0.15))),
        joint("j1", "revolute", "base", "shoulder", "0 0 0.2", "0.1 0 0"),
        joint("j2", "revolute", "shoulder", "upper", "0.05 0 0.25", "1.4 0 0", "0 1 0"),
        joint("j3", "prismatic", "upper", "slide", "0.3 0 0.1", "0 0.3 0", "1 0 0"),
        joint("mount", "fixed", "slide", "hand", "0.1 0 0", "0 0.2 0.1"),
        joint("grip", "prismatic", "hand", "finger", "0 0.02 0.1", "0 0 0", "0 1 0"),
        joint("turn", "revolute", "shoulder", "horn", "-0.05 0 0.2", "0 0 0.2", "1 0 0"),
    ]
    return f'<robot name="tree">{"".join(parts)}</robot>'


WORLD = [
    Sphere((0.5, 0.3, 0.6), 0.1),
    Capsule((0.6, -0.5, 0.1), (0.4, -0.6, 1.1), 0.05),
    HalfSpace((0.1, 0.2, 1.0), -0.9),
    Box((-0.6, 0.3, 0.5), (0.2, 0.15, 0.3), Rotation.from_rotvec([0.3, 0.4, 0.5]).as_matrix()),
]


def shape_of(obstacle):
    """The coal shape and where it stands."""
    if isinstance(obstacle, Sphere):
        return coal.Sphere(obstacle.radius), pin.SE3(np.eye(3), np.array(obstacle.center))
    if isinstance(obstacle, Capsule):
        a, b = np.array(obstacle.start), np.array(obstacle.end)
        d = b - a
        R, _ = Rotation.align_vectors([d], [[0, 0, 1]])
        return coal.Capsule(obstacle.radius, np.linalg.norm(d)), pin.SE3(R.as_matrix(), (a + b) / 2)
    if isinstance(obstacle, HalfSpace):
        n = np.array(obstacle.normal)
        return coal.Halfspace(n / np.linalg.norm(n), obstacle.offset), pin.SE3.Identity()
    return coal.Box(*obstacle.size), pin.SE3(obstacle.rotation, np.array(obstacle.center))


def placement_of(origin):
    xyz, rpy = (
        np.array([float(word) for word in origin.get(key).split()]) for key in ("xyz", "rpy")
    )
    return pin.SE3(Rotation.from_euler("xyz", rpy).as_matrix(), xyz)


def coal_shape(form):
    size = [float(word) for value in form.attrib.values() for word in value.split()]
    return {
        "capsule": coal.Capsule,
        "sphere": coal.Sphere,
        "cylinder": coal.Cylinder,
        "box": coal.Box,
    }[form.tag](*size)


class Oracle:
    """All distances between the moving links' true shapes and the obstacles, by Pinocchio."""

    def __init__(self, robot, moving, world=WORLD):
        self.robot = robot
        model = pin.GeometryModel()
        self.names = []
        for element in etree.fromstring(robot.urdf.encode()).iter("collision", "visual"):
            link = element.getparent().get("name")
            if link in moving:
                frame = robot.model.frames[robot.model.getFrameId(link, pin.FrameType.BODY)]
                where = frame.placement * placement_of(element.find("origin"))
                shape, name = coal_shape(element.find("geometry")[0]), f"{link}{model.ngeoms}"
                model.addGeometryObject(pin.GeometryObject(name, frame.parentJoint, where, shape))
                self.names.append(link)
        links = model.ngeoms
        for k, obstacle in enumerate(world):
            shape, where = shape_of(obstacle)
            model.addGeometryObject(pin.GeometryObject(f"obstacle{k}", 0, where, shape))
            for j in range(links):
                model.addCollisionPair(pin.CollisionPair(j, links + k))
        self.model, self.data = model, pin.GeometryData(model)
        for request in self.data.distanceRequests:
            request.gjk_tolerance = 1e-12
        self.shape = len(world), links

    def at(self, q):
        """Shape (links, obstacles)."""
        robot = self.robot
        whole = robot.configuration(q)
        pin.computeDistances(robot.model, robot.data(), self.model, self.data, whole)
        found = np.array([result.min_distance for result in self.data.distanceResults])
        return found.reshape(self.shape).T


MOVING = {"shoulder", "upper", "slide", "hand", "finger", "horn"}


def setting(round_only, frame="hand"):
    robot = robot_from_urdf(tree(round_only), tip="hand")
    arm = Arm.of(robot, frame, task_from("position"))
    start = np.array([0.2, -0.3, 0.1, 0.04, 0.5])
    return robot, arm, start, link_geometry(arm, start, np.zeros(arm.K))


def pairs_at(arm, S, q, world):
    d, g = np.empty(len(S) * len(world)), np.empty((len(S) * len(world), arm.K))
    pairs = Pairs(d, g, np.empty((len(d), 2), dtype=np.int64))
    chain, W = arm.constants.chain, workspace(arm.K, len(S))
    count, _ = near_pairs(chain, q, Scene(world, S), 1e9, W, pairs)
    assert count == len(d)
    return d.reshape(len(S), len(world)), g.reshape(len(S), len(world), arm.K)


def test_what_moves_counts_with_its_true_shape_also_beyond_the_frame():
    robot, arm, start, geometry = setting(round_only=True)
    oracle = Oracle(robot, MOVING)
    names = [name.removeprefix("link ") for name in geometry.links.names]
    assert sorted(names) == sorted(oracle.names) == sorted(MOVING)
    assert geometry.fixed_names == ("base",)
    assert not geometry.warnings
    assert all(part.excess == 0.0 for part in geometry.parts)
    joints = {part.link: part.joint for part in geometry.parts}
    assert joints == {
        "shoulder": "j1",
        "horn": "j1",
        "upper": "j2",
        "slide": "j3",
        "hand": "j3",
        "finger": "j3",
    }
    order = [oracle.names.index(name) for name in names]
    world, rng = encoded(WORLD), np.random.default_rng(1)
    for _ in range(50):
        q = arm.reduced(start) + rng.uniform(-1.2, 1.2, arm.K) * [1, 1, 0.2]
        d, _ = pairs_at(arm, geometry.links.rows, q, world)
        expected = oracle.at(arm.expanded(q[None], start)[0])[order]
        apart = expected > 1e-3
        np.testing.assert_allclose(d[:, :3][apart[:, :3]], expected[:, :3][apart[:, :3]], atol=1e-9)
        # the distance to a box is coal's own iteration, which ends where it is exact enough
        np.testing.assert_allclose(d[:, 3][apart[:, 3]], expected[:, 3][apart[:, 3]], atol=1e-6)
        assert apart.mean() > 0.7


def test_gradients_are_those_of_the_true_distances():
    robot, arm, start, geometry = setting(round_only=True)
    oracle = Oracle(robot, MOVING)
    names = [name.removeprefix("link ") for name in geometry.links.names]
    order = [oracle.names.index(name) for name in names]
    world, rng, checked = encoded(WORLD), np.random.default_rng(2), 0

    def distances(q):
        return oracle.at(arm.expanded(q[None], start)[0])[order][:, :3]

    def ours(q):
        return pairs_at(arm, geometry.links.rows, q, world)[0]

    for _ in range(10):
        q = arm.reduced(start) + rng.uniform(-1, 1, arm.K) * [1, 1, 0.2]
        d, g = pairs_at(arm, geometry.links.rows, q, world)
        for function, columns in ((distances, 3), (ours, 4)):
            coarse, fine = (np.moveaxis(numeric(function, q, h), 0, -1) for h in (1e-4, 3e-5))
            smooth = np.abs(coarse - fine).max(axis=-1) < 1e-8
            smooth &= d[:, :columns] > 1e-3
            scale = max(1.0, np.abs(fine).max())
            found, expected = g[:, :columns][smooth], fine[smooth]
            np.testing.assert_allclose(found, expected, atol=1e-7 * scale)
            checked += smooth.sum()
    assert checked > 250


def test_boxes_and_cylinders_lie_within_their_capsules_which_stick_out_by_the_excess():
    robot, arm, start, geometry = setting(round_only=False)
    oracle = Oracle(robot, MOVING)
    used, order = [], []
    for part in geometry.parts:  # several shapes of a link come in the order of the file
        order.append(
            [k for k, n in enumerate(oracle.names) if n == part.link][used.count(part.link)]
        )
        used.append(part.link)
    world, rng = encoded(WORLD), np.random.default_rng(3)
    excess = np.array([part.excess for part in geometry.parts])[:, None]
    assert {part.shape for part in geometry.parts} == {"box", "cylinder", "capsule", "sphere"}
    assert (excess > 0).sum() == 3
    least = np.inf
    for _ in range(100):
        q = arm.reduced(start) + rng.uniform(-1.2, 1.2, arm.K) * [1, 1, 0.2]
        d, _ = pairs_at(arm, geometry.links.rows, q, world)
        expected = oracle.at(arm.expanded(q[None], start)[0])[order]
        apart = (expected > 1e-3) & (d > 0)
        assert (d <= expected + 1e-6)[apart].all()
        assert (d >= expected - excess - 1e-6)[apart].all()
        least = min(least, (expected - d)[apart & (excess > 0)].min())
    assert least < 0.01


@pytest.mark.parametrize("seed", range(40))
def test_every_corner_and_rim_is_within_the_capsule(seed):
    rng = np.random.default_rng(seed)
    size = 10 ** rng.uniform(-2, 0.5, 3)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3)
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T * size / 2
    angle = np.linspace(0, 2 * np.pi, 50)
    rim = np.column_stack((size[0] * np.cos(angle), size[0] * np.sin(angle), 0 * angle))
    up = np.array([0, 0, size[1] / 2])
    rims = np.concatenate((rim + up, rim - up))
    box, cylinder = Shape("a", "box", tuple(size), T), Shape("a", "cylinder", tuple(size[:2]), T)
    for shape, points in ((box, corners), (cylinder, rims)):
        capsule = bounding_capsule(shape)
        p = points @ T[:3, :3].T + T[:3, 3]
        d = capsule.end - capsule.start
        t = np.clip((p - capsule.start) @ d / max(d @ d, 1e-30), 0, 1)
        away = np.linalg.norm(p - capsule.start - t[:, None] * d, axis=1)
        assert away.max() <= capsule.radius + 1e-12
        assert away.max() >= capsule.radius - 1e-9
        assert 0 < capsule.excess <= capsule.radius


def test_nothing_is_missed_between_samples():
    _, arm, start, geometry = setting(round_only=False)
    chain = arm.constants.chain
    S, rng, tight = geometry.links.rows, np.random.default_rng(4), 0
    world = encoded([*WORLD, CircleObstacle((0.2, 0.7), 0.1)])
    scene, W = Scene(world, S), workspace(arm.K, len(S))
    for k in range(40):
        a = arm.reduced(start) + rng.uniform(-1, 1, arm.K) * [1, 1, 0.2]
        b = a + rng.normal(size=arm.K) * (0.3, 0.03, 1.0)[k % 3]
        bound = swept_clearance(chain, a, b, scene, np.inf, W)
        Q = a + np.linspace(0, 1, 2001)[:, None] * (b - a)
        dense, whose = np.empty(len(Q)), np.empty((len(Q), 2), dtype=np.int64)
        clearances(chain, Q, scene, W, dense, whose)
        assert bound <= dense.min() + 1e-12
        tight += bound >= dense.min() - 2 * RESOLUTION
    assert tight >= 35


def test_a_frame_in_the_middle_still_carries_the_rest_of_the_arm():
    robot, arm, start, geometry = setting(round_only=True, frame="upper")
    assert arm.K == 2
    assert {part.link for part in geometry.parts} == MOVING
    joints = {part.link: part.joint for part in geometry.parts}
    assert joints["finger"] == joints["slide"] == "j2"
    oracle = Oracle(robot, MOVING)
    order = [oracle.names.index(part.link) for part in geometry.parts]
    q = np.array([0.5, -0.6])
    d, _ = pairs_at(arm, geometry.links.rows, q, encoded(WORLD))
    expected = oracle.at(arm.expanded(q[None], start)[0])[order]
    np.testing.assert_allclose(d[:, :3], expected[:, :3], atol=1e-9)


def test_a_base_at_the_other_end_moves_what_was_the_base():
    robot = robot_from_urdf(tree(round_only=True), base="hand", tip="base")
    arm = Arm.of(robot, None, task_from("position"))
    start = np.array([0.2, -0.3, 0.1, 0.04, 0.5])
    geometry = link_geometry(arm, start, np.zeros(arm.K))
    assert set(geometry.fixed_names) == {"hand", "slide", "finger"}
    joints = {part.link: part.joint for part in geometry.parts}
    assert joints == {"upper": "j3", "shoulder": "j2", "horn": "j2", "base": "j1"}
    rng, world = np.random.default_rng(5), encoded([Sphere((0.0, 0.0, 0.0), 0.0)])
    for _ in range(10):
        q = rng.uniform(-1, 1, 3)
        d, _ = pairs_at(arm, geometry.links.rows, q, world)
        data = robot.data()
        whole = robot.configuration(arm.expanded(q[None], start)[0])
        pin.framesForwardKinematics(robot.model, data, whole)
        ball = data.oMf[robot.frame_id("base")] * np.array([0, 0, 0.05])
        away = data.oMf[robot.frame_id("hand")].inverse() * ball
        (k,) = (k for k, part in enumerate(geometry.parts) if part.link == "base")
        assert d[k, 0] == pytest.approx(np.linalg.norm(away) - 0.1, abs=1e-12)


def test_meshes_are_named_and_the_skeleton_stands_for_them():
    robot = shipped_robot("panda_urdf")
    arm = Arm.of(robot, None, task_from("position"))
    start = np.clip(np.zeros(robot.dof), robot.lower, robot.upper)
    geometry = link_geometry(arm, start, np.full(arm.K, 0.06))
    assert sum(part.shape == "segment" for part in geometry.parts) == 7
    assert {part.link for part in geometry.parts if part.shape == "box"} >= {"panda_leftfinger"}
    assert "not uploaded are not counted, those of panda_link1, panda_link2" in geometry.warnings[0]
    assert len(geometry.warnings) == 1
    bones = skeleton(arm, 0.06).rows
    kept = geometry.links.rows[-7:]
    np.testing.assert_array_equal(kept, bones)
    bare = link_geometry(arm, start, np.zeros(arm.K))
    assert "link_radius is 0" in bare.warnings[1]
    table = Arm.of(shipped_robot("panda"), None, task_from("position"))
    drawn = link_geometry(table, np.zeros(7), np.zeros(7))
    assert len(drawn.links) == 7
    assert "a D-H table has no shapes" in drawn.warnings[0]


def test_what_no_joint_moves_is_told_and_not_counted():
    _, arm, start, geometry = setting(round_only=True)
    world = [Sphere((0.0, 0.0, 0.16), 0.05), Sphere((3.0, 0.0, 0.0), 0.1)]
    told = too_near(geometry, encoded(world), 0.01)
    assert len(told) == 1
    assert "link base" in told[0]
    assert "-0.04 m from obstacle 0" in told[0]
    goal = np.eye(4)
    path = polyline(goal, [goal], arm.task, Sampling(samples=2))
    shaped = PathProblem(arm, start, path, encoded(world[1:]), shaped=geometry)
    assert clearances_at(shaped, arm.reduced(start)[None])[0][0] > 1.0


def test_an_arm_may_stand_on_the_floor():
    """The origin of a first joint that turns touches it, which nothing could change."""
    arm = Arm.of(shipped_robot("ur5"), None, task_from("position"))
    q = np.array([0.3, -1.2, 0.8, 0.3, 0.5, 0.0])
    S = skeleton(arm, 0.05).rows
    d, _ = pairs_at(arm, S, q, encoded([HalfSpace((0, 0, 1), 0.0)]))
    assert d.min() > 0.0
    assert d[0, 0] == pytest.approx(0.089159 - 0.05)


def test_radii_of_their_own():
    arm = Arm.of(shipped_robot("ur5"), None, task_from("position"))
    q = np.array([0.3, -1.2, 0.8, 0.3, 0.5, 0.0])
    radii = np.array([0.01, 0.08, 0.02, 0.03, 0.01, 0.0])
    lines, thick = (
        pairs_at(arm, skeleton(arm, r).rows, q, encoded(WORLD))[0] for r in (0.0, radii)
    )
    spheres = np.delete(np.arange(4), 2)
    np.testing.assert_allclose(thick[:, spheres], (lines - radii[:, None])[:, spheres], atol=1e-15)
    floor = HalfSpace((0, 0, -1), -5.0)
    d = pairs_at(arm, skeleton(arm, radii).rows, q, encoded([floor]))[0][:, 0]
    ends = [T[2, 3] for T in poses_of(arm, q)]
    starts_too = [False, True, False, True, False, False]
    expected = [
        5.0 - max([ends[k + 1], *([ends[k]] if starts_too[k] else [])]) - radii[k] for k in range(6)
    ]
    np.testing.assert_allclose(d, expected, atol=1e-12)


def poses_of(arm, q):
    """Poses of the joints and the frame, multiplied out."""
    T, found = np.eye(4), []
    for C, value in zip(arm.chain.placements, [*q, 0.0], strict=True):
        M = np.eye(4)
        M[:2, :2] = [[np.cos(value), -np.sin(value)], [np.sin(value), np.cos(value)]]
        T = T @ np.vstack((C.reshape(3, 4), [0, 0, 0, 1])) @ M
        found.append(T)
    return found


@pytest.mark.parametrize("method", ["sqp", "qp", "whole_path"])
def test_methods_keep_the_shapes_clear(method):
    robot, arm, start, geometry = setting(round_only=False)
    data = robot.data()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(start))
    pose = data.oMf[robot.frame_id("hand")].homogeneous
    goal = pose.copy()
    goal[:3, 3] += [-0.05, 0.15, -0.05]
    task = task_from("xy")
    arm = Arm.of(robot, "hand", task)
    path = polyline(pose, [goal], task, Sampling(samples=21))
    free = PathProblem(arm, start, path, encoded([]), shaped=geometry)
    plain = followed(free, METHODS["qp"], PathOptions())
    assert plain.verdict.success
    # a ball beside the finger, which is beyond the frame, where it would be half way
    (k,) = (k for k, part in enumerate(geometry.parts) if part.link == "finger")
    finger = ends_of_links(free, arm.reduced(plain.q))[12, k].mean(axis=0)
    beside = np.array([geometry.parts[k].radius + 0.04, 0, 0])
    ball = Sphere(finger + beside, 0.05)
    problem = PathProblem(arm, start, path, encoded([ball]), d_safe=0.005, shaped=geometry)
    unaware = followed(problem, METHODS["damped"], PathOptions())
    assert unaware.verdict.violations == ("clearance",)
    assert "link finger to obstacle 0" in unaware.verdict.message
    result = followed(problem, METHODS[method], PathOptions())
    assert result.verdict.success, result.verdict.message
    assert result.measures.min_swept >= 0.005
    oracle = Oracle(robot, MOVING, [ball])
    least = min(oracle.at(q).min() for q in result.q)
    assert least == pytest.approx(result.measures.clearance.min(), abs=1e-6)
