"""The scripts of ``install/``, which import each other by their names."""

import importlib
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def script(monkeypatch):
    """A function that gives a script as a module of this test's own."""
    monkeypatch.syspath_prepend(str(ROOT / "install"))

    def load(name):
        for loaded in ("locked", "prune", "set_up", "page"):
            monkeypatch.delitem(sys.modules, loaded, raising=False)
        return importlib.import_module(name)

    return load
