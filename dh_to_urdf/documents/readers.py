"""Readers of JSON, YAML 1.2 and CSV -> :class:`DHTable`."""

from __future__ import annotations

import csv
import json
import re
from collections import Counter
from collections.abc import Mapping
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.events import (
    AliasEvent,
    CollectionEndEvent,
    CollectionStartEvent,
    DocumentStartEvent,
    ScalarEvent,
)

from dh_to_urdf.cells.decimal_commas import are_decimal, with_points
from dh_to_urdf.documents.csv_words import column_of, type_of
from dh_to_urdf.documents.limits import LIMIT_FIELDS
from dh_to_urdf.documents.mapping import DEFAULT_NAME, read_mapping
from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.table import DHTable

MAX_COLUMNS = 32
MAX_YAML_BYTES = 64_000
MAX_YAML_DEPTH = 16
MAX_YAML_EVENTS = 12_000
"""Keys, values, lists and mappings; a table of 300 full rows has fewer."""
_NO_NUMBER = re.compile(
    r"(?=.*_|[-+]?0b)[-+]?"
    r"(?:0b[01_]+|0o[0-7_]+|0x[0-9a-f_]+|[0-9][0-9_]*(?:\.[0-9_]*)?(?:e[-+]?[0-9_]+)?)",
    re.IGNORECASE,
)
"""Numbers of YAML 1.1 that the parser accepts and YAML 1.2 does not have: 1_000, 0b11."""
_SYNTAX = {
    "Expecting value": say("expecting value"),
    "Expecting property name enclosed in double quotes": say(
        "expecting property name enclosed in double quotes"
    ),
    "Expecting ',' delimiter": say("expecting ',' delimiter"),
    "Expecting ':' delimiter": say("expecting ':' delimiter"),
    "Extra data": say("extra data"),
    "Unterminated string starting at": say("unterminated string starting at"),
    "Invalid control character at": say("invalid control character at"),
    "Invalid \\escape": say("invalid \\escape"),
    "Invalid \\uXXXX escape": say("invalid \\uXXXX escape"),
    "Illegal trailing comma before end of object": say(
        "illegal trailing comma before end of object"
    ),
    "Illegal trailing comma before end of array": say("illegal trailing comma before end of array"),
}
"""What the JSON parser says of a text, in our words."""
_CSV = {
    "unexpected end of data": say("unexpected end of data"),
    "line contains NUL": say("line contains NUL"),
    "',' expected after '\"'": say("',' expected after '\"'"),
    "';' expected after '\"'": say("';' expected after '\"'"),
    "'\t' expected after '\"'": say("'\t' expected after '\"'"),
}
"""What the CSV parser says of a text, likewise."""


def read_json(text: str | bytes, default_name: str | None = DEFAULT_NAME) -> DHTable:
    """Read a table from JSON.

    Args:
        text: The JSON text, UTF-8 if bytes.
        default_name: Name for a table that gives none; None requires one.

    Raises:
        DHError: Not JSON, or not a usable table.
    """
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise DHSyntaxError.single(
                (), say("the text is not JSON: it is not UTF-8; save it so")
            ) from None
    if not text.strip():
        raise DHSyntaxError.single((), say("the text is not JSON: it is empty; send a table"))
    if text.startswith("\ufeff"):
        raise DHSyntaxError.single(
            (), say("the text is not JSON: it starts with a byte order mark too many; remove it")
        )
    try:
        data = json.loads(text, object_pairs_hook=_no_duplicates)
    except DHError:
        raise
    except (ValueError, RecursionError) as error:
        reason = (
            say(
                "line {lineno}, column {colno}: {msg}",
                lineno=error.lineno,
                colno=error.colno,
                msg=_syntax_fault(error.msg),
            )
            if isinstance(error, json.JSONDecodeError)
            else say("it is nested too deeply")
            if isinstance(error, RecursionError)
            else say("it holds a text or number that cannot be read")
        )
        raise DHSyntaxError.single(
            (), say("the text is not JSON: {reason}", reason=reason)
        ) from None
    return read_mapping(data, default_name)


def read_yaml(text: str | bytes, default_name: str | None = DEFAULT_NAME) -> DHTable:
    """Read a table from YAML 1.2; duplicate keys, tags and several documents are refused.

    Args:
        text: The YAML text.
        default_name: Name for a table that gives none; None requires one.

    Raises:
        DHError: Not YAML, or not a usable table.
    """
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise DHSyntaxError.single((), say("the text is not YAML: it is not UTF-8")) from None
    try:
        _refuse_costly_yaml(text)
        data = YAML(typ="safe", pure=True).load(text)
    except DHError:
        raise
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = (
            say("line {line}, column {column}: ", line=mark.line + 1, column=mark.column + 1)
            if mark
            else ""
        )
        problem = _printable((error.problem or say("malformed")).splitlines()[0])[:120]
        raise DHSyntaxError.single(
            (), say("the text is not YAML: {place}{problem}", place=place, problem=problem)
        ) from None
    except Exception:  # tags and escapes raise any error of int() and chr()
        raise DHSyntaxError.single(
            (), say("the text is not YAML of plain keys and values")
        ) from None
    return read_mapping(data, default_name)


def _refuse_costly_yaml(text: str) -> None:
    """Refuse YAML that takes exponential time to parse: aliases, deep nesting.

    Events are read one by one, so that reading stops where the text becomes too deep.
    """
    if len(text) > MAX_YAML_BYTES:
        raise DHError.single(
            (),
            say(
                "the YAML text is longer than {max_yaml_bytes} characters",
                max_yaml_bytes=MAX_YAML_BYTES,
            ),
        )
    depth = 0
    for number, event in enumerate(YAML(typ="safe", pure=True).parse(text)):
        if number > MAX_YAML_EVENTS:
            raise DHError.single(
                (),
                say(
                    "the YAML text has over {max_yaml_events} keys and values",
                    max_yaml_events=MAX_YAML_EVENTS,
                ),
            )
        if isinstance(event, AliasEvent):
            raise DHSyntaxError.single((), say("the YAML text has an alias (*name); write it out"))
        _refuse_other_yaml(event)
        if isinstance(event, CollectionStartEvent):
            depth += 1
        elif isinstance(event, CollectionEndEvent):
            depth -= 1
        if depth > MAX_YAML_DEPTH:
            raise DHSyntaxError.single((), say("the YAML text is nested too deeply"))


def _refuse_other_yaml(event: object) -> None:
    """Refuse what another version of YAML reads as another table."""
    if isinstance(event, DocumentStartEvent) and event.version not in (None, (1, 2)):
        raise DHSyntaxError.single(
            (),
            say("the text says that it is YAML 1.1, but YAML 1.2 is read here; remove %YAML 1.1"),
        )
    if not isinstance(event, ScalarEvent) or (event.style and event.tag is None):
        return
    line = event.start_mark.line + 1
    if event.value == "<<":
        raise DHSyntaxError.single(
            (), say("line {line} of the YAML text merges keys (<<); write them out", line=line)
        )
    if _NO_NUMBER.fullmatch(event.value):
        raise DHSyntaxError.single(
            (),
            say(
                "line {line} of the YAML text has {event}, which is no number in YAML"
                " 1.2; write it in digits 0 to 9 without _, or a text in quotes",
                line=line,
                event=quoted(event.value),
            ),
        )


def read_csv(
    text: str | bytes,
    convention: str | None,
    name: str | None = None,
    angle: str = "rad",
    length: str = "m",
    values: Mapping[str, Any] | None = None,
) -> DHTable:
    """Read a table from CSV with a header line and one line a joint.

    Columns: ``name,type,alpha,a,d,theta,offset,sign,lower,upper,velocity,effort``; in khalil
    ``ant,sigma,mu,gamma,b,alpha,d,theta,r``; or their names in another language, as
    :func:`~dh_to_urdf.documents.layouts.to_csv` writes them. Separated by commas, semicolons or
    tabs.

    Args:
        text: The CSV text, UTF-8 if bytes.
        convention: What the rows mean; required.
        name: Name of the robot.
        angle: Unit of plain angles, ``rad`` or ``deg``.
        length: Unit of plain lengths, ``m`` or ``mm``.
        values: Numbers for the names in the cells.

    Raises:
        DHError: Not a usable table.
    """
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise DHError.single((), say("the CSV text is not UTF-8")) from None
    numbered = enumerate(text.lstrip("\ufeff").splitlines(), start=1)
    lines = {number: line for number, line in numbered if line.strip()}
    if not lines:
        raise DHError.single((), say("the CSV text is empty; its first line names the columns"))
    header, *records = _records(lines)
    columns = [column_of(column.strip().lower()) for column in header]
    if len(columns) > MAX_COLUMNS:
        raise DHError.single(
            (), say("the CSV header has {count} columns; see README for them", count=len(columns))
        )
    twice, count = Counter(columns).most_common(1)[0]
    if count > 1:
        raise DHError.single((), say("the CSV header names {twice} twice", twice=quoted(twice)))
    if "," not in _separator(lines):
        french = any(column_of(word.strip().lower()) != word.strip().lower() for word in header)
        if french or are_decimal(cell for record in records for cell in record):
            records = [[with_points(cell) for cell in record] for record in records]
    rows = []
    for number, (line, record) in enumerate(zip(list(lines)[1:], records, strict=True)):
        if len(record) != len(columns):
            raise DHError.single(
                ("joints", number),
                say(
                    "line {line} has {count} cells under {count_2} columns; quote a cell"
                    " with a decimal comma, or separate cells by semicolons",
                    line=line,
                    count=len(record),
                    count_2=len(columns),
                ),
            )
        cells = zip(columns, (cell.strip() for cell in record), strict=True)
        row: dict[str, Any] = {column: cell for column, cell in cells if cell != ""}
        if "type" in row:
            row["type"] = type_of(row["type"])
        limits = {key: row.pop(key) for key in LIMIT_FIELDS if key in row}
        if limits:
            row["limits"] = limits
        rows.append(row)
    document: dict[str, Any] = {"units": {"angle": angle, "length": length}, "joints": rows}
    if convention is not None:
        document["convention"] = convention
    if values is not None:
        document["values"] = values
    if name:
        document["name"] = name
    return read_mapping(document, None if name == "" else DEFAULT_NAME, tuple(columns))


def _separator(lines: Mapping[int, str]) -> str:
    """Return what separates the cells of the header."""
    return max(",;\t", key=next(iter(lines.values())).count)


def _records(lines: Mapping[int, str]) -> list[list[str]]:
    """Split the lines into cells; refuse a quoted cell that goes on in the next line."""
    numbers, texts = list(lines), list(lines.values())
    reader = csv.reader(texts, delimiter=_separator(lines), strict=True, skipinitialspace=True)
    records: list[list[str]] = []
    try:
        for record in reader:
            if reader.line_num > len(records) + 1:
                raise DHSyntaxError.single(
                    (),
                    say(
                        "the text is not CSV: line {number} has a quoted cell that goes on in"
                        " the next line; write each row on one line",
                        number=numbers[len(records)],
                    ),
                )
            records.append(record)
    except csv.Error as error:
        raise DHSyntaxError.single(
            (),
            say(
                "the text is not CSV: {error}", error=_CSV.get(str(error)) or _printable(str(error))
            ),
        ) from None
    return records


def _syntax_fault(words: str) -> str:
    """Return what the JSON parser says, as a message where it is one that is known."""
    return _SYNTAX.get(words, words[:1].lower() + words[1:])


def _printable(text: str) -> str:
    return "".join(character if character.isprintable() else "?" for character in text)


def _no_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) != len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        raise DHError.single(
            (), say("the key {twice} stands twice in one object; keep one", twice=quoted(twice))
        )
    return mapping
