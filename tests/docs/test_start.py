"""The README's first command serves, and prints a request that works."""

import os
import signal
import subprocess
import time

from tests.docs.blocks import ROOT


def test_make_run_serves_and_prints_a_command_that_works(tmp_path, free_port):
    environment = {**os.environ, "DENAVIT_PORT": str(free_port), "DENAVIT_DATA_DIR": str(tmp_path)}
    process = subprocess.Popen(
        ["make", "run"],
        cwd=ROOT,
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        command = ""
        while not command.strip().startswith("curl"):
            command = process.stderr.readline()
            assert command, "make run ended"
        deadline = time.monotonic() + 180
        while subprocess.run(["bash", "-c", command], capture_output=True, check=False).returncode:
            assert time.monotonic() < deadline
            time.sleep(0.1)
        printed = subprocess.run(
            ["bash", "-c", command], capture_output=True, text=True, check=True
        )
        assert "matrix:" in printed.stdout
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.communicate(timeout=20)


def test_the_readme_is_short():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 200
