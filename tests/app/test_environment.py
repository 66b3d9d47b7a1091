"""Environment variables that look like settings."""

import os
import subprocess

import pytest

from app.environment import faults_of, is_service_address
from tests.conftest import DENAVIT

OF_A_SERVICE = {
    "DENAVIT_SERVICE_HOST": "10.0.0.11",
    "DENAVIT_SERVICE_PORT": "8000",
    "DENAVIT_SERVICE_PORT_HTTP": "8000",
    "DENAVIT_PORT": "tcp://10.0.0.11:8000",
    "DENAVIT_PORT_8000_TCP": "tcp://10.0.0.11:8000",
    "DENAVIT_PORT_8000_TCP_PROTO": "tcp",
    "DENAVIT_PORT_8000_TCP_ADDR": "10.0.0.11",
    "DENAVIT_LAB_SERVICE_HOST": "10.0.0.12",
    "DENAVIT_LAB_PORT": "tcp://10.0.0.12:80",
    "DENAVIT_LAB_PORT_80_TCP_PORT": "80",
}


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("DENAVIT_WORKER", "DENAVIT_WORKERS is meant?"),
        ("denavit_max_robot", "DENAVIT_MAX_ROBOTS is meant?"),
        ("DENAVIT_API_KEY", "DENAVIT_API_KEYS is meant?"),
        ("DENAVIT_ZZZZ", "docs/settings.md lists them"),
    ],
)
def test_what_is_no_setting_is_told_with_the_nearest_one(name, meant):
    (fault,) = faults_of({name: "1", "DENAVIT_PORT": "8000", "PATH": ""})
    assert fault == f"{name} is no setting; {meant}"


def test_what_kubernetes_sets_beside_a_service_of_this_name_is_not_taken_for_settings():
    assert faults_of(OF_A_SERVICE) == []
    assert is_service_address("DENAVIT_PORT", OF_A_SERVICE["DENAVIT_PORT"])
    assert not is_service_address("DENAVIT_PORT", "8000")


def test_the_service_does_not_start_with_a_setting_that_is_none(tmp_path):
    environment = {**os.environ, "DENAVIT_WORKER": "2"}
    command = [*DENAVIT, "serve", "--data-dir", str(tmp_path)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "DENAVIT_WORKER is no setting; DENAVIT_WORKERS is meant?" in done.stderr


def test_the_service_starts_beside_a_service_of_its_name(tmp_path, start_server, monkeypatch):
    for name, value in OF_A_SERVICE.items():
        monkeypatch.setenv(name, value)
    with start_server(tmp_path) as (address, _):
        assert address
