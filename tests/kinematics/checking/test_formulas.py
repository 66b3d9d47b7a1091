"""Formulas as students write them, against values computed beside them."""

import math

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.checking.check import check_answer
from kinematics.checking.formulas import MAX_DEPTH, MAX_LENGTH, Scope, parse_formula
from kinematics.checking.question import Quantity, Question
from kinematics.errors import InvalidAnswer
from kinematics.task import TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot

NAMES = {"a1": 0.7, "a2": 0.4, "L1": 0.7, "q1": 0.3, "q2": 1.1, "S2": math.sin(1.1)}


def value(text, *, degrees=False):
    def look_up(word):
        found = NAMES.get(word.replace("_", ""))
        return None if found is None else np.array([found])

    return float(np.ravel(parse_formula(text).value(Scope(look_up, degrees)))[0])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a1 a2 S2", 0.28 * math.sin(1.1)),
        ("a1a2S2", 0.28 * math.sin(1.1)),
        ("a1·a2·sin(q2)", 0.28 * math.sin(1.1)),
        ("2a1", 1.4),
        ("-a1 + -a2", -1.1),
        ("a1 - - a2", 1.1),
        ("a1*(a2+1)(2)", 0.7 * 1.4 * 2),
        ("sin q1 cos q2", math.sin(0.3) * math.cos(1.1)),
        ("sin 2 q1", math.sin(0.6)),
        ("cosq1 a1", math.cos(0.3) * 0.7),
        ("sin^2 q1 + cos^2(q1)", 1.0),
        ("sin(q1)^2", math.sin(0.3) ** 2),
        ("-a1^2", -0.49),
        ("a1**2", 0.49),
        ("a1²", 0.49),
        ("a_1 \\cdot \\sin(q_2)", 0.7 * math.sin(1.1)),
        ("√3/2", math.sqrt(3) / 2),
        ("sqrt(3)/2", math.sqrt(3) / 2),
        ("1/2 a1", 0.35),
        ("a1/a2/2", 0.7 / 0.4 / 2),
        ("0,5 a1", 0.35),
        ("1.5e-1", 0.15),
        ("sin(q1 − π/2)", math.sin(0.3 - math.pi / 2)),
        ("cos 30°", math.cos(math.pi / 6)),
        ("L_{1} cos(q_{1})", 0.7 * math.cos(0.3)),
        ("a1^(1/2)", math.sqrt(0.7)),
        ("4^-2", 1 / 16),
    ],
)
def test_a_formula_has_the_value_that_is_meant(text, expected):
    assert value(text) == pytest.approx(expected, abs=1e-14)


def test_plain_angles_are_in_the_unit_of_the_answer():
    assert value("sin(30)", degrees=True) == pytest.approx(0.5)
    assert value("sin(q1 + 90)", degrees=True) == pytest.approx(math.cos(0.3))
    assert value("sin(q1 + pi/2)", degrees=True) == pytest.approx(math.cos(0.3))
    assert value("sin(2 q1)", degrees=True) == pytest.approx(math.sin(0.6))


@pytest.mark.parametrize(
    "text",
    [
        "a1 +", "(a1", "a1)", "* a1", "a1 ^ q1", "2^100", "2^2^2", "sin", "sin()", "a1 & a2",
        "__import__('os')", "a1.real", "1e999", "1.2.3", "a1 = 2", ",", "a1,a2", "lambda: 1",
        "(" * (MAX_DEPTH + 1) + "1" + ")" * (MAX_DEPTH + 1), "√" * 3000 + "2",
        "1" * (MAX_LENGTH + 1),
    ],
)  # fmt: skip
def test_what_is_no_formula_is_refused(text):
    with pytest.raises(InvalidAnswer) as refused:
        parse_formula(text, (2, 0))
    assert refused.value.location == ("answer", 2, 0)


def test_unknown_names_are_told_with_those_that_are_known():
    with pytest.raises(InvalidAnswer, match="foo"):
        value("a1 * foo")


def test_long_formulas_are_evaluated_without_recursion():
    count = MAX_LENGTH // 3
    assert value("+".join(["a1"] * count)) == pytest.approx(0.7 * count)
    assert value("-" * 1000 + "a1") == pytest.approx(0.7)
    assert value(" ".join(["1"] * 1000)) == pytest.approx(1.0)


DETERMINANT = {"quantity": Quantity.DET_JACOBIAN, "task": TASKS["xy"]}


@pytest.mark.parametrize(
    "formula",
    ["a1*a2*S2", "a1 a2 sin(q2)", "L1 L2 s2", "L_1 L_2 sin θ2", "a2 sin(t2) a1", "0.8 S2",
     "4/5*s_2",
     "a1*a2*(S12*C1 - C12*S1)", "a1 a2 sin(θ1+θ2-q1)", "a1*a2*cos(q2 - pi/2)", "1*a2*S2"],
)  # fmt: skip
def test_equivalent_formulas_of_a_determinant_are_right(formula):
    robot = shipped_robot("planar_2r")
    assert check_answer(Question(robot=robot, **DETERMINANT), formula).correct


@pytest.mark.parametrize(
    ("formula", "code"),
    [
        ("-a1 a2 S2", "opposite_sign"),
        ("a1 a2 C2", "sin_and_cos_exchanged"),
        ("a2*S2", "length_missing"),
        ("a1 a2 S2/(C1 - C1)", "not_finite"),
        ("a1 a2 S12", None),
        ("a1 a2 S2 + 0.01", None),
        ("a1^2 a2 S2", None),
    ],
)
def test_wrong_formulas_are_wrong(formula, code):
    # a1 is 1 m: a formula that is right only for this length is wrong.
    found = check_answer(Question(robot=shipped_robot("planar_2r"), **DETERMINANT), formula)
    assert not found.correct
    if code is not None:
        assert found.diagnosis[0].code == code


def test_what_s2_means_with_an_offset_is_read_both_ways():
    rows = [
        {"type": "R", "alpha": 0, "a": 0.7, "d": 0, "theta": 0},
        {"type": "R", "alpha": 0, "a": 0.4, "d": 0, "theta": 0, "offset": 0.5},
    ]
    robot = robot_from_table(read_mapping({"convention": "dh", "joints": rows}))
    question = Question(robot=robot, **DETERMINANT)
    assert check_answer(question, "a1 a2 S2").correct
    assert check_answer(question, "a1 a2 sin(q2 + 0.5)").correct
    assert not check_answer(question, "a1 a2 sin(q2 - 0.5)").correct


def test_numbers_with_few_decimals_are_right_within_the_tolerance():
    question = Question(robot=shipped_robot("planar_3r"), quantity=Quantity.T)
    lengths = [row.a for row in question.robot.table.rows]
    tool = float(question.robot.table.tool[0, 3])
    one, two, three = [x for x in (*lengths, tool) if x]
    for off, right in ((0.0, True), (4e-4, True), (2e-3, False)):
        x = f"{one:.4f} C1 + {two:.4f} C12 + {three + off:.4f} C123"
        y = f"{one:.4f} S1 + {two:.4f} S12 + {three:.4f} S123"
        assert check_answer(question, [x, y]).correct is right
