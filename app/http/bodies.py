"""Read request bodies up to a limit."""

from __future__ import annotations

import re

from fastapi import Request

from app.http.negotiation import media_type
from app.http.problems import (
    MALFORMED_BODY,
    TOO_LARGE,
    UNSUPPORTED_TYPE,
    RequestProblem,
)
from dh_to_urdf.messages import say

_CODED = re.compile(rb"gzip|compress|deflate|br|zstd", re.IGNORECASE)

_UTF8 = re.compile(rb"charset\s*=\s*\"?(utf-?8|us-ascii)\b", re.IGNORECASE)


async def read_body(request: Request, limit: int, decoded: tuple[str, ...] = ()) -> bytes:
    """The body, up to a limit.

    Args:
        request: The request.
        limit: Most bytes.
        decoded: Media types whose reader decodes what ``charset`` names; others are UTF-8.

    Raises:
        RequestProblem: 413, as soon as the limit is passed; 400 and 415 for headers that leave
            open what the body is.
    """
    too_large = RequestProblem(
        TOO_LARGE, say("the body is larger than the {limit} bytes read here", limit=limit)
    )
    types = 0
    for name, value in request.scope["headers"]:
        if name == b"content-length":
            if value.isdigit() and int(value) > limit:
                raise too_large
        elif name == b"content-type":
            types += 1
            if types > 1:
                raise RequestProblem(MALFORMED_BODY, say("the header Content-Type stands twice"))
            is_other = b"charset" in value.lower() and not _UTF8.search(value)
            if is_other and media_type(request) not in decoded:
                raise RequestProblem(
                    UNSUPPORTED_TYPE, say("the body has another charset; send UTF-8 and say so")
                )
        elif (name == b"content-encoding" and value.strip().lower() not in (b"", b"identity")) or (
            name == b"transfer-encoding" and _CODED.search(value)
        ):
            raise RequestProblem(
                UNSUPPORTED_TYPE,
                say(
                    "compressed bodies are not read here; send the body as it is, without"
                    " Content-Encoding (large batches as application/x-npy) and with no"
                    " other Transfer-Encoding than chunked"
                ),
                headers={"Accept-Encoding": "identity"},
            )
    parts: list[bytes] = []
    size = 0
    async for part in request.stream():
        size += len(part)
        if size > limit:
            raise too_large
        parts.append(part)
    return parts[0] if len(parts) == 1 else b"".join(parts)
