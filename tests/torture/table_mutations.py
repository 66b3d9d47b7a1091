"""What goes wrong with D-H tables. Seeded, fast."""

from __future__ import annotations

import io
import json
import random
import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ruamel.yaml import YAML

from tests.torture.table_grammar import Text

VALUES: tuple[Any, ...] = (
    *(None, True, False, "", " ", [], {}, [1], {"a": 1}, 0, -1, 1.5, 1e308, -1e308, 1e-320),
    *(10**400, float("nan"), float("inf"), 1e6, 1e7, "nan", "inf", "-Infinity", ".nan"),
    *("1e999", "0x10", "1_0", "٣", "１", "1,5", "1,234", "1.234,5", "pi/0", "0/0", "pi pi"),
    *("((((", "1)", "q1", "q9", "L3", "sqrt(-1)", "atan2(0,0)", "9**9**9", "10**400", "${x}"),
    *("__import__('os')", "=1+1", "90deg", "90°", "1rad", "5mm", "1 m", "2*q1", "q1+q2", "-q1"),
    *("theta1", "x" * 5000, "1" * 100, "revolute", "ball", "R", "fixed", "standard", "a\nb"),
    *("../../etc/passwd", "\u202egnp", "\x00", "\ud800", "e\u0301", "{{7*7}}", "%s%n", "'", '"'),
    *("<script>", "null", "~", "yes", "!!int 3"),
)
KEYS = (
    *("name", "type", "a", "alpha", "d", "theta", "r", "offset", "sign", "limits", "ant", "sigma"),
    *("mu", "gamma", "b", "lower", "upper", "units", "base", "tool", "xyz", "rpy", "matrix"),
    *("joints", "values", "inertial", "visual", "x", "constructor", "__class__", "A", "alfa"),
)
SCRAPS = (
    *(
        b"\x00",
        b"\xff",
        b"\xfe\xff",
        b"\xef\xbb\xbf",
        b"{",
        b"}",
        b"[",
        b"]",
        b"(",
        b")",
        b"(*",
        b"*)",
    ),
    *(
        b"'",
        b'"',
        b"\\",
        b"\\frac{",
        b"$",
        b"%",
        b"#",
        b"&",
        b"*",
        b"&a *a ",
        b"<<: ",
        b"!!python/x ",
    ),
    *(
        b"|",
        b",",
        b";",
        b"\t",
        b"\r",
        b"\n",
        b"\n\n",
        b"---\n",
        b"...\n",
        b": ",
        b"- ",
        b"=",
        b"for ",
    ),
    *(b"1e999", b"nan", b"\xe2\x80\xae", b"\xc2\xa0", b"\xed\xa0\x80", b"\xc3", b"9" * 500, b"pi"),
    *(b"[" * 500, b"(" * 500, b"{" * 300, b'"' * 3, b"\\begin{tabular}", b"\\\\", b"Link("),
)
ENCODINGS = ("utf-16", "latin-1", "utf-7", "utf-8-sig", "utf-32", "cp1252")


def mutate(rng: random.Random, text: Text) -> Text:
    """A document with one to three things wrong, or changed without harm."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3))):
        if text.format in ("json", "yaml") and rng.random() < 0.65:
            text = _mutate_mapping(rng, text)
        elif rng.random() < 0.4:
            text = _mutate_cell(rng, text)
        else:
            text = replace(text, content=rng.choice(_BYTES)(rng, text.content))
    if rng.random() < 0.03:
        kinds = ("standard", "modified", "khalil", "", "dh\n", "x" * 300)
        text = replace(text, convention=rng.choice(kinds))
    return text


def _mutate_mapping(rng: random.Random, text: Text) -> Text:
    try:
        if text.format == "json":
            data = json.loads(text.content)
        else:
            data = YAML(typ="safe", pure=True).load(text.content)
    except Exception:
        return replace(text, content=rng.choice(_BYTES)(rng, text.content))
    places = list(_places(data))
    if not places:
        return text
    holder, key = rng.choice(places)
    kind = rng.choice(("set", "set", "set", "drop", "rename", "repeat", "swap", "deep"))
    if kind == "set":
        holder[key] = rng.choice(VALUES)
    elif kind == "drop":
        del holder[key]
    elif kind == "rename" and isinstance(holder, dict):
        holder[rng.choice(KEYS)] = holder.pop(key)
    elif kind == "repeat" and isinstance(holder, list):
        holder.extend([holder[key]] * rng.choice((1, 1, 1, 400)))
    elif kind == "swap":
        other, place = rng.choice(places)
        value = other[place]
        if not isinstance(value, (dict, list)):
            holder[key] = value
    elif kind == "deep":
        value = holder[key]
        for _ in range(rng.choice((1, 2, 50))):
            value = [value]
        holder[key] = value
    return replace(text, content=_written(text.format, data))


def _written(form: str, data: Any) -> bytes:
    if form == "json":
        return json.dumps(data).encode("utf-8", "surrogatepass")
    stream = io.StringIO()
    try:
        YAML(typ="safe", pure=True).dump(data, stream)
    except Exception:
        return json.dumps(data).encode("utf-8", "surrogatepass")
    return stream.getvalue().encode("utf-8", "surrogatepass")


def _places(data: Any) -> Any:
    keys = data.keys() if isinstance(data, dict) else range(len(data))
    for key in keys if isinstance(data, (dict, list)) else ():
        yield data, key
        if isinstance(data[key], (dict, list)):
            yield from _places(data[key])


def _mutate_cell(rng: random.Random, text: Text) -> Text:
    """One number or word of the text replaced, doubled or taken away."""
    words = list(re.finditer(rb"[\w.+\-/*]+", text.content))
    if not words:
        return text
    word = rng.choice(words)
    new = str(rng.choice(VALUES)).encode("utf-8", "surrogatepass")
    piece = rng.choice((new, new, b"", word[0] + b" " + word[0], word[0] + b",", word[0].upper()))
    return replace(text, content=text.content[: word.start()] + piece + text.content[word.end() :])


def _flip(rng: random.Random, content: bytes) -> bytes:
    if not content:
        return content
    at = rng.randrange(len(content))
    return content[:at] + bytes([content[at] ^ (1 << rng.randrange(8))]) + content[at + 1 :]


def _cut(rng: random.Random, content: bytes) -> bytes:
    return content[: rng.randrange(len(content) + 1)]


def _hole(rng: random.Random, content: bytes) -> bytes:
    start = rng.randrange(len(content) + 1)
    return content[:start] + content[start + rng.choice((1, 2, 5, 40)) :]


def _insert(rng: random.Random, content: bytes) -> bytes:
    at = rng.choice((0, len(content), rng.randrange(len(content) + 1)))
    return content[:at] + rng.choice(SCRAPS) + content[at:]


def _lines(rng: random.Random, content: bytes) -> bytes:
    """Lines dropped, doubled or exchanged."""
    lines = content.split(b"\n")
    one, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.choice(("drop", "double", "swap", "many"))
    if kind == "drop":
        del lines[one]
    elif kind == "swap":
        lines[one], lines[other] = lines[other], lines[one]
    else:
        lines[one:one] = [lines[one]] * (1 if kind == "double" else 400)
    return b"\n".join(lines)


def _recode(rng: random.Random, content: bytes) -> bytes:
    return content.decode("utf-8", "replace").encode(rng.choice(ENCODINGS), "replace")


_BYTES: tuple[Callable[[random.Random, bytes], bytes], ...] = (
    *(_flip, _flip, _flip, _cut, _hole, _insert, _insert, _insert, _lines, _lines, _recode),
)
