"""Links of an arm as capsules, from the shapes of its URDF, with warnings about gaps.

Everything that the arm's joints move keeps clear of obstacles, also what lies beyond the frame
(fingers, a tool, the rest of the arm) and on side branches. Joints that are not between base and
frame are fixed, so that these parts keep their placement at the start. Parts that no joint of the
arm moves, such as its base, are not included, as no motion changes their clearance; it is checked
once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from dh_to_urdf.messages import say
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.bounding import BoundingCapsule, bounding_capsule
from kinematics.redundancy.clearance.distances import pair_distance
from kinematics.redundancy.clearance.link_points import RADIUS
from kinematics.redundancy.clearance.links import Links, carried, skeleton
from kinematics.redundancy.clearance.polyline import carrier_poses
from robots.robot import FloatArray
from robots.shapes import Shape, link_shapes

NAMED = 5
"""Links that a warning names."""


@dataclass(frozen=True, eq=False)
class Part:
    """A capsule of a link.

    Attributes:
        link: Name of the URDF's link, or of the segment of the skeleton.
        joint: The last joint that moves it.
        shape: box, cylinder, sphere, capsule, mesh (its convex hull), or segment (between joint
            origins).
        radius: Of the capsule, m.
        length: Of its segment, m; None of a segment between joint origins, which may change.
        excess: Largest distance of the capsule's surface from the shape, m.
    """

    link: str
    joint: str
    shape: str
    radius: float
    length: float | None
    excess: float


@dataclass(frozen=True, eq=False)
class LinkGeometry:
    """Links of an arm.

    Attributes:
        links: The capsules.
        parts: Description of each.
        warnings: What the capsules do not cover.
        fixed: Capsules of parts that no joint moves; shape (n, 7): start, end, radius, m, in base
            axes.
        fixed_names: Names of their links.
    """

    links: Links
    parts: tuple[Part, ...]
    warnings: tuple[str, ...]
    fixed: FloatArray
    fixed_names: tuple[str, ...]


def link_geometry(arm: Arm, start: FloatArray, radii: FloatArray) -> LinkGeometry:
    """Return the links of an arm from its URDF.

    Each joint moves the capsules about its boxes, cylinders, spheres and capsules, and about the
    convex hulls of meshes that were uploaded. Where it also moves another mesh, or nothing with a
    shape, the pieces of the skeleton from there to the next joint are added, with the radius given
    for them.

    Args:
        arm: The arm.
        start: Configuration of all joints, shape (dof,), rad and m; fixes the other joints.
        radii: Radii of the segments that are added, m; shape (K,).
    """
    shapes = link_shapes(arm.robot)
    poses, carriers = _placements(arm, start, shapes)
    values = arm.chain.values(arm.reduced(start))
    inverse = [np.linalg.inv(T) for T in carrier_poses(arm, values)[:-1]]
    bones = skeleton(arm, radii)
    rows, names, segments, parts = [], [], [], []
    fixed, fixed_names = [], []
    known = set()
    for shape in shapes:
        if is_bare(shape):
            continue
        capsule = bounding_capsule(shape)
        carrier, T = carriers[shape.link], poses[shape.link]
        a, b = (T[:3, :3] @ p + T[:3, 3] for p in (capsule.start, capsule.end))
        if carrier < 0:
            fixed.append(np.r_[a, b, capsule.radius])
            fixed_names.append(shape.link)
            continue
        known.add(carrier)
        M = inverse[carrier]
        a, b = (M[:3, :3] @ p + M[:3, 3] for p in (a, b))
        rows.append(carried(carrier, a, b, capsule.radius))
        names.append(say("link {link}", link=shape.link))
        segments.append(-1)
        parts.append(_part(arm, carrier, shape, capsule))
    if arm.robot.bare is not arm.robot:
        k, name = arm.chain.length - 1, say("the tool")
        ends = [fk(one, start, [arm.frame])[arm.frame] for one in (arm.robot.bare, arm.robot)]
        a, b = (inverse[k][:3, :3] @ T[:3, 3] + inverse[k][:3, 3] for T in ends)
        radius = float(radii[arm.chain.leaders[k]])
        rows.append(carried(k, a, b, radius))
        names.append(name)
        segments.append(-1)
        length = float(np.linalg.norm(b - a))
        parts.append(Part(name, arm.chain.names[k], "segment", radius, length, 0.0))
    meshes = {carriers[s.link] for s in shapes if is_bare(s)}
    for k in range(arm.chain.length):
        if k in meshes or k not in known:
            name = say("segment {k}", k=k + 1)
            for row, segment in zip(bones.rows, bones.segments, strict=True):
                if segment != k:
                    continue
                rows.append(row)
                names.append(name)
                segments.append(k)
                joint, radius = arm.chain.names[k], float(row[RADIUS])
                parts.append(Part(name, joint, "segment", radius, None, 0.0))
    return LinkGeometry(
        Links(np.array(rows), tuple(names), tuple(segments)),
        tuple(parts),
        _warnings(arm, shapes, carriers, radii),
        np.array(fixed).reshape(-1, 7),
        tuple(fixed_names),
    )


def is_bare(shape: Shape) -> bool:
    """Return whether a shape is a mesh of which nothing is known."""
    return shape.kind == "mesh" and shape.hull is None


def too_near(geometry: LinkGeometry, obstacles: FloatArray, d_safe: float) -> tuple[str, ...]:
    """Return warnings about fixed parts that are nearer to an obstacle than d_safe."""
    found, out = [], np.empty(4)
    for capsule, name in zip(geometry.fixed, geometry.fixed_names, strict=True):
        for k, obstacle in enumerate(obstacles):
            d = pair_distance(capsule[:3].copy(), capsule[3:6].copy(), obstacle, out) - capsule[6]
            if d < d_safe:
                found.append(
                    say(
                        "link {name}, which no joint of the arm moves, is {d:.4g} m from"
                        " obstacle {k}; it is not counted",
                        name=name,
                        d=d,
                        k=k,
                    )
                )
    return tuple(found[:NAMED])


def _part(arm: Arm, carrier: int, shape: Shape, capsule: BoundingCapsule) -> Part:
    length = float(np.linalg.norm(capsule.end - capsule.start))
    joint = arm.chain.names[carrier]
    return Part(shape.link, joint, shape.kind, capsule.radius, length, capsule.excess)


def _placements(
    arm: Arm, start: FloatArray, shapes: Sequence[Shape]
) -> tuple[dict[str, FloatArray], dict[str, int]]:
    """Return the pose of each link with a shape, in base axes, and the joint that moves it.

    The carrier is the last joint of the chain between the base and the link, -1 for none.
    """
    robot, model = arm.robot, arm.robot.model
    base = robot.frame_id(robot.base_frame)
    links = list(dict.fromkeys(shape.link for shape in shapes))
    poses = fk(robot.bare, start, links)
    ids = [int(model.getJointId(name)) for name in arm.chain.names]
    order = {joint: k for k, joint in enumerate(ids)}
    base_path = _ancestors(model, int(model.frames[base].parentJoint))
    carriers = {}
    for name in links:
        frame = int(model.getFrameId(name, pin.FrameType.BODY))
        between = base_path ^ _ancestors(model, int(model.frames[frame].parentJoint))
        carriers[name] = max((order[joint] for joint in between if joint in order), default=-1)
    return poses, carriers


def _ancestors(model: pin.Model, joint: int) -> frozenset[int]:
    found = set()
    while joint > 0:
        found.add(joint)
        joint = int(model.parents[joint])
    return frozenset(found)


def _warnings(
    arm: Arm, shapes: Sequence[Shape], carriers: dict[str, int], radii: FloatArray
) -> tuple[str, ...]:
    way = say("between joint origins")
    if arm.robot.table is not None and not arm.chain.is_revolute.all():
        way = say("along z and x of the table's frames")
    instead = say(
        "the segments {way}, up to the frame {frame}, stand for it, with link_radius",
        way=way,
        frame=arm.frame,
    )
    if arm.robot.kind == "dh":
        return (say("a D-H table has no shapes; {instead}", instead=instead),)
    moved = [shape for shape in shapes if carriers[shape.link] >= 0]
    meshes = list(dict.fromkeys(s.link for s in moved if is_bare(s)))
    hulls = list(dict.fromkeys(s.link for s in moved if s.hull is not None))
    found = []
    if hulls:
        found.append(
            say(
                "the meshes of {links} count as capsules about their convex hulls: hollows are"
                " filled",
                links=_listed(hulls),
            )
        )
    if meshes:
        found.append(
            say(
                "meshes that were not uploaded are not counted, those of {meshes}; {instead}",
                meshes=_listed(meshes),
                instead=instead,
            )
        )
    bare = sorted(set(range(arm.chain.length)) - {carriers[shape.link] for shape in moved})
    if bare:
        joints = _listed([arm.chain.names[k] for k in bare])
        found.append(
            say(
                "nothing that moves with {joints} alone has a shape; {instead}",
                joints=joints,
                instead=instead,
            )
        )
    kept = {carriers[s.link] for s in moved if is_bare(s)} | set(bare)
    if kept and max(radii[arm.chain.leaders[k]] for k in kept) == 0.0:
        found.append(say("link_radius is 0: these segments are lines without thickness; give one"))
    return tuple(found)


def _listed(names: Sequence[str]) -> str:
    more = say(" and {count} more", count=len(names) - NAMED) if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
