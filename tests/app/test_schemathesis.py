"""The OpenAPI document and the service agree: schemathesis, every check, on a real server."""

import os
import subprocess
from pathlib import Path

import pytest

from tests.conftest import SCRIPTS, running_server

CONFIG = Path(__file__).with_name("schemathesis.toml")
# Every combination that a schema gives rise to, but of one operation of each kind: the others are
# made of the same fields.
COVERED = "^/(health/.*|v1/robots.*|v1/.*-to-.*|v1/convert-dh|v1/diff|v1/(fk|ik|singularity))$"
REST = "/(wrench|twist|hessian|jacobian.*|manip.*|joint-.*|step|symbolic|path.*|nearest|solutions)$"


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    os.environ["DENAVIT_MAX_REQUEST_SECONDS"] = "2"
    try:
        with running_server(tmp_path_factory.mktemp("robots")) as (address, _):
            yield address
    finally:
        del os.environ["DENAVIT_MAX_REQUEST_SECONDS"]


def checked(address, tmp_path, *arguments):
    command = [str(SCRIPTS / "st"), "--config-file", str(CONFIG), "run", f"{address}/openapi.json"]
    options = ["--checks", "all", "--generation-deterministic", "--no-color", *arguments]
    done = subprocess.run(
        [*command, *options], cwd=tmp_path, capture_output=True, text=True, timeout=300,
        env={**os.environ, "PYTHONWARNINGS": "default"},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    return done.stdout


def test_examples_and_random_requests_of_every_operation(address, tmp_path):
    shown = checked(
        address, tmp_path, "--phases", "examples,fuzzing", "--max-examples", "5", "--workers", "2"
    )
    assert "69 selected / 69 total" in shown


def test_every_combination_that_the_schema_gives_rise_to(address, tmp_path):
    chosen = ("--include-path-regex", COVERED, "--exclude-path-regex", REST)
    checked(address, tmp_path, "--phases", "coverage", "--workers", "2", *chosen)
