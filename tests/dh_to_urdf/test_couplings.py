"""Followers and couplings in D-H documents, their map, and every written form."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from dh_to_urdf import (
    DHError,
    JointType,
    dh_matrices,
    read_csv,
    read_json,
    read_mapping,
    read_par,
    read_pasted,
    read_yaml,
    table_to_par,
)
from dh_to_urdf.couplings import joint_map, moving_joints, uncoupled
from dh_to_urdf.documents.layouts import document, to_csv, to_text, to_yaml
from dh_to_urdf.pasted.writer import TABLE_TEXTS
from dh_to_urdf.table import Mimic


def table(*rows, **head):
    plain = {"type": "R", "alpha": 0, "a": 0.3, "d": 0}
    return read_mapping({"convention": "modified", **head, "joints": [plain | r for r in rows]})


def refusal(*rows, **head):
    with pytest.raises(DHError) as caught:
        table(*rows, **head)
    return caught.value.faults[0]


COUPLED = (
    {"name": "a", "limits": {"lower": -1, "upper": 1, "velocity": 2}},
    {"name": "b", "alpha": "pi/2", "mimic": {"joint": "a", "multiplier": -2, "offset": 0.1}},
    {"name": "c", "alpha": 0.3, "theta": "-q3 - q1 + pi/2"},
    {"name": "s", "type": "P", "alpha": 0.2, "theta": 0.4, "coupling": {"a": 0.01}},
    {"name": "w", "alpha": 0.7, "theta": "-q3 + 0.5*q4", "sign": 1},
    {"name": "f", "type": "F", "theta": 0.2},
    {"name": "v", "type": "P", "alpha": 0.1, "theta": 0, "mimic": {"joint": "b"}},
)


def test_a_follower_by_field_and_by_cell_is_the_same():
    by_field = table({}, {"mimic": {"joint": "j1", "multiplier": -2}, "offset": "pi/2"})
    by_cell = table({}, {"theta": "-2*q1 + pi/2"})
    by_text = table({}, {"mimic": "-2*q1", "offset": "pi/2"})
    assert by_field.rows == by_cell.rows == by_text.rows
    assert by_field.rows[1].mimic == Mimic("j1", -2.0, 0.0)
    assert by_field.dof == 1


def test_a_coupling_by_field_and_by_cell_is_the_same():
    by_field = table({}, {}, {"coupling": {"j2": 1}})
    assert by_field.rows == table({}, {}, {"theta": "q3+q2"}).rows
    assert by_field.rows == table({}, {}, {"coupling": "q2"}).rows
    assert by_field.dof == 3
    minus = table({}, {}, {"theta": "-q3+q2"}).rows[2]
    assert (minus.sign, minus.coupling) == (-1, (("j2", -1.0),))


def test_the_map_follows_followers_and_narrows_limits():
    made = table(
        {"limits": {"lower": -3, "upper": 3, "velocity": 2}},
        {"mimic": {"joint": "j1", "multiplier": -2, "offset": 0.1}},
        {
            "mimic": {"joint": "j2", "multiplier": 0.5},
            "limits": {"lower": -1, "upper": 0.5, "velocity": 1},
        },
        {"theta": "q4 + 0.5*q3 - q1"},
    )
    found = joint_map(*moving_joints(made))
    assert found.matrix.tolist() == [[1, 0], [-2, 0], [-1, 0], [-1.5, 1]]
    assert found.offset.tolist() == [0, 0.1, 0.05, 0.025]
    limits = found.limits[0]
    assert (limits.lower, limits.upper) == (pytest.approx(-0.45), pytest.approx(1.05))
    assert limits.velocity == 1
    for q in (limits.lower, limits.upper):
        assert -1 <= -q + 0.05 <= 0.5


def test_units_of_multipliers_are_those_of_the_table():
    units = {"angle": "deg", "length": "mm"}
    slide = {"type": "P", "theta": 0, "mimic": {"joint": "j1", "multiplier": 5, "offset": 10}}
    made = table({}, slide, units=units)
    assert made.rows[1].mimic.multiplier == pytest.approx(5e-3 * 180 / math.pi)
    assert made.rows[1].mimic.offset == 0.01
    by_cell = table({}, {"type": "P", "theta": 0, "d": "5*q1+10"}, units=units).rows[1]
    assert (by_cell.mimic, by_cell.offset) == (replace(made.rows[1].mimic, offset=0.0), 0.01)
    turning = table({"type": "P", "theta": 0}, {"mimic": "2*q1+90"}, units=units)
    assert turning.rows[1].mimic.multiplier == pytest.approx(2 * math.pi / 180 * 1000)
    assert turning.rows[1].mimic.offset == math.pi / 2


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_matrices_are_those_of_the_values_by_hand(convention):
    made = table(*COUPLED, convention=convention)
    assert made.dof == 3
    q = np.array([0.2, -0.7, 0.15])
    a, c, s = q
    b = -2 * a + 0.1
    values = {"a": a, "b": b, "c": c + a, "s": s + 0.01 * a, "w": -c + 0.5 * s, "v": b}
    full = np.array([values[row.name] for row in made.rows if row.type is not JointType.FIXED])
    expected = dh_matrices(uncoupled(made), full).T
    np.testing.assert_allclose(dh_matrices(made, q).T, expected, rtol=0, atol=1e-15)


def test_every_written_document_is_read_as_the_same_robot():
    made = table(*COUPLED)
    q = np.random.default_rng(3).uniform(-1, 1, (20, made.dof))
    expected = dh_matrices(made, q).T
    assert read_mapping(document(made)).rows == made.rows
    copies = [read_mapping(document(made, degrees=True)), read_yaml(to_yaml(document(made)))]
    copies += [read_json(json.dumps(document(made)))]
    copies += [read_csv(to_csv(made), "modified")]
    copies += [read_csv(to_csv(made, degrees=True), "modified", angle="deg")]
    for form in ("latex", "markdown", "tsv"):
        copies.append(read_pasted(TABLE_TEXTS[form].write(made), "modified"))
    copies.append(read_par(table_to_par(made)))
    for copy in copies:
        assert copy.dof == 3
        np.testing.assert_allclose(dh_matrices(copy, q).T, expected, rtol=0, atol=1e-13)
    assert "-2*q1 + 0.1" in to_text(made)


def test_matlab_has_no_couplings():
    with pytest.raises(DHError, match=r"j2.*depends on other joints"):
        TABLE_TEXTS["matlab"].write(table({}, {"theta": "q2+q1"}))


@pytest.mark.parametrize(
    ("rows", "location", "words"),
    [
        (({}, {"mimic": {"joint": "j2"}}), "mimic", ("'j2' mimics itself",)),
        (({"mimic": "q2"}, {"mimic": "q1"}), "mimic", ("'j1' mimics itself by way of 'j2'",)),
        (({}, {"mimic": {"joint": "jx"}}), "mimic", ("'jx', which does not exist", "j1, j2")),
        (({}, {"coupling": {"jx": 1}}), "coupling", ("'jx', which does not exist",)),
        (({}, {"coupling": {"j2": 1}}), "coupling", ("coupled with itself",)),
        (({}, {"coupling": {"j1": 0}}), "coupling", ("coefficient of 0",)),
        (({"theta": "q1+q2"}, {"theta": "q2+q1"}), "theta", ("'j1', 'j2'", "cycle")),
        (({"type": "F", "theta": 0}, {"theta": "q1"}), "theta", ("joint 1", "does not move")),
        (({}, {"type": "F", "theta": 0, "mimic": "q1"}), "mimic", ("a fixed joint has no mimic",)),
        (({}, {"theta": "q5"}), "theta", ("q5", "no such joint", "values q5:0.5")),
        (({}, {"theta": "d1+q2"}), "theta", ("d1", "is an angle", "values d1:0.5")),
        (
            ({"type": "C"}, {"type": "C", "mimic": {"joint": "j1", "multiplier": 0.5}}),
            "mimic",
            ("0.5 times", "'j1'", "continuous", "revolute"),
        ),
        (
            ({}, {"type": "C", "mimic": {"joint": "j1", "multiplier": 0.5}}),
            "mimic",
            ("'j2' is continuous",),
        ),
        (({}, {"mimic": {"joint": "j1", "multiplier": "x"}}), "mimic", ("multiplier", "'x'")),
        (({}, {"mimic": {"multiplier": 2}}), "mimic", ("lacks the name",)),
        (({}, {"mimic": "q1", "theta": "q2+q1"}), "theta", ("keep one",)),
        (
            (
                {"limits": {"lower": 0, "upper": 1}},
                {"mimic": "q1", "limits": {"lower": 2, "upper": 3}},
            ),
            "limits",
            ("'j2' leave no value to 'j1'",),
        ),
        (
            ({}, {}, {"theta": "-q1-q2", "limits": {"lower": 0, "upper": 1}}),
            "limits",
            ("several joints",),
        ),
    ],
)
def test_a_refusal_names_the_joint_and_the_remedy(rows, location, words):
    fault = refusal(*rows)
    assert fault.location[2] == location
    assert [word for word in words if word not in fault.message] == []


def test_whole_multiples_of_a_continuous_joint_work():
    made = table({"type": "C"}, {"type": "C", "mimic": {"joint": "j1", "multiplier": -2}})
    assert made.dof == 1
