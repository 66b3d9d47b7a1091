"""Texts -> :class:`DHTable`: JSON, YAML 1.2 and CSV."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Mapping
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent

from dh_to_urdf.documents.mapping import DEFAULT_NAME, read_mapping
from dh_to_urdf.documents.rows import LIMIT_FIELDS
from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.table import DHTable

MAX_COLUMNS = 32
MAX_YAML_BYTES = 64_000
MAX_YAML_DEPTH = 16
MAX_YAML_EVENTS = 12_000
"""Keys, values, lists and mappings; a table of 300 full rows has fewer."""


def read_json(text: str | bytes, default_name: str | None = DEFAULT_NAME) -> DHTable:
    """Reads a table from JSON.

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
                "", "the text is not JSON: it is not UTF-8; save it so"
            ) from None
    if not text.strip():
        raise DHSyntaxError.single("", "the text is not JSON: it is empty; send a table")
    try:
        data = json.loads(text, object_pairs_hook=_no_duplicates)
    except DHError:
        raise
    except (ValueError, RecursionError) as error:
        reason = (
            f"line {error.lineno}, column {error.colno}: {_decapitalised(error.msg)}"
            if isinstance(error, json.JSONDecodeError)
            else "it is nested too deeply"
            if isinstance(error, RecursionError)
            else "it holds a text or number that cannot be read"
        )
        raise DHSyntaxError.single("", f"the text is not JSON: {reason}") from None
    return read_mapping(data, default_name)


def read_yaml(text: str | bytes, default_name: str | None = DEFAULT_NAME) -> DHTable:
    """Reads a table from YAML 1.2; duplicate keys, tags and several documents are refused.

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
            raise DHSyntaxError.single("", "the text is not YAML: it is not UTF-8") from None
    try:
        _refuse_costly_yaml(text)
        data = YAML(typ="safe", pure=True).load(text)
    except DHError:
        raise
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        problem = _printable((error.problem or "malformed").splitlines()[0])[:120]
        raise DHSyntaxError.single("", f"the text is not YAML: {place}{problem}") from None
    except Exception:  # tags and escapes make the constructor raise whatever int() or chr() do
        raise DHSyntaxError.single("", "the text is not YAML of plain keys and values") from None
    return read_mapping(data, default_name)


def _refuse_costly_yaml(text: str) -> None:
    """Refuses what takes the parser exponential time and no table needs: aliases, deep nesting.

    The events are read one by one, so that a deep text is given up where it becomes too deep.
    """
    if len(text) > MAX_YAML_BYTES:
        raise DHError.single("", f"the YAML text is longer than {MAX_YAML_BYTES} characters")
    depth = 0
    for number, event in enumerate(YAML(typ="safe", pure=True).parse(text)):
        if number > MAX_YAML_EVENTS:
            raise DHError.single("", f"the YAML text has over {MAX_YAML_EVENTS} keys and values")
        if isinstance(event, AliasEvent):
            raise DHSyntaxError.single("", "the YAML text has an alias (*name); write it out")
        if isinstance(event, CollectionStartEvent):
            depth += 1
        elif isinstance(event, CollectionEndEvent):
            depth -= 1
        if depth > MAX_YAML_DEPTH:
            raise DHSyntaxError.single("", "the YAML text is nested too deeply")


def read_csv(
    text: str | bytes,
    convention: str | None,
    name: str | None = None,
    angle: str = "rad",
    length: str = "m",
    values: Mapping[str, Any] | None = None,
) -> DHTable:
    """Reads a table from CSV with a header line and one line a joint.

    Columns: ``name,type,alpha,a,d,theta,offset,sign,lower,upper,velocity,effort``; in khalil
    ``ant,sigma,mu,gamma,b,alpha,d,theta,r``. Separated by commas, semicolons or tabs.

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
            raise DHError.single("", "the CSV text is not UTF-8") from None
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip()]
    if not lines:
        raise DHError.single("", "the CSV text is empty; its first line names the columns")
    separator = max(",;\t", key=lines[0].count)
    try:
        header, *records = csv.reader(
            lines, delimiter=separator, strict=True, skipinitialspace=True
        )
    except csv.Error as error:
        raise DHSyntaxError.single("", f"the text is not CSV: {_printable(str(error))}") from None
    columns = [column.strip().lower() for column in header]
    if len(columns) > MAX_COLUMNS:
        raise DHError.single("", f"the CSV header has {len(columns)} columns; see README for them")
    twice, count = Counter(columns).most_common(1)[0]
    if count > 1:
        raise DHError.single("", f"the CSV header names {quoted(twice)} twice")
    rows = []
    for number, record in enumerate(records):
        if len(record) != len(columns):
            raise DHError.single(
                f"/joints/{number}",
                f"line {number + 2} has {len(record)} cells under {len(columns)} columns; quote a"
                " cell with a decimal comma, or separate cells by semicolons",
            )
        cells = zip(columns, (cell.strip() for cell in record), strict=True)
        row: dict[str, Any] = {column: cell for column, cell in cells if cell != ""}
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


def _decapitalised(text: str) -> str:
    return text[:1].lower() + text[1:]


def _printable(text: str) -> str:
    return "".join(character if character.isprintable() else "?" for character in text)


def _no_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) != len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        raise DHError.single("", f"the key {quoted(twice)} stands twice in one object; keep one")
    return mapping
