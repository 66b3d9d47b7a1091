"""JSON bodies -> typed values: strict, in pieces where they are large, refused with the place."""

from __future__ import annotations

import json
import re
from collections.abc import Hashable
from functools import cache
from itertools import chain
from typing import Any, TypeVar, cast

import msgspec
import numpy as np

from app.http.decoder_words import words_of_text, words_of_value
from app.http.pointers import escaped
from app.http.problems import INVALID_REQUEST, MALFORMED_BODY, TOO_LARGE, RequestProblem
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from kinematics.deadline import checkpoint
from robots.robot import FloatArray

T = TypeVar("T")

PIECE = 100_000
"""Bytes of JSON that are decoded at once: the decoder lets no other thread run meanwhile."""
MAX_FIELD = 1_000_000
"""Bytes of a field that is no batch of numbers."""
MAX_TEXTS = 200_000
"""Texts and keys in one body."""
_WINDOW = 4_000_000

_PATH = re.compile(r" - at `([^`]*)`$")
_ROW_END = re.compile(rb"\][ \t\r\n]*,")
_STRING = re.compile(rb'"((?:[^"\\]|\\.)*+)"', re.DOTALL)
_SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")
_INDEX = re.compile(r"\[(\d+)\]")


class RowLengthError(Exception):
    """A row of a batch that has another length than the others must have."""

    def __init__(self, index: int, row: list[float]) -> None:
        super().__init__(index)
        self.index, self.row = index, row


def decode_body(body: bytes, type_: type[T]) -> T:
    """A body as a typed value, with no key twice in one object.

    Raises:
        RequestProblem: 400 for text that is no JSON, 413 for more texts than a request needs, 422
            with a pointer for a wrong type or a doubled key.
    """
    if len(body) > MAX_FIELD:
        check_texts(body)
    value = decode_json(body, type_)
    refuse_doubled_keys(body)
    return value


def decode_json(body: bytes | msgspec.Raw, type_: type[T], pointer: str = "") -> T:
    """Strict JSON -> a typed value; keys may stand twice, see :func:`refuse_doubled_keys`.

    Raises:
        RequestProblem: 400 for text that is no JSON, 422 with a pointer for a wrong type.
    """
    try:
        value: T = _decoder(cast(Hashable, type_)).decode(body)
    except msgspec.ValidationError as error:
        raise validation_problem(error, pointer, getattr(type_, "__struct_fields__", ())) from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RequestProblem(
            MALFORMED_BODY,
            say("the body is not JSON: {reason}", reason=_reason(bytes(body), error)),
            pointer,
        ) from None
    except RecursionError:
        raise RequestProblem(
            MALFORMED_BODY, say("the body is nested too deeply"), pointer
        ) from None
    return value


@cache
def _decoder(type_: Hashable) -> msgspec.json.Decoder[Any]:
    return msgspec.json.Decoder(type_)


def _reason(body: bytes, error: Exception) -> str:
    """Why a text is no JSON, and what to send."""
    if not body.strip():
        return say('it is empty; send an object such as {{"q": [0, 0.5]}}')
    if body[:3] == b"\xef\xbb\xbf" or body[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in body[:4]:
        return say("JSON is UTF-8 without a byte order mark; save it so")
    if isinstance(error, UnicodeDecodeError):
        return say("a text in it is not UTF-8; JSON is UTF-8")
    if "truncated" in str(error):
        if _SURROGATE.search(body):
            return say(
                "it holds one half of a surrogate pair (\\ud800 to \\udfff), or ends too early"
            )
        return say("it ends too early; close every bracket and text")
    return words_of_text(str(error)[:160])


def refuse_doubled_keys(text: bytes, pointer: str = "") -> None:
    """Refuses an object with a key twice, of which decoders keep one without a word.

    Args:
        text: Valid JSON.
        pointer: Where it stands in the body.

    Raises:
        RequestProblem: 422; the pointer names the key where the text is short.
    """
    escapes = b"\\" in text
    parts = _STRING.split(text) if escapes else text.split(b'"')
    strings = parts[1::2]
    # Where all texts differ, and they are as good as always few, all keys do.
    if not escapes and len(set(strings)) == len(strings):
        return
    objects: list[set[bytes]] = []
    for before, string, after in zip(parts[:-1:2], strings, parts[2::2], strict=True):
        if b"{" in before or b"}" in before:
            for mark in re.findall(rb"[{}]", before):
                if mark == b"{":
                    objects.append(set())
                else:
                    objects.pop()
        if after.lstrip()[:1] == b":":
            key = json.loads(b'"' + string + b'"').encode() if b"\\" in string else string
            if key in objects[-1]:
                name = quoted(key.decode())
                raise RequestProblem(
                    INVALID_REQUEST,
                    say("the key {name} stands twice in one object; keep one", name=name),
                    pointer + _place_of_double(text),
                )
            objects[-1].add(key)


class _Double:
    """Stands in for an object with a doubled key."""

    def __init__(self, key: str) -> None:
        self.key = key


def _place_of_double(text: bytes) -> str:
    """JSON pointer to the first doubled key; empty for a text so long that it would take time."""
    if len(text) > MAX_FIELD:
        return ""

    def pairs(found: list[tuple[str, Any]]) -> Any:
        keys: set[str] = set()
        for key, value in found:
            if isinstance(value, _Double):
                break
            if key in keys:
                return _Double(key)
            keys.add(key)
        return dict(found)

    def search(value: Any) -> str | None:
        if isinstance(value, _Double):
            return f"/{escaped(value.key)}"
        if not isinstance(value, (dict, list)):
            return None
        items = value.items() if isinstance(value, dict) else enumerate(value)
        below = ((key, search(one)) for key, one in items)
        return next((f"/{escaped(key)}{place}" for key, place in below if place), None)

    return search(json.loads(text, object_pairs_hook=pairs)) or ""


def check_texts(body: bytes) -> None:
    """Refuses a large body with more texts and keys than any request needs, window by window.

    Raises:
        RequestProblem: 413.
    """
    quotes = 0
    for start in range(0, len(body), _WINDOW):
        quotes += body.count(b'"', start, start + _WINDOW)
        if quotes > 2 * MAX_TEXTS:
            raise RequestProblem(
                TOO_LARGE,
                say(
                    "the body holds over {max_texts} texts and keys; send it in parts,"
                    " numbers as lists of lists",
                    max_texts=MAX_TEXTS,
                ),
            )


def check_fields(body: bytes, most: dict[str, int]) -> None:
    """Refuses a large body in which a field has bytes that no good value of it needs.

    Args:
        body: JSON.
        most: Bytes of the fields that may have more than ``MAX_FIELD``.

    Raises:
        RequestProblem: 413; the pointer names the field.
    """
    check_texts(body)
    for name, raw in decode_json(body, dict[str, msgspec.Raw]).items():
        size, limit = memoryview(raw).nbytes, most.get(name, MAX_FIELD)
        if size > limit:
            raise RequestProblem(
                TOO_LARGE,
                say(
                    "the field {name} has {size} bytes; at most {limit} are read here, send"
                    " it in parts",
                    name=quoted(name),
                    size=size,
                    limit=limit,
                ),
                f"/{escaped(name)}",
            )


def decode_rows(text: bytes, pointer: str, columns: int, most: int) -> FloatArray:
    """JSON rows of numbers -> an array, piece by piece, so that other threads get a turn.

    Args:
        text: A JSON list.
        pointer: Where it stands in the body.
        columns: Numbers in a row.
        most: Rows that are read.

    Returns:
        Shape (n, columns).

    Raises:
        RowLengthError: A row has another length.
        RequestProblem: Not rows of numbers; the pointer names the value. Or too many.
    """
    pieces: list[FloatArray] = []
    start, end, done = 1, text.rfind(b"]"), 0
    while start < end:
        checkpoint()
        cut = _ROW_END.search(text, start + PIECE, end)
        stop = cut.start() + 1 if cut else end
        if stop - start > PIECE + MAX_FIELD:
            raise RequestProblem(
                INVALID_REQUEST,
                say(
                    "a row has over {max_field} bytes; give {columns} numbers",
                    max_field=MAX_FIELD,
                    columns=columns,
                ),
                f"{pointer}/{done}",
            )
        try:
            part = b"[" + text[start:stop] + b"]"
            rows = msgspec.json.decode(part, type=list[list[float]])
        except msgspec.ValidationError as error:
            raise validation_problem(error, pointer, skipped=done) from None
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            raise RequestProblem(
                INVALID_REQUEST,
                say("not rows of numbers; give lists of numbers"),
                f"{pointer}/{done}",
            ) from None
        if set(map(len, rows)) - {columns}:
            odd = next(k for k, row in enumerate(rows) if len(row) != columns)
            raise RowLengthError(done + odd, rows[odd])
        done += len(rows)
        if done > most:
            name = pointer.rsplit("/", 1)[-1]
            raise RequestProblem(
                INVALID_REQUEST,
                say("{name} holds over {most} rows; give 1 to {most}", name=name, most=most),
                pointer,
            )
        numbers = np.fromiter(chain.from_iterable(rows), np.float64, len(rows) * columns)
        pieces.append(numbers.reshape(-1, columns))
        start = cut.end() if cut else end
    return np.concatenate(pieces) if pieces else np.empty((0, columns))


def decode_numbers(text: bytes, pointer: str) -> list[float]:
    """A JSON list of a few numbers.

    Raises:
        RequestProblem: Not numbers, or far more than any robot has joints.
    """
    if len(text) > PIECE:
        name = pointer.rsplit("/", 1)[-1]
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "{name} is one list of {count} bytes; give one number a joint or row,"
                " batches as a list of lists",
                name=name,
                count=len(text),
            ),
            pointer,
        )
    return decode_json(text, list[float], pointer)


def validation_problem(
    error: msgspec.ValidationError, pointer: str = "", known: tuple[str, ...] = (), skipped: int = 0
) -> RequestProblem:
    """A problem from msgspec's message, whose path becomes a JSON pointer.

    Args:
        error: What msgspec says.
        pointer: Where the value stands in the body.
        known: Fields that the value may have.
        skipped: Items of the list before the first that was decoded.
    """
    text = str(error)
    match = _PATH.search(text)
    path = match[1] if match else "$"
    message = _PATH.sub("", text).replace("`", "")
    if skipped:
        path = _INDEX.sub(lambda index: f"[{int(index[1]) + skipped}]", path, count=1)
    found = pointer + pointer_of_path(path)
    unknown = re.search(r"Object contains unknown field (.+)$", message, re.DOTALL)
    if unknown:
        field = unknown[1]
        remedy = say("; known are {known}", known=", ".join(known)) if known and path == "$" else ""
        return RequestProblem(
            INVALID_REQUEST,
            say("unknown field {field!r}{remedy}", field=field[:64], remedy=remedy),
            f"{found}/{escaped(field)}",
        )
    missing = re.search(r"Object missing required field (.+)$", message)
    if missing:
        return RequestProblem(
            INVALID_REQUEST,
            say("the field {missing!r} is missing; give it", missing=missing[1]),
            f"{found}/{missing[1]}",
        )
    where = say("{place}: ", place=found.removeprefix("/")) if found else say("the body: ")
    return RequestProblem(INVALID_REQUEST, where + words_of_value(message), found)


def pointer_of_path(path: str) -> str:
    """Return a path of msgspec as a JSON pointer: ``$.joints[2].alpha`` -> ``/joints/2/alpha``."""
    known = path.removeprefix("$").partition("[...]")[0]
    return _INDEX.sub(r"/\1", known).replace(".", "/")
