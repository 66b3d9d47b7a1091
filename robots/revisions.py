"""Conditions on the stored revision under which a robot may be replaced or deleted."""

from __future__ import annotations

from typing import Final

from robots.errors import RevisionMismatch

ANY: Final = "*"
"""Stands for any revision."""


def named_revisions(*conditions: tuple[str, ...]) -> tuple[str, ...]:
    """Return the revisions that conditions name.

    Empty where it is enough to know whether a robot is stored at all.
    """
    return tuple(one for condition in conditions for one in condition if one != ANY)


def check_revision(
    robot_id: str,
    current: str | None,
    if_match: tuple[str, ...],
    if_none_match: tuple[str, ...],
) -> None:
    """Refuse a change whose conditions do not hold.

    Args:
        robot_id: The robot.
        current: The stored revision; None where no robot has the id.
        if_match: Revisions one of which must be stored; empty: no condition.
        if_none_match: Revisions none of which may be stored.

    Raises:
        RevisionMismatch: A condition does not hold.
    """
    found = current is not None
    if if_match and current not in if_match and not (ANY in if_match and found):
        raise RevisionMismatch(robot_id, current)
    if found and (current in if_none_match or ANY in if_none_match):
        raise RevisionMismatch(robot_id, current)


def check_mesh(
    robot_id: str,
    revision: str,
    mesh: tuple[str, str | None],
    if_match: tuple[str, ...],
    if_none_match: tuple[str, ...],
) -> None:
    """Refuse a change of a mesh whose conditions do not hold.

    Args:
        robot_id: The robot.
        revision: Its stored revision, which changes with each of its meshes.
        mesh: Name of the mesh, and its stored digest; None where there is none.
        if_match: Revisions of the robot or digests of the mesh, one of which must be stored; empty:
            no condition.
        if_none_match: The same, none of which may be stored.

    Raises:
        RevisionMismatch: A condition does not hold.
    """
    name, digest = mesh
    current = {revision} if digest is None else {revision, digest, ANY}
    if if_match and current.isdisjoint(if_match):
        if named_revisions(if_match):
            raise RevisionMismatch(robot_id, revision)
        raise RevisionMismatch(robot_id, digest, mesh=name)
    if revision in if_none_match:
        raise RevisionMismatch(robot_id, revision)
    if not current.isdisjoint(if_none_match):
        raise RevisionMismatch(robot_id, digest, mesh=name)
