"""Whether others are served while the service is at a large request."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import httpx

from tests.conftest import PATIENCE

TRIES = 5
SHORT = 0.25
"""Seconds that nobody minds."""


def others_are_served(address: str, request: Callable[[], object]) -> bool:
    """Whether ``/health/live`` is answered during a request, not only after it.

    It is where no answer takes most of the time that the request takes, whatever that is on this
    machine. A machine that stands still for a moment does so once, a service every time.
    """
    return any(_longest_share(address, request) < 0.5 for _ in range(TRIES))


def _longest_share(address: str, request: Callable[[], object]) -> float:
    """The longest answer meanwhile, as a part of the request's time; 0 where it is short."""
    with ThreadPoolExecutor(1) as pool, httpx.Client(base_url=address, timeout=PATIENCE) as client:
        assert client.get("/health/live").status_code == 200
        started, longest = time.monotonic(), 0.0
        done = pool.submit(request)
        while not done.done():
            asked = time.monotonic()
            assert client.get("/health/live").status_code == 200
            longest = max(longest, time.monotonic() - asked)
            time.sleep(0.002)
        done.result()
        return longest / (time.monotonic() - started) if longest > SHORT else 0.0
