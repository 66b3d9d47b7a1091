"""What the JSON decoder says, as messages: of values that do not fit, and of texts."""

from __future__ import annotations

import re

from dh_to_urdf.messages import chained, say

_TYPES = {
    "float": say("a number"),
    "int": say("an integer"),
    "str": say("a text"),
    "array": say("a list"),
    "object": say("an object"),
    "bool": say("true or false"),
}
_NAMES = r"[a-z]+(?: \| [a-z]+)*"
_UNLIKE = re.compile(rf"Expected ({_NAMES}), got ({_NAMES})")
_ALONE = re.compile(rf"Expected ({_NAMES})")
_LENGTH = re.compile(rf"Expected ({_NAMES}) of length ((?:[<>]= )?\d+)")
_BOUND = re.compile(rf"Expected ({_NAMES}) ([<>]=? .+)")
_PATTERN = re.compile(rf"Expected ({_NAMES}) matching regex (.+)", re.DOTALL)
_CHOICE = re.compile(r"Invalid enum value (.+)", re.DOTALL)
_BYTE = re.compile(r"(.*) \(byte (\d+)\)", re.DOTALL)
_SYNTAX = {
    one.template.one: one
    for one in (
        say("invalid character"),
        say("invalid number"),
        say("number out of range"),
        say("invalid escape character in string"),
        say("invalid escaped character"),
        say("invalid character in unicode escape"),
        say("invalid utf-16 surrogate pair"),
        say("object keys must be strings"),
        say("trailing characters"),
        say("trailing comma in object"),
        say("trailing comma in array"),
        say("expected ',' or ']'"),
        say("expected ',' or '}}'"),
        say("expected '\"'"),
        say("expected ':'"),
    )
    if one.template
}


def words_of_value(text: str) -> str:
    """Say what is wrong with a value.

    Args:
        text: What msgspec says of it, without the path and without quotes of types.
    """
    if found := _UNLIKE.fullmatch(text):
        return say(
            "expected {wanted}, got {given}", wanted=_named(found[1]), given=_named(found[2])
        )
    if found := _ALONE.fullmatch(text):
        return say("expected {wanted}", wanted=_named(found[1]))
    if found := _LENGTH.fullmatch(text):
        return say("expected {wanted} of length {size}", wanted=_named(found[1]), size=found[2])
    if found := _PATTERN.fullmatch(text):
        pattern = found[2]
        return say(
            "expected {wanted} matching regex {pattern}", wanted=_named(found[1]), pattern=pattern
        )
    if found := _BOUND.fullmatch(text):
        return say("expected {wanted} {bound}", wanted=_named(found[1]), bound=found[2])
    if found := _CHOICE.fullmatch(text):
        return say("invalid enum value {value}", value=found[1])
    return _syntax(text[:1].lower() + text[1:])


def words_of_text(text: str) -> str:
    """Say what makes a text no JSON, and where.

    Args:
        text: What msgspec says of it.
    """
    reason = text.removeprefix("JSON is malformed: ")
    found = _BYTE.fullmatch(reason)
    if found is None:
        return _syntax(reason)
    words = say("{what} at byte {position}", what=_syntax(found[1]), position=found[2])
    if "invalid character" in reason:
        words += say("; NaN and Infinity are not JSON, and texts take double quotes")
    return words


def _named(names: str) -> str:
    return chained(" | ", (_TYPES.get(name, name) for name in names.split(" | ")))


def _syntax(reason: str) -> str:
    return _SYNTAX.get(reason.replace("}", "}}"), reason)
