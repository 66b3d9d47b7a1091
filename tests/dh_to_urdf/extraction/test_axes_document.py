import math

import numpy as np
import pytest

from dh_to_urdf import Convention, DHError, dh_matrices, extract, read_axes

TWO_R = {
    "name": "two_r",
    "units": {"angle": "deg", "length": "mm"},
    "joints": [
        {
            "name": "a",
            "type": "R",
            "point": [0, 0, 100],
            "direction": [0, 0, 7],
            "limits": {"lower": -90, "upper": 90},
        },
        {
            "name": "b",
            "type": "P",
            "point": ["400", 0, 300],
            "direction": [0, 1, 0],
            "limits": {"lower": -10, "upper": 10},
        },
    ],
    "tip": {"xyz": [900, 0, 300], "rpy": [0, 90, 0]},
}


def test_axes_of_a_drawing_become_a_table():
    chain = read_axes(TWO_R)
    for convention in Convention:
        table = extract(chain, convention).table
        T = dh_matrices(table, [math.pi / 2, 0.01]).T
        np.testing.assert_allclose(T[:3, 3], [-0.01, 0.9, 0.3], atol=1e-15)
        np.testing.assert_allclose(T[:3, 2], [0, 1, 0], atol=1e-15)
        limits = [(row.limits.lower, row.limits.upper) for row in table.rows]
        assert limits[0] == (-math.pi / 2, math.pi / 2)
        assert limits[1] == (-0.01, 0.01)


def test_without_tip_the_last_axis_carries_it_and_that_is_said():
    document = {key: value for key, value in TWO_R.items() if key != "tip"}
    found = extract(read_axes(document), Convention.MODIFIED)
    assert any("no tip is given" in warning for warning in found.table.warnings)
    T = dh_matrices(found.table, [0.0, 0.0]).T
    np.testing.assert_allclose(T[:3, 3], [0.4, 0, 0.3], atol=1e-15)
    np.testing.assert_allclose(T[:3, 2], [0, 1, 0], atol=1e-15)


@pytest.mark.parametrize(
    ("change", "location", "message"),
    [
        ({"direction": [0, 0, 0]}, ("joints", 1, "direction"), "direction is zero"),
        ({"direction": [0, float("nan"), 0]}, ("joints", 1, "direction"), "direction"),
        ({"direction": [0, 1]}, ("joints", 1, "direction"), "list of 3"),
        ({"point": None}, ("joints", 1, "point"), "list of 3"),
        ({"point": [0, "foo", 1]}, ("joints", 1, "point"), "foo"),
        ({"type": "fixed", "limits": None}, ("joints", 1, "type"), "leave it out"),
        ({"type": "helical"}, ("joints", 1, "type"), "type is 'helical'"),
        ({"alpha": 3}, ("joints", 1, "alpha"), "unknown field"),
        ({"name": "a"}, ("joints", 1, "name"), "taken by joint 1"),
        ({"limits": {"lower": 3, "upper": 1}}, ("joints", 1, "limits", "lower"), "above upper"),
    ],
)
def test_what_is_wrong_is_named(change, location, message):
    joints = [TWO_R["joints"][0], TWO_R["joints"][1] | change]
    with pytest.raises(DHError) as refused:
        read_axes(TWO_R | {"joints": joints})
    assert refused.value.faults[0].location == location
    assert message in refused.value.faults[0].message


@pytest.mark.parametrize(
    "document", [None, [], {}, {"joints": []}, {"joints": [3]}, {"joints": [{}] * 65}]
)
def test_no_axes_are_refused(document):
    with pytest.raises(DHError):
        read_axes(document)
