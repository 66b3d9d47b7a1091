"""Types of the values in answers: arrays with their shapes, and values for each sample of a batch.

A value "for each" is as its schema says in the answer for one q, and has a leading axis n in that
for a batch; ``app.openapi.answers`` makes two schemas of one declaration.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, TypeAlias

import msgspec
import numpy as np
from numpy.typing import NDArray

from robots.robot import FloatArray

EACH, EACH_OR_NONE, SHAPE = "x-each", "x-each-or-none", "x-shape"
"""Marks of schemas that take the place of what msgspec says of a type."""
NUMBER: dict[str, Any] = {"type": "number"}
INTEGER: dict[str, Any] = {"type": "integer"}
FLAG: dict[str, Any] = {"type": "boolean"}
TEXT: dict[str, Any] = {"type": "string"}
NULL: dict[str, Any] = {"type": "null"}


def listed(item: dict[str, Any], count: int | None = None) -> dict[str, Any]:
    """Return the schema of a list, of ``count`` items where that is known."""
    sizes = {} if count is None else {"minItems": count, "maxItems": count}
    return {"type": "array", "items": item, **sizes}


def vector(count: int | None = None) -> dict[str, Any]:
    """Return the schema of a list of numbers."""
    return listed(NUMBER, count)


def rows(count: int | None = None, columns: int | None = None) -> dict[str, Any]:
    """Return the schema of a matrix, row by row."""
    return listed(vector(columns), count)


def or_null(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a value that may be null."""
    return {"anyOf": [schema, NULL]}


def each(schema: dict[str, Any]) -> msgspec.Meta:
    """Return the annotation of a value for each sample."""
    return msgspec.Meta(extra_json_schema={EACH: schema})


def each_or_none(schema: dict[str, Any]) -> msgspec.Meta:
    """Return the annotation of a value for each sample, or null for all of them."""
    return msgspec.Meta(extra_json_schema={EACH_OR_NONE: schema})


def shaped(schema: dict[str, Any]) -> msgspec.Meta:
    """Return the annotation of a value that is the same for one and for many."""
    return msgspec.Meta(extra_json_schema={SHAPE: schema})


Floats: TypeAlias = FloatArray | Sequence[float]
FloatRows: TypeAlias = FloatArray | Sequence[Sequence[float]] | Sequence[FloatArray]

AnswerUnits: TypeAlias = Annotated[
    dict[str, str], msgspec.Meta(description='Units of the answer: {"angle": …, "length": "m"}.')
]
Vector: TypeAlias = Annotated[Floats, shaped(vector())]
Position: TypeAlias = Annotated[Floats, shaped(vector(3))]
Matrix: TypeAlias = Annotated[FloatRows, shaped(rows())]
Pose: TypeAlias = Annotated[FloatRows, shaped(rows(4, 4))]
EachVector: TypeAlias = Annotated[Floats | FloatRows, each(vector())]
EachPosition: TypeAlias = Annotated[Floats, each(vector(3))]
EachQuaternion: TypeAlias = Annotated[Floats, each(vector(4))]
EachMatrix: TypeAlias = Annotated[FloatRows, each(rows())]
EachPose: TypeAlias = Annotated[FloatRows, each(rows(4, 4))]
EachJacobian: TypeAlias = Annotated[FloatArray, each(rows(6))]
EachNumber: TypeAlias = Annotated[float | Floats, each(NUMBER)]
EachNumberOrNull: TypeAlias = Annotated[
    float | FloatArray | Sequence[float | None] | None, each(or_null(NUMBER))
]
EachInteger: TypeAlias = Annotated[
    int | Sequence[int] | NDArray[np.signedinteger[Any]], each(INTEGER)
]
EachFlag: TypeAlias = Annotated[bool | Sequence[bool], each(FLAG)]
EachText: TypeAlias = Annotated[str | Sequence[str], each(TEXT)]
