"""An arm as every peer gets it, its targets, and the check that decides what counts as solved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from kinematics.chain import chain_of
from kinematics.inverse.bounds import JointBounds
from kinematics.task import TASKS, Task
from robots.robot import FloatArray, Robot
from robots.shipped import shipped_robot

ARMS = {
    "panda": "pose",
    "ur5": "pose",
    "ur5_limited": "pose",
    "xarm7": "pose",
    "kinova": "pose",
    "puma560": "pose",
    "kr6_r900": "pose",
    "iiwa14": "pose",
    "pa10": "pose",
    "planar_8r": "xy_phi",
}
POSITION = ORIENTATION = 1e-6
ROUNDING = 1e-9
"""How far beyond a limit still counts as at it: what is lost where limits pass through text."""
RESTARTS = 50
"""Random starts for peers whose own interface has none."""
_INERTIAL = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
)


class Unsupported(Exception):
    """A peer cannot express an arm."""


@dataclass(frozen=True, eq=False)
class Arm:
    """One arm.

    Attributes:
        name: Id in the shipped library.
        robot: The robot; its Pinocchio model is what answers are checked on.
        task: What of a target counts.
        urdf: The chain from base to tip of the canonical URDF, without meshes.
        bounded: The same with ±π for joints without limits, for peers that need limits.
    """

    name: str
    robot: Robot
    task: Task
    urdf: Path
    bounded: Path

    @cached_property
    def seed(self) -> FloatArray:
        """Mid-range; 0 where there is no limit."""
        bounds = JointBounds.of(self.robot)
        return bounds.inside(bounds.middle())

    @cached_property
    def ranges(self) -> tuple[FloatArray, FloatArray]:
        """The limits, ±π where there is none."""
        return JointBounds.of(self.robot).ranges(1.0)

    @cached_property
    def slack(self) -> tuple[FloatArray, FloatArray]:
        """The limits, wider by what rounding may cost."""
        return self.robot.lower - ROUNDING, self.robot.upper + ROUNDING

    @cached_property
    def placements(self) -> FloatArray:
        """C_0 … C_K of the chain ``C_0 Rz(q_1) C_1 … C_K``; shape (K + 1, 4, 4)."""
        rows = chain_of(self.robot, self.robot.tip_frame).placements
        result = np.tile(np.eye(4), (len(rows), 1, 1))
        result[:, :3] = rows.reshape(-1, 3, 4)
        return result

    def random(self, rng: np.random.Generator) -> FloatArray:
        low, high = self.ranges
        return rng.uniform(low, high)

    def starts(self) -> list[FloatArray]:
        """The seed and RESTARTS random ones, always the same."""
        rng = np.random.default_rng(1)
        return [self.seed, *(self.random(rng) for _ in range(RESTARTS))]

    def targets(self, count: int, random_seed: int) -> FloatArray:
        """Poses of random q within the limits; shape (count, 4, 4)."""
        rng = np.random.default_rng(random_seed)
        return np.array([self.pose(self.random(rng)) for _ in range(count)])

    def pose(self, q: FloatArray) -> FloatArray:
        """Pose of the tip in the base's axes, by Pinocchio."""
        robot, data = self.robot, self.robot.data()
        pin.framesForwardKinematics(robot.model, data, robot.configuration(q))
        base = data.oMf[robot.frame_id(robot.base_frame)]
        return base.actInv(data.oMf[robot.frame_id(robot.tip_frame)]).homogeneous

    def within(self, q: FloatArray) -> bool:
        low, high = self.slack
        return bool(((q >= low) & (q <= high)).all())

    def clipped(self, q: FloatArray) -> FloatArray:
        """At the limits where the tolerance of a QP has let q beyond them."""
        return np.clip(q, self.robot.lower, self.robot.upper)

    def solved(self, q: FloatArray | None, target: FloatArray) -> bool:
        """Whatever the peer says: within the limits, and the pose measured by Pinocchio."""
        if q is None or q.shape != self.seed.shape or not np.isfinite(q).all():
            return False
        pose = self.pose(q)
        p = (pose[:3, 3] - target[:3, 3])[list(self.task.positions)]
        w = pin.log3(target[:3, :3] @ pose[:3, :3].T)[list(self.task.rotations)]
        reached = np.linalg.norm(p) <= POSITION and np.linalg.norm(w) <= ORIENTATION
        return bool(reached) and self.within(q)

    def turned(self, q: FloatArray) -> FloatArray:
        """Rows of angles, each angle by the whole turns that bring it nearest to the seed."""
        turned = self.seed + np.remainder(q - self.seed + np.pi, 2 * np.pi) - np.pi
        low, high = self.slack
        turned = np.where((turned < low) & (turned + 2 * np.pi <= high), turned + 2 * np.pi, turned)
        return np.where((turned > high) & (turned - 2 * np.pi >= low), turned - 2 * np.pi, turned)


def load(name: str, folder: Path) -> Arm:
    robot = shipped_robot(name)
    urdf, bounded = folder / f"{name}.urdf", folder / f"{name}_bounded.urdf"
    root = _chain_urdf(robot)
    urdf.write_text(ET.tostring(root, encoding="unicode"), "utf-8")
    for joint in root.iter("joint"):
        if joint.attrib["type"] == "continuous":
            joint.attrib["type"] = "revolute"
            for limit in joint.iter("limit"):
                limit.attrib |= {"lower": str(-np.pi), "upper": str(np.pi)}
    bounded.write_text(ET.tostring(root, encoding="unicode"), "utf-8")
    return Arm(name, robot, TASKS[ARMS[name]], urdf, bounded)


def _chain_urdf(robot: Robot) -> ET.Element:
    """The canonical URDF from base to tip: joints as they are, links with nothing but a mass."""
    parents = {}
    for joint in ET.fromstring(robot.urdf).iter("joint"):
        if (child := joint.find("child")) is not None:
            parents[child.attrib["link"]] = joint
    root, link = ET.Element("robot", name=robot.name), robot.tip_frame
    parts = []
    while link != robot.base_frame:
        joint = parents[link]
        for extra in ("mimic", "safety_controller", "dynamics", "calibration"):
            for found in joint.findall(extra):
                joint.remove(found)
        parts.append((joint, link))
        link = next(joint.iter("parent")).attrib["link"]
    root.append(ET.Element("link", name=robot.base_frame))
    for joint, child in reversed(parts):
        made = ET.SubElement(root, "link", name=child)
        made.append(ET.fromstring(_INERTIAL))
        root.append(joint)
    return root
