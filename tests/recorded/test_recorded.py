"""The answers to the recorded requests are what they were, but for what is meant to change."""

from __future__ import annotations

from collections import Counter

import pytest

from tests.conftest import running_server
from tests.recorded.fixture import records
from tests.recorded.replay import replay


@pytest.mark.slow
def test_answers_are_what_they_were(tmp_path):
    with running_server(tmp_path) as (address, _):
        report = replay(address, records())
    assert report.count > 2000
    assert not report.differing, report.text(20)


def test_all_operations_are_recorded():
    kinds = Counter((one.asked.operation, one.answer.status // 100) for one in records())
    names = {name for name, _ in kinds}
    assert all(kinds[name, 4] for name in names - {"setup"})
    assert len(names) > 22
