"""Bodies in and answers out: their types, their limits, and JSON, npy and terminal text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import orjson
from fastapi import Response
from numpy.typing import NDArray
from starlette.types import Receive, Scope, Send

from app.http.csv_table import CsvForm, csv_parts
from app.http.language import language_headers
from app.http.negotiation import CSV, JSON, NPY, TEXT
from app.http.npy import PART, npy_parts
from app.http.problems import (
    NOT_ACCEPTABLE,
    RequestProblem,
)
from app.http.text import render_text
from app.sheets.sheet import Sheet
from dh_to_urdf.languages import Language
from dh_to_urdf.messages import say
from kinematics.deadline import checked

LARGE = 20_000
"""Numbers in an array above which it is written in parts, so that other threads get a turn."""
LONG = 1_000
"""Items of a list above which it is written in parts, too."""
MAX_HEADER = 2_000
"""Characters of a header that tells warnings."""
_NEGATIVE_ZERO = re.compile(rb"[\[:,]-0\.0[\],}]")
_STRING_OR_ZERO = re.compile(rb'"(?:[^"\\]|\\.)*"|-0\.0(?=[\],}])')
_CONTROLS = re.compile(r"[\x00-\x1f\x7f]")


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
            (b"," if start else b"[") + _array_text(payload[start : start + rows])[1:-1]
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


def _array_text(array: NDArray[Any]) -> bytes:
    """JSON of a large array: adding zero takes the signs of zeros sooner than a search does."""
    if array.dtype.kind != "f":
        return _dumps(array)
    return orjson.dumps(np.ascontiguousarray(array + 0.0), option=orjson.OPT_SERIALIZE_NUMPY)


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

    def __init__(
        self,
        parts: Sequence[bytes | memoryview],
        status: int,
        headers: Mapping[str, str],
        kind: str = JSON,
    ) -> None:
        length = {"content-length": str(sum(map(len, parts)))}
        super().__init__(None, status, {**headers, **length}, kind)
        self.parts = [*parts]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002
        """Sends the parts one by one."""
        start = {"type": "http.response.start", "status": self.status_code}
        await send({**start, "headers": self.raw_headers})
        for part in self.parts:
            await send({"type": "http.response.body", "body": part, "more_body": True})
        await send({"type": "http.response.body", "body": b"", "more_body": False})


def _dumps(payload: object) -> bytes:
    text = orjson.dumps(
        payload,
        default=_plain,
        option=orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS,
    )
    if b"-0.0" in text and _ends_in_zero(text) and _NEGATIVE_ZERO.search(text) is not None:
        return _STRING_OR_ZERO.sub(_without_sign, text)
    return text


def _ends_in_zero(text: bytes) -> bool:
    """Whether there may be a -0.0 that is no beginning of another number: sooner than a search."""
    return b"-0.0," in text or b"-0.0]" in text or b"-0.0}" in text


def _without_sign(found: re.Match[bytes]) -> bytes:
    return b"0.0" if found[0] == b"-0.0" else found[0]


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        return np.ascontiguousarray(value) if value.dtype.kind in "fiub" else value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"cannot write a {type(value).__name__}")


def json_of(payload: Mapping[str, Any], language: Language) -> bytes:
    """JSON of a payload that is known to hold a few numbers only."""
    return _dumps(language.told(payload))


@lru_cache(maxsize=16)
def json_head(language: Language) -> tuple[tuple[bytes, bytes], ...]:
    """The headers of a JSON answer with status 200, but for its length."""
    response = Response(b"", headers=language_headers(language), media_type=JSON)
    return tuple(one for one in response.raw_headers if one[0] != b"content-length")


def json_lines(rows: Iterable[Mapping[str, Any]], language: Language) -> bytes:
    """One JSON object a line."""
    return b"".join(_dumps(language.told(row)) + b"\n" for row in rows)


def told_in_header(warnings: Sequence[str], language: Language) -> dict[str, str]:
    """The header that tells warnings with a form that has no place for them."""
    if not warnings:
        return {}
    text = " | ".join(language.told(warnings)).encode("ascii", "backslashreplace").decode()
    return language_headers(language, {"x-warnings": _CONTROLS.sub(" ", text)[:MAX_HEADER]})


def respond(
    payload: Mapping[str, Any],
    wanted: str,
    language: Language,
    *,
    array: NDArray[Any] | None = None,
    sheet: Sheet | None = None,
    status: int = 200,
    headers: Mapping[str, str] | None = None,
    short: bool = False,
    digits: int | None = None,
    table: CsvForm | None = None,
) -> Response:
    """The answer in the wanted form.

    Args:
        payload: What JSON and text show.
        wanted: Media type from :func:`wanted_type`.
        language: What messages, and headings of texts, are written in.
        array: What npy holds.
        sheet: What CSV holds.
        status: HTTP status.
        headers: Further headers.
        short: Whether the payload is known to hold a few numbers only.
        digits: Decimals of numbers in text; None: its own choice.
        table: How CSV is written; None: in English, with decimal points.
    """
    if short and wanted == JSON:
        return Response(
            json_of(payload, language), status, language_headers(language, headers), JSON
        )
    payload = language.told(payload)
    if wanted == NPY:
        if array is None:
            raise RequestProblem(NOT_ACCEPTABLE, say("this answer has no npy form; ask for JSON"))
        told = told_in_header(payload.get("warnings", ()), language)
        headers, file = {**(headers or {}), **told}, npy_parts(array)
        if array.nbytes > PART:
            return PartsResponse(file, status, headers, NPY)
        return Response(b"".join(file), status, headers, NPY)
    headers = language_headers(language, headers)
    if wanted == TEXT:
        content = render_text(payload, digits, language).encode()
        return Response(content, status, headers, "text/plain; charset=utf-8")
    if wanted == CSV:
        if sheet is None:
            raise RequestProblem(NOT_ACCEPTABLE, say("this answer has no table; ask for JSON"))
        warnings = payload.get("warnings", ())
        told = {} if len(sheet) else told_in_header(warnings, language)
        parts = csv_parts(sheet, table or CsvForm(digits=digits), language.told(warnings))
        return PartsResponse(parts, status, {**headers, **told}, "text/csv; charset=utf-8")
    parts = json_parts(payload)
    if len(parts) > 1:
        return PartsResponse(parts, status, headers)
    return Response(parts[0], status, headers, JSON)
