"""Remove from site-packages what the service never reads, in the project's environments only.

``python install/prune.py`` by the environment's own Python: C++ headers and what only builds with
them, copies of libraries that wheels hold in the place of symbolic links, tests of packages, and
the robots of example-robot-data that the library does not name, with meshes that nobody draws.
The lists of installed files stay: pip and uv skip what is missing when they remove a package.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import sys
import sysconfig
from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree as ET

ROOT = Path(__file__).resolve().parents[1]
OWN = (ROOT / ".venv", Path("/opt/denavit"))
"""The environments that this may prune: the checkout's, and the image's."""
TESTS = ("llvmlite", "numba", "numpy", "scipy", "sympy", "mpmath")
"""Packages whose folders ``tests`` and ``benchmarks`` nothing imports."""
PACKAGE = re.compile("package:/+example-robot-data/robots/(.+)")


def site_packages(prefix: Path, purelib: Path) -> Path:
    """Return where the packages of an environment lie.

    Args:
        prefix: The environment, ``sys.prefix``.
        purelib: Its site-packages.

    Raises:
        SystemExit: It is not one of the project's own.
    """
    if prefix.resolve() not in {own.resolve() for own in OWN}:
        sys.exit(f"{prefix} is not this project's environment: nothing is removed from it")
    if not purelib.resolve().is_relative_to(prefix.resolve()):
        sys.exit(f"{purelib} is outside {prefix}: nothing is removed from it")
    return purelib


def prune(site: Path, library: Path) -> None:
    """Remove what the service never reads.

    Args:
        site: The site-packages.
        library: Folder of the library's documents, which name URDFs.
    """
    # The wheels of Pinocchio and of its C++ libraries share one Unix-like tree.
    prefix = site / "cmeel.prefix"
    robots = prefix / "share" / "example-robot-data" / "robots"
    keep_files(prefix / "share", robot_files(robots, named_urdfs(library)))
    for name in ("bin", "include"):
        shutil.rmtree(prefix / name, ignore_errors=True)
    for folder in (prefix / "lib", prefix / "lib64"):
        for path in list(folder.glob("*")):
            if path.is_dir() and not path.name.startswith("python"):
                shutil.rmtree(path)  # for CMake and pkg-config
            elif path.suffix == ".a":
                path.unlink()
        link_copies(folder.glob("*.so*"))
        link_copies(folder.glob("*.dylib"))
    link_copies(site.glob("*.libs/*.so*"))
    for package in TESTS:
        for name in ("tests", "benchmarks"):
            for folder in list((site / package).rglob(name)):
                shutil.rmtree(folder, ignore_errors=True)


def named_urdfs(library: Path) -> list[str]:
    """Return the URDFs that the library's documents name, relative to the robots' folder."""
    texts = (path.read_text(encoding="utf-8") for path in sorted(library.glob("*.yaml")))
    return [name for text in texts for name in re.findall(r"(?m)^urdf: *(\S+) *$", text)]


def robot_files(robots: Path, urdfs: Iterable[str]) -> set[Path]:
    """Return the files that the service reads of some robots: URDF, visual meshes, licence.

    Raises:
        SystemExit: A URDF is not installed.
    """
    kept = set()
    for name in urdfs:
        urdf = robots / name
        if not urdf.is_file():
            sys.exit(f"the library names a file that is not installed: {urdf}")
        kept.add(urdf)
        kept.update((robots / Path(name).parts[0]).glob("LICENSE*"))
        for mesh in ET.parse(urdf).iterfind("./link/visual/geometry/mesh"):
            if name := PACKAGE.match(mesh.get("filename", "")):
                kept.add(robots / name[1])
    return kept


def keep_files(folder: Path, kept: set[Path]) -> None:
    """Remove all files below a folder except some, and the folders that this empties."""
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_dir() and not path.is_symlink():
            if not any(path.iterdir()):
                path.rmdir()
        elif path not in kept:
            path.unlink()


def link_copies(files: Iterable[Path]) -> None:
    """Keep one of several files with the same content, and links to it in place of the others."""
    first: dict[tuple[int, bytes], Path] = {}
    for path in sorted(files, key=lambda path: (-len(path.name), path)):
        if path.is_symlink():
            continue
        content = path.stat().st_size, hashlib.sha256(path.read_bytes()).digest()
        kept = first.setdefault(content, path)
        if kept != path:
            path.unlink()
            path.symlink_to(os.path.relpath(kept, path.parent))


def main() -> None:
    """Prune the environment whose Python runs this."""
    site = site_packages(Path(sys.prefix), Path(sysconfig.get_path("purelib")))
    prune(site, ROOT / "robots" / "library")


if __name__ == "__main__":
    main()
