"""The cache of machine code: where it lies, who fills it, and what two processes do to it."""

import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

import numba
import pytest
from numba.core import caching, types
from numba.core.registry import cpu_target

from kinematics import kernel_cache
from kinematics.compiled import inner, jit
from kinematics.inverse.damped_least_squares import settle
from kinematics.kernel_cache import (
    SharedCache,
    choose_folder,
    compiled_sources,
    is_full,
    mark_full,
    source_digest,
    try_to_fill,
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The cache of this test only, empty."""
    monkeypatch.setattr(kernel_cache, "FOLDER", tmp_path)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return tmp_path


def double(x):
    return x + x


def test_two_that_save_at_once_do_not_mix_up_their_signatures(folder, monkeypatch):
    """Both read the index before either writes, if nothing makes them take turns."""
    function = numba.njit(double)
    function(1)
    function(1.0)
    results = list(function.overloads.values())
    both_have_read = threading.Barrier(2)
    read_index = caching.IndexDataCacheFile._load_index

    def read_and_wait(cache):
        found = read_index(cache)
        with suppress(threading.BrokenBarrierError):  # the other one waits for its turn
            both_have_read.wait(0.5)
        return found

    with monkeypatch.context() as patched:
        patched.setattr(caching.IndexDataCacheFile, "_load_index", read_and_wait)
        threads = [
            threading.Thread(target=SharedCache(double).save_overload, args=(one.signature, one))
            for one in results
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    for result in results:
        found = SharedCache(double).load_overload(result.signature, cpu_target.target_context)
        assert found is not None
        assert found.signature == result.signature
    assert {one.signature.return_type for one in results} == {types.int64, types.float64}


def test_kernels_keep_what_they_compile_in_the_shared_cache():
    """Held to a private member of Numba: compiled functions would be compiled anew for ever."""
    for decorator in (jit, inner):
        assert isinstance(decorator(double)._cache, SharedCache)
    assert hasattr(numba.njit(double), "_cache")


def test_what_one_process_compiled_the_next_one_loads(folder):
    code = (
        "from tests.kinematics.test_kernel_cache import double\n"
        "from kinematics.compiled import jit\n"
        "kernel = jit(double)\n"
        "assert kernel(2.0) == 4.0\n"
        "print(*kernel.stats.cache_hits.values(), '|', *kernel.stats.cache_misses.values())\n"
    )
    printed = [
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            check=True,
            cwd=Path(__file__).parents[2],
        ).stdout.strip()
        for _ in range(2)
    ]
    assert printed == ["| 1", "1 |"]


def test_machine_code_is_found_by_the_package_and_its_sources():
    """Not by the path and the time of a file: a tree may be moved, copied or checked out anew."""
    locator = SharedCache(settle.py_func)._impl.locator
    assert Path(locator.get_cache_path()) == Path(numba.config.CACHE_DIR, "kinematics.inverse")
    assert locator.get_source_stamp() == kernel_cache.DIGEST
    own = SharedCache(double)._impl.locator
    assert Path(own.get_cache_path()).name.startswith("kinematics_")
    assert own.get_source_stamp() != kernel_cache.DIGEST


def test_the_cache_lies_where_it_is_told_else_beside_the_sources_else_with_the_user(
    tmp_path, monkeypatch
):
    beside = tmp_path / "package"
    beside.mkdir()
    monkeypatch.setattr(kernel_cache, "PACKAGE", beside)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "told"))
    assert choose_folder("1") == tmp_path / "told"
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    assert choose_folder("1") == beside / "__pycache__" / "kernels-1"
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    (beside / "__pycache__" / "kernels-2").touch()  # no folder can be made there
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    assert choose_folder("2") == tmp_path / "user" / "denavit" / "kernels-2"
    assert str(tmp_path / "user" / "denavit" / "kernels-2") == numba.config.CACHE_DIR


def test_without_a_place_there_is_no_cache(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.touch()
    monkeypatch.setattr(kernel_cache, "PACKAGE", blocked)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    assert choose_folder("1") is None
    monkeypatch.setattr(kernel_cache, "FOLDER", None)
    mark_full()
    assert not is_full()
    with try_to_fill() as lock:
        assert lock is None


def test_a_read_only_cache_is_copied(tmp_path, monkeypatch):
    shipped = tmp_path / "shipped"
    shipped.mkdir()
    (shipped / "kernel.nbc").write_bytes(b"code")
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(shipped))
    monkeypatch.setattr(kernel_cache.os, "access", lambda path, mode: Path(path) != shipped)
    private = choose_folder("1")
    assert private not in (None, shipped)
    assert (private / "kernel.nbc").read_bytes() == b"code"


def test_a_cache_is_full_for_its_sources_its_numba_and_its_processor(folder, monkeypatch):
    assert not is_full()
    mark_full()
    assert is_full()
    with monkeypatch.context() as other:
        other.setattr(kernel_cache, "DIGEST", "other sources")
        assert not is_full()
    with monkeypatch.context() as other:
        other.setattr(numba, "__version__", "1.0")
        assert not is_full()
    with monkeypatch.context() as other:
        other.setattr(numba.config, "CPU_NAME", "generic")
        assert not is_full()
    assert is_full()


def test_one_process_fills_and_keeps_the_lock_until_it_ends(folder):
    command = [sys.executable, "-c", "input()"]
    with try_to_fill() as lock:
        assert lock is not None
        child = subprocess.Popen(command, stdin=subprocess.PIPE, pass_fds=[lock])
        with try_to_fill() as second:
            assert second is None
    with child:
        with try_to_fill() as second:
            assert second is None
        child.communicate(b"\n")
    with try_to_fill() as lock:
        assert lock is not None


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package with a compiled function, its constant, and what only calls it."""
    folder = tmp_path / "kinematics"
    folder.mkdir()
    (folder / "compiled.py").write_text("def jit(f): return f\n")
    (folder / "limits.py").write_text("TURN = 6.28\n\ndef wide(x): return x\n")
    (folder / "kernels.py").write_text(
        "from kinematics.compiled import jit\nfrom kinematics.limits import (\n    TURN,\n)\n"
    )
    (folder / "api.py").write_text("from kinematics.kernels import step\n")
    monkeypatch.setattr(kernel_cache, "PACKAGE", folder)
    return folder


@pytest.mark.parametrize(
    ("module", "counts"),
    [("compiled", True), ("kernels", True), ("limits", True), ("api", False)],
)
def test_only_what_becomes_machine_code_has_it_compiled_anew(package, module, counts):
    before = source_digest()
    (package / f"{module}.py").write_text("X = 1\n" + (package / f"{module}.py").read_text())
    assert (source_digest() != before) is counts


def test_all_modules_with_compiled_functions_count():
    counted = {path.name for path in compiled_sources()}
    assert {"compiled.py", "kernels.py", "task_error.py", "damped_step.py"} <= counted
    assert "errors.py" not in counted
