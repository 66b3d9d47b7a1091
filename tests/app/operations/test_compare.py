"""Methods beside each other: as JSON, text, CSV and a picture."""

import csv
import io

import pytest

from tests.app.operations.scenarios import LINE, SCENARIOS, body_of


@pytest.mark.scene
def test_compare_as_json_text_and_csv(client):
    methods = [
        "pseudo_inverse",
        {"method": "pseudo_inverse", "closed_loop": False},
        "qp",
        {"method": "qp", "label": "wide", "margin": 0.01},
    ]
    body = {**body_of(SCENARIOS["8R_obstacles"]), "methods": methods}
    url = "/v1/path/compare?angle=deg"
    table = client.post(url, json=body).json()
    rows = {row["method"]: row for row in table["rows"]}
    assert list(rows) == ["pseudo_inverse", "pseudo_inverse (2)", "qp", "wide"]
    assert rows["pseudo_inverse"]["reason"] == "collision"
    assert rows["pseudo_inverse (2)"]["end_position_error"] > 4e-3
    assert rows["qp"]["success"]
    assert rows["wide"]["min_clearance"] > rows["qp"]["min_clearance"] + 0.008
    assert "obstacle" in table["messages"]["pseudo_inverse"]
    text = client.post(url, json=body, headers={"Accept": "text/plain"}).text
    assert "ms_per_point" in text
    answer = client.post(url, json=body, headers={"Accept": "text/csv"})
    assert answer.headers["content-type"].startswith("text/csv")
    lines = list(csv.DictReader(io.StringIO(answer.text)))
    assert [line["method"] for line in lines] == list(rows)
    assert lines[2]["success"] == "true"
    assert lines[2]["reason"] == lines[2]["drift"] == ""
    assert (float(lines[2]["tracked"]), float(lines[2]["max_orientation_error"])) == (1, 0)
    assert float(lines[2]["sum_dq"]) == pytest.approx(rows["qp"]["sum_dq"])


def test_methods_compared_by_their_shortest_time(client):
    body = {**LINE, "methods": ["qp", "pseudo_inverse"], "retime": {"acceleration": 5}}
    url = "/v1/robots/panda/path/compare"
    table = client.post(url, json=body).json()
    assert all(row["retimed_success"] and row["retimed_duration"] > 0 for row in table["rows"])
    assert "the path takes" in table["messages"]["qp"]
    csv_text = client.post(f"{url}?format=csv", json=body).text
    rows = list(csv.DictReader(io.StringIO(csv_text)))
    assert float(rows[0]["retimed_duration"]) == pytest.approx(table["rows"][0]["retimed_duration"])
    del body["retime"]
    assert client.post(url, json=body).json()["rows"][0]["retimed_duration"] is None


def test_a_spatial_arm_is_drawn_in_space(client):
    """Seen from aside, on a floor with coordinates; a planar arm in its plane."""
    body = {
        **LINE,
        "obstacles": [
            {"type": "sphere", "center": [0.7, 0.5, 0.5], "radius": 0.1},
            {"type": "circle", "center": [0.7, -0.5], "radius": 0.1},
            {"type": "box", "center": [0.6, -0.5, 0.2], "size": [0.2, 0.2, 0.4], "rpy": [0, 0, 1]},
            {"type": "capsule", "start": [0, 0.6, 0], "end": [0, 0.6, 1], "radius": 0.05},
            {"type": "half_space", "normal": [0, 0, 1], "offset": -0.01},
        ],
        "methods": ["pseudo_inverse", "qp"],
    }
    picture = client.post("/v1/robots/panda/path/compare?format=svg", json=body).text
    assert picture.count(">z [m]<") == 2
    assert picture.count(">y [m]<") == 2
    assert "nan" not in picture
    flat = {**body_of(SCENARIOS["8R_obstacles"]), "methods": ["qp"]}
    assert ">z [m]<" not in client.post("/v1/path/compare?angle=deg&format=svg", json=flat).text


@pytest.mark.scene
def test_a_method_that_needs_more_is_left_out(client):
    body = {**LINE, "methods": ["task_priority", "qp", "task_priority"]}
    url = "/v1/robots/panda/path/compare"
    answer = client.post(url, json=body)
    assert answer.status_code == 200, answer.text
    said = answer.json()
    assert [row["method"] for row in said["rows"]] == ["qp"]
    assert set(said["left_out"]) == {"task_priority", "task_priority (2)"}
    assert "secondary" in said["left_out"]["task_priority"]
    assert any("task_priority is left out" in one for one in said["warnings"])
    assert "left_out" not in client.post(url, json={**body, "methods": ["qp"]}).json()
    rows = list(csv.DictReader(io.StringIO(client.post(f"{url}?format=csv", json=body).text)))
    assert [row["method"] for row in rows] == ["qp"]
    assert "left out" in rows[0]["warnings"]
    assert client.post(f"{url}?format=svg", json=body).status_code == 200
    alone = client.post(url, json={**body, "methods": ["task_priority"]})
    assert alone.status_code == 422
    assert "secondary" in alone.json()["errors"][0]["pointer"]
