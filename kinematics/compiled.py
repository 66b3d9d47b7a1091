"""Compile numeric functions with Numba; no other module imports it.

Compiled functions run without the GIL, and their machine code is kept in a cache on disk.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

F = TypeVar("F", bound=Callable[..., Any])


def _choose_cache() -> None:
    """Says where Numba keeps machine code, before it is imported.

    By default beside this file, in a folder named after the sources: Numba itself only notices
    changes in a function's own file, not in those that it calls. A read-only cache (of an image)
    is copied to where Numba, which insists on it, may write.
    """
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen is None:
        digest = hashlib.sha256()
        for source in sorted(Path(__file__).parent.rglob("*.py")):
            digest.update(source.read_bytes())
        folder = Path(__file__).parent / "__pycache__" / f"kernels-{digest.hexdigest()[:16]}"
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            os.environ["NUMBA_CACHE_DIR"] = str(folder)
    elif Path(chosen).is_dir() and not os.access(chosen, os.W_OK):
        private = Path(tempfile.mkdtemp(prefix="denavit-kernels-"))
        shutil.copytree(chosen, private, dirs_exist_ok=True)
        os.environ["NUMBA_CACHE_DIR"] = str(private)
        atexit.register(shutil.rmtree, private, ignore_errors=True)


_choose_cache()
from numba import njit  # noqa: E402 - it reads NUMBA_CACHE_DIR when it is imported

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
    try:
        compiled: Any = njit(cache=True, **_OPTIONS, **options)(function)
    except RuntimeError:  # no place for a cache: compiled anew in every process
        compiled = njit(**_OPTIONS, **options)(function)
    return compiled  # type: ignore[no-any-return]
