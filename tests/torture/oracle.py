"""What every answer must be, whatever was asked."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from tests.torture.exchange import Received, Sent

MAX_PROBLEM_BYTES = 4096
MAX_ERRORS = 10
HANG = 120.0
"""Seconds: nobody waits longer, on whatever machine. An answer takes some hundredths."""
DELIBERATE = {501, 503}
"""Without an optional package, or without room: named, not failures."""
LEAKS = (
    "Traceback",
    "site-packages",
    "msgspec",
    "pinocchio",
    "orjson",
    "starlette",
    "pydantic",
    "fastapi",
    "numpy",
    "lxml",
    "ruamel",
    "uvicorn",
    "/home/",
    "/tmp/",
    f"{Path('~root').expanduser()}/",
    '.py"',
    "object at 0x",
    "Expected `",
    "codec can't",
)
NULLS = {"condition_number", "force_semi_axes"}
"""Lists in which null is an answer: infinite."""
_BARE = re.compile(r"(?<![\w./-])[-+]?(?:nan|inf|infinity)(?![\w/-])", re.IGNORECASE)
# Control characters, and those that turn the direction of what follows.
_UNSAFE = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\u200e\u200f\u202a-\u202e\u2066-\u2069\ufeff]")
_POINTER = re.compile(r"(?:/(?:[^~]|~[01])*)?\Z", re.DOTALL)


def faults(sent: Sent, got: Received) -> list[str]:
    """What is wrong with an answer; empty where nothing is."""
    found = []
    if got.seconds > HANG:
        found.append(f"took {got.seconds:.1f} s")
    if got.status >= 500 and got.status not in DELIBERATE:
        found.append(f"status {got.status}")
    if sent.method == "HEAD":
        if got.body:
            found.append("HEAD has a body")
        return found
    if got.status >= 400:
        found += _problem_faults(sent, got)
    elif 200 <= got.status < 300:
        found += _answer_faults(sent, got)
    return found


def _problem_faults(sent: Sent, got: Received) -> list[str]:
    text = got.body.decode("utf-8", "replace")
    found = [f"leaks {word!r}" for word in LEAKS if word in text and word not in _asked(sent)]
    if len(got.body) > MAX_PROBLEM_BYTES:
        found.append(f"a problem of {len(got.body)} bytes")
    kind = got.headers.get("content-type", "")
    if kind.startswith("text/plain") and "x-request-id" in got.headers:
        return found + (["unsafe characters"] if _UNSAFE.search(text.replace("\n", "")) else [])
    if kind != "application/problem+json":
        return [*found, f"is {kind!r}"]
    try:
        problem = json.loads(text)
        errors, listed = problem["errors"], problem["errors"]
        words = [problem["title"], problem["detail"], problem["type"]]
        if problem["status"] != got.status or problem["request_id"] != got.headers["x-request-id"]:
            found.append("status or request_id differ")
        if not 1 <= len(errors) <= MAX_ERRORS:
            found.append(f"{len(errors)} errors")
        for one in listed:
            words += [one["pointer"], one["message"]]
            if not _POINTER.match(one["pointer"]):
                found.append(f"pointer {one['pointer']!r}")
            if not one["message"].strip():
                found.append("an empty message")
        if any(_UNSAFE.search(word) for word in words):
            found.append("unsafe characters")
    except (ValueError, KeyError, TypeError) as error:
        found.append(f"is no problem document: {error!r}")
    return found


def _answer_faults(sent: Sent, got: Received) -> list[str]:
    kind = got.headers.get("content-type", "").partition(";")[0]
    found = []
    try:
        if kind == "application/json":
            answer = json.loads(got.body, parse_constant=_refuse)
            found += [f"null in {key}" for key in _nulls(answer) if key not in NULLS]
        elif kind == "application/x-ndjson":
            for line in got.body.splitlines():
                json.loads(line, parse_constant=_refuse)
        elif kind == "application/x-npy":
            array = np.load(io.BytesIO(got.body), allow_pickle=False)
            if not np.isfinite(array).all():
                found.append("npy holds what is not finite")
        elif kind in ("text/plain", "text/csv") and _BARE.search(got.body.decode()):
            found.append(f"text holds {_BARE.search(got.body.decode())}")
    except (ValueError, UnicodeDecodeError) as error:
        found.append(f"{kind} cannot be read: {error}")
    if got.status not in (204, 304) and not kind:
        found.append("has no content type")
    return found


def _nulls(value: Any, key: str = "") -> set[str]:
    """Fields that hold null in a list of numbers, as a number that is none is written."""
    if isinstance(value, dict):
        return set().union(*(_nulls(one, name) for name, one in value.items()))
    if isinstance(value, list):
        here = {key} if None in value else set()
        return here.union(*(_nulls(one, key) for one in value if isinstance(one, (dict, list))))
    return set()


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"JSON holds {constant}")


def _asked(sent: Sent) -> str:
    """What the request itself says may stand in the answer."""
    body: Any = sent.body or b""
    return f"{sent.target} {body.decode('utf-8', 'replace')}"
