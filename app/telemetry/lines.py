"""Log lines: an event each, as JSON or as text. Nothing that a request carries can forge one."""

from __future__ import annotations

import asyncio
import json
import logging
import os
import threading
from abc import abstractmethod
from contextlib import suppress
from contextvars import ContextVar
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any, TextIO

import orjson

LIMIT = 4096
"""Bytes of a line with its end: what the kernel writes to a pipe as a whole, so that the lines of
several processes do not mix."""
PENDING_SECONDS = 0.02
REQUEST_ID: ContextVar[str] = ContextVar("denavit.request_id", default="")
"""Id of the request at work; every line that is written for it carries the id."""


def fields_of(record: logging.LogRecord) -> dict[str, Any]:
    """What a record says, in the order in which it is written.

    ``extra={"fields": {…}}`` of the logging call adds to it.
    """
    fields = head(
        record.created, record.levelname.lower(), record.getMessage().strip(), record.name
    )
    fields.update(getattr(record, "fields", ()))
    if record.exc_info:
        fields["exception"] = logging.Formatter().formatException(record.exc_info)
    return fields


def head(moment: float, level: str, event: str, logger: str) -> dict[str, Any]:
    """The fields of every line.

    Args:
        moment: Seconds since 1970.
        level: Level, in small letters.
        event: What has happened.
        logger: Who says so.
    """
    fields = {
        "time": _time_of(moment),
        "level": level,
        "event": event,
        "logger": logger,
        "pid": os.getpid(),
    }
    request_id = REQUEST_ID.get()
    if request_id:
        fields["request_id"] = request_id
    return fields


class LineFormatter(logging.Formatter):
    """Makes a line of a record, or of fields."""

    def format(self, record: logging.LogRecord) -> str:
        """The line of a record, without its end."""
        return self.line(fields_of(record))

    @abstractmethod
    def line(self, fields: dict[str, Any]) -> str:
        """The line of fields, without its end."""

    def template(self, event: str, logger: str, fields: dict[str, Any]) -> LineTemplate | None:
        """What writes lines of requests that differ in few fields; None: they are made singly.

        Args:
            event: What has happened.
            logger: Who says so.
            fields: Those that are the same in all.
        """
        del event, logger, fields
        return None


class LineTemplate:
    """Lines of requests that differ in time, id, duration and size.

    Args:
        text: One of them, with ``"@"`` for each of these.
    """

    def __init__(self, text: str) -> None:
        before, after_time, after_id, after_duration, end = text.replace("%", "%%").split('"@"')
        self._text = f'{before}"%s"{after_time}"%s"{after_id}%s{after_duration}%d{end}\n'

    def line(self, moment: float, request_id: str, seconds: float, size: int) -> bytes:
        """A line, with its end.

        Args:
            moment: Seconds since 1970.
            request_id: Of letters, digits and ``. _ -``.
            seconds: How long the request took.
            size: Bytes of its answer.
        """
        told = _time_of(moment), request_id, duration_ms(seconds), size
        return (self._text % told).encode("ascii")


def duration_ms(seconds: float) -> float:
    """A duration in ms as lines tell it."""
    return round(seconds * 1e3, 3)


class JSONLine(LineFormatter):
    """A JSON object in ASCII a line: escapes stand for whatever moves a cursor or turns a text."""

    def line(self, fields: dict[str, Any]) -> str:
        """One line."""
        line = _json(fields)
        for key in ("exception", "event"):
            while len(line) >= LIMIT and len(text := fields.get(key, "")) > 80:
                # Of a traceback the end says most, of an event the beginning.
                half = len(text) // 2
                fields[key] = f"...{text[half:]}" if key == "exception" else f"{text[:half]}..."
                line = _json(fields)
        return line

    def template(self, event: str, logger: str, fields: dict[str, Any]) -> LineTemplate:
        """What writes lines of requests, in a tenth of the time."""
        token = REQUEST_ID.set("@")
        try:
            text = self.line(
                head(0.0, "info", event, logger)
                | {"time": "@"}
                | fields
                | {"duration_ms": "@", "bytes": "@"}
            )
        finally:
            REQUEST_ID.reset(token)
        return LineTemplate(text)


class TextLine(LineFormatter):
    """For people: time (UTC), level, event, the rest; a traceback is indented behind a bar."""

    def line(self, fields: dict[str, Any]) -> str:
        """One line, and one for each line of a traceback."""
        rest = [f"{key}={value}" for key, value in fields.items() if key not in _LEADING]
        first = [fields["time"][11:19], fields["level"].upper().ljust(7), fields["event"], *rest]
        lines = [harmless(" ".join(first)[:LIMIT])]
        trace = fields.get("exception", "").split("\n")
        return "\n".join([*lines, *(f"    | {harmless(line)}" for line in trace if line)])


class LineHandler(logging.StreamHandler[TextIO]):
    """Writes lines to a stream: records at once, the many lines of requests a page at a time."""

    def __init__(self, stream: TextIO, formatter: LineFormatter) -> None:
        super().__init__(stream)
        self.setFormatter(formatter)
        self.form = formatter
        self._pending = bytearray()
        self._pending_lock = threading.Lock()

    def emit(self, record: logging.LogRecord) -> None:
        """Writes a record, after what came before it."""
        self.write_pending()
        super().emit(record)

    def write_soon(self, fields: dict[str, Any]) -> None:
        """Writes fields within PENDING_SECONDS; for the event loop, which must be running.

        A record of its own for each request, and a system call, would take five times as long.
        """
        self.write_line_soon(f"{self.form.line(fields)}\n".encode())

    def write_line_soon(self, line: bytes) -> None:
        """Writes a whole line as :meth:`write_soon` does."""
        if len(self._pending) + len(line) > LIMIT:
            self.write_pending()
        with self._pending_lock:
            if not self._pending:
                asyncio.get_running_loop().call_later(PENDING_SECONDS, self.write_pending)
            self._pending += line

    def write_pending(self) -> None:
        """Writes what waits."""
        with self._pending_lock, suppress(OSError, ValueError):
            if self._pending:
                page, self._pending = self._pending, bytearray()
                os.write(self.stream.fileno(), page)

    def close(self) -> None:
        """Writes what waits, and closes the handler."""
        self.write_pending()
        super().close()


_LEADING = {"time", "level", "event", "logger", "pid", "exception"}


def _time_of(moment: float) -> str:
    return f"{_second(int(moment))}.{int(moment % 1 * 1e3):03d}Z"


@lru_cache(maxsize=2)
def _second(moment: int) -> str:
    return datetime.fromtimestamp(moment, UTC).strftime("%Y-%m-%dT%H:%M:%S")


def harmless(text: str) -> str:
    """A text with escapes for control, direction and other unprintable characters."""
    if text.isprintable():
        return text
    return "".join(
        character if character.isprintable() else ascii(character)[1:-1] for character in text
    )


def _json(fields: dict[str, Any]) -> str:
    try:
        line = orjson.dumps(fields, default=str)
    except TypeError:  # a lone surrogate, an integer beyond 64 bits
        line = b"\x7f"
    if line.isascii() and b"\x7f" not in line:
        return line.decode("ascii")
    return json.dumps(fields, default=str, separators=(",", ":")).replace("\x7f", "\\u007f")
