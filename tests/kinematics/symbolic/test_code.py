"""Generated functions run and give Pinocchio's numbers."""

import shutil

import numpy as np
import pytest

from dh_to_urdf import dh_matrices
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from kinematics.symbolic import Notation
from robots.shipped import shipped_robot
from tests.kinematics.symbolic.formulas import c_program, python_functions, written

CASES = [("planar_2r", "numeric"), ("stanford", "symbolic"), ("pa10", "numeric")]
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


def random_q(dof, n):
    return np.random.default_rng(3).uniform(-3, 3, (n, dof))


@pytest.mark.parametrize(("name", "parameters"), CASES)
def test_python(name, parameters):
    robot = shipped_robot(name)
    answer = written(robot.table, notation=Notation.PYTHON, parameters=parameters)
    assert answer["simplified"]["code"] is True
    functions = python_functions(answer["code"])
    for q in random_q(robot.dof, 20):
        tolerance = {"atol": 1e-12, "rtol": 0}
        T, numbers = fk(robot, q)["tool"], dh_matrices(robot.table, q)
        np.testing.assert_allclose(functions.fk(q), T, **tolerance)
        np.testing.assert_allclose(functions.position(q), T[:3, 3], **tolerance)
        np.testing.assert_allclose(functions.rotation(q), T[:3, :3], **tolerance)
        np.testing.assert_allclose(functions.link_matrices(q), numbers.A, **tolerance)
        np.testing.assert_allclose(functions.partial_products(q), numbers.T0, **tolerance)
        J = jacobian(robot, q)
        np.testing.assert_allclose(functions.jacobian(q), J, **tolerance)
        if name == "pa10":
            minors = [np.linalg.det(np.delete(J, k, axis=1)) for k in range(7)]
            np.testing.assert_allclose(functions.jacobian_minors(q), minors, atol=1e-12)
        else:
            rows = [0, 1] if name == "planar_2r" else range(6)
            det = np.linalg.det(J[rows])
            np.testing.assert_allclose(functions.det_jacobian(q), det, atol=1e-12)


def test_lengths_are_arguments_of_python():
    robot = shipped_robot("planar_2r")
    code = written(
        robot.table, "position", notation=Notation.PYTHON, symbols=(("a1", "L1"), ("a2", "L2"))
    )["code"]
    position = python_functions(code).position
    np.testing.assert_allclose(position([0.0, 0.0]), [1.8, 0, 0], atol=1e-15)
    np.testing.assert_allclose(position([0.0, 0.0], L1=2.0, L2=0.5), [2.5, 0, 0], atol=1e-15)


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize(("name", "parameters"), CASES)
def test_c(name, parameters, tmp_path):
    robot = shipped_robot(name)
    answer = written(
        robot.table,
        "T",
        "jacobian",
        "position",
        "det_jacobian",
        notation=Notation.C,
        parameters=parameters,
    )
    q = random_q(robot.dof, 5)
    dof, minors = robot.dof, 7 if name == "pa10" else 1
    determinant = "jacobian_minors" if name == "pa10" else "det_jacobian"
    calls = []
    for one in q:
        literal = "(double[]){" + ", ".join(map(repr, one.tolist())) + "}"
        for function, size in (
            ("fk", 16),
            ("position", 3),
            ("jacobian", 6 * dof),
            (determinant, minors),
        ):
            lengths = arguments_of(answer["code"], function, answer["values"])
            calls.append((f"{function}({literal}, {lengths}out)", size))
    found = c_program(answer["code"], calls, tmp_path, COMPILER).reshape(len(q), -1)
    T, J = fk(robot, q)["tool"], jacobian(robot, q)
    expected = [T.reshape(len(q), -1), T[:, :3, 3], J.reshape(len(q), -1)]
    sum_of_sizes = sum(part.shape[1] for part in expected)
    np.testing.assert_allclose(
        found[:, :sum_of_sizes], np.concatenate(expected, axis=1), atol=1e-12, rtol=0
    )
    if name == "pa10":
        parts = [np.delete(J, k, axis=2) for k in range(7)]
    else:
        parts = [J[:, [0, 1]] if name == "planar_2r" else J]
    determinants = np.stack([np.linalg.det(part) for part in parts], axis=1)
    np.testing.assert_allclose(found[:, sum_of_sizes:], determinants, atol=1e-12, rtol=0)


def arguments_of(code, function, values):
    """Values of the lengths in the order of a C function's arguments."""
    signature = code.split(f"void {function}(")[1].split(")")[0]
    names = [part.split()[-1] for part in signature.split(",")[1:-1]]
    return "".join(f"{values[name]!r}, " for name in names)
