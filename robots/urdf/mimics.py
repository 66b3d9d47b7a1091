"""``<mimic>``: joints that follow another, checked and written to the canonical URDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from lxml import etree

from dh_to_urdf import JointType, Limits
from dh_to_urdf.couplings import CouplingError, MovingJoint, joint_map
from dh_to_urdf.messages import say
from dh_to_urdf.table import Mimic
from dh_to_urdf.writer import UNBOUNDED
from robots.errors import InvalidURDF
from robots.urdf.description import URDFJoint
from robots.urdf.values import Element, number


def read_mimics(
    joints: Sequence[URDFJoint], elements: Sequence[Element], robot: Element
) -> tuple[URDFJoint, ...]:
    """Read the ``<mimic>`` of each joint that moves.

    Args:
        joints: The joints.
        elements: Their elements, in the same order.
        robot: The canonical root element, with their twins.

    Returns:
        The joints, with what they follow.

    Raises:
        InvalidURDF: A joint follows one that does not exist or move, or itself; limits of
            followers leave nothing; or a number is none.
    """
    twins = {str(twin.get("name")): twin for twin in robot.iterfind("joint")}
    found = []
    for joint, element in zip(joints, elements, strict=True):
        mimic = element.find("mimic")
        if mimic is None:
            found.append(joint)
            continue
        where = say("joint {joint!r}", joint=joint.name)
        other = mimic.get("joint")
        if other is None:
            raise InvalidURDF(
                say("{where}: <mimic> lacks the name of a joint; give joint=…", where=where)
            )
        multiplier = number(mimic, "multiplier", where, "1")
        offset = number(mimic, "offset", where, "0")
        if joint.type == "fixed":
            found.append(joint)
            continue
        written = {"joint": other, "multiplier": repr(multiplier), "offset": repr(offset)}
        etree.SubElement(twins[joint.name], "mimic", written)
        found.append(replace(joint, mimic=Mimic(other, multiplier, offset)))
    if any(joint.mimic is not None for joint in found):
        try:
            joint_map(*moving_joints(found))
        except CouplingError as error:
            raise InvalidURDF(str(error)) from None
    return tuple(found)


def moving_joints(
    joints: Sequence[URDFJoint],
) -> tuple[tuple[MovingJoint, ...], tuple[str, ...]]:
    """Return the joints that move, and the names of those that do not."""
    moving = tuple(
        MovingJoint(joint.name, JointType(joint.type), _limits(joint), joint.mimic)
        for joint in joints
        if joint.type != "fixed"
    )
    return moving, tuple(joint.name for joint in joints if joint.type == "fixed")


def _limits(joint: URDFJoint) -> Limits:
    """Return the limits of a joint, without those that stand for none."""
    given = (joint.lower, joint.upper, joint.velocity, joint.effort)
    return Limits(*(None if v is None or abs(v) >= UNBOUNDED else v for v in given))
