"""Methods of lists of Python."""

from __future__ import annotations

from collections.abc import Sequence

from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.indexing import python_key
from dh_to_urdf.pasted.programs.numbers import whole
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import MAX_ITEMS, Items, Opaque, Unread, Value, is_part


def call(
    owner: Items, name: str, arguments: Sequence[Value], keywords: dict[str, Value], line: int
) -> Value:
    """Return what ``owner.name(…)`` returns; the list changes as in Python.

    Raises:
        Unread: The call has no value here.
        DHError: It changes a list of links in a way that is not read.
    """
    if name == "copy" and not arguments:
        return Items(list(owner.items), owner.is_tuple)
    if name in ("index", "count"):
        return Opaque(say("{name}() of a list", name=name), line)
    if owner.is_tuple or keywords:
        raise Unread(say("{name}() is not read here", name=name))
    if owner.robot is not None:
        raise refused(
            line, say("the list of links of a robot is changed after it was made; change it before")
        )
    match name, len(arguments):
        case "append", 1:
            owner.items.append(arguments[0])
        case "extend", 1:
            owner.items += _several(arguments[0], line)
        case "insert", 2:
            owner.items.insert(whole(arguments[0]), arguments[1])
        case "pop", 0 | 1:
            if not owner.items:
                raise Unread(say("takes from an empty list"))
            return owner.items.pop(python_key(arguments[0], len(owner.items)) if arguments else -1)
        case "remove", 1:
            positions = [k for k, item in enumerate(owner.items) if item is arguments[0]]
            if not positions:
                raise Unread(say("removes a value that is not in the list"))
            del owner.items[positions[0]]
        case "reverse", 0:
            owner.items.reverse()
        case "clear", 0:
            owner.items.clear()
        case _:
            if is_part(owner):
                raise refused(line, say("{name}() of a list of links is not read", name=name))
            raise Unread(say("{name}() of a list is not read", name=name))
    if len(owner.items) > MAX_ITEMS:
        raise refused(line, say("the list is too long"))
    return None


def _several(value: Value, line: int) -> list[Value]:
    if isinstance(value, Items):
        return list(value.items)
    why = (
        say("({why}, line {line})", why=value.why, line=value.line)
        if isinstance(value, Opaque)
        else say("is no list")
    )
    raise refused(line, say("a list is extended by a value that is not known {why}", why=why))
