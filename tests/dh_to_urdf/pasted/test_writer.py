from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import (
    Convention,
    DHError,
    JointType,
    dh_matrices,
    read_mapping,
    read_pasted,
    read_yaml,
)
from dh_to_urdf.pasted.writer import TABLE_TEXTS

LIBRARY = Path(__file__).parents[3] / "robots" / "library"
GRIDS = ("latex", "markdown", "tsv")
SHIPPED = [path.stem for path in sorted(LIBRARY.glob("*.yaml")) if "joints:" in path.read_text()]


def as_read(row, form):
    """What a form keeps of a row."""
    keys = ["type", "alpha", "a", "d", "theta", "offset", "sign", "parent", "gamma", "b"]
    kept = [getattr(row, key) for key in keys]
    if form == "matlab":
        kept[0] = JointType.REVOLUTE if row.type.is_revolute else row.type
        return kept, row.limits.lower, row.limits.upper
    return kept, row.name, row.limits


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_table_is_read_back_exactly(tables, data):
    form = data.draw(st.sampled_from([*GRIDS, "matlab"]))
    matlab = form == "matlab"
    table = data.draw(tables(trees=not matlab))
    text_of = TABLE_TEXTS[form].write
    if matlab and any(row.type is JointType.FIXED for row in table.rows):
        with pytest.raises(DHError, match="no fixed links"):
            text_of(table)
        return
    convention = table.convention
    if matlab and convention is Convention.KHALIL:
        convention = Convention.MODIFIED
    again = read_pasted(text_of(table), convention, angle="rad" if matlab else None)
    assert [as_read(row, form) for row in again.rows] == [as_read(row, form) for row in table.rows]
    assert np.array_equal(again.base, table.base)
    assert np.array_equal(again.tool, table.tool)


@pytest.mark.parametrize("form", [*GRIDS, "matlab"])
@pytest.mark.parametrize("name", SHIPPED)
def test_the_library_survives_every_form(name, form):
    table = read_yaml((LIBRARY / f"{name}.yaml").read_text())
    convention = table.convention
    if form == "matlab" and convention is Convention.KHALIL:
        convention = Convention.MODIFIED
    if form == "matlab" and any(row.type is JointType.FIXED for row in table.rows):
        pytest.skip("the Robotics Toolbox has no fixed links")
    if form == "matlab" and table.is_coupled:
        pytest.skip("the Robotics Toolbox has no coupled links")
    again = read_pasted(TABLE_TEXTS[form].write(table), convention)
    q = np.random.default_rng(2).uniform(-3, 3, (10, table.dof))
    assert np.abs(dh_matrices(again, q).T - dh_matrices(table, q).T).max() < 1e-15


def test_a_handout_looks_like_one():
    table = read_mapping(
        {
            "name": "arm",
            "convention": "craig",
            "joints": [
                {"type": "R", "alpha": 0, "a": 0, "d": 0.4, "theta": "q1 - 3*pi/4"},
                {"type": "P", "alpha": "-90°", "a": 0.5, "d": "0.1 - d2", "theta": "pi/2"},
            ],
            "tool": {"xyz": [0, 0, 0.1]},
        }
    )
    assert TABLE_TEXTS["markdown"].write(table) == (
        "**arm** (modified)\n\n"
        "| i | type | α(i-1) [rad] | a(i-1) [m] | d [m] | θ [rad] |\n"
        "| --- | --- | --- | --- | --- | --- |\n"
        "| 1 | R | 0 | 0 | 0.4 | θ1 - 3π/4 |\n"
        "| 2 | P | -π/2 | 0.5 | -d2 + 0.1 | π/2 |\n"
        "\ntool = [1 0 0 0; 0 1 0 0; 0 0 1 0.1; 0 0 0 1]\n"
    )
    latex = TABLE_TEXTS["latex"].write(table)
    assert r"2 & P & $-\frac{\pi}{2}$ & $0.5$ & $-d_{2} + 0.1$ & $\frac{\pi}{2}$ \\" in latex
    assert r"$\theta_{1} - \frac{3\pi}{4}$" in latex
    assert r"$\alpha_{i-1}$ [rad]" in latex
    first, second, *_ = TABLE_TEXTS["matlab"].write(table).splitlines()
    assert first == (
        "L(1) = Link('revolute', 'd', 0.4, 'a', 0, 'alpha', 0, 'offset', -3*pi/4, 'modified');"
    )
    assert second == (
        "L(2) = Link('prismatic', 'theta', pi/2, 'a', 0.5, 'alpha', -pi/2, 'offset', 0.1, 'flip',"
        " 'modified');"
    )


def test_a_tree_is_no_robot_of_the_toolbox():
    row = {"sigma": 0, "alpha": 0, "d": 0, "r": 0}
    table = read_mapping({"convention": "khalil", "joints": [row, row, row | {"ant": 1}]})
    with pytest.raises(DHError, match=r"joint 3 .* branches"):
        TABLE_TEXTS["matlab"].write(table)


@pytest.mark.parametrize("limit", [1.5, 25.0, 100.0, 12345.678, 999999.0])
def test_limits_of_the_toolbox_s_form_are_read_back_exactly(limit):
    row = {"type": "R", "alpha": 0, "a": 0.3, "d": 0}
    row["limits"] = {"lower": -limit, "upper": limit}
    slide = {"type": "P", "alpha": 0, "a": 0, "theta": 0, "limits": {"lower": -limit, "upper": 1}}
    table = read_mapping({"convention": "standard", "joints": [row, slide]})
    again = read_pasted(TABLE_TEXTS["matlab"].write(table), "standard")
    assert [r.limits for r in again.rows] == [r.limits for r in table.rows]
