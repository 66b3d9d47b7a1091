"""The sources of this package speak of robots and files, not of the service that may serve it."""

from pathlib import Path

import pytest

import robots

SOURCES = sorted(Path(robots.__file__).parent.rglob("*.py"))


@pytest.mark.parametrize("word", ["pointer", "/v1", "DENAVIT_"])
def test_no_source_file_speaks_of_the_web(word):
    assert SOURCES
    assert [path.name for path in SOURCES if word in path.read_text(encoding="utf-8")] == []
