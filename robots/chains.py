"""Serial chains of robots, and of untrusted URDF texts, as joint axes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from dh_to_urdf import DHError, table_to_urdf
from dh_to_urdf.couplings import moving_joints, uncoupled
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.dependences import depending
from dh_to_urdf.extraction.urdf_chain import read_chain
from robots.errors import InvalidURDF, UnknownFrame
from robots.robot import Robot
from robots.urdf import read_urdf


def chain_of_robot(robot: Robot, base: str | None = None, tip: str | None = None) -> SerialChain:
    """Return the chain between two frames of a robot, with the doubts about a URDF as warnings.

    Args:
        robot: The robot.
        base: Frame to start from; default its base frame.
        tip: Frame to end at; default its tip frame.

    Raises:
        UnknownFrame: The robot has no such frame.
        InvalidURDF: No joint moves between the two.
    """
    for role, name in (("base", base), ("tip", tip)):
        if name is not None:
            robot.frame_id(name, role)
    base, tip, table = base or robot.base_frame, tip or robot.tip_frame, robot.table
    if table is None or not table.is_coupled:
        told = robot.doubts if table is None else ()
        return _told(_chain(robot.urdf, base, tip), told)
    chain = _chain(table_to_urdf(uncoupled(table)), base, tip)
    return _read(lambda: depending(chain, moving_joints(table)[0]))


def chain_of_urdf(
    text: str | bytes, base: str | None = None, tip: str | None = None
) -> SerialChain:
    """Return the chain between two links of a URDF, which is checked in full before.

    Its warnings tell what of the file is doubtful, was forgiven or is left out.

    Args:
        text: The URDF.
        base: Link to start from; default the root.
        tip: Link to end at; default the leaf of the longest chain.

    Raises:
        InvalidURDF: See :func:`robots.urdf.read_urdf`; or no joint moves between the two.
        RobotTooLarge: More links, joints or bytes than are computed with.
        UnknownFrame: base or tip is no link.
    """
    description = read_urdf(text, base)
    for role, name in (("base", base), ("tip", tip)):
        if name is not None and name not in description.links:
            raise UnknownFrame(name, description.links, role)
    chain = _chain(
        description.canonical, base or description.root, tip or description.default_tip()
    )
    return _told(chain, description.warnings)


def _told(chain: SerialChain, warnings: tuple[str, ...]) -> SerialChain:
    """Return a chain with these warnings before its own."""
    return replace(chain, warnings=tuple(dict.fromkeys((*warnings, *chain.warnings))))


def _chain(text: str, base: str, tip: str) -> SerialChain:
    return _read(lambda: read_chain(text, base, tip))


def _read(read: Callable[[], SerialChain]) -> SerialChain:
    try:
        return read()
    except DHError as error:
        fault = error.faults[0]
        raise InvalidURDF(fault.message, fault.location) from None
