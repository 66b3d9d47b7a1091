"""Where a robot stands that floats: the part of a URDF whose poses follow from its joints.

A floating joint has no value of q, so it cuts the tree in two parts of which neither has a pose in
the other's axes. A robot whose root floats (a humanoid, a quadruped, a drone with an arm) stands
on the link below that joint; a planar joint at the root is the same, as the robot is driven about.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from robots.urdf.description import URDFJoint
from robots.urdf.faults import Faults
from robots.urdf.notes import Notes
from robots.urdf.values import Element, label_of


@dataclass(frozen=True, slots=True)
class Standing:
    """The part of a tree that is the robot.

    Attributes:
        links: Its links, in the order of the file.
        joints: Its joints.
        root: The link it stands on.
    """

    links: tuple[str, ...]
    joints: tuple[URDFJoint, ...]
    root: str


def stand(
    whole: Standing,
    base: str | None,
    faults: Faults,
    notes: Notes,
    element_of: Callable[[URDFJoint], Element],
) -> Standing:
    """Return the part of a tree that is computed.

    Args:
        whole: The tree.
        base: A link of the part that is asked for; None, or no link of the tree: the part below
            a joint at the root that floats.
        faults: Takes joints that float elsewhere.
        notes: Takes what is cut off.
        element_of: The element of a joint.
    """
    asked = base if base in whole.links else None
    cuts = _cuts(whole, asked)
    if not cuts:
        return whole
    part_of = _parts(whole, cuts)
    moving = {part_of[j.parent] for j in whole.joints if j.type != "fixed" and j not in cuts}
    if asked is not None:
        chosen: str | None = part_of[asked]
    else:
        elsewhere = [joint for joint in cuts if part_of[joint.parent] in moving]
        for joint in elsewhere or (cuts if len(moving) != 1 else ()):
            faults.add(element_of(joint), _not_here(joint))
        chosen = next(iter(moving)) if len(moving) == 1 and not elsewhere else None
    if chosen is None:
        return whole
    links = tuple(link for link in whole.links if part_of[link] == chosen)
    joints = tuple(j for j in whole.joints if j not in cuts and part_of[j.parent] == chosen)
    for joint in cuts:
        if chosen == part_of[joint.child]:
            _tell_base(joint, len(whole.links) - len(links), notes)
        elif chosen == part_of[joint.parent]:
            notes.add(
                say(
                    "{joint} is {type}: link {child} and what it carries are left out, as base"
                    " says",
                    joint=label_of("joint", joint.name),
                    type=joint.type,
                    child=quoted(joint.child),
                )
            )
    return Standing(links, joints, chosen)


def _cuts(whole: Standing, asked: str | None) -> tuple[URDFJoint, ...]:
    """Return the joints that float, and planar ones that carry the whole robot.

    A planar joint at the root is kept where its own side is asked for as the base.
    """
    above = {joint.child: joint for joint in whole.joints}
    cuts = []
    for joint in whole.joints:
        if joint.type == "floating":
            cuts.append(joint)
        elif joint.type == "planar" and _carries_all(joint, whole, above):
            link: str | None = asked
            while link is not None and link != joint.child:
                link = above[link].parent if link in above else None
            if asked is None or link == joint.child:
                cuts.append(joint)
    return tuple(cuts)


def _carries_all(planar: URDFJoint, whole: Standing, above: dict[str, URDFJoint]) -> bool:
    """Return whether every other joint that moves, and one at least, is below a joint."""
    found = False
    for joint in whole.joints:
        if joint is planar or joint.type in ("fixed", "floating"):
            continue
        link = joint.parent
        while link != planar.child and link in above:
            link = above[link].parent
        if link != planar.child:
            return False
        found = True
    return found


def _parts(whole: Standing, cuts: Sequence[URDFJoint]) -> dict[str, str]:
    """Return for each link the uppermost link of its part."""
    above = {joint.child: joint.parent for joint in whole.joints if joint not in cuts}
    tops: dict[str, str] = {}
    for link in whole.links:
        path = []
        while link not in tops and link in above:
            path.append(link)
            link = above[link]
        top = tops.get(link, link)
        tops[link] = top
        tops.update(dict.fromkeys(path, top))
    return tops


def _tell_base(joint: URDFJoint, count: int, notes: Notes) -> None:
    notes.add(
        say(
            "{joint} is {type}, so that the pose of the robot is free: link {child} is taken as"
            " the base, and link {parent} is left out",
            joint=label_of("joint", joint.name),
            type=joint.type,
            child=quoted(joint.child),
            parent=quoted(joint.parent),
        )
        + (say(", and {count} more links", count=count - 1) if count > 1 else "")
    )


def _not_here(joint: URDFJoint) -> str:
    return say(
        "joint {name!r}: type {type} is not supported here; write it as revolute and"
        " prismatic joints, or as fixed; or compute a part without it, with the query"
        " ?base=LINK, such as {parent} or {child}",
        name=joint.name,
        type=joint.type,
        parent=quoted(joint.parent),
        child=quoted(joint.child),
    )
