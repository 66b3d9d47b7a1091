"""Bodies in and answers out: their types, their limits, and JSON, npy and terminal text."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import orjson
from fastapi import Response
from starlette.types import Receive, Scope, Send

from app.http.negotiation import CSV, JSON, NPY, TEXT
from app.http.npy import npy_bytes
from app.http.problems import (
    NOT_ACCEPTABLE,
    RequestProblem,
)
from app.http.text import render_text
from kinematics.deadline import checked
from robots.robot import FloatArray

LARGE = 20_000
"""Numbers in an array above which it is written in parts, so that other threads get a turn."""
LONG = 1_000
"""Items of a list above which it is written in parts, too."""


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
