"""Values that are read as they stand and are probably meant in another unit."""

import math

import pytest

from dh_to_urdf import read_csv, read_mapping, read_pasted
from dh_to_urdf.cells.doubts import is_like_degree_limit, is_like_degrees, is_like_radians

ROW = {"name": "j1", "type": "R", "alpha": 0, "a": 0.3, "d": 0}


def read(row=None, **document):
    joints = [{**ROW, **(row or {})}, {**ROW, "name": "j2"}]
    return read_mapping({"name": "r", "convention": "standard", "joints": joints, **document})


@pytest.mark.parametrize("angle", [90, -90, 45, 30, 180, 270, 360, 900, 22.5, 10, 7.0])
def test_an_angle_over_a_turn_is_like_degrees(angle):
    assert is_like_degrees(angle)


@pytest.mark.parametrize("turns", [0, 0.25, 1, -1, 1.5, 2, 10, 1 / 3, 7 / 12 + 3])
@pytest.mark.parametrize("digits", [4, 15])
def test_a_multiple_of_fifteen_degrees_is_meant_in_rad(turns, digits):
    assert not is_like_degrees(round(2 * math.pi * turns, digits))


@pytest.mark.parametrize(
    "angle", [1.5708, -1.5708, 1.571, 1.57, 3.14, 3.1416, 3.14159, 0.7854, 0.5236, 1.0472, 6.2832]
)
def test_digits_of_rad_are_known_among_degrees(angle):
    assert is_like_radians(angle)


@pytest.mark.parametrize("angle", [0, 1, 1.5, 1.6, 3, 3.2, 0.79, 0.52, 2.36, 90, 15.71, 45.5])
def test_degrees_have_other_digits(angle):
    assert not is_like_radians(angle)


def test_limits_are_like_degrees_from_more_turns_on():
    assert is_like_degree_limit(180)
    assert not any(is_like_degree_limit(x) for x in (math.pi, 4 * math.pi, 8.3, 1000, 1e6))


@pytest.mark.parametrize(
    ("row", "document", "told"),
    [
        ({"alpha": 90}, {}, "alpha of joint 1 (j1) is 90 rad, which is 14 turns; degrees?"),
        ({"theta": "q1 - 90"}, {}, "theta of joint 1 (j1) is -90 rad"),
        ({"offset": 45}, {}, "offset of joint 1 (j1) is 45 rad"),
        ({"limits": {"lower": -180, "upper": 180}}, {}, "lower limit of joint 1 (j1) is -180 rad"),
        ({}, {"tool": {"rpy": [0, 90, 0]}}, "pitch of tool is 90 rad"),
        ({}, {"base": {"rpy": [180, 0, 0]}}, "roll of base is 180 rad"),
        ({"a": 300}, {}, "a of joint 1 (j1) is 300 m; millimetres?"),
        ({"a": 10}, {}, "a of joint 1 (j1) is 10 m; millimetres?"),
        ({}, {"tool": {"xyz": [0, 0, 107]}}, "z of tool is 107 m; millimetres?"),
        ({"type": "P", "theta": 0, "limits": {"lower": 0, "upper": 400}}, {}, "is 400 m"),
        ({"alpha": 1.5708}, {"units": {"angle": "deg"}}, "the digits of 90° in rad; radians?"),
        ({}, {"units": {"length": "mm"}}, "a of joint 1 (j1) is 0.3 mm"),
    ],
)
def test_a_doubtful_value_of_a_table_is_told_with_its_remedy(row, document, told):
    table = read(row, **document)
    (warning,) = table.doubts
    assert told in warning
    assert "then give" in warning
    assert table.warnings[0] == warning


def test_several_values_of_a_kind_are_one_sentence():
    table = read({"alpha": 90, "offset": 45}, tool={"rpy": [90, 0, 0]})
    assert "(and 2 more like it)" in table.doubts[0]
    assert len(table.doubts) == 1


@pytest.mark.parametrize(
    ("row", "document"),
    [
        ({}, {}),
        ({"alpha": "90deg", "a": "300mm"}, {}),
        ({"alpha": "pi/2", "offset": "-pi"}, {"units": {"angle": "deg"}}),
        ({"alpha": 90, "a": 300}, {"units": {"angle": "deg", "length": "mm"}}),
        ({"alpha": 2 * math.pi, "a": 4.2}, {}),
        ({"limits": {"lower": -4 * math.pi, "upper": 12.57, "velocity": 180}}, {}),
        ({}, {"base": {"xyz": [12, 30, 0]}}),
        ({"type": "P", "theta": 0, "limits": {"lower": -1000, "upper": 12}}, {}),
    ],
)
def test_a_right_table_has_no_doubt(row, document):
    assert read(row, **document).warnings == ()


def test_csv_and_pasted_text_name_their_own_remedy():
    text = "name,type,alpha,a,d,theta\nj1,R,90,300,0,0\n"
    angle, length = read_csv(text, "standard", "r").doubts
    assert "angle=deg" in angle
    assert "length=mm" in length
    assert read_csv(text, "standard", "r", "deg", "mm").warnings == ()
    pasted = "| i | α [deg] | a [mm] | d | θ |\n|---|---|---|---|---|\n| 1 | 90 | 300 | 0 | θ1 |\n"
    assert read_pasted(pasted, "standard").warnings == ()
