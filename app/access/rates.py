"""How often one key or address may ask: counted in bounded memory.

The workers of a service count together (:mod:`app.access.shared_counters`); a process that serves
alone counts in its own memory.
"""

from __future__ import annotations

import ipaddress
import math
import time
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

from limits import parse_many

CLIENTS = 100_000
"""Counters that are kept; the ones not used for longest give way: some 30 MB."""
NETWORK_OF_ONE = 64
"""Bits of an IPv6 address that one customer of a provider gets at least."""


class InvalidRate(ValueError):
    """A rate limit that cannot be read."""


@dataclass(frozen=True)
class Standing:
    """Where a client stands, in the window that is the nearest to its end.

    Attributes:
        allowed: Whether this request may pass.
        limit: Requests of a window.
        remaining: What is left of them.
        reset: Seconds until the window ends, rounded up.
    """

    allowed: bool
    limit: int
    remaining: int
    reset: int

    @property
    def headers(self) -> list[tuple[bytes, bytes]]:
        """``RateLimit-*`` headers, and ``Retry-After`` where it is refused."""
        found = [
            (b"ratelimit-limit", b"%d" % self.limit),
            (b"ratelimit-remaining", b"%d" % self.remaining),
            (b"ratelimit-reset", b"%d" % self.reset),
        ]
        return found if self.allowed else [*found, (b"retry-after", b"%d" % self.reset)]


class Counters(Protocol):
    """Where requests are counted."""

    def count(self, client: str, windows: Sequence[float]) -> list[tuple[int, float]]:
        """Count a request of a client, in windows that begin with their first one.

        Args:
            client: Whose.
            windows: Their lengths, s.

        Returns:
            Of each window its requests, and its end in s since the epoch.
        """


class RateLimits:
    """Counts requests, in windows that begin with their first one.

    Args:
        text: Such as ``10/second;600/minute``.
        counters: Where it counts; default a memory of its own.

    Raises:
        InvalidRate: It is not.
    """

    def __init__(self, text: str, counters: Counters | None = None) -> None:
        try:
            items = parse_many(text)
        except ValueError:
            raise InvalidRate(
                "DENAVIT_RATE_LIMIT cannot be read; give such as 600/minute or 10/second;600/minute"
            ) from None
        if any(item.amount < 1 for item in items):
            raise InvalidRate("DENAVIT_RATE_LIMIT allows nothing; give at least 1 request")
        self._amounts = [item.amount for item in items]
        self._windows = [item.get_expiry() for item in items]
        self._counters = BoundedMemory(CLIENTS) if counters is None else counters

    def count(self, client: str) -> Standing:
        """Count a request of a client, in each window."""
        now = time.time()
        standing = None
        counted = self._counters.count(client, self._windows)
        for amount, (count, end) in zip(self._amounts, counted, strict=True):
            allowed, remaining = count <= amount, max(0, amount - count)
            if standing is None or (allowed, remaining) < (standing.allowed, standing.remaining):
                reset = max(1, math.ceil(end - now))
                standing = Standing(allowed, amount, remaining, reset)
        assert standing is not None
        return standing


class BoundedMemory:
    """Counters in memory, as many as there is room for; one event loop uses them."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._counters: OrderedDict[str, list[tuple[int, float]]] = OrderedDict()

    def __len__(self) -> int:
        return len(self._counters)

    def count(self, client: str, windows: Sequence[float]) -> list[tuple[int, float]]:
        """Count a request; see :meth:`Counters.count`."""
        now = time.time()
        before = self._counters.get(client) or [(0, 0.0)] * len(windows)
        counted = [
            (count + 1, end) if end > now else (1, now + seconds)
            for (count, end), seconds in zip(before, windows, strict=True)
        ]
        self._counters[client] = counted
        self._counters.move_to_end(client)
        if len(self._counters) > self._most:
            self._counters.popitem(last=False)
        return counted


@lru_cache(maxsize=4096)
def network_of(host: str) -> str:
    """The client that an address stands for: itself, or of IPv6 its /64 network."""
    try:
        address: Any = ipaddress.ip_address(host.partition("%")[0])
    except ValueError:
        return "unknown"
    if address.version == 6:
        if address.ipv4_mapped is not None:
            return str(address.ipv4_mapped)
        return str(ipaddress.ip_network((address, NETWORK_OF_ONE), strict=False).network_address)
    return str(address)
