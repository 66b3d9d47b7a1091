"""The Jacobian of a task, with determinant and inverse, as formulas."""

import numpy as np
import pytest

from dh_to_urdf import Convention, dh_matrices, read_mapping
from dh_to_urdf.documents.writing import table_to_mapping
from dh_to_urdf.extraction.conversion import to_convention
from kinematics.jacobian import jacobian, task_jacobian
from kinematics.symbolic.link_matrix import LINK_MATRICES
from kinematics.symbolic.request import Notation
from kinematics.task import TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot
from tests.kinematics.symbolic.formulas import evaluator, python_functions, written


def random_q(dof, n=50):
    return np.random.default_rng(3).uniform(-3, 3, (n, dof))


@pytest.mark.parametrize("parameters", ["numeric", "symbolic"])
@pytest.mark.parametrize(("name", "task"), [("planar_2r", "xy"), ("planar_3r", "xy_phi")])
def test_inverse_times_jacobian_is_the_identity(name, task, parameters):
    robot = shipped_robot(name)
    asked = ("jacobian", "det_jacobian", "inverse_jacobian")
    answer = written(robot.table, *asked, task=TASKS[task], parameters=parameters)
    q = random_q(robot.dof)
    value, J = evaluator(answer, q), task_jacobian(robot, q, TASKS[task])
    np.testing.assert_allclose(value(answer["jacobian"]["matrix"]), J, atol=1e-12)
    assert answer["jacobian"]["rows"] == list(TASKS[task].row_names)
    found = answer["inverse_jacobian"]
    assert (found["rows"], found["columns"]) == (
        [joint.name for joint in robot.joints],
        list(TASKS[task].row_names),
    )
    divisor = value(found["divisor"])
    np.testing.assert_allclose(divisor, np.linalg.det(J), atol=1e-12)
    product = value(found["matrix"]) @ J
    wanted = divisor[:, None, None] * np.eye(robot.dof)
    np.testing.assert_allclose(product, wanted, atol=1e-12)
    assert found["divisor"] == answer["det_jacobian"]["expression"]


def test_the_inverse_of_the_lecture():
    answer = written(
        shipped_robot("planar_2r").table,
        "inverse_jacobian",
        task=TASKS["xy"],
        parameters="symbolic",
        symbols=(("a1", "L1"), ("a2", "L2")),
    )
    assert answer["inverse_jacobian"]["divisor"] == "L1*L2*S2"
    assert answer["inverse_jacobian"]["matrix"] == [
        ["L2*C12", "L2*S12"],
        ["-L1*C1 - L2*C12", "-L1*S1 - L2*S12"],
    ]


@pytest.mark.parametrize("task", ["position", "orientation"])
def test_three_joints_in_space_and_in_other_axes(task):
    table = read_mapping(
        {
            "convention": "standard",
            "joints": [
                {"type": "R", "alpha": "pi/2", "a": 0, "d": 0.3},
                {"type": "R", "alpha": "pi/3" if task == "orientation" else 0, "a": 0.4, "d": 0},
                {"type": "R", "alpha": 0, "a": 0.2, "d": 0.1},
            ],
        }
    )
    robot = robot_from_table(table)
    q = random_q(3)
    for axes in (None, "frame_1"):
        answer = written(table, "inverse_jacobian", task=TASKS[task], expressed_in=axes)
        J = jacobian(robot, q)
        if axes:
            R = np.swapaxes(dh_matrices(table, q).T0[:, 0, :3, :3], 1, 2)
            J = np.concatenate((R @ J[:, :3], R @ J[:, 3:]), axis=1)
        square = J[:, list(TASKS[task].rows)]
        value, found = evaluator(answer, q), answer["inverse_jacobian"]
        scale = np.abs(value(found["divisor"]))[:, None, None]
        product = value(found["matrix"]) @ square
        np.testing.assert_allclose(
            product,
            value(found["divisor"])[:, None, None] * np.eye(3),
            atol=1e-12 * (1 + scale.max()),
        )


def test_direction_counts_rows_about_the_tools_own_axes():
    robot = shipped_robot("puma560")
    answer = written(robot.table, "jacobian", "det_jacobian", task=TASKS["position_direction"])
    q = random_q(6)
    J = task_jacobian(robot, q, TASKS["position_direction"])
    np.testing.assert_allclose(evaluator(answer, q)(answer["jacobian"]["matrix"]), J, atol=1e-12)
    assert "own axes" in answer["det_jacobian"]["note"]


@pytest.mark.parametrize(
    ("name", "task", "word"),
    [
        ("puma560", "position", "6 columns"),
        ("puma560", "pose", "long"),
        ("planar_2r", "xz", "dependent"),
    ],
)
def test_why_there_is_no_inverse(name, task, word):
    answer = written(shipped_robot(name).table, "inverse_jacobian", task=TASKS[task])
    assert answer["inverse_jacobian"] is None
    assert any(word in note for note in answer["notes"])


def test_an_inverse_as_python():
    robot = shipped_robot("planar_3r")
    table = robot.table
    answer = written(table, "inverse_jacobian", task=TASKS["xy_phi"], notation=Notation.PYTHON)
    found = python_functions(answer["code"])
    for q in random_q(3, 5):
        inverse = np.array(found.inverse_jacobian_matrix(q)) / found.inverse_jacobian_divisor(q)
        J = task_jacobian(robot, q, TASKS["xy_phi"])
        np.testing.assert_allclose(inverse, np.linalg.inv(J), atol=1e-9)


@pytest.mark.parametrize("convention", list(LINK_MATRICES))
def test_the_link_matrix_in_symbols_is_that_of_a_row(convention):
    found = LINK_MATRICES[convention]
    columns = {"standard": "a", "modified": "a", "khalil": "d"}
    rng = np.random.default_rng(4)
    for _ in range(20):
        alpha, x, z, theta = rng.uniform(-3, 3, 4)
        along = "r" if convention == "khalil" else "d"
        row = {"type": "R", "alpha": alpha, columns[convention]: x, along: z}
        table = read_mapping({"convention": str(convention), "joints": [row]})
        scope = {"cos": np.cos, "sin": np.sin, "alpha": alpha, "theta": theta}
        scope |= {columns[convention]: x, along: z}
        value = [[eval(entry, {}, scope) for entry in line] for line in found.matrix]
        np.testing.assert_allclose(value, dh_matrices(table, [theta]).A[0], atol=1e-14)
        product = np.eye(4)
        for factor in found.product:
            kind, axis, name = factor.replace("(", " ").replace(",", "").rstrip(")").split()
            product = product @ elementary(kind, "xyz".index(axis), scope[name])
        np.testing.assert_allclose(value, product, atol=1e-14)
        exec(found.text(), scope)
        np.testing.assert_allclose(scope["A"], value)


def elementary(kind, axis, value):
    T = np.eye(4)
    if kind == "Trans":
        T[axis, 3] = value
        return T
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    T[i, i] = T[j, j] = np.cos(value)
    T[j, i], T[i, j] = np.sin(value), -np.sin(value)
    return T


def test_names_of_the_table_come_back():
    table = read_mapping(
        {
            "convention": "standard",
            "values": {"L1": 0.4, "L2": "30cm", "d_3": 0.1, "x": 1},
            "joints": [
                {"type": "R", "alpha": 0, "a": "L1", "d": "-d_3"},
                {"type": "R", "alpha": 0, "a": "L2", "d": "x"},
                {"type": "R", "alpha": 0, "a": " L_1 ", "d": 0.2},
                {"type": "P", "alpha": 0, "a": "2*L1", "d": "q4", "theta": 0},
            ],
        }
    )
    answer = written(table, "position", parameters="symbolic")
    assert answer["values"] == {
        "L1": 0.4,
        "d_3": 0.1,
        "L2": 0.3,
        "x": 1.0,
        "a4": 0.8,
        "d3": 0.2,
    }
    q = random_q(4)
    T = dh_matrices(table, q).T
    np.testing.assert_allclose(evaluator(answer, q)(answer["position"]), T[:, :3, 3], atol=1e-12)
    again = written(read_mapping(table_to_mapping(table)), "position", parameters="symbolic")
    assert again["position"] == answer["position"]
    renamed = written(
        table, "position", parameters="symbolic", symbols=(("L1", "u1"), ("d1", "v1"))
    )
    assert set(renamed["values"]) == {"u1", "v1", "L2", "x", "a4", "d3"}
    assert renamed["values"]["v1"] == -0.1
    assert not written(table, "position")["values"]


def test_names_that_would_mislead_are_left_out():
    rows = [
        {"type": "R", "alpha": 0, "a": "a2", "d": 0},
        {"type": "R", "alpha": 0, "a": 0.3, "d": 0},
        {"type": "R", "alpha": 0, "a": "C1", "d": 0},
    ]
    table = read_mapping({"convention": "dh", "values": {"a2": 0.4, "C1": 0.1}, "joints": rows})
    answer = written(table, "position", parameters="symbolic")
    assert answer["values"] == {"a1": 0.4, "a2": 0.3, "a3": 0.1}


def test_names_move_with_their_lengths():
    rows = [
        {"type": "R", "alpha": 0, "a": "L1", "d": "H"},
        {"type": "R", "alpha": 0, "a": "L2", "d": 0},
    ]
    values = {"L1": 0.4, "L2": 0.3, "H": 0.2}
    table = read_mapping({"convention": "standard", "values": values, "joints": rows})
    other = to_convention(table, Convention.MODIFIED)
    assert [dict(row.symbols) for row in other.rows] == [{"d": "H"}, {"a": "L1"}]
    answer = written(other, "position", parameters="symbolic", frame="frame_2")
    assert answer["position"]["X"] == "L1*C1"
    back = to_convention(other, Convention.STANDARD)
    assert dict(back.rows[0].symbols) == {"a": "L1", "d": "H"}
