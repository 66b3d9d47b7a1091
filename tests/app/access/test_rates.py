"""Rate limits, on real servers."""

import re

import httpx
import pytest

from app.access.keys import Scope, new_key
from app.access.rates import BoundedMemory, InvalidRate, RateLimits, network_of
from tests.app.access.requests import FK, bearer
from tests.conftest import PATIENCE


def test_who_asks_too_often_is_told_when_to_come_back(serve):
    with (
        serve(rate_limit="5/minute") as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        answers = [client.get(FK) for _ in range(8)]
        assert [answer.status_code for answer in answers] == [200] * 5 + [429] * 3
        left = [int(answer.headers["ratelimit-remaining"]) for answer in answers]
        assert left == [4, 3, 2, 1, 0, 0, 0, 0]
        last = answers[-1]
        assert last.headers["ratelimit-limit"] == "5"
        assert 1 <= int(last.headers["retry-after"]) <= 60
        assert last.json()["type"] == "/problems/too-many-requests"
        assert client.get("/health/live").status_code == 200
        # Nobody is trusted to say who asks.
        forged = client.get(FK, headers={"X-Forwarded-For": "203.0.113.7"})
        assert forged.status_code == 429


def test_pages_and_their_parts_are_not_counted(serve):
    """A browser asks for many of them at once, before it has a key."""
    with (
        serve(rate_limit="2/minute") as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        page = client.get("/", headers={"Accept": "text/html"})
        parts = re.findall(r"assets/[\w.-]+", page.text)
        assert parts
        pages = ("docs", "docs-assets/swagger-ui.css", "guide", "guide/api", "labs/fr")
        for path in (*parts * 3, *pages):
            answer = client.get(f"/{path}")
            assert answer.status_code == 200, path
            assert "ratelimit-limit" not in answer.headers
        assert [client.get(FK).status_code for _ in range(3)] == [200, 200, 429]


def test_behind_a_trusted_proxy_the_clients_are_counted(serve):
    settings = {"rate_limit": "2/minute", "trusted_proxies": "127.0.0.1"}
    with (
        serve(**settings) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):

        def status(forwarded: str) -> int:
            return client.get(FK, headers={"X-Forwarded-For": forwarded}).status_code

        assert [status("203.0.113.7") for _ in range(3)] == [200, 200, 429]
        assert [status(f"2001:db8::{k}") for k in range(1, 4)] == [200, 200, 429]
        assert status("2001:db8:0:1::1") == 200
        assert status("10.9.8.7, 203.0.113.7") == 429, "what the client itself wrote counts not"


def test_keys_have_limits_of_their_own(serve):
    (one, first), (two, second) = new_key("one", Scope.READ), new_key("two", Scope.READ)
    settings = {"rate_limit": "2/minute", "api_keys": f"{first.line},{second.line}"}
    with (
        serve(**settings) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        for secret in (one, two):
            statuses = [client.get(FK, headers=bearer(secret)).status_code for _ in range(3)]
            assert statuses == [200, 200, 429]
        guesses = [client.get(FK, headers=bearer(f"dnv_{k}")).status_code for k in range(3)]
        assert guesses == [401, 401, 429]


def test_memory_of_counters_is_bounded():
    memory = BoundedMemory(1000)
    for k in range(5000):
        assert memory.count(f"client {k}", [60])[0][0] == 1
    assert len(memory) == 1000
    assert memory.count("client 4999", [60])[0][0] == 2
    assert memory.count("client 0", [60])[0][0] == 1


def test_rates_are_read_or_refused():
    limits = RateLimits("2/hour; 3/day")
    assert [limits.count("a").allowed for _ in range(3)] == [True, True, False]
    for text in ("often", "600", "0/minute", "-1/minute"):
        with pytest.raises(InvalidRate):
            RateLimits(text)


@pytest.mark.parametrize(
    ("host", "network"),
    [
        ("203.0.113.7", "203.0.113.7"),
        ("2001:db8:1:2:3::4", "2001:db8:1:2::"),
        ("::ffff:203.0.113.7", "203.0.113.7"),
        ("fe80::1%eth0", "fe80::"),
        ("testclient", "unknown"),
    ],
)
def test_addresses_are_grouped(host, network):
    assert network_of(host) == network
