"""The arms, with four kinds of limits, as both programs get them."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from robots.robot import FloatArray, Robot, robot_from_urdf

ARMS = (
    "jaco2_ik",
    "gen3_lite_ik",
    "xarm6_ik",
    "piper_ik",
    "crx10ia_ik",
    "yam_ik",
    "hc10_ik",
    "xmatesr3_ik",
    "ur5_ik",
    "puma560_ik",
    "kr6_r900_ik",
    "irb120_ik",
)
"""Ready modules of ssik: each holds the placements and axes of its maker's URDF."""
LIMITS = ("a hair under ±π", "±π", "maker's", "none")
HAIR = 3.14159265
"""±π as files have it that were written with eight decimals."""

Limits = list[tuple[float, float] | None]


@dataclass(frozen=True, eq=False)
class Arm:
    """One arm with one kind of limits.

    Attributes:
        name: Of ssik's module.
        limits: Kind of limits.
        module: A copy of ssik's module with these limits.
        robot: The same arm of ours.
    """

    name: str
    limits: str
    module: ModuleType
    robot: Robot

    @cached_property
    def ranges(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper limits, infinite where there is none, shape (6,) each."""
        pairs = [joint.limits or (-np.inf, np.inf) for joint in self.module._KB.joints]
        low, high = np.array(pairs).T
        return low, high

    @cached_property
    def _parts(self) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
        parts = []
        for joint in self.module._KB.joints:
            x, y, z = joint.axis
            parts.append((joint.T_left, np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), joint))
        return [(left, K, joint.T_right) for left, K, joint in parts]

    def poses(self, q: FloatArray) -> list[FloatArray]:
        """Frames of the joints and of the flange, by Rodrigues' formula; independent of both."""
        T, frames = np.eye(4), []
        for angle, (left, K, right) in zip(q, self._parts, strict=True):
            turn = np.eye(4)
            turn[:3, :3] += np.sin(angle) * K + (1 - np.cos(angle)) * (K @ K)
            T = T @ left
            frames.append(T)
            T = T @ turn @ right
        return [*frames, T]

    def pose(self, q: FloatArray) -> FloatArray:
        """Pose of the flange, shape (4, 4)."""
        return self.poses(q)[-1]

    def jacobian(self, q: FloatArray) -> FloatArray:
        """Linear rows, then angular ones, in base axes; shape (6, 6)."""
        *frames, tip = self.poses(q)
        columns = []
        for frame, joint in zip(frames, self.module._KB.joints, strict=True):
            axis = frame[:3, :3] @ joint.axis
            columns.append(np.concatenate((np.cross(axis, tip[:3, 3] - frame[:3, 3]), axis)))
        return np.array(columns).T

    def random(self, rng: np.random.Generator) -> FloatArray:
        """A random q within the limits, ±π where there is none."""
        low, high = self.ranges
        return rng.uniform(np.maximum(low, -np.pi), np.where(low < -np.pi, np.pi, high).clip(max=7))

    def inside(self, q: FloatArray, slack: float) -> bool:
        """Whether whole turns bring q within limits that are wider by a slack."""
        low, high = self.ranges
        turns = np.ceil((low - slack - q) / (2 * np.pi))
        turns[~np.isfinite(turns)] = 0.0
        return bool((q + turns * 2 * np.pi <= high + slack).all())


def load(name: str, limits: str) -> Arm:
    """Return an arm with a kind of limits."""
    module = _copy(name)
    joints = module._KB.joints
    if limits != "maker's":
        range_of = {"none": None, "±π": (-np.pi, np.pi), LIMITS[0]: (-HAIR, HAIR)}[limits]
        joints = [replace(joint, limits=range_of) for joint in joints]
        module._KB = replace(module._KB, joints=joints)  # type: ignore[attr-defined]
    text = ET.tostring(_urdf(name, joints), encoding="unicode")
    return Arm(name, limits, module, robot_from_urdf(text))


def _copy(name: str) -> ModuleType:
    """Import ssik's module once more, so that its limits can be changed."""
    from ssik.prebuilt import _resolve_arm

    path = Path(str(_resolve_arm(name)[1].__file__))
    spec = importlib.util.spec_from_file_location(f"copy_of_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _urdf(name: str, joints: list[Any]) -> ET.Element:
    root = ET.Element("robot", name=name)
    ET.SubElement(root, "link", name="l0")
    before = np.eye(4)
    for k, joint in enumerate(joints):
        kind = "continuous" if joint.limits is None else "revolute"
        made = _joint(root, k, kind, before @ joint.T_left)
        ET.SubElement(made, "axis", xyz=" ".join(repr(float(x)) for x in joint.axis))
        if joint.limits is not None:
            low, high = (repr(float(x)) for x in joint.limits)
            ET.SubElement(made, "limit", lower=low, upper=high, effort="1", velocity="1")
        before = joint.T_right
    _joint(root, len(joints), "fixed", before)
    return root


def _joint(root: ET.Element, k: int, kind: str, placement: FloatArray) -> ET.Element:
    ET.SubElement(root, "link", name=f"l{k + 1}")
    made = ET.SubElement(root, "joint", name=f"j{k + 1}", type=kind)
    ET.SubElement(made, "parent", link=f"l{k}")
    ET.SubElement(made, "child", link=f"l{k + 1}")
    R, p = placement[:3, :3], placement[:3, 3]
    flat = np.hypot(R[0, 0], R[1, 0])
    pitch = np.arctan2(-R[2, 0], flat)
    if flat > 1e-12:
        roll, yaw = np.arctan2(R[2, 1], R[2, 2]), np.arctan2(R[1, 0], R[0, 0])
    else:
        roll, yaw = np.arctan2(-R[1, 2], R[1, 1]), 0.0
    numbers = {"xyz": p, "rpy": (roll, pitch, yaw)}
    ET.SubElement(
        made, "origin", {key: " ".join(repr(float(x)) for x in v) for key, v in numbers.items()}
    )
    return made


Solve = Callable[[FloatArray], list[FloatArray]]
