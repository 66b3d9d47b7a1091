"""The sources of this package speak of tables and chains, not of the service that may serve it."""

from pathlib import Path

import pytest

import dh_to_urdf

SOURCES = sorted(Path(dh_to_urdf.__file__).parent.rglob("*.py"))


@pytest.mark.parametrize("word", ["pointer", "/v1", "DENAVIT_"])
def test_no_source_file_speaks_of_the_web(word):
    assert SOURCES
    assert [path.name for path in SOURCES if word in path.read_text(encoding="utf-8")] == []
