"""Remove from the image's environment more than ``install/prune.py`` does from any.

``python docker/strip.py``, by the environment's Python, once the dependencies are installed and
pruned: meshes of most robots, shared libraries that no extension module links to, parts of packages
that the service does not import, symbols, and the lists of installed files.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "install"))
from prune import keep_files

SITE = Path(sysconfig.get_path("purelib"))
SCRIPTS = Path(sysconfig.get_path("scripts"))
# Pinocchio's wheels and those of its C++ libraries share one Unix-like tree.
PREFIX = SITE / "cmeel.prefix"
ROBOTS = PREFIX / "share" / "example-robot-data" / "robots"

# Visual meshes that are worth their size: 17 MiB. Other arms are drawn as skeletons.
MESHES = ("panda_description/meshes/visual/", "ur_description/meshes/ur5/visual/")
MESH_SUFFIXES = (".dae", ".obj", ".stl")

# Sources, headers, static libraries and type stubs: for compilers and checkers.
BUILD_SUFFIXES = {".a", ".c", ".cpp", ".h", ".hpp", ".pxd", ".pxi", ".pyi", ".pyx"}
# What neither the service nor what it imports from these packages imports. The image's build
# fails, in warm_up.py, where the service comes to name one of these modules: take it out here.
UNUSED = {
    "numpy": "**/tests _core/include _core/_simd.* _core/*_tests.* _pyinstaller distutils f2py/src",
    "scipy": "**/tests _build_utils"
    " sparse/csgraph special/cython_special.* cluster datasets differentiate fftpack integrate"
    " interpolate io misc ndimage odr signal stats",
    "lxml": "builder.* cssselect.* doctestcompare.* html includes isoschematron objectify.* sax.*",
    "fastapi_offline": "static/redoc*",
    "numba": "**/tests",
    "llvmlite": "**/tests",
    "sympy": "**/tests **/benchmarks",
}


def main() -> None:
    """Strip, and say what is left."""
    before = size(SITE)
    keep_files(ROBOTS, {path for path in ROBOTS.rglob("*") if is_kept(path)})
    keep_linked_libraries()
    remove_unused()
    strip_binaries()
    forget_emptied()
    print(f"{SITE}: {before / 2**20:.0f} MiB before, {size(SITE) / 2**20:.0f} MiB after")


def is_kept(path: Path) -> bool:
    """Return whether a robot's file is no mesh, or one of those that are worth their size."""
    inside = path.relative_to(ROBOTS).as_posix()
    return inside.startswith(MESHES) or path.suffix.lower() not in MESH_SUFFIXES


def keep_linked_libraries() -> None:
    """Of the C++ libraries keeps what the extension modules link to, under the name they use."""
    folder = PREFIX / "lib"
    modules = PREFIX.joinpath(*Path(sysconfig.get_path("purelib")).parts[-3:])
    needed: set[Path] = set()
    waiting = list(modules.rglob("*.so"))
    while waiting:
        found = {folder / name for name in linked(waiting.pop())}
        new = {path for path in found if path.exists()} - needed
        needed |= new
        waiting += new
    for path in PREFIX.iterdir():
        if path.name not in ("lib", "share"):
            shutil.rmtree(path)
    for path in folder.iterdir():
        if path.is_dir() and path not in modules.parents:
            shutil.rmtree(path)
        elif path.is_file() and path not in needed:
            path.unlink()


def linked(binary: Path) -> list[str]:
    """Names of the shared libraries that a binary is linked to."""
    dynamic = subprocess.run(
        ["readelf", "--dynamic", "--wide", binary], check=True, capture_output=True, text=True
    ).stdout
    return re.findall(r"\(NEEDED\).*\[(.+)\]", dynamic)


def remove_unused() -> None:
    """Removes UNUSED, sources, and the packages' commands."""
    for package, patterns in UNUSED.items():
        for pattern in patterns.split():
            for path in list((SITE / package).glob(pattern)):
                if path.is_dir():
                    shutil.rmtree(path)
                else:
                    path.unlink()
    for path in list(SITE.rglob("*")):
        if path.suffix in BUILD_SUFFIXES:
            path.unlink()
        elif path.name == "__pycache__":
            shutil.rmtree(path)
    for path in SCRIPTS.iterdir():
        if not path.name.startswith("python"):
            path.unlink()


def strip_binaries() -> None:
    """Removes the symbols that only linkers and debuggers read.

    Not from libraries that strip would spoil: where a wheel's builder has moved segments to add a
    search path, strip lays them out anew and forgets the alignment.
    """
    for path in SITE.rglob("*.so*"):
        stripped = path.with_name(f"{path.name}.stripped")
        subprocess.run(["strip", "--strip-unneeded", "-o", stripped, path], check=True)
        if loadable(stripped):
            stripped.replace(path)
        else:
            stripped.unlink()
            print(f"not stripped: {path.relative_to(SITE)}")


def loadable(binary: Path) -> bool:
    """True where every segment lies in the file as it must lie in memory, modulo its alignment."""
    segments = subprocess.run(
        ["readelf", "--segments", "--wide", binary], check=True, capture_output=True, text=True
    ).stdout
    loads = [line.split() for line in segments.splitlines() if line.split()[:1] == ["LOAD"]]
    return all(
        (int(offset, 16) - int(address, 16)) % int(load[-1], 16) == 0
        for load in loads
        for offset, address in [load[1:3]]
    )


def forget_emptied() -> None:
    """Removes the lists of installed files, and all trace of packages that have no file left.

    What is listed as installed afterwards is what the image carries.
    """
    for record in list(SITE.glob("*.dist-info/RECORD")):
        names = [line.rsplit(",", 2)[0] for line in record.read_text(encoding="utf-8").splitlines()]
        own = record.parent.name + "/"
        if any((SITE / name).exists() for name in names if not name.startswith(own)):
            record.unlink()
        else:
            print(f"nothing is left of {record.parent.name}")
            shutil.rmtree(record.parent)


def size(folder: Path) -> int:
    """Bytes of all files below a folder."""
    return sum(path.lstat().st_size for path in folder.rglob("*") if not path.is_dir())


if __name__ == "__main__":
    main()
