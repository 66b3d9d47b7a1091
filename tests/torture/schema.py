"""The OpenAPI document against the service by schemathesis: ``python -m tests.torture.schema``."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.conftest import SCRIPTS, running_server

CONFIG = Path(__file__).with_name("schemathesis.toml")


def run(address: str, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Every check, with the same cases each time.

    However long it takes to invent them, and in one thread: Python 3.11 cannot parse source in two
    (``SystemError: AST constructor recursion depth mismatch``), which is how cases are invented.
    """
    command = [str(SCRIPTS / "st"), "--config-file", str(CONFIG), "run", f"{address}/openapi.json"]
    options = ["--checks", "all", "--generation-deterministic", "--no-color", "--workers", "1"]
    options += ["--suppress-health-check", "too_slow"]
    return subprocess.run(
        [*command, *options, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONWARNINGS": "default"},
    )


def main() -> int:
    os.environ["DENAVIT_MAX_REQUEST_SECONDS"] = "2"
    with (
        tempfile.TemporaryDirectory() as name,
        running_server(Path(name) / "robots", "--workers", "2") as (address, _),
    ):
        done = run(address, Path(name), "--max-examples", "50")
    print(done.stdout[-6000:], done.stderr[-2000:])
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
