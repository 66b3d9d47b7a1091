"""Locations as JSON pointers (RFC 6901)."""

import pytest

from app.http.pointers import json_pointer


@pytest.mark.parametrize(
    ("location", "pointer"),
    [
        ((), ""),
        (("joints",), "/joints"),
        (("joints", 2, "alpha"), "/joints/2/alpha"),
        (("robot", "urdf"), "/robot/urdf"),
        (("joints", 1, "a~1b~0"), "/joints/1/a~01b~00"),
        (("values", "a/b"), "/values/a~1b"),
        (("values", ""), "/values/"),
        (("values", "a\nb\u200b\x7f"), "/values/a?b??"),
        (("values", "x" * 65), "/values/" + "x" * 64),
        (("values", "~" * 65), "/values/" + "~0" * 64),
        (("values", "θ1"), "/values/θ1"),
    ],
)
def test_a_location_becomes_a_pointer(location, pointer):
    assert json_pointer(location) == pointer
