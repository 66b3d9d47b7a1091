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
    return (
        asked.operation in BODIES
        and answer.status == 200
        and kind in ("application/json", "text/plain")
    )


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


INTENDED: list[Intended] = [
    Intended(
        "warnings is a field of every JSON answer of a computation, and a line of its text",
        _is_answer,
        _without_warnings,
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
