"""The short form of ``python -m tests.torture.meshes``."""

import pytest

from kinematics.meshes.preparation import MeshReader
from tests.torture.mesh_files import BOX, stl, urdf, zipped
from tests.torture.mesh_mutations import MUTATIONS, Case, case
from tests.torture.meshes import (
    CANARY_SIZE,
    MEMORY,
    MOST,
    PROGRAM,
    judge,
    largest_child,
    with_canary,
)

SLOW = ("many instances", "bomb")


@pytest.fixture(scope="module")
def reader():
    found = MeshReader(MOST, MEMORY, 0)
    yield found
    found.close()


@pytest.mark.slow
@pytest.mark.parametrize("kind", range(len(MUTATIONS)))
def test_mutated_meshes_and_archives_are_refused_or_read_right(reader, kind, tmp_path):
    outside = str(with_canary(tmp_path))
    outcomes = {judge(case(1, kind, outside), reader)}
    assert outcomes <= {"refused", "read", "read without meshes"}
    reader.close()
    assert largest_child() < MEMORY + PROGRAM


def test_the_judge_sees_a_file_from_outside(reader):
    content = zipped({"arm.urdf": urdf("a.stl"), "a.stl": stl(BOX / BOX.max() * CANARY_SIZE)})
    with pytest.raises(AssertionError, match="outside"):
        judge(Case("canary", "", content), reader)
