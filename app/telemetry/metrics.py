"""What the service counts, for Prometheus; one process or several that share a directory."""

from __future__ import annotations

import asyncio
import os
from bisect import bisect_left
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import prometheus_client.values as values
from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.multiprocess import MultiProcessCollector, mark_process_dead
from prometheus_client.registry import Collector

from app.telemetry.processes import pid_file, usage

DIRECTORY = "PROMETHEUS_MULTIPROC_DIR"
METHODS = frozenset(("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"))
BUCKETS = (
    5e-5,
    1e-4,
    2.5e-4,
    5e-4,
    1e-3,
    2.5e-3,
    5e-3,
    0.01,
    0.025,
    0.05,
    0.1,
    0.25,
    0.5,
    1.0,
    2.5,
    5.0,
    10.0,
    30.0,
    60.0,
)
"""Upper ends in seconds: a solve takes tens of microseconds, the longest request a minute."""


PENDING_SECONDS = 0.02
"""Within which gathered requests are counted."""


def share_values(directory: Path, slot: int) -> None:
    """Makes this process count in files that all workers read; before the first metric is made.

    A worker that takes over the slot of a dead one goes on counting where that one ended.

    Args:
        directory: Where the files are.
        slot: Number of this worker.
    """
    os.environ[DIRECTORY] = str(directory)
    values.ValueClass = values.MultiProcessValue(lambda: slot)  # type: ignore[no-untyped-call]


def shared_directory() -> Path | None:
    """The directory of :func:`share_values`; None in a process that serves alone."""
    return Path(os.environ[DIRECTORY]) if DIRECTORY in os.environ else None


def forget_worker(directory: Path, slot: int) -> None:
    """Removes what only a living worker has, such as requests in progress."""
    mark_process_dead(slot, str(directory))  # type: ignore[no-untyped-call]
    pid_file(directory, slot).unlink(missing_ok=True)


@dataclass(slots=True)
class Counts:
    """Requests that are not counted yet.

    Attributes:
        buckets: How many by duration, one for each of ``BUCKETS`` and one for the longer ones.
        seconds: How long they took together.
        bytes: Of their answers' bodies.
    """

    buckets: list[int]
    seconds: float = 0.0
    bytes: int = 0


class Metrics:
    """The metrics of one application.

    Attributes:
        in_progress: Requests that have come and are not answered.
        compute_waiting: Computations that wait for a thread; for whoever admits them to set.
    """

    def __init__(self, directory: Path | None = None) -> None:
        """Creates all metrics.

        Args:
            directory: Of :func:`shared_directory`.
        """
        self._directory = directory
        self._registry = own = CollectorRegistry()
        labels = ("method", "route")
        self._requests = Counter(
            "denavit_http_requests", "Requests answered.", (*labels, "status_class"), registry=own
        )
        self._durations = Histogram(
            "denavit_http_request_duration_seconds",
            "From the request's head to the answer's end.",
            labels,
            buckets=BUCKETS,
            registry=own,
        )
        self._bytes = Counter(
            "denavit_http_response_bytes", "Bytes of the answers' bodies.", labels, registry=own
        )
        self.in_progress = Gauge(
            "denavit_http_requests_in_progress",
            "Requests not yet answered.",
            multiprocess_mode="livesum",
            registry=own,
        )
        self.compute_waiting = Gauge(
            "denavit_compute_waiting",
            "Computations that wait for a thread.",
            multiprocess_mode="livesum",
            registry=own,
        )
        self._children: dict[tuple[str, str, int], tuple[Counter, Histogram, Counter]] = {}
        self._pending: dict[tuple[str, str, int], Counts] = {}

    def count(self, method: str, route: str, status: int, seconds: float, size: int) -> None:
        """Counts a request.

        Args:
            method: Its method.
            route: The route's template, never a path.
            status: The answer's status; 0 where the client went away before there was one.
            seconds: How long it took.
            size: Bytes of the answer's body.
        """
        key = (method if method in METHODS else "other", route, status // 100)
        found = self._children.get(key) or self._made(key)
        found[0].inc()
        found[1].observe(seconds)
        found[2].inc(size)

    def count_soon(self, method: str, route: str, status: int, seconds: float, size: int) -> None:
        """Counts a request within ``PENDING_SECONDS``; for the event loop, which must be running.

        Three counters for each request, which other processes read, would take as long as a
        computation. Arguments as of :meth:`count`.
        """
        key = (method if method in METHODS else "other", route, status // 100)
        counts = self._pending.get(key)
        if counts is None:
            if not self._pending:
                asyncio.get_running_loop().call_later(PENDING_SECONDS, self.write_pending)
            counts = self._pending[key] = Counts([0] * (len(BUCKETS) + 1))
        counts.buckets[bisect_left(BUCKETS, seconds)] += 1
        counts.seconds += seconds
        counts.bytes += size

    def write_pending(self) -> None:
        """Adds what :meth:`count_soon` has gathered; for the event loop."""
        pending, self._pending = self._pending, {}
        for key, counts in pending.items():
            requests, durations, sizes = self._children.get(key) or self._made(key)
            requests.inc(sum(counts.buckets))
            sizes.inc(counts.bytes)
            # What Histogram.observe does for each value, which is all that it offers.
            durations._sum.inc(counts.seconds)
            for bucket, count in zip(durations._buckets, counts.buckets, strict=True):
                if count:
                    bucket.inc(count)

    def _made(self, key: tuple[str, str, int]) -> tuple[Counter, Histogram, Counter]:
        method, route, hundreds = key
        kind = f"{hundreds}xx" if hundreds else "aborted"
        children = self._children[key] = (
            self._requests.labels(method, route, kind),
            self._durations.labels(method, route),
            self._bytes.labels(method, route),
        )
        return children

    def exposition(self, robots: Callable[[], int]) -> bytes:
        """All metrics in Prometheus' text format; of all workers where there are several.

        Args:
            robots: Counts the stored robots.
        """
        if self._directory is None:
            counted = generate_latest(self._registry)
        else:
            shared = CollectorRegistry()
            MultiProcessCollector(shared, str(self._directory))  # type: ignore[no-untyped-call]
            counted = generate_latest(shared)
        now = CollectorRegistry()
        now.register(_Now(self._directory, robots))
        return counted + generate_latest(now)


class _Now(Collector):
    """What is looked up when it is asked for."""

    def __init__(self, directory: Path | None, robots: Callable[[], int]) -> None:
        self._directory = directory
        self._robots = robots

    def collect(self) -> Iterable[Metric]:
        """Build, robots, and each worker's memory and processor time."""
        build = GaugeMetricFamily("denavit_build_info", "The version.", labels=("version",))
        build.add_metric((version("denavit"),), 1)
        yield build
        yield GaugeMetricFamily("denavit_robots", "Uploaded robots.", value=self._robots())
        memory = GaugeMetricFamily(
            "denavit_worker_resident_memory_bytes", "Memory of a worker.", labels=("worker",)
        )
        processor = CounterMetricFamily(
            "denavit_worker_cpu_seconds", "Processor time of a worker.", labels=("worker",)
        )
        started = GaugeMetricFamily(
            "denavit_worker_start_time_seconds",
            "When a worker started, Unix time.",
            labels=("worker",),
        )
        for slot, found in usage(self._directory):
            memory.add_metric((slot,), found.resident_bytes)
            processor.add_metric((slot,), found.cpu_seconds)
            started.add_metric((slot,), found.start_time)
        yield memory
        yield processor
        yield started
