import math
import re

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dh_to_urdf.cells.expressions import Cell, CellError, Quantity, parse_cell

ANGLE, LENGTH, NUMBER = Quantity.ANGLE, Quantity.LENGTH, Quantity.NUMBER
DEGREES, MILLIMETRES = math.pi / 180, 1e-3


@pytest.mark.parametrize(
    ("cell", "radians"),
    [
        (0, 0.0),
        (-1.5, -1.5),
        (1_000_000, 1e6),
        ("1.5", 1.5),
        (" 1.5 ", 1.5),
        ("+1", 1.0),
        ("--1", 1.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e-3", 1e-3),
        ("2E2", 200.0),
        ("0,4", 0.4),
        ("-0,4", -0.4),
        ("0,123", 0.123),
        ("1,2345", 1.2345),
        ("1,5 + 2,5", 4.0),
        ("pi", math.pi),
        ("PI", math.pi),
        ("π", math.pi),
        ("pi/2", math.pi / 2),
        ("-π/2", -math.pi / 2),
        ("3*pi/4", 3 * math.pi / 4),
        ("2pi", 2 * math.pi),
        ("2·π", 2 * math.pi),
        ("2 × π", 2 * math.pi),
        ("(pi)/2", math.pi / 2),
        ("2(pi - 1)", None),
        ("90deg", math.pi / 2),
        ("-90deg", -math.pi / 2),
        ("90 deg", math.pi / 2),
        ("90 degrees", math.pi / 2),
        ("90°", math.pi / 2),
        ("− 90°", -math.pi / 2),
        ("–90°", -math.pi / 2),
        ("90°/2", math.pi / 4),
        ("(45+45)°", math.pi / 2),
        ("0,5rad", 0.5),
        ("pi rad", math.pi),
        ("pi/2 rad", math.pi / 2),
        ("pi/2 - 30°", math.pi / 3),
        ("sqrt(2)/2", math.sqrt(0.5)),
        ("sqrt(1/4)pi", math.pi / 2),
        ("((((((1))))))", 1.0),
        ("(1+2)*(3-4)/5", -0.6),
        ("2/4/2", 0.25),
        ("1-2-3", -4.0),
    ],
)
def test_angle_cells_as_people_write_them(cell, radians):
    radians = 2 * (math.pi - 1) if radians is None else radians
    assert parse_cell(cell, ANGLE) == Cell(pytest.approx(radians, rel=1e-15, abs=1e-16))


@pytest.mark.parametrize(
    ("cell", "radians"),
    [
        (90, math.pi / 2),
        ("-90", -math.pi / 2),
        ("360/4", math.pi / 2),
        ("sqrt(4)*45", math.pi / 2),
        ("pi/2", math.pi / 2),
        ("90deg", math.pi / 2),
        ("1rad", 1.0),
        ("pi/2 - 45°", math.pi / 4),
    ],
)
def test_only_plain_numbers_are_in_the_degrees_of_their_table(cell, radians):
    assert parse_cell(cell, ANGLE, DEGREES).value == pytest.approx(radians, rel=1e-15)


@pytest.mark.parametrize("cell", ["pi/2 + 90", "90deg + 10", "10 - 1rad", "q2 + 90 - pi/2"])
def test_a_degree_table_refuses_cells_that_mix_pi_and_plain_degrees(cell):
    with pytest.raises(CellError, match="mixes π or an explicit unit with plain degrees"):
        parse_cell(cell, ANGLE, DEGREES)


@pytest.mark.parametrize(
    ("cell", "unit", "metres"),
    [
        ("300mm", 1.0, 0.3),
        ("300 mm", 1.0, 0.3),
        ("30cm", 1.0, 0.3),
        ("0,3m", 1.0, 0.3),
        ("0.3", 1.0, 0.3),
        ("100mm + 20cm", 1.0, 0.3),
        ("0.1 + 200mm", 1.0, 0.3),
        (300, MILLIMETRES, 0.3),
        ("300", MILLIMETRES, 0.3),
        ("300mm", MILLIMETRES, 0.3),
        ("0.3m", MILLIMETRES, 0.3),
        ("89.159", MILLIMETRES, 0.089159),
        ("-sqrt(2)/2", 1.0, -math.sqrt(0.5)),
    ],
)
def test_length_cells_as_people_write_them(cell, unit, metres):
    assert parse_cell(cell, LENGTH, unit).value == pytest.approx(metres, rel=1e-15)


@given(st.integers(-1_000_000, 1_000_000))
def test_whole_millimetres_become_the_double_nearest_to_the_decimal_number(millimetres):
    assert parse_cell(millimetres, LENGTH, MILLIMETRES).value == float(f"{millimetres}e-3")
    assert parse_cell(f"{millimetres}mm", LENGTH).value == float(f"{millimetres}e-3")


@pytest.mark.parametrize(
    ("cell", "unit", "expected"),
    [
        ("q", 1.0, Cell(0.0, "q")),
        ("q2", 1.0, Cell(0.0, "q", 2)),
        ("q_2", 1.0, Cell(0.0, "q", 2)),
        ("theta3", 1.0, Cell(0.0, "theta", 3)),
        ("th3", 1.0, Cell(0.0, "theta", 3)),
        ("θ3", 1.0, Cell(0.0, "theta", 3)),
        ("Θ_3", 1.0, Cell(0.0, "theta", 3)),
        ("q2-pi/2", 1.0, Cell(-math.pi / 2, "q", 2)),
        ("pi/2 - q2", 1.0, Cell(math.pi / 2, "q", 2, -1)),
        ("-q2+90°", 1.0, Cell(math.pi / 2, "q", 2, -1)),
        ("-(q2-90°)", 1.0, Cell(math.pi / 2, "q", 2, -1)),
        ("q2+90", DEGREES, Cell(math.pi / 2, "q", 2)),
        ("2*q1 - q1", 1.0, Cell(0.0, "q", 1)),
    ],
)
def test_a_cell_may_hold_the_joint_variable_with_an_offset(cell, unit, expected):
    assert parse_cell(cell, ANGLE, unit) == expected


@pytest.mark.parametrize(
    ("cell", "letter", "value"), [("d3 + 0,1", "d", 0.1), ("r3", "r", 0.0), ("-q3+50mm", "q", 0.05)]
)
def test_prismatic_variables_have_lengths_as_offsets(cell, letter, value):
    parsed = parse_cell(cell, LENGTH)
    assert (parsed.variable, parsed.index, parsed.value) == (letter, 3, value)


@pytest.mark.parametrize(
    ("cell", "reason"),
    [
        ("", "is empty; give a number"),
        (" \t ", "is empty"),
        ("1,234", "reads as two numbers; write a decimal point"),
        ("-12,345", "reads as two numbers"),
        ("1,234,567", "unexpected ','"),
        ("0.1,2", "unexpected ','"),
        ("nan", "give a finite number"),
        (".NaN", "give a finite number"),
        ("-inf", "give a finite number"),
        ("Infinity", "give a finite number"),
        ("1e400", "is infinite"),
        ("1e400 - 1e400", "is NaN"),
        ("1e7", "beyond ±1e+06; check its unit"),
        ("1e3*1e4", "beyond"),
        ("1/0", "divides by zero"),
        ("pi/(2-2)", "divides by zero"),
        ("1/pi", "divides by something that is not a plain number"),
        ("1/q1", "divides by something that is not a plain number"),
        ("pi*pi", "multiplies two quantities"),
        ("pi°", "puts the unit '°' on something that is not a plain number"),
        ("sqrt(-1)", "square root"),
        ("sqrt(pi)", "square root"),
        ("sqrt 2", "parentheses after sqrt"),
        ("log(0)", "unknown name 'log'"),
        ("foo", "unknown name 'foo'"),
        ("90 grad", "unknown name 'grad'"),
        ("deg", "unknown name"),
        ("__import__('os')", "unexpected '_'"),
        ("os.system", "unexpected '.'"),
        ("90^0", "may be a degree sign; write 90°"),
        ("2m**2", "a power of something that is not a plain number"),
        ("0**-1", "divides by zero"),
        ("(-8)**(1/3)", "a root of a negative number"),
        ("9**9**9**9", "not a finite number"),
        ("2***3", "unexpected '*'"),
        ("1 2", "unexpected '2'"),
        ("1)", "unexpected ')'"),
        ("(1", "lacks a closing parenthesis"),
        ("()", "unexpected ')'"),
        ("1+", "ends too early"),
        ("*1", "unexpected '*'"),
        ("1;2", "unexpected ';'"),
        ("0x10", "unknown name"),
        ("1_000", "unexpected '_'"),
        ("q1+q2", "two joint variables"),
        ("2q1", "coefficient"),
        ("q1-q1", "coefficient"),
        ("q1*q1", "multiplies two"),
        ("300mm", "a length; an angle is needed"),
        ("9" * 65, "longer than 64 characters"),
        ("(" * 32 + "1", "lacks a closing parenthesis"),
        ("-" * 64, "ends too early"),
    ],
)
def test_refused_cells_say_why(cell, reason):
    with pytest.raises(CellError, match=re.escape(reason)):
        parse_cell(cell, ANGLE)


def test_a_length_refuses_an_angle():
    with pytest.raises(CellError, match="an angle; a length is needed"):
        parse_cell("90deg", LENGTH)


@pytest.mark.parametrize("cell", [math.nan, math.inf, -math.inf, 1e7, -1e7, 10**9, 10**400])
def test_numbers_must_be_finite_and_at_most_a_million(cell):
    with pytest.raises(CellError, match=r"finite number|beyond"):
        parse_cell(cell, NUMBER)


@pytest.mark.parametrize("cell", [None, True, False, [1], {"a": 1}, (1,), b"1", 1j, object()])
def test_other_types_are_told_what_to_give(cell):
    with pytest.raises(CellError, match='give a number or a text such as "pi/2"'):
        parse_cell(cell, NUMBER)


@pytest.mark.parametrize(
    "cell", ["\u0663", "1.\u0663", "\uff11", "\u0967e3", "1e\u0663", "q\u0661"]
)
def test_numbers_are_written_in_digits_0_to_9(cell):
    with pytest.raises(CellError):
        parse_cell(cell, NUMBER)


def test_parentheses_may_fill_the_whole_cell():
    assert parse_cell("(" * 31 + "7" + ")" * 31, NUMBER) == Cell(7.0)


def test_a_message_never_echoes_a_long_cell():
    with pytest.raises(CellError) as caught:
        parse_cell("x" * 60 + "1+1", NUMBER)
    assert len(str(caught.value)) < 120


PIECES = st.sampled_from(
    [*"0123456789.,+-*/()° \t_eEqdrmθπ−–×·", "pi", "sqrt", "deg", "rad", "mm", "cm", "theta", "1e"]
)
TEXTS = st.text(max_size=80) | st.lists(PIECES, max_size=30).map("".join)


@settings(max_examples=300, deadline=None)
@given(TEXTS, st.sampled_from(list(Quantity)), st.sampled_from([1.0, DEGREES, MILLIMETRES]))
def test_any_text_is_a_finite_cell_or_a_cell_error(text, quantity, unit):
    try:
        cell = parse_cell(text, quantity, unit)
    except CellError:
        return
    assert abs(cell.value) <= 1e6
    assert cell.sign in (1, -1)


ARITHMETIC = st.recursive(
    st.floats(0, 100).map(lambda x: f"{x:.3f}"),
    lambda inner: (
        st.tuples(inner, st.sampled_from("+-*/"), inner).map("".join)
        | inner.map("({})".format)
        | inner.map("-{}".format)
    ),
    max_leaves=6,
)


@settings(max_examples=200, deadline=None)
@given(ARITHMETIC)
def test_arithmetic_gives_what_python_gives(text):
    assume(len(text) <= 64)
    try:
        expected = eval(text)
    except ZeroDivisionError:
        with pytest.raises(CellError, match="divides by zero"):
            parse_cell(text, NUMBER)
        return
    assume(abs(expected) <= 1e6)
    assert parse_cell(text, NUMBER).value == expected


@settings(deadline=None)
@given(st.floats(-1e6, 1e6))
def test_every_double_survives_its_shortest_text(number):
    assert parse_cell(repr(number), NUMBER).value == number
