"""Lengths of requests in millimetres, turned to metres where they are read.

A field that holds lengths is marked where it is declared: ``LENGTH`` for a number, or for lists and
objects of such, ``PLACED`` for matrices, whose last column holds lengths. Joint values, rates and
rows of tasks are no such fields, as their units depend on the robot: see :mod:`app.http.units`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import msgspec

from app.fields.bounds import is_number
from app.http.units import PER_METRE

_KEY = "lengths"
LENGTH = msgspec.Meta(extra={_KEY: "all"})
PLACED = msgspec.Meta(extra={_KEY: "last column"})


@dataclass(frozen=True)
class _Plan:
    """What of a value is a length.

    Attributes:
        mark: Of all numbers in it, or of matrices in it; empty for none.
        members: Of its members by name, where it is an object.
    """

    mark: str = ""
    members: Mapping[str, _Plan] = field(default_factory=dict)

    @property
    def is_empty(self) -> bool:
        """Return whether it holds no length."""
        return not self.mark and not self.members


def in_metres(body: bytes, wire: type[msgspec.Struct]) -> bytes:
    """Return a JSON body with its lengths in m; what is no JSON object is left as it is.

    Args:
        body: The body, in mm.
        wire: What it is decoded to.
    """
    plan = _plan_of(wire)
    try:
        fields = msgspec.json.decode(body, type=dict[str, msgspec.Raw])
    except msgspec.DecodeError:
        return body  # decoding as the request says what is wrong
    for name, found in plan.members.items():
        if name in fields:
            value = _scaled(msgspec.json.decode(fields[name]), found)
            fields[name] = msgspec.Raw(msgspec.json.encode(value))
    return msgspec.json.encode(fields)


def value_in_metres(value: Any, wire: type[msgspec.Struct], name: str) -> Any:
    """Return the value of one field of a query with its lengths in m."""
    plan = _plan_of(wire).members.get(name)
    if plan is None:
        return value
    if isinstance(value, msgspec.Struct):
        given = {key: one for key, one in msgspec.structs.asdict(value).items() if one is not None}
        return type(value)(**_scaled(given, plan))
    return _scaled(value, plan)


def _scaled(value: Any, plan: _Plan) -> Any:
    if isinstance(value, dict) and plan.members:
        return {
            key: _scaled(one, plan.members[key]) if key in plan.members else one
            for key, one in value.items()
        }
    if isinstance(value, list) and plan.members and any(isinstance(one, dict) for one in value):
        return [_scaled(one, plan) for one in value]
    if plan.mark == "all":
        return _every(value)
    if plan.mark:
        return _last_column(value)
    return value


def _every(value: Any) -> Any:
    if isinstance(value, list):
        return [_every(one) for one in value]
    if isinstance(value, dict):
        return {key: _every(one) for key, one in value.items()}
    return value / PER_METRE if is_number(value) else value


def _last_column(value: Any) -> Any:
    """Return a matrix, or a list of such, with the last column of its first three rows in m."""
    if not isinstance(value, list) or not value or not isinstance(value[0], list):
        return value
    if value[0] and isinstance(value[0][0], list):
        return [_last_column(one) for one in value]
    return [
        [*row[:-1], _every(row[-1])] if k < 3 and isinstance(row, list) and row else row
        for k, row in enumerate(value)
    ]


@cache
def _plan_of(struct: type[msgspec.Struct]) -> _Plan:
    hints = {one.name: one.type for one in msgspec.structs.fields(struct)}
    hints |= {name: hint for name, hint in _hints(struct).items() if name in hints}
    return _Plan("", _merged((name, _plan(hint)) for name, hint in hints.items()))


def _hints(struct: type[msgspec.Struct]) -> dict[str, Any]:
    """Return annotations with what is told beside them, of a class that is written in a module."""
    try:
        return get_type_hints(struct, include_extras=True)
    except NameError:  # of a class that is made at run time
        return {}


def _merged(found: Iterator[tuple[str, _Plan]]) -> dict[str, _Plan]:
    return {name: plan for name, plan in found if not plan.is_empty}


def _plan(hint: Any) -> _Plan:
    mark, members = "", dict[str, _Plan]()
    for one in _parts(hint):
        if isinstance(one, msgspec.Meta):
            mark = mark or (one.extra or {}).get(_KEY, "")
        elif isinstance(one, type) and issubclass(one, msgspec.Struct):
            members |= _plan_of(one).members
    return _Plan(mark, members)


def _parts(hint: Any) -> Iterator[Any]:
    """Return the types and metas that an annotation is made of."""
    if get_origin(hint) is Annotated:
        inner, *metas = get_args(hint)
        yield from metas
        yield from _parts(inner)
        return
    args = get_args(hint)
    if not args:
        yield hint
    for one in args:
        yield from _parts(one)
