"""RobotStore: shipped robots, and uploaded ones as plain files that survive crashes.

One file a robot, with its own checksum. A write goes to a temporary file, is flushed to the disk
and takes its final name in one step, so that a reader in any process sees the old robot or the new
one, never a part. Writers of all processes take turns (:mod:`robots.storage.directory`); readers
need none (:mod:`robots.storage.uploads`).
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path
from typing import Final

from dh_to_urdf.look_alikes import by_case, by_shape
from robots.errors import (
    DAMAGED,
    InvalidRobotId,
    MeshNotFound,
    ReadOnlyRobot,
    RobotError,
    RobotExists,
    RobotNotFound,
    SharedRobot,
    StorageError,
)
from robots.revisions import check_mesh, check_revision, named_revisions
from robots.robot import Robot, robot_with_meshes
from robots.shapes import mesh_users
from robots.shipped import is_shipped, shipped_file, shipped_ids, shipped_robot
from robots.storage.directory import RobotDirectory
from robots.storage.stored_file import ROBOT_ID, encode
from robots.storage.uploads import UploadMemory, UploadReader
from robots.storage.usage_record import Quotas, Total, Usage
from robots.stored_robot import RobotSummary, StoredRobot
from robots.uploaded_mesh import UploadedMesh
from robots.writer import ANYBODY, Writer

_NEAR: Final = 100
"""Ids on either side of an unknown one among which the nearest names are sought."""
_STARTING_PATIENCE: Final = 2.0
"""Seconds that a new store waits for the lock."""


class RobotStore:
    """Robots by id: the shipped library and a directory of uploads, perhaps above shared ones."""

    def __init__(
        self,
        directory: Path,
        quotas: Quotas | None = None,
        *,
        shared: RobotStore | None = None,
        total: Callable[[], Total] | None = None,
        memory: UploadMemory | None = None,
        namespace: str = "",
    ) -> None:
        """Open a store, creating its directory where it is missing.

        Removes what killed writers left behind, but for a namespace, whose first writer does that.
        A directory that cannot be written to is no hindrance: what can be read is served.

        Args:
            directory: Where uploads are kept; several processes may share it.
            quotas: How much may be kept in it.
            shared: Of a namespace, the store whose robots are seen too and never changed.
            total: Tells, while ``shared`` is locked, what is taken with the other directories.
            memory: Where loaded uploads are remembered; stores may share it.
            namespace: Name of the namespace.
        """
        self._directory = RobotDirectory(directory, quotas or Quotas())
        self._uploads = UploadReader(self._directory, memory, namespace)
        self._shared = shared
        self._total = total
        self._shipped: dict[str, StoredRobot] = {} if shared is None else shared._shipped
        self._merged: tuple[tuple[tuple[str, ...], ...] | None, tuple[str, ...]] = (None, ())
        if shared is None:
            self.recover()

    def recover(self) -> None:
        """Remove what killed writers left behind, where the directory can be written to."""
        with (
            suppress(StorageError),
            self._directory.write_transaction(_STARTING_PATIENCE) as transaction,
        ):
            transaction.recover()

    def ids(self) -> tuple[str, ...]:
        """Return the ids of all robots, sorted.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        known, merged = self._merged
        own = self._directory.ids()
        current = (own,) if self._shared is None else (own, self._shared.ids())
        # The same objects as long as nothing comes or goes.
        if known is None or any(a is not b for a, b in zip(known, current, strict=True)):
            merged = tuple(sorted({*shipped_ids()}.union(*current)))
            self._merged = current, merged
            self._uploads.limit_summaries(len(own))
        return merged

    def ids_after(self, robot_id: str, count: int) -> tuple[str, ...]:
        """Return the first ``count`` ids after one, which need not exist.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        ids = self.ids()
        first = bisect_right(ids, robot_id)
        return ids[first : first + count]

    def usage_now(self) -> Usage:
        """Return how many uploads there are and their bytes, without waiting for writers.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        return self._directory.usage()

    def usage(self) -> Usage:
        """Return how many uploads there are and how many bytes they take.

        Raises:
            StorageError: The directory cannot be used.
        """
        with self._directory.write_transaction() as transaction:
            return transaction.usage

    def summary(self, robot_id: str) -> RobotSummary:
        """Return what a list shows of a robot, without building it; verify its file's checksum.

        Raises:
            RobotNotFound: No robot has this id.
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        if robot_id in shipped_ids():
            head = shipped_file(robot_id)
            return RobotSummary(robot_id, "urdf" if head.urdf else "dh", head.title, head.dof, True)
        found = self._uploads.summary(robot_id)
        if found is None and self._is_shared(robot_id):
            assert self._shared is not None
            return self._shared.summary(robot_id)
        if found is None:
            raise self._not_found(robot_id)
        return found

    def in_memory(self, robot_id: str) -> StoredRobot | None:
        """Return the robot if it is loaded and current, without reading its file.

        Raises:
            StorageUnavailable: The directory cannot be looked into.
        """
        found = self._shipped.get(robot_id) or self._uploads.in_memory(robot_id)
        if found is None and self._shared is not None and not self._uploads.knows(robot_id):
            return self._shared.in_memory(robot_id)
        return found

    def get(self, robot_id: str) -> StoredRobot:
        """Load a robot.

        Raises:
            RobotNotFound: No robot has this id.
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        found = self.in_memory(robot_id)
        if found is not None:
            return found
        if is_shipped(robot_id):
            head = shipped_file(robot_id)
            stored = StoredRobot(robot_id, shipped_robot(robot_id), True, head.title, head.source)
            return self._shipped.setdefault(robot_id, stored)
        found = self._uploads.get(robot_id)
        if found is None and self._is_shared(robot_id):
            assert self._shared is not None
            return self._shared.get(robot_id)
        if found is None:
            raise self._not_found(robot_id)
        return found

    def hides_shared(self, robot_id: str) -> bool:
        """Return whether an upload of this namespace hides a shared robot of the same id.

        Raises:
            StorageUnavailable: The directory cannot be looked into.
        """
        return self._is_shared(robot_id) and self._uploads.knows(robot_id)

    def look_alikes(self, robot_id: str) -> tuple[str, ...]:
        """Return the ids of other robots that differ from one by case or by look-alike letters.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        keys = by_case(robot_id), by_shape(robot_id)
        return tuple(
            other
            for other in self.ids()
            if other != robot_id and (by_case(other) == keys[0] or by_shape(other) == keys[1])
        )

    @staticmethod
    def check_id(robot_id: str) -> None:
        """Refuse an id under which no robot may be stored.

        Raises:
            InvalidRobotId: The id has other characters than letters, digits and ``. _ -``.
            ReadOnlyRobot: The id belongs to the shipped library.
        """
        if ROBOT_ID.fullmatch(robot_id) is None:
            raise InvalidRobotId(robot_id)
        if is_shipped(robot_id):
            raise ReadOnlyRobot(robot_id)

    def put(
        self,
        robot_id: str,
        robot: Robot,
        *,
        meshes: Mapping[str, bytes] | None = None,
        writer: Writer = ANYBODY,
        create_only: bool = False,
        if_match: tuple[str, ...] = (),
        if_none_match: tuple[str, ...] = (),
    ) -> tuple[StoredRobot, bool]:
        """Store a robot durably.

        Args:
            robot_id: Its id.
            robot: The robot.
            meshes: The files of its uploaded meshes, by name.
            writer: Who stores it. The robot of another is replaced only by one with the same
                content, or where ``if_match`` holds.
            create_only: Refuse to replace a robot.
            if_match: Revisions one of which must be stored now, ``ANY`` for any; empty: no matter.
            if_none_match: Revisions none of which may be stored now, ``ANY`` for any.

        Returns:
            The stored robot, and True where the id is new.

        Raises:
            InvalidRobotId: The id has other characters than letters, digits and ``. _ -``.
            ReadOnlyRobot: The id belongs to the shipped library.
            AnothersRobot: The id holds what another has stored.
            RobotExists: ``create_only`` and the id is taken.
            RevisionMismatch: ``if_match`` or ``if_none_match`` does not hold.
            MeshesTooLarge: Its meshes take more than is kept with one robot.
            QuotaReached: It would exceed a quota.
            StorageError: The disk does not take it; what was stored before is intact.
        """
        self.check_id(robot_id)
        maker, content = writer.name, encode(robot, writer.name, meshes)
        exact = self._needs_revision(robot_id, if_match, if_none_match, spares=writer.spares)
        with ExitStack() as locked:
            if self._shared is not None:
                locked.enter_context(self._shared._directory.write_transaction())
            total = self._total() if self._total is not None else None
            transaction = locked.enter_context(self._directory.write_transaction())
            current = self._uploads.revision(robot_id, exact=exact)
            if create_only and current is not None:
                raise RobotExists(robot_id)
            seen = current if current is not None else self._shared_revision(robot_id, exact=exact)
            check_revision(robot_id, seen, if_match, if_none_match)
            # Only who spares others asks who has stored it: that reads and builds the robot.
            if writer.spares and current not in (None, DAMAGED) and not if_match:
                maker = self._uploads.maker(robot_id)
                if current != robot.revision:
                    writer.check(robot_id, maker)
                    maker = writer.name
                else:
                    content = encode(robot, maker, meshes)
            transaction.write(robot_id, content, total)
        return StoredRobot(robot_id, robot, False, robot.name, maker=maker), current is None

    def change_mesh(
        self,
        robot_id: str,
        name: str,
        mesh: tuple[UploadedMesh, bytes] | None,
        *,
        writer: Writer = ANYBODY,
        if_match: tuple[str, ...] = (),
        if_none_match: tuple[str, ...] = (),
    ) -> tuple[StoredRobot, bool]:
        """Store or remove a mesh of an uploaded robot, durably; its other meshes stay.

        Args:
            robot_id: The robot.
            name: Name of the mesh, as its URDF has it, without ``package://``.
            mesh: The mesh and its file; None removes it.
            writer: Who does it; the robot of another is changed only where ``if_match`` holds.
            if_match: Revisions of the robot or digests of the mesh, one of which must be stored
                now; ``ANY`` for any mesh of this name; empty: no matter.
            if_none_match: The same, none of which may be stored now.

        Returns:
            The robot as it is stored, and True where it had no such mesh.

        Raises:
            ReadOnlyRobot: The robot is shipped.
            SharedRobot: The robot is no upload of this namespace, but shared.
            RobotNotFound: No robot has this id.
            MeshNotFound: The robot's URDF names no such mesh, or it has none to remove.
            AnothersRobot: Another has stored the robot, and there is no ``if_match``.
            RevisionMismatch: ``if_match`` or ``if_none_match`` does not hold.
            MeshesTooLarge: The meshes would take more than is kept with one robot.
            QuotaReached: It would exceed a quota.
            StorageError: The disk does not take it; what was stored before is intact.
        """
        if is_shipped(robot_id):
            raise ReadOnlyRobot(robot_id)
        self._uploads.warm(robot_id)
        with ExitStack() as locked:
            if self._shared is not None:
                locked.enter_context(self._shared._directory.write_transaction())
            total = self._total() if self._total is not None else None
            transaction = locked.enter_context(self._directory.write_transaction())
            stored = self._uploads.stored(robot_id)
            if stored is None:
                shared = self._is_shared(robot_id)
                raise SharedRobot(robot_id) if shared else self._not_found(robot_id)
            robot = stored.robot
            digest = next((one.digest for one in robot.meshes if one.name == name), None)
            check_mesh(robot_id, robot.revision, (name, digest), if_match, if_none_match)
            if not if_match:
                writer.check(robot_id, stored.maker)
            files = self._uploads.mesh_files(robot_id, robot)
            is_new = name not in files
            named = tuple(mesh_users(robot)) if mesh is not None else tuple(files)
            if name not in named:
                raise MeshNotFound(robot_id, name, named)
            meshes = {one.name: one for one in robot.meshes}
            meshes.pop(name, None)
            files.pop(name, None)
            if mesh is not None:
                meshes[name], files[name] = mesh[0].named(name), mesh[1]
            changed = robot_with_meshes(robot, meshes.values())
            transaction.write(robot_id, encode(changed, stored.maker, files), total)
        return replace(stored, robot=changed), is_new

    def mesh_file(self, robot_id: str, name: str) -> tuple[UploadedMesh, bytes]:
        """Return an uploaded mesh of a robot, and its file (glTF, binary).

        Raises:
            RobotNotFound: No robot has this id.
            MeshNotFound: It has no such mesh.
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        found = self._uploads.mesh_file(robot_id, name)
        if found is None and self._shared is not None and not self._uploads.knows(robot_id):
            return self._shared.mesh_file(robot_id, name)
        if found is None:
            raise MeshNotFound(
                robot_id, name, tuple(one.name for one in self.get(robot_id).robot.meshes)
            )
        return found

    def delete(
        self,
        robot_id: str,
        *,
        writer: Writer = ANYBODY,
        if_match: tuple[str, ...] = (),
        if_none_match: tuple[str, ...] = (),
    ) -> None:
        """Remove an uploaded robot, and what was moved to quarantine from its id.

        Raises:
            ReadOnlyRobot: The robot is shipped.
            SharedRobot: The robot is no upload of this namespace, but shared.
            RobotNotFound: No robot has this id.
            AnothersRobot: Another has stored the robot, and there is no ``if_match``.
            RevisionMismatch: ``if_match`` or ``if_none_match`` does not hold.
            StorageError: The directory cannot be written to.
        """
        if is_shipped(robot_id):
            raise ReadOnlyRobot(robot_id)
        exact = self._needs_revision(robot_id, if_match, if_none_match, spares=writer.spares)
        with self._directory.write_transaction() as transaction:
            current = self._uploads.revision(robot_id, exact=exact)
            if current is not None:
                check_revision(robot_id, current, if_match, if_none_match)
                if writer.spares and current != DAMAGED and not if_match:
                    writer.check(robot_id, self._uploads.maker(robot_id), "delete")
                transaction.remove(robot_id)
        self._uploads.forget(robot_id)
        if current is None:
            raise SharedRobot(robot_id) if self._is_shared(robot_id) else self._not_found(robot_id)

    def check(self, stopped: Callable[[], bool] = lambda: False) -> None:
        """Verify the checksum of every upload, and remember what a list shows of it.

        Args:
            stopped: Asked between robots; True ends the check.
        """
        with suppress(StorageError):
            for robot_id in self._directory.ids():
                if stopped():
                    return
                with suppress(RobotError):
                    self.summary(robot_id)

    def damaged(self) -> tuple[str, ...]:
        """Return the ids whose stored files were found damaged and not replaced since, sorted.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        return self._uploads.damaged()

    def _needs_revision(
        self, robot_id: str, *conditions: tuple[str, ...], spares: bool = False
    ) -> bool:
        """Tell whether revisions are compared; load the robot then, before the lock is held."""
        if not spares and not named_revisions(*conditions):
            return False
        for store in (self, self._shared):
            if store is not None and store._directory.signature(robot_id) is not None:
                store._uploads.warm(robot_id)
        return True

    def _is_shared(self, robot_id: str) -> bool:
        return self._shared is not None and self._shared._uploads.knows(robot_id)

    def _shared_revision(self, robot_id: str, *, exact: bool) -> str | None:
        if self._shared is None:
            return None
        return self._shared._uploads.revision(robot_id, exact=exact)

    def _not_found(self, robot_id: str) -> RobotNotFound:
        ids = self.ids()
        place = bisect_left(ids, robot_id)
        near = ids[max(0, place - _NEAR) : place + _NEAR]
        return RobotNotFound(robot_id, sorted({*near, *shipped_ids()}), len(ids))
