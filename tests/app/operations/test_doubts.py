"""What is accepted but probably not meant is told in every answer; what is right is not."""

import json

import httpx
import numpy as np
import pytest

from app.operations import OPERATIONS
from robots.shipped import shipped_ids, shipped_robot

JSON = [one for one in OPERATIONS if one.forms[0] == "application/json"]
WITH_Q = [one for one in JSON if "q" in one.form.fields]
IN_UNITS = "mix"
"""A word of what singularity says of its measures, whatever q is."""
TABLE = {
    "name": "odd",
    "convention": "standard",
    "joints": [
        {"name": f"j{k}", "type": "R", "alpha": 90 if k == 1 else 0, "a": 0.3, "d": 0.1}
        for k in range(1, 4)
    ],
}
FREE = {
    **TABLE,
    "joints": [{**row, "alpha": 0, "d": 0} for row in TABLE["joints"]],
}
TURNS = "alpha of joint 1 (j1) is 90 rad, which is 14 turns; degrees? then give angle=deg"


def post(client, path, body, **query):
    answer = client.post(path, json=body, params=query)
    assert answer.status_code == 200, answer.text
    return answer


def told(client, path, body, **query):
    return post(client, path, body, **query).json()["warnings"]


def get(client, path, **query):
    answer = client.get(path, params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()["warnings"]


def body_for(operation, robot):
    """The example of an operation on another robot: as many joints, all within reach."""
    body = {"q": [0.3] * robot.dof} if "q" in operation.form.fields else {}
    small = {
        "qd": [0.1] * robot.dof,
        "tau": [0.1] * robot.dof,
        "twist": [0.01] * 6,
        "wrench": [1.0] * 6,
        "delta_x": [0.001, 0.001],
        "task": "xy",
        "target": {"position": [0.5, 0.3, 0.1]},
        "joints": [joint.name for joint in robot.joints[:2]],
        "samples": 3,
        "methods": ["damped"],
        "damping": 0.1,
    }
    body |= {name: small[name] for name in operation.example if name in small}
    if "target" in body:
        body["task"] = "position"
    if "twist" in body:
        body["task"] = "pose"
    if operation.name == "step":
        body["damping"] = 0.1
    if operation.name == "check":
        body |= {"quantity": "T", "answer": np.eye(4).tolist()}
    return body


@pytest.mark.parametrize("operation", JSON, ids=lambda one: one.name)
def test_an_example_has_no_warning(client, operation):
    path = f"/v1/robots/{operation.example_robot}/{operation.name}"
    warnings = told(client, path, operation.example)
    assert [one for one in warnings if IN_UNITS not in one] == []


@pytest.mark.parametrize("robot_id", shipped_ids())
def test_a_robot_of_the_library_in_the_middle_of_its_limits_has_no_warning(client, robot_id):
    robot = shipped_robot(robot_id)
    free = ~np.isfinite(robot.upper - robot.lower)
    q = np.where(free, 0.5, (np.maximum(robot.lower, -9) + np.minimum(robot.upper, 9)) / 2)
    corners = [q, np.where(free, 3.0, robot.lower), np.where(free, -3.0, robot.upper)]
    record = client.get(f"/v1/robots/{robot_id}").json()
    assert record["warnings"] == []
    for one in corners:
        assert told(client, f"/v1/robots/{robot_id}/fk", {"q": one.tolist()}) == []
        degrees = np.where(robot.is_revolute, np.rad2deg(one), one)
        text = ",".join(f"{x!r}" for x in degrees.tolist())
        assert get(client, f"/v1/robots/{robot_id}/fk", q=text, angle="deg") == []
    batch = {"q": [one.tolist() for one in corners]}
    assert told(client, f"/v1/robots/{robot_id}/fk", batch) == []


@pytest.mark.parametrize("operation", JSON, ids=lambda one: one.name)
def test_a_doubtful_robot_is_told_by_every_operation(client, operation):
    assert client.put("/v1/robots/odd", json=TABLE).status_code in (200, 201)
    body = body_for(operation, shipped_robot("planar_3r"))
    if operation.name == "symbolic":
        body = {"quantities": ["T"]}
    for path, sent in (
        (f"/v1/robots/odd/{operation.name}", body),
        (f"/v1/{operation.name}", {**body, "robot": TABLE}),
        (f"/v1/{operation.name}", {**body, "robot": "odd"}),
    ):
        assert told(client, path, sent)[0].startswith(TURNS)
    client.delete("/v1/robots/odd")


@pytest.mark.parametrize("operation", WITH_Q, ids=lambda one: one.name)
def test_degrees_in_q_are_told_by_every_operation(client, operation):
    path, body = f"/v1/{operation.name}", body_for(operation, shipped_robot("planar_3r"))
    asked = {**body, "robot": FREE, "q": [30, -45, 60]}
    assert told(client, path, asked)[0] == (
        "q of joint j1 is 30 rad, which is 5 turns (and 2 more like it); degrees? then angle=deg"
    )
    assert not any("degrees?" in one for one in told(client, path, asked, angle="deg"))


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ({"q": "0,45,-90,0,30,0"}, "q of joint shoulder_lift_joint is 45 rad"),
        ({"q": "0,1.5708,0,0,0,0", "angle": "deg"}, "the digits of 90° in rad; radians?"),
        ({"q": "0,-1.57,0,0,0,3.14", "angle": "deg"}, "(and 1 more like it); radians?"),
        ({"q": "0,6.5,0,0,0,0"}, "q of joint shoulder_lift_joint is 6.5 rad"),
        ({"q": "0,400,0,0,0,0", "angle": "deg"}, "400 deg, outside its limits -360 to 360"),
    ],
)
def test_a_doubtful_q_is_told(client, query, expected):
    (warning,) = get(client, "/v1/robots/ur5/fk", **query)
    assert expected in warning


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ({"rpy": "180,0,30"}, "rpy of target has 180 rad, which is 29 turns (and 1 more like it)"),
        ({"euler": "ZXZ:90,0,45"}, "euler of target has 90 rad"),
        ({"rpy": "3.14159,0,0", "angle": "deg"}, "rpy of target is 3.14159 degrees"),
        ({"rpy": "0,0,0", "position": "400,200,300"}, "the target is 538.5 m away"),
        ({"rpy": "0,0,0", "seed": "0,90,0,0,0,0"}, "seed of joint shoulder_lift_joint is 90 rad"),
    ],
)
@pytest.mark.parametrize("operation", ["ik", "ik/solutions"])
def test_a_doubtful_target_or_seed_is_told(client, operation, query, expected):
    asked = {"position": "0.4,0.2,0.3", **query}
    warnings = get(client, f"/v1/robots/ur5/{operation}", **asked)
    assert any(expected in one for one in warnings), warnings


def test_doubtful_targets_of_a_list_are_told_once(client):
    targets = [{"position": [0.4, 0.2, 0.3], "rpy": [180, 0, 10 * k]} for k in range(5)]
    (warning,) = told(client, "/v1/robots/ur5/ik", {"targets": targets})
    assert "like it); degrees? then angle=deg" in warning
    assert told(client, "/v1/robots/ur5/ik", {"targets": targets}, angle="deg") == []


def test_a_doubtful_path_is_told(client):
    body = {"q": [0, -1, 1, -1, -1, 0], "samples": 3, "method": "damped"}
    target = {"position": [300, 200, 400], "rpy": [180, 0, 0]}
    ball = {"type": "sphere", "center": [500, 0, 0], "radius": 50}
    path = "/v1/robots/ur5/path"
    first, second = told(client, path, {**body, "target": target, "obstacles": [ball]})
    assert "rpy of target has 180 rad" in first
    assert "the target is 538.5 m away, and the robot spans" in second
    assert "(and 1 more like it)" in second


def test_values_outside_limits_are_told_with_joint_and_limits(client):
    warnings = told(client, "/v1/robots/panda/fk", {"q": [0, 0, 0, 0.5, 0, 0, 0]})
    assert warnings == [
        "q of joint panda_joint4 is 0.5 rad, outside its limits -3.0718 to -0.0698; the robot"
        " cannot be there"
    ]
    rows = [[0, 0, 0, -1, 0, 1, 0]] * 3 + [[0, 0, 0, 1, 0, 1, 0]]
    (warning,) = told(client, "/v1/robots/panda/fk", {"q": rows})
    assert "in row 3" in warning


def test_a_joint_without_limits_may_turn_often(client):
    for q in ([7.345, -12.4321, 0], [4 * np.pi, 0, 0], [0, 0, -2 * np.pi], [6.2832, 3.14159, 0]):
        assert told(client, "/v1/fk", {"robot": FREE, "q": q}) == []
    for q in ([6.5, 0, 0], [0, 45, 0], [0, 0, -37.1234]):
        assert "degrees? then angle=deg" in told(client, "/v1/fk", {"robot": FREE, "q": q})[0]


def test_a_slide_in_millimetres_is_told(client):
    (warning,) = told(client, "/v1/robots/scara/fk", {"q": [0.1, 0.2, 100, 0]})
    assert warning.startswith("q of joint j3 is 100 m; millimetres? then length=mm")


def test_other_forms_tell_it_too(client):
    asked = {"robot": TABLE, "q": [0, 0, 0]}
    text = post(client, "/v1/fk", asked, format="text").text
    assert "warnings:\n  - alpha of joint 1 (j1) is 90 rad" in text
    for form in ("npy", "svg"):
        operation = "picture.svg" if form == "svg" else "fk"
        header = post(client, f"/v1/{operation}", asked, format=form).headers["x-warnings"]
        assert header.startswith("alpha of joint 1 (j1) is 90 rad")
        assert header.isascii()
    body = {**asked, "task": "xy", "target": {"position": [0.5, 0.2]}, "methods": ["damped"]}
    rows = post(client, "/v1/path/compare", {**body, "samples": 3}, format="csv").text.splitlines()
    assert rows[0].endswith(",warnings")
    assert "alpha of joint 1 (j1) is 90 rad" in rows[1]
    plain = {**body, "samples": 3, "robot": "planar_3r", "q": [0.3, 0.4, 0.5]}
    assert "warnings" not in post(client, "/v1/path/compare", plain, format="csv").text


def test_an_upload_echoes_its_table_and_names_ids_that_look_alike(client):
    table = {**TABLE, "units": {"angle": "deg", "length": "mm"}, "name": "UR5"}
    answer = client.put("/v1/robots/UR5", json=table)
    assert answer.status_code == 201, answer.text
    view = answer.json()
    assert view["table"]["units"] == {"angle": "rad", "length": "m"}
    assert view["table"]["joints"][0]["alpha"] == np.pi / 2
    assert view["table"]["joints"][0]["a"] == 0.0003
    assert any("'UR5' looks like that of another robot: 'ur5'" in one for one in view["warnings"])
    csv = "name,type,alpha,a,d,theta\nj1,R,90,0.3,0,0\n"
    query = {"convention": "standard", "angle": "deg", "name": "UR5", "overwrite": "true"}
    headers = {"content-type": "text/csv"}
    answer = client.put("/v1/robots/UR5", content=csv, params=query, headers=headers)
    assert answer.status_code == 200, answer.text
    assert answer.json()["table"]["units"]["angle"] == "deg"
    assert answer.json()["table"]["joints"][0]["alpha"] == 90
    client.delete("/v1/robots/UR5")


def test_the_doubts_of_a_stored_robot_outlive_the_service(tmp_path):
    from app.documents import robot_from_inline
    from robots.store import RobotStore

    table = {**TABLE, "units": {"angle": "deg"}}
    table["joints"] = [{**row, "alpha": 1.5708} for row in TABLE["joints"]]
    robot = robot_from_inline(table)
    RobotStore(tmp_path).put("odd", robot)
    again = RobotStore(tmp_path).get("odd").robot
    assert again.doubts == robot.doubts != ()
    assert again.warnings == robot.warnings


def test_digits_are_chosen_in_text_and_csv_and_refused_elsewhere(client):
    path, q = "/v1/robots/ur5/fk", "0,0.1,0.2,0.3,0.4,0.5"
    text = client.get(path, params={"q": q, "format": "text", "digits": "3"}).text
    assert max(len(word.partition(".")[2]) for word in text.split() if "." in word) <= 4
    odd = ({"digits": "3"}, {"digits": "x", "format": "text"}, {"digits": "16", "format": "text"})
    for query in odd:
        answer = client.get(path, params={"q": q, **query})
        assert answer.status_code == 422
        assert "digits" in answer.text


def test_no_answer_writes_minus_zero_or_noise(client):
    q = "0,-90,90,0,90,0"
    for robot in ("ur5", "puma560"):
        for form in ("json", "text"):
            query = {"q": q, "angle": "deg", "format": form, "frames": "all"}
            text = client.get(f"/v1/robots/{robot}/fk", params=query).text
            numbers = text.replace("[", " ").replace("]", " ").replace(",", " ").split()
            zeros = [one for one in numbers if one.startswith("-0") and float_or_one(one) == 0]
            assert zeros == []
        assert "e-" not in text


def float_or_one(word):
    try:
        return float(word)
    except ValueError:
        return 1.0


def test_a_row_of_npy_has_its_status(client):
    rng = np.random.default_rng(0)
    places = rng.uniform(-0.5, 0.5, (40, 3))
    places[::3] += 5
    targets = [{"position": place.tolist()} for place in places]
    body = {"targets": targets, "task": "position"}
    answer = client.post("/v1/robots/ur5/ik", json=body, params={"format": "npy", "with": "status"})
    rows = loaded(answer)
    listed = [int(k) for k in answer.headers["x-not-converged"].split(",")]
    assert np.flatnonzero(rows["status"] != b"converged").tolist() == listed
    told_in_json = post(client, "/v1/robots/ur5/ik", body).json()
    assert [one.decode() for one in rows["status"]] == told_in_json["status"]
    np.testing.assert_array_equal(rows["q"], np.array(told_in_json["q"]))
    plain = loaded(client.post("/v1/robots/ur5/ik", json=body, params={"format": "npy"}))
    np.testing.assert_array_equal(plain, rows["q"])


def test_a_header_that_is_shortened_says_so(client):
    far = np.tile(np.eye(4), (520, 1, 1))
    far[:, 0, 3] = 5.0 + np.arange(520)
    body = {"targets": [{"matrix": one.tolist()} for one in far], "max_restarts": 0}
    query = {"format": "npy", "with": "status"}
    answer = client.post("/v1/robots/ur5/ik", json=body, params=query, timeout=120)
    assert answer.headers["x-not-converged"].endswith("499,... 20 more: with=status marks each row")
    assert (loaded(answer)["status"] != b"converged").all()


def test_statuses_are_asked_for_in_npy_only(client):
    for query in ({"with": "status"}, {"with": "all", "format": "npy"}):
        answer = client.post(
            "/v1/robots/ur5/ik", json={"target": {"position": [0.3, 0.2, 0.1]}}, params=query
        )
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["pointer"] == "/with"


def loaded(answer: httpx.Response):
    import io

    assert answer.status_code == 200, answer.text
    return np.load(io.BytesIO(answer.content), allow_pickle=False)


def test_rpy_at_lock_follows_the_rule_of_euler_angles(client):
    q = {"q": [0.3, -np.pi / 2, 0, 0], "euler": "xyz"}
    table = {
        "convention": "modified",
        "joints": [
            {"type": "R", "alpha": 0, "a": 0, "d": 0},
            {"type": "R", "alpha": "-pi/2", "a": 0, "d": 0},
            {"type": "R", "alpha": "pi/2", "a": 0.3, "d": 0},
            {"type": "R", "alpha": "pi/2", "a": 0.3, "d": 0},
        ],
        "tool": {"rpy": ["-pi/2", 0, 0]},
    }
    seen = 0
    for turn in (-1, 1):
        body = {"robot": table, **q, "q": [0.3, turn * np.pi / 2, 0, 0]}
        for sent in (body, {k: v for k, v in body.items() if k != "euler"}):
            pose = post(client, "/v1/fk", sent).json()["poses"]["tool"]
            assert abs(abs(pose["rpy"][1]) - np.pi / 2) < 1e-7
            assert pose["rpy"][2] == 0
            assert pose["rpy_degenerate"] is True
            if "euler" in pose:
                assert pose["euler"]["degenerate"]
                np.testing.assert_allclose(pose["rpy"], pose["euler"]["solutions"][0], atol=1e-12)
            seen += 1
    assert seen == 4
    free = post(client, "/v1/robots/ur5/fk", {"q": [0.1] * 6}).json()["poses"]
    assert "rpy_degenerate" not in json.dumps(free)


@pytest.mark.parametrize("form", ["markdown", "latex", "tsv", "csv", "yaml", "text"])
def test_tables_are_in_degrees_where_asked(client, form):
    query = {"angle": "deg", "format": form, "convention": "standard"}
    text = client.get("/v1/robots/puma560/dh", params=query).text
    assert "90" in text
    assert "pi/2" not in text.replace("\\pi", "pi")
    assert "1.57" not in text
