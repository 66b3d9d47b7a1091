"""Names of meshes in a URDF -> files of the archive that the URDF came in, and no others."""

from __future__ import annotations

import posixpath
from collections import defaultdict
from collections.abc import Iterable, Iterator
from urllib.parse import unquote

from robots.uploaded_mesh import mesh_name
from robots.urdf.mesh_names import portable_name

_SCHEMES = ("package://", "model://")
_FILE = "file://"


class MeshNames:
    """Names the meshes of a URDF by the files of its archive.

    Used as a function it returns the name that is kept: the one in the URDF where other programs
    may open that, else the path in the archive; None where there is neither.

    Args:
        urdf: Path of the URDF in the archive.
        files: Paths of all files.

    Attributes:
        members: The file of the archive for each name of a mesh.
        missing: Names in the URDF for which the archive has no file.
        ambiguous: Names in the URDF that may mean several files, and these.
    """

    def __init__(self, urdf: str, files: Iterable[str]) -> None:
        self.members: dict[str, str] = {}
        self.missing: dict[str, None] = {}
        self.ambiguous: dict[str, tuple[str, ...]] = {}
        self._several: list[str] = []
        self._folder = posixpath.dirname(urdf)
        self._files = {path: path for path in files}
        lowered: dict[str, list[str]] = defaultdict(list)
        self._ends: dict[str, list[str]] = defaultdict(list)
        for path in self._files:
            lowered[path.lower()].append(path)
            self._ends[path.rpartition("/")[2].lower()].append(path)
        # Names are often made where case does not matter.
        self._lowered = {key: found[0] for key, found in lowered.items() if len(found) == 1}

    def __call__(self, filename: str) -> str | None:
        """Return the name under which a mesh is kept."""
        self._several = []
        path = self.file_of(filename)
        if path is None:
            if self._several and ".." not in filename.replace("\\", "/").split("/"):
                self.ambiguous[filename] = tuple(self._several)
            else:
                self.missing[filename] = None
            return portable_name(filename)
        kept = portable_name(filename) or portable_name(path)
        if kept is None:
            self.missing[filename] = None
            return None
        while self.members.get(mesh_name(kept), path) != path:
            kept = f"archive/{mesh_name(kept)}"
        self.members[mesh_name(kept)] = path
        return kept

    def file_of(self, filename: str) -> str | None:
        """Return the file of the archive that a name in the URDF means; None for none."""
        for name in dict.fromkeys((filename, unquote(filename))):
            for candidate in self._candidates(name.replace("\\", "/").strip()):
                found = self._files.get(candidate) or self._lowered.get(candidate.lower())
                if found is not None:
                    return found
        return None

    def _candidates(self, name: str) -> Iterator[str]:
        """Yield the paths that a name may mean, the likeliest first."""
        scheme = next((one for one in _SCHEMES if name.startswith(one)), "")
        if scheme:
            name = name.removeprefix(scheme).lstrip("/")
            package, _, inside = name.partition("/")
            parts = self._folder.split("/") if self._folder else []
            above = ["/".join(parts[:k]) for k in range(len(parts), -1, -1)]
            yield from (_within(folder, name) for folder in above)
            # The archive may be the package itself, whose folder has another name then.
            if inside and not self._has_folder(package):
                yield from (_within(folder, inside) for folder in above)
            yield from self._by_end(name)
            if inside and not self._has_folder(package):
                yield from self._by_end(inside)
        elif name.startswith((_FILE, "/")) or name[1:3] == ":/":
            # A path of another machine: what of it the archive has.
            parts = [one for one in name.removeprefix(_FILE).split("/") if one not in ("", ".")]
            if ".." not in parts:
                for k in range(len(parts)):
                    yield "/".join(parts[k:])
                    yield from self._by_end("/".join(parts[k:]))
        else:
            yield _within(self._folder, name)
            yield _within("", name)

    def _has_folder(self, package: str) -> bool:
        return any(f"/{package}/" in f"/{path}" for path in self._files)

    def _by_end(self, end: str) -> Iterator[str]:
        """Yield the one file whose path ends so; nothing where there are several."""
        last = end.rpartition("/")[2].lower()
        found = [
            path
            for path in self._ends.get(last, ())
            if f"/{path.lower()}".endswith(f"/{end.lower()}")
        ]
        if len(found) == 1:
            yield found[0]
        elif found:
            self._several = self._several or found


def _within(folder: str, name: str) -> str:
    """Return a path below a folder; one that leaves the archive is the path of no file."""
    return posixpath.normpath(posixpath.join(folder, name))
