"""Records the answers of a service: ``python -m tests.recorded.record ADDRESS > FILE``.

With several addresses, of services of one build with fresh data directories each, every request is
sent to all of them, and what they do not answer alike is left out and told on standard error.
``--documents`` also writes the OpenAPI document and the list of robots beside the fixture.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter

from tests.recorded.exchange import Connection, Session
from tests.recorded.fixture import (
    OPENAPI,
    ROBOTS,
    SETUP,
    Asked,
    Recorded,
    compressed,
    written,
)
from tests.recorded.requests import arms, computations, conversions, odd, others, stored, targets
from tests.recorded.requests.bases import BODIES
from tests.recorded.requests.sent import JSON
from tests.torture.exchange import Sent

MOST_BROKEN = 5
"""Requests without an answer after which no more are sent."""


def asked(address: str) -> list[Asked]:
    """All requests, in order, each once; the service gives poses that can be reached."""
    connection = Connection(address)

    def pose(robot: str, q: list[float], frame: str | None = None) -> list[list[float]]:
        body = json.dumps({"q": q, **({"frames": [frame]} if frame else {})}).encode()
        sent = Sent("POST", f"/v1/robots/{robot}/fk", "", (JSON,), body)
        (found,) = json.loads(connection.send(sent)[2])["poses"].values()
        return found["matrix"]  # type: ignore[no-any-return]

    found: dict[tuple[object, ...], Asked] = {}
    for one in stored.setup():
        connection.send(one.sent)
    for one in (
        *stored.setup(),
        *computations.asked(),
        *arms.asked(),
        *targets.asked(pose),
        *odd.asked(),
        *conversions.asked(),
        *others.asked(),
        *stored.asked(),
    ):
        sent = one.sent
        # What is stored changes what comes back, so that it is asked for again.
        stateless = one.operation in BODIES
        key = (sent.method, sent.target, sent.headers, sent.body) if stateless else (len(found),)
        found.setdefault(key, one)
    return list(found.values())


def told(text: str) -> None:
    """Says something beside the fixture, which goes to standard output."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


def recorded(addresses: list[str], only: list[str]) -> list[Recorded]:
    """The answers to all requests, of the first service, where all agree."""
    sessions = [Session(address) for address in addresses]
    requests = asked(addresses[0])
    for session in sessions:
        session.clear()
    kept, seconds, broken = [], Counter[str](), 0
    for one in requests:
        if only and one.operation not in (*only, SETUP):
            continue
        started = time.perf_counter()
        try:
            first, *others = [session.ask(one)[0] for session in sessions]
        except OSError as error:
            told(f"left out: {one.operation}: {one.kind}: {one.sent.shown()[:500]}: {error!r}")
            broken += 1
            if broken > MOST_BROKEN:
                raise
            continue
        spent = time.perf_counter() - started
        seconds[one.operation] += spent  # type: ignore[assignment]
        if spent > len(addresses):
            told(f"slow: {spent:.1f} s: {one.operation}: {one.sent.what}")
        if any(other != first for other in others) or first.status in (500, 503):
            told(f"left out: {one.operation}: {one.kind}: {one.sent.what}: {first.status}")
            continue
        kept.append(Recorded(one, first))
    for name, spent in seconds.most_common():
        told(f"{spent:7.1f} s {name}")
    return kept


def main() -> None:
    """Records what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("address", nargs="+", help="such as http://127.0.0.1:8000")
    parser.add_argument("--only", action="append", default=[], help="an operation, such as fk")
    parser.add_argument("--documents", action="store_true")
    chosen = parser.parse_args()
    if chosen.documents:
        with Session(chosen.address[0]) as session:
            session.clear()
            for path, query, target in (
                (OPENAPI, "", "/openapi.json"),
                (ROBOTS, "page_size=1000", "/v1/robots"),
            ):
                path.write_bytes(compressed(session.connection.send(Sent("GET", target, query))[2]))
    kept = recorded(chosen.address, chosen.only)
    told(f"{len(kept)} requests")
    sys.stdout.buffer.write(written(kept))


if __name__ == "__main__":
    main()
