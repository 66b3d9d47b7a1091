"""A checked URDF as plain values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from dh_to_urdf.table import Mimic

MOVING_TYPES = ("revolute", "prismatic", "continuous")
Triple: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Origin:
    """A placement.

    Attributes:
        xyz: Position, m.
        rpy: Angles about the fixed x, y and z axes, in this order, rad.
    """

    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class URDFJoint:
    """A joint as the file gives it, with a unit axis.

    Attributes:
        name: Its name.
        type: revolute, prismatic, continuous or fixed.
        parent: Parent link.
        child: Child link.
        origin: Placement of the joint, and of the child link at zero, in the parent link.
        axis: Unit vector in the joint's own axes; None for fixed joints.
        lower: Smallest value, rad or m; None for continuous and fixed joints.
        upper: Largest value.
        velocity: Largest speed, rad/s or m/s, if the file gives one.
        effort: Largest torque or force, if the file gives one.
        acceleration: Largest acceleration, rad/s² or m/s², if the file gives one.
        jerk: Largest jerk, rad/s³ or m/s³, if the file gives one.
        mimic: What it follows; None where it is a coordinate of q.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Origin = Origin()
    axis: Triple | None = None
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    mimic: Mimic | None = None


@dataclass(frozen=True)
class URDFDescription:
    """A checked URDF.

    Attributes:
        name: Name of the robot.
        links: Link names in the order of the file.
        joints: Joints in the order of the file.
        root: The link without a parent.
        canonical: URDF text with nothing but what was checked.
        warnings: What is doubtful, was assumed or was left out, the gravest first.
        doubts: Those of them about values that are probably meant in another unit.
        left_out: Those about what is left out.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[URDFJoint, ...]
    root: str
    canonical: str
    warnings: tuple[str, ...]
    doubts: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    @property
    def moving(self) -> tuple[URDFJoint, ...]:
        """Return the joints that move, free ones and followers, in the order of the file."""
        return tuple(joint for joint in self.joints if joint.type != "fixed")

    def default_tip(self) -> str:
        """Return the leaf of the longest chain, counted in moving joints, then in links.

        Of several, the one whose link is first in the file.
        """
        length = {self.root: (0, 0)}
        for joint in self.parents_first():
            moving, links = length[joint.parent]
            length[joint.child] = (moving + (joint.type != "fixed"), links + 1)
        parents = {joint.parent for joint in self.joints}
        return max((link for link in self.links if link not in parents), key=length.__getitem__)

    def parents_first(self) -> tuple[URDFJoint, ...]:
        """Return the joints in file order, each after the joint that carries its parent link."""
        below: dict[str, list[URDFJoint]] = {}
        for joint in reversed(self.joints):
            below.setdefault(joint.parent, []).append(joint)
        ordered: list[URDFJoint] = []
        waiting = list(below.get(self.root, ()))
        while waiting:
            joint = waiting.pop()
            ordered.append(joint)
            waiting.extend(below.get(joint.child, ()))
        return tuple(ordered)
