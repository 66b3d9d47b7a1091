"""DHTable -> URDF, with every frame 0A_k as a named link.

Modified and khalil: the joint of row k has origin ``D_k = A_k(v = offset)`` and axis
``(0, 0, sign)``; link ``frame_k`` *is* 0A_k. Standard: ``A_k = Motion * C_k`` with
``C_k = A_k(v = offset)``, so the moving link ``link_k`` sits on z_{k-1} and a fixed child
``frame_k`` with origin C_k carries 0A_k. ``base_link`` -base-> ``frame_0``;
the last frame -tool-> ``tool``.

Followers have ``<mimic>``, of the free joint that they follow at last. The joint of a coupled row
comes after one joint more for each other joint that moves it, on the same axis, with ``<mimic>`` of
that one and a link without mass between; so the file is exact wherever mimic is read.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from dh_to_urdf.couplings import JointMap, joint_map, moving_joints
from dh_to_urdf.matrices import branch_matrix, link_matrix
from dh_to_urdf.poses import Matrix, from_xyz_rpy, to_rpy
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType, Limits

UNBOUNDED = 1e6
"""Value for "no limit" in URDF, which requires numbers (m, m/s, rad/s, N, N m)."""

BASE_LINK, TOOL_LINK = "base_link", "tool"
_COLOURS = {"a": "0.90 0.45 0.10 1", "d": "0.15 0.35 0.65 1", "joint": "0.25 0.25 0.28 1"}


def table_to_urdf(table: DHTable, *, visuals: bool = True) -> str:
    """Write the URDF of a table.

    Revolute joints without limits are ``continuous`` in URDF.

    Args:
        table: The table.
        visuals: Whether to draw cylinders along a and d.

    Returns:
        The URDF text; numbers are written with all their digits.
    """
    return _Writer(table, visuals).write()


def frame_name(k: int) -> str:
    """Name of the link that carries 0A_k."""
    return f"frame_{k}"


class _Writer:
    def __init__(self, table: DHTable, visuals: bool) -> None:
        self.table = table
        self.visuals = visuals
        self.robot = ET.Element("robot", name=table.name)
        self.standard = table.convention is Convention.STANDARD
        self.radius = self._radius()
        self.joint_names = {row.name for row in table.rows}
        self.links = {BASE_LINK, TOOL_LINK}
        for k in range(len(table.rows) + 1):
            self.links |= {frame_name(k), f"link_{k}"}
        self.couplings = _Couplings.of(table) if table.is_coupled else None

    def write(self) -> str:
        for label, rgba in _COLOURS.items():
            if self.visuals:
                material = ET.SubElement(self.robot, "material", name=label)
                ET.SubElement(material, "color", rgba=rgba)
        self._link(BASE_LINK)
        self._link(frame_name(0))
        self._fixed("base_to_frame_0", BASE_LINK, frame_name(0), self.table.base)
        for k, row in enumerate(self.table.rows, start=1):
            if self.standard:
                self._standard_row(k, row)
            else:
                self._modified_row(k, row)
        self._link(TOOL_LINK)
        tip = frame_name(self.table.tip_row)
        self._fixed(f"{tip}_to_tool", tip, TOOL_LINK, self.table.tool)
        if self.visuals:
            self._draw_tool(tip)
        ET.indent(self.robot, "  ")
        return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(
            self.robot, encoding="unicode"
        )

    def _standard_row(self, k: int, row: DHRow) -> None:
        C = link_matrix(row, Convention.STANDARD, np.float64(row.offset))
        parent, frame = frame_name(row.parent), frame_name(k)
        if row.type is JointType.FIXED:
            holder = self.robot.find(f"link[@name='{parent}']")
            if row.visual and self.visuals and holder is not None:
                self._draw_standard(holder, row)
            link = self._link(frame)
            self._joint(row, parent, frame, C)
            self._inertial(link, row, np.eye(4))
            return
        moving = f"link_{k}"
        link = self._link(moving)
        self._inertial(link, row, C)
        if row.visual and self.visuals:
            self._draw_standard(link, row)
        self._joint(row, parent, moving, np.eye(4))
        self._link(frame)
        self._fixed(f"{moving}_to_{frame}", moving, frame, C)

    def _modified_row(self, k: int, row: DHRow) -> None:
        D = link_matrix(row, self.table.convention, np.float64(row.offset))
        link = self._link(frame_name(k))
        self._inertial(link, row, np.eye(4))
        if row.visual and self.visuals:
            self._draw_modified(link, row)
        self._joint(row, frame_name(row.parent), frame_name(k), D)

    def _link(self, name: str) -> ET.Element:
        return ET.SubElement(self.robot, "link", name=name)

    def _fixed(self, name: str, parent: str, child: str, T: Matrix) -> None:
        while name in self.joint_names:
            name += "_"
        self.joint_names.add(name)
        joint = ET.SubElement(self.robot, "joint", name=name, type="fixed")
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=child)
        _origin(joint, T)

    def _joint(self, row: DHRow, parent: str, child: str, T: Matrix) -> None:
        type_ = urdf_joint_type(row)
        if self.couplings is not None and row.type is not JointType.FIXED:
            type_ = self.couplings.type_of(row)
            for name, coefficient in row.coupling:
                parent, T = self._coupled(row, name, coefficient, parent, T), np.eye(4)
        joint = ET.SubElement(self.robot, "joint", name=row.name, type=type_.value)
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=child)
        _origin(joint, T)
        if type_ is JointType.FIXED:
            return
        ET.SubElement(joint, "axis", xyz=f"0 0 {row.sign}")
        _limit(joint, type_, row.limits)
        if self.couplings is not None and row.mimic is not None:
            _mimic(joint, *self.couplings.followed(row.name, 1.0))

    def _coupled(self, row: DHRow, other: str, coefficient: float, parent: str, T: Matrix) -> str:
        """Write a joint on a row's axis that another joint moves; return its link."""
        assert self.couplings is not None
        name, link = f"{row.name}_by_{other}", f"{row.name}_by_{other}"
        while name in self.joint_names:
            name += "_"
        while link in self.links:
            link += "_"
        self.joint_names.add(name)
        self.links.add(link)
        self._link(link)
        slides = row.type is JointType.PRISMATIC
        type_ = JointType.PRISMATIC if slides else JointType.REVOLUTE
        joint = ET.SubElement(self.robot, "joint", name=name, type=type_.value)
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=link)
        _origin(joint, T)
        ET.SubElement(joint, "axis", xyz=f"0 0 {row.sign}")
        _limit(joint, type_, Limits())
        _mimic(joint, *self.couplings.followed(other, coefficient))
        return link

    def _inertial(self, link: ET.Element, row: DHRow, frame: Matrix) -> None:
        """Write mass properties of frame k in the link's axes (``frame``: k in it)."""
        if row.inertial is None:
            return
        element = ET.SubElement(link, "inertial")
        T = frame.copy()
        T[:3, 3] = frame[:3, :3] @ row.inertial.com + frame[:3, 3]
        _origin(element, T)
        ET.SubElement(element, "mass", value=repr(row.inertial.mass))
        (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = row.inertial.inertia
        values = {"ixx": ixx, "ixy": ixy, "ixz": ixz, "iyy": iyy, "iyz": iyz, "izz": izz}
        ET.SubElement(element, "inertia", {key: repr(value) for key, value in values.items()})

    def _radius(self) -> float:
        lengths = [abs(x) for row in self.table.rows for x in (row.a, row.d, row.b)]
        lengths += [abs(row.offset) for row in self.table.rows if not row.type.is_revolute]
        total = sum(lengths) + float(np.linalg.norm(self.table.tool[:3, 3]))
        return 0.025 * total / max(1, len(self.table.rows)) + 0.005 * total or 0.01

    def _draw_standard(self, link: ET.Element, row: DHRow) -> None:
        """Draw in link_k: along z_{k-1} by d, then along x_k by a."""
        theta = row.offset if row.type.is_revolute else row.theta
        d = row.offset if row.type is JointType.PRISMATIC else row.d
        self._draw_joint(link, row, np.eye(4))
        self._draw_rod(link, "d", from_xyz_rpy((0, 0, 0), (0, 0, 0)), d)
        along_x = from_xyz_rpy((0, 0, d), (0, 0, theta)) @ from_xyz_rpy(
            (0, 0, 0), (0, math.pi / 2, 0)
        )
        self._draw_rod(link, "a", along_x, row.a)

    def _draw_modified(self, link: ET.Element, row: DHRow) -> None:
        """Draw in frame_k back along z_k by d, and on the parent back along x_{k-1} by a."""
        d = row.offset if row.type is JointType.PRISMATIC else row.d
        self._draw_joint(link, row, np.eye(4))
        self._draw_rod(link, "d", np.eye(4), -d)
        parent = self.robot.find(f"link[@name='{frame_name(row.parent)}']")
        if parent is not None:
            start = branch_matrix(row) @ from_xyz_rpy((0, 0, 0), (0, math.pi / 2, 0))
            self._draw_rod(parent, "a", start, row.a)

    def _draw_tool(self, tip: str) -> None:
        link = self.robot.find(f"link[@name='{tip}']")
        offset = self.table.tool[:3, 3]
        length = float(np.linalg.norm(offset))
        if link is None or length == 0.0:
            return
        across = math.hypot(offset[0], offset[1])
        pitch, yaw = math.atan2(across, offset[2]), math.atan2(offset[1], offset[0])
        self._draw_rod(link, "a", from_xyz_rpy((0, 0, 0), (0, pitch, yaw)), length)

    def _draw_joint(self, link: ET.Element, row: DHRow, T: Matrix) -> None:
        if row.type.is_revolute:
            self._cylinder(link, "joint", T, 1.6 * self.radius, 3.0 * self.radius)

    def _draw_rod(self, link: ET.Element, label: str, T: Matrix, length: float) -> None:
        """Draw a cylinder from the origin of T along its z by ``length``, which may be negative."""
        if abs(length) > 1e-9:
            middle = T @ from_xyz_rpy((0, 0, length / 2), (0, 0, 0))
            self._cylinder(link, label, middle, self.radius, abs(length))

    def _cylinder(
        self, link: ET.Element, label: str, T: Matrix, radius: float, length: float
    ) -> None:
        visual = ET.SubElement(link, "visual")
        _origin(visual, T)
        geometry = ET.SubElement(visual, "geometry")
        ET.SubElement(geometry, "cylinder", radius=f"{radius:.6g}", length=repr(float(length)))
        ET.SubElement(visual, "material", name=label)


@dataclass(frozen=True, eq=False)
class _Couplings:
    """What the joints of a table depend on.

    Attributes:
        names: Names of the joints that move.
        map: Their map.
        leading: Names of the joints that lead, or are led.
    """

    names: tuple[str, ...]
    map: JointMap
    leading: frozenset[str]

    @classmethod
    def of(cls, table: DHTable) -> _Couplings:
        moving, fixed = moving_joints(table)
        found = joint_map(moving, fixed)
        names = tuple(joint.name for joint in moving)
        parts = np.abs(found.matrix) > 0
        led = {names[k] for k, joint in enumerate(moving) if joint.mimic or joint.coupling}
        for k, joint in enumerate(moving):
            if joint.mimic or joint.coupling:
                led |= {names[found.free[n]] for n in np.flatnonzero(parts[k])}
        return cls(names, found, frozenset(led))

    def type_of(self, row: DHRow) -> JointType:
        """Return the URDF type of a row: no continuous joint leads or follows in all readers."""
        return row.type if row.name in self.leading else urdf_joint_type(row)

    def followed(self, name: str, factor: float) -> tuple[str, float, float]:
        """Return the free joint, the multiplier and the offset of a joint times a factor."""
        k = self.names.index(name)
        line = self.map.coordinates[k]
        n = int(np.argmax(np.abs(line)))
        # Of several followers' offsets only the joint's own counts, not those of its couplings.
        return self.names[self.map.free[n]], factor * float(line[n]), factor * self.map.own[k]


def _mimic(joint: ET.Element, name: str, multiplier: float, offset: float) -> None:
    ET.SubElement(
        joint, "mimic", joint=name, multiplier=repr(float(multiplier)), offset=repr(float(offset))
    )


def urdf_joint_type(row: DHRow) -> JointType:
    """Return the URDF type of a row's joint: revolute without limits is ``continuous``."""
    if row.type is JointType.REVOLUTE and row.limits.lower is None:
        return JointType.CONTINUOUS
    return row.type


def _origin(element: ET.Element, T: Matrix) -> None:
    xyz = " ".join(repr(float(value)) for value in T[:3, 3])
    rpy = " ".join(repr(value) for value in to_rpy(T[:3, :3]))
    ET.SubElement(element, "origin", xyz=xyz, rpy=rpy)


def _limit(joint: ET.Element, type_: JointType, limits: Limits) -> None:
    velocity = UNBOUNDED if limits.velocity is None else limits.velocity
    effort = UNBOUNDED if limits.effort is None else limits.effort
    values = {"effort": effort, "velocity": velocity}
    if type_ is not JointType.CONTINUOUS:
        values["lower"] = -UNBOUNDED if limits.lower is None else limits.lower
        values["upper"] = UNBOUNDED if limits.upper is None else limits.upper
    ET.SubElement(joint, "limit", {key: repr(float(value)) for key, value in values.items()})
