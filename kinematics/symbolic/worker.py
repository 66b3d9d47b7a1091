"""Closed forms in a process of their own: the plain answer, then the simplified one, as JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from dh_to_urdf.messages import Message, as_data

if TYPE_CHECKING:
    from dh_to_urdf.table import DHTable
    from kinematics.symbolic.request import SymbolicRequest


def prepare() -> Callable[[tuple[DHTable, SymbolicRequest]], Iterator[bytes]]:
    """Import what the first task needs, and return what does tasks."""
    from kinematics.symbolic.writing import Writing

    os.nice(5)

    def work(task: tuple[DHTable, SymbolicRequest]) -> Iterator[bytes]:
        writing = Writing(*task)
        writing.plain()
        yield json.dumps(_with_messages(writing.answer())).encode()
        writing.simplify()
        yield json.dumps(_with_messages(writing.answer())).encode()

    return work


def _with_messages(answer: dict[str, Any]) -> dict[str, Any]:
    """Return an answer whose sentences keep what they are made of, through JSON."""
    return {name: _as_data(value) for name, value in answer.items()}


def _as_data(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _as_data(inner) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_as_data(inner) for inner in value]
    return {"said": as_data(value)} if isinstance(value, Message) else value
