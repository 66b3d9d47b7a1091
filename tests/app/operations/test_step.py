"""The differential step over HTTP."""

import numpy as np
import pytest


@pytest.mark.scene
def test_the_step_of_the_course_and_its_refusal(client):
    body = {"q": [30, -45, 60], "delta_x": [0.01, 0], "task": "xy"}
    answer = client.post("/v1/robots/planar_3r/step?angle=deg", json=body).json()
    expected = np.rad2deg([-0.007463391, 0.030663928, -0.050222650])
    np.testing.assert_allclose(answer["delta_q"], expected, atol=1e-7)
    got = client.get(
        "/v1/robots/planar_3r/step?q=30,-45,60&delta_x=0.01,0&task=xy&z=1,0,0&angle=deg"
    ).json()
    N = np.array(got["null_projector"])
    np.testing.assert_allclose(got["null_motion"], N[:, 0], atol=1e-12)
    body["q"] = [0, 0, 0]
    refused = client.post("/v1/robots/planar_3r/step?angle=deg", json=body)
    assert refused.status_code == 422
    assert refused.json()["type"].endswith("rank-deficient")
    assert "rank(J) = 1 < 2" in refused.json()["detail"]
    assert "damping" in refused.json()["detail"]
    body["damping"] = 0.01
    assert client.post("/v1/robots/planar_3r/step", json=body).status_code == 200
    turn = {"q": [30, -45, 60], "delta_x": [0, 0, 1], "task": "xy_phi"}
    answer = client.post("/v1/robots/planar_3r/step?angle=deg", json=turn).json()
    assert sum(answer["delta_q"]) == pytest.approx(1)


def test_a_step_of_a_frame_that_no_joint_moves(client):
    body = {"q": [0.5, -0.7, 1], "delta_x": [0.01, 0], "task": "xy", "frame": "frame_0"}
    answer = client.post("/v1/robots/planar_3r/step", json=body)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/frame"
    assert "no joint moves frame 'frame_0'" in answer.json()["detail"]
    lower = {key: value for key, value in body.items() if key != "q"}
    second = {**body, "frame": "tool", "secondary": [lower]}
    answer = client.post("/v1/robots/planar_3r/step", json=second)
    assert answer.json()["errors"][0]["pointer"] == "/secondary/0/frame"
    second["secondary"] = [{**lower, "frame": "tool", "task": "magic"}]
    answer = client.post("/v1/robots/planar_3r/step", json=second)
    assert answer.json()["errors"][0]["pointer"] == "/secondary/0/task"
    whole = {"q": [0.5, -0.7, 1], "delta_x": [0] * 6, "task": "pose"}
    words = client.post("/v1/robots/planar_3r/step", json=whole).json()["detail"]
    assert "choose another (xy, x, y, xy_phi)" in words
