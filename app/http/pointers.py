"""Locations in a request as JSON pointers (RFC 6901)."""

from __future__ import annotations

from collections.abc import Iterable

from dh_to_urdf.errors import escaped


def json_pointer(location: Iterable[str | int]) -> str:
    """Return the pointer to a location: ``("q", 3)`` is ``/q/3``; empty for an empty one."""
    return "".join(f"/{escaped(part)}" for part in location)
