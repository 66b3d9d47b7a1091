"""When a computation has to end: its time is up, or nobody waits for its result any more.

Who starts a computation says so once, by :func:`under`; loops that may take long ask in
:func:`checkpoint`, between pieces of work of well below a second.
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
"""Numbers of the matrices that are decomposed between two checkpoints."""


class Cancelled(Exception):
    """Nobody waits for the result."""


class Deadline:
    """The end of a computation; any thread may call it off.

    Args:
        seconds: From now on.
        of: The deadline of the whole, of which this is a part: called off with it.
    """

    __slots__ = ("_dropped", "_end", "_of")

    def __init__(self, seconds: float = math.inf, of: Deadline | None = None) -> None:
        self._end = perf_counter() + seconds
        self._of = of
        self._dropped = False

    def drop(self) -> None:
        """Says that nobody waits any more."""
        self._dropped = True

    @property
    def is_dropped(self) -> bool:
        """Whether nobody waits any more."""
        return self._dropped or (self._of is not None and self._of.is_dropped)

    @property
    def left(self) -> float:
        """Seconds that are left, not below 0."""
        return max(0.0, self._end - perf_counter())

    def check_wanted(self) -> None:
        """Goes on where somebody waits, whatever the time.

        Raises:
            Cancelled: Nobody does.
        """
        if self.is_dropped:
            raise Cancelled

    def check(self) -> None:
        """Goes on where somebody waits and there is time left.

        Raises:
            Cancelled: Nobody waits.
            OutOfTime: The time is up.
        """
        self.check_wanted()
        if perf_counter() > self._end:
            raise OutOfTime


_FOREVER = Deadline()
_CURRENT: ContextVar[Deadline] = ContextVar("kinematics.deadline", default=_FOREVER)


def current() -> Deadline:
    """The deadline of the computation that this thread is at; one without end by default."""
    return _CURRENT.get()


@contextmanager
def under(deadline: Deadline) -> Iterator[Deadline]:
    """Makes a deadline the current one of this thread (or task)."""
    token = _CURRENT.set(deadline)
    try:
        yield deadline
    finally:
        _CURRENT.reset(token)


def checkpoint() -> None:
    """Goes on where somebody waits and there is time left; see :meth:`Deadline.check`."""
    _CURRENT.get().check()


def checked(items: Iterable[T], every: int = 64) -> Iterator[T]:
    """The items, with a checkpoint before each ``every``-th."""
    deadline = current()
    for number, item in enumerate(items):
        if number % every == 0:
            deadline.check()
        yield item


def svd(J: FloatArray, *, compute_uv: bool = True, full_matrices: bool = True) -> Any:
    """``np.linalg.svd`` of one matrix or many, with checkpoints between some thousands of them."""
    matrices = max(1, SVD_NUMBERS // max(1, J.shape[-1] * max(J.shape[-2:])))
    options: dict[str, bool] = {"compute_uv": compute_uv, "full_matrices": full_matrices}
    if J.ndim != 3 or len(J) <= matrices:
        return np.linalg.svd(J, **options)  # type: ignore[call-overload]
    starts = checked(range(0, len(J), matrices), 1)
    parts = [np.linalg.svd(J[k : k + matrices], **options) for k in starts]  # type: ignore[call-overload]
    if not compute_uv:
        return np.concatenate(parts)
    return tuple(np.concatenate(one) for one in zip(*parts, strict=True))
