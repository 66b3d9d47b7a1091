"""Differential kinematics and statics over HTTP."""

import io

import numpy as np
import pytest

Q = [0.1, -0.4, 0.8, 0.3, 0.6, -0.2]
PUMA, SCARA = "/v1/robots/puma560", "/v1/robots/scara"


def post(client, path, body, **query):
    answer = client.post(path, json=body, params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


@pytest.mark.parametrize("reference_frame", ["world", "local", "local_world_aligned"])
@pytest.mark.parametrize("frame", ["tool", "frame_4"])
def test_there_and_back(client, reference_frame, frame):
    qd = [0.3, -0.1, 0.2, 0.5, -0.4, 0.1]
    where = {"q": Q, "frame": frame, "reference_frame": reference_frame}
    J = np.array(post(client, f"{PUMA}/jacobian", where)["jacobian"])
    twist = post(client, f"{PUMA}/twist", {**where, "qd": qd})
    np.testing.assert_allclose(twist["twist"], J @ qd, atol=1e-14)
    assert twist["rows"] == ["vx", "vy", "vz", "wx", "wy", "wz"]
    assert twist["reference_frame"] == reference_frame
    wrench = [1.0, 2.0, -3.0, 0.1, 0.2, 0.3]
    tau = post(client, f"{PUMA}/joint-torques", {**where, "wrench": wrench})["tau"]
    assert np.dot(tau, qd) == pytest.approx(np.dot(wrench, twist["twist"]), abs=1e-12)
    back = post(client, f"{PUMA}/joint-velocities", {**where, "twist": twist["twist"]})
    held = post(client, f"{PUMA}/wrench", {**where, "tau": tau})
    if frame == "tool":
        assert back["status"] == "exact"
        np.testing.assert_allclose(back["qd"], qd, atol=1e-10)
        assert held["determined"]
        np.testing.assert_allclose(held["wrench"], wrench, atol=1e-10)
    else:
        assert back["status"] == "rank_deficient"
        (told,) = [one for one in back["warnings"] if "rank is 4 of 6" in one]
        assert "damping" in told
        assert not held["determined"]
        assert len(held["lost_directions"]) == 2
    np.testing.assert_allclose(back["residual"], 0, atol=1e-10)


def test_degrees_of_rates(client):
    q, qd = [10, 20, 0.1, 30], [5, -10, 0.02, 15]
    rad = np.array([np.pi / 180, np.pi / 180, 1, np.pi / 180])
    in_degrees = post(client, f"{SCARA}/twist", {"q": q, "qd": qd}, angle="deg")
    plain = post(client, f"{SCARA}/twist", {"q": list(q * rad), "qd": list(qd * rad)})
    assert in_degrees["units"] == {"angle": "deg", "length": "m", "time": "s"}
    np.testing.assert_allclose(in_degrees["twist"][:3], plain["twist"][:3], atol=1e-15)
    np.testing.assert_allclose(np.deg2rad(in_degrees["twist"][3:]), plain["twist"][3:], atol=1e-15)
    body = {"q": q, "twist": [*in_degrees["twist"][:3], in_degrees["twist"][5]], "task": "xyz_phi"}
    back = post(client, f"{SCARA}/joint-velocities", body, angle="deg")
    np.testing.assert_allclose(back["qd"], qd, atol=1e-10)
    torques = [
        post(
            client,
            f"{SCARA}/joint-torques",
            {"q": list(x), "wrench": [1, 2, 3, 4, 5, 6]},
            angle=angle,
        )["tau"]
        for x, angle in ((q, "deg"), (q * rad, "rad"))
    ]
    np.testing.assert_allclose(*torques, atol=1e-12)
    held = post(
        client, f"{SCARA}/wrench", {"q": q, "tau": torques[0], "task": "xyz_phi"}, angle="deg"
    )
    np.testing.assert_allclose(held["wrench"], [1, 2, 3, 6], atol=1e-10)


def test_null_motions_are_directions_in_the_units_of_the_answer(client):
    """A slide and three turns over xy: what is added in deg/s and m/s adds no twist."""
    q, body = [10, 20, 0.1, 30], {"twist": [0.1, 0.2], "task": "xy"}
    answer = post(client, f"{SCARA}/joint-velocities", {"q": q, **body}, angle="deg")
    assert len(answer["null_motions"]) == 2
    for motion in answer["null_motions"]:
        assert np.linalg.norm(motion) == pytest.approx(1)
        qd = (np.array(answer["qd"]) + motion).tolist()
        twist = post(client, f"{SCARA}/twist", {"q": q, "qd": qd}, angle="deg")["twist"]
        np.testing.assert_allclose(twist[:2], [0.1, 0.2], atol=1e-12)


def test_the_query_form_reads_units(client):
    path = f"{PUMA}/joint-velocities"
    q = ",".join(map(str, Q))
    got = client.get(path, params={"q": q, "twist": "100mm,0,0,0,0,90deg", "damping": "0.01"})
    posted = post(client, path, {"q": Q, "twist": [0.1, 0, 0, 0, 0, np.pi / 2], "damping": 0.01})
    assert got.json() == posted
    assert posted["status"] == "damped"
    got = client.get(f"{PUMA}/twist", params={"q": q, "qd": "0,0,10deg,0,0,0"}).json()
    expected = post(client, f"{PUMA}/twist", {"q": Q, "qd": [0, 0, np.pi / 18, 0, 0, 0]})
    assert got == expected
    text = client.get(
        f"{PUMA}/joint-torques", params={"q": q, "wrench": "0,0,10,0,0,0", "format": "text"}
    ).text
    assert "tau: [" in text
    assert "force N" in text


@pytest.mark.scene
def test_near_and_at_a_singularity(client):
    path = "/v1/robots/planar_2r/joint-velocities"
    at = post(client, path, {"q": [30, 0], "twist": [0.1, 0], "task": "xy"}, angle="deg")
    assert at["status"] == "rank_deficient"
    assert at["rank"] == 1
    np.testing.assert_allclose(at["residual"], [-0.075, -0.1 * np.sqrt(3) / 4], atol=1e-12)
    damped = {"q": [30, 0], "twist": [0.1, 0], "task": "xy", "damping": 0.1}
    assert post(client, path, damped, angle="deg")["status"] == "damped"


def test_batches_of_states(client):
    rng = np.random.default_rng(0)
    q, qd = rng.uniform(-1, 1, (2, 4, 6)).tolist()
    single_of = {
        "twist": {"qd": qd},
        "jacobian-derivative": {"qd": qd},
        "joint-velocities": {"twist": qd},
        "joint-torques": {"wrench": qd},
        "wrench": {"tau": qd},
        "hessian": {},
        "manipulability-gradient": {},
    }
    shared = ("rows", "columns", "units", "warnings")
    for operation, extra in single_of.items():
        many = post(client, f"{PUMA}/{operation}", {"q": q, **extra})
        one_q = post(client, f"{PUMA}/{operation}", {"q": q[0], **extra})
        for k in range(4):
            parts = {name: rows[k] for name, rows in extra.items()}
            one = post(client, f"{PUMA}/{operation}", {"q": q[k], **parts})
            fixed = post(client, f"{PUMA}/{operation}", {"q": q[0], **parts})
            for leaf, value in one.items():
                if isinstance(value, list) and leaf not in shared:
                    np.testing.assert_allclose(many[leaf][k], value, atol=1e-9, err_msg=leaf)
                    if extra:
                        np.testing.assert_allclose(one_q[leaf][k], fixed[leaf], atol=1e-9)
        if "rank" in many:
            assert many["rank"] == one_q["rank"] == [6] * 4


def test_acceleration_of_a_turning_link(client):
    """One joint turns: the tip's bias acceleration is centripetal, r qd² towards the axis."""
    body = {"q": [np.pi / 2, 0], "qd": [2, 0]}
    answer = post(client, "/v1/robots/planar_2r/jacobian-derivative", body)
    np.testing.assert_allclose(answer["bias_acceleration"], [0, -1.8 * 4, 0, 0, 0, 0], atol=1e-12)
    in_degrees = {"q": [90, 0], "qd": [np.rad2deg(2), 0]}
    again = post(client, "/v1/robots/planar_2r/jacobian-derivative", in_degrees, angle="deg")
    assert again["units"]["angle"] == "rad"
    np.testing.assert_allclose(again["bias_acceleration"], answer["bias_acceleration"], atol=1e-12)


@pytest.mark.parametrize(
    ("operation", "extra", "pointer"),
    [
        ("twist", {}, "/qd"),
        ("twist", {"qd": [1]}, "/qd"),
        ("twist", {"qd": [[0] * 6] * 2}, "/qd"),
        ("twist", {"qd": {"j1": 1}}, "/qd"),
        ("twist", {"qd": ["a"] * 6}, "/qd/0"),
        ("joint-velocities", {"twist": [1, 2]}, "/twist"),
        ("joint-velocities", {"twist": [1e9] * 6}, "/twist/0"),
        ("joint-velocities", {"twist": {"vx": 1}}, "/twist"),
        ("joint-velocities", {"twist": [[0] * 6, [0] * 5]}, "/twist/1"),
        ("joint-velocities", {"twist": []}, "/twist"),
        ("joint-velocities", {"twist": [[]]}, "/twist"),
        ("joint-velocities", {"twist": None}, "/twist"),
        ("joint-velocities", {"twist": [0] * 6, "damping": -1}, "/damping"),
        ("joint-velocities", {"twist": [0] * 6, "tolerance": 1}, "/tolerance"),
        ("joint-velocities", {"twist": [0] * 6, "task": "xx"}, "/task"),
        ("joint-torques", {"wrench": [1]}, "/wrench"),
        ("joint-torques", {"wrench": [0] * 6, "reference_frame": "tip"}, "/reference_frame"),
        ("wrench", {"tau": [1]}, "/tau"),
        ("wrench", {"tau": [0] * 6, "frame": "x"}, "/frame"),
        ("hessian", {"frame": "x"}, "/frame"),
        ("manipulability-gradient", {"task": [1]}, "/task"),
        ("jacobian-derivative", {"qd": [[0] * 6] * 2}, "/qd"),
    ],
)
def test_refusals_point_at_the_field(client, operation, extra, pointer):
    answer = client.post(f"{PUMA}/{operation}", json={"q": [Q] * 3, **extra})
    assert answer.status_code == 422, answer.text
    problem = answer.json()
    assert problem["errors"][0]["pointer"] == pointer
    assert problem["errors"][0]["message"]


def test_batches_as_npy_with_the_rest_in_the_query(client):
    q = np.random.default_rng(2).uniform(-1, 1, (3, 6))
    stream = io.BytesIO()
    np.save(stream, q)
    headers = {"Content-Type": "application/x-npy"}

    def send(operation, **query):
        answer = client.post(
            f"{PUMA}/{operation}", content=stream.getvalue(), params=query, headers=headers
        )
        assert answer.status_code == 200, answer.text
        return answer.json()

    extra = {"twist": "0.1,0,0,0,0,90deg", "damping": "0.01", "tolerance": "1e-9"}
    found = send("joint-velocities", **extra)
    body = {"q": q.tolist(), "twist": [0.1, 0, 0, 0, 0, np.pi / 2]}
    body |= {"damping": 0.01, "tolerance": 1e-9}
    expected = post(client, f"{PUMA}/joint-velocities", body)
    np.testing.assert_allclose(found["qd"], expected["qd"], atol=1e-14)
    assert send("singularity", tolerance="1e-3")["tolerance"] == 1e-3
    assert np.shape(send("hessian")["hessian"]) == (3, 6, 6, 6)
