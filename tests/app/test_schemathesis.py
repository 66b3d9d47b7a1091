"""The OpenAPI document and the service agree: schemathesis, every check, on a real server."""

import pytest

from tests.conftest import running_server
from tests.torture.schema import run

# Every combination that a schema gives rise to, of one operation of each kind: the others are
# made of the same fields, and `make torture` goes through all.
COVERED = r"^/v1/(robots|robots/\{robot_id\}(/(urdf|dh|fk))?|axes-to-dh|ik)$"


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DENAVIT_MAX_REQUEST_SECONDS", "2")
        with running_server(tmp_path_factory.mktemp("robots")) as (address, _):
            yield address


def test_examples_and_random_requests_of_every_operation(address, tmp_path):
    done = run(address, tmp_path, "--phases", "examples,fuzzing", "--max-examples", "3")
    assert done.returncode == 0, done.stdout[-6000:]


def test_every_combination_that_the_schema_gives_rise_to(address, tmp_path):
    done = run(address, tmp_path, "--phases", "coverage", "--include-path-regex", COVERED)
    assert done.returncode == 0, done.stdout[-6000:]
