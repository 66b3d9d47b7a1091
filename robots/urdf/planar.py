"""Planar joints as joints with one value each: two slides in the plane, a turn about its normal.

URDF gives the normal of the plane as the axis of the joint and does not say which directions in it
are counted. Here they are the two axes of the joint that follow the normal in the order x, y, z
(for z: x and y, as Pinocchio has it); for an oblique normal, these two turned with it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.writer import UNBOUNDED
from robots.urdf.description import Origin, Triple, URDFJoint
from robots.urdf.notes import Notes
from robots.urdf.values import label_of

_AXES = "xyz"


def without_planar(
    links: Sequence[str], joints: Sequence[URDFJoint], notes: Notes
) -> tuple[tuple[str, ...], tuple[URDFJoint, ...]]:
    """Return links and joints with three joints, and two links between them, for each planar one.

    Args:
        links: Names of the links.
        joints: The joints.
        notes: Takes the names of the joints that are written.
    """
    taken = {*links, *(joint.name for joint in joints)}
    more: list[str] = []
    written: list[URDFJoint] = []
    for joint in joints:
        if joint.type != "planar":
            written.append(joint)
            continue
        three = _three(joint, taken)
        taken.update(one.name for one in three)
        more += [one.child for one in three[:2]]
        written += three
        first, second, turn = (quoted(one.name) for one in three)
        notes.add(
            say(
                "{joint} is planar: it is read as the slides {first} and {second}, and the turn"
                " {turn}",
                joint=label_of("joint", joint.name),
                first=first,
                second=second,
                turn=turn,
            )
        )
    return (*links, *more), tuple(written)


def _three(joint: URDFJoint, taken: set[str]) -> list[URDFJoint]:
    assert joint.axis is not None
    u, v, suffixes = _directions(joint.axis)
    names: list[str] = []
    for suffix in (*suffixes, "turn"):
        name = f"{joint.name}_{suffix}"
        while name in taken or name in names:
            name += "_"
        names.append(name)
    first, second, turn = names
    return [
        _slide(first, joint.parent, joint.origin, u),
        _slide(second, first, Origin(), v),
        URDFJoint(turn, "continuous", second, joint.child, axis=joint.axis),
    ]


def _slide(name: str, parent: str, origin: Origin, axis: Triple) -> URDFJoint:
    """Return a slide, whose link has its name, with limits that stand for none."""
    most = UNBOUNDED
    return URDFJoint(name, "prismatic", parent, name, origin, axis, -most, most, most, most)


def _directions(normal: Triple) -> tuple[Triple, Triple, tuple[str, str]]:
    """Return unit vectors u, v in the plane with ``u × v = normal``, and what they are called."""
    n = np.array(normal)
    k = int(np.argmax(np.abs(n)))
    sign = 1.0 if n[k] > 0 else -1.0
    u, v, z = np.zeros(3), np.zeros(3), np.zeros(3)
    u[(k + 1) % 3], v[(k + 2) % 3], z[k] = 1.0, sign, sign
    if np.array_equal(n, z):
        return _triple(u), _triple(v), (_AXES[(k + 1) % 3], _AXES[(k + 2) % 3])
    # Rodrigues' formula for the smallest rotation that takes z to n.
    w = np.cross(z, n)
    K = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    R = np.eye(3) + K + K @ K / (1.0 + float(z @ n))
    return _triple(R @ u), _triple(R @ v), ("u", "v")


def _triple(vector: NDArray[np.float64]) -> Triple:
    x, y, z = (float(value) + 0.0 for value in vector / np.linalg.norm(vector))
    return x, y, z
