"""The short form of ``python -m tests.torture.soak``."""

import pytest

from tests.conftest import running_server
from tests.torture.soak import soak


def test_twice_as_much_work_as_there_is_room_for(tmp_path):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DENAVIT_PRELOAD", "true")
        patch.setenv("DENAVIT_MAX_WAITING", "8")  # so that there is overload within seconds
        with running_server(tmp_path, "--workers", "2") as (address, process):
            report = soak(int(address.rsplit(":", 1)[1]), process.pid, 12.0)
    assert report.failures == [], report.text()
    assert {200, 422} <= set(report.statuses), report.text()
    # How soon it answers is a matter of the long form, on a machine of its own.
    assert report.health
    assert report.growth < 0.3, report.text()
