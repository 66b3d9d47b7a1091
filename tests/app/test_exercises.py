"""Answers of course exercises, as a student gets them with curl: GET, degrees."""

import numpy as np
import pytest

pytestmark = pytest.mark.scene


def value(exercises, prefix):
    return next(entry["value"] for key, entry in exercises.items() if key.startswith(prefix))


def get(client, path, **query):
    answer = client.get(path, params={"angle": "deg", **query})
    assert answer.status_code == 200, answer.text
    return answer.json()


@pytest.fixture(scope="module")
def pa10_of_the_annex(client):
    """PA10-7CE with R1 = R7 = 0."""
    document = client.get("/v1/robots/pa10/dh").json() | {"name": "pa10-annex"}
    for key in ("base", "tool"):
        document.pop(key)
    assert client.put("/v1/robots/pa10-annex", json=document).status_code == 201
    return "/v1/robots/pa10-annex"


def test_one_link_matrix(client, exercises):
    table = {
        "convention": "standard",
        "units": {"angle": "deg"},
        "joints": [{"type": "R", "a": 0.4, "alpha": 90, "d": 0.2, "theta": 0}],
    }
    answer = client.post("/v1/dh-matrices?angle=deg", json={"robot": table, "q": [30]}).json()
    np.testing.assert_allclose(answer["A"][0], value(exercises, "E1_"), atol=1e-9)


def test_planar_2r(client, exercises):
    path, q = "/v1/robots/planar_2r", "30,45"
    position = get(client, f"{path}/fk", q=q)["poses"]["tool"]["position"]
    np.testing.assert_allclose(position[:2], value(exercises, "E2_"), atol=1e-9)
    expected = value(exercises, "E3_")
    J = np.array(get(client, f"{path}/jacobian", q=q)["jacobian"])[:2]
    np.testing.assert_allclose(J, expected["J"], atol=1e-9)
    report = get(client, f"{path}/singularity", q=q, task="xy")
    np.testing.assert_allclose(report["singular_values"], expected["sigma"], atol=1e-9)
    assert report["condition_number"] == pytest.approx(expected["cond"], abs=1e-8)
    assert report["manipulability"] == pytest.approx(expected["w"], abs=1e-9)


def test_stretched_2r_is_singular(client, exercises):
    report = get(client, "/v1/robots/planar_2r/singularity", q="30,0", task="xy")
    expected = value(exercises, "E4_")
    assert report["singular"]
    assert report["rank"] == 1
    np.testing.assert_allclose(report["lost_directions"], [expected["lost_direction"]], atol=1e-9)
    np.testing.assert_allclose(report["null_motions"], [expected["null_joint_motion"]], atol=1e-9)


def test_2r_inverse_reaches_either_solution(client, exercises):
    for solution in value(exercises, "E5_"):
        seed = ",".join(str(angle + 5) for angle in solution)
        answer = get(client, "/v1/robots/planar_2r/ik", position="1.2,0.8", task="xy", seed=seed)
        assert answer["status"] == "converged"
        np.testing.assert_allclose(answer["q"], solution, atol=1e-4)


def test_planar_3r(client, exercises):
    q = "30,-45,60"
    pose = get(client, "/v1/robots/planar_3r/fk", q=q, euler="ZXZ")["poses"]["tool"]
    x, y, phi = value(exercises, "E6_")
    np.testing.assert_allclose(pose["position"][:2], [x, y], atol=1e-9)
    assert np.deg2rad(pose["rpy"][2]) == pytest.approx(phi, abs=1e-9)
    assert pose["euler"]["degenerate"]
    J = get(client, "/v1/robots/planar_3r/jacobian", q=q)["jacobian"]
    np.testing.assert_allclose(J[:2], value(exercises, "E7_")["J"], atol=1e-9)
    n = get(client, "/v1/robots/planar_3r/singularity", q=q, task="xy")["null_motions"][0]
    np.testing.assert_allclose(n, value(exercises, "E8_")["n"], atol=1e-9)


def test_pa10_position_and_both_euler_triples(client, exercises, pa10_of_the_annex):
    q = "10,20,30,40,50,60,70"
    pose = get(client, f"{pa10_of_the_annex}/fk", q=q, euler="ZXZ")["poses"]["tool"]
    np.testing.assert_allclose(pose["position"], value(exercises, "E10_"), atol=1e-12)
    expected = value(exercises, "E11_")
    np.testing.assert_allclose(pose["euler"]["solutions"], expected, atol=1e-9)
    assert not pose["euler"]["degenerate"]


def test_pa10_position_term_by_term(client, pa10_of_the_annex):
    rng = np.random.default_rng(0)
    R3, R5 = 0.45, 0.48
    for q in rng.uniform(-1.5, 1.5, (20, 7)):
        C1, C2, C3, C4 = np.cos(q[:4])
        S1, S2, S3, S4 = np.sin(q[:4])
        expected = (
            R5 * (S4 * C3 * C2 * C1 - S4 * S3 * S1 + C4 * S2 * C1) + R3 * C1 * S2,
            R5 * (S4 * C3 * C2 * S1 + S4 * S3 * C1 + C4 * S2 * S1) + R3 * S2 * S1,
            -R5 * S4 * C3 * S2 + R5 * C4 * C2 + R3 * C2,
        )
        answer = client.post(f"{pa10_of_the_annex}/fk", json={"q": q.tolist()}).json()
        np.testing.assert_allclose(answer["poses"]["tool"]["position"], expected, atol=1e-12)


def test_pa10_ranks(client, exercises, pa10_of_the_annex):
    generic = [10, 20, 30, 40, 50, 60, 70]
    changes = {
        "generic 10..70deg": {},
        "q4=0 (elbow)": {4: 0},
        "q6=0 (wrist) generic": {6: 0},
        "q2=0 generic": {2: 0},
        "q2=0,q3=90": {2: 0, 3: 90},
        "q5=90,q6=0": {5: 90, 6: 0},
    }
    expected = value(exercises, "E12_")
    assert set(changes) == set(expected["table"])
    for label, change in changes.items():
        q = [change.get(k, angle) for k, angle in enumerate(generic, start=1)]
        report = get(client, f"{pa10_of_the_annex}/singularity", q=",".join(map(str, q)))
        assert report["rank"] == expected["table"][label]["rank"], label
        assert report["singular_values"][-1] == pytest.approx(
            expected["table"][label]["sigma_min"], abs=1e-9
        )
        assert report["singular"] == (report["rank"] < 6)


@pytest.fixture(scope="module")
def puma_of_the_course(client):
    """PUMA 560 with d1 = 0."""
    document = client.get("/v1/robots/puma560/dh").json() | {"name": "puma-course"}
    document["joints"][0]["d"] = 0
    for joint in document["joints"]:
        joint.pop("limits")
    assert client.put("/v1/robots/puma-course", json=document).status_code == 201
    return "/v1/robots/puma-course"


def test_puma_pose_and_every_inverse_solution(client, exercises, puma_of_the_course):
    expected = value(exercises, "E13_")
    pose = get(client, f"{puma_of_the_course}/fk", q="0,45,180,0,45,0")["poses"]["tool"]
    np.testing.assert_allclose(pose["matrix"], expected, atol=1e-9)
    for solution in value(exercises, "E14_"):
        q = ",".join(map(str, solution["q_deg"]))
        again = get(client, f"{puma_of_the_course}/fk", q=q)["poses"]["tool"]
        np.testing.assert_allclose(again["matrix"], expected, atol=3e-6)
        answer = client.post(
            f"{puma_of_the_course}/ik?angle=deg",
            json={"target": {"matrix": pose["matrix"]}, "seed": solution["q_deg"]},
        ).json()
        assert answer["status"] == "converged"
        difference = (np.array(answer["q"]) - solution["q_deg"] + 180) % 360 - 180
        np.testing.assert_allclose(difference, 0, atol=1e-3)


def test_puma_determinant_factors(client, exercises, puma_of_the_course):
    q = "20,-30,100,40,50,60"
    expected = value(exercises, "E15_")
    J = np.array(get(client, f"{puma_of_the_course}/jacobian", q=q)["jacobian"])
    wrist = np.sin(np.deg2rad(50))
    assert wrist == pytest.approx(expected["wrist"], abs=1e-9)
    assert abs(np.linalg.det(J)) == pytest.approx(abs(expected["det"]), abs=1e-11)


def test_puma_analytic_jacobian(client, exercises, puma_of_the_course):
    q = "20,-30,100,40,50,60"
    expected = value(exercises, "E16_")
    pose = get(client, f"{puma_of_the_course}/fk", q=q, euler="ZXZ")["poses"]["tool"]
    np.testing.assert_allclose(pose["euler"]["solutions"][0], expected["euler_deg"], atol=1e-6)
    answer = get(client, f"{puma_of_the_course}/jacobian", q=q, euler="ZXZ")
    assert answer["rows"][3:] == ["phi_dot", "theta_dot", "psi_dot"]
    np.testing.assert_allclose(answer["jacobian"][3], expected["row_phi"], atol=1e-6)


def test_ur5_pose_and_every_inverse_solution(client, exercises):
    expected = value(exercises, "E17_")
    document = client.get("/v1/robots/ur5/dh").json() | {"name": "ur5-course"}
    document.pop("base")
    q = [30, -60, 80, -40, 50, 20]
    pose = client.post("/v1/fk?angle=deg", json={"robot": document, "q": q}).json()["poses"]["tool"]
    np.testing.assert_allclose(pose["position"], expected["p"], atol=1e-9)
    for solution in expected["sols"]:
        body = {"robot": document, "target": {"matrix": pose["matrix"]}, "seed": solution["q_deg"]}
        answer = client.post("/v1/ik?angle=deg", json=body).json()
        assert answer["status"] == "converged"
        np.testing.assert_allclose(answer["q"], solution["q_deg"], atol=1e-3)
