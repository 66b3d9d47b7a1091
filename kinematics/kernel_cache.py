"""The cache of machine code on disk: where it lies, who may write, and whether it is full."""

from __future__ import annotations

import atexit
import fcntl
import hashlib
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding as llvm
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator

PACKAGE = Path(__file__).parent
CONFIG: Any = numba.config


_IMPORTS = re.compile(r"^from (kinematics[.\w]*) import (\([^)]*\)|.*)", re.MULTILINE)
_COMPILES = "from kinematics.compiled import"
LAYOUT = "by-package"
"""How files are named in the cache: another layout is not full."""


def source_digest() -> str:
    """Return a digest of the sources that machine code is made of, 16 hexadecimal digits.

    Numba itself only notices changes in a function's own file, not in those that it calls. Here
    count the modules with compiled functions, and what they import of this package.
    """
    digest = hashlib.sha256()
    for source in sorted(compiled_sources()):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def compiled_sources() -> set[Path]:
    """Return the modules with compiled functions, and those whose constants they import.

    A constant or a named tuple becomes machine code, a function that is not compiled cannot.
    """
    texts = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    compiled = {path for path, text in texts.items() if _COMPILES in text}
    compiled.add(PACKAGE / "compiled.py")
    found: set[Path] = set()
    left = list(compiled)
    while left:
        path = left.pop()
        if path in found:
            continue
        found.add(path)
        for module, names in _IMPORTS.findall(texts[path]):
            folder = PACKAGE.parent.joinpath(*module.split("."))
            for source in (folder.with_suffix(".py"), folder / "__init__.py"):
                text = texts.get(source, "")
                if source in compiled or any(
                    re.search(
                        rf"^{name}(?: =|:|\(NamedTuple\))|class {name}\(NamedTuple", text, re.M
                    )
                    for name in re.findall(r"\w+", names)
                ):
                    left.append(source)
    return found


def choose_folder(digest: str) -> Path | None:
    """Choose where Numba keeps machine code, and tell Numba and child processes.

    ``NUMBA_CACHE_DIR`` if it is set; a read-only one (of an image) is copied to where Numba, which
    insists on it, may write. Else a folder named after the sources beside them, or, where they are
    read-only, in the user's cache directory.

    Returns:
        The folder; None where there is no place to write to.
    """
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given is not None and Path(given).is_dir() and not os.access(given, os.W_OK):
        folder = _private_copy(given)
    elif given is not None:
        folder = _first_writable([Path(given)])
    else:
        folder = _first_writable(_places(f"kernels-{digest}"))
    if folder is not None:
        # Numba has read the variable when it was imported, and reads it again as it compiles.
        os.environ["NUMBA_CACHE_DIR"] = CONFIG.CACHE_DIR = str(folder)
    return folder


def _private_copy(shipped: str) -> Path | None:
    private = Path(tempfile.mkdtemp(prefix="denavit-kernels-"))
    shutil.copytree(shipped, private, dirs_exist_ok=True)
    atexit.register(shutil.rmtree, private, ignore_errors=True)
    return private


def _places(name: str) -> list[Path]:
    places = [PACKAGE / "__pycache__" / name]
    with suppress(RuntimeError):  # a user without a home
        home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        places.append(Path(home) / "denavit" / name)
    return places


def _first_writable(folders: list[Path]) -> Path | None:
    for folder in folders:
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            if os.access(folder, os.W_OK):
                return folder
    return None


DIGEST = source_digest()
FOLDER = choose_folder(DIGEST)


class KernelLocator(UserProvidedCacheLocator):
    """Where the machine code of a function lies: by its place in the package, and its sources.

    Numba goes by the path of the source file and the time of its last change, so that a tree that
    was moved, copied or checked out anew would be compiled again. What the code is made of is in
    the digest of all sources.
    """

    def get_cache_path(self) -> str:
        """Return the folder, one for each folder of sources."""
        if not self._is_ours:
            return str(super().get_cache_path())  # type: ignore[no-untyped-call]
        parts = Path(self._py_file).parent.relative_to(PACKAGE.parent).parts
        return str(Path(CONFIG.CACHE_DIR, ".".join(parts)))

    def get_source_stamp(self) -> Any:
        """Return what machine code of other sources is told by."""
        return DIGEST if self._is_ours else super().get_source_stamp()  # type: ignore[no-untyped-call]

    @property
    def _is_ours(self) -> bool:
        return Path(self._py_file).is_relative_to(PACKAGE)


class _Located(CompileResultCacheImpl):
    _locator_classes = [KernelLocator]  # noqa: RUF012  as the base class has it


class SharedCache(FunctionCache):
    """Numba's cache of one function, for processes that fill it at the same time.

    Numba reads the index, chooses a file name that is free in it, and writes index and file. Two
    processes that save different signatures of one function at the same time could choose the same
    name, and a third would then run machine code for other arguments: here they take turns.
    """

    _impl_class = _Located

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled function of a signature, None where it is not in the cache."""
        with locked(_lock_file(self)):
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write the compiled function of a signature into the cache."""
        with locked(_lock_file(self)):
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]


def _lock_file(cache: FunctionCache) -> Path:
    return (FOLDER or Path(cache.cache_path)) / ".lock"


def enable_cache(dispatcher: Any, function: Callable[..., Any]) -> None:
    """Keep what a dispatcher compiles on disk, where there is a place for it."""
    with suppress(RuntimeError):  # no place for a cache: compiled anew in every process
        dispatcher._cache = SharedCache(function)  # type: ignore[no-untyped-call]


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a file that exists for this only; waits for other processes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


@contextmanager
def try_to_fill() -> Iterator[int | None]:
    """Take the lock of who fills the cache, unless another process holds it.

    Yields:
        The lock's file descriptor, for the process that fills; None where another has it, and
        where there is no cache.
    """
    if FOLDER is None:
        yield None
        return
    with (FOLDER / ".filling").open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield None
        else:
            yield file.fileno()


def mark_full() -> None:
    """Write down that the cache holds all that :mod:`kinematics.warm` compiles."""
    if FOLDER is not None:
        _mark(FOLDER).touch()


def is_full() -> bool:
    """Return whether the cache holds everything, for these sources, this Numba and this CPU."""
    return FOLDER is not None and _mark(FOLDER).exists()


def _mark(folder: Path) -> Path:
    cpu = CONFIG.CPU_NAME or llvm.get_host_cpu_name()
    features = CONFIG.CPU_FEATURES
    if features is None:
        features = llvm.get_host_cpu_features().flatten()
    known = (LAYOUT, DIGEST, numba.__version__, sys.implementation.cache_tag, cpu, features)
    return folder / f"full-{hashlib.sha256(repr(known).encode()).hexdigest()[:16]}"
