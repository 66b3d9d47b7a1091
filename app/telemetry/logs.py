"""Sends everything that this process says through log lines: also warnings and tracebacks."""

from __future__ import annotations

import logging
import sys
import threading
from types import TracebackType
from typing import Any, Literal

from app.settings import Settings
from app.telemetry import tracing
from app.telemetry.lines import JSONLine, LineHandler, TextLine

LOG = logging.getLogger("denavit")
_OWN = ("denavit", "app", "kinematics", "robots", "dh_to_urdf")
"""Loggers that follow the chosen level; those of libraries start at warnings."""
_TWICE = "Invalid HTTP request received."
"""Uvicorn's word for what ``app.serving.connections`` tells with its status and request id."""


def log_form(settings: Settings) -> Literal["json", "text"]:
    """The form of the lines: where nothing is chosen, text on a terminal and JSON elsewhere."""
    if settings.log_format != "auto":
        return settings.log_format
    return "text" if sys.stderr.isatty() else "json"


def log_to_stderr(settings: Settings) -> None:
    """Makes standard error the place of all log lines of this process, and of nothing else.

    For the process of a server only: it takes over the root logger and the hooks for exceptions
    that nobody handles.
    """
    form = JSONLine() if log_form(settings) == "json" else TextLine()
    handler = LineHandler(sys.stderr, form)
    if tracing.asked_for():
        handler.addFilter(tracing.WithTraceIds())
    root = logging.getLogger()
    for old in root.handlers[:]:
        root.removeHandler(old)
    root.addHandler(handler)
    level = logging.getLevelNamesMapping()[settings.log_level.upper()]
    root.setLevel(max(level, logging.WARNING))
    for name in _OWN:
        logging.getLogger(name).setLevel(level)
    logging.getLogger("uvicorn.error").addFilter(lambda record: record.msg != _TWICE)
    # What logging would look up for each line, and no line shows.
    logging.logThreads = logging.logMultiprocessing = False
    # A log that cannot be written to is no reason to write about it.
    logging.raiseExceptions = False
    logging.captureWarnings(True)
    sys.excepthook = _log_uncaught
    threading.excepthook = _log_uncaught_in_thread
    sys.unraisablehook = _log_unraisable


def _log_uncaught(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    if issubclass(kind, KeyboardInterrupt):
        return
    LOG.critical("uncaught exception", exc_info=(kind, error, trace))


def _log_uncaught_in_thread(given: threading.ExceptHookArgs) -> None:
    error = given.exc_value
    if error is not None and not isinstance(error, SystemExit):
        LOG.error("uncaught exception in a thread", exc_info=error)


def _log_unraisable(given: Any) -> None:
    LOG.error(given.err_msg or "exception ignored", exc_info=given.exc_value)
