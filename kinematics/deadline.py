"""Deadlines and cancellation of computations.

The caller sets a deadline with :func:`under`; loops that may take long call :func:`checkpoint`
between pieces of work of well below a second.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

from kinematics.errors import OutOfTime
from robots.robot import FloatArray

T = TypeVar("T")
SVD_NUMBERS = 50_000
"""Matrix entries that are decomposed between two checkpoints."""


class Cancelled(Exception):
    """The result is no longer wanted."""


class Deadline:
    """End of a computation; any thread may cancel it.

    Args:
        seconds: Time from now on, s.
        of: Deadline of the whole of which this is a part; cancelled with it.
    """

    __slots__ = ("_dropped", "_end", "_of")

    def __init__(self, seconds: float = math.inf, of: Deadline | None = None) -> None:
        self._end = perf_counter() + seconds
        self._of = of
        self._dropped = False

    def drop(self) -> None:
        """Cancel the computation."""
        self._dropped = True

    @property
    def is_dropped(self) -> bool:
        """Whether the computation is cancelled."""
        return self._dropped or (self._of is not None and self._of.is_dropped)

    @property
    def left(self) -> float:
        """Time left, s, not below 0."""
        return max(0.0, self._end - perf_counter())

    def check_wanted(self) -> None:
        """Raise if the computation is cancelled, whatever the time.

        Raises:
            Cancelled: It is cancelled.
        """
        if self.is_dropped:
            raise Cancelled

    def check(self) -> None:
        """Raise if the computation is cancelled or its time is up.

        Raises:
            Cancelled: It is cancelled.
            OutOfTime: The time is up.
        """
        self.check_wanted()
        if perf_counter() > self._end:
            raise OutOfTime


_FOREVER = Deadline()
_CURRENT: ContextVar[Deadline] = ContextVar("kinematics.deadline", default=_FOREVER)


def current() -> Deadline:
    """Return the deadline of the computation of this thread; by default one without end."""
    return _CURRENT.get()


@contextmanager
def under(deadline: Deadline) -> Iterator[Deadline]:
    """Make a deadline the current one of this thread (or task)."""
    token = _CURRENT.set(deadline)
    try:
        yield deadline
    finally:
        _CURRENT.reset(token)


def checkpoint() -> None:
    """Raise if the current computation is cancelled or late; see :meth:`Deadline.check`."""
    _CURRENT.get().check()


def checked(items: Iterable[T], every: int = 64) -> Iterator[T]:
    """Yield the items, with a checkpoint before every ``every``-th."""
    deadline = current()
    for number, item in enumerate(items):
        if number % every == 0:
            deadline.check()
        yield item


def svd(J: FloatArray, *, compute_uv: bool = True, full_matrices: bool = True) -> Any:
    """Return ``np.linalg.svd`` of one matrix or many, with checkpoints in between."""
    matrices = max(1, SVD_NUMBERS // max(1, J.shape[-1] * max(J.shape[-2:])))
    options: dict[str, bool] = {"compute_uv": compute_uv, "full_matrices": full_matrices}
    if J.ndim != 3 or len(J) <= matrices:
        return np.linalg.svd(J, **options)  # type: ignore[call-overload]
    starts = checked(range(0, len(J), matrices), 1)
    parts = [np.linalg.svd(J[k : k + matrices], **options) for k in starts]  # type: ignore[call-overload]
    if not compute_uv:
        return np.concatenate(parts)
    return tuple(np.concatenate(one) for one in zip(*parts, strict=True))
