"""Tables out over HTTP: of robots, URDFs and axes, between conventions, and compared."""

import numpy as np
import pytest

from dh_to_urdf import read_csv, read_yaml

URDF = """<robot name="two"><link name="root"/><link name="arm"/><link name="hand"/>
<joint name="z" type="revolute"><parent link="root"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="a" type="continuous"><parent link="arm"/><child link="hand"/>
<origin xyz="1 0 0.5"/><axis xyz="0 1 0"/></joint></robot>"""
AXES = {
    "joints": [
        {"type": "R", "point": [0, 0, 0], "direction": [0, 0, 1]},
        {"type": "R", "point": [0.4, 0, 0], "direction": [0, 0, 1]},
    ],
    "tip": {"xyz": [1, 0, 0]},
}
XML = {"Content-Type": "application/xml"}


def fk(client, table, q):
    return np.array(
        client.post("/v1/fk", json={"robot": table, "q": q}).json()["poses"]["tool"]["matrix"]
    )


def test_a_urdf_robot_has_a_table_in_every_convention_that_can_be_sent_back(client):
    q = [0.1, -0.4, 0.3, -1.2, 0.5, 1.1, 0.2]
    pose = client.post("/v1/robots/panda_urdf/fk", json={"q": [*q, 0]}).json()
    expected = np.array(pose["poses"]["panda_hand_tcp"]["matrix"])
    for convention in ("standard", "modified", "khalil"):
        answer = client.get(f"/v1/robots/panda_urdf/dh?convention={convention}&explain=true")
        assert answer.status_code == 200, answer.text
        table = answer.json()
        assert table["residual"]["position"] <= 1e-12
        assert len(table["explanation"]) == 8
        np.testing.assert_allclose(fk(client, table, q), expected, atol=1e-12)
    missing = client.get("/v1/robots/panda_urdf/dh")
    assert missing.status_code == 422
    assert missing.json()["errors"][0]["pointer"] == "/convention"


def test_a_table_robot_gives_its_own_table_and_others(client):
    own = client.get("/v1/robots/ur5/dh").json()
    assert own["convention"] == "standard"
    assert "residual" not in own
    assert client.get("/v1/robots/ur5/dh?convention=dh").json() == own
    modified = client.get("/v1/robots/ur5/dh?convention=craig").json()
    q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    np.testing.assert_allclose(fk(client, modified, q), fk(client, own, q), atol=1e-12)
    back = client.post("/v1/convert-dh?to=standard", json=modified).json()
    np.testing.assert_allclose(fk(client, back, q), fk(client, own, q), atol=1e-12)
    part = client.get("/v1/robots/ur5/dh?convention=craig&base=frame_1&tip=frame_4").json()
    assert len(part["joints"]) == 3


@pytest.mark.scene
def test_every_form_of_the_answer(client):
    url = "/v1/robots/ur5/dh?convention=khalil"
    table = client.get(url).json()
    yaml = client.get(url, headers={"Accept": "application/yaml"})
    assert yaml.headers["content-type"].startswith("application/yaml")
    assert len(read_yaml(yaml.text).rows) == 6
    csv = client.get(f"{url}&format=csv&angle=deg")
    assert csv.headers["content-type"].startswith("text/csv")
    rows = read_csv(csv.text, "khalil", angle="deg").rows
    moving = [row for row in rows if row.type != "fixed"]
    assert [row.name for row in moving] == [row["name"] for row in table["joints"]]
    text = client.get(f"{url}&format=text&explain=1")
    assert text.text.count("\n") > 15
    assert "intersect" in text.text
    assert r"\begin{tabular}" in client.get(f"{url}&format=latex").text
    degrees = client.get(f"{url}&angle=deg").json()
    assert degrees["units"]["angle"] == "deg"
    assert abs(degrees["joints"][1]["alpha"]) == 90.0
    assert client.get(f"{url}&format=npy").status_code == 422


@pytest.mark.scene
def test_urdf_to_dh(client):
    answer = client.post("/v1/urdf-to-dh?convention=mdh&explain=1", content=URDF, headers=XML)
    assert answer.status_code == 200, answer.text
    table = answer.json()
    assert [row["name"] for row in table["joints"]] == ["z", "a"]
    assert table["joints"][1]["type"] == "continuous"
    assert table["explanation"][1]["case"] == "skew"
    part = client.post("/v1/urdf-to-dh?convention=mdh&tip=arm", content=URDF, headers=XML).json()
    assert len(part["joints"]) == 1


@pytest.mark.parametrize(
    ("query", "content", "status", "pointer"),
    [
        ("", URDF, 422, "/convention"),
        ("?convention=x", URDF, 422, "/convention"),
        ("?convention=dh&tip=x", URDF, 422, "/tip"),
        ("?convention=dh&base=hand&tip=hand", URDF, 422, "/tip"),
        ("?convention=dh&snap=5", URDF, 422, "/snap"),
        ("?convention=dh&snap=nan", URDF, 422, "/snap"),
        ("?convention=dh&explain=maybe", URDF, 422, "/explain"),
        ("?convention=dh&foo=1", URDF, 422, "/foo"),
        ("?convention=dh", "<robot", 422, ""),
        ("?convention=dh", URDF.replace("0 1 0", "0 0 0"), 422, ""),
    ],
)
def test_urdf_to_dh_refuses_with_the_field(client, query, content, status, pointer):
    answer = client.post(f"/v1/urdf-to-dh{query}", content=content, headers=XML)
    assert answer.status_code == status, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer
    assert client.post("/v1/urdf-to-dh?convention=dh", json={}).status_code == 415


def test_axes_to_dh(client):
    answer = client.post("/v1/axes-to-dh?convention=dh", json=AXES)
    assert answer.status_code == 200, answer.text
    assert [row["a"] for row in answer.json()["joints"]] == [0.4, 0.6]
    inside = client.post("/v1/axes-to-dh", json=AXES | {"convention": "dh"})
    assert inside.json() == answer.json()
    assert client.post("/v1/axes-to-dh", json=AXES).json()["errors"][0]["pointer"] == "/convention"
    both = client.post("/v1/axes-to-dh?convention=dh", json=AXES | {"convention": "dh"})
    assert both.status_code == 422
    bad = AXES | {"joints": [AXES["joints"][0] | {"direction": [0, 0, 0]}]}
    refused = client.post("/v1/axes-to-dh?convention=dh", json=bad)
    assert refused.json()["errors"][0]["pointer"] == "/joints/0/direction"
    for body in ("[1]", "3", '"x"', '{"joints": 3}'):
        answer = client.post(
            "/v1/axes-to-dh?convention=dh",
            content=body,
            headers={"Content-Type": "application/json"},
        )
        assert answer.status_code == 422


def test_convert_reads_every_table_and_refuses_trees_without_tip(client):
    csv = "type,alpha,a,d\nR,90,0,1\nR,0,2,0\n"
    answer = client.post(
        "/v1/convert-dh?to=mdh&convention=dh&angle=deg",
        content=csv,
        headers={"Content-Type": "text/csv"},
    )
    assert [row["alpha"] for row in answer.json()["joints"]] == [0.0, 90.0]
    tree = {
        "convention": "khalil",
        "joints": [
            {"name": name, "type": "R", "alpha": 0, "d": 1, "r": 0, "ant": ant}
            for name, ant in (("a", 0), ("b", 1), ("c", 1))
        ],
    }
    refused = client.post("/v1/convert-dh?to=dh", json=tree)
    assert refused.json()["errors"][0]["pointer"] == "/tip"
    part = client.post("/v1/convert-dh?to=dh&tip=c", json=tree).json()
    assert [row["name"] for row in part["joints"]] == ["a", "c"]
    assert client.post("/v1/convert-dh", json=tree).json()["errors"][0]["pointer"] == "/to"
    urdf = client.post("/v1/convert-dh?to=dh", content=URDF, headers=XML)
    assert "urdf-to-dh" in urdf.json()["detail"]


@pytest.mark.scene
def test_diff_finds_the_toolboxs_ur5(client):
    rows = [
        {"type": "R", "alpha": alpha, "a": a, "d": d}
        for alpha, a, d in (
            ("pi/2", 0, 0.089459),
            (0, -0.425, 0),
            (0, -0.39225, 0),
            ("pi/2", 0, 0.10915),
            ("-pi/2", 0, 0.09465),
            (0, 0, 0.0823),
        )
    ]
    toolbox = {"convention": "standard", "joints": rows}
    answer = client.post("/v1/robots/ur5/diff", json={"other": toolbox})
    assert answer.status_code == 200, answer.text
    body = answer.json()
    assert body["verdict"] == "equivalent"
    first = body["first_difference"]
    assert (first["joint"], first["parameter"], first["absorbed_by"]) == (1, "d", "base")
    assert first["difference"] == pytest.approx(0.0003)
    inline = client.post("/v1/diff", json={"robot": "ur5", "other": toolbox}).json()
    assert inline == body
    same = client.post("/v1/robots/ur5/diff?angle=deg&format=text", json={"other": "ur5_urdf"})
    assert "verdict: identical" in same.text
    assert "zero(s)" not in same.text
    ends = {"tip": "frame_1", "other_tip": "frame_1"}
    part = client.post("/v1/robots/ur5/diff", json={"other": "ur10", **ends})
    assert len(part.json()["joints"]) == 1


def test_diff_refuses_with_the_field(client):
    url = "/v1/robots/ur5/diff"
    assert client.post(url, json={"other": "nobody"}).status_code == 404
    assert client.post(url, json={}).json()["errors"][0]["pointer"] == "/other"
    bad = client.post(url, json={"other": {"convention": "dh", "joints": [{"type": "R"}]}})
    assert bad.json()["errors"][0]["pointer"] == "/other/joints/0/alpha"
    for other, pointer in ((None, "/other"), ({"urdf": "<a/>"}, "/other/urdf")):
        problem = client.post(url, json={"other": other}).json()
        assert problem["errors"][0]["pointer"] == pointer
        assert "robot is neither" not in problem["detail"]
    zero = client.post(url, json={"other": "ur5", "tolerance": {"length": 0}})
    assert zero.json()["errors"][0]["pointer"] == "/tolerance/length"
    assert client.post(url, json={"other": "ur5", "tip": "x"}).status_code == 422
