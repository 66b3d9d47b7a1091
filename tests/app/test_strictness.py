"""Methods, addresses and numbers at the edges: exact or refused, in one shape."""

import numpy as np
import pytest

from app.operations.singularity import SINGULARITY
from robots.shipped import shipped_robot
from tests.app.http.requests import FK, IK, check


def test_head_is_get_without_a_body_on_every_route(client):
    document = client.get("/openapi.json").json()
    paths = [path for path, item in document["paths"].items() if "get" in item]
    for path in (*paths, "/", "/docs", "/openapi.json", "/problems/invalid-q"):
        parameters = document["paths"].get(path, {}).get("get", {}).get("parameters", [])
        examples = {p["name"]: p["example"] for p in parameters if "example" in p}
        robot = examples.pop("robot_id", "ur5")
        url = path.replace("{robot_id}", robot)
        head, get = client.head(url, params=examples), client.get(url, params=examples)
        assert (head.status_code, head.content) == (get.status_code, b""), url
        assert head.headers["content-type"] == get.headers["content-type"]
    assert client.head("/v1/fk").status_code == 405
    assert client.head("/v1/robots/none").status_code == 404


@pytest.mark.parametrize(
    ("path", "allowed"),
    [
        ("/v1/robots", "GET, HEAD, POST, OPTIONS"),
        ("/v1/robots/ur5", "GET, HEAD, PUT, DELETE, OPTIONS"),
        ("/v1/robots/ur5/fk", "GET, HEAD, POST, OPTIONS"),
        ("/v1/robots/ur5/dh", "GET, HEAD, OPTIONS"),
        ("/v1/fk", "POST, OPTIONS"),
        ("/health/live", "GET, HEAD, OPTIONS"),
        ("/docs-assets/x.js", "GET, HEAD, OPTIONS"),
    ],
)
def test_methods_that_are_not_possible_say_which_are(client, path, allowed):
    for method in ("TRACE", "PATCH", "PROPFIND"):
        answer = client.request(method, path)
        check(answer, 405, "", method, allowed)
        assert answer.headers["allow"] == allowed
    answer = client.options(path)
    if "docs-assets" not in path:
        assert (answer.status_code, answer.content) == (204, b"")
        assert answer.headers["allow"] == allowed


@pytest.mark.parametrize(
    "path",
    [
        "/v1/robots/",
        "/v1//robots",
        "/v1/robots/ur5/fk/",
        "/v1/robots/%2e%2e",
        "/v1/fk/x",
        "/v1/robots/%00",
        "/v1/robots/UR5",
        "/v1/robots/ur5%20",
        "/v1/robots/a%2Fb",
    ],
)
def test_addresses_that_lead_nowhere(client, path):
    check(client.get(path), 404, "")
    check(client.options(path), 404, "") if path.endswith("/") else None


def test_problems_are_text_for_those_who_ask_for_text(client):
    asked = ({"params": {"format": "text"}}, {"headers": {"Accept": "text/plain"}})
    for ask in asked:
        answer = client.get("/v1/robots/puma56", **ask)
        assert answer.status_code == 404
        assert answer.headers["content-type"] == "text/plain; charset=utf-8"
        first, second, third = answer.text.splitlines()
        assert first == "404 There is no such robot"
        assert "did you mean puma560" in second
        assert third == f"request_id: {answer.headers['x-request-id']}"
    answer = client.get(f"{FK}?q=0,x&format=text")
    assert answer.text.splitlines()[1].startswith("  /q: ")
    check(client.get(f"{FK}?q=0,x&format=json", headers={"Accept": "text/plain"}), 422, "/q")


@pytest.mark.parametrize(
    ("path", "body", "pointer"),
    [
        ("fk", {"q": {"j1": 0, "j2": 10**400}}, "/q/j2"),
        ("fk", {"q": {"j1": 0, "j2": -(10**20)}}, "/q/1"),
        ("singularity", {"q": [0, 0], "tolerance": -1}, "/tolerance"),
        ("singularity", {"q": [0, 0], "tolerance": 1e308}, "/tolerance"),
        ("singularity", {"q": [0, 0], "characteristic_length": 0}, "/characteristic_length"),
        ("singularity", {"q": [0, 0], "characteristic_length": 1e-320}, "/characteristic_length"),
        ("singularity", {"q": [0, 0], "task": [0] * 6}, "/task"),
        ("singularity", {"q": [0, 0], "task": [True] * 6}, "/task/0"),
        ("singularity/nearest", {"q": [0, 0], "tolerance": 5}, "/tolerance"),
        ("manipulability-gradient", {"q": [0, 0], "tolerance": -1e-320}, "/tolerance"),
        ("wrench", {"q": [0, 0], "tau": [1e308, 0]}, "/tau/0"),
        ("wrench", {"q": [0, 0], "tau": [1, 0], "tolerance": 1}, "/tolerance"),
        ("joint-torques", {"q": [0, 0], "wrench": [0, 0, 0, 0, 0, 1e308]}, "/wrench/5"),
        ("joint-velocities", {"q": [0, 0], "twist": [0] * 6, "damping": 1e-320}, "/damping"),
        ("joint-velocities", {"q": [0, 0], "twist": [0] * 6, "damping": 1e308}, "/damping"),
        ("twist", {"q": [0, 0], "qd": [0, 1e308]}, "/qd/1"),
        ("step", {"q": [0, 0], "delta_x": [1e308, 0], "task": "xy"}, "/delta_x"),
        ("step", {"q": [0, 0], "delta_x": [0, 0], "task": "xy", "damping": 1e308}, "/damping"),
        ("ik", {"target": {"position": [1e308, 0]}, "task": "xy"}, "/target/position"),
        (
            "ik",
            {"target": {"position": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 0]}},
            "/target/quaternion_xyzw",
        ),
        ("ik", {"target": {"matrix": np.diag([1, 1, -1, 1]).tolist()}}, "/target/matrix"),
        ("ik", {"target": {"matrix": np.diag([2, 2, 2, 1]).tolist()}}, "/target/matrix"),
        ("ik", {"target": {"matrix": [[1e308] * 4] * 4}}, "/target/matrix"),
        (
            "ik",
            {
                "target": {
                    "position": [0, 0, 0],
                    "euler": {"sequence": "Z" * 9000, "angles": [0, 0, 0]},
                }
            },
            "/target/euler/sequence",
        ),
        (
            "ik",
            {"target": {"position": [1, 0]}, "task": "xy", "max_restarts": 10**9},
            "/max_restarts",
        ),
        (
            "ik",
            {"target": {"position": [1, 0]}, "task": "xy", "time_budget_ms": -1},
            "/time_budget_ms",
        ),
        (
            "ik",
            {"targets": [{"position": [1, 0]}] * 500 + [{"position": [1, None]}], "task": "xy"},
            "/targets/500/position/1",
        ),
        (
            "ik",
            {"targets": [{"position": [1, 0]}] * 500 + [{"position": [1, 1e7]}], "task": "xy"},
            "/targets/500/position",
        ),
        ("fk", {"q": [0, 0], "frames": [f"f{k}" for k in range(99_000)]}, "/frames/0"),
    ],
)
def test_numbers_and_lists_that_would_break_the_mathematics(client, path, body, pointer):
    check(client.post(f"/v1/robots/planar_2r/{path}", json=body), 422, pointer)


def test_time_budget_of_nothing_and_doubled_frames_are_answered(client):
    body = {"target": {"position": [1, 0]}, "task": "xy", "time_budget_ms": 0}
    assert client.post(IK, json=body).json()["status"] in ("timeout", "converged")
    answer = client.post(FK, json={"q": [0, 0], "frames": ["tool"] * 99_000}).json()
    assert list(answer["poses"]) == ["tool"]


def test_singularity_reports_are_left_to_a_thread():
    """Milliseconds each: in the event loop, eight at a time would hold up /health/live."""
    robot, request = shipped_robot("puma560"), SINGULARITY.request(q=np.zeros(6))
    assert SINGULARITY.run_at_once(robot, request, None) is None
