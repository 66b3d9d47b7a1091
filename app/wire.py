"""Bytes to values and back: JSON and npy in, JSON, npy and terminal text out."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeVar

import msgspec
import numpy as np
import orjson
from fastapi import Request, Response
from starlette.types import Receive, Scope, Send

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
from robots.robot import FloatArray

T = TypeVar("T")

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
PIECE = 100_000
"""Bytes of JSON that are decoded at once."""
LARGE = 20_000
"""Numbers in an array above which it is written in parts, so that other threads get a turn."""

_PATH = re.compile(r" - at `([^`]*)`$")
_TYPE_NAMES = (
    ("float", "a number"),
    ("int", "an integer"),
    ("str", "a text"),
    ("array", "a list"),
    ("bool", "true or false"),
)
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
    weighted: list[tuple[float, int, str]] = []
    for position, item in enumerate(accept.lower().split(",")[:32]):
        name, *parameters = (part.strip() for part in item.split(";"))
        weight = 1.0
        for parameter in parameters:
            if parameter.startswith("q="):
                try:
                    weight = float(parameter[2:])
                except ValueError:
                    weight = 0.0
        if weight > 0:
            weighted.append((-weight, position, name))
    for _, _, name in sorted(weighted):
        for offer in offers:
            kind = offer.partition("/")[0]
            if name in (offer, "*/*", f"{kind}/*"):
                return offer
    raise RequestProblem(NOT_ACCEPTABLE, f"this answer is available as {', '.join(offers)}")


def decode_json(body: bytes | msgspec.Raw, type_: type[T], pointer: str = "") -> T:
    """Strict JSON -> a typed value.

    Raises:
        RequestProblem: 400 for text that is no JSON, 422 with a pointer for a wrong type.
    """
    try:
        return msgspec.json.decode(body, type=type_)
    except msgspec.ValidationError as error:
        raise validation_problem(error, pointer, getattr(type_, "__struct_fields__", ())) from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        reason = str(error)[:160]
        remedy = ""
        if "invalid character" in reason:
            remedy = "; JSON is UTF-8 without a byte order mark, and NaN and Infinity are not JSON"
        raise RequestProblem(
            MALFORMED_BODY, f"the body is not JSON: {reason}{remedy}", pointer
        ) from None
    except RecursionError:
        raise RequestProblem(MALFORMED_BODY, "the body is nested too deeply", pointer) from None


def decode_rows(text: bytes, pointer: str) -> FloatArray | list[list[float]]:
    """JSON rows of numbers -> an array, piece by piece, so that other threads get a turn.

    Returns:
        Shape (n, columns); the plain lists where rows are of unequal lengths.

    Raises:
        RequestProblem: Not rows of numbers; the pointer names the value.
    """
    pieces: list[FloatArray] = []
    start, end = 1, text.rfind(b"]")
    try:
        while start < end:
            cut = text.find(b"],", start + PIECE, end)
            stop = end if cut < 0 else cut + 1
            rows = msgspec.json.decode(b"[" + text[start:stop] + b"]", type=list[list[float]])
            pieces.append(np.array(rows, dtype=np.float64))
            start = stop + 1
        if text[end + 1 :].strip() or not pieces:
            raise ValueError
        return np.concatenate(pieces)
    except (msgspec.MsgspecError, ValueError, UnicodeDecodeError):
        # As a whole, for the exact place of what is wrong.
        return decode_json(text, list[list[float]], pointer)


async def read_body(request: Request, limit: int) -> bytes:
    """The body, up to a limit.

    Raises:
        RequestProblem: 413, as soon as the limit is passed.
    """
    too_large = RequestProblem(TOO_LARGE, f"the body is larger than the {limit} bytes read here")
    declared = request.headers.get("content-length", "0")
    if declared.isdigit() and int(declared) > limit:
        raise too_large
    parts: list[bytes] = []
    size = 0
    async for part in request.stream():
        size += len(part)
        if size > limit:
            raise too_large
        parts.append(part)
    return parts[0] if len(parts) == 1 else b"".join(parts)


def validation_problem(
    error: msgspec.ValidationError, pointer: str = "", known: tuple[str, ...] = ()
) -> RequestProblem:
    """A problem from msgspec's message, whose path becomes a JSON pointer.

    Args:
        error: What msgspec says.
        pointer: Where the value stands in the body.
        known: Fields that the value may have.
    """
    text = str(error)
    match = _PATH.search(text)
    path = match[1] if match else "$"
    message = _PATH.sub("", text).replace("`", "")
    found = pointer + json_pointer(path)
    unknown = re.search(r"Object contains unknown field (.+)$", message)
    if unknown:
        field = unknown[1]
        remedy = f"; known are {', '.join(known)}" if known and path == "$" else ""
        return RequestProblem(
            INVALID_REQUEST, f"unknown field {field[:64]!r}{remedy}", f"{found}/{field}"
        )
    missing = re.search(r"Object missing required field (.+)$", message)
    if missing:
        return RequestProblem(
            INVALID_REQUEST,
            f"the field {missing[1]!r} is missing; give it",
            f"{found}/{missing[1]}",
        )
    where = f"{found.removeprefix('/')}: " if found else "the body: "
    for name, plain in _TYPE_NAMES:
        message = re.sub(rf"\b{name}\b", plain, message)
    return RequestProblem(INVALID_REQUEST, f"{where}{message[:1].lower()}{message[1:]}", found)


def json_pointer(path: str) -> str:
    """``$.joints[2].alpha`` -> ``/joints/2/alpha``."""
    known = path.removeprefix("$").partition("[...]")[0]
    return re.sub(r"\[(\d+)\]", r"/\1", known).replace(".", "/")


def decode_npy(body: bytes, pointer: str = "") -> FloatArray:
    """An npy file of real numbers -> a float array in native byte order.

    Raises:
        RequestProblem: Not npy, another type than numbers, or shorter than its header says.
    """
    stream = io.BytesIO(body)
    try:
        version = np.lib.format.read_magic(stream)
        reader = (
            np.lib.format.read_array_header_1_0
            if version == (1, 0)
            else np.lib.format.read_array_header_2_0
        )
        shape, fortran, dtype = reader(stream)
    except Exception:  # numpy's header reader lets errors of its tokenizer and parser through
        raise RequestProblem(MALFORMED_BODY, "the body is no npy file", pointer) from None
    if dtype.hasobject or dtype.kind not in "fiu" or dtype.itemsize > 8:
        raise RequestProblem(
            INVALID_REQUEST, "the npy array holds no real numbers; save it as float64", pointer
        )
    count = 1
    for extent in shape:
        if isinstance(extent, bool) or not 0 < extent < 10**9 or len(shape) > 3:
            raise RequestProblem(MALFORMED_BODY, f"the npy array has shape {shape!r:.80}", pointer)
        count *= extent
    payload = body[stream.tell() :]
    if count * dtype.itemsize != len(payload):
        raise RequestProblem(
            MALFORMED_BODY, "the npy file is shorter or longer than its header says", pointer
        )
    array = np.frombuffer(payload, dtype=dtype, count=count)
    array = array.reshape(shape, order="F" if fortran else "C")
    return np.ascontiguousarray(array, dtype=np.float64)


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
            for start in range(0, len(payload), rows)
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
        elif kind is dict and _has_large(value):
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


_CELLS = {None: "", True: "true", False: "false"}
"""Values of a table that CSV writes otherwise than Python."""


def csv_bytes(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """A table as CSV (RFC 4180): a header, nothing where a value is null."""
    stream = io.StringIO()
    writer = csv.writer(stream)
    if rows:
        writer.writerow(rows[0])
    for row in rows:
        writer.writerow([_CELLS.get(value, value) for value in row.values()])
    return stream.getvalue().encode()


def npy_bytes(array: FloatArray) -> bytes:
    """An npy file."""
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.ascontiguousarray(array), allow_pickle=False)
    return stream.getvalue()


def respond(
    payload: Mapping[str, Any],
    wanted: str = JSON,
    *,
    array: FloatArray | None = None,
    rows: Sequence[Mapping[str, Any]] | None = None,
    status: int = 200,
    headers: Mapping[str, str] | None = None,
) -> Response:
    """The answer in the wanted form.

    Args:
        payload: What JSON and text show.
        wanted: Media type from :func:`wanted_type`.
        array: What npy holds.
        rows: What CSV holds: a table, with the columns of its first row.
        status: HTTP status.
        headers: Further headers.
    """
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
