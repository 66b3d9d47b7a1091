"""Followers and couplings of the joints of a serial chain, taken over from the robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dh_to_urdf.couplings import MovingJoint
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.extraction.axes import ChainJoint, SerialChain, motion
from dh_to_urdf.messages import say
from dh_to_urdf.table import DHTable, Mimic


def depending(chain: SerialChain, moving: Sequence[MovingJoint]) -> SerialChain:
    """Return a chain whose joints depend on each other as those of the whole robot do.

    Args:
        chain: The chain.
        moving: All joints of the robot that move.

    Raises:
        DHError: A joint of the chain depends on one that is not in it.
    """
    if not any(joint.mimic or joint.coupling for joint in moving):
        return chain
    every = {joint.name: joint for joint in moving}
    inside = {joint.name for joint in chain.joints}
    joints = []
    for joint in chain.joints:
        relation = every[joint.name]
        mimic = relation.mimic
        if mimic is not None:
            mimic = _within(joint.name, mimic, every, inside)
        coupling = []
        for name, coefficient in relation.coupling:
            other = Mimic(name, coefficient)
            if name not in inside:
                other = _within(joint.name, other, every, inside)
            if other.offset != 0.0:
                raise _apart(joint.name, name)
            coupling.append((other.joint, other.multiplier))
        joints.append(replace(joint, type=relation.type, mimic=mimic, coupling=tuple(coupling)))
    return replace(chain, joints=_merged(joints, every))


def _merged(
    joints: Sequence[ChainJoint], every: Mapping[str, MovingJoint]
) -> tuple[ChainJoint, ...]:
    """Return the joints, with followers on the very axis of the next one as its couplings.

    So the URDF of a coupled joint is written; see :mod:`dh_to_urdf.writer`.
    """
    leading = {one.mimic.joint for one in every.values() if one.mimic is not None}
    found: list[ChainJoint] = []
    for joint in joints:
        while found and _on_one_axis(found[-1], joint) and found[-1].name not in leading:
            before = found.pop()
            assert before.mimic is not None
            followed = before.mimic.joint, before.mimic.multiplier
            coupling = (*before.coupling, followed, *joint.coupling)
            placement = before.placement
            if before.mimic.offset != 0.0:
                placement = placement @ motion(before, np.array(before.mimic.offset))
            joint = replace(joint, placement=placement, coupling=coupling)
        found.append(joint)
    return tuple(found)


def _on_one_axis(first: ChainJoint, second: ChainJoint) -> bool:
    """Return whether a follower without limits moves about the axis of the next."""
    mimic, limits = first.mimic, first.limits
    return (
        mimic is not None
        and limits.lower is None
        and limits.upper is None
        and first.type.is_revolute is second.type.is_revolute
        and mimic.joint != second.name
        and np.array_equal(second.placement, np.eye(4))
        and np.array_equal(first.axis, second.axis)
    )


def _within(name: str, mimic: Mimic, every: Mapping[str, MovingJoint], inside: set[str]) -> Mimic:
    """Return what a joint follows within the chain, by way of followers outside of it."""
    while mimic.joint not in inside:
        further = every[mimic.joint].mimic
        if further is None:
            raise _apart(name, mimic.joint)
        multiplier = mimic.multiplier * further.multiplier
        offset = mimic.offset + mimic.multiplier * further.offset
        mimic = Mimic(further.joint, multiplier, offset)
    return mimic


def _apart(name: str, leader: str) -> DHError:
    return DHError.single(
        ("tip",),
        say(
            "joint {name!r} depends on {leader}, which is not between base and tip;"
            " choose them so that it is, or make the joint independent",
            name=name,
            leader=quoted(leader, 64),
        ),
    )


def is_coupled(chain: SerialChain) -> bool:
    """Return whether a joint of a chain depends on another."""
    return any(joint.mimic is not None or joint.coupling for joint in chain.joints)


def with_dependences(table: DHTable, chain: SerialChain) -> DHTable:
    """Return the table of a chain, with what its joints depend on; names may have changed."""
    if not is_coupled(chain):
        return table
    names = {
        joint.name: table.rows[k].name
        for joint, k in zip(chain.joints, table.moving_rows, strict=True)
    }
    rows = list(table.rows)
    for joint, k in zip(chain.joints, table.moving_rows, strict=True):
        mimic = joint.mimic
        rows[k] = replace(
            rows[k],
            mimic=None if mimic is None else replace(mimic, joint=names[mimic.joint]),
            coupling=tuple((names[name], c) for name, c in joint.coupling),
        )
    return replace(table, rows=tuple(rows))
