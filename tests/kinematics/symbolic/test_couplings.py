"""Closed forms of tables whose joints depend on each other."""

from __future__ import annotations

import numpy as np
import pytest

from dh_to_urdf import dh_matrices, read_mapping
from kinematics.jacobian import jacobian
from kinematics.symbolic.chain import fraction_in
from kinematics.symbolic.request import Notation, Quantity, SymbolicRequest
from kinematics.symbolic.writing import Writing
from robots.robot import robot_from_table


def random_table(seed, convention):
    rng = np.random.default_rng(seed)
    rows = []
    for _ in range(int(rng.integers(3, 6))):
        slides = rng.random() < 0.25
        row = {"type": "P" if slides else "R", "sign": int(rng.choice([-1, 1]))}
        row |= {"alpha": str(rng.choice(["0", "pi/2", "-pi/2", "pi"]))}
        row |= {"a": float(rng.choice([0, 0.3])), "d": 0.0 if slides else 0.2, "theta": 0}
        row["offset"] = float(rng.choice([0, 0.25])) if slides else "pi/2"
        turning = [n for n, other in enumerate(rows) if other["type"] == "R"]
        if turning and rng.random() < 0.7:
            name = f"j{int(rng.choice(turning)) + 1}"
            factor = float(rng.choice([1, -1, 2])) * (0.05 if slides else 1)
            if rng.random() < 0.5:
                offset = 0.1 if slides else "pi/6"
                row["mimic"] = {"joint": name, "multiplier": factor, "offset": offset}
            else:
                row["coupling"] = {name: factor}
        rows.append(row)
    return read_mapping({"convention": convention, "joints": rows})


def written(table, **options):
    quantities = (Quantity.A, Quantity.T0, Quantity.T, Quantity.POSITION, Quantity.JACOBIAN)
    request = SymbolicRequest(quantities=quantities, notation=Notation.PYTHON, **options)
    writing = Writing(table, request)
    writing.plain()
    writing.simplify()
    return writing.answer()


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_formulas_are_the_numbers_of_the_table(seed, convention):
    table = random_table(seed, convention)
    answer = written(table)
    assert all(answer["simplified"].values())
    names = {}
    exec(answer["code"], names)
    functions = [one for one in names.values() if hasattr(one, "__code__")]
    q = np.random.default_rng(seed).uniform(-2, 2, table.dof)
    found = {np.shape(one(q)): np.array(one(q)) for one in functions}
    np.testing.assert_allclose(found[4, 4], dh_matrices(table, q).T, rtol=0, atol=1e-12)
    J = jacobian(robot_from_table(table), q)
    np.testing.assert_allclose(found[6, table.dof], J, rtol=0, atol=1e-12)


def test_a_palletiser_reads_as_in_lectures():
    rows = [
        {"type": "R", "alpha": 0, "a": 0.4, "d": 0},
        {"type": "R", "alpha": 0, "a": 0.3, "d": 0, "theta": "q2 - q1"},
    ]
    table = read_mapping({"convention": "standard", "joints": rows})
    request = SymbolicRequest(quantities=(Quantity.POSITION, Quantity.DET_JACOBIAN))
    writing = Writing(table, request)
    writing.plain()
    writing.simplify()
    answer = writing.answer()
    assert answer["position"]["X"] == "0.3*C2 + 0.4*C1"
    assert any("all free" in note for note in answer["notes"])


def test_a_fraction_of_a_turn_is_named():
    rows = [
        {"type": "R", "alpha": 0, "a": 0.4, "d": 0},
        {"type": "R", "alpha": 0, "a": 0.3, "d": 0, "theta": "q2 - 0.5*q1"},
    ]
    assert fraction_in(read_mapping({"convention": "standard", "joints": rows})) == "j2"
