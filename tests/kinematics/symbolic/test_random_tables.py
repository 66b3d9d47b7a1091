"""Random tables in the three conventions: formulas equal Pinocchio's numbers."""

import math

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dh_to_urdf import dh_matrices
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from robots.robot import robot_from_table
from tests.kinematics.symbolic.formulas import evaluator, written

ANGLES = st.one_of(
    st.integers(-12, 12).map(lambda k: k * math.pi / 12),
    st.integers(-2, 2).map(lambda k: k * math.pi / 2),
    st.floats(-3, 3),
)
LENGTHS = st.one_of(st.just(0.0), st.sampled_from([0.3, -0.3, 1.0]), st.floats(-1, 1))


@st.composite
def tables(draw):
    convention = draw(st.sampled_from(list(Convention)))
    rows = []
    for k in range(draw(st.integers(1, 4))):
        type_ = draw(st.sampled_from(list(JointType)))
        if k == 0:
            type_ = JointType.REVOLUTE
        khalil = convention is Convention.KHALIL
        rows.append(
            DHRow(
                name=f"j{k + 1}",
                type=type_,
                alpha=draw(ANGLES),
                a=draw(LENGTHS),
                d=0.0 if type_ is JointType.PRISMATIC else draw(LENGTHS),
                theta=0.0 if type_.is_revolute else draw(ANGLES),
                parent=k,
                offset=0.0 if type_ is JointType.FIXED else draw(ANGLES),
                sign=draw(st.sampled_from([1, -1])),
                gamma=draw(ANGLES) if khalil else 0.0,
                b=draw(LENGTHS) if khalil else 0.0,
            )
        )
    return DHTable("random", convention, tuple(rows))


@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(table=tables(), parameters=st.sampled_from(["numeric", "symbolic"]))
def test_random_tables(table, parameters):
    robot = robot_from_table(table)
    answer = written(table, parameters=parameters, time_budget=30.0)
    q = np.random.default_rng(1).uniform(-3, 3, (10, table.dof))
    value = evaluator(answer, q)
    tolerance = {"atol": 1e-12, "rtol": 0}
    numbers = dh_matrices(table, q)
    np.testing.assert_allclose(value(answer["A"]), numbers.A, **tolerance)
    np.testing.assert_allclose(value(answer["T0"]), numbers.T0, **tolerance)
    np.testing.assert_allclose(value(answer["T"]), fk(robot, q)["tool"], **tolerance)
    J = jacobian(robot, q)
    np.testing.assert_allclose(value(answer["jacobian"]["matrix"]), J, **tolerance)
    found = answer["det_jacobian"]
    if found["expression"] is not None:
        rows = [("vx", "vy", "vz", "wx", "wy", "wz").index(row) for row in found["rows"]]
        square = J[:, rows]
        bound = np.prod(np.linalg.norm(square, axis=1), axis=1)
        difference = np.abs(value(found["expression"]) - np.linalg.det(square))
        assert (difference <= 1e-12 * np.maximum(bound, 1.0)).all()
