"""An untrusted URDF text -> a checked description, or all that is wrong with it."""

from __future__ import annotations

import re
from collections.abc import Sequence

from lxml import etree

from dh_to_urdf.look_alikes import look_alikes
from dh_to_urdf.messages import say
from robots.errors import InvalidURDF, RobotTooLarge
from robots.urdf.description import MOVING_TYPES, URDFDescription, URDFJoint
from robots.urdf.doubts import doubts_of, limits_left_out
from robots.urdf.faults import Faults
from robots.urdf.joints import JointReader, write_joint
from robots.urdf.limits import MAX_BYTES, MAX_DOF, MAX_JOINTS, MAX_LINKS
from robots.urdf.links import LinkReader
from robots.urdf.markup import parse
from robots.urdf.mesh_names import MeshNames, portable_name
from robots.urdf.mimics import check_mimics, read_mimic
from robots.urdf.notes import Notes
from robots.urdf.planar import without_planar
from robots.urdf.standing import Standing, stand
from robots.urdf.structure import Survey, left_out_sentence, survey
from robots.urdf.text import decode
from robots.urdf.tree import check_names, check_tree
from robots.urdf.values import Element, name_of

_QUATERNIONS_FROM = 1.1
"""Version of URDF that has ``quat_xyzw``."""
_VERSION = re.compile(r"[0-9]{1,3}(?:\.[0-9]{1,3})?")


def read_urdf(
    text: str | bytes, base: str | None = None, mesh_names: MeshNames = portable_name
) -> URDFDescription:
    """Check a URDF and write its canonical form.

    Args:
        text: The XML text; at most ``MAX_BYTES`` bytes.
        base: The link that is to be the base, where joints that float leave several.
        mesh_names: Names meshes in the canonical form.

    Returns:
        The description.

    Raises:
        InvalidURDF: Not XML, not one tree, not finite, an unsupported joint type, …; it holds
            all that is wrong.
        RobotTooLarge: More links or joints than are computed with.
    """
    faults, notes = Faults(), Notes()
    source = parse(decode(text, notes), notes)
    found = survey(source, faults, notes)
    _check_sizes(found)
    name = faults.read(source, "", lambda: name_of(source, say("the root element")))
    robot = etree.Element("robot")
    quaternions = _has_quaternions(source)
    reader = LinkReader(robot, faults, notes, quaternions, mesh_names)
    reader.read_materials(source)
    links = tuple(reader.read(element) for element in found.links)
    check_names("link", list(zip(links, found.links, strict=True)), faults)
    read = JointReader(frozenset(links), faults, notes, quaternions).read
    joints = tuple(read_mimic(read(e), e, faults) for e in found.joints)
    check_names("joint", [(j.name, e) for j, e in zip(joints, found.joints, strict=True)], faults)
    standing = _standing(links, joints, found, base, faults, notes)
    faults.check()
    assert standing is not None
    joints = standing.joints
    for one in [one for one in robot.iterfind("link") if one.get("name") not in standing.links]:
        robot.remove(one)
    links, joints = without_planar(standing.links, joints, notes)
    for link in links[len(standing.links) :]:
        etree.SubElement(robot, "link", name=link)
    for joint in joints:
        write_joint(joint, robot)
    robot.set("name", name)
    _check_chain(joints, base if base in links else standing.root)
    return _described(name, links, joints, standing.root, robot, found, reader, notes)


def _described(
    name: str,
    links: tuple[str, ...],
    joints: tuple[URDFJoint, ...],
    root: str,
    robot: Element,
    found: Survey,
    reader: LinkReader,
    notes: Notes,
) -> URDFDescription:
    doubts = doubts_of(joints)
    unused = (
        *notes.sentences(),
        *limits_left_out(found.joints),
        *reader.warnings(),
        *left_out_sentence(found.left_out),
    )
    told = (
        *doubts,
        *look_alikes(say("joints"), [joint.name for joint in joints]),
        *look_alikes(say("links"), links),
    )
    return URDFDescription(
        name=name,
        links=links,
        joints=joints,
        root=root,
        canonical=_written(robot),
        warnings=(*told, *unused),
        doubts=doubts,
        left_out=unused,
    )


def _standing(
    links: tuple[str, ...],
    joints: tuple[URDFJoint, ...],
    found: Survey,
    base: str | None,
    faults: Faults,
    notes: Notes,
) -> Standing | None:
    """Return the part of the tree that is computed; None where there is none."""
    elements = {id(joint): element for joint, element in zip(joints, found.joints, strict=True)}

    def element_of(joint: URDFJoint) -> Element:
        return elements[id(joint)]

    standing = None
    if len(set(links)) == len(links) and all(joint.parent and joint.child for joint in joints):
        root = check_tree(links, joints, faults, element_of)
        if root is not None:
            standing = stand(Standing(links, joints, root), base, faults, notes, element_of)
    if standing is None:
        for element, message in found.suspects:
            faults.add(element, message)
    kept = joints if standing is None else standing.joints
    if len({joint.name for joint in joints}) == len(joints):
        check_mimics(kept, faults, element_of)
    if not faults and not any(joint.type != "fixed" for joint in kept):
        faults.add(None, say("the robot has no joint that moves; give it one"))
    return standing


def _has_quaternions(source: Element) -> bool:
    version = source.get("version", "1.0")
    return bool(_VERSION.fullmatch(version)) and float(version) >= _QUATERNIONS_FROM


def _check_sizes(found: Survey) -> None:
    """Refuse what is too large, before anything of it is read."""
    links, joints = found.links, found.joints
    if not links:
        raise InvalidURDF(say("the robot has no <link>; a URDF has one a body"))
    if len(links) > MAX_LINKS:
        raise RobotTooLarge(
            say(
                "the robot has {count} links; at most {max_links} are computed",
                count=len(links),
                max_links=MAX_LINKS,
            )
        )
    if len(joints) > MAX_LINKS:
        raise RobotTooLarge(
            say(
                "the robot has {count} joints; at most {max_links} are computed",
                count=len(joints),
                max_links=MAX_LINKS,
            )
        )
    values = dict.fromkeys(MOVING_TYPES, 1) | {"planar": 3}
    moving = sum(values.get(element.get("type", ""), 0) for element in joints)
    if moving > MAX_JOINTS:
        raise RobotTooLarge(
            say(
                "the robot has {moving} joints; at most {max_dof} are computed",
                moving=moving,
                max_dof=MAX_JOINTS,
            )
        )


def _check_chain(joints: Sequence[URDFJoint], base: str) -> None:
    """Refuse a chain from the base that has more joints than are computed with."""
    beside: dict[str, list[URDFJoint]] = {}
    for joint in joints:
        beside.setdefault(joint.parent, []).append(joint)
        beside.setdefault(joint.child, []).append(joint)
    moving, waiting = {base: 0}, [base]
    while waiting:
        link = waiting.pop()
        for joint in beside.get(link, ()):
            other = joint.child if joint.parent == link else joint.parent
            if other not in moving:
                moving[other] = moving[link] + (joint.type != "fixed")
                waiting.append(other)
    longest = max(moving, key=moving.__getitem__)
    if moving[longest] > MAX_DOF:
        raise RobotTooLarge(
            say(
                "the chain from {base!r} to {tip!r} has {moving} joints; at most {max_dof} are"
                " computed",
                base=base,
                tip=longest,
                moving=moving[longest],
                max_dof=MAX_DOF,
            )
        )


def _written(robot: Element) -> str:
    etree.indent(robot, "  ")
    text = f'<?xml version="1.0"?>\n{etree.tostring(robot, encoding="unicode")}\n'
    if len(text.encode()) > MAX_BYTES:
        raise RobotTooLarge(
            say(
                "the URDF has over {max_bytes} bytes when its numbers are written out;"
                " leave out shapes",
                max_bytes=MAX_BYTES,
            )
        )
    return text
