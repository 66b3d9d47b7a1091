import copy
import datetime
import json
import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import (
    Convention,
    DHError,
    JointType,
    Limits,
    dh_matrices,
    read_csv,
    read_json,
    read_mapping,
    read_yaml,
    table_to_urdf,
)
from dh_to_urdf.documents.mapping import CONVENTION_ALIASES

ARM = {
    "name": "arm",
    "convention": "standard",
    "units": {"angle": "deg", "length": "mm"},
    "base": {"xyz": [0, 0, 100], "rpy": [0, 0, 90]},
    "tool": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 50], [0, 0, 0, 1]]},
    "joints": [
        {
            "name": "j1",
            "type": "revolute",
            "a": 0,
            "alpha": 90,
            "d": 672,
            "theta": 0,
            "limits": {"lower": -160, "upper": 160, "velocity": 90, "effort": 100},
        },
        {
            "name": "j2",
            "type": "revolute",
            "a": 431.8,
            "alpha": 0,
            "d": 0,
            "theta": "q2 - pi/2",
            "limits": {"lower": -45, "upper": 225},
        },
        {
            "name": "j3",
            "type": "prismatic",
            "a": 0,
            "alpha": 0,
            "d": 0,
            "theta": 30,
            "sign": -1,
            "offset": 20,
            "limits": {"lower": 0, "upper": "0.5m"},
            "inertial": {"mass": 2, "com": [1, 2, 3], "inertia": {"ixx": 1, "iyy": 1, "izz": 1}},
        },
        {"name": "j4", "type": "fixed", "a": 1, "alpha": 2, "d": 3, "theta": 4, "visual": False},
    ],
}
TREE = {
    "name": "tree",
    "convention": "khalil",
    "joints": [
        {"name": "j1", "sigma": 0, "mu": 1, "ant": 0, "alpha": 0, "d": 0, "theta": 0, "r": 0},
        {
            "name": "j2",
            "sigma": 1,
            "mu": 1,
            "ant": 1,
            "alpha": "pi/2",
            "d": 0.1,
            "theta": 0,
            "r": "r2",
            "gamma": "pi/3",
            "b": 0.4,
        },
        {"name": "j3", "sigma": 2, "mu": 0, "ant": 1, "alpha": 0, "d": 0.3, "theta": 0, "r": 0.2},
    ],
}
GONE = object()


def at(place):
    """``joints/2/alpha`` -> ``("joints", 2, "alpha")``."""
    return tuple(int(part) if part.isdigit() else part for part in place.split("/") if part)


def edited(document, place, value):
    """A copy of a document with one value set, or taken out."""
    document = copy.deepcopy(document)
    *path, last = at(place) if isinstance(place, str) else place
    target = document
    for step in path:
        target = target[step]
    if value is GONE:
        del target[last]
    else:
        target[last] = value
    return document


def locations(value, above=()):
    yield above
    children = value.items() if isinstance(value, dict) else ()
    children = enumerate(value) if isinstance(value, list) else children
    for key, child in children:
        yield from locations(child, (*above, key))


def faults(read, *args):
    with pytest.raises(DHError) as caught:
        read(*args)
    assert 1 <= len(caught.value.faults) <= 10
    return [(fault.location, fault.message) for fault in caught.value.faults]


def test_json_yaml_and_csv_give_equal_tables(assert_same_table):
    document = {key: ARM[key] for key in ("name", "convention", "units")}
    document["joints"] = [
        {key: value for key, value in row.items() if key not in ("inertial", "visual")}
        for row in ARM["joints"]
    ]
    yaml = """
        name: arm
        convention: standard
        units: {angle: deg, length: mm}
        joints:
        - {name: j1, type: revolute, a: 0, alpha: 90, d: 672, theta: 0,
           limits: {lower: -160, upper: 160, velocity: 90, effort: 100}}
        - {name: j2, type: revolute, a: 431.8, alpha: 0, d: 0, theta: q2 - pi/2,
           limits: {lower: -45, upper: 225}}
        - {name: j3, type: prismatic, a: 0, alpha: 0, d: 0, theta: 30, sign: -1, offset: 20,
           limits: {lower: 0, upper: 0.5m}}
        - {name: j4, type: fixed, a: 1, alpha: 2, d: 3, theta: 4}
    """
    csv = (
        "name,type,alpha,a,d,theta,offset,sign,lower,upper,velocity,effort\n"
        "j1,revolute,90,0,672,0,,,-160,160,90,100\n"
        "j2,R,0,431.8,0,q2 - pi/2,,,-45,225,,\n"
        "j3,P,0,0,0,30,20,-1,0,0.5m,,\n"
        "j4,fixed,2,1,3,4,,,,,,\n"
    )
    table = read_json(json.dumps(document))
    assert_same_table(read_yaml(yaml), table)
    assert_same_table(read_csv(csv, "standard", "arm", "deg", "mm"), table)
    assert_same_table(read_csv(csv.encode(), "DH", "arm", "deg", "mm"), table)


def test_a_table_is_stored_in_radians_and_metres():
    table = read_mapping(ARM)
    first, second, third, fourth = table.rows
    assert (table.name, table.convention, table.dof) == ("arm", Convention.STANDARD, 3)
    assert (first.alpha, first.a, first.d, first.theta) == (math.pi / 2, 0, 0.672, 0)
    assert first.limits.lower == math.radians(-160)
    assert (first.limits.velocity, first.limits.effort) == (math.pi / 2, 100)
    assert (second.a, second.offset, second.theta, second.sign) == (0.4318, -math.pi / 2, 0, 1)
    assert (third.type, third.theta) == (JointType.PRISMATIC, math.radians(30))
    assert (third.d, third.offset, third.sign, third.limits.upper) == (0, 0.02, -1, 0.5)
    assert (third.inertial.mass, third.inertial.com) == (2, (0.001, 0.002, 0.003))
    assert third.inertial.inertia == ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    assert (fourth.type, fourth.visual, first.visual) == (JointType.FIXED, False, True)
    assert table.base[:3, 3].tolist() == [0, 0, 0.1]
    assert np.allclose(table.base[:3, :3], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert table.tool[:3, 3].tolist() == [0, 0, 0.05]


def test_a_tree_keeps_the_columns_of_khalil():
    table = read_mapping(TREE)
    assert [row.type.value for row in table.rows] == ["revolute", "prismatic", "fixed"]
    assert [row.parent for row in table.rows] == [0, 1, 1]
    assert (table.rows[1].gamma, table.rows[1].b, table.rows[1].a) == (math.pi / 3, 0.4, 0.1)
    assert table.rows[2].d == 0.2


@pytest.mark.parametrize(
    ("alias", "convention"),
    [
        *((alias, "standard") for alias in ("standard", "dh", "sdh", "distal", "paul", "Paul")),
        *((alias, "modified") for alias in ("modified", "mdh", "craig", "proximal", " MDH ")),
        *((alias, "khalil") for alias in ("khalil", "khalil-kleinfinger", "Khalil-Kleinfinger")),
    ],
)
def test_every_name_of_a_convention_is_understood(alias, convention):
    z_column = "r" if convention == "khalil" else "a"
    row = {"type": "R", "alpha": 0, "d": 0, z_column: 0}
    table = read_mapping({"convention": alias, "joints": [row]})
    assert table.convention.value == convention
    assert alias.strip().lower() in CONVENTION_ALIASES


@pytest.mark.parametrize(
    ("written", "type_"),
    [
        ("R", "revolute"),
        ("p", "prismatic"),
        ("C", "continuous"),
        ("f", "fixed"),
        ("FIXED", "fixed"),
    ],
)
def test_types_have_short_names(written, type_):
    row = {"type": written, "alpha": 0, "a": 0, "d": 0, "theta": 0}
    assert read_mapping({"convention": "dh", "joints": [row]}).rows[0].type.value == type_


def test_names_are_optional():
    row = {"type": "R", "alpha": 0, "a": 0, "d": 0}
    table = read_mapping({"convention": "dh", "joints": [row, row]})
    assert (table.name, [r.name for r in table.rows]) == ("robot", ["j1", "j2"])


def test_a_constant_in_the_variables_own_column_is_an_offset():
    joints = [
        {"type": "R", "alpha": 0, "a": 0, "d": 0.1, "theta": 0.5, "offset": 0.25},
        {"type": "P", "alpha": 0, "a": 0, "d": 0.1, "theta": 0.5, "offset": 0.25},
        {"type": "R", "alpha": 0, "a": 0, "d": 0, "theta": "1 - q"},
        {"type": "P", "alpha": 0, "a": 0, "d": "-d4 + 10cm", "theta": 0, "sign": -1},
    ]
    rows = read_mapping({"convention": "mdh", "joints": joints}).rows
    assert [(r.d, r.theta, r.offset, r.sign) for r in rows] == [
        (0.1, 0, 0.75, 1),
        (0, 0.5, 0.35, 1),
        (0, 0, 1, -1),
        (0, 0, 0.1, -1),
    ]


@pytest.mark.parametrize(
    "placement",
    [
        {"xyz": [1, 2, 3], "rpy": ["90deg", 0, "pi/2"]},
        {"xyz": [1, 2, 3], "quaternion_xyzw": [0.5, 0.5, 0.5, 0.5]},
        {"xyz": ["1m", "200cm", "3000mm"], "quaternion_xyzw": [-0.5, -0.5, -0.5, -0.5]},
        {"matrix": [[0, 0, 1, 1], [1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 0, 1]]},
        [[0, 0, 1, 1], [1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 0, 1]],
    ],
)
def test_placements_have_several_forms(placement):
    table = read_mapping(edited(TREE, "base", placement))
    expected = [[0, 0, 1, 1], [1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 0, 1]]
    assert np.abs(table.base - expected).max() < 1e-15
    assert table.warnings == ()


def test_a_rounded_matrix_is_mended_and_the_warning_says_by_how_much():
    c, s = round(math.cos(0.7), 6), round(math.sin(0.7), 6)
    matrix = [[c, -s, 0, 0.5], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    table = read_mapping(edited(TREE, "tool", {"matrix": matrix}))
    R = table.tool[:3, :3]
    assert np.abs(R.T @ R - np.eye(3)).max() < 1e-15
    change = np.abs(table.tool - matrix).max()
    assert 0 < change < 1e-6
    assert len(table.warnings) == 1
    assert "tool" in table.warnings[0]
    assert f"{change:.1e}" in table.warnings[0]


SKEWED = [[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
MIRROR = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]
SCALED = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 2]]
J2, J3 = "joint 2 (j2)", "joint 3 (j3)"


@pytest.mark.parametrize(
    ("document", "where", "value", "place", "words"),
    [
        (ARM, "convention", GONE, "", ("missing", "standard (distal, Paul)", "khalil")),
        (ARM, "convention", None, "", ("missing", "standard (distal, Paul)")),
        (ARM, "convention", "denavit", "", ("'denavit'", "unknown", "modified (proximal, Craig)")),
        (ARM, "convention", ["dh"], "", ("a list", "give standard")),
        (ARM, "name", "../etc", "", ("'../etc'", "use letters, digits")),
        (ARM, "name", 7, "", ("7", "use letters")),
        (ARM, "units", "deg", "", ("mapping", '{"angle": "deg", "length": "mm"}')),
        (ARM, "units/angle", "grad", "", ("'grad'", "rad or deg")),
        (ARM, "units/length", "inch", "", ("'inch'", "m or mm")),
        (ARM, "units/mass", "kg", "", ("unknown field 'mass'", "angle, length")),
        (ARM, "gravity", 9.81, "", ("unknown field 'gravity'", "known are name, convention")),
        (ARM, "title", 5, "", ("title is 5", "give a text")),
        (ARM, "joints", GONE, "", ("missing", "list")),
        (ARM, "joints", [], "", ("empty", "list")),
        (ARM, "joints", {"j1": {}}, "", ("list with one entry a joint",)),
        (ARM, "joints/1", 5, "", ("joint 2 is 5", "give a mapping")),
        (ARM, "joints/1", [0, 0, 0, 0], "", ("joint 2 is a list", "give a mapping")),
        (ARM, "joints/1/alpha", math.nan, "", (J2, "alpha", "NaN", "give a finite number")),
        (ARM, "joints/1/alpha", math.inf, "", (J2, "infinite", "give a finite number")),
        (ARM, "joints/1/alpha", "foo", "", (J2, "'foo'", "unknown name")),
        (ARM, "joints/1/alpha", GONE, "", (J2, "alpha is missing", "0 if it is zero")),
        (ARM, "joints/1/a", GONE, "", (J2, "a is missing", "give it")),
        (ARM, "joints/1/d", GONE, "", (J2, "d is missing", "give it")),
        (ARM, "joints/2/theta", GONE, "", (J3, "theta is missing", "give it")),
        (ARM, "joints/1/a", None, "", (J2, "a is None", "give a number")),
        (ARM, "joints/1/a", True, "", (J2, "a is True", "give a number")),
        (ARM, "joints/1/a", "1,234", "", (J2, "two numbers", "decimal point")),
        (ARM, "joints/1/a", 1e12, "", (J2, "beyond", "check its unit")),
        (ARM, "joints/1/a", "q2", "", (J2, "'q2'", "variable belongs in theta")),
        (ARM, "joints/1/d", "d2", "", (J2, "'d2'", "variable belongs in theta")),
        (ARM, "joints/1/theta", "d2", "", (J2, "'d2'", "belongs")),
        (ARM, "joints/1/theta", "q7", "", (J2, "variable q7", "no such joint", "values q7:0.5")),
        (ARM, "joints/3/theta", "q4", "", ("joint 4 (j4)", "belongs")),
        (ARM, "joints/1/r", 0.3, "", (J2, "khalil convention only", "write a for")),
        (ARM, "joints/1/ant", 0, "", (J2, "unknown field 'ant'", "known are")),
        (ARM, "joints/1/A", 0, "", (J2, "unknown field 'A'", "known are")),
        (ARM, "joints/1/a~1b~0", 0, "", (J2, "unknown field 'a~1b~0'")),
        (ARM, "joints/1/name", "j1", "", ("joint 2", "'j1'", "joint 1", "its own")),
        (ARM, "joints/1/name", "j\n2", "", ("joint 2", "use letters")),
        (ARM, "joints/1/name", "", "", ("joint 2", "''", "use letters")),
        (ARM, "joints/1/name", "x" * 65, "", ("joint 2", "at most 64")),
        (ARM, "joints/1/name", None, "", ("joint 2", "None", "use letters")),
        (ARM, "joints/1/type", GONE, "", (J2, "type is missing", "give revolute")),
        (ARM, "joints/1/type", "floating", "", (J2, "'floating'", "give revolute")),
        (ARM, "joints/1/type", 0, "", (J2, "type is 0", "give revolute")),
        (ARM, "joints/1/sign", 0, "", (J2, "sign is 0", "give 1 or -1")),
        (ARM, "joints/1/sign", "minus", "", (J2, "sign is 'minus'", "give 1 or -1")),
        (ARM, "joints/1/sign", 1.5, "", (J2, "sign is 1.5", "give 1 or -1")),
        (ARM, "joints/1/sign", -1, "", (J2, "sign is -1", "keep one of the two")),
        (ARM, "joints/1/offset", "q2", "", (J2, "'q2'", "belongs")),
        (ARM, "joints/1/limits", [0, 1], "", (J2, "a list", "give lower and upper")),
        (ARM, "joints/1/limits/lower", GONE, "", (J2, "lower is missing", "both or none")),
        (ARM, "joints/1/limits/upper", GONE, "", (J2, "upper is missing", "both or none")),
        (ARM, "joints/1/limits/lower", 226, "", (J2, "226", "above upper 225", "swap them")),
        (ARM, "joints/1/limits/lower", math.nan, "", (J2, "lower is NaN", "finite")),
        (ARM, "joints/1/limits/lower", "q2", "", (J2, "lower holds a joint variable")),
        (ARM, "joints/1/limits/lower", "1m", "", (J2, "lower", "a length", "an angle is needed")),
        (ARM, "joints/1/limits/velocity", -1, "", (J2, "velocity is negative")),
        (ARM, "joints/1/limits/effort", -1, "", (J2, "effort is negative")),
        (ARM, "joints/1/limits/min", -1, "", (J2, "unknown field 'min'", "known are lower")),
        (ARM, "joints/1/type", "continuous", "joints/1/limits", (J2, "use revolute")),
        (ARM, "joints/2/visual", "no", "", (J3, "true or false")),
        (ARM, "joints/2/inertial", 5, "", (J3, "inertial is not a mapping with mass")),
        (ARM, "joints/2/inertial/mass", GONE, "joints/2/inertial", (J3, "with mass")),
        (ARM, "joints/2/inertial/mass", -1, "", (J3, "mass is negative")),
        (ARM, "joints/2/inertial/mass", "x", "joints/2/inertial", (J3, "unknown name")),
        (ARM, "joints/2/inertial/com", [1, 2], "joints/2/inertial", (J3, "com", "list of 3")),
        (ARM, "joints/2/inertial/inertia/ixx", 5, "joints/2/inertial/inertia", (J3, "no body")),
        (ARM, "joints/2/inertial/inertia/xx", 5, "joints/2/inertial", (J3, "unknown field 'xx'")),
        (
            ARM,
            "joints/2/inertial/inertia",
            [[1, 2, 3], [0, 1, 0], [0, 0, 1]],
            "joints/2/inertial",
            (J3, "not symmetric"),
        ),
        (ARM, "joints/2/inertial/inertia", 5, "joints/2/inertial", (J3, "neither a 3x3 matrix")),
        (ARM, "base", "origin", "", ("base is 'origin'", 'give {"xyz"')),
        (ARM, "base", 5, "", ("base is 5", 'give {"xyz"')),
        (ARM, "base/xyz", [0, 0], "base", ("xyz is not a list of 3 numbers",)),
        (ARM, "base/rpy", [0, 0, 0, 0], "base", ("rpy is not a list of 3 numbers",)),
        (ARM, "base/rpy", 0, "base", ("rpy is not a list of 3 numbers",)),
        (ARM, "base/rpy", [0, 0, "q1"], "base", ("rpy holds a joint variable", "give numbers")),
        (ARM, "base/xyz", [0, 0, math.nan], "base", ("xyz is NaN", "give a finite number")),
        (ARM, "base/quaternion_xyzw", [0, 0, 0, 1], "base", ("rpy and quaternion", "give one")),
        (ARM, "base", {"quaternion_xyzw": [0, 0, 0]}, "", ("list of 4 numbers",)),
        (ARM, "base", {"quaternion_xyzw": [0, 0, 0, 0]}, "", ("unit quaternion", "divide it")),
        (ARM, "base", {"quaternion_xyzw": [1, 1, 0, 0]}, "", ("unit quaternion", "divide it")),
        (ARM, "base/euler", [0, 0, 0], "base", ("unknown field 'euler'", 'give {"xyz"')),
        (ARM, "tool/xyz", [0, 0, 0], "tool", ("matrix and 1 other field(s)", "give one form")),
        (ARM, "tool/matrix", [[1, 0], [0, 1]], "tool", ("not four rows of four numbers",)),
        (ARM, "tool/matrix", [[1, 0, 0, 0]] * 3, "tool", ("not four rows of four numbers",)),
        (ARM, "tool/matrix", SKEWED, "tool", ("no rotation", "orthonormal", "give more digits")),
        (ARM, "tool/matrix", MIRROR, "tool", ("no rotation", "right-handed")),
        (ARM, "tool/matrix", SCALED, "tool", ("last row other than 0 0 0 1",)),
        (TREE, "joints/1/a", 0, "", (J2, "khalil has no column a", "d is the length along x")),
        (TREE, "joints/1/d", GONE, "", (J2, "d is missing")),
        (TREE, "joints/2/r", GONE, "", (J3, "r is missing")),
        (TREE, "joints/1/sigma", GONE, "joints/1/type", (J2, "type is missing")),
        (TREE, "joints/1/sigma", 3, "", (J2, "sigma is 3", "0 (revolute), 1 (prismatic)")),
        (TREE, "joints/1/sigma", 1e400, "", (J2, "sigma is inf", "give 0 (revolute)")),
        (
            TREE,
            "joints/1/type",
            "revolute",
            "joints/1/sigma",
            (J2, "sigma says prismatic but type says revolute"),
        ),
        (TREE, "joints/1/mu", 2, "", (J2, "mu is 2", "give 1 (moved) or 0")),
        (TREE, "joints/1/ant", 2, "", (J2, "ant is the joint itself", "closed loops")),
        (TREE, "joints/1/ant", 3, "", (J2, "ant is 3, a later row", "after its antecedent")),
        (TREE, "joints/1/ant", 4, "", (J2, "ant is 4, but the last frame is 3")),
        (TREE, "joints/1/ant", -1, "", (J2, "ant is -1", "0 for the base")),
        (TREE, "joints/1/ant", "j1", "", (J2, "ant is 'j1'", "give the number")),
        (TREE, "joints/1/ant", 0.5, "", (J2, "ant is 0.5", "give the number")),
    ],
)
def test_a_refusal_names_the_place_the_joint_and_a_remedy(document, where, value, place, words):
    read_mapping(document)
    found = faults(read_mapping, edited(document, where, value))
    assert len(found) == 1
    assert found[0][0] == at(place or where)
    assert [word for word in words if word not in found[0][1]] == []


def test_several_faults_come_in_the_order_of_the_document():
    document = edited(edited(ARM, "joints/1/alpha", "foo"), "joints/2/a", math.nan)
    found = faults(read_mapping, document)
    assert [location for location, _ in found] == [at("joints/1/alpha"), at("joints/2/a")]


def test_at_most_ten_faults_are_told_of_a_bad_document():
    document = {"convention": "dh", "joints": [{"type": "R"}] * 100}
    with pytest.raises(DHError, match=re.escape("(and 299 more)")) as caught:
        read_mapping(document)
    assert len(caught.value.faults) == 10


def test_three_hundred_rows_are_read_and_no_more():
    row = {"type": "R", "alpha": 0, "a": 0, "d": 0}
    assert len(read_mapping({"convention": "dh", "joints": [row] * 300}).rows) == 300
    found = faults(read_mapping, {"convention": "dh", "joints": [row] * 301})
    assert found == [(("joints",), "joints has 301 rows; at most 300 are read")]


@pytest.mark.parametrize("document", [None, 5, "text", [], [ARM], True, 1.5])
def test_a_document_that_is_no_mapping_is_refused(document):
    assert faults(read_mapping, document)[0][0] == ()
    assert "not a mapping" in faults(read_json, json.dumps(document))[0][1]
    assert "not a mapping" in faults(read_yaml, json.dumps(document))[0][1]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not JSON"),
        ("{", "not JSON"),
        ('{"a": 1,}', "not JSON"),
        (b"\xff\xfe\x00", "not JSON"),
        ("[" * 100_000, "nested too deeply"),
        ('{"name": ' + "1" * 5000 + "}", "cannot be read"),
        ('{"name": "a", "name": "b"}', "'name' stands twice in one object; keep one"),
        ('{"joints": [{"alpha": 0, "alpha": 1}]}', "'alpha' stands twice"),
        ("{" + '"a":1,' * 100_000 + '"b":1}', "'a' stands twice"),
    ],
)
def test_bad_json_is_refused(text, reason):
    ((location, message),) = faults(read_json, text)
    assert (location, reason in message) == ((), True)


def test_json_bytes_are_utf_8_with_or_without_mark():
    text = json.dumps(ARM)
    for encoding in ("utf-8", "utf-8-sig"):
        assert len(read_json(text.encode(encoding)).rows) == 4
    for encoding in ("utf-16", "utf-32"):
        with pytest.raises(DHError, match="it is not UTF-8; save it so"):
            read_json(text.encode(encoding))
    for nothing in (b"", " \n", b"\xef\xbb\xbf"):
        with pytest.raises(DHError, match="it is empty; send a table"):
            read_json(nothing)


@pytest.mark.parametrize("field", ["ant", "sigma", "mu"])
def test_whole_numbers_are_written_in_digits_0_to_9(field):
    number = TREE["joints"][0][field]
    assert read_mapping(edited(TREE, f"joints/0/{field}", f"{number}"))
    arabic = chr(0x660 + number)
    ((location, _),) = faults(read_mapping, edited(TREE, f"joints/0/{field}", arabic))
    assert location == ("joints", 0, field)


def test_nan_in_json_is_found_where_it_stands():
    document = edited(ARM, "joints/2/alpha", math.nan)
    assert faults(read_json, json.dumps(document))[0][0] == ("joints", 2, "alpha")


ROW = "joints: [{type: R, alpha: 0, a: 0, d: 0}]\n"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not a mapping"),
        ("a: b: c", "line 1, column 5"),
        ("a: [1, 2", "not YAML"),
        ("a: 'x", "not YAML"),
        ("\ta: 1", "line 1"),
        ("a: 1\na: 2\n", "duplicate key"),
        ("convention: dh\n" + ROW + "---\n" + ROW, "another document"),
        ("name: !foo x", "tag '!foo'"),
        ("name: !!python/object/apply:os.system [ls]", "tag"),
        ("a: *nowhere", "alias"),
        ("name: 2001-99-99", "not YAML of plain keys and values"),
        ("name: \x00", "not YAML"),
        (b"name: \xe9", "not YAML"),
        ("- " * 2000, "nested too deeply"),
        ("{a: " * 2000, "nested too deeply"),
    ],
)
def test_bad_yaml_is_refused(text, reason):
    ((location, message),) = faults(read_yaml, text)
    assert (location, reason in message) == ((), True)


@pytest.mark.parametrize(
    "value",
    ["2001-01-01", "2001-01-01T00:00:00Z", "!!binary YQ==", "!!set {a, b}", "!!omap [a: 1]", "~"],
)
def test_yaml_values_that_json_does_not_have_are_refused_like_others(value):
    found = faults(read_yaml, f"name: {value}\nconvention: dh\n" + ROW)
    assert [location for location, _ in found] == [("name",)]


def test_yaml_bytes_are_utf_8_with_or_without_mark():
    text = "name: épaule\nconvention: dh\n" + ROW
    for encoding in ("utf-8", "utf-8-sig"):
        assert read_yaml(text.encode(encoding)).name == "épaule"
    assert faults(read_yaml, text.encode("latin-1")) == [
        ((), "the text is not YAML: it is not UTF-8")
    ]


@pytest.mark.parametrize("field", ["name", "sigma", "title", "joints"])
def test_huge_numbers_are_not_echoed(field):
    huge = "0x" + "f" * 5000
    for text in (f"{field}: {huge}\n", f"convention: khalil\njoints: [{{{field}: {huge}}}]\n"):
        for _, message in faults(read_yaml, text):
            assert len(message) < 300


def test_yaml_keys_may_be_anything_and_are_unknown_fields():
    text = "3: a\n2.5: b\n[1, 2]: c\ntrue: d\n~: e\n2001-01-01: f\nconvention: dh\n" + ROW
    found = faults(read_yaml, text)
    assert len(found) == 6
    assert all("unknown field" in message for _, message in found)


def test_yaml_aliases_are_refused():
    """Merged and nested they take exponential time, and a table is short without them."""
    for text in (
        "convention: dh\njoints:\n- &row {type: R, alpha: 0, a: 1, d: 0}\n- *row\n",
        "convention: dh\njoints: &a [*a]\n",
    ):
        ((location, message),) = faults(read_yaml, text)
        assert location == ()
        assert "alias" in message


@pytest.mark.parametrize("name", ["3_dof", "2_a", "pa_10", "arm_1e5", "6r_0x"])
def test_names_that_only_look_like_numbers_are_names(name):
    row = "joints: [{type: R, a: 1, alpha: 0, d: 0}]"
    table = read_yaml(f"name: {name}\nconvention: standard\n{row}\n")
    assert table.name == name


@pytest.mark.parametrize("number", ["1_000", "-1_0.5", "1e1_0", "0x1_f", "0o1_7", "0b11"])
def test_numbers_of_an_older_yaml_are_refused(number):
    row = f"joints: [{{type: R, a: {number}, alpha: 0, d: 0}}]"
    with pytest.raises(DHError, match=r"line 2 .* no number in YAML 1\.2"):
        read_yaml(f"convention: standard\n{row}\n")


def test_angles_over_a_turn_that_are_read_in_rad_get_a_warning():
    text = "{unit}convention: standard\njoints: [{{type: R, a: 1, alpha: {alpha}, d: 0}}]"
    said = "units: {angle: rad}\n"
    for unit in ("", said):
        (warning,) = read_yaml(text.format(unit=unit, alpha=90)).warnings
        assert warning.startswith("alpha of joint 1 is 90 rad, which is 14 turns; degrees? then")
    for unit, alpha in (("", "90°"), ("", "2*pi"), (said.replace("rad", "deg"), 90)):
        assert read_yaml(text.format(unit=unit, alpha=alpha)).warnings == ()


@pytest.mark.parametrize("date", ["2026-01-02", "1/2/2026", " 01/02/2026"])
def test_what_spreadsheets_make_of_a_fraction_is_no_sum(date):
    with pytest.raises(DHError, match="looks like a date"):
        read_csv(f"type,alpha,a,d\nR,{date},1,0\n", "standard")


def test_a_second_byte_order_mark_is_named():
    with pytest.raises(DHError, match="a byte order mark too many"):
        read_json(b"\xef\xbb\xbf\xef\xbb\xbf{}")


def test_yaml_is_version_1_2():
    table = read_yaml("name: no\nconvention: dh\njoints: [{type: R, alpha: 0, a: 1e2, d: 010}]")
    assert (table.name, table.rows[0].a, table.rows[0].d) == ("no", 100, 10)


@pytest.mark.parametrize(
    "text",
    [
        'name,type,alpha,a,d,theta\nj1,R,pi/2,"0,4",0,0\n',
        "name;type;alpha;a;d;theta\nj1;R;pi/2;0,4;0;0\n",
        "name\ttype\talpha\ta\td\ttheta\nj1\tR\tpi/2\t0,4\t0\t0\n",
        "\ufeffname,type,alpha,a,d,theta\r\nj1,R,pi/2,0.4,0,0\r\n",
        "Name, Type, ALPHA, a , d, theta\n\n j1 , R , pi/2 , 0.4 , 0 , 0 \n\n",
        "theta,d,a,alpha,type,name\n,0,0.4,pi/2,R,j1",
    ],
)
def test_csv_dialects_of_spreadsheets_are_read(text):
    for content in (text, text.encode()):
        (row,) = read_csv(content, "standard").rows
        assert (row.name, row.alpha, row.a, row.d) == ("j1", math.pi / 2, 0.4, 0)


def test_csv_of_khalil_has_its_own_columns():
    text = "ant,sigma,mu,gamma,b,alpha,d,theta,r\n0,0,1,0,0,0,0,0,0.1\n1,1,1,0.5,2,0,0.3,0,r2\n"
    first, second = read_csv(text, "khalil").rows
    assert (first.type, first.parent, first.d) == (JointType.REVOLUTE, 0, 0.1)
    assert (second.type, second.gamma, second.b, second.a) == (JointType.PRISMATIC, 0.5, 2, 0.3)


def test_csv_limits_become_limits_and_empty_cells_nothing():
    text = "type,alpha,a,d,lower,upper,velocity,effort\nR,0,0,0,-90deg,pi,,10\nR,0,0,0,,,,\n"
    first, second = read_csv(text, "dh").rows
    assert first.limits == Limits(-math.pi / 2, math.pi, None, 10)
    assert second.limits == Limits()


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("", "", ("empty", "first line names the columns")),
        ("\n \n", "", ("empty",)),
        (b"\xff\xfe", "", ("not UTF-8",)),
        ('a,"b\n', "", ("not CSV",)),
        ("a,alpha,A\n1,2,3\n", "", ("names 'a' twice",)),
        (",".join(f"c{k}" for k in range(33)), "", ("33 columns",)),
        ("type,alpha,a,d\n", "joints", ("empty", "one entry a joint")),
        (
            "type,alpha,a,d\nR,0,0,4,0\n",
            "joints/0",
            ("line 2 has 5 cells under 4 columns", "quote a cell", "semicolons"),
        ),
        ("type,alpha,a,d\nR,0,0,4\nR,0\n", "joints/1", ("line 3 has 2 cells",)),
        ("type,alpha,d\nR,0,0\n", "joints/0/a", ("joint 1: column a is missing", "give it")),
        ("type,alpha,a,d\nR,0,,0\n", "joints/0/a", ("joint 1: a is missing", "give it")),
        ("type,alpha,a,d,color\nR,0,0,0,red\n", "joints/0/color", ("unknown field 'color'",)),
        ("type,alpha,r,d\nR,0,0,0\n", "joints/0/r", ("joint 1: r is a column of the khalil",)),
        ("name,type,alpha,a,d\nx,R,0,foo,0\n", "joints/0/a", ("joint 1 (x)", "'foo'")),
        ("type,alpha,a,d,lower,upper\nR,0,0,0,2,1\n", "joints/0/limits/lower", ("swap them",)),
    ],
)
def test_bad_csv_is_refused(text, place, words):
    found = faults(read_csv, text, "standard")
    assert at(place) in [location for location, _ in found]
    message = next(message for location, message in found if location == at(place))
    assert [word for word in words if word not in message] == []


def test_csv_needs_a_convention():
    found = faults(read_csv, "type,alpha,a,d\nR,0,0,0\n", None)
    assert found[0][0] == ("convention",)
    assert "missing" in found[0][1]


@pytest.mark.parametrize(("angle", "length"), [("grad", "m"), ("rad", "inch")])
def test_csv_units_are_checked(angle, length):
    found = faults(read_csv, "type,alpha,a,d\nR,0,0,0\n", "dh", None, angle, length)
    assert found[0][0] == ("units", "angle" if angle == "grad" else "length")


ODD = (
    st.none()
    | st.booleans()
    | st.integers(-(10**20), 10**20)
    | st.sampled_from([0, 1, -1, 2, 10**300, -(10**300), 1e308, 0.0, "q1", "R", "1,234", "0"])
    | st.floats()
    | st.text(max_size=70)
    | st.binary(max_size=3)
    | st.just(datetime.date(2001, 1, 1))
    | st.just(frozenset({1}))
)
KEYS = st.text(max_size=10) | st.integers() | st.none() | st.just((1, 2)) | st.floats()
KNOWN = st.sampled_from(
    ["name", "type", "a", "r", "limits", "lower", "mu", "ant", "sigma", "matrix"]
)
ANYTHING = st.recursive(
    ODD,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS | KNOWN, inner, max_size=4),
    max_leaves=8,
)


def refused_or_usable(document):
    try:
        table = read_mapping(document)
    except DHError as error:
        found = error.faults
    else:
        assert np.isfinite(dh_matrices(table, np.full(table.dof, 0.3)).T0).all()
        assert table_to_urdf(table).startswith("<?xml")
        return
    assert 1 <= len(found) <= 10
    assert all(isinstance(part, (str, int)) for fault in found for part in fault.location)
    assert all(len(fault.message) < 500 for fault in found)


@settings(max_examples=200, deadline=None)
@given(ANYTHING)
def test_arbitrary_data_is_refused_and_nothing_else(document):
    refused_or_usable(document)


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_a_table_with_one_arbitrary_value_is_refused_or_usable(data):
    document = data.draw(st.sampled_from([ARM, TREE]))
    where = data.draw(st.sampled_from([p for p in locations(document) if p]))
    refused_or_usable(edited(document, where, data.draw(ANYTHING)))


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_a_table_with_one_field_more_or_less_is_refused_or_usable(data):
    document = data.draw(st.sampled_from([ARM, TREE]))
    places = [p for p in locations(document) if p]
    where = data.draw(st.sampled_from(places))
    if data.draw(st.booleans()):
        return refused_or_usable(edited(document, where, GONE))
    key = data.draw(KNOWN | st.sampled_from(["mass", "com", "inertia", "xyz", "quaternion_xyzw"]))
    edit = copy.deepcopy(document)
    target = edit
    for step in where[:-1]:
        target = target[step]
    if isinstance(target, dict):
        target[key] = data.draw(ANYTHING)
    return refused_or_usable(edit)


SCRAPS = st.sampled_from(
    [
        *"ab:-?&*[]{}|>%'\"#, \n\t017.eE+;=\x00\r\ufeff",
        "a,b,c\n",
        "alpha",
        "type",
        "- ",
        "nan",
        "pi/2",
    ]
)


@pytest.mark.filterwarnings("ignore::Warning")
@settings(max_examples=200, deadline=None)
@given(st.lists(SCRAPS, max_size=30).map("".join) | st.text(max_size=60) | st.binary(max_size=60))
def test_any_text_is_refused_or_a_table(text):
    for read in (read_json, read_yaml, lambda text: read_csv(text, "standard")):
        try:
            table = read(text)
        except DHError:
            continue
        assert table.rows
