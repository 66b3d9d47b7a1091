"""The process of a whole path finds no more memory: a refusal in words, at once."""

import resource

import httpx
import pytest

from tests.conftest import PATIENCE, running_server
from tests.processes import children_of
from tests.torture.memory import status_of

pytest.importorskip("casadi")

PATH = {
    "q": [0, -0.3, 0, -1.8, 0, 1.6, 0.7],
    "target": {"position": [0.5, 0.2, 0.5]},
    "task": "position",
    "method": "whole_path",
    "obstacles": [{"type": "sphere", "center": [0.4, 0, 0.3], "radius": 0.05}] * 3,
}
SMALL, LARGE = {**PATH, "samples": 3}, {**PATH, "samples": 400}


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    with running_server(tmp_path_factory.mktemp("data")) as (address, process):
        yield f"{address}/v1/robots/panda/path", process.pid


def program_of(pid):
    """The process that waits for the next path."""
    (found,) = [one for one, command in children_of(pid).items() if "program.worker" in command]
    return found


# Where it fails: in the expressions, in the factors of the first step, in those of a later one.
@pytest.mark.parametrize("megabytes", [2, 8, 16, 24])
def test_what_finds_no_memory_is_refused_in_words(service, megabytes):
    path, pid = service
    first = httpx.post(path, json=SMALL, timeout=PATIENCE)
    assert first.status_code == 200
    program = program_of(pid)
    most = status_of(program, "VmData") + megabytes * 1_000_000
    resource.prlimit(program, resource.RLIMIT_DATA, (most, most))
    refused = httpx.post(path, json=LARGE, timeout=PATIENCE)
    assert refused.status_code == 413, refused.text[:300]
    assert "this needs more than the" in refused.json()["detail"]
    assert "it may take; ask for less" in refused.json()["detail"]
    again = httpx.post(path, json=SMALL, timeout=PATIENCE)
    assert again.status_code == 200, "the next one has a new process"
    assert again.json()["success"] == first.json()["success"]
