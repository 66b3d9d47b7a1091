"""An untrusted URDF text -> a checked description."""

from __future__ import annotations

from lxml import etree

from dh_to_urdf.look_alikes import look_alikes
from dh_to_urdf.messages import say
from robots.errors import InvalidURDF, RobotTooLarge
from robots.urdf.description import MOVING_TYPES, URDFDescription
from robots.urdf.doubts import doubts_of, limits_left_out
from robots.urdf.joints import read_joint
from robots.urdf.limits import MAX_BYTES, MAX_DOF, MAX_LINKS
from robots.urdf.links import LinkReader, check_shapes
from robots.urdf.markup import parse
from robots.urdf.mimics import read_mimics
from robots.urdf.structure import check_structure
from robots.urdf.text import decode
from robots.urdf.tidy import tidy
from robots.urdf.tree import check_names, check_tree
from robots.urdf.values import Element, name_of


def read_urdf(text: str | bytes) -> URDFDescription:
    """Check a URDF and write its canonical form.

    Args:
        text: The XML text; at most ``MAX_BYTES`` bytes.

    Returns:
        The description.

    Raises:
        InvalidURDF: Not XML, not one tree, not finite, an unsupported joint type, …
        RobotTooLarge: More links, joints or shapes than are computed with.
    """
    source = parse(decode(text))
    mended = tidy(source)
    left_out = check_structure(source)
    name = name_of(source, say("the root element"))
    link_elements, joint_elements = source.findall("link"), source.findall("joint")
    _check_sizes(link_elements, joint_elements)
    robot = etree.Element("robot", name=name)
    reader = LinkReader(robot)
    reader.read_materials(source)
    links = tuple(reader.read(element) for element in link_elements)
    check_names("link", links)
    known = frozenset(links)
    joints = tuple(read_joint(element, robot, known) for element in joint_elements)
    check_names("joint", [joint.name for joint in joints])
    root = check_tree(links, joints)
    joints = read_mimics(joints, joint_elements, robot)
    if not any(joint.type != "fixed" for joint in joints):
        raise InvalidURDF(say("the robot has no joint that moves; give it one"))
    doubts = doubts_of(joints)
    unused = (
        *mended,
        *limits_left_out(joints, joint_elements),
        *reader.warnings(),
        *_left_out(left_out),
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


def _check_sizes(links: list[Element], joints: list[Element]) -> None:
    """Refuse what is too large, before anything of it is read."""
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
    moving = sum(element.get("type") in MOVING_TYPES for element in joints)
    if moving > MAX_DOF:
        raise RobotTooLarge(
            say(
                "the robot has {moving} joints; at most {max_dof} are computed",
                moving=moving,
                max_dof=MAX_DOF,
            )
        )
    check_shapes(links)


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


def _left_out(kinds: tuple[str, ...]) -> tuple[str, ...]:
    if not kinds:
        return ()
    shown = ", ".join(f"<{kind}>" for kind in kinds[:8]) + (", …" if len(kinds) > 8 else "")
    return (say("left out, since kinematics does not use it: {shown}", shown=shown),)
