"""Where an answer differs from the recorded one; nothing where they say the same.

Bodies are the same where they are equal byte for byte. Else, for other machines, numbers that are
no integers may differ by ``TOLERANCE``, relative and absolute, in text also by one unit of the last
decimal that is written. Statuses, headers, keys and their order, texts and structure are equal.
"""

from __future__ import annotations

import difflib
import json
import re
from typing import Any

from tests.recorded.fixture import Answer
from tests.recorded.normalise import split

TOLERANCE = 1e-9
_INTEGER = re.compile(r"-?\d+")


def differences(old: Answer, new: Answer) -> list[str]:
    """What differs, one line each, at most a dozen."""
    found = []
    if old.status != new.status:
        found.append(f"status: {old.status} -> {new.status}")
    found += _of_headers(old.headers, new.headers)
    found += _of_bodies(old, new)
    return found[:12]


def _of_headers(old: dict[str, str], new: dict[str, str]) -> list[str]:
    return [
        f"header {name}: {old.get(name)!r} -> {new.get(name)!r}"
        for name in sorted({*old, *new})
        if old.get(name) != new.get(name)
    ]


def _of_bodies(old: Answer, new: Answer) -> list[str]:
    if old.text is None or new.text is None:
        return _of_digests(old, new)
    if old.text == new.text:
        return []
    if old.text[:1] in "{[" and new.text[:1] in "{[":
        found = _of_json(old.text, new.text)
        if found is not None:
            return found
    return _of_texts(old.text, new.text)


def _of_digests(old: Answer, new: Answer) -> list[str]:
    before, after = old.digest, new.digest
    if before is None or after is None:
        return [f"body: {_shown(old)} -> {_shown(new)}"]
    if before["sha256"] == after["sha256"]:
        return []
    if "pixels" in before and before["pixels"] == after.get("pixels"):
        return []
    same = "shape" in before and all(
        before[name] == after.get(name) for name in ("shape", "numbers", "keys") if name in before
    )
    if same:
        bound = TOLERANCE * (1 + before["sums"][0])
        if all(abs(a - b) <= bound for a, b in zip(before["sums"], after["sums"], strict=True)):
            return []
    named = [name for name in before if before[name] != after.get(name)]
    return [f"long body, {name}: {before[name]} -> {after.get(name)}" for name in named]


def _shown(answer: Answer) -> str:
    return f"digest {answer.digest}" if answer.text is None else repr(answer.text[:200])


def _of_json(old: str, new: str) -> list[str] | None:
    """None where one is no JSON."""
    try:
        before, after = json.loads(old), json.loads(new)
    except ValueError:
        return None
    found: list[str] = []
    _compare(before, after, "", found)
    if not found and len(split(old)[0]) != len(split(new)[0]):
        found.append(f"written otherwise: {old[:200]} -> {new[:200]}")
    return found


def _compare(old: Any, new: Any, place: str, found: list[str]) -> None:
    if type(old) is not type(new):
        found.append(f"{place}: {_short(old)} -> {_short(new)}")
    elif isinstance(old, dict):
        gone, come = [k for k in old if k not in new], [k for k in new if k not in old]
        found += [f"{place}/{key}: gone ({_short(old[key])})" for key in gone]
        found += [f"{place}/{key}: new ({_short(new[key])})" for key in come]
        if not gone and not come and list(old) != list(new):
            found.append(f"{place}: keys in another order: {list(old)} -> {list(new)}")
        for key in old:
            if key in new:
                _compare(old[key], new[key], f"{place}/{key}", found)
    elif isinstance(old, list):
        if len(old) != len(new):
            found.append(f"{place}: {len(old)} items -> {len(new)}")
        for index, (one, other) in enumerate(zip(old, new, strict=False)):
            _compare(one, other, f"{place}/{index}", found)
    elif isinstance(old, float):
        if not _near(old, new):
            found.append(f"{place}: {old!r} -> {new!r}")
    elif old != new:
        found.append(f"{place}: {_short(old)} -> {_short(new)}")


def _of_texts(old: str, new: str) -> list[str]:
    (shape, numbers), (other_shape, other_numbers) = split(old), split(new)
    if shape == other_shape and len(numbers) == len(other_numbers):
        pairs = zip(numbers, other_numbers, strict=True)
        wrong = [f"number: {a} -> {b}" for a, b in pairs if not _near_texts(a, b)]
        if not wrong:
            return []
    lines = difflib.unified_diff(old.splitlines(), new.splitlines(), lineterm="", n=0)
    return [line[:300] for line in lines if not line.startswith(("---", "+++", "@@"))]


def _near(a: float, b: float) -> bool:
    return a == b or abs(a - b) <= TOLERANCE * (1 + max(abs(a), abs(b)))


def _near_texts(a: str, b: str) -> bool:
    if a == b:
        return True
    if _INTEGER.fullmatch(a) and _INTEGER.fullmatch(b):
        return False
    unit = max(_unit(a), _unit(b)) if "e" not in f"{a}{b}".lower() else 0.0
    return _near(float(a), float(b)) or abs(float(a) - float(b)) <= 1.01 * unit


def _unit(text: str) -> float:
    """One in the last decimal."""
    return 10.0 ** -len(text.partition(".")[2]) if "." in text else 0.0


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 300 else f"{text[:300]}…"
