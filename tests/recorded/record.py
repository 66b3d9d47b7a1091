"""Records the answers of a service: ``python -m tests.recorded.record ADDRESS > FILE``.

With several addresses, of services of one build with fresh data directories each, every request is
sent to all of them, and what they do not answer alike is left out and told on standard error.
``--documents`` also writes the OpenAPI document and the list of robots beside the fixture.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

from tests.recorded import computations, routes
from tests.recorded.exchange import Session
from tests.recorded.fixture import (
    OPENAPI,
    ROBOTS,
    SETUP,
    Asked,
    Recorded,
    compressed,
    written,
)
from tests.torture.exchange import Sent


def asked() -> list[Asked]:
    """All requests, in order, each once."""
    found: dict[tuple[object, ...], Asked] = {}
    for one in (*routes.asked(), *computations.asked()):
        sent = one.sent
        key = (sent.method, sent.target, sent.headers, sent.body)
        if one.operation in (SETUP, "robots"):
            key = (len(found),)  # what is stored changes what comes back
        found.setdefault(key, one)
    return list(found.values())


def recorded(addresses: list[str], only: list[str]) -> list[Recorded]:
    """The answers to all requests, of the first service, where all agree."""
    sessions = [Session(address) for address in addresses]
    for session in sessions:
        session.clear()
    kept, seconds = [], Counter[str]()
    for one in asked():
        if only and one.operation not in (*only, SETUP):
            continue
        started = time.perf_counter()
        try:
            first, *others = [session.ask(one)[0] for session in sessions]
        except OSError as error:
            print(f"left out: {one.operation}: {one.kind}: {one.sent.shown()}: {error!r}",
                  file=sys.stderr, flush=True)  # fmt: skip
            continue
        spent = time.perf_counter() - started
        seconds[one.operation] += spent  # type: ignore[assignment]
        if spent > len(addresses):
            print(f"slow: {spent:.1f} s: {one.operation}: {one.sent.what}", file=sys.stderr,
                  flush=True)  # fmt: skip
        if any(other != first for other in others) or first.status in (500, 503):
            print(f"left out: {one.operation}: {one.kind}: {one.sent.what}: {first.status}",
                  file=sys.stderr)  # fmt: skip
            continue
        kept.append(Recorded(one, first))
    for name, spent in seconds.most_common():
        print(f"{spent:7.1f} s {name}", file=sys.stderr)
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
                path.write_bytes(compressed(session.client.send(Sent("GET", target, query)).body))
    kept = recorded(chosen.address, chosen.only)
    print(f"{len(kept)} requests", file=sys.stderr)
    sys.stdout.buffer.write(written(kept))


if __name__ == "__main__":
    main()
