"""Zip archives of strangers, read in the process for meshes: names, and the bytes of a member.

Nothing is unpacked to a disk: names are keys only. Links, encrypted members and names that leave
the archive are passed over, so that no name ever stands for anything else than a member.
"""

from __future__ import annotations

import io
import stat
import zipfile
import zlib
from dataclasses import dataclass, field

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import plural, say
from kinematics.meshes.refusals import MOST_SHOWN, MeshRefused, shown_name

MAX_MEMBERS = 10_000
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


@dataclass
class Archive:
    """An archive.

    Attributes:
        names: The members that may be read, by the path that names them, in order.
        notes: What was passed over.
    """

    names: dict[str, zipfile.ZipInfo] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    _zip: zipfile.ZipFile | None = None

    @classmethod
    def of(cls, content: bytes) -> Archive:
        """Open an archive.

        Raises:
            MeshRefused: It is none, is encrypted, or has too many members or two of one name.
        """
        try:
            opened = zipfile.ZipFile(io.BytesIO(content))
        except (zipfile.BadZipFile, ValueError, NotImplementedError, OSError, EOFError):
            raise MeshRefused(say("the body is no zip archive, or it is cut off")) from None
        if len(opened.infolist()) > MAX_MEMBERS:
            raise MeshRefused(
                say(
                    "the archive has {count} entries; at most {most} are read: pack the URDF and"
                    " its meshes only",
                    count=len(opened.infolist()),
                    most=MAX_MEMBERS,
                )
            )
        return cls(_zip=opened)._listed(opened)

    def read(self, name: str, most: int) -> bytes:
        """Return the bytes of a member.

        Raises:
            MeshRefused: It is larger than it may be, or cannot be unpacked.
        """
        info = self.names[name]
        assert self._zip is not None
        too_large = MeshRefused(
            say("it has over {most} bytes when it is unpacked", most=most),
        )
        if info.file_size > most:
            raise too_large
        try:
            with self._zip.open(info) as stream:
                content = stream.read(most + 1)
        except (
            zipfile.BadZipFile,
            zlib.error,
            ValueError,
            NotImplementedError,
            RuntimeError,
            OSError,
            EOFError,
        ):
            raise MeshRefused(say("it cannot be unpacked: the archive is damaged")) from None
        if len(content) > most:
            raise too_large
        return content

    def _listed(self, opened: zipfile.ZipFile) -> Archive:
        outside = links = 0
        odd: list[str] = []
        for info in opened.infolist():
            if info.is_dir():
                continue
            if info.flag_bits & 1:
                raise MeshRefused(say("the archive is encrypted; pack it without a password"))
            path = _path(info.filename)
            mode = info.external_attr >> 16
            if path is None:
                outside += 1
            elif mode and not stat.S_ISREG(mode) and stat.S_IFMT(mode):
                links += 1
            elif info.compress_type not in _METHODS:
                odd.append(path)
            elif _is_apples(path):
                continue
            elif path in self.names:
                raise MeshRefused(
                    say(
                        "the archive has two entries {name!r}; pack it anew",
                        name=shown_name(path),
                    )
                )
            else:
                self.names[path] = info
        self._note(outside, links, odd)
        return self

    def _note(self, outside: int, links: int, odd: list[str]) -> None:
        if outside:
            self.notes.append(
                plural(
                    "an entry whose name leaves the archive is passed over",
                    "{count} entries whose names leave the archive are passed over",
                    count=outside,
                )
            )
        if links:
            self.notes.append(
                plural(
                    "a link in the archive is passed over; pack the file that it points to",
                    "{count} links in the archive are passed over; pack the files that they point"
                    " to",
                    count=links,
                )
            )
        if odd:
            self.notes.append(
                plural(
                    "an entry is packed by a method that is not read: {names}; pack it by deflate",
                    "{count} entries are packed by a method that is not read, such as {names}; pack"
                    " them by deflate",
                    count=len(odd),
                    names=", ".join(quoted(shown_name(name), 2 * MOST_SHOWN) for name in odd[:3]),
                )
            )


def _path(filename: str) -> str | None:
    """Return the path of a member; None where it leaves the archive."""
    path = filename.replace("\\", "/")
    while path.startswith("./"):
        path = path[2:]
    parts = path.split("/")
    if path.startswith("/") or ".." in parts or (parts[0][1:2] == ":") or "\0" in path:
        return None
    return "/".join(part for part in parts if part not in ("", ".")) or None


def _is_apples(path: str) -> bool:
    """Return whether a member is what macOS adds beside each file."""
    return path.startswith("__MACOSX/") or path.rpartition("/")[2].startswith("._")
