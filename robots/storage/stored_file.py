"""The file of an uploaded robot: format, reading, writing, and faults.

The first line is the SHA-256 of the rest, the second what a list shows (JSON), the third the robot
(JSON). Files of format 1 had the robot in the second line. Files of format 3 hold uploaded meshes
after the third line: their glTF files, one after the other, in the order of the robot's.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import stat
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from dh_to_urdf import read_mapping
from dh_to_urdf.documents.writing import table_to_mapping
from dh_to_urdf.messages import as_data, from_data, say
from robots.errors import MeshesTooLarge, RobotTooLarge, StorageUnavailable
from robots.robot import Robot, robot_from_table, robot_from_urdf, robot_with_meshes
from robots.uploaded_mesh import UploadedMesh, mesh_as_data, mesh_from_data

ROBOT_ID: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
SUFFIX: Final = ".json"
FORMAT: Final = 2
WITH_MESHES: Final = 3
"""Format of files with meshes; without, files stay as older versions read them."""
MAX_FILE_BYTES: Final = 64_000_000
"""Far above the size of any robot that passes the checks on uploads."""
MAX_MESHES_BYTES: Final = 24_000_000
"""Bytes of meshes that are kept with one robot, as they are kept."""

Signature = tuple[int, int, int]
"""Inode, time of the last change in ns, size in bytes: differs between files."""

_SHORT_OF = (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN, errno.ESTALE, errno.EINTR)


class BrokenFile(Exception):
    """A file that holds no robot: to be moved aside.

    Attributes:
        reason: One word.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class UnusableFile(Exception):
    """A file that may be right, but cannot be used now: to be left in place.

    Attributes:
        fault: What is wrong, as the predicate of a sentence.
    """

    def __init__(self, fault: str) -> None:
        super().__init__(fault)
        self.fault = fault


FAULTS: Final = {
    "empty": say("was found empty"),
    "checksum": say("was found damaged (it fails its checksum)"),
    "foreign": say("was found to be something else than a file"),
    "size": say("was found damaged (it is larger than any robot)"),
    "content": say("was found damaged (it holds no robot)"),
}
"""Predicate of each reason of a :class:`BrokenFile`."""


@dataclass(frozen=True, slots=True)
class FileHead:
    """What a list shows, without the robot."""

    kind: str
    title: str
    dof: int


def encode(
    robot: Robot, maker: str | None = None, meshes: Mapping[str, bytes] | None = None
) -> bytes:
    """Write the content of a robot's file.

    Args:
        robot: The robot.
        maker: Name of the key that stores it.
        meshes: The files of its uploaded meshes, by name.

    Raises:
        MeshesTooLarge: The meshes take more than is kept with one robot.
        RobotTooLarge: The file would be larger than any that is read.
    """
    files = [(meshes or {})[one.name] for one in robot.meshes]
    size = sum(map(len, files))
    if size > MAX_MESHES_BYTES:
        raise MeshesTooLarge(size, MAX_MESHES_BYTES)
    number = WITH_MESHES if files else FORMAT
    head: dict[str, Any] = {"format": number, "kind": robot.kind}
    head |= {"title": robot.name, "dof": robot.dof}
    if maker is not None:
        head["maker"] = maker
    document: dict[str, Any] = {"kind": robot.kind, "warnings": list(robot.warnings)}
    if robot.table is not None:
        document.update(table=table_to_mapping(robot.table), doubts=list(robot.doubts))
    else:
        document.update(urdf=robot.urdf, base=robot.base_frame, tip=robot.tip_frame)
    if files:
        document["meshes"] = [mesh_as_data(one) for one in robot.meshes]
    # Beside the English sentences, which any version reads, what they are made of.
    said = {
        name: [as_data(one) for one in document.get(name, ())] for name in ("warnings", "doubts")
    }
    if any(said.values()):
        document["messages"] = said
    lines = [json.dumps(part, ensure_ascii=False).encode() for part in (head, document)]
    body = b"\n".join([*lines, b"".join(files)] if files else lines)
    content = hashlib.sha256(body).hexdigest().encode() + b"\n" + body
    if len(content) > MAX_FILE_BYTES:
        raise RobotTooLarge(
            say(
                "the robot takes {count} bytes; at most {max_file_bytes}",
                count=len(content),
                max_file_bytes=MAX_FILE_BYTES,
            )
        )
    return content


def read_file(path: Path) -> tuple[bytes, Signature] | None:
    """Read content and identity of a regular file; None where there is none.

    A pipe, a device, a link or a huge file is neither followed nor waited for.

    Raises:
        BrokenFile: It is no file that a robot can be in.
        UnusableFile: The system does not let it be read.
        StorageUnavailable: The process or the machine is short of something; the file may be right.
    """
    descriptor = _opened(path)
    if descriptor is None:
        return None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise BrokenFile("foreign")
        if status.st_size > MAX_FILE_BYTES:
            raise BrokenFile("size")
        with os.fdopen(descriptor, "rb", closefd=False) as stream:
            content = stream.read(MAX_FILE_BYTES + 1)
    except OSError as error:
        raise _unread(path, error) from None
    finally:
        os.close(descriptor)
    return content, signature_of(status)


def _opened(path: Path) -> int | None:
    """Open a file to read; None where there is none. A link is not followed, nor waited for.

    Raises:
        UnusableFile: The system does not let it be read.
        StorageUnavailable: The process or the machine is short of something.
    """
    try:
        return os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise _unread(path, error) from None


def signature_of(status: os.stat_result) -> Signature:
    """Return the identity of a file's content."""
    return status.st_ino, status.st_mtime_ns, status.st_size


def read_head(content: bytes) -> FileHead | None:
    """Read what a list shows; None for a file of format 1, which does not hold it.

    Raises:
        BrokenFile: It fails its checksum.
        UnusableFile: It is of a later version.
    """
    head, body = _parts(content)
    return None if body is None else _head(head)


def decode(content: bytes) -> Robot:
    """Read the robot of a file.

    Raises:
        BrokenFile: It fails its checksum.
        UnusableFile: It is of a later version, or this version does not accept the robot.
    """
    head, body = _parts(content)
    if body is not None:
        _head(head)
    try:
        return _robot_of(json.loads(head if body is None else body))
    except (ArithmeticError, LookupError, RecursionError, TypeError, ValueError):
        raise UnusableFile(say("holds a robot that this version of the service refuses")) from None


def read_meshes(path: Path, robot: Robot, signature: Signature) -> dict[str, bytes] | None:
    """Read the mesh files of a robot; None where the file is no longer the one with this signature.

    Raises:
        BrokenFile: They fail their checksums.
        UnusableFile: The system does not let it be read.
        StorageUnavailable: The process or the machine is short of something.
    """
    found = read_file(path)
    if found is None or found[1] != signature:
        return None
    content, files = found[0], {}
    end = len(content)
    for mesh in reversed(robot.meshes):
        files[mesh.name] = _whole(content[end - mesh.size : end], mesh)
        end -= mesh.size
    return files


def read_mesh(path: Path, robot: Robot, signature: Signature, name: str) -> bytes | None:
    """Read one mesh file of a robot; see :func:`read_meshes`."""
    names = [mesh.name for mesh in robot.meshes]
    later = robot.meshes[names.index(name) :]
    descriptor = _opened(path)
    if descriptor is None:
        return None
    try:
        status = os.fstat(descriptor)
        if signature_of(status) != signature:
            return None
        start = status.st_size - sum(mesh.size for mesh in later)
        content = os.pread(descriptor, later[0].size, start)
    except OSError as error:
        raise _unread(path, error) from None
    finally:
        os.close(descriptor)
    return _whole(content, later[0])


def _whole(content: bytes, mesh: UploadedMesh) -> bytes:
    if hashlib.sha256(content).hexdigest() != mesh.digest:
        raise BrokenFile("checksum")
    return content


def maker_in(content: bytes) -> str | None:
    """Return the name of the key that stored a robot, of a file that :func:`decode` has read."""
    lines = content.split(b"\n", 2)
    maker = json.loads(lines[1]).get("maker") if len(lines) > 2 else None
    return maker if isinstance(maker, str) else None


def _unread(path: Path, error: OSError) -> Exception:
    if error.errno in _SHORT_OF or not os.access(path.parent, os.X_OK):
        return StorageUnavailable(say("the stored robots cannot be read now"))
    if error.errno in (errno.ELOOP, errno.ENXIO, errno.EISDIR, errno.ENODEV):
        return BrokenFile("foreign")
    return UnusableFile(say("cannot be read"))


def _parts(content: bytes) -> tuple[bytes, bytes | None]:
    if not content:
        raise BrokenFile("empty")
    checksum, _, rest = content.partition(b"\n")
    if hashlib.sha256(rest).hexdigest().encode() != checksum:
        raise BrokenFile("checksum")
    head, separator, body = rest.partition(b"\n")
    # JSON has no line feeds: what follows the next one are meshes.
    return head, body.partition(b"\n")[0] if separator else None


def _head(line: bytes) -> FileHead:
    try:
        head = json.loads(line)
        if head["format"] not in (FORMAT, WITH_MESHES):
            raise UnusableFile(say("was written by another version of the service"))
        return FileHead(str(head["kind"]), str(head["title"]), int(head["dof"]))
    except (LookupError, RecursionError, TypeError, ValueError):
        raise BrokenFile("content") from None


def _robot_of(document: Any) -> Robot:
    if not isinstance(document, dict):
        raise TypeError("a robot is an object")
    if document.get("format", 1) != 1:
        raise UnusableFile(say("was written by another version of the service"))
    said = document.get("messages", document)
    warnings = tuple(from_data(one) for one in said["warnings"])
    if document["kind"] == "dh":
        table = read_mapping(document["table"])
        doubts = tuple(from_data(one) for one in said.get("doubts", table.doubts))
        return robot_from_table(replace(table, warnings=warnings, doubts=doubts))
    robot = robot_from_urdf(
        document["urdf"], base=document["base"], tip=document["tip"], warnings=warnings
    )
    meshes = [mesh_from_data(one) for one in document.get("meshes", ())]
    return robot_with_meshes(robot, meshes) if meshes else robot
