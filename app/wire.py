"""Bodies in and answers out: their types, their limits, and JSON, npy and terminal text."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import orjson
from fastapi import Request, Response
from starlette.types import Receive, Scope, Send

from app.npy import npy_bytes
from app.problems import (
    INVALID_REQUEST,
    MALFORMED_BODY,
    NOT_ACCEPTABLE,
    TOO_LARGE,
    UNSUPPORTED_TYPE,
    RequestProblem,
)
from app.text import render_text
from dh_to_urdf.pasted.writer import TABLE_TEXTS
from kinematics.deadline import checked
from robots.robot import FloatArray

JSON = "application/json"
NPY = "application/x-npy"
TEXT = "text/plain"
HTML = "text/html"
NDJSON = "application/x-ndjson"
YAML = "application/yaml"
CSV = "text/csv"
SVG = "image/svg+xml"
PNG = "image/png"
LATEX = TABLE_TEXTS["latex"].media_type
PYTHON_SOURCE = "text/x-python"
C_SOURCE = "text/x-c"
MAX_RANGES = 32
"""Entries of an Accept header that are read."""
LARGE = 20_000
"""Numbers in an array above which it is written in parts, so that other threads get a turn."""
LONG = 1_000
"""Items of a list above which it is written in parts, too."""

FORMATS = {
    "json": JSON,
    "text": TEXT,
    "html": HTML,
    "npy": NPY,
    "ndjson": NDJSON,
    "yaml": YAML,
    "csv": CSV,
    "svg": SVG,
    "png": PNG,
    "python": PYTHON_SOURCE,
    "c": C_SOURCE,
} | {name: form.media_type for name, form in TABLE_TEXTS.items()}
"""Names of media types in ``?format=``."""
_WEIGHT = re.compile(r"0(\.\d{0,3})?|1(\.0{0,3})?", re.ASCII)
_CODED = re.compile(rb"gzip|compress|deflate|br|zstd", re.IGNORECASE)
_UTF8 = re.compile(rb"charset\s*=\s*\"?(utf-?8|us-ascii)\b", re.IGNORECASE)


def media_type(request: Request) -> str:
    """The body's media type in lower case, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


def wanted_type(request: Request, *offers: str) -> str:
    """The form of the answer: ``?format=`` if given, else the best of the Accept header.

    Raises:
        RequestProblem: 406, neither names an offer.
    """
    named = request.query_params.get("format") if request.scope["query_string"] else None
    if named is not None:
        wanted = FORMATS.get(named)
        if wanted not in offers:
            choices = ", ".join(key for key, value in FORMATS.items() if value in offers)
            raise RequestProblem(
                INVALID_REQUEST, f"format is {named[:32]!r}; give one of {choices}", "/format"
            )
        return wanted
    accept = request.headers.get("accept", "*/*")
    if accept in ("*/*", offers[0]):
        return offers[0]
    ranges = accepted_ranges(",".join(request.headers.getlist("accept")))
    best: tuple[float, int] | None = None
    chosen = None
    for offer in offers:
        kind = offer.partition("/")[0]
        # The most specific range that fits an offer says how much it is wanted.
        found = next((ranges[n] for n in (offer, f"{kind}/*", "*/*") if n in ranges), None)
        if found is not None and found[0] < 0 and (best is None or found < best):
            best, chosen = found, offer
    if chosen is None:
        raise RequestProblem(NOT_ACCEPTABLE, f"this answer is available as {', '.join(offers)}")
    return chosen


def accepted_ranges(accept: str) -> dict[str, tuple[float, int]]:
    """Media ranges of an Accept header, each with its negative weight and its position.

    A weight that is none counts as 0; an empty header accepts everything.
    """
    ranges: dict[str, tuple[float, int]] = {}
    for position, item in enumerate(accept.lower().split(",")[:MAX_RANGES]):
        name, *parameters = (part.strip() for part in item.split(";"))
        if not name:
            continue
        weights = [one[2:] for one in parameters if one.startswith("q=")]
        weight = 1.0
        if weights:
            weight = float(weights[0]) if _WEIGHT.fullmatch(weights[0]) else 0.0
        ranges.setdefault(name, (-weight, position))
    return ranges or {"*/*": (-1.0, 0)}


async def read_body(request: Request, limit: int) -> bytes:
    """The body, up to a limit.

    Raises:
        RequestProblem: 413, as soon as the limit is passed; 400 and 415 for headers that leave
            open what the body is.
    """
    too_large = RequestProblem(TOO_LARGE, f"the body is larger than the {limit} bytes read here")
    types = 0
    for name, value in request.scope["headers"]:
        if name == b"content-length":
            if value.isdigit() and int(value) > limit:
                raise too_large
        elif name == b"content-type":
            types += 1
            if types > 1:
                raise RequestProblem(MALFORMED_BODY, "the header Content-Type stands twice")
            if b"charset" in value.lower() and not _UTF8.search(value):
                raise RequestProblem(
                    UNSUPPORTED_TYPE, "the body has another charset; send UTF-8 and say so"
                )
        elif (name == b"content-encoding" and value.strip().lower() not in (b"", b"identity")) or (
            name == b"transfer-encoding" and _CODED.search(value)
        ):
            raise RequestProblem(
                UNSUPPORTED_TYPE,
                "compressed bodies are not read here; send the body as it is, without"
                " Content-Encoding (large batches as application/x-npy) and with no other"
                " Transfer-Encoding than chunked",
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


def json_parts(payload: Mapping[str, Any]) -> list[bytes]:
    """JSON of dicts, lists, scalars and numpy arrays; large arrays in parts."""
    parts: list[bytes] = []
    _append_json(payload, parts)
    return parts


def _append_json(payload: object, parts: list[bytes]) -> None:
    if isinstance(payload, dict) and _has_large(payload):
        for position, (key, value) in enumerate(payload.items()):
            parts.append((b"," if position else b"{") + orjson.dumps(key) + b":")
            _append_json(value, parts)
        parts.append(b"}")
    elif isinstance(payload, np.ndarray) and payload.size > LARGE:
        rows = max(1, LARGE // max(1, payload[0].size))
        parts.extend(
            (b"," if start else b"[") + _dumps(payload[start : start + rows])[1:-1]
            for start in checked(range(0, len(payload), rows), 1)
        )
        parts.append(b"]")
    elif isinstance(payload, list) and len(payload) > LONG:
        rows = max(1, LARGE // max(1, np.size(payload[0])))
        parts.extend(
            (b"," if start else b"[") + _dumps(payload[start : start + rows])[1:-1]
            for start in checked(range(0, len(payload), rows), 1)
        )
        parts.append(b"]")
    else:
        parts.append(_dumps(payload))


def _has_large(payload: dict[str, Any]) -> bool:
    for value in payload.values():
        kind = type(value)
        if kind is np.ndarray:
            if value.size > LARGE:
                return True
        elif (kind is list and len(value) > LONG) or (kind is dict and _has_large(value)):
            return True
    return False


class PartsResponse(Response):
    """A body in parts that are never joined: a copy of megabytes would hold up other requests."""

    def __init__(self, parts: list[bytes], status: int, headers: Mapping[str, str]) -> None:
        length = {"content-length": str(sum(map(len, parts)))}
        super().__init__(None, status, {**headers, **length}, JSON)
        self.parts = parts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002
        """Sends the parts one by one."""
        start = {"type": "http.response.start", "status": self.status_code}
        await send({**start, "headers": self.raw_headers})
        for part in self.parts:
            await send({"type": "http.response.body", "body": part, "more_body": True})
        await send({"type": "http.response.body", "body": b"", "more_body": False})


def _dumps(payload: object) -> bytes:
    return orjson.dumps(
        payload,
        default=_plain,
        option=orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS,
    )


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        return np.ascontiguousarray(value) if value.dtype.kind in "fiub" else value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"cannot write a {type(value).__name__}")


def json_lines(rows: Iterable[Mapping[str, Any]]) -> bytes:
    """One JSON object a line."""
    return b"".join(_dumps(row) + b"\n" for row in rows)


def _cell(value: object) -> object:
    """A value of a table, as CSV writes it; 1 and 0 are numbers, though Python has True == 1."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else value


def csv_bytes(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """A table as CSV (RFC 4180): a header, nothing where a value is null."""
    stream = io.StringIO()
    writer = csv.writer(stream)
    if rows:
        writer.writerow(rows[0])
    for row in rows:
        writer.writerow([_cell(value) for value in row.values()])
    return stream.getvalue().encode()


def respond(
    payload: Mapping[str, Any],
    wanted: str = JSON,
    *,
    array: FloatArray | None = None,
    rows: Sequence[Mapping[str, Any]] | None = None,
    status: int = 200,
    headers: Mapping[str, str] | None = None,
    short: bool = False,
) -> Response:
    """The answer in the wanted form.

    Args:
        payload: What JSON and text show.
        wanted: Media type from :func:`wanted_type`.
        array: What npy holds.
        rows: What CSV holds: a table, with the columns of its first row.
        status: HTTP status.
        headers: Further headers.
        short: Whether the payload is known to hold a few numbers only.
    """
    if short and wanted == JSON:
        return Response(_dumps(payload), status, headers, JSON)
    if wanted == TEXT:
        content = render_text(payload).encode()
        return Response(content, status, dict(headers or {}), "text/plain; charset=utf-8")
    if wanted == CSV:
        content = csv_bytes(rows or [])
        return Response(content, status, dict(headers or {}), "text/csv; charset=utf-8")
    if wanted == NPY:
        if array is None:
            raise RequestProblem(NOT_ACCEPTABLE, "this answer has no npy form; ask for JSON")
        return Response(npy_bytes(array), status, dict(headers or {}), NPY)
    parts = json_parts(payload)
    if len(parts) > 1:
        return PartsResponse(parts, status, headers or {})
    return Response(parts[0], status, dict(headers or {}), JSON)


def require_type(request: Request, *accepted: str) -> str:
    """The body's media type, if it is one of those accepted.

    Raises:
        RequestProblem: 415, with what to write.
    """
    given = media_type(request)
    if given in accepted:
        return given
    raise unsupported(given, accepted)


def unsupported(given: str, accepted: tuple[str, ...]) -> RequestProblem:
    """415 that teaches ``curl --json`` to those who used ``curl -d``."""
    listed = ", ".join(accepted)
    if given in ("", "application/x-www-form-urlencoded"):
        detail = (
            "the body has no JSON content type; with curl write --json '{…}' instead of -d, or add"
            f" -H 'Content-Type: {accepted[0]}' (read here: {listed})"
        )
    else:
        detail = f"a body of type {given[:64]!r} is not read here; send {listed}"
    return RequestProblem(UNSUPPORTED_TYPE, detail, headers={"Accept": listed})
