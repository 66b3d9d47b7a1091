"""JSON pointers (RFC 6901) of places in a request."""

from __future__ import annotations

from collections.abc import Iterable

MAX_TOKEN = 64


def json_pointer(location: Iterable[object]) -> str:
    """Return the JSON pointer of a place: ``("joints", 2, "alpha")`` -> ``/joints/2/alpha``."""
    return "".join(f"/{escaped(part)}" for part in location)


def escaped(token: object) -> str:
    """Return a key as one token of a pointer, at most 64 characters that can be seen."""
    shown = "".join(c if c.isprintable() else "?" for c in str(token)[:MAX_TOKEN])
    return shown.replace("~", "~0").replace("/", "~1")
