"""What of a URDF is left out or mended, collected while it is read: one sentence a kind."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say

_PLACES = 3
"""Places that a sentence names."""
_KINDS = 20
"""Sentences of one document."""


class Notes:
    """Kinds of what was left out or mended, each with the links or joints where it was."""

    def __init__(self) -> None:
        self._found: dict[str, dict[str, None]] = {}
        self._beyond = 0

    def add(self, text: str, where: str = "") -> None:
        """Note a kind at a place; empty for the whole document."""
        if text not in self._found and len(self._found) >= _KINDS:
            self._beyond += 1
            return
        places = self._found.setdefault(text, {})
        if where:
            places[where] = None

    def sentences(self) -> tuple[str, ...]:
        """Return a warning for each kind, with the first few of its places."""
        found = [_sentence(text, list(places)) for text, places in self._found.items()]
        if self._beyond:
            found.append(
                say(
                    "{count} more such parts are left out, which kinematics does not use",
                    count=self._beyond,
                )
            )
        return tuple(found)


def _sentence(text: str, places: list[str]) -> str:
    if not places:
        return text
    beyond = len(places) - _PLACES
    more = say(" and {count} more", count=beyond) if beyond > 0 else ""
    return say(
        "{places}{more}: {text}", places=chained(", ", places[:_PLACES]), more=more, text=text
    )
