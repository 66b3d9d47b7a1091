"""How a program is refused, with its line."""

from __future__ import annotations

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say


def refused(line: int, words: str) -> DHError:
    """Return the error for a statement that is not read."""
    return DHError.single((), say("line {line}: {words}", line=line, words=words))
