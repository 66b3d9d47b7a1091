"""Random D-H tables that are right, in every format that is read."""

from __future__ import annotations

import json
import math
import random
from dataclasses import dataclass, replace
from typing import Any

from dh_to_urdf import Convention, DHTable, read_mapping, table_to_par
from dh_to_urdf.documents.layouts import to_csv, to_yaml
from dh_to_urdf.pasted.writer import TABLE_TEXTS

FORMATS = ("json", "json", "yaml", "csv", "par", "latex", "markdown", "tsv", "matlab")
NAMES = ("j1", "a b", "épaule", "x.y-z_0", "手", "Ж+", "0", "tool", "frame_1", "q")
ANGLES = (0, "pi/2", "-pi/2", "π", "90deg", "-45°", 0.3, "3*pi/4", "0.25", 1e-9, "+1", "-0.0")
LENGTHS = (0, 1, 0.4318, "0.15", "0,4", "200mm", "sqrt(2)/2", -0.02, "1e-3", ".5", "2*0.1")


@dataclass(frozen=True)
class Text:
    """A document and how it is to be read.

    Attributes:
        format: json, yaml, csv, par or pasted.
        content: The document.
        convention: Given beside the document where the format does not say it.
    """

    format: str
    content: bytes
    convention: str


def random_table(rng: random.Random) -> dict[str, Any]:
    """The mapping of a table that must be read."""
    convention = rng.choice(("standard", "modified", "khalil"))
    x, z = ("d", "r") if convention == "khalil" else ("a", "d")
    degrees = rng.random() < 0.3
    rows = []
    for k in range(rng.choice((1, 2, 2, 3, 3, 4, 6, 7))):
        kind = rng.choice(("R", "revolute", "P", "prismatic", "C", "F"))
        row: dict[str, Any] = {"type": "R" if k == 0 else kind}
        row["alpha"], row[x] = _angle(rng, degrees), rng.choice(LENGTHS)
        row[z], row["theta"] = rng.choice(LENGTHS), _angle(rng, degrees)
        if rng.random() < 0.4:
            row["name"] = f"{rng.choice(NAMES)}{k}"
        if row["type"] in ("R", "revolute", "P", "prismatic") and rng.random() < 0.5:
            row["limits"] = {"lower": -1, "upper": rng.choice((-1, 1, 2.5)), "velocity": 2}
        if row["type"] not in ("F",) and rng.random() < 0.3:
            row["sign"] = rng.choice((1, -1))
            row["offset"] = rng.choice((0, 0.2))
        if convention == "khalil" and rng.random() < 0.3:
            row["ant"] = rng.randrange(k + 1)
            row["gamma"], row["b"] = _angle(rng, degrees), rng.choice(LENGTHS)
        rows.append(row)
    table: dict[str, Any] = {"name": rng.choice(NAMES), "convention": convention, "joints": rows}
    if degrees or rng.random() < 0.5:
        table["units"] = {"angle": "deg" if degrees else "rad", "length": "m"}
    for key in ("base", "tool"):
        if rng.random() < 0.3:
            table[key] = {"xyz": [0.1, 0, rng.choice((0, -1.5))], "rpy": [0, 0, _plain(rng)]}
    return table


def random_text(rng: random.Random) -> Text:
    """A document of a random table."""
    form, mapping = rng.choice(FORMATS), random_table(rng)
    if form == "json":
        text = json.dumps(mapping, ensure_ascii=rng.random() < 0.5)
        return Text("json", text.encode(), "")
    table = read_mapping(mapping)
    if form == "yaml":
        return Text("yaml", to_yaml(mapping).encode(), "")
    if form == "csv":
        return Text("csv", to_csv(table).encode(), table.convention.value)
    if form == "par":
        if table.convention is Convention.STANDARD:
            table = replace(table, convention=Convention.MODIFIED)
        return Text("par", table_to_par(table).encode(), "")
    content, convention = _handout(form, table)
    return Text("pasted", content.encode(), convention.value)


def _handout(form: str, table: DHTable) -> tuple[str, Convention]:
    try:
        content = TABLE_TEXTS[form].write(table)
    except ValueError:
        return TABLE_TEXTS["markdown"].write(table), table.convention
    # The Robotics Toolbox has no links of Khalil's; those of Craig's are the same in a chain.
    as_modified = form == "matlab" and table.convention is Convention.KHALIL
    return content, Convention.MODIFIED if as_modified else table.convention


def _plain(rng: random.Random) -> float:
    return rng.choice((0.0, 0.5, -1.25))


def _angle(rng: random.Random, degrees: bool) -> Any:
    if degrees:
        return rng.choice((0, 90, -90.0, "45", 30.5, "pi/2", "90deg"))
    return rng.choice(ANGLES) if rng.random() < 0.7 else rng.uniform(-math.pi, math.pi)
