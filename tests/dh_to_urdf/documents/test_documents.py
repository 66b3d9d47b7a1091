import json

from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import read_json, read_mapping, table_to_urdf
from dh_to_urdf.documents.writing import table_to_mapping


@settings(deadline=None, max_examples=50)
@given(st.data())
def test_a_table_comes_back_bit_for_bit(tables, assert_same_table, data):
    table = data.draw(tables(inertials=data.draw(st.booleans())))
    assert_same_table(read_mapping(table_to_mapping(table)), table)


@settings(deadline=None, max_examples=20)
@given(st.data())
def test_a_table_comes_back_through_json_text(tables, assert_same_table, data):
    table = data.draw(tables(inertials=True))
    again = read_json(json.dumps(table_to_mapping(table)))
    assert_same_table(again, table)
    assert table_to_urdf(again) == table_to_urdf(table)


def test_a_document_says_no_more_than_it_needs():
    joints = [{"name": "j1", "type": "R", "alpha": 0, "a": 0.5, "d": 0, "theta": 1}]
    table = read_mapping({"name": "r", "convention": "craig", "joints": joints})
    assert table_to_mapping(table) == {
        "name": "r",
        "convention": "modified",
        "units": {"angle": "rad", "length": "m"},
        "joints": [
            {
                "name": "j1",
                "type": "revolute",
                "alpha": 0.0,
                "a": 0.5,
                "d": 0.0,
                "theta": 0.0,
                "offset": 1.0,
                "sign": 1,
            }
        ],
    }


def test_a_document_in_degrees_and_millimetres_comes_back_in_radians_and_metres(assert_same_table):
    joints = [
        {"type": "R", "alpha": 90, "a": 89.159, "d": 94.65, "theta": "q1 - 30"},
        {"type": "P", "alpha": -33.3, "a": 0, "d": "10 - d2", "theta": 0},
    ]
    units = {"angle": "deg", "length": "mm"}
    table = read_mapping({"convention": "dh", "units": units, "joints": joints})
    assert_same_table(read_mapping(table_to_mapping(table)), table)
