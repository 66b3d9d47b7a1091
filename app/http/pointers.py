"""JSON pointers (RFC 6901): the only place that writes locations as the API shows them."""

from __future__ import annotations

from dh_to_urdf.errors import Location, printable


def json_pointer(location: Location) -> str:
    """Return a location as a JSON pointer: ``("joints", 2, "a/b")`` -> ``/joints/2/a~1b``.

    Args:
        location: Keys and indices from the root of the request to the value at fault.

    Returns:
        The pointer, empty for the root; a key is cut to 64 characters, and ``?`` stands for what
        cannot be seen.
    """
    return "".join(f"/{escaped(part)}" for part in location)


def escaped(token: object) -> str:
    """Return a key as one token of a JSON pointer, at most 64 characters that can be seen."""
    return printable(str(token)).replace("~", "~0").replace("/", "~1")
