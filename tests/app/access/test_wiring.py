"""Settings of access that cannot be used."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import PATIENCE

SCRIPTS = Path(sys.executable).parent


@pytest.mark.parametrize(
    ("name", "value"),
    [("API_KEYS", "secret-password"), ("API_KEYS_FILE", "/nowhere/keys"), ("RATE_LIMIT", "often")],
)
def test_wrong_settings_stop_the_start_and_are_not_repeated(name, value, tmp_path):
    found = subprocess.run(
        [str(SCRIPTS / "denavit"), "serve", "--data-dir", str(tmp_path)],
        env={**os.environ, f"DENAVIT_{name}": value},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert found.returncode == 1
    assert found.stderr.startswith(f"Error: DENAVIT_{name}")
    assert "secret-password" not in found.stderr
