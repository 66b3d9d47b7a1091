"""Compile numeric functions with Numba; beside it only the vectors of lanes import it.

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


# No reassociation and no "no NaN": results must not depend on how the compiler arranges sums.
_OPTIONS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"nsz", "contract"},
}


def writable(array: NDArray[Any]) -> NDArray[np.float64]:
    """Return the array as compiled functions take it: float64, C-contiguous, writable.

    A read-only or strided array is another type to the compiler, and each type is compiled anew.
    """
    return np.require(array, np.float64, ("C", "W"))


def jit(function: F) -> F:
    """Compile a function on its first call; for those that Python calls."""
    return _compiled(function, {})


def inner(function: F) -> F:
    """Compile a function that only compiled ones call, which is quicker than :func:`jit`."""
    return _compiled(function, {"no_cpython_wrapper": True, "no_cfunc_wrapper": True})


def _compiled(function: F, options: dict[str, Any]) -> F:
    compiled: Any = njit(**_OPTIONS, **options)(function)
    enable_cache(compiled, function)
    return compiled  # type: ignore[no-any-return]
