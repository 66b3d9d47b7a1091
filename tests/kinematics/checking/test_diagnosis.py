"""Slips made on purpose are found; right answers are right in every form, wrong ones wrong."""

from dataclasses import replace

import numpy as np
import pytest

from dh_to_urdf import Convention, dh_matrices, to_convention
from dh_to_urdf.documents.layouts import document
from dh_to_urdf.languages import language
from kinematics.checking.check import check_answer
from kinematics.checking.question import Quantity, Question
from kinematics.forward import fk
from kinematics.inverse.all_solutions import all_solutions
from kinematics.jacobian import ReferenceFrame, jacobian
from kinematics.orientation import euler_angles
from kinematics.redundancy.step import StepTask, differential_step
from kinematics.task import TASKS
from robots.shipped import shipped_robot
from tests.kinematics.checking.made_slips import arm_of, figures, first_codes, robots

RANDOM = np.random.default_rng(7)
NAMES = (
    "planar_2r",
    "puma560",
    "pa10",
    "scara",
    "stanford",
    "panda",
    "ur5e",
    "panda_urdf",
    "talos",
)


def some_q(robot):
    q = RANDOM.uniform(-1.2, 1.2, robot.dof)
    return np.where(robot.is_revolute, q, np.abs(q) / 10)


@pytest.mark.parametrize("count", [20, pytest.param(150, marks=pytest.mark.slow)])
def test_slips_are_named_first(count):
    outcomes, missed = figures(count)
    assert outcomes["named"] + outcomes["same"] >= 0.95 * count, missed


def test_what_a_student_works_out_by_hand_is_right():
    for robot in robots(np.random.default_rng(3), 40):
        q = some_q(robot)
        arm = arm_of(robot, q)
        for quantity, values in ((Quantity.T, arm.pose()), (Quantity.JACOBIAN, arm.jacobian())):
            question = Question(quantity, robot, q)
            assert check_answer(question, values.tolist()).correct
            assert check_answer(question, np.round(values, 3).tolist()).correct


@pytest.mark.parametrize("name", NAMES)
def test_an_answer_beyond_the_tolerance_is_wrong_and_the_entry_named(name):
    robot = shipped_robot(name)
    q = some_q(robot)
    T, J = fk(robot, q)[robot.tip_frame], jacobian(robot, q)
    for quantity, values in ((Quantity.T, T), (Quantity.JACOBIAN, J)):
        for tolerance in (1e-3, 1e-6):
            question = Question(quantity, robot, q, tolerance=tolerance)
            place = tuple(int(RANDOM.integers(n)) for n in values.shape)
            for factor, right in ((0.9, True), (1.1, False)):
                changed = values.copy()
                changed[place] += factor * tolerance * max(1.0, abs(values[place]))
                found = check_answer(question, changed.tolist())
                assert found.correct is right
                if not right:
                    (error,) = found.errors
                    assert error.index == place
                    assert error.given == pytest.approx(changed[place])
                    assert error.off_by == pytest.approx(
                        1.1 * tolerance * max(1.0, abs(values[place])), rel=0.06
                    )


@pytest.mark.parametrize("name", ["puma560", "pa10", "panda_urdf"])
@pytest.mark.parametrize("sequence", ["ZXZ", "ZYX", "xyz", "XYX"])
def test_every_equivalent_triple_is_right(name, sequence):
    robot = shipped_robot(name)
    q = some_q(robot)
    both = euler_angles(fk(robot, q)[robot.tip_frame][:3, :3], sequence).solutions
    question = Question(Quantity.EULER, robot, q, euler=sequence)
    turns = 2 * np.pi * np.array([1, -1, 2])
    for triple in (both[0], both[1], both[0] + turns, np.round(both[1], 4)):
        assert check_answer(question, triple.tolist()).correct
    assert check_answer(question, both[::-1].tolist()).correct
    assert check_answer(replace(question, angle=np.pi / 180), np.rad2deg(both[1]).tolist()).correct
    mixed = [both[0][0], both[1][1], both[0][2]]
    assert not check_answer(question, mixed).correct
    twice = check_answer(question, [both[0].tolist(), (both[0] + turns).tolist()])
    assert (twice.correct, first_codes(twice)) == (False, {"double_solution"})


def test_slips_with_euler_angles_are_named():
    robot = shipped_robot("pa10")
    q = np.array([0.2, 0.4, 0.6, 0.8, 1.0, 0.5, 0.3])
    R = fk(robot, q)["tool"][:3, :3]
    question = Question(Quantity.EULER, robot, q)
    phi, theta, psi = euler_angles(R, "ZXZ").solutions[0]
    for answer, code in (
        (euler_angles(R, "xyz").solutions[0], "rpy_for_euler"),
        (euler_angles(R, "ZYZ").solutions[0], "other_sequence"),
        (euler_angles(R.T, "ZXZ").solutions[0], "transposed"),
        ((psi, theta, phi), "angles_in_other_order"),
        (np.rad2deg([phi, theta, psi]), "degrees_for_radians"),
        ((phi, -theta, psi), "angle_sign"),
        ((phi + np.pi, theta, psi), "quadrant"),
        (np.round([phi, theta, psi], 2), "rounded"),
    ):
        found = check_answer(question, [float(x) for x in answer])
        assert not found.correct
        codes = [one.code for one in found.diagnosis]
        # -theta and a half turn of phi are one rotation apart: either may be meant.
        assert code in codes


@pytest.mark.parametrize(
    ("name", "task"),
    [("planar_2r", "xy"), ("puma560", "pose"), ("ur5e", "pose"), ("scara", "xyz_phi")],
)
def test_solutions_count_in_any_order_and_modulo_turns(name, task):
    robot = shipped_robot(name)
    q = some_q(robot)
    target = fk(robot, q)[robot.tip_frame]
    question = Question(Quantity.IK, robot, target=target, task=TASKS[task])
    known = all_solutions(robot, target, task=TASKS[task]).solutions
    rows = np.array([one.q for one in known])
    inside = [k for k, one in enumerate(known) if one.within_limits] or list(range(len(rows)))
    turned = rows[::-1] + 2 * np.pi * robot.is_periodic
    assert check_answer(question, turned.tolist()).correct
    assert check_answer(question, rows[inside].tolist()).correct
    assert check_answer(question, rows[0].tolist()).correct
    missing = check_answer(question, rows[inside[1:]].tolist()) if len(inside) > 1 else None
    if missing is not None:
        assert (missing.correct, first_codes(missing)) == (False, {"missing_solution"})
    doubled = check_answer(question, [*rows.tolist(), turned[0].tolist()])
    assert (doubled.correct, first_codes(doubled)) == (False, {"double_solution"})
    false = rows.copy()
    false[0, 0] += 0.01
    found = check_answer(question, false.tolist())
    assert not found.correct
    assert found.errors[0].index[0] == 0
    assert "false_solution" in {one.code for one in found.diagnosis}


def test_an_empty_list_says_that_nothing_reaches_the_target():
    robot = shipped_robot("planar_2r")
    for x, reached in ((5.0, False), (1.0, True)):
        target = np.eye(4)
        target[0, 3] = x
        question = Question(Quantity.IK, robot, target=target, task=TASKS["xy"])
        found = check_answer(question, [])
        assert found.correct is not reached
        assert not reached or first_codes(found) == {"missing_solutions"}
        assert check_answer(question, [[0.0, 0.0]]).correct is False


def test_what_is_noted_of_solutions_can_be_said_in_french():
    robot = shipped_robot("planar_2r")
    target = fk(robot, np.array([0.3, 0.4]))["tool"]
    question = Question(Quantity.IK, robot, target=target, task=TASKS["xy"])
    found = check_answer(question, [[0.3, 0.4]])
    assert found.note == "1 of 1 given solutions reach the target"
    assert language("fr").text(found.note) == "solutions données qui atteignent la cible : 1 sur 1"


def test_joint_values_in_degrees_and_a_forgotten_tool_are_named():
    robot = shipped_robot("pa10")
    q = some_q(robot)
    question = Question(Quantity.IK, robot, target=fk(robot, q)["tool"])
    found = check_answer(question, np.rad2deg(q).tolist())
    assert first_codes(found) == {"degrees_for_radians"}
    bare = dh_matrices(replace(robot.table, tool=np.eye(4)), q).T
    found = check_answer(Question(Quantity.IK, robot, target=bare), q.tolist())
    assert first_codes(found) == {"tool_forgotten"}


@pytest.mark.parametrize("name", ["puma560", "pa10", "scara"])
def test_tables_are_compared_as_written_then_by_motion(name):
    robot = shipped_robot(name)
    question = Question(Quantity.TABLE, robot)
    assert check_answer(question, document(robot.table)).correct
    others = [one for one in Convention if one is not robot.table.convention]
    for convention in others:
        found = check_answer(question, document(to_convention(robot.table, convention)))
        assert found.correct
        if Convention.STANDARD in (convention, robot.table.convention):
            assert "equivalent" in found.note
    turned = document(robot.table)
    turned["joints"][1]["alpha"] += 2 * np.pi
    assert check_answer(question, turned).correct
    wrong = document(robot.table)
    wrong["joints"][1]["alpha"] -= 0.5
    found = check_answer(question, wrong)
    assert not found.correct
    assert found.errors[0].index == ("joints", 1, "alpha")
    assert found.errors[0].off_by == pytest.approx(0.5)


def test_slips_in_tables_are_named():
    robot = shipped_robot("puma560")
    for change, codes in (
        (lambda t: t.update(convention="modified"), {"modified_for_standard"}),
        (lambda t: t["joints"][2].update(alpha=-t["joints"][2]["alpha"]), {"alpha_sign"}),
        (lambda t: [j.update(alpha=-j["alpha"]) for j in t["joints"]], {"alpha_sign"}),
        (lambda t: [j.update(a=1000 * j["a"], d=1000 * j["d"]) for j in t["joints"]], {"mm_for_m"}),
        (lambda t: [j.update(a=j["d"], d=j["a"]) for j in t["joints"]], {"columns_swapped"}),
        (lambda t: (t["joints"][1].update(a=0), t["joints"][3].update(d=-t["joints"][3]["d"])),
         {"a_missing", "d_sign"}),
    ):  # fmt: skip
        table = document(robot.table)
        change(table)
        found = check_answer(Question(Quantity.TABLE, robot), table)
        assert not found.correct
        assert first_codes(found) == codes


def test_steps_and_their_slips():
    robot = shipped_robot("planar_3r")
    q, dx, z = np.array([0.5, 0.4, -0.6]), np.array([0.02, -0.01]), np.array([0.1, 0.0, 0.0])
    first = StepTask(dx, TASKS["xy"])
    J = jacobian(robot, q)[:2]
    question = Question(Quantity.DELTA_Q, robot, q, delta_x=dx, z=z)
    right = differential_step(robot, q, first, z=z).delta_q
    assert check_answer(question, np.round(right, 4).tolist()).correct
    without = differential_step(robot, q, first).delta_q
    for answer, code in (
        (without, "null_motion_forgotten"),
        (without + z, "null_motion_not_projected"),
        (J.T @ dx + right - without, None),
        (np.rad2deg(right), "degrees_for_radians"),
    ):
        found = check_answer(question, answer.tolist())
        assert not found.correct
        assert code is None or code in first_codes(found)
    found = check_answer(replace(question, z=None), (J.T @ dx).tolist())
    assert first_codes(found) == {"transpose_for_inverse"}


@pytest.mark.parametrize("reference", list(ReferenceFrame))
def test_jacobians_of_other_points_and_axes_are_named(reference):
    robot = shipped_robot("puma560")
    q = some_q(robot)
    question = Question(Quantity.JACOBIAN, robot, q, reference_frame=reference)
    for other in ReferenceFrame:
        J = jacobian(robot, q, None, other)
        found = check_answer(question, J.tolist())
        assert found.correct is (other is reference)
        if not found.correct:
            assert {one.code for one in found.diagnosis} <= {"other_point", "other_frame"}
    upright = jacobian(robot, q, None, reference)
    found = check_answer(question, np.vstack((upright[3:], upright[:3])).tolist())
    assert first_codes(found) == {"rows_swapped"}
    assert first_codes(check_answer(question, upright.T.tolist())) == {"transposed"}


def test_errors_have_few_digits_and_no_sign():
    robot = shipped_robot("planar_2r")
    question = Question(Quantity.DET_JACOBIAN, robot, np.array([0.3, 0.7]), task=TASKS["xy"])
    found = check_answer(question, 0.0)
    assert found.errors[0].off_by == pytest.approx(0.8 * np.sin(0.7), rel=0.05)
    assert len(repr(found.errors[0].off_by)) <= 4
