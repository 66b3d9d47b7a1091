"""Calls with a time limit; for the main thread of a process of its own."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from dh_to_urdf.messages import say
from kinematics.symbolic.polynomial import TooManyTerms

T = TypeVar("T")
GRACE_SECONDS = 15
"""Time of a worker beside its time budget, s: start, and work before and after."""


class Unfinished(Exception):
    """A call that did not end; the text is the reason."""


class _Alarm(BaseException):
    """Raised by the alarm; not an Exception, so that no library handles it."""


def limited(seconds: float, call: Callable[[], T]) -> T:
    """Call a function with a time limit, s.

    Raises:
        Unfinished: The time was up, memory was exhausted, or a polynomial exceeded its limit.
    """
    if seconds <= 0:
        raise Unfinished(say("out of time"))
    try:
        with _alarm(seconds):
            return call()
    except _Alarm:
        raise Unfinished(say("out of time")) from None
    except TooManyTerms as error:
        raise Unfinished(str(error)) from None
    except (MemoryError, RecursionError):
        raise Unfinished(say("out of memory")) from None


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    def ring(signal_number: int, frame: object) -> None:  # noqa: ARG001
        raise _Alarm

    signal.signal(signal.SIGALRM, ring)
    # Repeated: an alarm in a destructor or a callback is lost.
    signal.setitimer(signal.ITIMER_REAL, seconds, 0.1)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
