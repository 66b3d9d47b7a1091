"""uv installs; where it cannot, pip does."""

from pathlib import Path

import pytest


@pytest.fixture
def set_up(script, monkeypatch, tmp_path):
    module = script("set_up")
    monkeypatch.setattr(module, "ENVIRONMENT", tmp_path)
    monkeypatch.setattr(module, "UV", tmp_path / "uv")
    called = []
    monkeypatch.setattr(module, "pip", lambda *arguments: called.append(arguments))
    module.called = called
    return module


def program(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


def test_uv_installs(set_up, tmp_path):
    program(tmp_path / "uv", f'echo "$@" > {tmp_path}/said')
    set_up.install("--require-hashes", "-r", "lock")
    said = (tmp_path / "said").read_text()
    assert said.startswith("pip install --python ")
    assert "--require-hashes -r lock" in said
    assert set_up.called == []


@pytest.mark.parametrize("present", [False, True])
def test_where_uv_is_missing_or_fails_pip_installs(set_up, tmp_path, present, capsys):
    if present:
        program(tmp_path / "uv", "exit 2")
    set_up.install("--require-hashes", "-r", "lock")
    assert set_up.called == [("install", "--require-hashes", "-r", "lock")]
    assert "trying pip" in capsys.readouterr().err


def test_what_is_installed_has_hashes(set_up):
    *options, path = set_up.requirements("run", "build")
    assert options == ["--require-hashes", "--no-deps", "--requirement"]
    assert Path(path).read_text().count("==") > 50
