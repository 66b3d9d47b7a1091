"""Bodies and queries with one thing changed: what a refusal must name."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import Any
from urllib.parse import quote

VALUES: dict[str, Any] = {
    "null": None,
    "a text": "x",
    "an empty text": "",
    "seven": 7,
    "zero": 0,
    "negative": -1,
    "a fraction": 0.5,
    "true": True,
    "an empty list": [],
    "a list": [1],
    "a list of texts": ["x"],
    "an empty object": {},
    "an object": {"a": 1},
    "ten million": 1e7,
    "huge": 1e300,
    "a long text": "é" * 70 + "\u202e",
}
IN_LISTS = ("null", "a text", "true", "a list", "an object", "ten million", "huge")
"""What is put in the place of numbers in lists, of which there are many."""
HASTY = ("seven", "a fraction", "zero", "true")
"""Budgets of time that could run out."""
RAW: dict[str, bytes] = {
    "nothing": b"",
    "blanks": b" \n",
    "null": b"null",
    "a list": b"[]",
    "a text": b'"q"',
    "a number": b"3",
    "an empty object": b"{}",
    "no JSON": b"q=0,0",
    "single quotes": b"{'q': [0]}",
    "a mark": b'\xef\xbb\xbf{"q": [0]}',
    "UTF-16": '{"q": [0]}'.encode("utf-16"),
    "no UTF-8": b'{"q": [0], "frame": "\xc3\x28"}',
    "half of a pair": b'{"q": [0], "frame": "\\ud83d"}',
    "deep": b"[" * 3000,
    "deep in a field": b'{"q": ' + b"[" * 3000 + b"}",
    "two values": b"{}{}",
    "an unknown field alone": b'{"zzz": 1}',
    "fields with odd names": b'{"a/b~c": 1, "\\u202e": 2}',
}
TEXTS: dict[str, str] = {
    "empty": "",
    "a word": "x",
    "nan": "nan",
    "inf": "-inf",
    "huge": "1e16",
    "seven": "7",
    "negative": "-1",
    "a fraction": "0.5",
    "a trailing comma": "0.1,",
    "three": "0.1,0.2,0.3",
    "texts": "a,,b",
    "expressions": "pi/2,-90deg",
    "a length": "10mm",
    "a variable": "q1+pi",
    "division by zero": "1/0",
    "an underscore": "1_0",
    "Arabic": "٣",
    "a superscript": "²",
    "true": "true",
    "all": "all",
    "brackets": "[0.1,0.2]",
    "a sequence": "ZXZ:10,20,30",
    "an odd sequence": "ABC:1",
    "pairs": "a2:L1,a3:L2",
    "a long word": "y" * 90,
    "NUL": "a\0b",
}


def bodies(
    body: dict[str, Any], seen: set[tuple[Any, ...]] | None = None
) -> Iterator[tuple[str, bytes]]:
    """What is changed, and the body, for each field at any depth.

    Args:
        body: A body that works.
        seen: Fields of earlier bodies, which are left as they are; gets those of this one.
    """
    first = not seen
    seen = set() if seen is None else seen
    here = set()
    for place in _places(body):
        kind = _kind(body, place)
        if kind in seen:
            continue
        here.add(kind)
        name = "/".join(map(str, place))
        for what, changed in _changes(body, place):
            yield f"{name}: {what}", json.dumps(changed, ensure_ascii=False).encode()
    seen |= here
    if first:
        yield from _raw(body)


def _kind(body: Any, place: tuple[Any, ...]) -> tuple[Any, ...]:
    """A field, whichever its indices and values are."""
    value = _at(body, place)
    inner = type(value[0]).__name__ if isinstance(value, list) and value else ""
    above = _at(body, place[:-1])
    tag = above.get("type") if isinstance(above, dict) else ""
    keys = tuple("#" if isinstance(key, int) else key for key in place)
    return (*keys, type(value).__name__, inner, tag)


def _places(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(value, dict):
        for key, one in value.items():
            yield (*place, key)
            yield from _places(one, (*place, key))
    elif isinstance(value, list):
        for index in sorted({0, len(value) - 1} if _plain(value) else set(range(len(value)))):
            yield (*place, index)
            yield from _places(value[index], (*place, index))


def _plain(value: list[Any]) -> bool:
    return not any(isinstance(one, dict) for one in value)


def _changes(body: Any, place: tuple[Any, ...]) -> Iterator[tuple[str, Any]]:
    old = _at(body, place)
    in_list = isinstance(place[-1], int) and isinstance(old, int | float)
    for what in IN_LISTS if in_list else VALUES:
        if VALUES[what] == old or (place[-1] == "time_budget_ms" and what in HASTY):
            continue
        yield what, _with(body, place, VALUES[what])
    if not in_list:
        yield "gone", _without(body, place)
    if isinstance(old, list) and old:
        yield "one less", _with(body, place, old[:-1])
        yield "one more", _with(body, place, [*old, old[-1]])
        yield "in a list", _with(body, place, [old])
    elif isinstance(old, dict):
        yield "a field more", _with(body, place, {**old, "zzz": 1})
        first = next(iter(old))
        rest = {key: one for key, one in old.items() if key != first}
        yield "a field misspelt", _with(body, place, {first + "s": old[first], **rest})
    elif isinstance(old, str):
        yield "in capitals", _with(body, place, old.swapcase())
        yield "misspelt", _with(body, place, old + "s")
    elif isinstance(old, int) and not isinstance(old, bool):
        yield "as a float", _with(body, place, old + 0.25)
        yield "as a text", _with(body, place, str(old))
    if len(place) == 1:
        yield "misspelt field", {**_without(body, place), f"{place[0]}s": old}
        yield "field in capitals", {**_without(body, place), str(place[0]).upper(): old}


def _raw(body: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    yield from ((f"raw: {what}", text) for what, text in RAW.items())
    text = json.dumps(body)
    first = next(iter(body))
    again = json.dumps({first: body[first]})[1:-1]
    yield "raw: cut", text[:-2].encode()
    yield "raw: a comma more", f"{text[:-1]},}}".encode()
    yield "raw: a field twice", f"{text[:-1]}, {again}}}".encode()
    yield (
        "raw: a field twice by an escape",
        (f'{text[:-1]}, "\\u{ord(first[0]):04x}{first[1:]}": 1}}'.encode()),
    )
    yield "raw: an unknown field first", f'{{"zzz": 1, {text[1:]}'.encode()
    for word in ("NaN", "-Infinity", "1e400", "1" + "0" * 400, "01", "+1", ".5", "1."):
        name = word if len(word) < 10 else "400 digits"
        yield f"raw: {name}", f'{{"{first}": {word}, {text[1:]}'.encode()
        yield f"raw: {name} in a list", f'{{"q": [{word}, 0]}}'.encode()


NAMES = (
    "frame",
    "base",
    "expressed_in",
    "parameters",
    "choose",
    "method",
    "time_law",
    "view",
    "reference_frame",
    "joints",
    "methods",
    "quantities",
    "symbols",
    "frames",
)
"""Parameters that are names, which are wrong in fewer ways than numbers."""
OF_NAMES = (
    "empty",
    "a word",
    "seven",
    "a trailing comma",
    "texts",
    "all",
    "pairs",
    "a long word",
    "NUL",
    "a superscript",
)


def queries(query: dict[str, str], known: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """What is changed, and the query."""
    for name in known:
        for what, text in TEXTS.items():
            if name in NAMES and what not in OF_NAMES:
                continue
            if name == "time_budget_ms" and what in ("seven", "a fraction"):
                continue
            yield f"{name}: {what}", encoded({**query, name: text})
        if name in query:
            yield f"{name}: gone", encoded({k: v for k, v in query.items() if k != name})
            yield f"{name}: twice", f"{encoded(query)}&{name}={quote(query[name])}"
            yield f"{name}: in capitals", encoded({**query, name.upper(): query[name]})
        yield f"{name}: misspelt", encoded({**query, f"{name}s": "1"})
    for what, more in {
        "unknown": "zzz=1",
        "odd name": "a%0Ab%E2%80%AE=1",
        "grad": "angle=grad",
        "empty angle": "angle=",
        "angle twice": "angle=deg&angle=deg",
        "degrees": "angle=deg",
        "empty format": "format=",
        "unknown format": "format=exe",
        "text": "format=text",
        "a name without value": "zzz",
        "a tilde": "a~b/c=1",
    }.items():
        yield f"query: {what}", f"{encoded(query)}&{more}"
    yield "query: nothing", ""


def encoded(query: dict[str, str]) -> str:
    """A query string with commas as they are."""
    return "&".join(f"{name}={quote(text, safe=',:[]/')}" for name, text in query.items())


def _at(value: Any, place: tuple[Any, ...]) -> Any:
    for key in place:
        value = value[key]
    return value


def _with(body: Any, place: tuple[Any, ...], new: Any) -> Any:
    changed = copy.deepcopy(body)
    _at(changed, place[:-1])[place[-1]] = copy.deepcopy(new)
    return changed


def _without(body: Any, place: tuple[Any, ...]) -> Any:
    changed = copy.deepcopy(body)
    del _at(changed, place[:-1])[place[-1]]
    return changed
