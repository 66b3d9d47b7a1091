"""Paths in the shortest time, over HTTP."""

import io
import json

import numpy as np
import pytest

from tests.app.operations.scenarios import LINE


@pytest.mark.scene
def test_a_path_in_the_shortest_time(client):
    body = {**LINE, "retime": {"acceleration": 5, "samples": 301}}
    url = "/v1/robots/panda/path"
    answer = client.post(url, json=body).json()
    assert answer["success"]
    motion = answer["retimed"]
    assert motion["status"] == "retimed"
    assert motion["success"], motion["message"]
    assert motion["violations"] == motion["warnings"] == []
    assert 0.1 < motion["duration"] < 2
    assert len(motion["t"]) == len(motion["q"]) == len(motion["velocity"]) == 301
    assert motion["t"][-1] == pytest.approx(motion["duration"])
    robot = client.get("/v1/robots/panda").json()
    speeds = np.array([joint["velocity"] for joint in robot["joints"]])
    assert motion["velocity_limits"] == speeds.tolist()
    assert motion["acceleration_limits"] == [5.0] * 7
    assert np.abs(np.array(motion["velocity"]) / speeds).max() <= 1 + 1e-9
    assert np.abs(motion["acceleration"]).max() <= 5 * (1 + 1e-9)
    np.testing.assert_allclose(motion["q"][-1], answer["q"][-1], atol=1e-12)
    assert motion["max_position_deviation"] < 1e-4
    assert motion["min_clearance"] <= answer["summary"]["min_clearance"]

    # the same in degrees, and joint by joint
    names = [joint["name"] for joint in robot["joints"]]
    wide = dict.fromkeys(names, float(np.rad2deg(5)))
    degrees = {
        **body,
        "q": np.rad2deg(LINE["q"]).tolist(),
        "retime": {"acceleration": wide, "velocity": np.rad2deg(speeds).tolist(), "samples": 301},
    }
    turned = client.post(f"{url}?angle=deg", json=degrees).json()["retimed"]
    assert turned["duration"] == pytest.approx(motion["duration"], rel=1e-6)
    np.testing.assert_allclose(turned["velocity"], np.rad2deg(motion["velocity"]), atol=1e-3)
    np.testing.assert_allclose(turned["acceleration_limits"], np.rad2deg(5))

    assert client.post(url, json=LINE).json()["retimed"] is None


def test_a_retimed_path_as_text_picture_npy_and_stream(client):
    body = {**LINE, "retime": {"acceleration": 5, "samples": 50}}
    url = "/v1/robots/panda/path"
    plain = client.post(url, json=body).json()
    text = client.post(f"{url}?format=text", json=body).text
    assert "retimed:" in text
    assert "  duration: " in text
    picture = client.post(f"{url}?format=svg", json=body).text
    assert "in the shortest time: speeds / limit" in picture
    assert "nan" not in picture
    array = np.load(io.BytesIO(client.post(f"{url}?format=npy", json=body).content))
    assert array.shape == (101, 7)
    lines = [
        json.loads(line)
        for line in client.post(f"{url}?format=ndjson", json=body).text.splitlines()
    ]
    assert len(lines) == 101 + 50 + 1
    assert [line["retimed_sample"] for line in lines[101:-1]] == list(range(50))
    np.testing.assert_allclose([line["q"] for line in lines[101:-1]], plain["retimed"]["q"])
    last = lines[-1]["retimed"]
    assert last["success"]
    assert "q" not in last
    assert last["duration"] == pytest.approx(plain["retimed"]["duration"])
    untimed = client.post(f"{url}?format=ndjson", json=LINE).text.splitlines()
    assert json.loads(untimed[-1])["retimed"] is None


def test_a_stuck_path_has_no_motion_to_time(client):
    body = {
        "q": [0, 0, 0],
        "target": {"position": [0.9, 0]},
        "task": "xy",
        "method": "pseudo_inverse",
        "retime": {"acceleration": 1},
    }
    url = "/v1/robots/planar_3r/path"
    motion = client.post(url, json=body).json()["retimed"]
    assert (motion["status"], motion["success"], motion["duration"]) == ("no_motion", False, 0)
    assert motion["velocity_limits"] == [None] * 3
    lines = client.post(f"{url}?format=ndjson", json=body).text.splitlines()
    assert json.loads(lines[-1])["retimed"]["status"] == "no_motion"
    assert "<svg" in client.post(f"{url}?format=svg", json=body).text
