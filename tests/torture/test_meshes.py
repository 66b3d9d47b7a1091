"""The short form of ``python -m tests.torture.meshes``."""

import subprocess
import sys

import pytest

from kinematics.meshes.preparation import MeshReader
from tests.torture.mesh_files import BOX, stl, urdf, zipped
from tests.torture.mesh_mutations import MUTATIONS, Case
from tests.torture.meshes import (
    CANARY_SIZE,
    MEMORY,
    MOST,
    judge,
)


@pytest.fixture(scope="module")
def reader():
    found = MeshReader(MOST, MEMORY, 0)
    yield found
    found.close()


@pytest.mark.slow
def test_mutated_meshes_and_archives_are_refused_or_read_right():
    """In a process of its own, whose children are those that read: each mutation once."""
    command = [sys.executable, "-m", "tests.torture.meshes", "--seed", "1"]
    done = subprocess.run(
        [*command, "--count", str(len(MUTATIONS))], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


def test_the_judge_sees_a_file_from_outside(reader):
    content = zipped({"arm.urdf": urdf("a.stl"), "a.stl": stl(BOX / BOX.max() * CANARY_SIZE)})
    with pytest.raises(AssertionError, match="outside"):
        judge(Case("canary", "", content), reader)
