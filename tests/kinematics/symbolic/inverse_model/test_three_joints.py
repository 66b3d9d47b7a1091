"""Turns and slides of textbook arms, alone and before a spherical wrist: poses and own q."""

import math

import numpy as np
import pytest

from dh_to_urdf.table import Convention, DHRow, DHTable, JointType
from kinematics.forward import fk
from kinematics.symbolic.inverse_model.derive import NoClosedForm
from robots.robot import robot_from_table
from tests.kinematics.symbolic.formulas import written
from tests.kinematics.symbolic.inverse_model.test_against_closed_form import python_function

RIGHT = math.pi / 2
ARMS = {
    "elbow": [("R", 0.1, 0.4, RIGHT), ("R", 0.5, 0.1, 0.0), ("R", 0.3, 0.0, RIGHT)],
    "shoulder": [("R", 0.0, 0.4, RIGHT), ("R", 0.2, 0.3, -RIGHT), ("R", 0.4, 0.1, RIGHT)],
    "spherical": [("R", 0.0, 0.4, -RIGHT), ("R", 0.0, 0.2, RIGHT), ("P", 0.0, 0.1, 0.0)],
    "offset spherical": [("R", 0.3, 0.4, -RIGHT), ("R", 0.1, 0.2, RIGHT), ("P", 0.1, 0.1, 0.0)],
    "SCARA without hand": [("R", 0.5, 0.3, 0.0), ("R", 0.4, 0.0, math.pi), ("P", 0.0, 0.0, 0.0)],
    "slanted column": [("R", 0.5, 0.3, 0.0), ("R", 0.4, 0.0, 0.7), ("P", 0.2, 0.0, 0.0)],
    "cylindrical": [("R", 0.0, 0.2, 0.0), ("P", 0.0, 0.1, -RIGHT), ("P", 0.1, 0.3, 0.0)],
    "slanted cylinder": [("R", 0.1, 0.2, 0.4), ("P", 0.2, 0.1, 1.1), ("P", 0.1, 0.3, 0.0)],
    "gantry": [("P", 0.1, 0.2, RIGHT), ("P", 0.0, 0.1, RIGHT), ("P", 0.1, 0.3, 0.0)],
    "slanted gantry": [("P", 0.1, 0.2, 0.9), ("P", 0.0, 0.1, 1.2), ("P", 0.1, 0.3, 0.0)],
}
WRIST = [("R", 0.0, 0.3, RIGHT), ("R", 0.0, 0.0, -RIGHT), ("R", 0.0, 0.1, 0.0)]


def table_of(links, convention, sign=1):
    """A table in a convention; the tool puts the end off the last axis."""
    rows = []
    for k, (kind, a, d, alpha) in enumerate(links):
        if convention is not Convention.STANDARD:
            _, a, _, alpha = links[k - 1] if k else ("R", 0.0, 0.0, 0.0)
        slides = kind == "P"
        rows.append(
            DHRow(
                f"j{k + 1}",
                JointType.PRISMATIC if slides else JointType.REVOLUTE,
                alpha=alpha,
                a=a,
                d=0.0 if slides else d,
                theta=(RIGHT, 0.3)[k % 2] if slides else 0.0,
                parent=k,
                offset=d if slides else 0.2,
                sign=sign if k % 2 else 1,
            )
        )
    tool = np.eye(4)
    tool[:3, 3] = 0.45, 0.05, 0.02
    return DHTable("textbook", convention, tuple(rows), tool=tool)


@pytest.mark.parametrize("convention", list(Convention))
@pytest.mark.parametrize("hand", ["alone", "before a wrist"])
@pytest.mark.parametrize("name", ARMS)
def test_solutions_reach_the_target_and_hold_its_q(name, hand, convention):
    links = ARMS[name] + (WRIST if hand == "before a wrist" else [])
    table = table_of(links, convention, sign=-1)
    robot, function = robot_from_table(table), python_function(table, parameters="symbolic")
    rng = np.random.default_rng(4)
    for _ in range(5):
        q = rng.uniform(-1.4, 1.4, table.dof)
        T = fk(robot, q)["tool"]
        found = function(T.tolist())
        for one in found:
            error = fk(robot, np.array(one["q"]))["tool"] - T
            error = error if hand == "before a wrist" else error[:3, 3]
            assert np.abs(error).max() < 1e-12
        turned = [np.exp(1j * (np.array(one["q"]) - q)) - 1 for one in found]
        assert min(np.abs(one).max() for one in turned) < 1e-9
        assert len({tuple(one["posture"]) for one in found}) == len(found)


def test_a_cylindrical_arm_is_written_as_in_textbooks():
    links = [("R", 0.0, 0.5, 0.0), ("P", 0.0, 0.0, -RIGHT), ("P", 0.0, 0.0, 0.0)]
    rows = [
        DHRow(
            f"j{k + 1}",
            JointType.PRISMATIC if kind == "P" else JointType.REVOLUTE,
            alpha=alpha,
            a=a,
            d=d,
            theta=0.0,
            parent=k,
        )
        for k, (kind, a, d, alpha) in enumerate(links)
    ]
    table = DHTable("cylindrical", Convention.STANDARD, tuple(rows))
    answer = written(table, "inverse", parameters="symbolic")
    texts = [line["text"] for step in answer["inverse"]["steps"] for line in step["lines"]]
    assert "w3 = sqrt(X**2 + Y**2)" in texts
    assert "d3 = e3*w3" in texts
    assert "d2 = Z - d1" in texts
    assert answer["inverse"]["postures"] == [["extended", "retracted"]]


def test_slides_that_do_not_span_space_are_refused():
    links = [("P", 0.1, 0.2, RIGHT), ("P", 0.0, 0.1, 0.0), ("P", 0.1, 0.3, 0.0)]
    answer = written(table_of(links, Convention.STANDARD), "inverse")
    assert answer["inverse"] is None
    assert "of 3 joints (PPP)" in answer["no_inverse"]
    assert issubclass(NoClosedForm, ValueError)
