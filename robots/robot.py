"""Robot: joints, frames and model of one robot, immutable and safe to share between threads."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dh_to_urdf import DHTable, Limits, table_to_urdf
from dh_to_urdf.couplings import MovingJoint, joint_map, moving_joints, narrow_warnings, uncoupled
from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from dh_to_urdf.writer import BASE_LINK, TOOL_LINK, UNBOUNDED
from robots.errors import InvalidURDF, RobotTooLarge, UnknownFrame
from robots.joints import CoupledJoints, Joint
from robots.model import build_model
from robots.uploaded_mesh import UploadedMesh
from robots.urdf import MAX_DOF, URDFDescription, read_urdf
from robots.urdf.mesh_names import MeshNames, portable_name
from robots.urdf.mimics import moving_joints as joints_that_move

__all__ = [
    "FloatArray",
    "Joint",
    "Robot",
    "robot_from_table",
    "robot_from_urdf",
    "robot_with_meshes",
]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mounting:
    """Where an installed robot stands, and what it carries.

    Attributes:
        base_frame: The base frame of the robot itself.
        base: Its pose in the world, 4x4, m; None: the world is that frame.
        tool: Pose of the tool in each frame, 4x4, m; None: there is none.
    """

    base_frame: str
    base: FloatArray | None = None
    tool: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot that can be computed on.

    ``q`` holds one value a free joint, in the order of the table or the URDF file, in rad and m.
    Where joints depend on others, ``C q + c`` are the values of all that move. Pinocchio orders
    joints by the tree, parents first: :meth:`configuration` maps.

    Attributes:
        name: Name in the document.
        kind: What it was made from.
        revision: SHA-256 of kind, frames, URDF and uploaded meshes, hexadecimal.
        model: Pinocchio's model; not to be changed.
        joints: The entries of q, the free joints; limits of those that follow them narrow theirs.
        base_frame: Frame in whose axes results are given.
        tip_frame: Frame to compute for where none is named.
        frames: All frame (link) names in the order of the document.
        urdf: Canonical URDF text.
        table: The D-H table, for robots made from one.
        warnings: What is doubtful, was assumed or was left out, the gravest first.
        doubts: Those of them about values that are probably meant in another unit, which every
            computation tells.
        coupled: The values of all joints that move; None where every one of them is an entry of q.
        mounting: Of an installed robot, where it stands and what it carries.
        without_tool: Of a robot with a tool on its frames, the same with bare frames.
        meshes: Those that were uploaded of the meshes that the URDF names.
    """

    name: str
    kind: Literal["dh", "urdf"]
    revision: str
    model: Any
    joints: tuple[Joint, ...]
    base_frame: str
    tip_frame: str
    frames: tuple[str, ...]
    urdf: str
    table: DHTable | None = None
    warnings: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    coupled: CoupledJoints | None = None
    mounting: Mounting | None = None
    without_tool: Robot | None = None
    meshes: tuple[UploadedMesh, ...] = ()
    _frame_ids: Mapping[str, int] = field(default_factory=dict, repr=False)
    _local: threading.local = field(default_factory=threading.local, repr=False, compare=False)

    @property
    def bare(self) -> Robot:
        """Return the robot whose frames carry no tool: itself, but for an installed one."""
        return self.without_tool or self

    @property
    def dof(self) -> int:
        """Return the number of entries of q."""
        return len(self.joints)

    @cached_property
    def lower(self) -> FloatArray:
        """Return the lower limits, ``-inf`` where there is none, shape (dof,), rad and m."""
        return np.array([-np.inf if j.lower is None else j.lower for j in self.joints])

    @cached_property
    def upper(self) -> FloatArray:
        """Return the upper limits, ``inf`` where there is none, shape (dof,), rad and m."""
        return np.array([np.inf if j.upper is None else j.upper for j in self.joints])

    @cached_property
    def expected(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return bounds of q that nobody wonders at: its limits, else a turn; rad and m."""
        wide = np.where(self.is_revolute, 2 * np.pi * (1 + 1e-9), 50.0)
        lower = np.where(np.isfinite(self.lower), self.lower - 1e-9, -wide)
        upper = np.where(np.isfinite(self.upper), self.upper + 1e-9, wide)
        return tuple(lower.tolist()), tuple(upper.tolist())

    @cached_property
    def span(self) -> float:
        """Return a bound of the distance of any frame from the root, m; inf for a free slide."""
        placements = [placement.translation for placement in self.model.jointPlacements]
        lengths = sum(float(np.linalg.norm(one)) for one in placements)
        frames = [np.linalg.norm(frame.placement.translation) for frame in self.model.frames]
        slides = np.maximum(np.abs(self.lower), np.abs(self.upper))[~self.is_revolute]
        return float(lengths + max(frames, default=0.0) + slides.sum())

    @cached_property
    def is_revolute(self) -> NDArray[np.bool_]:
        """Return True where an entry of q is an angle; shape (dof,)."""
        return np.array([joint.type.is_revolute for joint in self.joints])

    @cached_property
    def is_periodic(self) -> NDArray[np.bool_]:
        """Return True where the robot is the same after a turn of an entry of q; shape (dof,)."""
        if self.coupled is None:
            return self.is_revolute
        return self.is_revolute & self.coupled.is_periodic

    @cached_property
    def moving(self) -> tuple[Joint, ...]:
        """Return all joints that move, free ones and followers, in the order of the document."""
        return self.joints if self.coupled is None else self.coupled.joints

    def joint_values(self, q: FloatArray) -> FloatArray:
        """Return the values of all joints that move, (…, dof) -> (…, m), rad and m."""
        return q if self.coupled is None else self.coupled.values(q)

    @cached_property
    def velocity_columns(self) -> NDArray[np.intp]:
        """Return the places of all joints that move in Pinocchio's configuration and tangents."""
        ids = [self.model.getJointId(joint.name) for joint in self.moving]
        return np.array([self.model.joints[i].idx_v for i in ids])

    @cached_property
    def _in_model_order(self) -> bool:
        return np.array_equal(self.velocity_columns, np.arange(self.model.nq))

    @cached_property
    def base_is_fixed(self) -> bool:
        """Return whether the base frame is Pinocchio's world, at every q."""
        frame = self.model.frames[self.frame_id(self.base_frame)]
        return bool(frame.parentJoint == 0 and frame.placement.isIdentity(0.0))

    def configuration(self, q: FloatArray) -> FloatArray:
        """Return Pinocchio's configuration of q, (dof,) -> (model.nq,); may be q itself."""
        values = self.joint_values(q)
        if self._in_model_order:
            return values
        configuration = np.empty(self.model.nq)
        configuration[self.velocity_columns] = values
        return configuration

    @property
    def is_large(self) -> bool:
        """Return whether Pinocchio's working memory of the whole robot would be too large.

        It grows with the cube of the joints (116 MB at 150): such a robot is computed chain by
        chain, from the constants of the chain that is asked for.
        """
        return bool(self.model.nv > MAX_DOF)

    def data(self) -> Any:
        """Return Pinocchio's working memory of this robot in this thread; not of a large one."""
        assert not self.is_large
        try:
            return self._local.data
        except AttributeError:
            self._local.data = self.model.createData()
            return self._local.data

    def frame_id(self, name: str, argument: str = "frame", index: Location = ()) -> int:
        """Return Pinocchio's number of a frame.

        Args:
            name: Name of the frame.
            argument: Name of the argument that holds the name, for the error.
            index: Where in the argument it stands, for the error.

        Raises:
            UnknownFrame: The robot has no such frame; the error lists the names that it has.
        """
        try:
            return self._frame_ids[name]
        except KeyError:
            raise UnknownFrame(name, self.frames, argument, index) from None


def robot_from_table(table: DHTable) -> Robot:
    """Build the robot of a D-H table: q in row order, ``base_link`` to ``tool``.

    Raises:
        RobotTooLarge: More than 64 joints.
        InvalidURDF: No joint moves.
    """
    moving = len(table.moving_rows)
    if moving > MAX_DOF:
        raise RobotTooLarge(
            say(
                "the table has {moving} joints; at most {max_dof} are computed",
                moving=moving,
                max_dof=MAX_DOF,
            )
        )
    if moving == 0:
        raise InvalidURDF(say("the table has no joint that moves"), ("joints",))
    urdf = table_to_urdf(table)
    # The model is the mechanism, whose joints are all free; the map of q knows the couplings.
    description = read_urdf(table_to_urdf(uncoupled(table)) if table.is_coupled else urdf)
    joints, coupled = _joints(*moving_joints(table))
    narrow = () if coupled is None else narrow_warnings(coupled.relations, coupled.map)
    frames = tuple(name for name in description.links if not name.startswith("link_"))
    return _build(
        description,
        kind="dh",
        joints=joints,
        coupled=coupled,
        frames=frames,
        base=BASE_LINK,
        tip=TOOL_LINK,
        table=table,
        urdf=urdf,
        identity=f"dh|{table.convention}|{','.join(row.type for row in table.rows)}",
        warnings=(*table.warnings, *narrow),
        doubts=table.doubts,
    )


def robot_from_urdf(
    text: str | bytes,
    *,
    base: str | None = None,
    tip: str | None = None,
    warnings: tuple[str, ...] | None = None,
    tell_left_out: bool = True,
    mesh_names: MeshNames = portable_name,
) -> Robot:
    """Build the robot of a URDF: q in file order, every joint that is not fixed.

    Args:
        text: The URDF.
        base: Frame in whose axes results are given; default the root link.
        tip: Frame to compute for where none is named; default the leaf of the longest chain.
        warnings: Warnings of an earlier reading, kept with a canonical text; None: of this one.
        tell_left_out: Whether warnings tell what of the file is left out.
        mesh_names: Names meshes in the canonical text.

    Raises:
        InvalidURDF: See :func:`robots.urdf.read_urdf`.
        RobotTooLarge: More links, joints or bytes than are computed with.
        UnknownFrame: base or tip is no link of the robot.
    """
    description = read_urdf(text, base, mesh_names)
    joints, coupled = _joints(*joints_that_move(description.joints))
    narrow = () if coupled is None else narrow_warnings(coupled.relations, coupled.map)
    if warnings is None:
        unused = () if tell_left_out else description.left_out
        kept = tuple(one for one in description.warnings if one not in unused)
        warnings = (*kept, *narrow) if tell_left_out else kept
    for role, name in (("base", base), ("tip", tip)):
        if name is not None and name not in description.links:
            raise UnknownFrame(name, description.links, role)
    return _build(
        description,
        kind="urdf",
        joints=_timed(joints, coupled, description),
        coupled=coupled,
        frames=description.links,
        base=base or description.root,
        tip=tip or description.default_tip(),
        table=None,
        urdf=description.canonical,
        identity="urdf",
        warnings=warnings,
        doubts=description.doubts,
    )


def _build(
    description: URDFDescription,
    *,
    kind: Literal["dh", "urdf"],
    joints: tuple[Joint, ...],
    coupled: CoupledJoints | None,
    frames: tuple[str, ...],
    base: str,
    tip: str,
    table: DHTable | None,
    urdf: str,
    identity: str,
    warnings: tuple[str, ...],
    doubts: tuple[str, ...],
) -> Robot:
    model = build_model(description)
    body = pin.FrameType.BODY
    frame_ids = {name: int(model.getFrameId(name, body)) for name in frames}
    return Robot(
        name=description.name,
        kind=kind,
        revision=_revision(identity, base, tip, urdf),
        model=model,
        joints=joints,
        coupled=coupled,
        base_frame=base,
        tip_frame=tip,
        frames=frames,
        urdf=urdf,
        table=table,
        warnings=warnings,
        doubts=doubts,
        _frame_ids=frame_ids,
    )


def robot_with_meshes(robot: Robot, meshes: Iterable[UploadedMesh]) -> Robot:
    """Return the robot of a URDF with these uploaded meshes and no others, ordered by name."""
    ordered = tuple(sorted(meshes, key=lambda one: one.name))
    digests = (part for one in ordered for part in (one.name, one.digest))
    revision = _revision("urdf", robot.base_frame, robot.tip_frame, robot.urdf, *digests)
    return replace(robot, meshes=ordered, revision=revision)


def _revision(*content: str) -> str:
    return hashlib.sha256("\x00".join(content).encode()).hexdigest()


def _joints(
    moving: tuple[MovingJoint, ...], fixed: tuple[str, ...]
) -> tuple[tuple[Joint, ...], CoupledJoints | None]:
    """Return the entries of q, and the map to all joints where it is not the identity."""
    every = tuple(_joint(joint, joint.limits) for joint in moving)
    if not any(joint.mimic or joint.coupling for joint in moving):
        return every, None
    found = joint_map(moving, fixed)
    joints = tuple(
        _joint(moving[k], limits) for k, limits in zip(found.free, found.limits, strict=True)
    )
    return joints, CoupledJoints(every, moving, found)


def _timed(
    joints: tuple[Joint, ...], coupled: CoupledJoints | None, description: URDFDescription
) -> tuple[Joint, ...]:
    """Return joints with limits of acceleration and jerk: their own, and those of followers."""
    given = {one.name: one for one in description.moving}
    if all(one.acceleration is None and one.jerk is None for one in given.values()):
        return joints
    names = [joint.name for joint in (joints if coupled is None else coupled.joints)]
    C = np.eye(len(names)) if coupled is None else coupled.matrix

    def least(column: int, key: Literal["acceleration", "jerk"]) -> float | None:
        found = [
            limit / abs(factor)
            for name, factor in zip(names, C[:, column], strict=True)
            if factor != 0.0 and (limit := getattr(given[name], key)) is not None
        ]
        return min(found, default=None)

    return tuple(
        replace(joint, acceleration=least(k, "acceleration"), jerk=least(k, "jerk"))
        for k, joint in enumerate(joints)
    )


def _joint(joint: MovingJoint, limits: Limits) -> Joint:
    """Return a joint, with None for limits that stand for none (1e6 and above)."""

    def bound(value: float | None) -> float | None:
        return None if value is None or abs(value) >= UNBOUNDED else value

    lower, upper = bound(limits.lower), bound(limits.upper)
    velocity, effort = bound(limits.velocity), bound(limits.effort)
    return Joint(joint.name, joint.type, lower, upper, velocity, effort)
