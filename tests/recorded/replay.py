"""Sends the recorded requests again and shows where answers differ.

``python -m tests.recorded.replay ADDRESS`` asks a service that runs; without an address one of its
own is started, with a fresh data directory.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.conftest import running_server
from tests.recorded.compare import differences
from tests.recorded.exchange import Session
from tests.recorded.fixture import SETUP, Recorded, records
from tests.recorded.intended import adapted, is_accepted_now, is_refused_now
from tests.torture.exchange import Sent


@dataclass
class Report:
    """What a replay found.

    Attributes:
        count: Requests sent.
        differing: Each record whose answer differs, and how.
        seconds: How long it took.
        slow: Seconds by operation.
    """

    count: int = 0
    differing: list[tuple[Recorded, list[str]]] = field(default_factory=list)
    seconds: float = 0.0
    slow: Counter[str] = field(default_factory=Counter)

    def text(self, show: int = 20) -> str:
        """Counts by operation and kind, and the first differences."""
        lines = [
            f"{self.count} requests in {self.seconds:.1f} s, {len(self.differing)} answers differ"
        ]
        groups = Counter((one.asked.operation, one.asked.kind) for one, _ in self.differing)
        lines += [f"  {count:5} {name}: {kind}" for (name, kind), count in sorted(groups.items())]
        for one, found in self.differing[:show]:
            asked = one.asked
            lines.append(f"\n{asked.operation}: {asked.kind}: {asked.sent.what}")
            lines.append(f"  {asked.sent.shown()[:500]}")
            lines += [f"  {line}" for line in found]
        if len(self.differing) > show:
            lines.append(f"\n… and {len(self.differing) - show} more")
        return "\n".join(lines)


def chosen_records(only: Sequence[str] = (), kind: str = "", every: int = 1) -> list[Recorded]:
    """The records of the fixture that are asked for, besides what they rest on.

    Args:
        only: Names of operations; none: all.
        kind: Part of the kind, such as ``refused``.
        every: Of the refusals of an operation, only one of so many; they change nothing.
    """
    counts: Counter[str] = Counter()
    found = []
    for one in records():
        operation, name = one.asked.operation, one.asked.kind
        if operation != SETUP and ((only and operation not in only) or kind not in name):
            continue
        if one.answer.status >= 400:
            counts[operation] += 1
            if counts[operation] % every:
                continue
        found.append(one)
    return found


def replay(address: str, chosen: Iterable[Recorded]) -> Report:
    """Sends records in order and compares.

    Args:
        address: Of the service.
        chosen: The records.
    """
    report, started = Report(), time.perf_counter()
    with Session(address) as session:
        session.clear()
        for one in chosen:
            asked = one.asked
            before = time.perf_counter()
            new, text = session.ask(asked)
            report.slow[asked.operation] += time.perf_counter() - before  # type: ignore[assignment]
            report.count += 1
            if new == one.answer or is_refused_now(asked, new.status):
                continue
            was_refused = one.answer.status in (406, 422)
            if was_refused and new.status < 300 and is_accepted_now(asked):
                if new.status == 201:
                    session.connection.send(Sent("DELETE", new.headers["location"]))
                continue
            found = differences(one.answer, new)
            if found:
                found = differences(one.answer, adapted(asked, one.answer, new, text))
            if found:
                report.differing.append((one, found))
    report.seconds = time.perf_counter() - started
    return report


def main() -> int:
    """Replays, prints, and says by its status whether all answers are the same."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("address", nargs="?", help="such as http://127.0.0.1:8000")
    parser.add_argument("--only", action="append", default=[], help="an operation, such as fk")
    parser.add_argument("--kind", default="", help="a part of the kind, such as refused or form")
    parser.add_argument("--every", type=int, default=1, help="of refusals only one of so many")
    parser.add_argument("--show", type=int, default=20, help="differences that are shown")
    parser.add_argument("--times", action="store_true", help="seconds by operation")
    chosen = parser.parse_args()
    wanted = chosen_records(chosen.only, chosen.kind, chosen.every)
    if chosen.address:
        report = replay(chosen.address, wanted)
    else:
        with (
            tempfile.TemporaryDirectory() as folder,
            running_server(Path(folder)) as (address, _),
        ):
            report = replay(address, wanted)
    sys.stdout.write(report.text(chosen.show) + "\n")
    if chosen.times:
        for name, spent in report.slow.most_common():
            sys.stdout.write(f"{spent:7.1f} s {name}\n")
    return 1 if report.differing or not report.count else 0


if __name__ == "__main__":
    sys.exit(main())
