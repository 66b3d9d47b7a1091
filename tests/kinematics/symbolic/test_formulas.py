"""Formulas give the numbers of Pinocchio, and look like those of the lectures."""

import re

import numpy as np
import pytest

from dh_to_urdf import dh_matrices, read_mapping
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from robots.robot import robot_from_table
from robots.shipped import shipped_robot
from tests.kinematics.symbolic.formulas import evaluator, plain, written

ARMS = [
    "planar_2r",
    "planar_3r",
    "planar_8r",
    "scara",
    "stanford",
    "puma560",
    "rx90",
    "ur5",
    "panda",
    "pa10",
]


def random_q(dof, n=100, seed=0):
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (n, dof))


def assert_equals_numbers(robot, answer, q, atol=1e-12):
    value = evaluator(answer, q)
    numbers = dh_matrices(robot.table, q)
    np.testing.assert_allclose(value(answer["A"]), numbers.A, atol=atol, rtol=0)
    np.testing.assert_allclose(value(answer["T0"]), numbers.T0, atol=atol, rtol=0)
    T = fk(robot, q)["tool"]
    np.testing.assert_allclose(value(answer["T"]), T, atol=atol, rtol=0)
    np.testing.assert_allclose(value(answer["position"]), T[:, :3, 3], atol=atol, rtol=0)
    axes = np.swapaxes(value(answer["rotation"]), 1, 2)
    np.testing.assert_allclose(axes, T[:, :3, :3], atol=atol, rtol=0)
    J = jacobian(robot, q)
    np.testing.assert_allclose(value(answer["jacobian"]["matrix"]), J, atol=atol, rtol=0)


def assert_determinants(robot, answer, q):
    """Each minor equals numpy's, relative to Hadamard's bound."""
    J, value = jacobian(robot, q), evaluator(answer, q)
    found = answer["det_jacobian"]
    names = [joint.name for joint in robot.joints]
    rows = [("vx", "vy", "vz", "wx", "wy", "wz").index(row) for row in found["rows"]]
    for minor in found.get("minors", [found]):
        assert minor["expression"] is not None
        kept = [names.index(n) for n in found["columns"] if n not in minor.get("without", ())]
        square = J[:, rows][:, :, kept]
        bound = np.prod(np.linalg.norm(square, axis=1), axis=1)
        difference = np.abs(value(minor["expression"]) - np.linalg.det(square))
        assert (difference <= 1e-12 * np.maximum(bound, 1e-3)).all()
        product = value([f["factor"] for f in minor["factors"]] or ["1"])
        powers = [f["exponent"] for f in minor["factors"]] or [1]
        size = np.prod(product ** np.array(powers), axis=1)
        np.testing.assert_allclose(  # the factors leave out no more than a number
            np.linalg.det(square) * size[0], np.linalg.det(square)[0] * size, atol=1e-12
        )


@pytest.mark.parametrize(
    ("name", "parameters"),
    [(name, "symbolic") for name in ARMS]
    + [(name, "numeric") for name in ("puma560", "pa10", "ur5")],
)
def test_formulas_equal_numbers_at_a_hundred_q(name, parameters):
    robot = shipped_robot(name)
    answer = written(robot.table, parameters=parameters)
    assert all(answer["simplified"].values()), answer["simplified"]
    assert bool(answer["values"]) == (parameters == "symbolic")
    q = random_q(robot.dof)
    assert_equals_numbers(robot, answer, q)
    assert_determinants(robot, answer, q)


@pytest.mark.parametrize("name", ["scara", "puma560", "pa10"])
def test_formulas_hold_before_they_are_simplified(name):
    robot = shipped_robot(name)
    answer = plain(robot.table)
    assert not any(answer["simplified"].values())
    assert_equals_numbers(robot, answer, random_q(robot.dof, 20))


def monomials(formula):
    """``R5*(a*b - c) + d`` multiplied out, as a map from sorted factors to sign."""
    found = {}
    for sign, group in re.findall(r"(^-|^|[+-] )((?:[^()+-]|\([^()]*\))+)", formula):
        inner = re.search(r"\((.*)\)", group)
        outside = [f for f in re.sub(r"\(.*\)", "", group).strip().split("*") if f]
        terms = re.findall(r"(^-|^|[+-] )([^+-]+)", inner[1]) if inner else [("", "")]
        for inner_sign, term in terms:
            factors = outside + [f for f in term.strip().split("*") if f]
            negative = ("-" in sign) != ("-" in inner_sign)
            found[tuple(sorted(factors))] = -1 if negative else 1
    return found


def test_the_pa10_s_position_is_that_of_the_lecture_term_by_term():
    answer = written(
        shipped_robot("pa10").table,
        "position",
        "T0",
        parameters="symbolic",
        base="frame_0",
        frame="frame_7",
    )
    expected = {
        "X": "R5*(S4*C3*C2*C1 - S4*S3*S1 + C4*S2*C1) + R3*C1*S2",
        "Y": "R5*(S4*C3*C2*S1 + S4*S3*C1 + C4*S2*S1) + R3*S2*S1",
        "Z": "-R5*S4*C3*S2 + R5*C4*C2 + R3*C2",
    }
    for axis, formula in expected.items():
        assert monomials(answer["position"][axis]) == monomials(formula)
        assert len(monomials(formula)) == (3 if axis == "Z" else 4)
    assert answer["position"]["X"] == "R5*(C1*C2*C3*S4 - S1*S3*S4 + C1*S2*C4) + R3*C1*S2"
    assert [row[3] for row in answer["T0"][6][:3]] == list(answer["position"].values())


def test_the_pa10_s_point_of_the_exercises(exercises):
    answer = written(shipped_robot("pa10").table, "position", base="frame_0", frame="frame_7")
    q = np.radians([[10.0, 20, 30, 40, 50, 60, 70]])
    expected = exercises["E10_PA10_MGD R1=R7=0 q=10..70deg XE,YE,ZE"]["value"]
    position = evaluator(answer, q)(answer["position"])[0]
    np.testing.assert_allclose(position, expected, atol=5e-13)


def test_the_puma_s_determinant_falls_into_shoulder_elbow_and_wrist(exercises):
    answer = written(shipped_robot("puma560").table, "det_jacobian", parameters="symbolic")
    found = answer["det_jacobian"]
    assert {f["factor"] for f in found["factors"]} == {
        "a2",
        "S5",
        "a2*C2 + a3*C23 - d4*S23",
        "a3*S3 + d4*C3",
    }
    assert all(f["exponent"] == 1 for f in found["factors"])
    expected = exercises["E15_PUMA_det factors"]["value"]
    S5 = expected["wrist"]
    size = 0.4318 * expected["elbow"] * expected["shoulder"] * S5
    assert abs(size) == pytest.approx(expected["det"], rel=1e-6)
    q = np.radians([[20.0, -30, 100, 40, 50, 60]])
    det = evaluator(answer, q)(found["expression"])[0]
    assert abs(det) == pytest.approx(expected["det"], rel=1e-6)


def test_known_determinants():
    cases = {
        "planar_2r": "a1*a2*S2",
        "scara": "-a1*a2*S2",
        "stanford": "q3**2*S2*S5",
        "ur5": "a2*a3*S3*S5*(a2*C2 + a3*C23 + d5*S234)",
    }
    for name, formula in cases.items():
        answer = written(shipped_robot(name).table, "det_jacobian", parameters="symbolic")
        assert answer["det_jacobian"]["expression"].lstrip("-") == formula.lstrip("-")


def test_parallel_axes_are_added_up():
    answer = written(shipped_robot("planar_3r").table, "position", parameters="symbolic")
    assert answer["position"]["X"] == "a1*C1 + a2*C12 + xt*C123"
    assert answer["definitions"]["C123"] == "cos(q1 + q2 + q3)"
    opposite = written(shipped_robot("scara").table, "T")
    assert opposite["definitions"]["C12m4"] == "cos(q1 + q2 - q4)"


@pytest.mark.parametrize("frame", ["frame_3", "frame_0", "tool", "frame_6"])
def test_the_jacobian_in_the_axes_of_any_frame(frame):
    robot = shipped_robot("puma560")
    answer = written(robot.table, "jacobian", expressed_in=frame, parameters="symbolic")
    q = random_q(6, 20)
    R = np.swapaxes(fk(robot, q, [frame])[frame][:, :3, :3], 1, 2)
    J = jacobian(robot, q)
    expected = np.concatenate((R @ J[:, :3], R @ J[:, 3:]), axis=1)
    found = evaluator(answer, q)(answer["jacobian"]["matrix"])
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("frame", ["frame_2", "frame_4"])
def test_frames_on_the_way(frame):
    robot = shipped_robot("panda")
    answer = written(robot.table, "T", "jacobian", frame=frame)
    q = random_q(7, 20)
    value = evaluator(answer, q)
    np.testing.assert_allclose(value(answer["T"]), fk(robot, q, [frame])[frame], atol=1e-12)
    J = value(answer["jacobian"]["matrix"])
    np.testing.assert_allclose(J, jacobian(robot, q, frame), atol=1e-12)


def test_offsets_signs_and_known_angles():
    rows = [
        {"type": "R", "alpha": "pi/4", "a": 0.3, "d": 0.1, "offset": "pi/2", "sign": -1},
        {"type": "R", "alpha": "-pi/3", "a": 0, "d": 0.2, "offset": 0.3},
        {"type": "P", "alpha": 0.7, "a": 0.1, "theta": "pi/6", "offset": 0.25, "sign": -1},
        {"type": "F", "alpha": 0, "a": 0.1, "d": 0, "theta": "5*pi/12"},
        {"type": "R", "alpha": "pi", "a": 0.2, "d": -0.1, "sign": -1},
    ]
    for convention in ("standard", "modified"):
        document = {"name": "mixed", "convention": convention, "joints": rows}
        document["base"] = {"xyz": [0.1, 0, 0.2], "rpy": [0.1, "pi/2", 0]}
        document["tool"] = {"xyz": [0, 0.1, 0], "rpy": [0, 0, "pi/4"]}
        robot = robot_from_table(read_mapping(document))
        answer = written(robot.table, parameters="symbolic")
        assert_equals_numbers(robot, answer, random_q(4, 20))
    assert answer["definitions"]["C1"] == "cos(q1)"
    assert "sqrt(2)" in str(answer["A"][0])


def test_branches_of_a_tree():
    rows = [
        {"type": "R", "alpha": 0, "d": 0, "r": 0.3},
        {"type": "R", "alpha": "pi/2", "d": 0.2, "r": 0},
        {"type": "R", "alpha": 0, "d": 0.1, "r": 0, "ant": 1, "gamma": "pi/3", "b": 0.2},
        {"type": "P", "alpha": "pi/2", "d": 0, "theta": 0, "ant": 3},
    ]
    document = {"name": "tree", "convention": "khalil", "joints": rows}
    robot = robot_from_table(read_mapping(document))
    answer = written(robot.table, parameters="symbolic")
    assert_equals_numbers(robot, answer, random_q(4, 20))
    other = written(robot.table, "T", "jacobian", frame="frame_2")
    q = random_q(4, 20)
    J = evaluator(other, q)(other["jacobian"]["matrix"])
    np.testing.assert_allclose(J, jacobian(robot, q, "frame_2"), atol=1e-12)


def test_over_nine_joints_are_kept_apart_in_names():
    rows = [{"type": "R", "alpha": 0, "a": 0.1, "d": 0} for _ in range(12)]
    table = read_mapping({"name": "long", "convention": "standard", "joints": rows})
    answer = written(table, "T", "position")
    assert answer["definitions"]["C1_2"] == "cos(q1 + q2)"
    robot = robot_from_table(table)
    q = random_q(12, 20)
    np.testing.assert_allclose(evaluator(answer, q)(answer["T"]), fk(robot, q)["tool"], atol=1e-12)


def test_a_task_chooses_the_rows_of_the_determinant():
    from kinematics.task import task_from

    robot = shipped_robot("planar_3r")
    q = random_q(3, 20)
    answer = written(robot.table, "det_jacobian", task=task_from("xy"), parameters="symbolic")
    assert len(answer["det_jacobian"]["minors"]) == 3
    assert_determinants(robot, answer, q)
    refused = written(robot.table, "det_jacobian", task=task_from("pose"))
    assert refused["det_jacobian"]["expression"] is None
    assert "at most 3 rows" in refused["det_jacobian"]["note"]
    dependent = written(robot.table, "det_jacobian", task=task_from([1, 1, 1, 0, 0, 0]))
    assert dependent["det_jacobian"]["expression"] == "0"
    assert "dependent" in dependent["notes"][0]


def test_angles_with_few_digits_are_taken_as_they_stand_and_told():
    rows = [
        {"type": "R", "alpha": 1.5708, "a": 0, "d": 0.3},
        {"type": "R", "alpha": 0, "a": 0.4, "d": 0, "offset": -1.57},
    ]
    robot = robot_from_table(
        read_mapping({"name": "digits", "convention": "standard", "joints": rows})
    )
    answer = written(robot.table)
    assert_equals_numbers(robot, answer, random_q(2, 20))
    told = [note for note in answer["notes"] if note.startswith("joint ")]
    assert "alpha is 1.5708 and not pi/2" in told[0]
    assert "theta is -1.57 and not -pi/2" in told[1]
    assert not any("joint" in note for note in written(shipped_robot("ur5").table, "T")["notes"])


def test_beyond_all_limits_is_left_out_and_said_so():
    rng = np.random.default_rng(0)
    rows = [
        {"type": "R", "alpha": float(alpha), "a": float(a), "d": float(d)}
        for alpha, a, d in rng.uniform(0.1, 1, (14, 3))
    ]
    table = read_mapping({"name": "wild", "convention": "modified", "joints": rows})
    answer = written(table, "A", "T", time_budget=0.2)
    assert answer["T"] is None
    assert answer["simplified"] == {"A": True, "T": False}
    assert "T is left out" in answer["notes"][0]
