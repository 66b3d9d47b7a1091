"""Large texts as gzip, for clients that take it.

The coding is igzip's first level, some 200 MB/s: numbers in decimal digits shrink to less than
half, so that an answer arrives sooner on any network of less than 800 Mbit/s. npy does not: its
bytes hold few repetitions. Answers that are streamed are sent as they come.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fastapi import Request, Response
from isal import isal_zlib

from app.http.negotiation import NDJSON, NPY, PNG
from app.http.ranges import accepted_ranges
from app.http.responses import PartsResponse
from kinematics.deadline import checked

COMPRESSED = 100_000
"""Bytes of an answer from which on it is compressed; a smaller one arrives as soon as it is."""
PIECE = 500_000
"""Bytes that are compressed at once."""
_PLAIN = frozenset({NPY, NDJSON, PNG})
"""Media types that gzip does not shorten, or that are sent as they are computed."""
_GZIP = ("gzip", "x-gzip")
_WINDOW = 16 + 15
"""zlib's name for a gzip file with its largest window."""


def needs_coding(request: Request) -> bool:
    """Return whether a client refuses an answer without content coding, and takes gzip."""
    for name, value in request.scope["headers"]:
        # Short requests are asked this one by one, and hardly any of them names either.
        if name == b"accept-encoding" and (b"*" in value or b"identity" in value.lower()):
            gzip, identity = _weights(request)
            return gzip > 0.0 and identity == 0.0
    return False


def compressed(response: Response, request: Request) -> Response:
    """Return an answer as the client takes it: a large text in gzip.

    To be called in a thread where the answer may be large; stops where its time is up.

    Args:
        response: The whole answer.
        request: Says what its client takes.
    """
    kind = response.headers.get("content-type", "").partition(";")[0]
    size = int(response.headers.get("content-length", 0))
    if kind in _PLAIN or "content-encoding" in response.headers or not size:
        return response
    gzip, identity = _weights(request)
    if size < COMPRESSED and (gzip == 0.0 or identity > 0.0):
        return response
    varied = response.headers.get("vary")
    headers: dict[str, str] = {key: response.headers[key] for key in response.headers}
    headers["vary"] = f"{varied}, Accept-Encoding" if varied else "Accept-Encoding"
    if gzip == 0.0 or gzip < identity:
        response.headers["vary"] = headers["vary"]
        return response
    del headers["content-length"]
    parts: list[bytes | memoryview] = [response.body]
    if isinstance(response, PartsResponse):
        parts = response.parts
    headers["content-encoding"] = "gzip"
    kind = headers.pop("content-type")
    return PartsResponse(_gzip(parts), response.status_code, headers, kind)


def _gzip(parts: list[bytes | memoryview]) -> list[bytes]:
    """Compress, letting go of each part when it is done."""
    coder: Any = isal_zlib.compressobj(1, wbits=_WINDOW)
    found: list[bytes] = []
    parts.reverse()
    while parts:
        found.extend(map(coder.compress, _pieces(parts.pop())))
    return [part for part in (*found, coder.flush()) if part]


def _pieces(part: bytes | memoryview) -> Iterable[memoryview]:
    view = memoryview(part)
    return (view[start : start + PIECE] for start in checked(range(0, len(view), PIECE), 1))


def _weights(request: Request) -> tuple[float, float]:
    """Return how much a client wants gzip, and an answer without coding, each from 0 to 1.

    Without a header, or with an empty one, there is no coding (RFC 9110, section 12.5.3). Where
    both are wanted alike, gzip is meant: nobody names it in vain. An answer without coding is
    refused only where it says so.
    """
    lines = request.headers.getlist("accept-encoding")
    text = ",".join(lines)
    if not text.strip(" ,"):
        return 0.0, 1.0
    ranges = {name: -weight for name, (weight, _) in accepted_ranges(text).items()}
    others = ranges.get("*")
    gzip = max((ranges[name] for name in _GZIP if name in ranges), default=others or 0.0)
    if "identity" in ranges:
        return gzip, ranges["identity"]
    # Not named, it is taken as a last resort, unless the star refuses it.
    return gzip, 0.0 if others == 0.0 else min(gzip, 0.001)
