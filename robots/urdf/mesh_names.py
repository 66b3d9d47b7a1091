"""Names of mesh files, which are kept as text only.

Programs that read the canonical URDF open the files that it names. So only names within a package
or below the URDF's own directory are kept: no absolute paths, no other hosts, no ``..``.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable
from typing import TypeAlias

MeshNames: TypeAlias = Callable[[str], str | None]
"""Returns the name under which a mesh is kept, from that in the document; None: left out."""
MAX_LENGTH = 512
_PACKAGE = "package://"
_UNSAFE = re.compile(r"""[\\:%~$`|<>"'*?#&;{}]""")


def portable_name(filename: str) -> str | None:
    """Return the name where it is ``package://…`` or a relative path downwards, else None.

    ``package:///arm/a.stl``, which some exporters write, loses its third slash: programs that cut
    off ``package://`` would open ``/arm/a.stl``.
    """
    if len(filename) > MAX_LENGTH or filename != filename.strip():
        return None
    if any(unicodedata.category(c)[0] in "CZ" for c in filename if c != " "):
        return None
    scheme = _PACKAGE if filename.startswith(_PACKAGE) else ""
    path = filename.removeprefix(_PACKAGE)
    path = path.removeprefix("/") if scheme else path.removeprefix("./")
    if _UNSAFE.search(path) or {"", ".", ".."} & {part.strip() for part in path.split("/")}:
        return None
    return scheme + path
