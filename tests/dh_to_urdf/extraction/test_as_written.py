"""Tables compared as written: a cell that is changed is told, and no other."""

from dataclasses import replace

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from dh_to_urdf.extraction.as_written import differences_as_written, words_as_written
from dh_to_urdf.table import Convention, JointType


def table(generator, convention):
    rows = []
    names = ("d", "r") if convention == "khalil" else ("a", "d")
    for _ in range(int(generator.integers(2, 7))):
        kind = str(generator.choice(["R", "P"]))
        row = {"type": kind, "alpha": generator.uniform(-3, 3), names[0]: generator.uniform(-1, 1)}
        row |= {"offset": generator.uniform(-1, 1), "sign": int(generator.choice([1, -1]))}
        row |= {"limits": {"lower": -1.5, "upper": 2.0, "velocity": 1.0}}
        row |= {"theta": 0.3} if kind == "P" else {names[1]: generator.uniform(-1, 1)}
        rows.append(row)
    return read_mapping({"name": "t", "convention": convention, "joints": rows})


@pytest.mark.parametrize("seed", range(60))
def test_the_changed_cell_is_told_and_no_other(seed):
    generator = np.random.default_rng(seed)
    convention = ("standard", "modified", "khalil")[seed % 3]
    one = table(generator, convention)
    assert differences_as_written(one, one) == ()
    assert words_as_written(()) == ""
    k = int(generator.integers(len(one.rows)))
    row = one.rows[k]
    fixed = "d" if row.type.is_revolute else "theta"
    column = str(generator.choice(["alpha", "a", fixed, "offset", "sign", "lower"]))
    if column == "lower":
        changed = replace(row, limits=replace(row.limits, lower=-1.2))
    elif column == "sign":
        changed = replace(row, sign=-row.sign)
    else:
        changed = replace(row, **{column: getattr(row, column) + generator.uniform(0.01, 7)})
    rows = [*one.rows]
    rows[k] = changed
    (cell,) = differences_as_written(one, replace(one, rows=tuple(rows)))
    called = {"a": "d", "d": "r"}.get(column, column) if convention == "khalil" else column
    assert (cell.joint, cell.name, cell.parameter) == (k + 1, row.name, called)
    holder = (row.limits, changed.limits) if column == "lower" else (row, changed)
    assert [cell.first, cell.second] == [getattr(x, column) for x in holder]
    assert cell.is_angle == (
        column in ("alpha", "theta") or (column in ("offset", "lower") and row.type.is_revolute)
    )
    assert f"joint {k + 1} ({row.name}): {called} is" in words_as_written((cell,))


def test_base_tool_rows_and_types():
    generator = np.random.default_rng(1)
    one = table(generator, "standard")
    moved = np.eye(4)
    moved[0, 3] = 0.1
    (cell,) = differences_as_written(one, replace(one, tool=moved))
    assert (cell.joint, cell.name) == (0, "tool")
    assert "tool is xyz 0 0 0 m, rpy 0 0 0 rad and xyz 0.1 0 0 m" in words_as_written((cell,))
    (missing,) = differences_as_written(one, replace(one, rows=one.rows[:-1]))
    assert missing.parameter == "joints"
    assert "is present in the first and missing in the second" in words_as_written((missing,))
    rows = [*one.rows]
    rows[0] = replace(rows[0], type=JointType.FIXED)
    assert differences_as_written(one, replace(one, rows=tuple(rows)))[0].parameter == "type"
    assert differences_as_written(one, replace(one, convention=Convention.MODIFIED)) is None
