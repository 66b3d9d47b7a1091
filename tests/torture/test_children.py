"""The short form of ``python -m tests.torture.children``."""

from tests.conftest import running_server
from tests.torture.children import campaign, fault_of, question


def test_no_answer_is_lost_when_children_are_killed(tmp_path):
    with running_server(tmp_path) as (address, process):
        report = campaign(address, process.pid, 150, 8)
    assert report.failures == [], report.text()
    assert report.statuses == {200: 150}, report.text()
    assert report.kills >= 8, report.text()


def test_a_wrong_answer_is_found():
    _, lengths = question(7)
    right = {"X": f"{lengths[0]}*C1 + {lengths[1]}*C12", "Y": f"{lengths[0]}*S1 + {lengths[1]}*S12"}
    assert fault_of({"position": right}, lengths) is None
    assert fault_of({"position": {**right, "Y": right["X"]}}, lengths) is not None
