"""Judges what the readers of tables do with a document: refused in clear words, or computed right.

The robot is computed a second time by elementary matrices: of the table that was read, and, where
the cells are plain numbers, of the document itself.
"""

from __future__ import annotations

import csv
import io
import json
import math
import random
import re
import time
import unicodedata
from typing import Any

import numpy as np
from ruamel.yaml import YAML

from app.http.rendering import rendered
from dh_to_urdf import (
    Convention,
    DHError,
    DHRow,
    DHTable,
    JointType,
    read_csv,
    read_json,
    read_mapping,
    read_par,
    read_pasted,
    read_yaml,
)
from dh_to_urdf.documents.writing import table_to_mapping
from kinematics.forward import fk
from robots.errors import RobotError
from robots.robot import robot_from_table
from tests.cost import within
from tests.torture.table_grammar import Text
from tests.torture.urdf_oracle import TOLERANCE, check_message

SECONDS = 1.5
MAX_ERROR_BYTES = 4096
_ARITHMETIC = re.compile(r"(?:pi|[\d.+\-*/() ]|(?<=\d)[eE](?=[+\-\d])){1,40}", re.ASCII)
_TYPES = {
    "r": "R",
    "revolute": "R",
    "c": "R",
    "continuous": "R",
    "p": "P",
    "prismatic": "P",
    "f": "F",
    "fixed": "F",
}
_PAR_KEYS = ("ant", "sigma", "b", "d", "r", "gamma", "alpha", "theta")
_IDENTITY = np.eye(4).ravel()
_WITH_UNIT = re.compile(r"([+-]?[0-9]+\.?[0-9]*) ?(deg|°|rad|m|mm)")
_UNITS = {"deg": math.pi / 180, "°": math.pi / 180, "rad": 1.0, "m": 1.0, "mm": 1e-3}


class NotPlain(Exception):
    """A document that the second reading leaves to the first."""


def judge(text: Text, rng: random.Random) -> str:
    """``refused`` or ``accepted``.

    Raises:
        AssertionError: Neither is right; the message says why.
    """
    started = time.thread_time()
    try:
        table = read(text)
        robot = robot_from_table(table)
    except (DHError, RobotError) as error:
        refused = shown(error)
    else:
        refused = []
    seconds = time.thread_time() - started
    assert within(seconds, SECONDS), f"took {seconds:.2f} s"
    if refused:
        check_refusal(refused)
        return "refused"
    q = np.array([rng.uniform(-3, 3) for _ in range(robot.dof)])
    found = fk(robot, q, robot.frames)
    check_poses(found, frames(table, q), table)
    for warning in table.warnings:
        check_message(warning)
    assert read_mapping(table_to_mapping(table)) is not None
    try:
        other = second_reading(text)
    except NotPlain:
        return "accepted"
    assert len(other.rows) == len(table.rows), "rows are lost"
    check_poses(found, frames(other, q), other)
    return "accepted, read twice"


def read(text: Text) -> DHTable:
    """Reads a document as a request would have it read."""
    if text.format == "json":
        return read_json(text.content)
    if text.format == "yaml":
        return read_yaml(text.content)
    if text.format == "csv":
        return read_csv(text.content, text.convention)
    if text.format == "par":
        return read_par(text.content)
    return read_pasted(text.content, text.convention)


def shown(error: DHError | RobotError) -> list[tuple[str, str]]:
    """Pointers and messages as an answer of the API shows them."""
    _, entries, _ = rendered(error)
    return [(entry.pointer, entry.message) for entry in entries]


def check_refusal(problems: list[tuple[str, str]]) -> None:
    """At most ten, short, clean, each about something."""
    assert 1 <= len(problems) <= 10
    assert sum(len((p + m).encode("utf-8", "replace")) for p, m in problems) < MAX_ERROR_BYTES
    for pointer, message in problems:
        assert not any(unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp") for c in pointer)
        assert pointer == "" or pointer.startswith("/")
        assert 10 < len(message) < 400, f"message of {len(message)} characters: {message[:80]!r}"
        odd = [c for c in message if unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp")]
        assert not odd, f"message holds {odd!r}: {message!r}"
        assert "Traceback" not in message
        assert "ruamel" not in message


def check_poses(found: dict[str, Any], expected: dict[str, Any], table: DHTable) -> None:
    """The frames agree to rounding."""
    lengths = [abs(x) for row in table.rows for x in (row.a, row.d, row.b, row.offset)]
    lengths += [float(np.abs(T[:3, 3]).max()) for T in (table.base, table.tool)]
    scale = 10.0 + sum(lengths)
    assert set(expected) <= set(found), "frames are lost"
    for name, T in expected.items():
        assert np.isfinite(found[name]).all(), f"{name} is not finite"
        off = float(np.abs(found[name] - T).max())
        assert off < TOLERANCE * scale, f"{name} is off by {off:g}"


def frames(table: DHTable, q: np.ndarray) -> dict[str, np.ndarray]:
    """``frame_k`` and ``tool`` in base axes, one elementary matrix a factor."""
    found = {"frame_0": np.array(table.base)}
    values = iter(q)
    for k, row in enumerate(table.rows, start=1):
        v = 0.0 if row.type is JointType.FIXED else row.sign * float(next(values)) + row.offset
        found[f"frame_{k}"] = (row.parent, _link(table.convention, row, v))  # type: ignore[assignment]
    placed = {0: found["frame_0"]}

    def place(k: int) -> np.ndarray:
        if k not in placed:
            parent, A = found[f"frame_{k}"]
            placed[k] = place(parent) @ A
        return placed[k]

    poses = {f"frame_{k}": place(k) for k in range(len(table.rows) + 1)}
    return poses | {"tool": poses[f"frame_{table.tip_row}"] @ table.tool}


def _link(convention: Convention, row: DHRow, v: float) -> np.ndarray:
    theta = v if row.type.is_revolute else row.theta
    d = v if row.type is JointType.PRISMATIC else row.d
    z = _turn(2, theta) @ _shift(0, 0, d)
    x = _shift(row.a, 0, 0) @ _turn(0, row.alpha)
    if convention is Convention.STANDARD:
        return z @ x
    return _turn(2, row.gamma) @ _shift(0, 0, row.b) @ x @ z


def _turn(axis: int, angle: float) -> np.ndarray:
    T = np.eye(4)
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    T[i, i] = T[j, j] = math.cos(angle)
    T[j, i] = math.sin(angle)
    T[i, j] = -T[j, i]
    return T


def _shift(x: float, y: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def second_reading(text: Text) -> DHTable:
    """The table of a document whose cells are plain arithmetic.

    Raises:
        NotPlain: It holds more than that.
    """
    if text.format == "json":
        data = json.loads(text.content)
    elif text.format == "yaml":
        data = YAML(typ="safe", pure=True).load(text.content)
    elif text.format == "csv":
        data = {"convention": text.convention, "joints": _csv_rows(text.content)}
    elif text.format == "par":
        data = {"convention": "khalil", "joints": _par_rows(text.content)}
    else:
        raise NotPlain
    names = {
        "standard": Convention.STANDARD,
        "modified": Convention.MODIFIED,
        "khalil": Convention.KHALIL,
    }
    if data["convention"] not in names:
        raise NotPlain
    units = data.get("units") or {}
    angle = {"rad": 1.0, "deg": math.pi / 180}[units.get("angle", "rad")]
    length = {"m": 1.0, "mm": 1e-3}[units.get("length", "m")]
    convention = names[data["convention"]]
    rows = [_row(k, row, convention, angle, length) for k, row in enumerate(data["joints"])]
    base, tool = (_placement(data.get(key), angle, length) for key in ("base", "tool"))
    return DHTable("second", convention, tuple(rows), base, tool)


def _csv_rows(content: bytes) -> list[dict[str, Any]]:
    text = content.decode("utf-8-sig")
    if text.count(",") < 3 or ";" in text or "\t" in text:
        raise NotPlain
    lines = [line for line in text.splitlines() if line.strip()]
    header, *records = csv.reader(io.StringIO("\n".join(lines)), skipinitialspace=True)
    keys = [key.strip().lower() for key in header]
    return [
        {k: c.strip() for k, c in zip(keys, record, strict=True) if c.strip()} for record in records
    ]


def _par_rows(content: bytes) -> list[dict[str, Any]]:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if "tool" in text or re.search(r"\(\*[^)]*\(\*", text):
        raise NotPlain
    code = re.sub(r"\(\*.*?\*\)", " ", text, flags=re.DOTALL)
    found = re.findall(r"(\w+)\s*=\s*\{([^{}]*)\}", code)
    lists = {
        key if key in ("GAMMA", "Z") else key.lower(): cells.split(",") for key, cells in found
    }
    if [float(cell) for cell in lists.get("Z", ["0"])] != [*_IDENTITY] or "sigma" not in lists:
        raise NotPlain
    rows = []
    for k in range(len(lists["sigma"])):
        row = {key: lists[key][k].strip() for key in _PAR_KEYS if key in lists}
        own = {"0": "theta", "1": "r"}.get(row["sigma"], "")
        name = f"th{k + 1}" if own == "theta" else f"r{k + 1}"
        if own and row[own].startswith(name):
            row[own] = row[own].removeprefix(name).replace(" ", "").removeprefix("+") or "0"
        elif own and row[own].startswith(f"-{name}"):
            row[own], row["sign"] = row[own].removeprefix(f"-{name}") or "0", "-1"
        rows.append(row)
    return rows


def _row(k: int, row: dict[str, Any], convention: Convention, angle: float, length: float) -> DHRow:
    kind = _TYPES[row["type"].strip().lower()] if "type" in row else "RPF"[int(row["sigma"])]
    x, z = ("d", "r") if convention is Convention.KHALIL else ("a", "d")
    a, d, b = (plain(row.get(key, 0), length) for key in (x, z, "b"))
    alpha, theta, gamma = (plain(row.get(key, 0), angle) for key in ("alpha", "theta", "gamma"))
    offset = plain(row.get("offset", 0), length if kind == "P" else angle)
    types = {"R": JointType.REVOLUTE, "P": JointType.PRISMATIC, "F": JointType.FIXED}
    return DHRow(
        name=f"j{k}",
        type=types[kind],
        alpha=alpha,
        a=a,
        parent=int(row.get("ant", k)),
        d=0.0 if kind == "P" else d,
        theta=0.0 if kind == "R" else theta,
        gamma=gamma,
        b=b,
        offset=offset + (d if kind == "P" else theta if kind == "R" else 0.0),
        sign=int(row.get("sign", 1)),
    )


def _placement(data: Any, angle: float, length: float) -> np.ndarray:
    if data is None:
        return np.eye(4)
    if "matrix" in data:
        T = np.array([[plain(cell, 1.0) for cell in line] for line in data["matrix"]])
        T[:3, 3] *= length
        return T
    if set(data) - {"xyz", "rpy"}:
        raise NotPlain
    xyz = [plain(cell, length) for cell in data.get("xyz") or (0, 0, 0)]
    roll, pitch, yaw = (plain(cell, angle) for cell in data.get("rpy") or (0, 0, 0))
    return _shift(*xyz) @ _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)


def plain(cell: Any, unit: float) -> float:
    """A number, or arithmetic of numbers and pi, which is in rad."""
    if isinstance(cell, bool) or not isinstance(cell, (int, float, str)):
        raise NotPlain
    if not isinstance(cell, str):
        return float(cell) * unit
    text = cell.strip().replace("π", "pi")
    with_unit = _WITH_UNIT.fullmatch(text)
    if with_unit:
        return float(with_unit[1]) * _UNITS[with_unit[2]]
    if re.fullmatch(r"-?[0-9]+,[0-9]+", text):
        text = text.replace(",", ".")
    if text.startswith("sqrt(2)/2"):
        text = text.replace("sqrt(2)/2", repr(math.sqrt(2) / 2))
    if _ARITHMETIC.fullmatch(text) is None or "**" in text or "//" in text:
        raise NotPlain
    if re.search(r"\d\s*\(|\)\s*[\d(]|\d\s+\d|pi\s*[\d(p]|[\d)]\s*pi|(?<![\d.])0\d", text):
        raise NotPlain
    try:
        value = float(eval(text, {"__builtins__": {}}, {"pi": math.pi}))  # digits and + - * / only
    except (SyntaxError, ZeroDivisionError, OverflowError, TypeError, NameError):
        raise NotPlain from None
    return value if "pi" in text else value * unit
