"""Requests that take their time, each in a thread."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from typing import Any

import httpx

from tests.conftest import PATIENCE

WILD = {
    "convention": "standard",
    "joints": [
        {"type": "R", "alpha": 0.31 + 0.1 * k, "a": 0.23 + 0.07 * k, "d": 0.11 + 0.13 * k}
        for k in range(7)
    ],
}


class Asked(threading.Thread):
    """A request in a thread; its answer or error."""

    def __init__(self, call: Callable[[Asked], httpx.Response]) -> None:
        super().__init__(daemon=True)
        self.call = call
        self.answer: httpx.Response | None = None
        self.error: httpx.HTTPError | None = None
        self.lines: list[dict[str, Any]] = []
        self.start()

    def run(self) -> None:
        try:
            self.answer = self.call(self)
        except httpx.HTTPError as error:
            self.error = error


def symbolic(address: str, seconds: float) -> Asked:
    """A request that works for so long in a process of its own."""
    body = {"robot": WILD, "quantities": ["jacobian", "det_jacobian"]}
    body["time_budget_ms"] = int(seconds * 1e3)
    url = f"{address}/v1/symbolic"
    return Asked(lambda _: httpx.post(url, json=body, timeout=PATIENCE))


def stream(address: str) -> Asked:
    """A request that sends line after line from a thread, until the gate is open."""
    body, headers = {"q": [0.1] * 7}, {"Accept": "application/x-ndjson"}
    url = f"{address}/v1/robots/panda/endless"

    def read(asked: Asked) -> httpx.Response:
        with httpx.stream("POST", url, json=body, headers=headers, timeout=PATIENCE) as answer:
            for line in answer.iter_lines():
                asked.lines.append(json.loads(line))
        return answer

    return Asked(read)
