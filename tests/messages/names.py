"""Names of fields and words in them, which texts and CSV show in the language of the answer."""

from __future__ import annotations

import typing
from collections.abc import Iterator
from typing import Any

import msgspec

from app.operations import OPERATIONS
from app.readiness import Check, ReadinessReport
from app.routes.diff import DiffResponse
from app.routes.mesh_lines import MeshList
from app.routes.robots import RobotList, RobotView
from app.sheets.headings import Heading
from dh_to_urdf.documents.csv_words import COLUMNS
from dh_to_urdf.extraction.comparison_result import Verdict
from dh_to_urdf.extraction.normals import Case
from dh_to_urdf.languages import HEADING, WORD
from dh_to_urdf.table import JointType
from kinematics.inverse.forbidden import Forbids
from kinematics.inverse.reachable import GivenUp
from kinematics.inverse.result import IKStatus
from kinematics.redundancy.judging.verdict import Reason
from kinematics.redundancy.timing.result import RetimeStatus

UNTYPED = (
    *("angle", "length", "time", "force", "torque", "unit", "index", "row", "label", "slug"),
    *("service", "docs", "guide", "openapi", "robots", "try", "title", "explanation"),
    *("foot_on_first", "foot_on_second", "case", "words", "sign", "offset", "alpha", "theta"),
)
"""Names in answers whose types do not list them, such as units and rows of tables."""
CODES = {
    "": ("yes", "no", "true", "false", "(none)"),
    "status": (*IKStatus, *RetimeStatus, "exact", "damped", "rank_deficient", "ok", "warning"),
    "verdict": tuple(Verdict),
    "reason": (*Reason, "limit", "singularity", "unbounded", "unreachable", "jump"),
    "by": tuple(Forbids),
    "topology": ("closed", "arc"),
    "limit": ("lower", "upper"),
    "violations": ("tracking", "limits", "clearance", "velocity", "completeness"),
    "case": tuple(Case),
    "type": tuple(JointType),
    "posture": (
        *("front", "back", "up", "down", "positive", "negative", "flip", "noflip", "left"),
        *("right", "in", "out", "first", "second", "third", "fourth", "extended", "retracted"),
    ),
    "given_up": tuple(GivenUp),
    "of": ("determinant", "manipulability"),
    "chosen": ("given", "mean_lever"),
}
"""The words of fields that hold one of a few."""


def headings() -> list[str]:
    """Return the names of all fields of answers, sorted."""
    answers = [operation.answer for operation in OPERATIONS]
    types = [*answers, RobotView, RobotList, MeshList, DiffResponse, ReadinessReport, Check]
    seen: set[Any] = set()
    found = {name for type_ in types for name in _fields(type_, seen)}
    return sorted({*found, *COLUMNS, *UNTYPED, *(one.value for one in Heading)})


def words() -> list[tuple[str, str]]:
    """Return each context and text of a heading or word."""
    found = [(HEADING, name) for name in headings()]
    for name, codes in CODES.items():
        found += [(WORD.format(name), str(code)) for code in dict.fromkeys(map(str, codes))]
    return found


def _fields(type_: Any, seen: set[Any]) -> Iterator[str]:
    is_struct = isinstance(type_, type) and issubclass(type_, msgspec.Struct)
    if typing.is_typeddict(type_) or is_struct:
        if type_ in seen:
            return
        seen.add(type_)
        for name, inner in typing.get_type_hints(type_).items():
            yield name
            yield from _fields(inner, seen)
    for inner in typing.get_args(type_):
        yield from _fields(inner, seen)
