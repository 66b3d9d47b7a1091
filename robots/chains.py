"""Serial chains of robots, and of untrusted URDF texts, as joint axes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from dh_to_urdf import DHError, table_to_urdf
from dh_to_urdf.couplings import moving_joints, uncoupled
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.dependences import depending
from dh_to_urdf.extraction.urdf_chain import read_chain
from dh_to_urdf.poses import Matrix
from robots.errors import InvalidURDF, UnknownFrame
from robots.robot import Mounting, Robot
from robots.urdf import read_urdf


def chain_of_robot(robot: Robot, base: str | None = None, tip: str | None = None) -> SerialChain:
    """Return the chain between two frames of a robot, with the doubts about a URDF as warnings.

    Args:
        robot: The robot.
        base: Frame to start from; default its base frame, of an installed robot the world.
        tip: Frame to end at; default its tip frame.

    Raises:
        UnknownFrame: The robot has no such frame.
        InvalidURDF: No joint moves between the two.
    """
    for role, name in (("base", base), ("tip", tip)):
        if name is not None:
            robot.frame_id(name, role)
    mounting = robot.mounting or Mounting(robot.base_frame)
    stands = None if base else mounting.base
    base, tip, table = base or mounting.base_frame, tip or robot.tip_frame, robot.table
    if table is None or not table.is_coupled:
        told = robot.doubts if table is None else ()
        chain = _told(_chain(robot.urdf, base, tip), told)
        return _mounted(chain, stands, mounting.tool)
    chain = _chain(table_to_urdf(uncoupled(table)), base, tip)
    chain = _read(lambda: depending(chain, moving_joints(table)[0]))
    return _mounted(chain, stands, mounting.tool)


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


def _mounted(chain: SerialChain, base: Matrix | None, tool: Matrix | None) -> SerialChain:
    """Return a chain from the world to the tool."""
    if base is not None:
        first, *others = chain.joints
        first = replace(first, placement=base @ first.placement)
        chain = replace(chain, joints=(first, *others))
    if tool is not None:
        chain = replace(chain, tip_placement=chain.tip_placement @ tool)
    return chain


def _chain(text: str, base: str, tip: str) -> SerialChain:
    return _read(lambda: read_chain(text, base, tip))


def _read(read: Callable[[], SerialChain]) -> SerialChain:
    try:
        return read()
    except DHError as error:
        fault = error.faults[0]
        raise InvalidURDF(fault.message, fault.location) from None
