"""Documents of tables that are large, or a little deeper than is read."""

from __future__ import annotations

import json
from typing import Any

from tests.torture.table_grammar import Text

_ROW = {"type": "R", "alpha": 0, "a": 0, "d": 0}
_KEYS = {f"k{k}": 1 for k in range(100_000)}


def _json(**changes: Any) -> str:
    return json.dumps({"convention": "dh", "joints": [_ROW], **changes})


def _large() -> dict[str, tuple[str, str]]:
    heading = "| i | alpha | a | d | theta |\n|---|---|---|---|---|\n"
    return {
        "keys": ("json", _json(**_KEYS)),
        "keys of a row": ("json", _json(joints=[_ROW | _KEYS])),
        "keys of limits": ("json", _json(joints=[{**_ROW, "limits": _KEYS}])),
        "a key twice": ("json", "{" + ",".join(f'"k{k}":1' for k in range(100_000)) + ',"k1":2}'),
        "lists in lists": ("json", "[" * 1_100),
        "mappings in mappings": ("json", '{"a":' * 1_100),
        "a long number": ("json", '{"a":' + "9" * 1_900_000 + "}"),
        "a long name": ("json", _json(name="x" * 1_900_000)),
        "bad rows": ("json", _json(joints=[{}] * 300)),
        "many rows": ("json", _json(joints=[{}] * 300_000)),
        "a wide matrix": ("json", _json(tool={"matrix": [[1] * 50_000] * 4})),
        "many values": ("json", _json(values=_KEYS)),
        "a flow of numbers": ("yaml", "[" * 10 + "1," * 31_000 + "1" + "]" * 10),
        "many keys": ("yaml", "\n".join(f"k{k}: {k}" for k in range(5500))),
        "an unquoted text": ("yaml", "a: " + "x " * 31_000),
        "anchors": ("yaml", "a: " + "&x " * 20_000),
        "dashes": ("yaml", "- " * 40),
        "braces": ("yaml", "{" * 40),
        "columns": ("csv", "," * 1_900_000),
        "rows": ("csv", "type,alpha,a,d\n" + "R,0,0,0\n" * 100_000),
        "an open quote": ("csv", '"' + "a" * 1_900_000),
        "open braces": ("par", "alpha = {" * 50_000),
        "open comments": ("par", "(*" * 240_000),
        "nested comments": ("par", "(*" * 120_000 + "*)" * 120_000),
        "notes": ("par", "(* Joint 1: name = 'x' *)" * 19_000 + "alpha={0}"),
        "pipes": ("pasted", "|" * 99_000),
        "words": ("pasted", "a " * 49_000),
        "lines": ("pasted", heading + "| 1 | 0 | 0 | 0 | q |\n" * 4000),
        "fractions": ("pasted", "\\begin{tabular}{cc}" + "\\frac{" * 13_000),
        "brackets": ("pasted", "L = [" + "[" * 90_000),
        "links": ("pasted", "L(1) = Link(" * 7000),
        "quotes": ("pasted", '"""' * 33_000),
    }


LARGE = {name: Text(form, text.encode(), "dh") for name, (form, text) in _large().items()}
