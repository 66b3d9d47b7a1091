"""A short campaign of the request fuzzer; ``make torture`` runs the long one."""

import pytest

from tests.conftest import running_server
from tests.torture.requests import SETTINGS, campaign


def test_mutated_requests_get_answers_or_refusals(tmp_path):
    with pytest.MonkeyPatch.context() as patch:
        for name, value in SETTINGS.items():
            patch.setenv(name, value)
        with running_server(tmp_path, "--workers", "2") as (address, process):
            port = int(address.rsplit(":", 1)[1])
            report = campaign(port, process.pid, count=600, seed=7)
    assert report.failures == [], report.text()
    assert report.count == 600
    assert {200, 400, 404, 405, 415, 422} <= set(report.statuses)
    assert report.health
