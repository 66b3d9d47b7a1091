"""Fields of a path that cannot be used are named as they were given."""

import pytest

from tests.app.operations.scenarios import SCENARIOS, body_of


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"method": "magic"}, "/method"),
        ({"target": None}, "/target"),
        ({"circle": {"center": [0, 0]}}, "/circle"),
        ({"samples": 1}, "/samples"),
        ({"samples": 10**6}, "/samples"),
        ({"tf": 0}, "/tf"),
        ({"time_law": "jerk"}, "/time_law"),
        ({"d_safe": -1}, "/d_safe"),
        ({"link_radius": -1}, "/link_radius"),
        ({"obstacles": [{"type": "cone"}]}, "/obstacles/0/type"),
        (
            {"obstacles": [{"type": "circle", "center": [1, 2], "radius": -1}]},
            "/obstacles/0/radius",
        ),
        ({"obstacles": [{"type": "sphere", "center": [1, 2], "radius": 1}]}, "/obstacles/0/center"),
        ({"obstacles": [{"type": "circle", "center": [9, 9], "radius": 1}] * 101}, "/obstacles"),
        ({"q": [200, 0, 0]}, "/q/0"),
        ({"task": "magic"}, "/task"),
        ({"task": "xy_phi"}, "/target"),
        ({"frame": "hand"}, "/frame"),
        ({"frame": "base_link"}, "/frame"),
        ({"secondary": [{"frame": "frame_0"}]}, "/secondary/0/frame"),
        ({"damping": 0}, "/damping"),
        ({"tolerance": {"position": -1}}, "/tolerance/position"),
        ({"secondary": [{"frame": "no"}]}, "/secondary/0/frame"),
        ({"secondary": [{}, {"task": "magic"}]}, "/secondary/1/task"),
        ({"method": "task_priority"}, "/secondary"),
        ({"posture": [0, 0]}, "/posture"),
        ({"gains": {"limits": -1}}, "/gains/limits"),
        (
            {
                "method": "whole_path",
                "samples": 10_000,
                "obstacles": [{"type": "circle", "center": [9, 9], "radius": 1}] * 5,
            },
            "/samples",
        ),
    ],
)
def test_bad_paths_name_their_field(client, change, pointer):
    body = {**body_of(SCENARIOS["3R_free"]), **change}
    answer = client.post("/v1/path?angle=deg", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer


@pytest.mark.parametrize(
    ("change", "pointer", "words"),
    [
        ({"retime": {}}, "/retime/acceleration", "give a number for all joints"),
        ({"retime": {"acceleration": 0}}, "/retime/acceleration", "joint j1"),
        ({"retime": {"acceleration": [1, -1, 1]}}, "/retime/acceleration/1", "joint j2"),
        ({"retime": {"acceleration": [1, 1]}}, "/retime/acceleration", "2 values; give 3"),
        ({"retime": {"acceleration": {"j1": 1}}}, "/retime/acceleration", "lacks joint j2"),
        ({"retime": {"acceleration": {"j1": 1, "jx": 1}}}, "/retime/acceleration/jx", "unknown"),
        ({"retime": {"acceleration": "fast"}}, "/retime/acceleration", ""),
        ({"retime": {"acceleration": 1, "velocity": 1e12}}, "/retime/velocity", "give 1e-06"),
        ({"retime": {"acceleration": 1, "samples": 1}}, "/retime/samples", "give 2"),
        ({"retime": {"acceleration": 1, "samples": 10**6}}, "/retime/samples", "give 2"),
        ({"retime": {"acceleration": 1, "jerk": 1}}, "/retime/jerk", "unknown"),
        ({"link_radius": [0.1]}, "/link_radius", "1 values; give 3"),
        ({"link_radius": {"j1": 0.1, "j2": -1, "j3": 0}}, "/link_radius/j2", "joint j2"),
        ({"link_geometry": "mesh"}, "/link_geometry", "skeleton or urdf"),
    ],
)
def test_bad_limits_and_links_name_their_field(client, change, pointer, words):
    body = {**body_of(SCENARIOS["3R_free"]), **change}
    for headers in ({}, {"Accept": "application/x-ndjson"}):
        answer = client.post("/v1/path?angle=deg", json=body, headers=headers)
        assert answer.status_code == 422, answer.text
        assert answer.json()["errors"][0]["pointer"] == pointer
        assert words in answer.json()["detail"]
    compare = {key: value for key, value in body.items() if key != "method"}
    assert client.post("/v1/path/compare?angle=deg", json=compare).status_code == 422


@pytest.mark.parametrize(
    ("change", "pointer", "words"),
    [
        ({"target": {"position": [1]}}, "/target/position", "target.position has 1 values; give 2"),
        (
            {"target": None, "waypoints": [{"position": [0.5, 0.2]}, {"position": []}]},
            "/waypoints/1/position",
            "waypoints.1.position has 0 values",
        ),
        (
            {"obstacles": [{"type": "box", "center": [9, 9, 0], "size": [1, 1, 1], "rpy": [0, 0]}]},
            "/obstacles/0/rpy",
            "obstacles.0.rpy has 2 values; give 3",
        ),
        ({"target": None, "circle": {"center": [0.1]}}, "/circle/center", "give two"),
        (
            {"target": None, "circle": {"center": [0.1, 0], "plane": "xz"}},
            "/circle/plane",
            "leaves the plane of the task xy",
        ),
        ({"methods": ["qp", {"method": "qp", "margin": -1}]}, "/methods/1/margin", "margin is -1"),
        (
            {"methods": [{"method": "null_space", "gains": {"limits": -1}}]},
            "/methods/0/gains/limits",
            "give 0",
        ),
        (
            {"d_safe": 0.02, "methods": ["qp", {"method": "null_space", "influence": 0.01}]},
            "/methods/1/influence",
            "give more than d_safe, 0.02",
        ),
        (
            {"obstacles": [{"type": "box", "center": [9, 9, 0], "size": [1, 0, 1]}]},
            "/obstacles/0/size",
            "the size has a value that is not positive",
        ),
        (
            {"obstacles": [{"type": "circle", "center": [9], "radius": 1}]},
            "/obstacles/0/center",
            "center has 1 values; give 2 or 3",
        ),
    ],
)
def test_refusals_name_the_field_as_it_was_given(client, change, pointer, words):
    body = {**body_of(SCENARIOS["3R_free"]), **change}
    body = {key: value for key, value in body.items() if value is not None}
    url = "/v1/path/compare" if "methods" in change else "/v1/path"
    answer = client.post(f"{url}?angle=deg", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer
    assert words in answer.json()["detail"]
