"""A robot as it is installed: on a base in the world, with a tool, within limits of its own.

Nothing of it is stored. The installed robot has the model of the robot, a frame more, whose axes
are those of the world, and in the place of each frame the same with the tool on it.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from dh_to_urdf import Limits
from dh_to_urdf.couplings import CouplingError, joint_map
from dh_to_urdf.messages import say
from dh_to_urdf.writer import UNBOUNDED
from robots.errors import WrongLimits, hint
from robots.joints import CoupledJoints, Joint
from robots.robot import FloatArray, Mounting, Robot

BOUNDS = ("lower", "upper", "velocity", "acceleration", "jerk")
KEPT = 16
"""Installations of one robot that are kept for the next request."""
_TOUCH = 1e-9
"""Excess of a limit, rad or m, that is rounding."""


@dataclass(frozen=True, eq=False)
class Installation:
    """What differs from the robot as it is stored.

    Attributes:
        base: Pose of the robot's base frame in the world, 4x4, m; None: the world is that frame.
        tool: Pose of the tool in each frame that is asked for, 4x4, m; None: there is none.
        limits: Of some joints, by name, those of ``BOUNDS`` that differ; None for no limit.
    """

    base: FloatArray | None = None
    tool: FloatArray | None = None
    limits: Mapping[str, Mapping[str, float | None]] = field(default_factory=dict)

    @property
    def key(self) -> tuple[object, ...]:
        """What tells it from others."""
        placements = (None if T is None else T.tobytes() for T in (self.base, self.tool))
        limits = (
            (name, *((key, one.get(key)) for key in BOUNDS if key in one))
            for name, one in self.limits.items()
        )
        return (*placements, frozenset(limits))


class _Kept:
    """The latest installations of one robot."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.found: OrderedDict[tuple[object, ...], Robot] = OrderedDict()


_KEPT: WeakKeyDictionary[Robot, _Kept] = WeakKeyDictionary()
_KEPT_LOCK = threading.Lock()


def installed(robot: Robot, installation: Installation) -> Robot:
    """Return a robot as it is installed; the latest ones are kept.

    Poses of the answer are in the axes of the world, and those of frames are poses of the tool
    on them. Its table, where there is one, has this base, and this tool after its own.

    Args:
        robot: As it is stored.
        installation: What differs.

    Raises:
        WrongLimits: Limits name no joint of the robot, or leave a joint no value.
    """
    if installation.base is None and installation.tool is None and not installation.limits:
        return robot
    with _KEPT_LOCK:
        kept = _KEPT.setdefault(robot, _Kept())
    key = installation.key
    with kept.lock:
        found = kept.found.get(key)
        if found is not None:
            kept.found.move_to_end(key)
            return found
    found = _install(robot, installation)
    with kept.lock:
        kept.found[key] = found
        while len(kept.found) > KEPT:
            kept.found.popitem(last=False)
    return found


def _install(robot: Robot, installation: Installation) -> Robot:
    # Nothing of the result refers to the robot that it is kept with.
    joints, coupled, warnings = _limited(robot, installation.limits)
    own = replace(
        robot,
        joints=joints,
        coupled=coupled,
        doubts=(*robot.doubts, *warnings),
        _local=threading.local(),
    )
    if installation.base is None and installation.tool is None:
        return own
    model, ids = robot.model.copy(), dict(robot._frame_ids)
    base_frame = robot.base_frame
    if installation.base is not None:
        base_frame = _free_name("world", ids)
        inverse = pin.SE3(installation.base).inverse()
        ids[base_frame] = _add(model, base_frame, ids[robot.base_frame], inverse)
    table = robot.table
    if table is not None and installation.base is not None:
        table = replace(table, base=installation.base @ table.base)
    bare = replace(
        own,
        model=model,
        base_frame=base_frame,
        table=table,
        mounting=Mounting(robot.base_frame, installation.base),
        _frame_ids=ids,
        _local=threading.local(),
    )
    if installation.tool is None:
        return bare
    T, with_tool = pin.SE3(installation.tool), dict(ids)
    for name in robot.frames:
        with_tool[name] = _add(model, _free_name(f"{name} tool", with_tool), ids[name], T)
    if base_frame == robot.base_frame:
        # The axes of answers stay those of the frame itself.
        base_frame = _free_name("world", ids)
        with_tool[base_frame] = ids[robot.base_frame]
    if table is not None:
        table = replace(table, tool=table.tool @ installation.tool)
    return replace(
        bare,
        base_frame=base_frame,
        table=table,
        mounting=Mounting(robot.base_frame, installation.base, installation.tool),
        without_tool=bare,
        _frame_ids=with_tool,
        _local=threading.local(),
    )


def _free_name(name: str, known: Mapping[str, int]) -> str:
    while name in known:
        name += "_"
    return name


def _add(model: Any, name: str, at: int, placement: Any) -> int:
    """Add a frame at a placement in another one; return its number."""
    frame = model.frames[at]
    added = pin.Frame(
        name, frame.parentJoint, at, frame.placement * placement, pin.FrameType.OP_FRAME
    )
    return int(model.addFrame(added, False))


def _limited(
    robot: Robot, limits: Mapping[str, Mapping[str, float | None]]
) -> tuple[tuple[Joint, ...], CoupledJoints | None, tuple[str, ...]]:
    """Return the entries of q and all joints within other limits, and what is doubtful."""
    if not limits:
        return robot.joints, robot.coupled, ()
    for name, bounds in limits.items():
        _check(moving_joint(robot, name), bounds)
    every = tuple(_changed(joint, limits.get(joint.name, {})) for joint in robot.moving)
    wider = tuple(
        sentence
        for one, before in zip(every, robot.moving, strict=True)
        if (sentence := _wider(one, before))
    )
    if any(bounds.get("jerk") is not None for bounds in limits.values()):
        wider = (*wider, say("limits of jerk are kept by no computation"))
    if robot.coupled is None:
        return every, None, wider
    relations = tuple(
        replace(
            one,
            limits=Limits(joint.lower, joint.upper, joint.velocity, joint.effort),
        )
        for one, joint in zip(robot.coupled.relations, every, strict=True)
    )
    try:
        found = joint_map(relations)
    except CouplingError as error:
        raise WrongLimits(str(error), relations[error.joint].name) from None
    joints = tuple(
        replace(every[k], lower=own.lower, upper=own.upper, velocity=own.velocity)
        for k, own in zip(found.free, found.limits, strict=True)
    )
    return joints, CoupledJoints(every, relations, found), wider


def moving_joint(robot: Robot, name: str) -> Joint:
    """Return the joint of a name, an entry of q or one that follows.

    Raises:
        WrongLimits: No joint that moves has this name.
    """
    for joint in robot.moving:
        if joint.name == name:
            return joint
    known = hint(name, tuple(joint.name for joint in robot.moving))
    raise WrongLimits(say("limits name joint {name!r}; {known}", name=name[:64], known=known), name)


def _check(joint: Joint, bounds: Mapping[str, float | None]) -> None:
    for key, value in bounds.items():
        if value is not None and not np.isfinite(value):
            message = say("limits.{joint}.{key} is no number", joint=joint.name, key=key)
            raise WrongLimits(message, joint.name, key)
        if key not in ("lower", "upper") and value is not None and not value > 0.0:
            message = say(
                "limits.{joint}.{key} is {value:g}; give a number above 0, or null for none",
                joint=joint.name,
                key=key,
                value=value,
            )
            raise WrongLimits(message, joint.name, key)
    lower, upper = bounds.get("lower", joint.lower), bounds.get("upper", joint.upper)
    if lower is not None and upper is not None and lower > upper:
        # The one that the request gives is at fault; of two the lower.
        message = say(
            "the limits of joint {joint} go from {lower:g} to {upper:g}, in rad or m; give a lower"
            " one that is not above the upper one",
            joint=joint.name,
            lower=lower,
            upper=upper,
        )
        raise WrongLimits(message, joint.name, "lower" if "lower" in bounds else "upper")


def _changed(joint: Joint, bounds: Mapping[str, float | None]) -> Joint:
    def bound(key: str, own: float | None) -> float | None:
        value = bounds.get(key, own)
        return None if value is None or abs(value) >= UNBOUNDED else value

    return replace(
        joint,
        lower=bound("lower", joint.lower),
        upper=bound("upper", joint.upper),
        velocity=bound("velocity", joint.velocity),
        acceleration=bound("acceleration", joint.acceleration),
        jerk=bound("jerk", joint.jerk),
    )


def _wider(joint: Joint, before: Joint) -> str | None:
    """Return a warning where a joint may go to where the robot's own limits do not let it."""
    below = before.lower is not None and (
        joint.lower is None or joint.lower < before.lower - _TOUCH
    )
    above = before.upper is not None and (
        joint.upper is None or joint.upper > before.upper + _TOUCH
    )
    if not below and not above:
        return None
    return say(
        "limits of the request let joint {name} go further than the robot's own do"
        " ({lower} to {upper}, rad or m)",
        name=joint.name,
        lower=_shown(before.lower),
        upper=_shown(before.upper),
    )


def _shown(value: float | None) -> str:
    return say("no limit") if value is None else f"{value:.6g}"
