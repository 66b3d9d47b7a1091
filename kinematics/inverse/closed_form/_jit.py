"""The one place that knows the compiler."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit  # type: ignore[import-untyped]

F = TypeVar("F", bound=Callable[..., object])


def jit(function: F) -> F:
    """Compiles a function, keeps the result on disk and runs it without the interpreter lock."""
    compiler = njit(cache=True, nogil=True, error_model="numpy", fastmath={"nsz", "contract"})
    return cast(F, compiler(function))
