"""Compile numeric functions with Numba; no other module imports it.

Compiled functions run without the GIL, and their machine code is kept in a cache on disk.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from kinematics.kernel_cache import enable_cache

F = TypeVar("F", bound=Callable[..., Any])


# Reassociation and "no NaN" stay off: results must not depend on the compiler's mood.
_OPTIONS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"nsz", "contract"},
}


def writable(array: NDArray[Any]) -> NDArray[np.float64]:
    """The same numbers as compiled functions want them: float, in one piece, writable.

    A read-only array is another type to the compiler, and a new type is compiled for anew.
    """
    return np.require(array, np.float64, ("C", "W"))


def jit(function: F) -> F:
    """Compiles a function of scalars and float arrays on its first call."""
    return _compiled(function, {})


def inner(function: F) -> F:
    """As :func:`jit`, for functions that only compiled ones call: quicker to compile."""
    return _compiled(function, {"no_cpython_wrapper": True, "no_cfunc_wrapper": True})


def _compiled(function: F, options: dict[str, Any]) -> F:
    compiled: Any = njit(**_OPTIONS, **options)(function)
    enable_cache(compiled, function)
    return compiled  # type: ignore[no-any-return]
