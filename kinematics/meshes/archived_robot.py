"""An archive with a URDF and its meshes -> the robot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import plural, say
from kinematics.meshes.doubts import doubts_of_mesh
from kinematics.meshes.names import MeshNames
from kinematics.meshes.preparation import ArchiveReader, Listing, Prepared
from kinematics.meshes.refusals import MOST_SHOWN, shown_name
from robots.errors import InvalidArchive
from robots.robot import Robot, robot_from_urdf, robot_with_meshes

NAMED = 5
"""Files that a sentence names."""


@dataclass(frozen=True, eq=False)
class ArchivedRobot:
    """A robot that came with its meshes.

    Attributes:
        robot: The robot.
        files: The files of its meshes that are kept, by name.
        notes: What was passed over, is missing or is doubtful.
    """

    robot: Robot
    files: dict[str, bytes]
    notes: tuple[str, ...]


def archived_robot(
    archive: ArchiveReader, urdf: str | None, base: str | None, tip: str | None
) -> ArchivedRobot:
    """Read the robot of an archive with those of its meshes that the URDF names.

    A mesh that is missing or cannot be read is left out, and a note names it.

    Raises:
        InvalidArchive: It has no URDF, several of which none is named, or not the one that is.
        InvalidURDF: The URDF is refused.
        RobotTooLarge: It has more links, joints or bytes than are computed with.
        UnknownFrame: base or tip is no link of the robot.
    """
    path = chosen_urdf(archive.listing, urdf)
    names = MeshNames(path, archive.listing.names)
    robot = robot_from_urdf(archive.text(path), base=base, tip=tip, mesh_names=names)
    found, notes = _read(archive.meshes(names.members))
    robot = robot_with_meshes(robot, [mesh for mesh, _ in found])
    for mesh in robot.meshes:
        notes += [
            say("mesh {name}: {warning}", name=_shown(mesh.name), warning=one)
            for one in doubts_of_mesh(robot, mesh)
        ]
    missing = (*_missing(tuple(names.missing)), *_ambiguous(names.ambiguous))
    files = {mesh.name: content for mesh, content in found}
    return ArchivedRobot(robot, files, (*archive.listing.notes, *missing, *notes))


def chosen_urdf(listing: Listing, wanted: str | None) -> str:
    """Return the path of the URDF of an archive.

    Raises:
        InvalidArchive: See :func:`archived_robot`.
    """
    urdfs = listing.urdfs
    if wanted is not None:
        found = [one for one in listing.names if f"/{one}".endswith(f"/{wanted.lstrip('/')}")]
        exact = [one for one in found if one == wanted] or found
        if len(exact) != 1:
            raise InvalidArchive(
                say(
                    "urdf is {wanted}, and the archive has {count} files of that name; its URDFs"
                    " are: {names}",
                    wanted=_shown(wanted),
                    count=len(exact),
                    names=_listed(urdfs) if urdfs else say("none"),
                )
            )
        return exact[0]
    if not urdfs and listing.notes:
        raise InvalidArchive(
            say("the archive has no .urdf that is read: {note}", note=listing.notes[-1])
        )
    if not urdfs:
        raise InvalidArchive(say("the archive has no .urdf; expand a xacro file first"))
    if len(urdfs) > 1:
        raise InvalidArchive(
            say(
                "the archive has {count} URDFs: {names}; name the one that is meant in urdf",
                count=len(urdfs),
                names=_listed(urdfs),
            ),
            several=True,
        )
    return urdfs[0]


def _read(
    meshes: Iterable[tuple[str, Prepared | str]],
) -> tuple[list[Prepared], list[str]]:
    """Return the meshes that are read, and why others are not."""
    found: list[Prepared] = []
    notes: list[str] = []
    for name, outcome in meshes:
        if isinstance(outcome, str):
            notes.append(
                say("mesh {name} is left out: {reason}", name=_shown(name), reason=outcome)
            )
        else:
            found.append(outcome)
    return found, notes


def _missing(names: Sequence[str]) -> tuple[str, ...]:
    if not names:
        return ()
    return (
        plural(
            "a mesh that the URDF names is not in the archive: {names}; add it, or upload it"
            " by itself",
            "{count} meshes that the URDF names are not in the archive: {names}; add them, or"
            " upload them by themselves",
            count=len(names),
            names=_listed(names),
        ),
    )


def _ambiguous(names: Mapping[str, Sequence[str]]) -> list[str]:
    return [
        say(
            "mesh {name} is ambiguous: the archive has {files}; write the path of the one that is"
            " meant in the URDF",
            name=_shown(name),
            files=_listed(files),
        )
        for name, files in islice(names.items(), NAMED)
    ]


def _shown(name: str) -> str:
    return quoted(shown_name(name), 2 * MOST_SHOWN)


def _listed(names: Sequence[str]) -> str:
    more = say(" and {count} more", count=len(names) - NAMED) if len(names) > NAMED else ""
    return ", ".join(_shown(name) for name in names[:NAMED]) + more
