"""Calls that end when their time is up; for the main thread of a process of its own."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from kinematics.symbolic.polynomial import TooManyTerms

T = TypeVar("T")
GRACE_SECONDS = 15
"""What a worker has beside its time budget: to start, and for what comes before and after."""
HEADER = 8
"""Bytes of a task's length, big-endian."""


class Unfinished(Exception):
    """A call that did not end; its text says why."""


class _Alarm(BaseException):
    """No Exception, so that no library takes it for one of its own."""


def limited(seconds: float, call: Callable[[], T]) -> T:
    """Calls, for so many seconds at most.

    Raises:
        Unfinished: The time was up, the memory full, or a polynomial grew beyond its limit.
    """
    if seconds <= 0:
        raise Unfinished("out of time")
    try:
        with _alarm(seconds):
            return call()
    except _Alarm:
        raise Unfinished("out of time") from None
    except TooManyTerms as error:
        raise Unfinished(str(error)) from None
    except (MemoryError, RecursionError):
        raise Unfinished("out of memory") from None


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    def ring(signal_number: int, frame: object) -> None:  # noqa: ARG001
        raise _Alarm

    signal.signal(signal.SIGALRM, ring)
    # Again and again: an alarm that falls into a destructor or a callback is lost.
    signal.setitimer(signal.ITIMER_REAL, seconds, 0.1)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
