"""How often one key or address may ask: windows of the package limits, in bounded memory.

Each process counts for itself: with N workers a client gets at most N times as much.
"""

from __future__ import annotations

import ipaddress
import math
import time
from collections import OrderedDict
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from limits import RateLimitItem, parse_many
from limits.storage import Storage
from limits.strategies import FixedWindowRateLimiter

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


class RateLimits:
    """Counts requests.

    Args:
        text: Such as ``10/second;600/minute``.

    Raises:
        InvalidRate: It is not.
    """

    def __init__(self, text: str) -> None:
        try:
            self._items: list[RateLimitItem] = parse_many(text)
        except ValueError:
            raise InvalidRate(
                "DENAVIT_RATE_LIMIT cannot be read; give such as 600/minute or 10/second;600/minute"
            ) from None
        if any(item.amount < 1 for item in self._items):
            raise InvalidRate("DENAVIT_RATE_LIMIT allows nothing; give at least 1 request")
        self._windows = FixedWindowRateLimiter(BoundedMemory(CLIENTS))

    def count(self, client: str) -> Standing:
        """Counts a request of a client, in each window."""
        standing = None
        for item in self._items:
            allowed = self._windows.hit(item, client)
            end, remaining = self._windows.get_window_stats(item, client)
            reset = max(1, math.ceil(end - time.time()))
            one = Standing(allowed, item.amount, remaining, reset)
            if standing is None or (one.allowed, one.remaining) < (
                standing.allowed,
                standing.remaining,
            ):
                standing = one
        assert standing is not None
        return standing


class BoundedMemory(Storage):
    """Counters in memory, as many as there is room for.

    The memory of the package itself grows with the number of addresses, and a thread goes through
    all of them a hundred times a second. One event loop uses this, so there is nothing to lock.
    """

    STORAGE_SCHEME = ["denavit-bounded-memory"]  # noqa: RUF012  as the base class has it

    def __init__(self, most: int) -> None:
        super().__init__()
        self._most = most
        self._counters: OrderedDict[str, tuple[int, float]] = OrderedDict()

    @property
    def base_exceptions(self) -> type[Exception]:
        """What can go wrong: nothing."""
        return ValueError

    def __len__(self) -> int:
        return len(self._counters)

    def incr(self, key: str, expiry: float, amount: int = 1) -> int:
        """Counts, in a window that begins with its first request."""
        now = time.time()
        count, end = self._counters.get(key, (0, 0.0))
        if end <= now:
            count, end = 0, now + expiry
        self._counters[key] = count + amount, end
        self._counters.move_to_end(key)
        if len(self._counters) > self._most:
            self._counters.popitem(last=False)
        return count + amount

    def get(self, key: str) -> int:
        """The count of a window that has not ended."""
        count, end = self._counters.get(key, (0, 0.0))
        return count if end > time.time() else 0

    def get_expiry(self, key: str) -> float:
        """When the window ends, s since the epoch."""
        return self._counters.get(key, (0, time.time()))[1]

    def check(self) -> bool:
        """It is always there."""
        return True

    def reset(self) -> int | None:
        """Forgets all counters; gives their number."""
        count = len(self._counters)
        self._counters.clear()
        return count

    def clear(self, key: str) -> None:
        """Forgets one counter."""
        self._counters.pop(key, None)


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
