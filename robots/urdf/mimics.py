"""Joints that mimic another: checked, then treated as independent, with a warning.

Every joint that moves is in q, so that q has the same entries in every reader of the file. The
warning states the relation between the two entries of q.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dh_to_urdf.cells.notation import number_text
from dh_to_urdf.errors import quoted
from robots.errors import InvalidURDF
from robots.urdf.description import URDFJoint
from robots.urdf.values import Element, number


def read_mimics(joints: Sequence[URDFJoint], elements: Sequence[Element]) -> tuple[str, ...]:
    """Check the ``<mimic>`` of each joint.

    Args:
        joints: The joints.
        elements: Their elements, in the same order.

    Returns:
        A warning for each joint that moves and mimics another.

    Raises:
        InvalidURDF: A joint mimics one that does not exist, or itself; or a number is none.
    """
    moves = {joint.name: joint.type != "fixed" for joint in joints}
    followed: dict[str, str] = {}
    warnings = []
    for joint, element in zip(joints, elements, strict=True):
        mimic = element.find("mimic")
        if mimic is None:
            continue
        where = f"joint {joint.name!r}"
        other = mimic.get("joint")
        if other is None:
            raise InvalidURDF(f"{where}: <mimic> lacks the name of a joint; give joint=…")
        if other not in moves:
            raise InvalidURDF(
                f"{where} mimics {quoted(other, 64)}, which does not exist; mend the name or"
                " remove <mimic>"
            )
        factor = number(mimic, "multiplier", where, "1")
        offset = number(mimic, "offset", where, "0")
        followed[joint.name] = other
        if moves[joint.name] and not moves[other]:
            warnings.append(
                f"joint {joint.name!r} mimics {quoted(other, 64)}, which does not move; it is"
                f" treated as independent: give it {number_text(offset)}"
            )
        elif moves[joint.name]:
            warnings.append(
                f"joint {joint.name!r} mimics another; it is treated as independent: give it"
                f" {number_text(factor)} times the value of {quoted(other, 64)}"
                + (f" plus {number_text(offset)}" if offset else "")
            )
    _refuse_loops(followed)
    return tuple(warnings)


def _refuse_loops(followed: Mapping[str, str]) -> None:
    settled: set[str] = set()
    for start in followed:
        path: list[str] = []
        name = start
        while name in followed and name not in settled:
            if name in path:
                raise InvalidURDF(
                    f"joint {name!r} mimics itself"
                    + (f" by way of {followed[name]!r}" if followed[name] != name else "")
                    + "; remove one <mimic>"
                )
            path.append(name)
            name = followed[name]
        settled.update(path)
