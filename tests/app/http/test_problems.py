"""Bad input gets a 4xx problem document that names the field and what to write instead."""

import copy
import json

import pytest

from tests.cost import within
from tests.processes import processor_seconds

GOOD = {
    "name": "probe",
    "convention": "standard",
    "joints": [
        {
            "name": "j1",
            "type": "revolute",
            "alpha": 0,
            "a": 1,
            "d": 0,
            "theta": 0,
            "limits": {"lower": -1, "upper": 1},
        },
        {"name": "j2", "type": "revolute", "alpha": "pi/2", "a": 1, "d": 0, "theta": 0},
    ],
}


def changed(path, value):
    document = copy.deepcopy(GOOD)
    *parents, last = path
    target = document
    for key in parents:
        target = target[key]
    if value is KeyError:
        del target[last]
    else:
        target[last] = value
    return document


def check(answer, status, pointer, *words):
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["status"] == status
    assert problem["request_id"] == answer.headers["x-request-id"]
    assert len(answer.content) <= 4096
    assert 1 <= len(problem["errors"]) <= 10
    assert problem["errors"][0]["pointer"] == pointer
    for word in words:
        assert word in problem["detail"], problem["detail"]
    for shown in (problem["type"],):
        assert shown.startswith("/problems/")


@pytest.mark.parametrize(
    ("path", "value", "pointer", "words"),
    [
        (["convention"], KeyError, "/convention", ["missing", "modified"]),
        (["convention"], "denavit", "/convention", ["denavit", "khalil"]),
        (["convention"], 3, "/convention", ["khalil"]),
        (["joints", 1, "alpha"], float("nan"), "/joints/1/alpha", ["joint 2", "NaN", "finite"]),
        (["joints", 1, "alpha"], float("inf"), "/joints/1/alpha", ["joint 2", "finite"]),
        (["joints", 1, "alpha"], "pi/0", "/joints/1/alpha", ["divides by zero"]),
        (["joints", 1, "alpha"], [1], "/joints/1/alpha", ["joint 2", "give"]),
        (["joints", 1, "alpha"], True, "/joints/1/alpha", ["joint 2", "give"]),
        (["joints", 1, "alpha"], KeyError, "/joints/1/alpha", ["alpha is missing", "0"]),
        (["joints", 1, "a"], KeyError, "/joints/1/a", ["a is missing"]),
        (["joints", 1, "d"], KeyError, "/joints/1/d", ["d is missing"]),
        (["joints", 1, "type"], KeyError, "/joints/1/type", ["revolute"]),
        (["joints", 1, "type"], "ball", "/joints/1/type", ["ball", "revolute"]),
        (["joints", 1, "r"], 0, "/joints/1/r", ["khalil"]),
        (["joints", 1, "alfa"], 0, "/joints/1/alfa", ["unknown", "alpha"]),
        (["joints", 1, "name"], "j1", "/joints/1/name", ["taken"]),
        (["joints", 1, "sign"], 2, "/joints/1/sign", ["1 or -1"]),
        (["joints", 0, "limits"], {"lower": 1, "upper": -1}, "/joints/0/limits/lower", ["swap"]),
        (["joints", 0, "limits"], {"lower": 1}, "/joints/0/limits/upper", ["both"]),
        (["joints", 0, "limits"], {"lower": [], "upper": {}}, "/joints/0/limits/lower", ["give"]),
        (["joints"], [], "/joints", ["empty"]),
        (["joints"], "none", "/joints", ["list"]),
        (["joints", 1], 7, "/joints/1", ["mapping"]),
        (["tool"], {"matrix": [[1, 0], [0, 1]]}, "/tool", ["four rows"]),
        (
            ["tool"],
            {"matrix": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]},
            "/tool",
            ["rotation"],
        ),
        (["units"], {"angle": "grad"}, "/units/angle", ["deg"]),
        (["colour"], "red", "/colour", ["unknown"]),
        (["name"], "../etc", "/name", ["letters"]),
    ],
)
def test_bad_tables(client, path, value, pointer, words):
    body = json.dumps(changed(path, value))
    for answer in (
        client.post("/v1/dh-to-urdf", content=body, headers={"Content-Type": "application/json"}),
        client.put("/v1/robots/probe", content=body, headers={"Content-Type": "application/json"}),
    ):
        check(answer, 422, pointer, *words)
    assert client.get("/v1/robots/probe").status_code == 404


def test_a_bad_inline_table_is_pointed_at_inside_robot(client):
    body = {"robot": changed(["joints", 0, "alpha"], "x"), "q": [0, 0]}
    check(client.post("/v1/fk", json=body), 422, "/robot/joints/0/alpha", "joint 1", "x")


def test_sixty_five_joints(client):
    joints = [GOOD["joints"][1] | {"name": f"j{k}"} for k in range(65)]
    answer = client.put("/v1/robots/long", json={"convention": "dh", "joints": joints})
    check(answer, 422, "", "65 joints", "at most 64")
    assert (
        client.put("/v1/robots/long", json={"convention": "dh", "joints": joints[:64]}).status_code
        == 201
    )
    assert client.delete("/v1/robots/long").status_code == 204


LINK = '<link name="a"/><link name="b"/>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def joint(inner, kind="revolute", name="j"):
    ends = '<parent link="a"/><child link="b"/>'
    return f'<robot name="r">{LINK}<joint name="{name}" type="{kind}">{ends}{inner}</joint></robot>'


@pytest.mark.parametrize(
    ("urdf", "words"),
    [
        ('<robot name="r"><link name="a"/><link name="b"/></robot>', ["2 root links", "'a', 'b'"]),
        (joint(f'<axis xyz="0 0 0"/>{LIMIT}'), ["joint 'j'", "axis is zero"]),
        (joint('<limit lower="1" upper="-1" effort="1" velocity="1"/>'), ["joint 'j'", "swap"]),
        (joint('<limit lower="nan" upper="1" effort="1" velocity="1"/>'), ["joint 'j'", "lower"]),
        (joint('<limit effort="1" velocity="1"/>'), ["joint 'j'", "lacks lower"]),
        (joint('<limit lower="0" upper="1" velocity="1"/>'), ["joint 'j'", "lacks effort"]),
        (joint(""), ["joint 'j'", "continuous"]),
        (joint(f'<origin xyz="0,5 0 0"/>{LIMIT}'), ["decimal point"]),
        (joint(LIMIT, "floating"), ["joint 'j'", "floating"]),
        ('<!DOCTYPE r [<!ENTITY x "y">]><robot name="r"><link name="a"/></robot>', ["DOCTYPE"]),
        ("<robot", ["XML"]),
        ("", ["XML"]),
        ('<sdf name="r"/>', ["<sdf>"]),
        ('<robot><link name="a"/></robot>', ["name"]),
    ],
)
def test_bad_urdfs(client, urdf, words):
    answer = client.put(
        "/v1/robots/probe", content=urdf, headers={"Content-Type": "application/xml"}
    )
    check(answer, 422, "", *words)


@pytest.mark.parametrize(
    ("path", "body", "pointer", "words"),
    [
        ("fk", {}, "/q", ["q", "missing"]),
        ("fk", {"q": [0]}, "/q", ["1 values", "2 joints", "j1, j2"]),
        ("fk", {"q": []}, "/q", ["2 joints"]),
        ("fk", {"q": [[0, 0], [0]]}, "/q/1", ["2 joints"]),
        ("fk", {"q": [[]]}, "/q/0", ["2 joints"]),
        ("fk", {"q": ["a", 0]}, "/q/0", ["q/0", "number"]),
        ("fk", {"q": [True, 0]}, "/q/0", ["number"]),
        ("fk", {"q": 3}, "/q", ["list"]),
        ("fk", {"q": None}, "/q", ["list"]),
        ("fk", {"q": {"j1": 0, "j2": "x"}}, "/q/j2", ["j2", "'x'", "number"]),
        ("fk", {"q": {"j1": 0}}, "/q", ["lacks", "j2"]),
        ("fk", {"q": {"j1": 0, "j2": 0, "j3": 0}}, "/q/j3", ["j3"]),
        ("fk", {"q": [0, 1e9]}, "/q/1", ["j2", "finite"]),
        ("fk", {"q": [0, 0], "frames": ["nope"]}, "/frames/0", ["nope", "frame_1"]),
        ("fk", {"q": [0, 0], "frame": "tool"}, "/frame", ["unknown field", "known are q, frames"]),
        ("fk", {"q": [0, 0], "frames": []}, "/frames", ["all"]),
        ("fk", {"q": [0, 0], "euler": "ZZX"}, "/euler", ["ZXZ"]),
        ("jacobian", {"q": [0, 0], "frame": "nope"}, "/frame", ["nope"]),
        (
            "jacobian",
            {"q": [0, 0], "reference_frame": "base"},
            "/reference_frame",
            ["base", "local_world_aligned"],
        ),
        ("jacobian", {"q": [0, 0], "euler": "ZXZ"}, "/euler", ["no rates"]),
        ("singularity", {"q": [0, 0], "task": "poze"}, "/task", ["pose"]),
        ("singularity", {"q": [0, 0], "task": [1, 1]}, "/task", ["six"]),
        ("ik", {}, "/target", ["target"]),
        ("ik", {"target": {}}, "/target/position", ["position"]),
        (
            "ik",
            {"target": {"position": [0, 0, 0]}, "task": "pose"},
            "/target",
            ["orientation", "task position"],
        ),
        ("ik", {"target": {"position": [0, 0, 0], "rpy": [0, 0]}}, "/target/rpy", ["give 3"]),
        ("ik", {"target": {"matrix": [[1]]}}, "/target/matrix", ["four rows"]),
        (
            "ik",
            {"target": {"position": [0, 0, 0]}, "task": "position", "seed": [0]},
            "/seed",
            ["2 joints"],
        ),
        (
            "ik",
            {"target": {"position": [0, 0]}, "task": "xy", "max_restarts": -1},
            "/max_restarts",
            ["give"],
        ),
        (
            "ik",
            {"target": {"position": [0, 0]}, "task": "xy", "tolerance": {"position": 0}},
            "/tolerance/position",
            ["give"],
        ),
        ("ik", {"target": {"position": [1, 0, 0], "phi": 0}}, "/target/phi", ["rpy"]),
        (
            "ik",
            {"target": {"position": [0, 0]}, "task": "xy", "max_restarts": int("9" * 400)},
            "/max_restarts",
            [],
        ),
        (
            "ik",
            {"target": {"position": [0, 0]}, "task": "xy", "random_seed": 2**62},
            "/random_seed",
            ["give"],
        ),
        ("ik", {"targets": []}, "/targets", ["give 1 to"]),
        ("ik", {"targets": {"position": [[0, 0, 0]], "rpy": []}}, "/targets", ["unequal"]),
    ],
)
def test_bad_computations(client, path, body, pointer, words):
    check(client.post(f"/v1/robots/planar_2r/{path}", json=body), 422, pointer, *words)


@pytest.mark.parametrize("body", [b"", b"{", b"[", b'{"q": [NaN, 0]}', b"\xff\xfe", b"[" * 100_000])
def test_bodies_that_are_no_json(client, body):
    answer = client.post(
        "/v1/robots/planar_2r/fk", content=body, headers={"Content-Type": "application/json"}
    )
    assert answer.status_code in (400, 422), answer.text
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_joint_called_universe_is_refused(client):
    """Pinocchio calls its root joint so; the joint's numbers came from nowhere."""
    table = {"convention": "standard", "joints": [GOOD["joints"][0] | {"name": "universe"}]}
    check(
        client.post("/v1/fk", json={"robot": table, "q": [1]}), 422, "/robot", "universe", "another"
    )


def test_lengths_take_no_angles_in_a_query(client):
    check(client.get("/v1/robots/scara/fk?q=0,0,90deg,0"), 422, "/q", "length")
    check(client.get("/v1/robots/pa10/ik?position=90deg,0,0&task=position"), 422, "/position")
    answer = client.get("/v1/robots/scara/fk?q=0,0,100mm,0").json()
    expected = client.get("/v1/robots/scara/fk?q=0,0,0.1,0").json()
    assert answer == expected


def test_an_angle_unit_that_would_be_ignored_is_refused(client):
    check(client.put("/v1/robots/probe?angle=deg", json=GOOD), 422, "/angle", "unknown")


def test_costly_documents_are_refused_at_once(client, shared_service):
    keys = "{" + ",".join(f'"k{k}":1' for k in range(100_000)) + ',"k99999":1}'
    columns = ",".join(f"c{k}" for k in range(100_000))
    deep, many = "convention: " + "[" * 3000, "joints:\n" + "- {type: R}\n" * 20_000
    for kind, body in (
        ("application/json", keys),
        ("text/csv", columns),
        ("application/yaml", deep),
        ("application/yaml", many),
        ("application/yaml", "- " * 20_000),
    ):
        before = processor_seconds(shared_service[1])
        answer = client.put("/v1/robots/probe", content=body, headers={"Content-Type": kind})
        assert answer.status_code in (400, 422), answer.text
        assert within(processor_seconds(shared_service[1]) - before, 3)
    for text in ("name: !!bool foo", 'name: "\\UFFFFFFFF"', "sign: 0x" + "f" * 5000, "a: !!int ''"):
        answer = client.put(
            "/v1/robots/probe", content=text, headers={"Content-Type": "application/yaml"}
        )
        assert answer.status_code in (400, 422), answer.text


def test_answers_that_would_fill_the_memory_are_refused(client):
    q = [[0.0] * 32] * 16_000
    check(client.post("/v1/robots/talos/singularity", json={"q": q}), 422, "/q", "parts")


def test_a_limit_on_one_side_only(client):
    urdf = joint('<limit lower="-1e9" upper="-2" effort="1" velocity="1"/>', "prismatic")
    body = {"robot": {"urdf": urdf}, "target": {"position": [0, 0, 9]}, "task": "position"}
    answer = client.post("/v1/ik", json=body)
    assert answer.status_code == 200
    assert answer.json()["q"][0] <= -2


def test_curl_d_is_taught_to_be_curl_json(client):
    form = {"Content-Type": "application/x-www-form-urlencoded"}
    answer = client.post("/v1/robots/planar_2r/fk", content=b'{"q":[0,0]}', headers=form)
    check(answer, 415, "", "--json")
    answer = client.post("/v1/robots", content=b"{}", headers=form)
    check(answer, 415, "", "--json")
    # Also beside parameters that only other types have.
    pdf = {"Content-Type": "application/pdf"}
    answer = client.post("/v1/dh-to-urdf?convention=dh", content=b"a", headers=pdf)
    check(answer, 415, "", "text/plain")


@pytest.mark.scene
def test_unknown_things(client):
    check(client.get("/v1/robots/puma56"), 404, "", "puma560")
    check(client.get("/v1/nothing"), 404, "", "/v1/nothing")
    check(client.patch("/v1/robots/pa10"), 405, "", "PATCH")
    check(client.get("/v1/robots/planar_2r/fk?q=0,0&angel=deg"), 422, "/angel", "angle")
    check(client.get("/v1/robots/planar_2r/fk?q=0,x"), 422, "/q", "x")
    check(client.get("/v1/robots/planar_2r/fk?q=0,0&q=1,1"), 422, "/q", "twice")
    check(client.get("/v1/robots/planar_2r/fk?q=0,0&angle=grad"), 422, "/angle", "deg")
    check(client.get("/v1/robots/planar_2r/fk?q=0,0", headers={"Accept": "image/png"}), 406, "")
    check(client.get("/v1/robots?page_size=0"), 422, "/page_size", "1 to")


def test_bodies_beyond_the_limit(client):
    huge = b'{"name": "' + b"x" * 2_100_000 + b'"}'
    answer = client.put(
        "/v1/robots/probe", content=huge, headers={"Content-Type": "application/json"}
    )
    check(answer, 413, "", "larger")


@pytest.mark.scene
def test_every_problem_type_is_explained(client):
    slug = client.get("/v1/robots/nope").json()["type"]
    assert client.get(slug).json()["status"] == 404
