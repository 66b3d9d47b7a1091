"""Numba where it is installed: one place that knows about it.

``jit`` compiles without the GIL and keeps the machine code in a cache on disk. Without Numba it
leaves a function as it is; callers then take their NumPy path (``COMPILED`` is False).
"""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


def _make_cache_writable() -> None:
    """Copies a read-only cache (of an image) to where Numba, which insists on it, may write."""
    shipped = os.environ.get("NUMBA_CACHE_DIR")
    if shipped and Path(shipped).is_dir() and not os.access(shipped, os.W_OK):
        private = Path(tempfile.mkdtemp(prefix="denavit-kernels-"))
        shutil.copytree(shipped, private, dirs_exist_ok=True)
        os.environ["NUMBA_CACHE_DIR"] = str(private)
        atexit.register(shutil.rmtree, private, ignore_errors=True)


_make_cache_writable()
try:
    from numba import njit
except ImportError:
    COMPILED = False
else:
    COMPILED = True

# Reassociation and "no NaN" stay off: results must not depend on the compiler's mood.
_OPTIONS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"nsz", "contract"},
}


def jit(function: F) -> F:
    """Compiles a function of scalars and float arrays on its first call."""
    return _compiled(function, {})


def inner(function: F) -> F:
    """As :func:`jit`, for functions that only compiled ones call: quicker to compile."""
    return _compiled(function, {"no_cpython_wrapper": True, "no_cfunc_wrapper": True})


def _compiled(function: F, options: dict[str, Any]) -> F:
    if not COMPILED:
        return function
    try:
        compiled: Any = njit(cache=True, **_OPTIONS, **options)(function)
    except RuntimeError:  # no place for a cache: compiled anew in every process
        compiled = njit(**_OPTIONS, **options)(function)
    return compiled  # type: ignore[no-any-return]
