"""Robots as resources: upload in every form, read, replace, delete, list."""

import io
import re

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy

from tests.conftest import PATIENCE

TABLE = {
    "name": "arm",
    "convention": "standard",
    "units": {"angle": "deg", "length": "mm"},
    "joints": [
        {
            "name": "a1",
            "type": "revolute",
            "a": 0,
            "alpha": 90,
            "d": 400,
            "theta": 0,
            "limits": {"lower": -170, "upper": 170, "velocity": 90, "effort": 100},
        },
        {"name": "a2", "type": "prismatic", "a": 300, "alpha": 0, "d": 0, "theta": 30},
    ],
}
YAML = """
name: arm
convention: standard
units: {angle: deg, length: mm}
joints:
- name: a1
  type: R
  a: 0
  alpha: 90
  d: 400
  limits: {lower: -170, upper: 170, velocity: 90, effort: 100}
- {name: a2, type: P, a: 300, alpha: 0, theta: 30}
"""
CSV = """name;type;alpha;a;d;theta;offset;sign;lower;upper;velocity;effort
a1;R;90;0;0,4;0;0;1;-170;170;90;100
a2;P;0;0,3;0;30;0;1;;;;
"""
URDF = """<robot name="two"><link name="root"/><link name="arm"/><link name="hand"/>
<joint name="z" type="revolute"><parent link="root"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="a" type="continuous"><parent link="arm"/><child link="hand"/>
<origin xyz="1 0 0"/><axis xyz="0 1 0"/></joint></robot>"""


@pytest.fixture
def arm(client):
    yield "/v1/robots/arm"
    client.delete("/v1/robots/arm")


@pytest.mark.scene
def test_the_same_robot_in_every_form(client, arm):
    revisions = set()
    for content, kind, query in (
        (None, "application/json", ""),
        (YAML, "application/yaml", ""),
        (CSV, "text/csv", "?convention=standard&angle=deg"),
    ):
        if content is None:
            answer = client.put(arm, json=TABLE)
        else:
            answer = client.put(arm + query, content=content, headers={"Content-Type": kind})
        assert answer.status_code in (200, 201), answer.text
        revisions.add(answer.json()["revision"])
    assert len(revisions) == 1
    body = client.get(arm).json()
    assert body["kind"] == "dh"
    assert body["dof"] == 2
    assert body["convention"] == "standard"
    assert body["frames"] == ["base_link", "frame_0", "frame_1", "frame_2", "tool"]
    assert body["joints"][0]["lower"] == pytest.approx(np.deg2rad(-170), abs=1e-15)
    assert body["joints"][1]["lower"] is None


def test_post_gives_location_and_etag_and_conflicts_the_second_time(client, arm):
    answer = client.post("/v1/robots", json=TABLE)
    assert answer.status_code == 201
    assert answer.headers["location"] == arm
    assert answer.headers["etag"] == f'"{answer.json()["revision"]}"'
    again = client.post("/v1/robots", json=TABLE)
    assert again.status_code == 409
    assert "another name" in again.json()["detail"]


@pytest.mark.scene
def test_conditional_requests(client, arm):
    tag = client.put(arm, json=TABLE).headers["etag"]
    for path in (arm, f"{arm}/urdf", f"{arm}/dh"):
        assert client.get(path).headers["etag"] == tag
        assert client.get(path, headers={"If-None-Match": tag}).status_code == 304
    changed = TABLE | {"joints": TABLE["joints"][:1]}
    assert client.put(arm, json=changed, headers={"If-None-Match": "*"}).status_code == 412
    for met in (tag, f"W/{tag}", f'"old", {tag}', '"old", *'):
        headers = {"If-None-Match": met}
        assert client.put(arm, json=changed, headers=headers).status_code == 412
        assert client.delete(arm, headers=headers).status_code == 412
    assert client.put(arm, json=TABLE, headers={"If-None-Match": '"old", "*"'}).status_code == 200
    for tag_of_none in ('"old"', '"*"', '""*""', f"W/{tag}", "W/*", tag[:-1], f'"{tag}"'):
        headers = {"If-Match": tag_of_none}
        assert client.put(arm, json=changed, headers=headers).status_code == 412
    answer = client.put(arm, json=changed, headers={"If-Match": f'"other", {tag}'})
    assert answer.status_code == 200
    assert answer.headers["etag"] != tag
    assert client.delete(arm, headers={"If-Match": tag}).status_code == 412
    assert client.delete(arm).status_code == 204
    assert client.get(arm).status_code == 404


def test_shipped_robots_are_read_only(client):
    for answer in (
        client.put("/v1/robots/pa10", json=TABLE | {"name": "pa10"}),
        client.delete("/v1/robots/pa10"),
        client.post("/v1/robots", json=TABLE | {"name": "pa10"}),
    ):
        assert answer.status_code == 409
        assert "read-only" in answer.json()["detail"]


def test_name_must_be_the_id_of_the_path(client):
    answer = client.put("/v1/robots/other", json=TABLE)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/name"
    unnamed = {key: value for key, value in TABLE.items() if key != "name"}
    assert client.put("/v1/robots/other", json=unnamed).status_code == 201
    assert client.post("/v1/robots", json=unnamed).status_code == 422
    assert client.delete("/v1/robots/other").status_code == 204
    urdf = {"content": URDF, "headers": {"Content-Type": "application/xml"}}
    for answer in (
        client.put("/v1/robots/other?name=this", json=unnamed | {"name": "other"}),
        client.put("/v1/robots/other?name=this", **urdf),
    ):
        assert answer.status_code == 422
        assert "'this' but the path says 'other'" in answer.json()["detail"]
    assert client.post("/v1/robots?name=", **urdf).status_code == 422


def test_an_id_may_end_with_a_point(client):
    unnamed = {key: value for key, value in TABLE.items() if key != "name"}
    assert client.put("/v1/robots/arm.", json=unnamed).status_code == 201
    assert client.get("/v1/robots/arm.").json()["id"] == "arm."
    assert client.delete("/v1/robots/arm.").status_code == 204


@pytest.mark.parametrize("robot_id", ["a b", "é", "%2e%2e", ".hidden", "a" * 65, "a%0ab"])
def test_an_id_that_names_no_robot_is_refused_as_such(client, robot_id):
    unnamed = {key: value for key, value in TABLE.items() if key != "name"}
    answer = client.put(f"/v1/robots/{robot_id}", json=unnamed)
    assert answer.status_code == 422
    assert answer.json()["type"] == "/problems/invalid-robot-id"
    assert "letters, digits and . _ -" in answer.json()["detail"]


def test_urdf_upload_orders_q_by_the_file(client):
    answer = client.put(
        "/v1/robots/two?tip=arm", content=URDF, headers={"Content-Type": "application/xml"}
    )
    assert answer.status_code == 201, answer.text
    body = answer.json()
    assert [joint["name"] for joint in body["joints"]] == ["z", "a"]
    assert (body["kind"], body["base_frame"], body["tip_frame"]) == ("urdf", "root", "arm")
    pose = client.get("/v1/robots/two/fk?q=0,90deg&frames=hand").json()["poses"]["hand"]
    np.testing.assert_allclose(pose["matrix"][2][:3], [-1, 0, 0], atol=1e-15)
    client.delete("/v1/robots/two")


def test_a_velocity_limit_alone_survives_the_store(client):
    urdf = URDF.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><limit velocity="2"/>')
    headers = {"Content-Type": "application/xml"}
    put = client.put("/v1/robots/two", content=urdf, headers=headers).json()
    assert put["joints"][1]["velocity"] == 2
    assert client.get("/v1/robots/two").json() == put
    client.delete("/v1/robots/two")


@pytest.mark.scene
def test_the_list_is_paged_and_complete(client):
    found, token = [], ""
    while token is not None:
        page = client.get("/v1/robots", params={"page_size": 20, "page_token": token}).json()
        assert len(page["robots"]) <= 20
        found += [line["id"] for line in page["robots"]]
        token = page["next_page_token"]
    assert found == sorted(set(found))
    expected = """planar_2r planar_3r planar_8r scara stanford puma560 rx90 pa10 ur3 ur5 ur10 panda
        iiwa14 kr6_r900 panda_urdf ur5_urdf kinova xarm7 z1 so101 tiago talos baxter
        double_pendulum"""
    assert set(expected.split()) <= set(found)


@pytest.mark.parametrize("name", ["puma560", "pa10", "stanford", "panda", "planar_8r"])
def test_the_urdf_is_the_same_robot_elsewhere(client, name):
    text = client.get(f"/v1/robots/{name}/urdf").text
    joints = client.get(f"/v1/robots/{name}").json()["joints"]
    q = np.linspace(0.1, 0.7, len(joints))
    poses = client.post(f"/v1/robots/{name}/fk", json={"q": q.tolist(), "frames": "all"}).json()
    model = pin.buildModelFromXML(text)
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.integrate(model, pin.neutral(model), q))
    other = yourdfpy.URDF.load(io.BytesIO(text.encode()), load_meshes=False)
    assert other.validate()
    other.update_cfg({joint["name"]: value for joint, value in zip(joints, q, strict=True)})
    for frame, pose in poses["poses"].items():
        frame_id = model.getFrameId(frame, pin.FrameType.BODY)
        np.testing.assert_allclose(
            pose["matrix"], data.oMf[frame_id].homogeneous, atol=1e-12, rtol=0
        )
        theirs = other.get_transform(frame, "base_link")
        np.testing.assert_allclose(pose["matrix"], theirs, atol=1e-12, rtol=0)


def test_a_name_that_gives_no_id_is_refused_with_what_to_write(client):
    urdf = client.get("/v1/robots/planar_2r/urdf").text
    urdf = re.sub(r'<robot name="[^"]*"', '<robot name="Ρομπότ"', urdf, count=1)
    headers = {"Content-Type": "application/xml"}
    refused = client.post("/v1/robots", content=urdf.encode(), headers=headers)
    assert refused.status_code == 422
    assert "?name=" in refused.json()["detail"]
    named = client.post("/v1/robots?name=greek-arm", content=urdf.encode(), headers=headers)
    assert named.status_code == 201
    assert client.delete("/v1/robots/greek-arm").status_code == 204


@pytest.mark.scene
def test_stateless_conversion(client):
    answer = client.post("/v1/dh-to-urdf", json=TABLE)
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/xml"
    assert pin.buildModelFromXML(answer.text).nv == 2


def test_uploads_survive_a_kill_and_are_seen_by_all_workers(tmp_path, start_server):
    import os
    import signal

    import httpx

    with start_server(tmp_path, "--workers", "2") as (address, process):
        for k in range(20):
            name = f"arm-{k}"
            body = TABLE | {"name": name}
            assert (
                httpx.put(f"{address}/v1/robots/{name}", json=body, timeout=PATIENCE).status_code
                == 201
            )
            answers = [
                httpx.get(f"{address}/v1/robots/{name}/fk?q=0,{k}", timeout=PATIENCE).status_code
                for _ in range(10)
            ]
            assert answers == [200] * 10
        assert httpx.delete(f"{address}/v1/robots/arm-0", timeout=PATIENCE).status_code == 204
        gone = [
            httpx.get(f"{address}/v1/robots/arm-0", timeout=PATIENCE).status_code for _ in range(10)
        ]
        assert gone == [404] * 10
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    with start_server(tmp_path) as (address, _):
        assert (
            httpx.get(f"{address}/v1/robots/arm-19/fk?q=0,1", timeout=PATIENCE).status_code == 200
        )
        assert httpx.get(f"{address}/v1/robots/arm-0", timeout=PATIENCE).status_code == 404
