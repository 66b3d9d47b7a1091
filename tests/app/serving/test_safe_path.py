"""No process of the service imports what lies in the directory in which it was started."""

import os

import httpx
import pytest

from tests.app.access.requests import FK
from tests.conftest import DENAVIT, PATIENCE, running_server

NAMES = ("robots", "kinematics", "fractions", "json", "socket", "pickle", "sympy", "sitecustomize")


@pytest.mark.parametrize("workers", ["1", "2"])
def test_the_service_imports_nothing_from_the_current_directory(tmp_path, monkeypatch, workers):
    folder, imported = tmp_path / "folder", tmp_path / "imported"
    folder.mkdir()
    for name in NAMES:
        text = f"open({str(imported)!r}, 'a').write({name!r})\nraise ImportError({name!r})\n"
        (folder / f"{name}.py").write_text(text)
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(("/nowhere", "/nor/there")))
    with running_server(tmp_path / "data", "--workers", workers, program=DENAVIT) as (address, _):
        assert httpx.get(f"{address}{FK}", timeout=PATIENCE).status_code == 200
        question = {"quantities": ["jacobian"]}
        url = f"{address}/v1/robots/planar_2r/symbolic"
        answer = httpx.post(url, json=question, timeout=PATIENCE)
        assert answer.status_code == 200, answer.text
    assert not imported.exists()
