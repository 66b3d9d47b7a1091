"""Removes from the environment whose Python runs it what the service does not need to run.

``python docker/strip.py robots/library``, once the dependencies are installed: what only builds or
tests, the data of robots that the library does not name, shared libraries that no extension module
links to, and parts of packages that the service does not import.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

from ruamel.yaml import YAML

SITE = Path(sysconfig.get_path("purelib"))
SCRIPTS = Path(sysconfig.get_path("scripts"))
# Pinocchio's wheels and those of its C++ libraries share one Unix-like tree.
PREFIX = SITE / "cmeel.prefix"
ROBOTS = PREFIX / "share" / "example-robot-data" / "robots"

# Visual meshes that are worth their size: 17 MiB. Other arms are drawn as skeletons.
MESHES = ("panda_description/meshes/visual", "ur_description/meshes/ur5/visual")

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
    """Strips, and says what is left."""
    before = size(SITE)
    keep_robot_data(Path(sys.argv[1]))
    keep_linked_libraries()
    remove_unused()
    strip_binaries()
    link_duplicates()
    print(f"{SITE}: {before / 2**20:.0f} MiB before, {size(SITE) / 2**20:.0f} MiB after")


def keep_robot_data(library: Path) -> None:
    """Of example-robot-data keeps the URDFs that the library names, some meshes, and licences."""
    reader = YAML(typ="safe", pure=True)
    heads = [reader.load(path.read_text(encoding="utf-8")) for path in library.glob("*.yaml")]
    kept = {ROBOTS / head["urdf"] for head in heads if "urdf" in head}
    for folder in MESHES:
        kept.update(path for path in (ROBOTS / folder).rglob("*") if path.is_file())
    if absent := sorted(str(path) for path in kept if not path.is_file()):
        sys.exit(f"the library names files that are not installed: {', '.join(absent)}")
    for urdf in list(kept):
        kept.update((ROBOTS / urdf.relative_to(ROBOTS).parts[0]).glob("LICENSE*"))
    remove_files(PREFIX / "share", keep=kept)


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
    """Removes UNUSED, sources, the lists of installed files, and the packages' commands."""
    for package, patterns in UNUSED.items():
        for pattern in patterns.split():
            for path in list((SITE / package).glob(pattern)):
                if path.is_dir():
                    shutil.rmtree(path)
                else:
                    path.unlink()
    for path in list(SITE.rglob("*")):
        if path.suffix in BUILD_SUFFIXES or path.match("*.dist-info/RECORD"):
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


def link_duplicates() -> None:
    """Keeps one copy of the libraries that NumPy and SciPy both bring."""
    first: dict[tuple[str, str], Path] = {}
    for path in sorted(SITE.glob("*.libs/*.so*")):
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        kept = first.setdefault((path.name, digest), path)
        if kept != path:
            path.unlink()
            path.symlink_to(Path("..") / kept.relative_to(SITE))


def remove_files(folder: Path, *, keep: set[Path]) -> None:
    """Removes all files below a folder except some, and the folders that this empties."""
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_dir() and not path.is_symlink():
            if not any(path.iterdir()):
                path.rmdir()
        elif path not in keep:
            path.unlink()


def size(folder: Path) -> int:
    """Bytes of all files below a folder."""
    return sum(path.lstat().st_size for path in folder.rglob("*") if not path.is_dir())


if __name__ == "__main__":
    main()
