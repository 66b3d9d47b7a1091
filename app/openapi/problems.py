"""What the OpenAPI document says of problems."""

from __future__ import annotations

from typing import Any

import msgspec

from app.openapi.answers import REF


class ProblemItem(msgspec.Struct, kw_only=True):
    """One thing wrong with a request; of an XML text also its line and the element."""

    pointer: str
    message: str
    line: int | msgspec.UnsetType = msgspec.UNSET
    xpath: str | msgspec.UnsetType = msgspec.UNSET


class ProblemDetails(msgspec.Struct, kw_only=True):
    """RFC 9457 problem document; ``more_errors`` counts those that are not shown."""

    type: str
    title: str
    status: int
    detail: str
    errors: list[ProblemItem]
    more_errors: int | msgspec.UnsetType = msgspec.UNSET
    request_id: str


PROBLEMS: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "description": "A problem: what is wrong, where, and what to write instead.",
        "content": {
            "application/problem+json": {"schema": {"$ref": REF.format(name="ProblemDetails")}},
            # To those who ask for text: the same in lines.
            "text/plain": {"schema": {"type": "string"}},
        },
    }
}
