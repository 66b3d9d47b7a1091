"""Names that a reader takes for one another."""

import pytest

from dh_to_urdf import read_mapping
from dh_to_urdf.look_alikes import look_alikes


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ("A", "a"),
        ("Joint", "joint"),
        ("a", "а"),
        ("Ο1", "O1"),
        ("ﬁnger", "finger"),
        ("ﬁ", "fi"),
        ("Ａ", "A"),
        ("j0", "jO"),
        ("j1", "jl"),
        ("j1", "jI"),
        ("straße", "strasse"),
    ],
)
def test_two_names_that_look_alike_are_both_named(a, b):
    (told,) = look_alikes("joints", [a, "elbow", b])
    assert f"'{a}'" in told
    assert f"'{b}'" in told
    assert all(f"U+{ord(c):04X}" in told for c in a + b if not c.isascii())


def test_names_that_differ_are_not():
    names = ["j1", "j2", "j12", "elbow", "épaule", "покоть", "γ", "left_1", "right_1", "joint_a"]
    assert look_alikes("joints", names) == ()


def test_many_pairs_are_counted():
    (told,) = look_alikes("joints", [*"abcd", *"ABCD"])
    assert "(and 2 more pairs)" in told


def test_a_table_with_such_names_is_read_with_a_warning():
    row = {"type": "R", "alpha": 0, "a": 1, "d": 0}
    joints = [{**row, "name": "A"}, {**row, "name": "a"}]
    (told,) = read_mapping({"name": "r", "convention": "standard", "joints": joints}).warnings
    assert told.startswith("joints 'A' and 'a' look alike")
