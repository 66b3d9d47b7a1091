"""What is taken out of an answer before it is recorded or compared, and digests of long bodies.

Left out of the headers: ``date``, ``server``, ``x-request-id``, ``content-length``,
``transfer-encoding``, ``content-language``, and in ``vary`` the language, as answers were recorded
when they had only one. Put in the place of what differs from run to run:

- the service's own address: ``http://HOST``;
- ``request_id`` of problems: an empty text;
- how many more robots are known, where a robot is not found: ``N``;
- ``elapsed_ms`` and ``ms_per_point``: 0 in JSON and NDJSON, one blank and 0 in text, with runs of
  blanks in that line made one; 0 in the column of CSV.

Everything else stays, byte for byte. A body above ``LONGEST`` bytes, and one that is no text, is
kept as a digest: its SHA-256; that of its text with every number replaced, for other machines,
where last bits differ; how many numbers there are, and weighted sums of them; its top-level keys.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import re
import struct
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from tests.recorded.fixture import Answer

LONGEST = 20_000
DROPPED = {
    *("date", "server", "x-request-id", "content-length", "transfer-encoding"),
    "content-language",
}
_NUMBER = r"(?<![A-Za-z0-9_.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![A-Za-z0-9_])"
NUMBER = re.compile(_NUMBER)
_PLACE = re.compile(rf" *{_NUMBER}")
TOP = re.compile(r"^([A-Za-z_]\w*):", re.MULTILINE)
_NUMBERS = rb"-?[0-9.]+(?:[eE][-+]?[0-9]+)?"
_IN_JSON = re.compile(rb'"(elapsed_ms|ms_per_point)":(\[[-+0-9.eE,]*\]|' + _NUMBERS + rb")")
_IN_TEXT = re.compile(
    rb"^(.*\b(?:elapsed_ms|ms_per_point)\b:?)((?: +\[?" + _NUMBERS + rb"\]?)+)(.*)$", re.MULTILINE
)
_ID_IN_JSON = re.compile(rb'"request_id":"[^"]*"')
_KNOWN = re.compile(rb"(known are [^\"\n]* and )\d+( more)")
_ID_IN_TEXT = re.compile(rb"^request_id: .*$", re.MULTILINE)


def normalised(
    status: int, headers: Mapping[str, str], body: bytes, address: str
) -> tuple[Answer, str | None]:
    """An answer as it is recorded and compared, and its whole text, None where it is no text.

    Args:
        status: Its status.
        headers: Its headers, by lower-case name.
        body: Its body.
        address: Of the service, such as http://127.0.0.1:8000.
    """
    kept = {
        name: value.replace(address, "http://HOST")
        for name, value in sorted(_without_language(headers).items())
        if name not in DROPPED
    }
    kind = headers.get("content-type", "").partition(";")[0]
    content = _steady(kind, body).replace(address.encode(), b"http://HOST")
    if status == 404:
        content = _KNOWN.sub(rb"\1N\2", content)
    if kind in ("application/x-npy", "image/png") and body[:1] == b"\x93":
        return Answer(status, kept, None, _array_digest(body)), None
    if kind == "image/png":
        return Answer(status, kept, None, _picture_digest(body)), None
    try:
        text = content.decode()
    except UnicodeDecodeError:
        digest = {"sha256": _sha(content), "bytes": len(content)}
        return Answer(status, kept, None, digest), None
    if len(content) <= LONGEST:
        return Answer(status, kept, text), text
    return Answer(status, kept, None, text_digest(text)), text


LATER = ("Accept-Language", "Accept-Encoding", "")
"""What answers depend on since languages and content codings were added."""


def _without_language(headers: Mapping[str, str]) -> dict[str, str]:
    """Headers without the language among what an answer varies by."""
    kept = [one for one in headers.get("vary", "").split(", ") if one not in LATER]
    rest = {name: value for name, value in headers.items() if name != "vary"}
    return {**rest, "vary": ", ".join(kept)} if any(kept) else rest


def _steady(kind: str, body: bytes) -> bytes:
    """A body without times and ids."""
    if kind.endswith(("json", "x-ndjson")):
        body = _ID_IN_JSON.sub(b'"request_id":""', body)
        return _IN_JSON.sub(rb'"\1":0', body)
    if kind == "text/csv" and b"ms_per_point" in body[:1000]:
        rows = [line.split(b",") for line in body.split(b"\r\n")]
        column = rows[0].index(b"ms_per_point")
        kept = [[*row[:column], b"0", *row[column + 1 :]] for row in rows[1:] if len(row) > column]
        return b"\r\n".join(b",".join(row) for row in (rows[0], *kept))
    if kind == "text/plain":
        body = _ID_IN_TEXT.sub(b"request_id: ", body)
        if b"elapsed_ms" in body or b"ms_per_point" in body:
            body = _IN_TEXT.sub(_without_times, body)
    return body


def _without_times(found: re.Match[bytes]) -> bytes:
    return b" ".join((found[1] + b" 0" + found[3]).split())


def text_digest(text: str) -> dict[str, Any]:
    """What is kept of a long text."""
    numbers = NUMBER.findall(text)
    # Not the shape of :func:`split`: the recorded digests keep one blank before a number.
    shape = re.sub(r" +", " ", NUMBER.sub("#", text))
    return {
        "sha256": _sha(text.encode()),
        "bytes": len(text.encode()),
        "shape": _sha(shape.encode()),
        "numbers": len(numbers),
        "sums": sums(np.array([float(number) for number in numbers])),
        "keys": top_keys(text),
    }


def split(text: str) -> tuple[str, list[str]]:
    """A text with ``#`` for every number, runs of blanks made one, and its numbers."""
    return re.sub(r" +", " ", _PLACE.sub("#", text)), NUMBER.findall(text)


def sums(values: Any) -> list[float]:
    """The sum of absolute values, and four weighted sums."""
    finite = np.nan_to_num(np.ravel(values).astype(float), posinf=1e300, neginf=-1e300)
    index = np.arange(len(finite))
    weights = [np.cos(index * math.sqrt(prime)) for prime in (2, 3, 5, 7)]
    return [float(np.abs(finite).sum()), *(float(finite @ one) for one in weights)]


def top_keys(text: str) -> list[str]:
    """Keys of a JSON object, or headings of a text."""
    if text[:1] == "{":
        try:
            return list(json.loads(text))
        except ValueError:
            pass
    return TOP.findall(text)


def _array_digest(body: bytes) -> dict[str, Any]:
    array = np.load(io.BytesIO(body))
    return {
        "sha256": _sha(body),
        "bytes": len(body),
        "shape": f"{array.dtype} {array.shape}",
        "numbers": array.size,
        "sums": sums(array),
    }


def _picture_digest(body: bytes) -> dict[str, Any]:
    """Of a PNG: also its pixels, as another zlib packs them otherwise."""
    data, start = b"", 8
    while start < len(body):
        (size,) = struct.unpack(">I", body[start : start + 4])
        if body[start + 4 : start + 8] == b"IDAT":
            data += body[start + 8 : start + 8 + size]
        start += size + 12
    pixels = zlib.decompress(data) if data else b""
    return {"sha256": _sha(body), "pixels": _sha(body[16:29] + pixels)}


def _sha(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
