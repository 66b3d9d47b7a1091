"""A classroom behind one address: ``python -m tests.torture.classroom``.

Thirty students, each with a key and a namespace, all upload ``my-pa10``, each another one, and work
with it at the documented rate limit: poses, inverse kinematics, and a slider that is dragged, which
asks somewhat under ten times a second. Nothing may be refused, and everybody reads their own.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx

from app.access.keys import Scope, new_key
from robots.shipped import shipped_robot
from tests.conftest import PATIENCE, running_server

RATE_LIMIT = "20/second;600/minute"
"""As docs/operate.md shows it."""
ROBOT = "/v1/robots/my-pa10"
PACE = 0.11
"""Seconds between requests of a slider: the page sends fewer than ten a second."""
TOLERANCE = 1e-9


@dataclass
class Report:
    """What happened in the classroom."""

    statuses: Counter[int] = field(default_factory=Counter)
    times: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    seconds: float = 0.0

    def text(self) -> str:
        times = sorted(self.times)
        refused = sum(n for status, n in self.statuses.items() if status >= 400)
        return "\n".join(
            [
                f"classroom: {len(times)} requests in {self.seconds:.0f} s, {refused} refused,"
                f" {len(self.failures)} failures; median {1e3 * times[len(times) // 2]:.0f} ms,"
                f" p99 {1e3 * times[int(0.99 * len(times))]:.0f} ms",
                "statuses: " + ", ".join(f"{k}: {n}" for k, n in sorted(self.statuses.items())),
                *self.failures[:20],
            ]
        )


def keys(students: int) -> tuple[list[str], str]:
    """The keys of students, and their lines for the service."""
    made = [new_key(f"student{k}", Scope.WRITE) for k in range(students)]
    return [secret for secret, _ in made], ",".join(key.line for _, key in made)


def table_of(student: int) -> dict[str, Any]:
    """A PA10 whose tool is as long as its student's number says."""
    table = shipped_robot("pa10").table
    assert table is not None
    rows = [
        {"type": "R", "alpha": row.alpha, "d": row.a, "theta": row.theta, "r": row.d}
        for row in table.rows
    ]
    tool = {"xyz": [0, 0, 0.01 * (student + 1)]}
    return {"convention": "khalil", "joints": rows, "tool": tool}


async def lesson(address: str, secrets: list[str], drags: int) -> Report:
    """Have all students work at once."""
    report, started = Report(), time.monotonic()
    await asyncio.gather(
        *(_work(address, secret, k, drags, report) for k, secret in enumerate(secrets))
    )
    report.seconds = time.monotonic() - started
    return report


async def _work(address: str, secret: str, student: int, drags: int, report: Report) -> None:
    headers = {"X-API-Key": secret}
    async with httpx.AsyncClient(base_url=address, headers=headers, timeout=PATIENCE) as client:

        async def ask(method: str, path: str, **more: Any) -> httpx.Response:
            before = time.monotonic()
            answer = await client.request(method, path, **more)
            report.times.append(time.monotonic() - before)
            report.statuses[answer.status_code] += 1
            if not answer.is_success:
                report.failures.append(f"student {student}: {method} {path}: {answer.text[:200]}")
            # Nobody is quicker than a hand.
            await asyncio.sleep(max(0.0, PACE - (time.monotonic() - before)))
            return answer

        put = await ask("PUT", ROBOT, json=table_of(student))
        expect(report, put.status_code == 201, f"student {student} found the id taken")
        q = [0.3, 0.4, 0.2, 0.9, 0.1, 0.5, 0.0]
        zero = await ask("GET", f"{ROBOT}/fk", params={"q": ",".join(map(str, [0] * 7))})
        pose = (await ask("POST", f"{ROBOT}/fk", json={"q": q})).json()["poses"]["tool"]
        target = {"position": pose["position"], "quaternion_xyzw": pose["quaternion_xyzw"]}
        solved = (await ask("POST", f"{ROBOT}/ik", json={"target": target})).json()
        expect(report, solved.get("status") == "converged", f"student {student}: {solved}")
        for step in range(drags):
            await ask("POST", f"{ROBOT}/fk", json={"q": [0.01 * step, *q[1:]]})
        tag = (await ask("GET", ROBOT)).headers.get("etag")
        expect(report, tag == put.headers.get("etag"), f"student {student} reads another robot")
        height = zero.json()["poses"]["tool"]["position"][2]
        again = await ask("POST", f"{ROBOT}/fk", json={"q": [0] * 7})
        same = again.json()["poses"]["tool"]["position"][2]
        mine = RAISED + 0.01 * (student + 1)
        for found in (height, same):
            right = abs(found - mine) < TOLERANCE
            expect(report, right, f"student {student}: the tool is at {found}, not {mine}")
        listed = (await ask("GET", "/v1/robots", params={"page_size": 1000})).json()["robots"]
        uploads = [one["id"] for one in listed if not one["shipped"]]
        expect(report, uploads == ["my-pa10"], f"student {student} sees {uploads}")


def expect(report: Report, holds: bool, failure: str) -> None:
    if not holds:
        report.failures.append(failure)


RAISED = 0.45 + 0.48
"""Height of the last frame over that of the shoulder where q is zero, m: R3 + R5."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--students", type=int, default=30)
    parser.add_argument("--drags", type=int, default=300, help="requests of the slider of each")
    parser.add_argument("--workers", default="2")
    chosen = parser.parse_args()
    secrets, lines = keys(chosen.students)
    os.environ |= {
        "DENAVIT_API_KEYS": lines,
        "DENAVIT_NAMESPACES": "true",
        "DENAVIT_RATE_LIMIT": RATE_LIMIT,
    }
    with (
        tempfile.TemporaryDirectory() as folder,
        running_server(Path(folder), "--workers", chosen.workers) as (address, _),
    ):
        report = asyncio.run(lesson(address, secrets, chosen.drags))
    print(report.text())
    return 1 if report.failures else 0


if __name__ == "__main__":
    sys.exit(main())
