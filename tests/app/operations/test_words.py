"""Sentences over HTTP, each beside the numbers that make it true."""

import numpy as np
import pytest

QUARTER = np.pi / 2


def post(client, path, body, **query):
    answer = client.post(path, json=body, params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


def slide(**more):
    return {"type": "P", "a": 0, "alpha": 0, "theta": 0} | more


def table(*joints, **more):
    return {"name": "arm", "convention": "standard", "joints": list(joints), **more}


def test_an_arm_is_singular_where_the_numbers_say_so(client):
    rpp = table({"type": "R", "a": 0, "alpha": 0, "d": 0.2}, slide(alpha=-QUARTER), slide())
    rrp = table(
        {"type": "R", "a": 0, "alpha": -QUARTER, "d": 0.4},
        {"type": "R", "a": 0, "alpha": QUARTER, "d": 0},
        slide(),
    )
    for robot, q, rank in (
        (rpp, [0.3, 0.1, 0], 2),
        (rpp, [0.3, 0.1, 0.2], 3),
        (rrp, [0.3, 0.7, 1e-9], 3),
        (rrp, [0.3, 0.7, 0], 1),
    ):
        report = post(client, "/v1/singularity", {"robot": robot, "q": q, "task": "position"})
        assert report["rank"] == rank
        named = report["factorization"]
        assert named["reason"] is None
        assert any(one["vanishes"] for one in named["factors"]) == report["singular"]
        assert report["singular"] == (rank < 3)


@pytest.mark.parametrize(("q5", "singular"), [(0.0, False), (QUARTER, True), (-QUARTER, True)])
def test_the_wrist_of_z1_is_singular_at_a_right_angle(client, q5, singular):
    q = [0.1, 1.0, -1.0, 0.2, q5, 0.3, 0.0]
    report = post(client, "/v1/robots/z1/singularity", {"q": q})
    wrist = report["factorization"]["factors"][2]
    assert report["singular"] == singular
    assert wrist["vanishes"] == singular
    assert "(joint5 = -90°, 90°)" in wrist["vanishes_where"]
    assert "sin" not in wrist["vanishes_where"]


@pytest.mark.parametrize(
    ("q5", "words"), [(180, "the same way by value"), (0, "against each other")]
)
def test_null_motions_are_told_by_the_signs_of_their_values(client, q5, words):
    q = [10, 20, -100, 30, q5, 40]
    report = post(client, "/v1/robots/puma560/singularity", {"q": q}, angle="deg")
    (motion,) = report["null_motions"]
    assert (motion[3] * motion[5] > 0) == (q5 == 180)
    assert any(f"joints j4 and j6 turn {words}" in text for text in report["explanation"])


def test_a_coarse_tolerance_says_how_little_is_left(client):
    body = {"q": [0.3, 0.01], "task": "xy", "tolerance": 0.1}
    report = post(client, "/v1/robots/planar_2r/singularity", body)
    assert report["singular"]
    assert "can hardly" in report["explanation"][0]
    assert "next to nothing" in report["explanation"][1]


def test_a_solution_on_a_limit_is_within(client):
    robot = table(
        {"type": "R", "a": 0.325, "alpha": 0, "d": 0.387},
        {"type": "R", "a": 0.275, "alpha": np.pi, "d": 0},
        slide(limits={"lower": 0, "upper": 0.01}),
        {"type": "R", "a": 0, "alpha": 0, "d": 0.1},
    )
    q = [0.3, 0.5, 0.01, 0.2]
    pose = post(client, "/v1/fk", {"robot": robot, "q": q})["poses"]["tool"]["matrix"]
    body = {"robot": robot, "target": {"matrix": pose}, "task": "xyz_phi"}
    found = post(client, "/v1/ik/solutions", body)
    assert [one["within_limits"] for one in found["solutions"]] == [True, True]
    assert {one["q"][2] for one in found["solutions"]} == {0.01}
    assert "explanation" not in found
    robot["joints"][2]["limits"]["upper"] = 0.005
    found = post(client, "/v1/ik/solutions", body)
    assert [one["beyond_limits"] for one in found["solutions"]] == [["j3"], ["j3"]]
    assert "j3 at 0.01 m, its limit is 0.005 m" in found["explanation"][0]
    answer = post(client, "/v1/ik", body)
    assert answer["status"] == "unreachable"
    assert answer["explanation"] == found["explanation"]


def test_up_is_above_the_line_from_shoulder_to_wrist(client):
    target = {"position": [0.5, 0.1, 0.3], "rpy": [np.pi, 0, 0.5]}
    found = post(client, "/v1/robots/ur5/ik/solutions", {"target": target})
    assert len({tuple(one["posture"]) for one in found["solutions"]}) == 8
    for one in found["solutions"]:
        poses = post(client, "/v1/robots/ur5/fk", {"q": one["q"], "frames": "all"})["poses"]
        shoulder, elbow, wrist = (np.array(poses[f"frame_{k}"]["position"]) for k in (1, 2, 3))
        line = (wrist - shoulder) / np.linalg.norm(wrist - shoulder)
        across = np.array([0, 0, 1.0]) - line[2] * line
        assert ((elbow - shoulder) @ across > 0) == ("up" in one["posture"])


def test_an_orientation_that_a_scara_cannot_reach(client):
    body = {"target": {"position": [0.4, 0.2, 0.3], "rpy": [0, 0, 30]}}
    answer = post(client, "/v1/robots/scara/ik", body, angle="deg")
    assert answer["status"] == "unreachable"
    tilted, alone, *more = answer["explanation"]
    assert "misses it by 180° at least" in tilted
    assert "the position alone is within reach" in alone
    assert len(more) == 1, more
    best = answer["reachable"][0]
    assert best["position_error"] < 1e-6
    assert best["orientation_error"] == pytest.approx(3.141592653589793)
    found = post(client, "/v1/robots/scara/ik/solutions", body, angle="deg")
    assert found["solutions"] == []
    assert found["explanation"] == answer["explanation"]
    text = client.post(
        "/v1/robots/scara/ik/solutions", json=body, params={"angle": "deg", "format": "text"}
    ).text
    assert "explanation:\n  - this structure cannot bring the frame to this orientation" in text


def test_a_planar_arm_placed_by_position(client):
    joints = [{"type": "R", "a": 1, "alpha": 0, "d": 0}] * 2
    robot = table(*joints)
    body = {"robot": robot, "target": {"position": [0, 0, 0]}, "task": "position"}
    found = post(client, "/v1/ik/solutions", body)
    assert (found["method"], found["complete"]) == ("closed_form", True)
    assert [one["free"] for one in found["solutions"]] == [["j1"]]
    body["target"]["position"] = [-2, 0, 0]
    assert len(post(client, "/v1/ik/solutions", body)["solutions"]) == 1


def kr6(alpha3):
    rows = [
        (-90, 0.025, 0.4),
        (0, 0.455, 0),
        (alpha3, 0.035, 0),
        (-90, 0, 0.42),
        (90, 0, 0),
        (0, 0, 0.08),
    ]
    joints = [{"type": "R", "alpha": x, "a": a, "d": d} for x, a, d in rows]
    return {"name": "kr6", "convention": "standard", "units": {"angle": "deg"}, "joints": joints}


def test_tables_are_compared_as_written_first(client):
    found = post(client, "/v1/diff", {"robot": kr6(90), "other": kr6(-90)}, angle="deg")
    (cell,) = found["as_written"]
    assert (cell["joint"], cell["parameter"]) == (3, "alpha")
    assert cell["first"] == pytest.approx(90)
    assert cell["second"] == pytest.approx(-90)
    assert found["summary"].startswith("As written, one cell differs: joint 3 (j3): alpha is 1.57")
    assert "Up to base, tool and zero offsets:" in found["summary"]
    same = post(client, "/v1/diff", {"robot": kr6(90), "other": kr6(90)})
    assert same["as_written"] == []
    assert same["summary"] == "The same arm."
    other = post(client, "/v1/robots/panda/diff", {"other": "panda_urdf"})
    assert other["as_written"] is None


def test_the_scaras_second_link_is_where_the_table_has_it(client):
    body = {
        "q": [0.3, 0.5, 0.1, 0.2],
        "target": {"position": [0.45, 0.2, 0.2]},
        "task": "position",
        "link_radius": 0.02,
        "obstacles": [{"type": "sphere", "center": [0.4063, 0.1947, 0.387], "radius": 0.02}],
    }
    answer = post(client, "/v1/robots/scara/path", body)
    assert not answer["success"]
    assert answer["clearance"][0] == pytest.approx(-0.04, abs=1e-4)
