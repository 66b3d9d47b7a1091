"""What is written for people: text that runs, LaTeX that is read, refusals that say why."""

import itertools
import math

import numpy as np
import pytest

from dh_to_urdf.table import Convention, DHRow, DHTable, JointType, Mimic
from kinematics.forward import fk
from kinematics.symbolic import Notation, Quantity
from kinematics.symbolic.request import DEFAULT_BUDGET
from robots.robot import robot_from_table
from robots.shipped import shipped_robot
from tests.kinematics.symbolic.formulas import written
from tests.kinematics.symbolic.inverse_model.arms import CLASSES, Judge, random_table
from tests.kinematics.symbolic.inverse_model.test_against_closed_form import (
    pairs,
    python_function,
)

ELEMENTS = ("ux", "uy", "uz", "vx", "vy", "vz", "wx", "wy", "wz", "X", "Y", "Z")


def evaluated(listing, T, signs):
    """q and posture of the text, run as Python with these signs; None where a root is not real."""
    lines = iter(signs)
    text = "\n".join(
        f"{line.split(' = ')[0]} = {next(lines)}" if line.endswith("# +-1") else line
        for line in listing.splitlines()
    )
    scope = {name: getattr(math, name) for name in ("cos", "sin", "sqrt", "atan2", "hypot", "pi")}
    scope |= dict(zip(ELEMENTS, T[:3].T.ravel().tolist(), strict=True))
    try:
        exec(compile(text, "text", "exec"), scope)
    except ValueError:
        return None
    q = [scope[f"q{k}"] for k in range(1, 8) if f"q{k}" in scope]
    return q, [scope[f"posture{k}"] for k in range(1, 4) if f"posture{k}" in scope]


@pytest.mark.parametrize("name", ["puma560", "ur5", "stanford", "scara", "rx90", "planar_2r"])
def test_text_runs_for_every_choice_of_signs(name):
    robot = shipped_robot(name)
    judge = Judge(robot)
    answer = written(robot.table, "inverse", parameters="symbolic", listing=True)
    count = answer["listing"].count("# +-1")
    for T in judge.targets(3, seed=11):
        each = itertools.product((1, -1), repeat=count)
        found = [evaluated(answer["listing"], T, signs) for signs in each]
        judge.check(T, [one for one in found if one is not None])


@pytest.mark.parametrize("name", CLASSES)
def test_every_formula_is_latex(name):
    mathtext = pytest.importorskip("matplotlib.mathtext").MathTextParser("path")
    table = random_table(name, seed=3)
    answer = written(table, "inverse", notation=Notation.LATEX, parameters="symbolic", listing=True)
    for step in answer["inverse"]["steps"]:
        for line in step["lines"]:
            if line["kind"] != "remark":
                mathtext.parse(f"${line['text']}$")
    for name_, value in answer["inverse"]["q"].items():
        mathtext.parse(f"${name_} = {value}$")
    text = answer["listing"]
    assert text.count(r"\[") == text.count(r"\]")
    outside = [part.split(r"\[")[0] for part in text.split(r"\]")]
    for part in outside:
        for line in part.splitlines():
            plain = line if not line.startswith("%") else ""
            assert "_" not in plain.replace(r"\_", "").replace("_{", ""), line
            assert plain.count("$") % 2 == 0


def test_latex_has_greek_letters_and_the_base_of_the_target():
    answer = written(
        shipped_robot("kr6_r900").table,
        "inverse",
        notation=Notation.LATEX,
        parameters="symbolic",
        listing=True,
    )
    assert r"\[ x_{w} = X - d_{6} \, w_{x} \]" in answer["listing"]
    assert r"base\_link" in answer["listing"]
    assert answer["inverse"]["q"] == {
        "q_{1}": r"-\theta_{1}",
        "q_{2}": r"\theta_{2}",
        "q_{3}": r"\theta_{3} + \frac{\pi}{2}",
        "q_{4}": r"-\theta_{4}",
        "q_{5}": r"\theta_{5}",
        "q_{6}": r"-\theta_{6} + \pi",
    }


def test_the_planar_arm_is_the_law_of_cosines():
    answer = written(
        shipped_robot("planar_2r").table, "inverse", symbols=(("a1", "L1"), ("a2", "L2"))
    )
    formulas = [
        line["text"]
        for step in answer["inverse"]["steps"]
        for line in step["lines"]
        if line["kind"] == "formula"
    ]
    assert "C2 = (X**2 + Y**2 - L1**2 - L2**2)/(2*L1*L2)" in formulas
    assert answer["values"] == {"L1": 1.0, "L2": 0.8}
    assert answer["inverse"]["postures"] == [["up", "down"]]
    assert answer["inverse"]["most_solutions"] == 2
    assert answer["simplified"] == {}


def test_lengths_are_arguments_of_the_function():
    function = python_function(shipped_robot("planar_2r").table, parameters="symbolic")
    T = np.eye(4)
    T[:2, 3] = 0.5, 0.5
    found = sorted(one["q"] for one in function(T.tolist(), a1=0.5, a2=0.5))
    np.testing.assert_allclose(found, [[0, math.pi / 2], [math.pi / 2, -math.pi / 2]], atol=1e-15)


def test_a_free_joint_takes_the_given_value():
    robot = shipped_robot("puma560")
    function = python_function(robot.table, parameters="symbolic")
    q = np.array([0.3, 0.5, -0.7, 0.4, 0.0, 0.6])
    T = fk(robot, q)["tool"]
    found = function(T.tolist(), given=[0, 0, 0, 0.4, 0, 0])
    nearest = min(found, key=lambda one: np.abs(np.array(one["q"]) - q).max())
    np.testing.assert_allclose(nearest["q"], q, atol=1e-9)
    assert nearest["free"] == [4]
    assert len({tuple(one["posture"]) for one in found}) == len(found)
    for one in found:
        np.testing.assert_allclose(fk(robot, np.array(one["q"]))["tool"], T, atol=1e-9)


def test_a_point_on_axis_1_leaves_joint_1_free():
    robot = shipped_robot("rx90")
    function = python_function(robot.table, parameters="symbolic")
    T = np.eye(4)
    T[2, 3] = 0.6
    found = function(T.tolist(), given=[0.25, 0, 0, 0, 0, 0])
    assert found
    for one in found:
        assert one["q"][0] == pytest.approx(0.25)
        assert 1 in one["free"]
        np.testing.assert_allclose(fk(robot, np.array(one["q"]))["tool"], T, atol=1e-9)


@pytest.mark.parametrize("name", ["puma560", "ur5", "scara", "planar_2r", "rx90"])
def test_out_of_reach_has_no_solution(name):
    function = python_function(shipped_robot(name).table, parameters="symbolic")
    T = np.eye(4)
    T[:3, 3] = 5.0, 1.0, 0.2
    assert function(T.tolist()) == []


@pytest.mark.parametrize("turn", [0.01, math.pi])
def test_a_tilted_target_is_out_of_reach_of_a_scara(turn):
    robot = shipped_robot("scara")
    function = python_function(robot.table, parameters="symbolic")
    T = fk(robot, np.array([0.3, 0.5, 0.1, 0.2]))["tool"]
    assert len(function(T.tolist())) == 2
    tilt = np.eye(4)
    tilt[1:3, 1:3] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    assert function((T @ tilt).tolist()) == []


def test_a_stretched_arm_has_one_solution():
    function = python_function(shipped_robot("planar_2r").table)
    T = np.eye(4)
    T[0, 3] = 1.8
    (one,) = function(T.tolist())
    np.testing.assert_allclose(one["q"], [0, 0], atol=1e-7)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("panda", "of 7 joints (RRRRRRR)"),
        ("planar_8r", "8 joints before it"),
    ],
)
def test_refused_with_the_reason(name, words):
    answer = written(shipped_robot(name).table, "inverse")
    assert answer["inverse"] is None
    assert words in answer["no_inverse"]
    assert any(words in note for note in answer["notes"])


def test_six_joints_that_nothing_joins_are_told_what_would_have_to_meet():
    rows = tuple(
        DHRow(f"j{k}", JointType.REVOLUTE, math.pi / 2 + 0.1 * k, 0.2, 0.1 * k, 0.0, k - 1)
        for k in range(1, 7)
    )
    answer = written(DHTable("skew", Convention.STANDARD, rows), "inverse")
    assert "axes 4, 5 and 6 do not meet in one point" in answer["no_inverse"]
    assert "ik/solutions" in answer["no_inverse"]


def test_two_joints_that_move_as_one_are_refused():
    rows = [
        DHRow(f"j{k}", JointType.REVOLUTE, 0.0, 0.3, 0.0, 0.0, k - 1, mimic=mimic)
        for k, mimic in ((1, None), (2, Mimic("j1", 1.0, 0.0)), (3, None))
    ]
    answer = written(DHTable("tied", Convention.STANDARD, tuple(rows)), "inverse")
    assert "moved by 2 entries of q" in answer["no_inverse"]


def test_a_fixed_row_along_the_way_is_taken_into_the_lengths():
    def row(k, kind=JointType.REVOLUTE, **cells):
        values = {"alpha": 0.0, "a": 0.0, "d": 0.0, "theta": 0.0} | cells
        return DHRow(f"j{k}", kind, parent=k - 1, **values)

    rows = (
        row(1, JointType.FIXED, d=0.3),
        row(2, a=0.5),
        row(3, JointType.FIXED, a=0.2, d=0.1),
        row(4, a=0.4),
        row(5, JointType.FIXED, a=0.1, alpha=math.pi),
    )
    table = DHTable("fixed", Convention.STANDARD, rows)
    judge, function = Judge(robot_from_table(table)), python_function(table)
    for T in judge.targets(5, seed=12):
        judge.check(T, pairs(function(T.tolist())))


def test_words_of_the_functions_are_no_names_of_lengths():
    table = shipped_robot("planar_2r").table
    renamed = (("a1", "size"), ("a2", "T"))
    answer = written(table, "inverse", notation=Notation.PYTHON, symbols=renamed)
    assert "size is a word of the functions here; the length is called a1" in answer["notes"]
    function = python_function(table, symbols=renamed)
    T = np.eye(4)
    T[0, 3] = 1.0
    assert len(function(T.tolist())) == 2


@pytest.mark.parametrize("symbols", [(("a1", "X"), ("a2", "theta2")), (("a1", "e2"), ("a2", "w2"))])
def test_names_of_lengths_do_not_meet_those_of_the_derivation(symbols):
    table = shipped_robot("planar_2r").table
    judge, function = Judge(shipped_robot("planar_2r")), python_function(table, symbols=symbols)
    for T in judge.targets(3, seed=13):
        judge.check(T, pairs(function(T.tolist())))


@pytest.mark.parametrize(("base", "frame"), [("frame_0", "tool"), ("base_link", "frame_6")])
def test_other_frames(base, frame):
    table = random_table("elbow", seed=9)
    function = python_function(table, base=base, frame=frame)
    q = np.random.default_rng(5).uniform(-2, 2, 6)
    T = fk(robot_from_table(table), q)["tool"]
    T = np.linalg.inv(table.base) @ T if base == "frame_0" else T @ np.linalg.inv(table.tool)
    found = [one["q"] for one in function(T.tolist())]
    assert min(np.abs(np.array(one) - q).max() for one in found) < 1e-9


def test_everything_at_once_has_the_reason_or_the_model():
    answer = written(shipped_robot("planar_2r").table, time_budget=DEFAULT_BUDGET)
    assert set(answer["simplified"]) == {one.value for one in Quantity} - {"inverse"}
    assert answer["inverse"]["kind"] == "planar_2r"
