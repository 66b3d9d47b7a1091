"""A file that is refused in the process for meshes."""

from __future__ import annotations

MOST_SHOWN = 80
"""Characters of a name in a sentence."""


class MeshRefused(ValueError):
    """A mesh or an archive that is not read; the message says why."""


def shown_name(name: str) -> str:
    """Return a name for a sentence: its end, where it is long."""
    return name if len(name) <= MOST_SHOWN else "…" + name[-MOST_SHOWN:]
