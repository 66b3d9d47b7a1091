"""Pages of other origins, as a browser sends their requests."""

import json

import httpx
import pytest

from tests.app.access.requests import TABLE
from tests.conftest import PATIENCE

EVIL, OWN = "http://evil.example", "http://localhost:8000"


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": EVIL},
        {"Origin": "null"},
        {"Origin": "http://localhost:3000"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
        {"Origin": EVIL, "Sec-Fetch-Site": "cross-site"},
        {"Origin": OWN, "Sec-Fetch-Site": "cross-site"},
    ],
)
def test_a_foreign_page_changes_nothing(client, headers):
    before = client.get("/v1/robots?page_size=1000").json()
    for method, path in (
        ("POST", "/v1/robots"),
        ("POST", "/v1/robots/"),
        ("PUT", "/v1/robots/foreign"),
        ("PUT", "/v1/robots/foreign/meshes/a.stl"),
        ("DELETE", "/v1/robots/foreign"),
    ):
        wanted = {"Host": "localhost:8000", "Content-Type": "text/plain", **headers}
        body = json.dumps({"name": "foreign", **TABLE})
        refused = client.request(method, path, content=body, headers=wanted)
        assert refused.status_code == 403, (method, path)
        assert refused.json()["type"] == "/problems/cross-origin"
    assert client.get("/v1/robots?page_size=1000").json() == before


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Origin": OWN},
        {"Origin": OWN, "Sec-Fetch-Site": "same-origin"},
        {"Origin": "https://robots.example.org", "Sec-Fetch-Site": "same-origin"},
        {"Sec-Fetch-Site": "none"},
    ],
)
def test_programs_and_the_page_itself_do(client, headers):
    wanted = {"Host": "localhost:8000", **headers}
    put = client.put("/v1/robots/own-page", json=TABLE, headers=wanted)
    assert put.status_code in (200, 201)
    assert client.delete("/v1/robots/own-page", headers=wanted).status_code == 204


def test_a_foreign_page_may_compute(client):
    answer = client.post("/v1/fk", json={"robot": TABLE, "q": [0]}, headers={"Origin": EVIL})
    assert answer.status_code == 200


@pytest.mark.parametrize("origins", [f"http://a.example {EVIL}", "*"])
def test_origins_that_cors_allows_do_too(serve, origins):
    with serve(cors_origins=origins) as server:
        headers = {"Origin": EVIL, "Sec-Fetch-Site": "cross-site"}
        with httpx.Client(base_url=server.address, timeout=PATIENCE) as client:
            assert client.put("/v1/robots/allowed", json=TABLE, headers=headers).is_success
            other = {"Origin": "http://other.example", "Sec-Fetch-Site": "cross-site"}
            status = client.delete("/v1/robots/allowed", headers=other).status_code
            assert status == (204 if origins == "*" else 403)
