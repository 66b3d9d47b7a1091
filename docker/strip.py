"""Removes from the environment whose Python runs it what the service does not need to run.

``python docker/strip.py robots/library``, once the dependencies are installed. Nothing is removed
by guess: what goes is for building and testing, or belongs to a robot that the library does not
name, or is a shared library that no extension module links to, directly or through others.
"""

from __future__ import annotations

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

# Sources, headers, static libraries and type stubs: for compilers and checkers.
BUILD_SUFFIXES = {".a", ".c", ".cpp", ".h", ".hpp", ".pxd", ".pxi", ".pyi", ".pyx", ".tp"}
# Folders of tests and headers, by pattern, in packages that are known to run without them.
UNUSED = (
    "numpy/**/tests",
    "numpy/_core/include",
    "numpy/_pyinstaller",
    "numpy/f2py",
    "scipy/**/tests",
    "scipy/_build_utils",
    "lxml/includes",
)


def main() -> None:
    """Strips, and says what is left."""
    before = size(SITE)
    keep_robot_data(Path(sys.argv[1]))
    keep_linked_libraries()
    remove_unused()
    strip_binaries()
    print(f"{SITE}: {before / 1e6:.0f} MB before, {size(SITE) / 1e6:.0f} MB after")


def keep_robot_data(library: Path) -> None:
    """Of example-robot-data keeps the URDFs that the library names, and their licences."""
    reader = YAML(typ="safe", pure=True)
    heads = [reader.load(path.read_text(encoding="utf-8")) for path in library.glob("*.yaml")]
    kept = {ROBOTS / head["urdf"] for head in heads if "urdf" in head}
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
    """Removes sources, tests, the lists of installed files, and the packages' commands."""
    for pattern in UNUSED:
        for path in SITE.glob(pattern):
            shutil.rmtree(path, ignore_errors=True)
    for path in SITE.rglob("*"):
        if path.suffix in BUILD_SUFFIXES or path.match("*.dist-info/RECORD"):
            path.unlink()
    for path in SCRIPTS.iterdir():
        if not path.name.startswith("python"):
            path.unlink()


def strip_binaries() -> None:
    """Removes the symbols that only linkers and debuggers read."""
    for path in SITE.rglob("*.so*"):
        if path.is_file() and not path.is_symlink():
            subprocess.run(["strip", "--strip-unneeded", path], check=True)


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
    return sum(path.lstat().st_size for path in folder.rglob("*") if path.is_file())


if __name__ == "__main__":
    main()
