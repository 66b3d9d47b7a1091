"""Meshes and archives of strangers -> what is kept of them, read in a process of its own."""

from __future__ import annotations

import hashlib
import math
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final

from dh_to_urdf.messages import from_data, say
from kinematics.deadline import current
from kinematics.errors import OutOfMemory, WorkersBusy
from kinematics.meshes.tasks import ListTask, MeshTask, parted
from kinematics.processes.pool import ProcessPool, Session, TaskFailed
from kinematics.processes.protocol import Limits
from robots.errors import InvalidArchive, InvalidMesh
from robots.uploaded_mesh import UploadedMesh, mesh_from_data
from robots.urdf import MAX_BYTES

WORKER: Final = "kinematics.meshes.worker"
SHOWN_TRIANGLES: Final = 20_000
"""Most triangles of a mesh that are kept, for drawing."""
SECONDS: Final = 20.0
"""Longest that reading one mesh takes, s."""
ALL_SECONDS: Final = 45.0
"""Longest that the meshes of an archive take, s."""
LEAST_MEMORY: Final = 160 << 20
"""Bytes that reading a mesh may take besides those of an idle process."""
MEMORY_PER_BYTE: Final = 24
"""And for each byte of its file."""
MOST_MEMORY: Final = 700 << 20
IDLE_SECONDS: Final = 30.0
"""How long the process waits for the next mesh, s; it takes some 100 MB."""
COPIES: Final = 3
"""Of a file: pickled, in the pipe, and what comes back."""
IDLE_MEMORY: Final = 130 << 20
"""Bytes of an idle process."""

Prepared = tuple[UploadedMesh, bytes]
"""A mesh, and the file that is kept of it."""


@dataclass(frozen=True)
class Listing:
    """An archive.

    Attributes:
        names: The paths of its files.
        urdfs: Those of them that are URDFs.
        notes: What is passed over.
    """

    names: tuple[str, ...]
    urdfs: tuple[str, ...]
    notes: tuple[str, ...]


class MeshReader:
    """Reads meshes and archives, in one process at a time.

    Args:
        most: Largest file of one mesh, bytes.
        memory: Most bytes that the process may take.
        waiting: How many callers wait for the process.

    Attributes:
        most: Largest file of one mesh, bytes.
    """

    def __init__(self, most: int, memory: int, waiting: int) -> None:
        self.most = most
        self._memory = max(LEAST_MEMORY, min(MOST_MEMORY, memory - IDLE_MEMORY))
        self._pool = ProcessPool(WORKER, 1, waiting)
        self._lock = threading.Lock()
        self._rest: threading.Timer | None = None

    def close(self) -> None:
        """End the idle processes."""
        with self._lock:
            if self._rest is not None:
                self._rest.cancel()
        self._pool.close()

    @contextmanager
    def _session(self) -> Iterator[Session]:
        """Hold the process; afterwards it stays for a while, as meshes come one after the other."""
        try:
            with self._pool.session() as session:
                yield session
        finally:
            with self._lock:
                if self._rest is not None:
                    self._rest.cancel()
                self._rest = threading.Timer(IDLE_SECONDS, self._pool.close)
                self._rest.daemon = True
                self._rest.start()

    def task_memory(self, size: int) -> int:
        """Return the bytes that the process may take besides those of an idle one.

        Args:
            size: Bytes of the files that it reads.
        """
        return min(self._memory, LEAST_MEMORY + MEMORY_PER_BYTE * size)

    def memory(self, size: int) -> int:
        """Return the bytes that reading so many bytes of files takes, with all copies."""
        return IDLE_MEMORY + self.task_memory(size) + COPIES * size

    def mesh(self, name: str, content: bytes) -> Prepared:
        """Read a mesh file.

        Raises:
            InvalidMesh: It is refused, or takes too long or too much memory.
            WorkersBusy: Too many meshes are read now.
            Cancelled: The result is no longer wanted.
        """
        with self._session() as session:
            task = MeshTask(content, (), name, self.most, SHOWN_TRIANGLES)
            answers = _called(session, task, self.task_memory(len(content)), SECONDS)
            return _prepared(answers[0], name)

    @contextmanager
    def archive(self, content: bytes) -> Iterator[ArchiveReader]:
        """Open an archive.

        Raises:
            InvalidArchive: It is none, or is refused.
            WorkersBusy: Too many meshes are read now.
            Cancelled: The result is no longer wanted.
        """
        with self._session() as session:
            yield ArchiveReader(session, content, self.most, self.task_memory(len(content)))


class ArchiveReader:
    """An archive while it is read.

    Attributes:
        listing: What is in it.
    """

    def __init__(self, session: Session, content: bytes, most: int, memory: int) -> None:
        self._session, self._content, self._most, self._memory = session, content, most, memory
        try:
            answers = _called(session, ListTask(content, MAX_BYTES), memory, SECONDS)
        except InvalidMesh:
            raise InvalidArchive(
                say("the list of the archive takes too much memory or time; pack it anew")
            ) from None
        head, _ = parted(answers[0])
        if "refused" in head:
            raise InvalidArchive(from_data(head["refused"]))
        notes = tuple(map(from_data, head["notes"]))
        self.listing = Listing(tuple(head["names"]), tuple(head["urdfs"]), notes)

    def text(self, name: str) -> bytes:
        """Return a URDF of the archive.

        Raises:
            InvalidArchive: It cannot be unpacked, or is larger than a URDF may be.
        """
        task = MeshTask(self._content, (name,), "", MAX_BYTES, 0)
        try:
            answers = _called(self._session, task, self._memory, SECONDS)
        except InvalidMesh as error:
            raise InvalidArchive(error.args[0]) from None
        head, content = parted(answers[0])
        if "refused" in head:
            raise InvalidArchive(
                say("{name!r}: {reason}", name=name, reason=from_data(head["refused"]))
            )
        return content

    def meshes(self, members: Mapping[str, str]) -> Iterator[tuple[str, Prepared | str]]:
        """Read meshes, one after the other.

        Args:
            members: The file of the archive for each name of a mesh.

        Yields:
            The name with the mesh, or with why it is not read: each on its own, so that one bad
            file does not refuse the others.
        """
        ends = time.monotonic() + ALL_SECONDS
        left = list(members.items())
        while left:
            files = tuple(member for _, member in left)
            answers: Sequence[bytes] = ()
            reason = ""
            seconds = min(ends - time.monotonic(), SECONDS * len(left))
            if seconds > 0:
                task = MeshTask(self._content, files, "", self._most, SHOWN_TRIANGLES)
                answers, reason = _outcome(self._session, task, self._memory, seconds)
            else:
                reason = say("the meshes before it took all the time; send it alone")
            for (name, _), answer in zip(left, answers, strict=False):
                try:
                    yield name, _prepared(answer, name)
                except InvalidMesh as error:
                    yield name, error.args[0]
            if not answers:
                yield left[0][0], reason
            left = left[len(answers) or 1 :]


def _called(session: Session, task: Any, memory: int, seconds: float) -> Sequence[bytes]:
    """Return the answers to a task.

    Raises:
        InvalidMesh: There is none.
    """
    answers, reason = _outcome(session, task, memory, seconds)
    if not answers:
        raise InvalidMesh(reason)
    return answers


def _outcome(
    session: Session, task: Any, memory: int, seconds: float
) -> tuple[Sequence[bytes], str]:
    """Return the answers to a task, and why there is no further one."""
    limits = Limits(memory, seconds)
    too_long = say("reading it takes longer than {seconds:.0f} s; simplify it", seconds=SECONDS)
    try:
        answers = session.call(task, limits, seconds)
    except OutOfMemory:
        return (), say(
            "reading it takes more than the {memory:.0f} MB that there are for it; simplify it",
            memory=limits.memory / 1e6,
        )
    except WorkersBusy:
        # The process ended without an answer, twice: the file does that.
        return (), say("the library that reads it fails on it; export it anew")
    except TaskFailed:
        return (), say("the library that reads it fails on it; export it anew")
    if not answers:
        current().check()
    return answers, too_long


def _prepared(answer: bytes, name: str) -> Prepared:
    """Return the mesh of an answer.

    Raises:
        InvalidMesh: It is refused.
    """
    head, content = parted(answer)
    if "refused" in head:
        raise InvalidMesh(from_data(head["refused"]))
    mesh = mesh_from_data(head["mesh"]).named(name)
    sizes = (*mesh.lower, *mesh.upper)
    whole = hashlib.sha256(content).hexdigest() == mesh.digest and len(content) == mesh.size
    if not whole or not all(map(math.isfinite, sizes)):
        raise InvalidMesh(say("the library that reads it fails on it; export it anew"))
    return mesh, content
