"""The short form of ``python -m tests.torture.classroom``."""

import asyncio
from pathlib import Path

import pytest

from tests.conftest import running_server
from tests.torture.classroom import RATE_LIMIT, keys, lesson

OPERATE = Path(__file__).parents[2] / "docs" / "operate.md"


@pytest.mark.parametrize("workers", ["1", "2"])
def test_thirty_students_who_upload_one_id_keep_thirty_robots(tmp_path, monkeypatch, workers):
    assert f"DENAVIT_RATE_LIMIT='{RATE_LIMIT}'" in OPERATE.read_text()
    secrets, lines = keys(30)
    monkeypatch.setenv("DENAVIT_API_KEYS", lines)
    monkeypatch.setenv("DENAVIT_NAMESPACES", "true")
    monkeypatch.setenv("DENAVIT_RATE_LIMIT", RATE_LIMIT)
    with running_server(tmp_path, "--workers", workers) as (address, _):
        report = asyncio.run(lesson(address, secrets, 20))
    assert report.failures == [], report.text()
    assert set(report.statuses) == {200, 201}, report.text()
    assert report.statuses[201] == 30
