import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import Convention, read_csv, read_json, read_mapping, read_yaml
from dh_to_urdf.documents.layouts import document, to_csv, to_text, to_yaml

TABLE = {
    "name": "arm",
    "convention": "standard",
    "tool": {"xyz": [0, 0, 0.1]},
    "joints": [
        {
            "name": "j1",
            "type": "R",
            "alpha": "-pi/2",
            "a": 0.25,
            "d": 0.4,
            "theta": "q1+pi/6",
            "limits": {"lower": "-90deg", "upper": "90deg", "velocity": 2},
        },
        {"name": "j2", "type": "P", "alpha": "10deg", "a": 0, "d": 0.5, "theta": "pi", "sign": -1},
    ],
}


@settings(deadline=None, max_examples=50)
@given(st.data())
def test_yaml_and_csv_read_back_to_the_same_kinematics(elementary, tables, configurations, data):
    table = data.draw(tables(trees=False))
    degrees = data.draw(st.booleans())
    q = data.draw(configurations(table))
    expected = elementary.tip(table, q)
    unit = "deg" if degrees else "rad"
    for again in (
        read_yaml(to_yaml(document(table, degrees=degrees))),
        read_csv(to_csv(table, degrees=degrees), table.convention.value, "r", angle=unit),
    ):
        np.testing.assert_allclose(elementary.tip(again, q), expected, atol=1e-12, rtol=0)
        moving = [(row.name, row.type, row.sign) for row in table.rows if row.type != "fixed"]
        assert [(r.name, r.type, r.sign) for r in again.rows if r.type != "fixed"] == moving


def test_degrees_are_degrees():
    (first, second) = document(read_mapping(TABLE), degrees=True)["joints"]
    assert (first["alpha"], first["offset"], first["a"]) == (-90.0, 30.0, 0.25)
    assert first["limits"]["lower"] == -90.0
    assert first["limits"]["velocity"] == math.degrees(2)
    assert (second["alpha"], second["offset"], second["theta"]) == (10.0, 0.5, 180.0)


def test_what_a_document_says_of_itself_is_not_read():
    import json

    mapping = document(read_mapping(TABLE)) | {"residual": {"position": 0.0}, "explanation": []}
    assert read_json(json.dumps(mapping)).rows == read_mapping(TABLE).rows


def test_text_is_aligned_and_complete():
    lines = to_text(read_mapping(TABLE), degrees=True).splitlines()
    assert lines[0].startswith("arm, standard: Rz(theta)")
    start = lines[3].index("alpha")
    assert lines[4][start:].startswith("-90 ")
    assert "base: identity" in lines
    assert lines[lines.index("tool:") + 3].split() == [
        "0.000000000",
        "0.000000000",
        "1.000000000",
        "0.100000000",
    ]


def test_conventions_are_in_csv_headers():
    table = read_mapping(TABLE)
    assert to_csv(table).startswith("name,type,alpha,a,d,theta,offset,sign,lower,upper")
    from dh_to_urdf import to_convention

    khalil = to_csv(to_convention(table, Convention.KHALIL))
    assert khalil.startswith("name,type,alpha,d,theta,r,offset")
