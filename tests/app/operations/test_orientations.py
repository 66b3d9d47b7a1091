"""Orientations as makers write them, in targets and in answers."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.orientation_formats import FORMATS

Q = [0.3, -0.7, 0.4, 0.4, 0.8, -0.5]
ADDRESS = "/v1/robots/puma560"


@pytest.mark.parametrize("angle", ["rad", "deg"])
@pytest.mark.parametrize("name", FORMATS)
def test_an_answer_in_a_format_is_a_target_in_it(client, name, angle):
    params = {"angle": angle, "orientation": name}
    q = np.rad2deg(Q).tolist() if angle == "deg" else Q
    answer = client.post(f"{ADDRESS}/fk", json={"q": q}, params=params)
    assert answer.status_code == 200, answer.text
    pose = answer.json()["poses"]["tool"]
    target = {"position": pose["position"], name: pose[name]}
    found = client.post(
        f"{ADDRESS}/ik", json={"target": target, "seed": q}, params={"angle": angle}
    ).json()
    assert found["status"] == "converged", found
    assert found["q"] == pytest.approx(q, abs=1e-7)
    many = client.post(
        f"{ADDRESS}/ik",
        json={"targets": {key: [value] * 3 for key, value in target.items()}, "seed": q},
        params={"angle": angle},
    ).json()
    assert np.abs(np.array(many["q"]) - q).max() < 1e-6
    listed = client.post(
        f"{ADDRESS}/ik", json={"targets": [target] * 3, "seed": q}, params={"angle": angle}
    ).json()
    assert listed["q"] == many["q"]
    text = {key: ",".join(map(str, value)) for key, value in target.items()}
    query = {**text, "angle": angle, "seed": ",".join(map(str, q))}
    asked = client.get(f"{ADDRESS}/ik", params=query).json()
    assert asked["q"] == pytest.approx(q, abs=1e-7)


def test_one_and_a_batch_are_written_alike(client):
    one = client.post(f"{ADDRESS}/fk", json={"q": Q}, params={"orientation": "kuka_abc"}).json()
    many = client.post(
        f"{ADDRESS}/fk", json={"q": [Q, Q]}, params={"orientation": "kuka_abc"}
    ).json()
    found = many["poses"]["tool"]["kuka_abc"]
    assert found[0] == found[1] == pytest.approx(one["poses"]["tool"]["kuka_abc"], abs=1e-12)
    assert "orientation_degenerate" not in one["poses"]["tool"]


def test_values_that_are_not_unique_are_marked(client):
    answer = client.get(f"{ADDRESS}/fk", params={"q": "0,0,0,0,0,0", "orientation": "comau_euler"})
    pose = answer.json()["poses"]["tool"]
    assert pose["orientation_degenerate"] is True


def test_a_box_is_turned_as_makers_write_it(client):
    """The clearance is that of the box turned by rpy."""
    body = {"q": Q, "circle": {"center": [0.3, 0.1, 0.5]}, "task": "position", "samples": 5}
    box = {"type": "box", "center": [0.9, 0, 0.2], "size": [0.4, 0.1, 0.1]}
    found = [
        client.post(f"{ADDRESS}/path", json={**body, "obstacles": [{**box, **turned}]}).json()
        for turned in ({"rpy": [0.3, 0.2, 0.1]}, {"kuka_abc": [0.1, 0.2, 0.3]})
    ]
    assert found[0]["clearance"] == pytest.approx(found[1]["clearance"], abs=1e-12)


def test_a_sheet_has_columns_of_them(client):
    params = {"q": "0,0,0,0,0.3,0", "orientation": "abb_quaternion", "format": "csv"}
    heading, row = client.get(f"{ADDRESS}/fk", params=params).text.splitlines()
    cells = dict(zip(heading.split(","), row.split(","), strict=True))
    values = [float(cells[f"orientation_abb_quaternion_{k}"]) for k in range(1, 5)]
    assert np.linalg.norm(values) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("target", "part"),
    [
        ({"kuka_abc": [0, 0, 0], "fanuc_wpr": [0, 0, 0]}, "give one orientation"),
        ({"kuka_abc": [0, 0, 0], "rpy": [0, 0, 0]}, "give one orientation"),
        ({"kuka_abc": [0, 0]}, "give 3"),
        ({"abb_quaternion": [1, 1, 1, 1]}, "w, x, y, z"),
        ({"ur_rotation_vector": [1e9, 0, 0]}, "1e6"),
    ],
)
def test_what_is_no_orientation_is_refused(client, target, part):
    body = {"target": {"position": [0.4, 0, 0.3], **target}}
    answer = client.post(f"{ADDRESS}/ik", json=body)
    assert answer.status_code == 422
    assert part in answer.json()["errors"][0]["message"], answer.text


def test_an_unknown_format_is_refused_with_those_that_are_known(client):
    answer = client.get(f"{ADDRESS}/fk", params={"q": "0,0,0,0,0,0", "orientation": "kuka"})
    assert answer.status_code == 422
    error = answer.json()["errors"][0]
    assert error["pointer"] == "/orientation"
    assert "kuka_abc" in error["message"]


def test_degrees_for_radians_are_doubted(client):
    body = {"target": {"position": [0.4, 0.1, 0.3], "kuka_abc": [90, 0, 180]}}
    answer = client.post(f"{ADDRESS}/ik", json=body).json()
    assert any("angle=deg" in one for one in answer["warnings"]), answer["warnings"]
