"""What cannot be asked for is refused with the field and what to write."""

import math

import pytest

from kinematics.errors import InvalidOption
from kinematics.symbolic import Quantity, SymbolicRequest
from kinematics.symbolic.parameters import lengths_of
from kinematics.symbolic.request import checked, quantity_from
from robots.errors import UnknownFrame
from robots.shipped import shipped_robot


@pytest.mark.parametrize(
    ("options", "location"),
    [
        ({"quantities": ()}, ("quantities",)),
        ({"parameters": "both"}, ("parameters",)),
        ({"time_budget": 0.0}, ("time_budget",)),
        ({"time_budget": math.nan}, ("time_budget",)),
        ({"time_budget": math.inf}, ("time_budget",)),
        ({"symbols": (("a9", "L"),)}, ("symbols", "a9")),
        ({"symbols": (("a2", "C1"),)}, ("symbols", "a2")),
        ({"symbols": (("a2", "lambda"),)}, ("symbols", "a2")),
        ({"symbols": (("a2", "double"),)}, ("symbols", "a2")),
        ({"symbols": (("a2", "q1"),)}, ("symbols", "a2")),
        ({"symbols": (("a2", "__import__('os')"),)}, ("symbols", "a2")),
        ({"symbols": (("a2", "L"), ("a3", "L"))}, ("symbols", "a3")),
        ({"symbols": (("a2", "d1"),), "parameters": "symbolic"}, ("symbols", "a2")),
    ],
)
def test_refused_options(options, location):
    table = shipped_robot("puma560").table
    with pytest.raises(InvalidOption) as caught:
        checked(table, SymbolicRequest(**options))
    assert caught.value.location == location


@pytest.mark.parametrize(
    ("options", "argument"),
    [
        ({"frame": "frame_9"}, "frame"),
        ({"frame": "base_link"}, "frame"),
        ({"base": "frame_2"}, "base"),
        ({"frame": "frame_2", "expressed_in": "frame_3"}, "expressed_in"),
        ({"base": "frame_0", "expressed_in": "base_link"}, "expressed_in"),
    ],
)
def test_refused_frames(options, argument):
    with pytest.raises(UnknownFrame) as caught:
        checked(shipped_robot("puma560").table, SymbolicRequest(**options))
    assert (caught.value.argument, caught.value.index) == (argument, ())


def test_unknown_quantities_are_told_the_nearest():
    with pytest.raises(InvalidOption, match="did you mean jacobian"):
        quantity_from("jacobean")


def test_quantities_come_once_and_in_order():
    request = SymbolicRequest(quantities=(Quantity.JACOBIAN, Quantity.T, Quantity.JACOBIAN))
    found = checked(shipped_robot("scara").table, request)
    assert found.quantities == (Quantity.T, Quantity.JACOBIAN)


def test_one_name_for_equal_lengths():
    symbols = (("a2", "L"), ("d4", "L"))
    checked(shipped_robot("puma560").table, SymbolicRequest(symbols=symbols))


@pytest.mark.parametrize(
    ("robot", "names"),
    [
        ("puma560", ["d1", "a2", "a3", "d3", "d4"]),
        ("pa10", ["R3", "R5", "zb", "zt"]),
        ("rx90", ["D3", "R4"]),
        ("planar_3r", ["a1", "a2", "xt"]),
        ("panda", ["d1", "d3", "a3", "a4", "d5", "a6", "zt"]),
    ],
)
def test_names_of_lengths(robot, names):
    assert [length.name for length in lengths_of(shipped_robot(robot).table)] == names
