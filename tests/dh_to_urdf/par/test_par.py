import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import Convention, DHError, JointType, dh_matrices, read_yaml
from dh_to_urdf.par.reader import read_par
from dh_to_urdf.par.text import parse_par
from dh_to_urdf.par.writer import table_to_par

FILES = Path(__file__).parents[2] / "fixtures" / "par"
LIBRARY = Path(__file__).parents[3] / "robots" / "library"
RX90, STANFORD, TREE, SR400 = (
    (FILES / f"{name}.par").read_text() for name in ("rx90", "stanford", "tree", "sr400")
)
LENGTHS = {"D3": 0.45, "RL4": "450mm"}
SR400_LENGTHS = {"d2": 0.3, "d3": 0.8, "d4": 0.14, "d8": 0.5, "RL4": 1.0}


def fault(*args, **options):
    with pytest.raises(DHError) as caught:
        read_par(*args, **options)
    return caught.value.faults[0].location, caught.value.faults[0].message


def test_the_rx90_is_that_of_the_library():
    table = read_par(RX90, values=LENGTHS)
    shipped = read_yaml((LIBRARY / "rx90.yaml").read_text())
    assert (table.name, table.convention, table.dof) == ("RX90", Convention.KHALIL, 6)
    assert table.warnings == ()
    q = np.random.default_rng(0).uniform(-3, 3, (100, 6))
    assert np.abs(dh_matrices(table, q).T0 - dh_matrices(shipped, q).T0).max() < 1e-15


def test_the_stanford_arm_is_its_printed_model():
    """Khalil and Dombre: r2 = RL2, r3 variable; position of the wrist by hand."""
    table = read_par(STANFORD, values={"RL2": 0.154})
    assert [row.type for row in table.rows].count(JointType.PRISMATIC) == 1
    assert table.warnings[0].startswith("mu = 0 at joints 1, 2, 3, 4, 5, 6")
    t1, t2, r3 = 0.4, -0.9, 0.7
    s1, c1, s2, c2 = math.sin(t1), math.cos(t1), math.sin(t2), math.cos(t2)
    p = dh_matrices(table, [t1, t2, r3, 0.1, 0.2, 0.3]).T[:3, 3]
    expected = [r3 * c1 * s2 - 0.154 * s1, r3 * s1 * s2 + 0.154 * c1, r3 * c2]
    assert p == pytest.approx(expected, abs=1e-15)


def test_a_tree_has_branches_offsets_signs_and_inertias():
    table = read_par(TREE)
    assert [row.parent for row in table.rows] == [0, 1, 1, 2, 3]
    second, third, fourth, fifth = table.rows[1:]
    assert (second.sign, second.offset) == (-1, math.pi / 2)
    assert (third.gamma, third.b) == (math.pi / 3, 0.3)
    assert (fourth.type, fourth.offset, fourth.d) == (JointType.PRISMATIC, -0.1, 0)
    assert (fifth.type, fifth.theta) == (JointType.FIXED, math.pi / 5)
    body = table.rows[0].inertial
    assert (body.mass, body.com) == (4, (0.125, -0.0625, 0.25))
    c = np.array(body.com)
    J = np.array([[2.5, -0.1, 0], [-0.1, 2.25, 0.05], [0, 0.05, 1.5]])
    about_com = J - 4 * (c @ c * np.eye(3) - np.outer(c, c))
    assert np.abs(np.array(body.inertia) - about_com).max() < 1e-15
    assert [row.inertial for row in table.rows[1:]] == [None] * 4


@pytest.mark.parametrize(
    ("text", "values"), [(RX90, LENGTHS), (STANFORD, {"RL2": 0.154}), (TREE, None)]
)
def test_files_survive_being_read_and_written(text, values):
    table = read_par(text, values=values)
    written = table_to_par(table)
    again = read_par(written)
    assert again.rows == table.rows
    assert table_to_par(again) == written


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_khalil_or_modified_table_survives(tables, configurations, data):
    conventions = (Convention.KHALIL, Convention.MODIFIED)
    table = data.draw(tables(conventions=conventions, inertials=data.draw(st.booleans())))
    again = read_par(table_to_par(table))
    q = data.draw(configurations(table))
    expected, found = dh_matrices(table, q), dh_matrices(again, q)
    assert np.abs(found.T - expected.T).max() < 1e-12
    assert np.abs(found.T0[: len(table.rows)] - expected.T0).max() < 1e-13
    assert len(again.rows) == len(table.rows)
    for row, other in zip(table.rows, again.rows, strict=True):
        names = ("name", "type", "limits", "sign", "offset", "parent", "visual")
        assert [getattr(row, key) for key in names] == [getattr(other, key) for key in names]
        assert (row.inertial is None) == (other.inertial is None)
        if row.inertial is not None:
            assert other.inertial.mass == row.inertial.mass
            assert other.inertial.com == pytest.approx(row.inertial.com, rel=1e-15, abs=1e-15)
            difference = np.subtract(other.inertial.inertia, row.inertial.inertia)
            assert np.abs(difference).max() < 1e-14


@pytest.mark.parametrize(
    "path",
    [path for path in sorted(LIBRARY.glob("*.yaml")) if "joints:" in path.read_text()],
    ids=lambda path: path.stem,
)
def test_every_table_of_the_library_survives_or_says_what_to_do(path):
    table = read_yaml(path.read_text())
    if table.convention is Convention.STANDARD:
        with pytest.raises(DHError, match="convert it to khalil or modified first"):
            table_to_par(table)
        return
    again = read_par(table_to_par(table))
    q = np.random.default_rng(1).uniform(-3, 3, (20, table.dof))
    assert np.abs(dh_matrices(again, q).T - dh_matrices(table, q).T).max() < 1e-12
    assert [row.limits for row in again.rows] == [row.limits for row in table.rows]


def test_a_name_without_a_value_is_refused_at_its_cell():
    location, message = fault(RX90)
    assert location == ("joints", 2, "d")
    assert "joint 3: d is 'D3'" in message
    assert "give values D3:0.5" in message
    location, message = fault(RX90, values={"D3": 0.45, "R4": 1})
    assert location == ("joints", 3, "r")
    assert "unknown name 'RL4'" in message


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (LENGTHS | {"t2": 0.1}, ("t2", "joint variable takes none")),
        (LENGTHS | {"L9": 0.1}, ("L9", "no constant in the table")),
        (LENGTHS | {"D_3": 0.1}, ("'D_3' twice",)),
        ({"D3": "0.45*x"}, ("D3", "unknown name 'x'")),
        ({"D3": "q1"}, ("D3", "joint variable")),
        ({"D3": math.inf}, ("D3", "finite")),
        ({"D3": None}, ("D3", "no number")),
        ({"pi": 3}, ("'pi'", "give a letter")),
        ({3: 3}, ("names 3",)),
        ([1], ("a list",)),
    ],
)
def test_values_that_cannot_be_used_are_refused(values, words):
    location, message = fault(RX90, values=values)
    assert location[0] == "values"
    assert [word for word in words if word not in message] == []


def test_values_may_build_on_each_other_and_have_functions():
    text = STANFORD.replace("RL2", "L*cos(g) + atan2(0, 1)*0")
    location, message = fault(text, values={"L": 1, "g": 0})
    assert location == ("joints", 1, "r")
    assert "an angle; a length is needed" in message
    text = STANFORD.replace("RL2", "2*L*cos(g + pi/6)")
    table = read_par(text, values={"L": "100mm", "h": "15deg", "g": "2*h"})
    assert table.rows[1].d == pytest.approx(0.2 * math.cos(math.pi / 3), abs=1e-16)


def test_closed_loops_are_refused_or_cut():
    location, message = fault(SR400, values=SR400_LENGTHS)
    assert location == ("NJ",)
    assert "1 closed loop " in message
    assert "loops=cut" in message
    table = read_par(SR400, values=SR400_LENGTHS, cut_loops=True)
    assert (table.dof, [row.parent for row in table.rows]) == (8, [0, 1, 2, 3, 4, 5, 1, 7])
    assert "joint 9 and frames 10 are left out; joints 3, 8, passive" in table.warnings[0]


@pytest.mark.parametrize(
    ("old", "new", "location", "words"),
    [
        ("NJ = 6", "NJ = 7", ("NF",), ("NL = 6, NJ = 7, NF = 6", "2 NJ - NL")),
        ("NJ = 6", "NJ = six", ("NJ",), ("'six'", "integer")),
        ("d = {0,0,D3,0,0,0}", "d = {0,0,D3,0,0}", ("d",), ("d has 5 entries", "need 6")),
        ("XX = {XX1,", "XX = {", ("XX",), ("XX has 5 entries", "NL = 6")),
        ("Theta =", "Thta =", ("Thta",), ("line 19", "Thta is no list of SYMORO", "theta")),
        ("Theta = {t1,t2,t3,t4,t5,t6}", "", ("theta",), ("theta is missing",)),
        ("Theta =", "Theta = {}\nTheta =", ("theta",), ("stands twice",)),
        ("Sigma = {0,", "Sigma = {5,", ("joints", 0, "sigma"), ("sigma is '5'", "give 0")),
        ("Ant = {0,1", "Ant = {0,2", ("joints", 1, "ant"), ("ant is the joint itself",)),
        ("0,Pi/2", "0,Pi/x", ("joints", 1, "alpha"), ("joint 2", "'Pi/x'", "unknown name 'x'")),
        ("t1,t2", "t1,t8", ("joints", 1, "theta"), ("theta8", "no such joint")),
        ("t1,t2", "t1,2*t2", ("joints", 1, "theta"), ("coefficient",)),
        ("'RX90'", "'../rx'", ("name",), ("'../rx'", "use letters")),
        ("Z = {1,", "Z = {2,", ("base",), ("no rotation",)),
        ("Z = {1,", "Z = {q1,", ("Z",), ("entry 1 of Z is 'q1'",)),
        ("Z = {1,", "Z = {", ("Z",), ("15 entries",)),
        ("(* General", "(* (* General", (), ("line 3", "not closed")),
        ("NF = 6", "NF = 6\nis_floating = True", ("is_floating",), ("base that moves",)),
        ("NF = 6", "NF = 6\nhello", (), ("line 6", "'hello'", "neither")),
        ("NF = 6", "NF = 6\nd", (), ("neither",)),
    ],
)
def test_a_refusal_names_the_place_and_a_remedy(old, new, location, words):
    assert old in RX90
    found = fault(RX90.replace(old, new, 1), values=LENGTHS)
    assert found[0] == location
    assert [word for word in words if word not in found[1]] == []


def test_inertias_that_are_no_numbers_or_no_body_are_left_out_and_named():
    text = TREE.replace("M = {4,", "M = {Mtot,")
    table = read_par(text)
    assert table.rows[0].inertial is None
    assert "link 1: its inertial values are left out, since 'Mtot'" in table.warnings[0]
    assert read_par(text, values={"Mtot": 4}).rows[0].inertial.mass == 4
    for change in (("M = {4,", "M = {0,"), ("XX = {2.5", "XX = {0.1"), ("M = {4,", "M = {-4,")):
        assert "no body has them" in read_par(TREE.replace(*change)).warnings[0]


def test_an_angle_that_lost_its_digits_is_told():
    table = read_par(RX90.replace("0,Pi/2", "0,1.5708"), values=LENGTHS)
    assert table.rows[1].alpha == 1.5708
    assert "alpha is 1.5708" in table.warnings[0]
    assert "pi/2 is meant" in table.warnings[0]


def test_lists_may_be_broken_and_the_file_latin_1():
    text = RX90.replace("0,Pi/2", "0,\n  Pi/2").replace("General", "rue de la Noë (* nested *)")
    table = read_par(text.encode("latin-1"), name="mine", values=LENGTHS)
    assert (table.name, table.rows[1].alpha) == ("mine", math.pi / 2)


def test_a_file_without_a_name_takes_the_default_or_is_refused():
    text = re.sub(r"\(\* Robotname.*", "", RX90)
    assert read_par(text, values=LENGTHS).name == "robot"
    assert fault(text, values=LENGTHS, default_name=None)[0] == ("name",)


SCRAPS = st.sampled_from(
    [
        *"{}=,()*+-/ \n\x00é1",
        "(*",
        "*)",
        "Alpha",
        "theta = {t1}",
        "sigma = {0}",
        "d = {0}",
        "r={0}",
        "alpha={0}",
        "NJ = 1",
        "NL = 1",
        "th1",
        "Pi",
        "Z",
        "1e999",
        "(* Joint 1: lower = 2 *)",
        "(* Frame 1: tool *)",
        "(* Robotname = 'a' *)",
    ]
)


@settings(max_examples=300, deadline=None)
@given(st.lists(SCRAPS, max_size=30).map("\n".join) | st.text(max_size=80) | st.binary(max_size=80))
def test_any_text_is_refused_or_a_table(text):
    try:
        table = read_par(text, cut_loops=True)
    except DHError:
        return
    assert table.rows


@pytest.mark.parametrize("text", ["(*" * 100_000, "a=" * 100_000, "{" * 200_000, " \n" * 200_000])
def test_long_garbage_is_refused_at_once(text):
    with pytest.raises(DHError):
        parse_par(text)
