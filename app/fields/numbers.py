"""Numbers of requests with their bounds, in a body and in a query."""

from __future__ import annotations

from typing import Annotated, TypeAlias

import msgspec

from app.fields import texts
from app.fields.field import Field, Parameter, Text, declared


def within_query(
    low: float,
    high: float,
    text: str | None,
    in_query: str,
    read: Text = texts.scalar,
) -> msgspec.Meta:
    """Return the annotation of a number with bounds, both included, that a query gives too.

    Args:
        low: Lower bound.
        high: Upper bound.
        text: For the documents of a body.
        in_query: For those of a query.
        read: Reader of the query's text.
    """
    schema = {"minimum": low, "maximum": high}
    return declared(Field((Parameter(read, in_query),)), text, schema)


RankTolerance: TypeAlias = Annotated[
    float,
    declared(
        Field(
            (
                Parameter(
                    texts.scalar, "singularity: relative tolerance of the rank; ik: m and rad."
                ),
            )
        ),
        "Singular values below tolerance * max(1, largest) count as zero.",
        {"minimum": 0, "exclusiveMaximum": 1},
    ),
]
