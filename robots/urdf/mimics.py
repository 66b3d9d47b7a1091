"""``<mimic>``: joints that follow another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from dh_to_urdf import JointType, Limits
from dh_to_urdf.couplings import CouplingError, MovingJoint, joint_map
from dh_to_urdf.messages import say
from dh_to_urdf.table import Mimic
from dh_to_urdf.writer import UNBOUNDED
from robots.errors import InvalidURDF
from robots.urdf.description import MOVING_TYPES, URDFJoint
from robots.urdf.faults import Faults
from robots.urdf.values import Element, number

_ATTRIBUTES = ("joint", "multiplier", "offset")
_TOLD = 50
"""Followers at fault that are told."""


def read_mimic(joint: URDFJoint, element: Element, faults: Faults) -> URDFJoint:
    """Return a joint with what it follows; of a fixed joint that has no meaning.

    Args:
        joint: The joint.
        element: Its element.
        faults: Takes what is wrong with its <mimic>.
    """
    mimic = element.find("mimic")
    if mimic is None or joint.type not in MOVING_TYPES:
        return joint
    found = faults.read(
        mimic, None, lambda: _mimic(mimic, say("joint {joint!r}", joint=joint.name))
    )
    return joint if found is None else replace(joint, mimic=found)


def _mimic(mimic: Element, where: str) -> Mimic:
    other = mimic.get("joint")
    if other is None:
        raise InvalidURDF(
            say("{where}: <mimic> lacks the name of a joint; give joint=…", where=where)
        )
    unknown = [str(key) for key in mimic.attrib if key not in _ATTRIBUTES]
    if unknown:
        raise InvalidURDF(
            say(
                "{where}: <{tag}> has an attribute {key}; known are {known}",
                where=where,
                tag="mimic",
                key=repr(unknown[0][:64]),
                known=", ".join(_ATTRIBUTES),
            )
        )
    return Mimic(
        other, number(mimic, "multiplier", where, "1"), number(mimic, "offset", where, "0")
    )


def check_mimics(
    joints: Sequence[URDFJoint], faults: Faults, element_of: Callable[[URDFJoint], Element]
) -> None:
    """Keep as faults joints that follow none that moves, themselves, or beyond their limits.

    Args:
        joints: The joints.
        faults: Takes each follower at fault.
        element_of: The element of a joint.
    """
    found = list(joints)
    for _ in range(_TOLD):
        if all(joint.mimic is None for joint in found):
            return
        try:
            joint_map(*moving_joints(found))
        except CouplingError as error:
            moving = [k for k, joint in enumerate(found) if joint.type in MOVING_TYPES]
            at = moving[error.joint]
            faults.add(element_of(joints[at]), str(error))
            if found[at].mimic is None:
                return
            found[at] = replace(found[at], mimic=None)
        else:
            return


def moving_joints(
    joints: Sequence[URDFJoint],
) -> tuple[tuple[MovingJoint, ...], tuple[str, ...]]:
    """Return the joints that move, and the names of those that do not."""
    moving = tuple(
        MovingJoint(joint.name, JointType(joint.type), _limits(joint), joint.mimic)
        for joint in joints
        if joint.type in MOVING_TYPES
    )
    return moving, tuple(joint.name for joint in joints if joint.type not in MOVING_TYPES)


def _limits(joint: URDFJoint) -> Limits:
    """Return the limits of a joint, without those that stand for none."""
    given = (joint.lower, joint.upper, joint.velocity, joint.effort)
    return Limits(*(None if v is None or abs(v) >= UNBOUNDED else v for v in given))
