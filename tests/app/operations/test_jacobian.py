"""The Jacobian of a task over HTTP, and the link matrix in symbols."""

import numpy as np
import pytest

from tests.app.http.requests import check

PLANAR = "/v1/robots/planar_2r/jacobian"


def ask(client, path, body, **query):
    answer = client.post(path, json=body, params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


@pytest.mark.scene
def test_two_rows_of_a_planar_arm(client):
    """Against the formulas of every course; lengths 1 and 0.8."""
    q1, q2 = 0.5, 0.3
    said = ask(client, PLANAR, {"q": [q1, q2], "task": "xy"})
    s1, c1, s12, c12 = np.sin(q1), np.cos(q1), np.sin(q1 + q2), np.cos(q1 + q2)
    J = np.array([[-s1 - 0.8 * s12, -0.8 * s12], [c1 + 0.8 * c12, 0.8 * c12]])
    np.testing.assert_allclose(said["jacobian"], J, atol=1e-12)
    assert said["determinant"] == pytest.approx(0.8 * np.sin(q2), abs=1e-12)
    np.testing.assert_allclose(said["inverse"], np.linalg.inv(J), atol=1e-10)
    assert (said["rows"], said["square_columns"]) == (["vx", "vy"], ["j1", "j2"])
    got = client.get(f"{PLANAR}?q={q1},{q2}&task=xy").json()
    assert got == said


def test_no_inverse_at_a_singularity(client):
    batch = ask(client, PLANAR, {"q": [[0.5, 0], [0.5, 1]], "task": "xy"})
    assert batch["inverse"][0] is None
    assert np.shape(batch["inverse"][1]) == (2, 2)
    assert batch["determinant"][0] == pytest.approx(0, abs=1e-12)
    assert ask(client, PLANAR, {"q": [0.5, 0], "task": "xy"})["inverse"] is None


def test_only_joints_that_move_the_frame_count(client):
    body = {"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "frame": "frame_3", "task": "position"}
    said = ask(client, "/v1/robots/puma560/jacobian", body)
    assert said["square_columns"] == ["j1", "j2", "j3"]
    J = np.array(said["jacobian"])
    assert J.shape == (3, 6)
    assert said["determinant"] == pytest.approx(np.linalg.det(J[:, :3]), abs=1e-12)
    assert "determinant" not in ask(
        client, "/v1/robots/puma560/jacobian", {**body, "frame": "tool"}
    )


@pytest.mark.parametrize("task", ["pose", "xyz_phi", "direction", "position_direction"])
@pytest.mark.parametrize("reference_frame", ["local_world_aligned", "local", "world"])
def test_rows_are_those_of_the_whole(client, task, reference_frame):
    q = {"q": np.random.default_rng(5).uniform(-2, 2, (4, 6)).tolist()}
    axes = {"reference_frame": reference_frame}
    path = "/v1/robots/puma560/jacobian"
    said = ask(client, path, {**q, **axes, "task": task})
    whole = np.array(ask(client, path, {**q, **axes})["jacobian"])
    own = np.array(ask(client, path, {**q, "reference_frame": "local"})["jacobian"])
    names = ["vx", "vy", "vz", "wx", "wy", "wz"]
    if "direction" in task:
        whole[:, 3:] = own[:, 3:]
    rows = [names.index(row) for row in said["rows"]]
    np.testing.assert_allclose(said["jacobian"], whole[:, rows], atol=1e-12)


def test_euler_rates_take_whole_rotations(client):
    body = {"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "euler": "ZXZ"}
    path = "/v1/robots/puma560/jacobian"
    whole = np.array(ask(client, path, body)["jacobian"])
    said = ask(client, path, {**body, "task": "orientation"})
    np.testing.assert_array_equal(said["jacobian"], whole[3:])
    assert said["rows"] == ["phi_dot", "theta_dot", "psi_dot"]
    check(client.post(path, json={**body, "task": "xy_phi"}), 422, "/task", "leave euler out")


@pytest.mark.scene
@pytest.mark.parametrize("convention", ["standard", "craig", "khalil"])
def test_the_link_matrix_in_symbols(client, convention):
    said = client.get(f"/v1/dh-matrices?convention={convention}").json()
    along = "r" if convention == "khalil" else "d"
    x = "d" if convention == "khalil" else "a"
    row = {"type": "R", "alpha": 0.3, x: 0.7, along: 0.2}
    table = {"convention": convention, "joints": [row]}
    numbers = ask(client, "/v1/dh-matrices", {"robot": table, "q": [0.9]})["A"][0]
    scope = {"cos": np.cos, "sin": np.sin, "theta": 0.9, "alpha": 0.3, x: 0.7, along: 0.2}
    value = [[eval(entry, {}, scope) for entry in line] for line in said["matrix"]]
    np.testing.assert_allclose(value, numbers, atol=1e-15)
    text = client.get(f"/v1/dh-matrices?convention={convention}&format=text").text
    assert said["matrix"][0][0] in text


def test_a_link_matrix_of_no_convention(client):
    check(client.get("/v1/dh-matrices"), 422, "/convention", "standard, modified, khalil")
    check(client.get("/v1/dh-matrices?convention=dhx"), 422, "/convention", "'dhx'")
    check(client.get("/v1/dh-matrices?convention=dh&q=1"), 422, "/q", "unknown")
