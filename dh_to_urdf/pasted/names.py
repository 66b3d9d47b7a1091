"""Names of robots in texts -> names as they are here."""

from __future__ import annotations

import re

from dh_to_urdf.documents.checks import NAME
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say

_FOREIGN = re.compile(r"[^\w .+:-]", re.ASCII)


def name_of(text: str | None, warnings: list[str]) -> str | None:
    """Return the name of a robot, without characters that names here do not have.

    Args:
        text: The name in the text, None for none.
        warnings: Receives what was changed.
    """
    if text is None or NAME.fullmatch(text):
        return text
    name = _FOREIGN.sub("_", text)[:64].strip(" ._-+:")
    if not name or not NAME.fullmatch(name):
        return None
    warnings.append(
        say("the name {robot} is written {name}", robot=quoted(text), name=quoted(name))
    )
    return name
