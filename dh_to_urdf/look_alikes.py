"""Names that a reader takes for one another: they differ by case, or by letters that look alike.

A short table of the letters that scripts share (Unicode Technical Standard 39 has them all), after
compatibility composition (NFKC), which resolves ligatures and wide letters.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable

from dh_to_urdf.messages import chained, say

MOST = 2
"""Pairs that are named."""
_CYRILLIC = str.maketrans("АВЕКМНОРСТХУІЈЅаеорсхуіјѕкԁһԛԝ", "ABEKMHOPCTXYIJSaeopcxyijskdhqw")
_GREEK = str.maketrans("ΑΒΕΖΗΙΚΜΝΟΡΤΥΧοικρυν", "ABEZHIKMNOPTYXoikpuv")
_OTHERS = str.maketrans("ıɡ‐‑–−’ʼ", "ig----''")
_STROKES = str.maketrans("0OI1|", "oolll")
"""Digits and letters that look alike in many fonts."""


def by_case(name: str) -> str:
    """Return a text that is equal for names that differ by case or script only."""
    return _in_latin(name).casefold()


def by_shape(name: str) -> str:
    """Return a text that is equal for names whose letters and digits look alike."""
    return _in_latin(name).translate(_STROKES)


def look_alikes(kind: str, names: Iterable[str]) -> tuple[str, ...]:
    """Return a warning that names two of the names that look alike; none where all differ.

    Args:
        kind: What they name, in the plural, such as "joints".
        names: Different names.
    """
    pairs: list[tuple[str, str]] = []
    seen: dict[str, str] = {}
    for name in names:
        for key in ("c" + by_case(name), "s" + by_shape(name)):
            other = seen.setdefault(key, name)
            if other != name and (other, name) not in pairs:
                pairs.append((other, name))
    if not pairs:
        return ()
    shown = chained(
        say(", and "),
        (say("{a} and {b}", a=shown_name(a), b=shown_name(b)) for a, b in pairs[:MOST]),
    )
    more = say(" (and {count} more pairs)", count=len(pairs) - MOST) if len(pairs) > MOST else ""
    return (
        say(
            "{kind} {shown}{more} look alike; give them names that differ more",
            kind=kind,
            shown=shown,
            more=more,
        ),
    )


def shown_name(name: str) -> str:
    """Write a name between quotes, with the code points of its letters beyond ASCII."""
    odd = " ".join(f"U+{ord(c):04X}" for c in dict.fromkeys(name) if not c.isascii())
    return f"'{name}' ({odd})" if odd else f"'{name}'"


def _in_latin(name: str) -> str:
    text = name if name.isascii() else unicodedata.normalize("NFKC", name)
    if text.isascii():
        return text
    return text.translate(_CYRILLIC).translate(_GREEK).translate(_OTHERS)
