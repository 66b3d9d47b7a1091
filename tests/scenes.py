"""Scenes: one test of each kind that ``make test`` runs over HTTP and in the browser."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def one_scene(values: Iterable[Any]) -> list[Any]:
    """Parameters of a test, of which the first is a scene and all are run by ``make check``."""
    first, *rest = values
    return [pytest.param(first, marks=pytest.mark.scene), *rest]
