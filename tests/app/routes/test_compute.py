"""Forms of requests and answers: batches, npy, text, degrees, names, inline robots."""

import io
import json
import subprocess

import httpx
import numpy as np
import pytest

from tests.app.meanwhile import others_are_served
from tests.conftest import PATIENCE

NPY = {"Content-Type": "application/x-npy", "Accept": "application/x-npy"}


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def leaves(value, path=()):
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    else:
        yield path, value


@pytest.mark.scene
@pytest.mark.parametrize("operation", ["fk", "jacobian", "singularity", "dh-matrices"])
def test_a_batch_is_the_single_answers_stacked(client, operation):
    rng = np.random.default_rng(0)
    batch = rng.uniform(-1, 1, (7, 6)).tolist()
    extra = {"fk": {"frames": "all", "euler": "ZYZ"}, "singularity": {"task": "position"}}
    path, options = f"/v1/robots/puma560/{operation}", extra.get(operation, {})
    many = dict(leaves(client.post(path, json={"q": batch, **options}).json()))
    for k, q in enumerate(batch):
        for leaf, value in leaves(client.post(path, json={"q": q, **options}).json()):
            if not isinstance(value, (list, float, int)) or isinstance(value, bool):
                continue
            if leaf[-1] == "warnings":  # names the first row that is doubtful
                continue
            if leaf[-1] in (
                "rows",
                "columns",
                "joints",
                "base",
                "tool",
                "tolerance",
                "characteristic_length",
            ):
                assert many[leaf] == value
            elif leaf[-1] == "explanation":
                assert many[leaf][k] == value
            elif leaf[-1] not in ("lost_directions", "null_motions", "factors"):
                np.testing.assert_allclose(many[leaf][k], value, atol=1e-12, err_msg=str(leaf))


def test_inverse_batches_in_every_form(client):
    q = np.random.default_rng(1).uniform(-1, 1, (5, 7))
    poses = client.post("/v1/robots/pa10/fk", json={"q": q.tolist()}).json()["poses"]["tool"]
    path = "/v1/robots/pa10/ik"
    forms = [
        {"matrix": poses["matrix"]},
        {"position": poses["position"], "rpy": poses["rpy"]},
        {"position": poses["position"], "quaternion_xyzw": poses["quaternion_xyzw"]},
        [{"matrix": matrix} for matrix in poses["matrix"]],
    ]
    for form in forms:
        answer = client.post(path, json={"targets": form}).json()
        assert answer["status"] == ["converged"] * 5
        again = client.post("/v1/robots/pa10/fk", json={"q": answer["q"]}).json()
        np.testing.assert_allclose(
            again["poses"]["tool"]["matrix"], poses["matrix"], atol=3e-6, rtol=0
        )
    single = client.post(path, json={"target": {"matrix": poses["matrix"][0]}}).json()
    assert single["status"] == "converged"
    assert np.shape(single["q"]) == (7,)
    assert single["random_seed"] == 0
    assert single["tolerance"] == {"position": 1e-6, "orientation": 1e-6}


@pytest.mark.scene
def test_degrees_both_ways(client):
    q = [10, 0.2, 30, 40]  # scara: R R P R
    rad = [np.deg2rad(10), np.deg2rad(0.2), 30, np.deg2rad(40)]
    deg = client.post("/v1/robots/scara/fk?angle=deg", json={"q": q, "euler": "ZYX"}).json()
    plain = client.post("/v1/robots/scara/fk", json={"q": rad, "euler": "ZYX"}).json()
    assert deg["units"] == {"angle": "deg", "length": "m"}
    one, other = deg["poses"]["tool"], plain["poses"]["tool"]
    np.testing.assert_allclose(one["matrix"], other["matrix"], atol=1e-14)
    np.testing.assert_allclose(np.deg2rad(one["rpy"]), other["rpy"], atol=1e-14)
    np.testing.assert_allclose(
        np.deg2rad(one["euler"]["solutions"]), other["euler"]["solutions"], atol=1e-14
    )
    angles = {"sequence": "ZYX", "angles": one["euler"]["solutions"][1]}
    target = {"position": one["position"], "euler": angles}
    body = {"target": target, "task": "xyz_phi", "seed": [5, 5, 0.1, 5]}
    answer = client.post("/v1/robots/scara/ik?angle=deg", json=body).json()
    assert answer["units"]["angle"] == "deg"
    np.testing.assert_allclose(answer["seed"], [5, 5, 0.1, 5], atol=1e-12)
    limits = client.get("/v1/robots/scara?angle=deg").json()["joints"]
    assert limits[0]["upper"] == pytest.approx(50)
    assert limits[2]["upper"] == pytest.approx(0.21)


def test_get_takes_expressions_and_equals_post(client):
    body = {"q": [0, np.pi / 4, -np.pi / 2, 0, np.pi / 4, 0]}
    posted = client.post("/v1/robots/puma560/fk", json=body).json()
    for query in ("q=0,pi/4,-90deg,0,45°,0", "q=0,45,-90,0,pi/4,0&angle=deg"):
        got = client.get(f"/v1/robots/puma560/fk?{query}").json()
        np.testing.assert_allclose(
            got["poses"]["tool"]["matrix"], posted["poses"]["tool"]["matrix"], atol=1e-14
        )
    report = client.get("/v1/robots/planar_2r/singularity?q=0,0&task=1,1,0,0,0,0").json()
    assert report["task"] == "xy"


def test_q_by_joint_name(client):
    q = {"j2": 0.2, "j1": 0.1}
    named = client.post("/v1/robots/planar_2r/fk", json={"q": q}).json()
    listed = client.post("/v1/robots/planar_2r/fk", json={"q": [0.1, 0.2]}).json()
    assert named == listed


@pytest.mark.scene
def test_inline_robots_by_table_urdf_and_name(client):
    table = client.get("/v1/robots/stanford/dh").json()
    urdf = client.get("/v1/robots/stanford/urdf").text
    q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    expected = client.post("/v1/robots/stanford/jacobian", json={"q": q}).json()["jacobian"]
    for robot in ("stanford", table, {"urdf": urdf, "tip": "tool"}):
        answer = client.post("/v1/jacobian", json={"robot": robot, "q": q}).json()
        np.testing.assert_allclose(answer["jacobian"], expected, atol=1e-14)


@pytest.mark.scene
@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", "<i4"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_npy_in_and_out(client, dtype, order):
    q = np.array(np.random.default_rng(2).integers(-2, 3, (50, 7)), dtype=dtype, order=order)
    answer = client.post("/v1/robots/panda/fk", content=npy(q), headers=NPY)
    assert answer.headers["content-type"] == "application/x-npy"
    found = np.load(io.BytesIO(answer.content))
    expected = client.post("/v1/robots/panda/fk", json={"q": q.tolist()}).json()
    np.testing.assert_allclose(found, expected["poses"]["tool"]["matrix"], atol=1e-14)
    J = client.post("/v1/robots/panda/jacobian?frame=frame_3", content=npy(q), headers=NPY)
    assert np.load(io.BytesIO(J.content)).shape == (50, 6, 7)


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"\x93NUMPY",
        npy(np.array(["a"])),
        npy(np.zeros((2, 7)))[:-8],
        *(
            npy(np.zeros((2, 6))).replace(b"(2, 6), ", shape.ljust(8))
            for shape in (b"(-2,-3),", b"(0,10),", b"(True,6)")
        ),
        npy(np.array([1 + 2j] * 7)),
        npy(np.full((2, 7), np.nan)),
        npy(np.zeros(5)),
        npy(np.zeros((2, 7))).replace(b"(2, 7),", b"(-2,7),"),
    ],
)
def test_npy_that_is_no_q(client, body):
    answer = client.post("/v1/robots/panda/fk", content=body, headers=NPY)
    assert answer.status_code in (400, 422), answer.status_code
    assert answer.headers["content-type"] == "application/problem+json"


@pytest.mark.scene
def test_text_for_a_terminal(client):
    for ask in ({"headers": {"Accept": "text/plain"}}, {"params": {"format": "text"}}):
        params = {"q": "30,45", "angle": "deg"} | ask.get("params", {})
        answer = client.get("/v1/robots/planar_2r/fk", params=params, headers=ask.get("headers"))
        assert answer.headers["content-type"].startswith("text/plain")
        rows = answer.text.split("matrix:\n")[1].splitlines()[:4]
        assert float(rows[0].split()[3]) == pytest.approx(1.07308064)
        assert len({len(row) for row in rows}) == 1
    for path in (
        "/",
        "/v1/robots",
        "/v1/robots/panda",
        "/v1/robots/panda/dh",
        "/v1/robots/panda/singularity?q=0,0,0,0,0,0,0",
    ):
        assert client.get(path, headers={"Accept": "text/plain"}).text.strip()


def test_a_hundred_thousand_poses_do_not_stall_the_service(server, tmp_path):
    q = np.random.default_rng(3).uniform(-1, 1, (100_000, 6))
    request, response = tmp_path / "q.json", tmp_path / "poses.json"
    request.write_text(f'{{"q": {q.tolist()}}}')
    command = ["curl", "-sf", "-o", response, "--json", f"@{request}"]

    def post() -> None:
        subprocess.run([*command, f"{server}/v1/robots/puma560/fk"], check=True)

    assert others_are_served(server, post)
    poses = json.loads(response.read_text())["poses"]["tool"]
    assert np.shape(poses["matrix"]) == (100_000, 4, 4)
    answer = httpx.post(
        f"{server}/v1/robots/puma560/fk", content=npy(q), headers=NPY, timeout=PATIENCE
    )
    assert np.load(io.BytesIO(answer.content)).shape == (100_000, 4, 4)
