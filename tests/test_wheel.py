"""The wheel: typed, with its page, and installed as a tool it serves."""

import subprocess
import sys
import zipfile
from pathlib import Path

import httpx
import pytest

from tests.conftest import unused_port

ROOT = Path(__file__).parents[1]
PACKAGES = ("app", "kinematics", "robots", "dh_to_urdf")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (built,) = folder.iterdir()
    return built


@pytest.mark.slow
def test_the_wheel_holds_types_page_and_library(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {f"{package}/py.typed" for package in PACKAGES} <= names
    assert {"app/static/index.html", "robots/library/puma560.yaml"} <= names
    assert any(name.startswith("app/static/assets/index-") for name in names)
    assert not [name for name in names if "__pycache__" in name or name.startswith("install/")]


@pytest.mark.slow
def test_a_tool_that_uv_installs_from_it_serves(wheel, tmp_path, monkeypatch, wait_for):
    """A first service, so its kernels are being compiled; a pose needs none of them."""
    for name in ("UV_TOOL_DIR", "UV_TOOL_BIN_DIR"):
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.setenv("UV_SYSTEM_CERTS", "1")
    for name in ("PYTHONPATH", "NUMBA_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    uv = [str(Path(sys.executable).parent / "uv"), "tool", "install", "--python", sys.executable]
    subprocess.run([*uv, "--constraints", ROOT / "requirements.lock", wheel], check=True)
    port = str(unused_port())
    denavit = tmp_path / "UV_TOOL_BIN_DIR" / "denavit"
    command = [str(denavit), "serve", "--port", port, "--data-dir", str(tmp_path / "data")]
    address = f"http://127.0.0.1:{port}"

    def answers():
        assert service.poll() is None, "the service has ended"
        try:
            return httpx.get(f"{address}/health/ready").status_code == 200
        except httpx.TransportError:
            return False

    with subprocess.Popen(command, cwd=tmp_path) as service:
        try:
            wait_for(answers)
            poses = httpx.get(f"{address}/v1/robots/puma560/fk?q=0,0,0,0,0,0").json()["poses"]
            assert len(poses["tool"]["matrix"]) == 4
            page = httpx.get(address, headers={"Accept": "text/html"}).text
            assert "assets/index-" in page
        finally:
            service.terminate()
    assert service.returncode == 0
