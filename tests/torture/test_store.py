"""The campaigns of ``python -m tests.torture.store``, short."""

import pytest

from tests.torture.store import (
    copied,
    full_disk,
    killed_workers,
    killed_writers,
    running_service,
    two_workers,
)


def test_killed_writers_tear_and_lose_nothing(tmp_path):
    report = killed_writers(tmp_path, 24, seed=1)
    assert report.failures == [], report.text()
    assert report.counts["kills"] == 24
    assert report.counts["writes"] >= 8


def test_a_full_disk_stores_whole_or_not_at_all(tmp_path):
    report = full_disk(tmp_path, 2, seed=1)
    assert report.failures == [], report.text()
    if not report.counts["rounds"]:
        pytest.skip("mounting a small disk takes more rights than this process has")
    assert report.counts["refused"] > 0


def test_a_copy_taken_at_any_moment_is_a_store(tmp_path):
    report = copied(tmp_path, 6, seed=1)
    assert report.failures == [], report.text()
    assert report.counts["copies"] == 6


def test_two_workers_know_the_same_and_lose_nothing_when_killed(tmp_path):
    with running_service(tmp_path) as service:
        known = two_workers(service, 6)
        killed = killed_workers(service, 1, seed=1)
    assert known.failures == [], known.text()
    assert known.counts["rounds"] == 6
    assert killed.failures == [], killed.text()
    assert killed.counts["writes"] > 0
