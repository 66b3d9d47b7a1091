"""Numbers and names in attributes."""

from __future__ import annotations

import re
import unicodedata
from typing import TypeAlias

from lxml import etree

from dh_to_urdf.documents.checks import UNSEEN
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.poses import from_xyz_quaternion, to_rpy
from robots.errors import InvalidURDF
from robots.urdf.description import Origin, Triple
from robots.urdf.limits import MAX_MAGNITUDE, MAX_NAME, MAX_NUMBER

Element: TypeAlias = etree._Element

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_BLANKS = re.compile(r"[ \t\r\n]+")
_HIDDEN = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp", "Zs"})
"""Categories of characters that cannot be seen, turn the text round, end a line or look blank."""


def label_of(tag: str, name: str) -> str:
    """Return what messages call an element with a name, such as "link 'base'"."""
    shown = quoted(name, 64)
    if tag == "link":
        return say("link {name}", name=shown)
    if tag == "joint":
        return say("joint {name}", name=shown)
    return f"{tag} {shown}"


def name_of(element: Element, where: str) -> str:
    """Read the ``name`` attribute.

    Raises:
        InvalidURDF: Missing, blank, too long, or with characters that a reader cannot see.
    """
    name = element.get("name")
    if name is None or not name.strip():
        raise InvalidURDF(say("{where} has no name attribute; give it one", where=where))
    return checked_name(name, where)


def checked_name(name: str, where: str) -> str:
    """Return a name that people can read and tell from others.

    Raises:
        InvalidURDF: With what is wrong with it.
    """
    if len(name) > MAX_NAME:
        raise InvalidURDF(
            say(
                "{where} has a name of over {max_name} characters; shorten it",
                where=where,
                max_name=MAX_NAME,
            )
        )
    hidden = any(unicodedata.category(c) in _HIDDEN for c in name if c != " ")
    if hidden or re.search(UNSEEN, name):
        raise InvalidURDF(
            say(
                "{where} has the name {name}, with control characters or others that"
                " cannot be seen; remove them",
                where=where,
                name=quoted(name),
            )
        )
    if name != name.strip(" "):
        raise InvalidURDF(
            say(
                "{where} has the name {name}, with blanks at its ends; remove them",
                where=where,
                name=quoted(name),
            )
        )
    if not unicodedata.is_normalized("NFC", name):
        raise InvalidURDF(
            say(
                "{where} has the name {name}, whose accents are characters of their"
                " own; write it in composed form (Unicode NFC), so that equal names are"
                " equal",
                where=where,
                name=quoted(name),
            )
        )
    return name


def number(
    element: Element,
    key: str,
    where: str,
    default: str | None = None,
    bound: float = MAX_MAGNITUDE,
) -> float:
    """Read an attribute that is one number.

    Raises:
        InvalidURDF: See :func:`numbers`.
    """
    return numbers(element, key, 1, where, default, bound)[0]


def numbers(
    element: Element,
    key: str,
    count: int,
    where: str,
    default: str | None = None,
    bound: float = MAX_MAGNITUDE,
) -> tuple[float, ...]:
    """Read an attribute of numbers between blanks, in digits 0 to 9.

    Args:
        element: The element.
        key: The attribute.
        count: How many numbers.
        where: Link or joint, for the message.
        default: Text taken where the attribute is missing; None requires it.
        bound: Largest magnitude.

    Raises:
        InvalidURDF: Missing, another count, no finite numbers, or beyond the bound.
    """
    text = element.get(key, default)
    words = _words(text, count)
    if len(words) == count and all(map(_is_number, words)):
        values = tuple(map(float, words))
        if max(map(abs, values)) <= bound:
            return values
    # A large document has thousands of numbers: words are found for those at fault only.
    what = say("{where}: {key} of <{tag}>", where=where, key=key, tag=element.tag)
    raise InvalidURDF(_refusal(text, count, what, bound))


def _words(text: str | None, count: int) -> list[str]:
    """Return what stands between blanks; nothing of a text that is too long to be numbers."""
    if text is None or len(text) > count * (MAX_NUMBER + 8):
        return []
    return _BLANKS.split(text.strip(" \t\r\n"))


def _is_number(word: str) -> bool:
    return len(word) <= MAX_NUMBER and _NUMBER.fullmatch(word) is not None


def _refusal(text: str | None, count: int, what: str, bound: float) -> str:
    """Return why a text is not so many numbers within a bound."""
    if text is None:
        return say("{what} is missing; give it", what=what)
    words = _words(text, count)
    if len(words) != count or not words[0]:
        counted = (
            "1 number" if count == 1 else say("{count} numbers separated by blanks", count=count)
        )
        return say(
            "{what} is {text}; give {counted}", what=what, text=quoted(text), counted=counted
        )
    for word in words:
        if not _is_number(word):
            remedy = say("write a decimal point") if "," in word else say("give a finite number")
            if word.startswith(("${", "$(")):
                remedy = remedy + say(" (this is xacro: expand it with denavit push, or xacro)")
            return say("{what} has {word}; {remedy}", what=what, word=quoted(word), remedy=remedy)
    return say(
        "{what} is {text}, beyond ±{bound:g}; check the unit",
        what=what,
        text=quoted(text),
        bound=bound,
    )


def origin_of(element: Element, where: str, *, quaternions: bool = False) -> Origin:
    """Read the ``<origin>`` of an element; zero where there is none.

    Args:
        element: What has the origin.
        where: Link or joint, for the message.
        quaternions: Whether ``quat_xyzw`` counts, as it does since URDF 1.1.

    Raises:
        InvalidURDF: See :func:`numbers`; or two orientations, or a quaternion that is none.
    """
    origin = element.find("origin")
    if origin is None:
        return Origin()
    return read_origin(origin, where, quaternions=quaternions)


def read_origin(origin: Element, where: str, *, quaternions: bool) -> Origin:
    """Read an ``<origin>``.

    Raises:
        InvalidURDF: See :func:`origin_of`.
    """
    x, y, z = numbers(origin, "xyz", 3, where, "0 0 0")
    if origin.get("quat_xyzw") is not None:
        return Origin((x, y, z), _turned(origin, where, quaternions=quaternions))
    roll, pitch, yaw = numbers(origin, "rpy", 3, where, "0 0 0")
    return Origin((x, y, z), (roll, pitch, yaw))


def _turned(origin: Element, where: str, *, quaternions: bool) -> Triple:
    """Return ``quat_xyzw`` as roll, pitch and yaw."""
    if not quaternions:
        raise InvalidURDF(
            say(
                '{where}: quat_xyzw of <origin> counts since URDF 1.1: write <robot version="1.1">'
                " or give rpy",
                where=where,
            )
        )
    if origin.get("rpy") is not None:
        raise InvalidURDF(say("{where}: <origin> has rpy and quat_xyzw; keep one", where=where))
    quaternion = numbers(origin, "quat_xyzw", 4, where)
    try:
        R = from_xyz_quaternion((0.0, 0.0, 0.0), quaternion)[:3, :3]
    except ValueError as error:
        raise InvalidURDF(
            say("{where}: quat_xyzw of <origin> {error}", where=where, error=error)
        ) from None
    roll, pitch, yaw = to_rpy(R)
    return roll + 0.0, pitch + 0.0, yaw + 0.0


def write_origin(origin: Origin, twin: Element) -> None:
    """Add an ``<origin>`` to an element of the canonical URDF, unless it is zero."""
    if origin != Origin():
        etree.SubElement(twin, "origin", xyz=text_of(origin.xyz), rpy=text_of(origin.rpy))


def text_of(values: tuple[float, ...]) -> str:
    """Write numbers as digits that are read back exactly."""
    return " ".join(repr(value) for value in values)
