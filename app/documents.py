"""Robot documents of requests -> Robot: D-H tables in every format, and URDF."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from email.message import EmailMessage
from typing import Any

from fastapi import Request

from app.http.negotiation import media_type, unsupported
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import check_query
from dh_to_urdf import (
    DHError,
    read_csv,
    read_json,
    read_mapping,
    read_par,
    read_pasted,
    read_spreadsheet,
    read_yaml,
    split_values,
)
from dh_to_urdf.encodings import decoded
from dh_to_urdf.errors import Fault
from dh_to_urdf.messages import say
from dh_to_urdf.par.text import MAX_PAR_LENGTH
from dh_to_urdf.pasted.workbooks import WORKBOOK_BYTES
from robots.errors import InvalidURDF, RobotTooLarge, UnknownFrame
from robots.robot import Robot, robot_from_table, robot_from_urdf

JSON_TYPES = ("application/json",)
YAML_TYPES = ("application/yaml", "application/x-yaml", "text/yaml", "text/x-yaml")
CSV_TYPES = ("text/csv",)
PAR_TYPES = ("text/x-symoro", "application/x-symoro")
PASTED_TYPES = (
    "text/plain",
    "text/markdown",
    "text/tab-separated-values",
    "text/x-tex",
    "application/x-tex",
    "application/x-latex",
    "text/x-matlab",
    "text/x-python",
    "text/html",
)
SPREADSHEET_TYPES = (
    "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "application/vnd.oasis.opendocument.spreadsheet",
)
DECODED_TYPES = (*CSV_TYPES, *PAR_TYPES, *PASTED_TYPES)
"""Texts that may be in another encoding than UTF-8, which ``charset`` names."""
BINARY = {"type": "string", "format": "binary"}
"""Schema of a body of bytes."""
ARCHIVE_TYPES = ("application/zip", "application/x-zip-compressed")
XML_TYPES = ("application/xml", "text/xml", "application/urdf+xml")
TABLES = (
    "application/json",
    "application/yaml",
    "text/csv",
    "text/x-symoro",
    "text/plain",
    *SPREADSHEET_TYPES,
)
ACCEPTED = (*TABLES, "application/xml")

_NOT_ID = re.compile(r"[^A-Za-z0-9._-]+")


def robot_from_body(
    request: Request, body: bytes, default_name: str | None, also: tuple[str, ...] = ()
) -> Robot:
    """Reads the robot of a request by its content type.

    Args:
        request: Says the content type and the parameters that some of them need.
        body: The document.
        default_name: Name for a table that says none; None requires one.
        also: Query parameters that the route itself reads.

    Raises:
        DHError: Not a usable table.
        RobotError: Not a usable URDF.
        RequestProblem: Another content type, or unknown parameters.
    """
    kind, query = media_type(request), request.query_params
    if kind in XML_TYPES:
        check_query(request, "tip", "base", "name", *also, common=("format", "lang"))
        return robot_from_urdf(body, base=query.get("base"), tip=query.get("tip"))
    if kind in CSV_TYPES:
        check_query(request, "convention", "name", "length", "values", *also)
        name = query.get("name", default_name or "")
        angle, length = query.get("angle", "rad"), query.get("length", "m")
        text, warnings = decoded(body, _charset(request), max(1, len(body)))
        table = read_csv(text, query.get("convention"), name, angle, length, _values(request))
        return robot_from_table(replace(table, warnings=(*warnings, *table.warnings)))
    if kind in PAR_TYPES:
        check_query(request, "name", "values", "loops", *also, common=("format", "lang"))
        charset = _charset(request)
        return robot_from_table(
            read_par(
                body if charset is None else decoded(body, charset, MAX_PAR_LENGTH)[0],
                query.get("name"),
                _values(request),
                cut_loops=_cut_loops(request),
                default_name=default_name,
            )
        )
    if kind in (*PASTED_TYPES, *SPREADSHEET_TYPES):
        check_query(request, "convention", "name", "length", "values", "columns", *also)
        given = (
            query.get("convention"),
            query.get("name"),
            query.get("angle"),
            query.get("length"),
            _values(request),
            query.get("columns"),
            default_name,
        )
        if kind in SPREADSHEET_TYPES:
            return robot_from_table(read_spreadsheet(body, *given))
        return robot_from_table(read_pasted(body, *given, _charset(request)))
    if kind not in (*JSON_TYPES, *YAML_TYPES):
        raise unsupported(kind, ACCEPTED)
    check_query(request, "name", *also, common=("format", "lang"))
    default_name = query.get("name", default_name)
    read = read_json if kind in JSON_TYPES else read_yaml
    return robot_from_table(read(body, default_name))


def memory_beside(request: Request) -> int:
    """Return the bytes that reading the robot of a request takes whatever its size."""
    return WORKBOOK_BYTES if media_type(request) in SPREADSHEET_TYPES else 0


def _charset(request: Request) -> str | None:
    """Return the ``charset`` of a request's content type; None where it names none."""
    message = EmailMessage()
    message["Content-Type"] = request.headers.get("content-type", "")
    return message.get_content_charset()


def _values(request: Request) -> dict[str, str] | None:
    """``?values=D3:0.45,RL4:450mm``: numbers for the names in the cells."""
    text = request.query_params.get("values")
    return None if text is None else split_values(text)


def _cut_loops(request: Request) -> bool:
    """``?loops=cut``: the spanning tree of a robot with closed loops."""
    text = request.query_params.get("loops")
    if text not in (None, "cut"):
        raise RequestProblem(
            INVALID_REQUEST,
            say("loops is {text!r}; give cut, or leave it out", text=text[:32]),
            "/loops",
        )
    return text == "cut"


def robot_from_inline(document: Mapping[str, Any]) -> Robot:
    """The robot of ``"robot": {…}`` in a body: a table, or ``{"urdf": text, "base", "tip"}``.

    Raises:
        DHError: Not a usable table; locations start at ``robot``.
        RobotError: Not a usable URDF.
    """
    if "urdf" in document:
        for key, value in document.items():
            if key not in ("urdf", "base", "tip", "name") or not isinstance(value, str):
                raise DHError.single(("robot", key), say("give urdf, base and tip as texts"))
    try:
        if "urdf" not in document:
            return robot_from_table(read_mapping(document))
        return robot_from_urdf(document["urdf"], base=document.get("base"), tip=document.get("tip"))
    except DHError as error:
        faults = [Fault(("robot", *one.location), one.message) for one in error.faults]
        raise DHError(faults) from None
    except UnknownFrame as error:
        index = (error.argument, *error.index)
        raise UnknownFrame(error.name, error.valid, "robot", index) from None
    except (InvalidURDF, RobotTooLarge) as error:
        within = ("urdf",) if "urdf" in document else error.location
        raise error.within(("robot", *within)) from None


def id_from_name(name: str) -> str:
    """A robot's id from its name: other characters than letters, digits, ``. _ -`` become ``-``."""
    return _NOT_ID.sub("-", name).strip("-.")
