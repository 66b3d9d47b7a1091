"""What a case of the corpus is: a request, the statuses that are right for it, and words."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from tests.torture.exchange import Sent

JSON, XML = "application/json", "application/xml"
YAML, CSV, PAR, PASTED = "application/yaml", "text/csv", "text/x-symoro", "text/plain"
NPY = "application/x-npy"
MINE = "corpus"
"""Id of the robots that cases try to store."""


@dataclass(frozen=True)
class Case:
    """A request and what must come of it.

    Attributes:
        name: What is tried.
        sent: The request.
        status: The statuses that are right.
        words: What a refusal must say; of an answer, what its body must hold.
        secret: What must not be in the answer.
    """

    name: str
    sent: Sent
    status: tuple[int, ...]
    words: tuple[str, ...] = ()
    secret: tuple[str, ...] = ()

    @property
    def accepted(self) -> bool:
        return self.status[0] < 300


def body(
    name: str,
    path: str,
    content: bytes | str | dict[str, Any] | list[Any],
    status: int | tuple[int, ...],
    *words: str,
    kind: str = JSON,
    method: str = "POST",
    secret: tuple[str, ...] = (),
    headers: tuple[tuple[str, str], ...] = (),
) -> Case:
    """A case that sends a body."""
    if isinstance(content, (dict, list)):
        content = json.dumps(content)
    data = content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass")
    given = (("Content-Type", kind), *headers) if kind else headers
    path, _, query = path.partition("?")
    statuses = status if isinstance(status, tuple) else (status,)
    return Case(name, Sent(method, path, query, given, data, what=name), statuses, words, secret)


def line(
    name: str,
    target: str,
    status: int | tuple[int, ...],
    *words: str,
    method: str = "GET",
    headers: tuple[tuple[str, str], ...] = (),
) -> Case:
    """A case that has no body."""
    path, _, query = target.partition("?")
    statuses = status if isinstance(status, tuple) else (status,)
    return Case(name, Sent(method, path, query, headers, what=name), statuses, words)
