"""What keeps clear of obstacles: shapes of a URDF, or segments with a radius."""

import json

import pytest

from tests.app.operations.scenarios import SCENARIOS, body_of

SHAPED = """<robot name="shaped">
<link name="base"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
<link name="upper"><collision><origin xyz="0.25 0 0" rpy="0 1.5707963 0"/>
  <geometry><cylinder radius="0.05" length="0.5"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.2 0 0" rpy="0 1.5707963 0"/>
  <geometry><capsule radius="0.03" length="0.4"/></geometry></collision></link>
<link name="wrist"><collision><geometry><mesh filename="wrist.stl"/></geometry></collision></link>
<link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
<joint name="j2" type="revolute"><parent link="upper"/><child link="lower"/>
  <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
<joint name="j3" type="revolute"><parent link="lower"/><child link="wrist"/>
  <origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
<joint name="end" type="fixed"><parent link="wrist"/><child link="tip"/>
  <origin xyz="0.2 0 0"/></joint>
</robot>"""


def test_the_shapes_of_a_urdf(client):
    body = {
        "robot": {"urdf": SHAPED},
        "q": [0.4, 0.5, 0.6],
        "target": {"position": [0.3, 0.8]},
        "task": "xy",
        "obstacles": [
            {"type": "sphere", "center": [0.6, -0.2, 0], "radius": 0.05},
            {"type": "sphere", "center": [0, 0.2, 0], "radius": 0.1},
        ],
        "link_radius": {"j1": 0.01, "j2": 0.02, "j3": 0.04},
        "link_geometry": "urdf",
    }
    answer = client.post("/v1/path", json=body).json()
    parts = {part["link"]: part for part in answer["links"]}
    assert set(parts) == {"upper", "lower", "segment 3"}
    assert parts["upper"]["shape"] == "cylinder"
    assert 0 < parts["upper"]["excess"] <= 0.06
    lower = {"link": "lower", "joint": "j2", "shape": "capsule", "radius": 0.03, "excess": 0.0}
    assert parts["lower"] == {**lower, "length": pytest.approx(0.4)}
    segment = {"link": "segment 3", "joint": "j3", "shape": "segment", "radius": 0.04}
    assert parts["segment 3"] == {**segment, "length": None, "excess": 0.0}
    assert "meshes that were not uploaded are not counted, those of wrist" in answer["warnings"][0]
    assert "link base, which no joint of the arm moves" in answer["warnings"][1]
    assert "from obstacle 1" in answer["warnings"][1]
    picture = client.post("/v1/path?format=svg", json=body).text
    assert picture.count("#56b4e9") >= 27
    assert "nan" not in picture
    lines = client.post("/v1/path?format=ndjson", json=body).text.splitlines()
    assert json.loads(lines[-1])["links"] == answer["links"]

    bones = {**body, "link_geometry": "skeleton"}
    plain = client.post("/v1/path", json=bones).json()
    assert plain["links"] is None
    assert plain["warnings"] == []
    assert plain["clearance"][0] > answer["clearance"][0]
    table = client.post("/v1/path/compare", json={**body, "methods": ["qp"]}).json()
    assert table["links"] == answer["links"]
    assert table["rows"][0]["min_clearance"] == answer["summary"]["min_clearance"]


def test_radii_of_the_links_by_joint(client):
    body = body_of(SCENARIOS["3R_obstacle"])
    one = client.post("/v1/path?angle=deg", json={**body, "link_radius": 0.03}).json()
    for radii in ([0.03] * 3, {"j1": 0.03, "j2": 0.03, "j3": 0.03}):
        same = client.post("/v1/path?angle=deg", json={**body, "link_radius": radii}).json()
        assert same["clearance"] == one["clearance"]
    thin = client.post("/v1/path?angle=deg", json={**body, "link_radius": [0, 0, 0.03]}).json()
    assert thin["clearance"][0] >= one["clearance"][0]
    picture = client.post(
        "/v1/path?angle=deg&format=svg", json={**body, "link_radius": [0, 0, 0.03]}
    )
    assert "<svg" in picture.text
