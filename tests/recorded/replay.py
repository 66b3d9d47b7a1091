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
from tests.recorded.intended import adapted


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
            lines.append(f"  {asked.sent.shown()}")
            lines += [f"  {line}" for line in found]
        if len(self.differing) > show:
            lines.append(f"\n… and {len(self.differing) - show} more")
        return "\n".join(lines)


def replay(
    address: str, chosen: Iterable[Recorded] | None = None, only: Sequence[str] = ()
) -> Report:
    """Sends the records in order and compares.

    Args:
        address: Of the service.
        chosen: The records; default all of the fixture.
        only: Operations to which it is confined, besides what they rest on; none: all.
    """
    report, started = Report(), time.perf_counter()
    with Session(address) as session:
        session.clear()
        for one in records() if chosen is None else chosen:
            asked = one.asked
            if only and asked.operation not in (*only, SETUP):
                continue
            before = time.perf_counter()
            new, text = session.ask(asked)
            report.slow[asked.operation] += time.perf_counter() - before  # type: ignore[assignment]
            report.count += 1
            if new == one.answer:
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
    parser.add_argument("--show", type=int, default=20, help="differences that are shown")
    parser.add_argument("--times", action="store_true", help="seconds by operation")
    chosen = parser.parse_args()
    if chosen.address:
        report = replay(chosen.address, only=chosen.only)
    else:
        with (
            tempfile.TemporaryDirectory() as folder,
            running_server(Path(folder)) as (address, _),
        ):
            report = replay(address, only=chosen.only)
    print(report.text(chosen.show))
    if chosen.times:
        print("\n".join(f"{name}: {spent:.1f} s" for name, spent in report.slow.most_common()))
    return 1 if report.differing or not report.count else 0


if __name__ == "__main__":
    sys.exit(main())
