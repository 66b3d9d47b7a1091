"""Changes of answers that are meant, each with its reason: a short list, and explicit.

An entry adapts a new answer: it takes out what is meant to be there now, so that the rest can be
compared with the recorded one. It is asked only where the two differ.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import orjson

from tests.recorded.fixture import Answer, Asked
from tests.recorded.normalise import LONGEST, text_digest, top_keys
from tests.recorded.requests.bases import BODIES

_WARNINGS = re.compile(r"^warnings:(?: .*)?\n(?: {2}.*\n)*", re.MULTILINE)


@dataclass(frozen=True)
class Intended:
    """One change that is meant.

    Attributes:
        reason: Why it is.
        concerns: Whether it may be in the answer to a request.
        adapted: The new text (second) without the change, given the recorded answer (first).
    """

    reason: str
    concerns: Callable[[Asked, Answer], bool]
    adapted: Callable[[Answer, str], str]


def _keys(old: Answer) -> list[str]:
    return top_keys(old.text) if old.text is not None else (old.digest or {}).get("keys", [])


def _is_answer(asked: Asked, answer: Answer) -> bool:
    """An answer of a computation in JSON or text."""
    kind = answer.headers.get("content-type", "").partition(";")[0]
    asks = asked.operation in BODIES or asked.operation in ("corpus", "robots")
    return asks and answer.status == 200 and kind in ("application/json", "text/plain")


def _without_warnings(old: Answer, text: str) -> str:
    """A text without ``warnings``, where the recorded one has none."""
    if "warnings" in _keys(old):
        return text
    if text[:1] != "{":
        return _WARNINGS.sub("", text)
    payload: dict[str, Any] = orjson.loads(text)
    if not isinstance(payload.get("warnings"), list):
        return text
    del payload["warnings"]
    return orjson.dumps(payload).decode()


_MAPS = ("manipulability-map", "workspace")
_DEGENERATE = re.compile(r"(degenerate:)((?: (?:yes|no),?)+)$", re.MULTILINE)
_KNOWN = re.compile(r"known are [^\"\n]*")
_PLACE = re.compile(r"targets[./]\w+[./]\w+(?:[./]sequence)?")


def _kind(answer: Answer) -> str:
    return answer.headers.get("content-type", "").partition(";")[0]


def _with_no_warnings(old: Answer, text: str) -> str:
    """A text with the line that says that there are none, where the recorded one has it."""
    line = "\nwarnings: (none)\n"
    _, found, after = (old.text or "").partition(line)
    if not found or line in text:
        return text
    following = after.partition(" ")[0].partition("\n")[0]
    start, mark, rest = text.partition(f"\n{following}") if following else (text[:-1], "\n", "")
    return f"{start}{line}{mark[1:]}{rest}"


def _same_names(old: Answer, text: str) -> str:
    """A text with the recorded names, where it lists the same ones or some of as many."""
    before, now = _KNOWN.findall(old.text or ""), _KNOWN.findall(text)
    more = " and "
    for one, other in zip(before, now, strict=False):
        names, others = (
            set(re.split(r", | and ", listed.removeprefix("known are "))) for listed in (one, other)
        )
        cut = more in one and one.rpartition(more)[2] == other.rpartition(more)[2]
        if names == others or cut:
            text = text.replace(other, one)
    return text


def _same_place(old: Answer, text: str) -> bool:
    """Whether two texts differ in where they find a fault of targets, and in words of it, only."""
    if '"targets":{' not in text and "/targets/" not in text:
        return False
    if "/targets/" not in (old.text or "") and '"/targets/matrix"' not in (old.text or ""):
        return False
    fields = [set(re.findall(r"\w+", one)) for one in _PLACE.findall(old.text or "")] or [
        {"matrix"}
    ]
    return all(set(re.findall(r"\w+", one)) & set().union(*fields) for one in _PLACE.findall(text))


def _numbers(match: re.Match[str]) -> str:
    words = re.findall("yes|no", match[2])
    return match[1] + "".join(f" {float(word == 'yes'):11.6f}" for word in words)


def _is_unknown(old: Answer, text: str) -> bool:
    """Whether both refuse a name that is not known."""
    return "unknown" in (old.text or "") and "is unknown; " in text


def _without_guide(text: str) -> str:
    if text[:1] != "{":
        return re.sub(r"^guide: .*\n", "", text, flags=re.MULTILINE)
    payload: dict[str, Any] = orjson.loads(text)
    payload.pop("guide", None)
    return orjson.dumps(payload).decode() if payload else text


_DEPENDENCES = re.compile(r"^(?:followers|couplings): \(none\)\n", re.MULTILINE)
_WITH_FOLLOWERS = ("baxter", "panda_urdf", "pr2", "romeo", "talos", "talos_arm", "tiago_pro")


def _without_dependences(text: str) -> str:
    """A record of a robot whose joints are all free, without the lists that say so."""
    return _DEPENDENCES.sub("", text.replace('"followers":[],"couplings":[],', ""))


def _has_followers(asked: Asked) -> bool:
    """Whether a request is about a robot with joints that follow others, or its q has such."""
    told = f"{asked.sent.path} {asked.sent.query} {asked.sent.body!r}"
    return "<mimic" in told or any(f"{name}" in told for name in _WITH_FOLLOWERS)


INTENDED: list[Intended] = [
    Intended(
        "a record lists followers and couplings",
        lambda asked, answer: answer.status < 300,
        lambda old, text: _without_dependences(text),
    ),
    Intended(
        "a joint that mimics another is no entry of q",
        lambda asked, answer: _has_followers(asked),
        lambda old, text: text if old.text is None else old.text,
    ),
    Intended(
        "warnings is a field of every JSON answer of a computation, and a line of its text",
        _is_answer,
        _without_warnings,
    ),
    Intended(
        "a text shows warnings only where there are some",
        lambda asked, answer: _kind(answer) == "text/plain",
        lambda old, text: _with_no_warnings(old, text),
    ),
    Intended(
        "names that are known are listed in the order in which fields are declared",
        lambda asked, answer: answer.status == 422,
        lambda old, text: _same_names(old, text),
    ),
    Intended(
        "a fault in targets that are given field by field is found by field, then by number",
        lambda asked, answer: asked.operation == "ik" and answer.status == 422,
        lambda old, text: old.text if _same_place(old, text) and old.text is not None else text,
    ),
    Intended(
        "an Euler sequence with angles, where none are taken, is no sequence",
        lambda asked, answer: answer.status == 422 and "euler" in asked.sent.query,
        lambda old, text: (
            old.text
            if old.text is not None and "unknown-euler-sequence" in text and "/euler" in old.text
            else text
        ),
    ),
    Intended(
        "a text says of each pose whether its Euler angles are degenerate, in words",
        lambda asked, answer: asked.operation == "fk" and _kind(answer) == "text/plain",
        lambda old, text: _DEGENERATE.sub(_numbers, text),
    ),
    Intended(
        "path/compare takes no parameter that it would refuse as a field",
        lambda asked, answer: asked.operation == "path/compare" and answer.status == 422,
        lambda old, text: old.text if old.text is not None and _is_unknown(old, text) else text,
    ),
    Intended(
        "the index names the guide",
        lambda asked, answer: asked.sent.path == "/",
        lambda old, text: _without_guide(text),
    ),
    Intended(
        "of several faults in one request another is told first",
        lambda asked, answer: answer.status == 422 and asked.operation in ("corpus", *_MAPS),
        lambda old, text: (
            old.text
            if old.text is not None and ("give either target" in old.text or '"/q"' in old.text)
            else text
        ),
    ),
    Intended(
        "q is read before a robot is found to have no table",
        lambda asked, answer: asked.operation == "dh-matrices" and answer.status == 422,
        lambda old, text: (
            old.text
            if old.text is not None and "has no D-H table" in old.text and "/q" in text
            else text
        ),
    ),
]


def adapted(asked: Asked, old: Answer, new: Answer, text: str | None) -> Answer:
    """The new answer without the changes that are meant.

    Args:
        asked: The request.
        old: The recorded answer.
        new: The new one.
        text: Its whole text, also where only a digest is compared; None of what is no text.
    """
    if text is None:
        return new
    for entry in INTENDED:
        if entry.concerns(asked, new):
            text = entry.adapted(old, text)
    if len(text.encode()) <= LONGEST and old.digest is None:
        return replace(new, text=text, digest=None)
    return replace(new, text=None, digest=text_digest(text))


def is_refused_now(asked: Asked) -> bool:
    """Whether a request was accepted and no longer is: maps took an empty name for the tip."""
    sent = asked.sent
    empty = b'"frame": ""' in (sent.body or b"") or sent.query.endswith("frame=")
    return asked.operation in _MAPS and (empty or "&frame=&" in sent.query)
