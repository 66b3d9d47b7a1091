"""What is wrong with the answer to a case; nothing, where all is well."""

from __future__ import annotations

import json

from tests.corpus.case import Case
from tests.torture.exchange import Received
from tests.torture.oracle import faults

LONGEST_ECHO = 100
"""Bytes of a request that a refusal may repeat in one piece."""


def wrong_with(case: Case, got: Received, folder: str) -> list[str]:
    """What is wrong.

    Args:
        case: What was asked.
        got: What came back.
        folder: The service's data directory, which no answer may name.
    """
    found = faults(case.sent, got)
    text = got.body.decode("utf-8", "replace")
    if got.status not in case.status:
        found.append(f"status {got.status}, not {case.status}")
    if folder in text:
        found.append("tells its data directory")
    found += [f"tells {word!r}" for word in case.secret if word in text]
    if got.status >= 400 and case.sent.method != "HEAD":
        told = _told(text)
        found += [f"does not say {word!r}" for word in case.words if word not in told]
        if (echo := _echo(case.sent.body or b"", text)) is not None:
            found.append(f"echoes {echo[:60]!r}…")
    else:
        found += [f"does not hold {word!r}" for word in case.words if word not in _plain(text)]
    if found:
        found.append(f"answer: {text[:400]}")
    return found


def _told(text: str) -> str:
    try:
        problem = json.loads(text)
        errors = [f"{one['pointer']} {one['message']}" for one in problem["errors"]]
        return " ".join([problem["detail"], *errors])
    except (ValueError, KeyError, TypeError):
        return text


def _plain(text: str) -> str:
    try:
        return json.dumps(json.loads(text), ensure_ascii=False).replace('\\"', '"')
    except ValueError:
        return text


def _echo(body: bytes, answer: str) -> str | None:
    """A long piece of the request that stands in the answer."""
    sent = body.decode("utf-8", "replace")
    step = LONGEST_ECHO // 2
    for start in range(0, len(answer) - LONGEST_ECHO, step):
        piece = answer[start : start + LONGEST_ECHO]
        if piece in sent:
            return piece
    return None
