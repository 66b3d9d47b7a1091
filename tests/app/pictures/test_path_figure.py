"""Pictures of followed paths: what is drawn is where the arm is."""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from app.pictures.canvas import Canvas
from app.pictures.chart import Chart, draw_chart, ticks
from app.pictures.curves import Curve

SVG = "{http://www.w3.org/2000/svg}"
SPHERES = {
    "q": [0.3, 0.4, 0.0, -1.6, 0.0, 1.9, 0.6],
    "target": {"position": [0.45, 0.3, 0.5]},
    "task": "position",
    "obstacles": [
        {"type": "sphere", "center": [0.5, -0.3, 0.4], "radius": 0.05},
        {"type": "box", "center": [0.7, 0.5, 0.2], "size": [0.1, 0.1, 0.1]},
        {"type": "capsule", "start": [0.8, 0, 0], "end": [0.8, 0, 1], "radius": 0.03},
        {"type": "half_space", "normal": [0, 0, 1], "offset": -0.2},
    ],
    "samples": 21,
}


def plane_path(client, path, **more):
    body = client.get("/openapi.json").json()["paths"][f"/v1/robots/{{robot_id}}/{path}"]["post"]
    example = body["requestBody"]["content"]["application/json"]["example"]
    return {**example, "samples": 31, **more}


@pytest.mark.scene
def test_a_path_as_picture(client):
    body = plane_path(client, "path", method="qp")
    answer = client.post("/v1/robots/planar_8r/path?format=svg", json=body)
    assert answer.headers["content-type"].startswith("image/svg+xml")
    root = ET.fromstring(answer.text)
    texts = [element.text for element in root.iter(f"{SVG}text")]
    assert "qp: success" in texts
    assert {"joints [rad]", "clearance [m]", "position error [m]", "d_safe", "j8"} <= set(texts)
    accepted = client.post(
        "/v1/robots/planar_8r/path", json=body, headers={"Accept": "image/svg+xml"}
    )
    assert accepted.headers["content-type"].startswith("image/svg+xml")


def test_links_keep_their_lengths_in_the_picture(client):
    """Nine snapshots of eight links of equal length, in one scale."""
    body = plane_path(client, "path", method="qp")
    root = ET.fromstring(client.post("/v1/robots/planar_8r/path?format=svg", json=body).text)
    shapes = [
        np.array([pair.split(",") for pair in e.get("points").split()], dtype=float)
        for e in root.iter(f"{SVG}polyline")
    ]
    arms = [shape for shape in shapes if len(shape) == 9]
    assert len(arms) == 9
    lengths = np.linalg.norm(np.diff(arms, axis=1), axis=2)
    assert np.ptp(lengths) < 0.05
    assert lengths.min() > 10


def test_methods_side_by_side(client):
    body = plane_path(client, "path/compare", methods=["pseudo_inverse", "qp"])
    text = client.post("/v1/robots/planar_8r/path/compare?format=svg", json=body).text
    texts = [element.text for element in ET.fromstring(text).iter(f"{SVG}text")]
    assert "pseudo_inverse: collision" in texts
    assert "qp: success" in texts


@pytest.mark.parametrize("robot", ["panda", "pa10"])
def test_arms_in_space_and_every_obstacle(client, robot):
    answer = client.post(f"/v1/robots/{robot}/path?format=svg", json=SPHERES)
    assert answer.status_code == 200
    assert "nan" not in answer.text
    ET.fromstring(answer.text)


@pytest.mark.parametrize(
    ("low", "high"), [(0, 1), (-1e-9, 1e-9), (0, 0), (1e6, 1e6 + 1), (-3.2, 7.9)]
)
def test_ticks_are_round_and_inside(low, high):
    found = ticks(low, high)
    assert 1 <= len(found) <= 7
    assert all(low - 1e-9 * abs(low) - 1e-15 <= t <= high + 1e-9 * abs(high) + 1e-15 for t in found)


def test_a_chart_of_nothing_and_of_gaps():
    canvas = Canvas(400, 200, "a < b & c")
    x = np.arange(4.0)
    empty = np.full(4, np.inf)
    draw_chart(canvas, (0, 0, 400, 200), Chart([Curve("x", x, empty, "#000")], "t", "x", log=True))
    gaps = Curve("y", x, np.array([0, np.nan, 1e-300, 5]), "#000")
    draw_chart(canvas, (0, 0, 400, 200), Chart([gaps], "t", "x", log=True))
    text = canvas.render()
    ET.fromstring(text)
    assert "nan" not in text
    assert "inf" not in text.replace("infinite", "")
