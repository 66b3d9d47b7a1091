"""A short form of the campaign of memory; the long one is ``python -m tests.torture.memory``."""

import httpx
import pytest

from tests.conftest import PATIENCE
from tests.torture.at_limits import ROBOT, cases
from tests.torture.memory import WORKER_BYTES, alone, in_pairs, service

ALONE = (
    "few joints fk application/x-npy",
    "few joints manipulability-gradient application/x-npy",
    "path application/x-npy",
    "wrench",
)
TOGETHER = ("few joints fk application/x-npy", "wrench")

pytestmark = pytest.mark.slow


def chosen(names):
    return [one for one in cases() if one.name in names]


def test_what_is_taken_is_what_was_said_and_goes_back():
    for measured in alone(chosen(ALONE)):
        assert measured.status == 200
        assert measured.as_said, measured.text()
        assert measured.kept < measured.estimate / 2, measured.text()


def test_no_pair_takes_a_worker_beyond_its_bound():
    first, second = chosen(TOGETHER)
    report = in_pairs([(first, second), (second, second)], workers=1, preload=False)
    assert not report.failures, report.text()


def test_what_never_fits_is_refused_with_the_size_that_would():
    (large,) = chosen(("path whole_path 937 0",))
    with service(1, WORKER_BYTES) as (address, _):
        answer = httpx.post(
            address + large.address, content=large.body, headers=large.headers, timeout=PATIENCE
        )
        assert answer.status_code == 413
        problem = answer.json()
        assert problem["errors"][0]["pointer"] == "/samples"
        assert "samples of this robot at once" in problem["detail"]
        # It is refused before anything is computed; what fits is not.
        small = {"q": [0.1] * 64, "target": {"position": [0.4, 0.2, 0.5]}, "task": "position"}
        path = f"{address}/v1/robots/{ROBOT}/path"
        assert httpx.post(path, json={**small, "samples": 11}, timeout=PATIENCE).status_code == 200
