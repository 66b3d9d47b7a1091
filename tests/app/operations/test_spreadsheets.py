"""Answers as CSV: what a spreadsheet reads is what JSON says, row by row."""

from __future__ import annotations

import csv
import io
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.sheets.sheet import Column, Sheet, cell

ARM = "/v1/robots/puma560"
LINE = {
    "q": [1.9, -0.25, -0.45, -0.5, -0.5, -0.35, 0, 0.2],
    "target": {"position": [1.15, -0.15]},
    "task": "xy",
    "samples": 21,
}
OBSTACLE = {
    "obstacles": [{"type": "circle", "center": [0.73, 0.22], "radius": 0.08}],
    "link_radius": 0.02,
    "d_safe": 0.02,
}


def table(client, path, body, **query):
    """The columns of a CSV answer, by heading; numbers where all of a column are."""
    answer = client.post(path, json=body, params={**query, "format": "csv"})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    assert answer.headers["content-length"] == str(len(answer.content))
    headings, *rows = csv.reader(io.StringIO(answer.content.decode(), newline=""))
    assert all(len(row) == len(headings) for row in rows)
    assert len(set(headings)) == len(headings)
    columns = zip(*rows, strict=True) if rows else [()] * len(headings)
    found = dict(zip(headings, columns, strict=True))
    return {name: as_numbers(values) for name, values in found.items()}


def as_numbers(values):
    try:
        return np.array([float(value) for value in values])
    except ValueError:
        return list(values)


def stacked(found, names):
    return np.stack([found[name] for name in names], axis=-1)


def joints(robot_dof, unit, prefix="q"):
    return [f"{prefix}_j{k} [{unit}]" for k in range(1, robot_dof + 1)]


@pytest.mark.scene
def test_one_row_a_pose(client):
    q = np.random.default_rng(1).uniform(-90, 90, (5, 6))
    body = {"q": q.tolist(), "frames": ["tool", "frame_3"], "euler": "ZXZ"}
    found = table(client, f"{ARM}/fk", body, angle="deg")
    poses = client.post(f"{ARM}/fk?angle=deg", json=body).json()["poses"]
    assert found["frame"] == ["tool", "frame_3"] * 5
    np.testing.assert_array_equal(found["sample"], np.repeat(np.arange(5), 2))
    np.testing.assert_allclose(
        stacked(found, joints(6, "deg")), np.repeat(q, 2, axis=0), atol=1e-12
    )
    T = np.stack([poses[name]["matrix"] for name in ("tool", "frame_3")], axis=1).reshape(-1, 4, 4)
    R = stacked(found, [f"R_{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]).reshape(-1, 3, 3)
    np.testing.assert_array_equal(R, T[:, :3, :3])
    np.testing.assert_array_equal(stacked(found, ["x [m]", "y [m]", "z [m]"]), T[:, :3, 3])
    turned = Rotation.from_quat(stacked(found, [f"quaternion_{letter}" for letter in "xyzw"]))
    np.testing.assert_allclose(turned.as_matrix(), R, atol=1e-12)
    rpy = Rotation.from_euler(
        "xyz", stacked(found, ["roll [deg]", "pitch [deg]", "yaw [deg]"]), degrees=True
    )
    np.testing.assert_allclose(rpy.as_matrix(), R, atol=1e-12)
    for solution in (1, 2):
        names = [f"euler_ZXZ_{solution}_{k} [deg]" for k in (1, 2, 3)]
        again = Rotation.from_euler("ZXZ", stacked(found, names), degrees=True)
        np.testing.assert_allclose(again.as_matrix(), R, atol=1e-12)


@pytest.mark.scene
def test_one_row_a_target_with_its_status(client):
    body = {"task": "xy", "targets": {"position": [[1, 0.5], [9, 9], [0.5, 1]]}}
    found = table(client, "/v1/robots/planar_2r/ik", body)
    assert found["status"] == ["converged", "unreachable", "converged"]
    said = client.post("/v1/robots/planar_2r/ik", json=body).json()
    np.testing.assert_array_equal(stacked(found, joints(2, "rad")), said["q"])
    np.testing.assert_array_equal(found["position_error [m]"], said["position_error"])
    one = table(client, "/v1/robots/planar_2r/ik", {"task": "xy", "target": {"position": [9, 9]}})
    assert one["status"] == ["unreachable"]
    assert list(one) == list(found)


def test_one_row_a_solution(client):
    body = {"target": {"position": [0.4, 0.2, 0.5], "rpy": [0.1, 0.2, 0.3]}}
    found = table(client, f"{ARM}/ik/solutions", body)
    solutions = client.post(f"{ARM}/ik/solutions", json=body).json()["solutions"]
    np.testing.assert_array_equal(stacked(found, joints(6, "rad")), [one["q"] for one in solutions])
    assert found["posture"] == [" ".join(one["posture"]) for one in solutions]
    assert found["within_limits"] == [str(one["within_limits"]).lower() for one in solutions]
    none = {"target": {"position": [9, 9, 9], "rpy": [0, 0, 0]}}
    assert list(table(client, f"{ARM}/ik/solutions", none)) == list(found)


def test_one_row_a_q_with_its_measures(client):
    q = [[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], [0, 0.5, 0.2, 0, 0, 0]]
    found = table(client, f"{ARM}/singularity", {"q": q})
    said = client.post(f"{ARM}/singularity", json={"q": q}).json()
    np.testing.assert_array_equal(found["rank"], said["rank"])
    assert found["singular"] == ["false", "true"]
    assert found["condition_number"][1] == ""
    sigma = stacked(found, [f"sigma_{k}" for k in range(1, 7)])
    np.testing.assert_allclose(sigma, said["singular_values"], atol=1e-15)
    J = np.array(client.post(f"{ARM}/jacobian", json={"q": q}).json()["jacobian"])
    np.testing.assert_allclose(found["manipulability"], np.abs(np.linalg.det(J)), atol=1e-12)
    np.testing.assert_allclose(np.abs(found["determinant"]), found["manipulability"], atol=1e-12)
    assert found["factor_wrist"][1] == pytest.approx(0, abs=1e-12)


def test_one_row_a_row_of_the_jacobian(client):
    q = [[0.1, 0.2], [0.5, 0.3]]
    found = table(client, "/v1/robots/planar_2r/jacobian", {"q": q, "task": "xy_phi"})
    assert found["row"] == ["vx", "vy", "wz"] * 2
    assert found["unit"] == ["m", "m", "rad"] * 2
    J = stacked(found, ["j1 [1/rad]", "j2 [1/rad]"]).reshape(2, 3, 2)
    whole = client.post("/v1/robots/planar_2r/jacobian", json={"q": q}).json()["jacobian"]
    np.testing.assert_array_equal(J, np.array(whole)[:, [0, 1, 5]])
    assert "determinant" not in found


@pytest.mark.scene
def test_one_row_a_sample_of_a_path(client):
    path = "/v1/robots/planar_8r/path"
    body = {**LINE, **OBSTACLE, "method": "pseudo_inverse", "closed_loop": False}
    found = table(client, path, body)
    said = client.post(path, json=body).json()
    for heading, key in (("t [s]", "t"), ("r", "r"), ("clearance [m]", "clearance")):
        np.testing.assert_array_equal(found[heading], said[key])
    for prefix, unit, key in (
        ("q", "rad", "q"),
        ("qd", "rad/s", "velocity"),
        ("qdd", "rad/s^2", "acceleration"),
    ):
        np.testing.assert_array_equal(stacked(found, joints(8, unit, prefix)), said[key])
    poses = client.post("/v1/robots/planar_8r/fk", json={"q": said["q"]}).json()["poses"]["tool"]
    tip = stacked(found, ["x [m]", "y [m]", "z [m]"])
    np.testing.assert_allclose(tip, poses["position"], atol=1e-12)
    start, end = tip[0], np.array([*LINE["target"]["position"], 0])
    wanted = start + np.outer(found["r"], end - start)
    error = np.linalg.norm((tip - wanted)[:, :2], axis=1)
    np.testing.assert_allclose(found["position_error [m]"], error, atol=1e-12)
    report = client.post(
        "/v1/robots/planar_8r/singularity", json={"q": said["q"], "task": "xy"}
    ).json()
    np.testing.assert_allclose(found["manipulability"], report["manipulability"], atol=1e-12)
    told = [set(one.split()) for one in found["status"]]
    lost = error > 1e-4
    assert [("tracking" in one) for one in told] == lost.tolist()
    assert told[0] == {"ok"}
    assert {*set().union(*told)} - {"ok"} == set(said["violations"])
    swept = np.array([np.inf, *said["clearance_swept"]])
    near = np.minimum(said["clearance"], swept) < OBSTACLE["d_safe"]
    assert ["clearance" in one for one in told] == near.tolist()


def test_samples_in_degrees_without_obstacles(client):
    q = {"q": np.degrees(LINE["q"]).tolist()}
    found = table(client, "/v1/robots/planar_8r/path", {**LINE, **q}, angle="deg", digits=3)
    assert found["q_j1 [deg]"][0] == pytest.approx(math.degrees(1.9), abs=5e-4)
    assert set(found["status"]) == {"ok"}
    assert not any("clearance" in name for name in found)


def test_warnings_are_told_with_and_without_rows(client):
    doubtful = {"q": [0, 45, -90, 0, 30, 0]}
    found = table(client, f"{ARM}/fk", doubtful)
    assert "degrees" in found["warnings"][0]
    empty = {"target": {"position": [900, 0, 0], "rpy": [0, 0, 0]}}
    answer = client.post(f"{ARM}/ik/solutions?format=csv", json=empty)
    assert len(answer.text.splitlines()) == 1
    assert "millimetres" in answer.headers["x-warnings"]


def test_followers_have_columns_of_their_own(client):
    arm = {
        "convention": "standard",
        "joints": [
            {"name": "a", "type": "R", "a": 1, "alpha": 0, "d": 0},
            {"name": "b", "type": "R", "a": 1, "alpha": 0, "d": 0, "mimic": {"joint": "a"}},
            {"name": "c", "type": "R", "a": 1, "alpha": 0, "d": 0},
        ],
    }
    found = table(client, "/v1/fk", {"robot": arm, "q": [[10, 20]]}, angle="deg")
    assert found["joint_b [deg]"] == pytest.approx([10])
    assert [name for name in found if name.startswith("q_")] == ["q_a [deg]", "q_c [deg]"]


@pytest.mark.scene
@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1"])
def test_texts_are_no_formulas(text):
    assert cell(text, None) == f"'{text}"


def test_cells_of_numbers_that_are_none_are_empty():
    sheet = Sheet(
        (Column("a", np.array([1.5, -0.0, np.nan, np.inf]), "m"), Column("b", [1, 2, 3, 4]))
    )
    assert list(sheet.rows()) == [(1.5, 1), (0.0, 2), (None, 3), (None, 4)]
    assert math.copysign(1, next(iter(list(sheet.rows())[1:]))[0]) == 1
    assert sheet.headings == ["a [m]", "b"]
