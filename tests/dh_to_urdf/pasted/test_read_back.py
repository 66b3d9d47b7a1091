"""Every form that is written is read back: the whole library, every form, limits of any size."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dh_to_urdf import (
    Convention,
    JointType,
    Limits,
    dh_matrices,
    read_csv,
    read_json,
    read_par,
    read_pasted,
    read_yaml,
    to_convention,
)
from dh_to_urdf.documents.layouts import document, to_csv, to_text, to_yaml
from dh_to_urdf.languages import language
from dh_to_urdf.pasted.writer import TABLE_TEXTS

LIBRARY = Path(__file__).parents[3] / "robots" / "library"
ROBOTS = [path for path in sorted(LIBRARY.glob("*.yaml")) if "joints:" in path.read_text()]
FRENCH = language("fr")
PASTED = ("latex", "markdown", "tsv", "matlab", "text", "texte")
FORMS = ("json", "yaml", "csv", "csv-fr", "par", *PASTED)
HUGE = Limits(-999999.0, 999999.0, 1e5, 1e5)


def written(table, form, degrees):
    if form in ("json", "yaml"):
        import json

        mapping = document(table, degrees=degrees)
        return json.dumps(mapping) if form == "json" else to_yaml(mapping)
    if form == "csv":
        return to_csv(table, degrees=degrees)
    if form == "csv-fr":
        return to_csv(table, degrees=degrees, language=FRENCH, commas=True)
    if form == "text":
        return to_text(table, degrees=degrees)
    if form == "texte":
        return FRENCH.text(to_text(table, degrees=degrees))
    writer = TABLE_TEXTS[form]
    return (writer.write_degrees if degrees and writer.write_degrees else writer.write)(table)


def read(text, form, convention, degrees):
    if form == "json":
        return read_json(text)
    if form == "yaml":
        return read_yaml(text)
    if form.startswith("csv"):
        return read_csv(text, convention, angle="deg" if degrees else "rad")
    if form == "par":
        return read_par(text)
    stated = form in ("text", "texte")
    return read_pasted(
        text, None if stated else convention, angle="rad" if form == "matlab" else None
    )


def fits(table, form):
    """Return the table as a form can have it: MATLAB has neither fixed rows nor couplings."""
    depends = any(row.mimic is not None or row.coupling for row in table.rows)
    if form == "matlab" and (
        depends
        or any(row.type is JointType.FIXED for row in table.rows)
        or any(row.parent != k or row.gamma or row.b for k, row in enumerate(table.rows))
    ):
        return None
    if form == "par" and table.convention is Convention.STANDARD:
        return to_convention(table, Convention.KHALIL)
    return table


@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_what_is_written_is_read_back(path, form, wide):
    table = read_yaml(path.read_text())
    if wide:
        rows = (
            replace(row, limits=HUGE)
            if row.type in (JointType.REVOLUTE, JointType.PRISMATIC)
            else row
            for row in table.rows
        )
        table = replace(table, rows=tuple(rows))
    table = fits(table, form)
    if table is None:
        pytest.skip("the Robotics Toolbox has no such links")
    degrees = len(path.stem) % 2 == 0
    convention = table.convention.value
    if form == "matlab" and convention == "khalil":
        convention = "modified"
    text = written(table, form, degrees)
    again = read(text, form, convention, degrees)
    assert again.dof == table.dof
    q = np.random.default_rng(1).uniform(-1, 1, (3, table.dof))
    tolerance = 2e-8 if form in ("text", "texte") else 1e-12
    assert np.allclose(dh_matrices(again, q).T, dh_matrices(table, q).T, atol=tolerance), text
    moving = [row for row in again.rows if row.type is not JointType.FIXED]
    theirs = [row for row in table.rows if row.type is not JointType.FIXED]
    if form != "matlab":
        assert [row.name for row in moving] == [row.name for row in theirs]
    lower = [row.limits.lower for row in theirs]
    assert [row.limits.lower for row in moving] == pytest.approx(lower, rel=1e-8)
