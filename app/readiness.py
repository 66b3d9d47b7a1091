"""Whether the service can do its work, check by check."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import msgspec

from dh_to_urdf.messages import say

PROBE_SECONDS = 1.0
"""A result of the disk serves as long, so that probes from anywhere do not become writes."""
_BLOCK = b"\0" * 4096


class Check(msgspec.Struct, kw_only=True, frozen=True, omit_defaults=True):
    """One thing that must be right.

    ``failed`` makes the service unready, ``warning`` does not. ``names`` are the robots at fault.
    """

    status: Literal["ok", "warning", "failed"]
    detail: str
    names: tuple[str, ...] = ()


class ReadinessReport(msgspec.Struct, kw_only=True):
    """State of the service and of all that it needs."""

    status: Literal["ready", "unready", "stopping"]
    checks: dict[str, Check]


class Readiness:
    """The checks of one application; each is a function that returns a :class:`Check`."""

    def __init__(self) -> None:
        self._checks: dict[str, Callable[[], Check]] = {}
        self._stopping = False

    def add(self, name: str, check: Callable[[], Check]) -> None:
        """Adds a check, or replaces the one of that name."""
        self._checks[name] = check

    def stop(self) -> None:
        """Says from now on that the service is stopping."""
        self._stopping = True

    def report(self) -> ReadinessReport:
        """Runs all checks; may block on a disk."""
        checks = {name: _run(check) for name, check in self._checks.items()}
        failed = not checks or any(check.status == "failed" for check in checks.values())
        if self._stopping:
            return ReadinessReport(status="stopping", checks=checks)
        return ReadinessReport(status="unready" if failed else "ready", checks=checks)


def _run(check: Callable[[], Check]) -> Check:
    try:
        return check()
    except Exception as error:
        return Check(
            status="failed", detail=say("the check failed: {name}", name=type(error).__name__)
        )


class WritableDirectory:
    """Checks that uploads can be written: writes a block, as a full disk shows in nothing else."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._known: tuple[float, Check] | None = None

    def __call__(self) -> Check:
        """The check; a result serves for a second."""
        if self._known is None or time.monotonic() - self._known[0] > PROBE_SECONDS:
            self._known = time.monotonic(), self._written()
        return self._known[1]

    def _written(self) -> Check:
        try:
            written_to(self._directory)
        except OSError as error:
            detail = say("uploads cannot be written: {strerror}", strerror=error.strerror)
            return Check(status="failed", detail=detail)
        return Check(status="ok", detail=say("uploads can be written"))


def written_to(directory: Path) -> None:
    """Writes a block into a directory and removes it.

    Raises:
        OSError: It cannot be written to.
    """
    path = directory / f".probe-{os.getpid()}"
    try:
        path.write_bytes(_BLOCK)
    finally:
        path.unlink(missing_ok=True)
