"""Robot documents of requests -> Robot: D-H tables as JSON, YAML or CSV, and URDF."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from fastapi import Request

from app.query import check_query
from app.wire import media_type, unsupported
from dh_to_urdf import DHError, read_csv, read_json, read_mapping, read_yaml
from robots.errors import InvalidURDF
from robots.robot import Robot, robot_from_table, robot_from_urdf

JSON_TYPES = ("application/json",)
YAML_TYPES = ("application/yaml", "application/x-yaml", "text/yaml", "text/x-yaml")
CSV_TYPES = ("text/csv",)
XML_TYPES = ("application/xml", "text/xml", "application/urdf+xml")
ACCEPTED = ("application/json", "application/yaml", "text/csv", "application/xml")

_NOT_ID = re.compile(r"[^A-Za-z0-9._-]+")


def robot_from_body(
    request: Request, body: bytes, default_name: str | None, also: tuple[str, ...] = ()
) -> Robot:
    """Reads the robot of a request by its content type.

    Args:
        request: Says the content type and the parameters that CSV and URDF need.
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
        check_query(request, "tip", "base", "name", *also, common=("format",))
        return robot_from_urdf(body, base=query.get("base"), tip=query.get("tip"))
    if kind in CSV_TYPES:
        check_query(request, "convention", "name", "length", *also)
        name = query.get("name", default_name or "")
        angle, length = query.get("angle", "rad"), query.get("length", "m")
        return robot_from_table(read_csv(body, query.get("convention"), name, angle, length))
    check_query(request, "name", *also, common=("format",))
    default_name = query.get("name", default_name)
    if kind in JSON_TYPES:
        return robot_from_table(read_json(body, default_name))
    if kind in YAML_TYPES:
        return robot_from_table(read_yaml(body, default_name))
    raise unsupported(kind, ACCEPTED)


def robot_from_inline(document: Mapping[str, Any]) -> Robot:
    """The robot of ``"robot": {…}`` in a body: a table, or ``{"urdf": text, "base", "tip"}``.

    Raises:
        DHError: Not a usable table; pointers start at ``/robot``.
        RobotError: Not a usable URDF.
    """
    if "urdf" not in document:
        try:
            return robot_from_table(read_mapping(document))
        except DHError as error:
            raise DHError(
                [type(p)(f"/robot{p.pointer}", p.message) for p in error.problems]
            ) from None
    for key, value in document.items():
        if key not in ("urdf", "base", "tip", "name") or not isinstance(value, str):
            raise DHError.single(f"/robot/{key}", "give urdf, base and tip as texts")
    try:
        return robot_from_urdf(document["urdf"], base=document.get("base"), tip=document.get("tip"))
    except InvalidURDF as error:
        raise InvalidURDF(str(error), "/robot/urdf") from None


def id_from_name(name: str) -> str:
    """A robot's id from its name: other characters than letters, digits, ``. _ -`` become ``-``."""
    return _NOT_ID.sub("-", name).strip("-.")
