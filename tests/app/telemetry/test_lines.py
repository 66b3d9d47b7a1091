"""Lines of the log: one event a line, whatever is in it."""

import json
import logging
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.telemetry.lines import LIMIT, REQUEST_ID, JSONLine, TextLine, duration_ms, head

NASTY = (
    "a\nb",
    "a\r\nb",
    "\x1b[2K\x1b[1A",
    "\x85",
    "\u2028",
    "\u202e evil",
    "\u2066",
    "\x00",
    "\x7f",
    "\x9b31m",
    "\ud800",
    "\U000e0041",
    '{"level":"info"}',
    "\u200f",
    "é",
)
texts = st.one_of(
    st.text(st.characters(exclude_categories=())),
    st.sampled_from(NASTY),
    st.text("\n\x1b}", max_size=9000),
)


def record(event, fields=None, error=None):
    exc_info = (type(error), error, error.__traceback__) if error else None
    made = logging.LogRecord("denavit", logging.WARNING, "", 0, "%s", (event,), exc_info)
    if fields is not None:
        made.fields = fields
    return made


@given(texts, texts)
def test_json_is_one_line_of_ascii_that_says_all(event, value):
    line = JSONLine().format(record(event, {"value": value[:500]}))
    assert len(line) < LIMIT
    assert all(" " <= character <= "~" for character in line)
    found = json.loads(line)
    assert found["value"] == value[:500]
    assert found["level"] == "warning"
    whole = event.strip()
    assert found["event"] == whole or (
        found["event"].endswith("...") and whole.startswith(found["event"][:-3])
    )


@given(texts, texts, texts)
def test_text_has_no_line_that_the_service_did_not_begin(event, value, message):
    try:
        raise ValueError(message)
    except ValueError as error:
        made = record(event, {"value": value}, error)
    first, *rest = TextLine().format(made).split("\n")
    assert first[2] == first[5] == ":"
    assert first[9:16] == "WARNING"
    assert rest
    assert all(line.startswith("    | ") for line in rest)
    assert all(line.isprintable() for line in (first, *rest))


def test_a_traceback_is_one_line_and_keeps_its_end():
    def deep(n):
        if n:
            deep(n - 1)
        raise ValueError("the\ncause" + "x" * 50)

    try:
        sys.setrecursionlimit(3000)
        deep(500)
    except ValueError as error:
        line = JSONLine().format(record("failed", error=error))
    assert "\n" not in line
    assert len(line) < LIMIT
    assert json.loads(line)["exception"].endswith("ValueError: the\ncause" + "x" * 50)


@pytest.mark.parametrize("value", [10**30, float("nan"), object(), b"x", {1, 2}, {"a": {"b": 1}}])
def test_any_value_can_be_written(value):
    assert json.loads(JSONLine().format(record("x", {"value": value})))["event"] == "x"


def test_a_request_is_named_in_every_line_of_its_own():
    token = REQUEST_ID.set("abc-1")
    try:
        assert json.loads(JSONLine().format(record("x")))["request_id"] == "abc-1"
        assert "request_id=abc-1" in TextLine().format(record("x"))
    finally:
        REQUEST_ID.reset(token)
    assert "request_id" not in json.loads(JSONLine().format(record("x")))


@given(st.floats(0, 2e9), st.floats(0, 1e4), st.integers(0, 2**40))
def test_a_template_writes_the_lines_that_are_made_singly(moment, seconds, size):
    fields = {"method": "POST", "route": "/v1/robots/{robot_id}/100%/fk", "status": 200}
    template = JSONLine().template("request", "denavit.access", fields)
    token = REQUEST_ID.set("abc-1")
    try:
        every = head(moment, "info", "request", "denavit.access") | fields
        single = JSONLine().line(every | {"duration_ms": duration_ms(seconds), "bytes": size})
    finally:
        REQUEST_ID.reset(token)
    assert template.line(moment, "abc-1", seconds, size) == f"{single}\n".encode()
