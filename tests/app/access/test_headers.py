"""CORS, and the headers of every answer."""

import httpx
import pytest

from app.access.keys import Scope, new_key
from tests.app.access.requests import FK
from tests.conftest import PATIENCE


def test_other_origins_are_shut_out_by_default(client):
    headers = {"Origin": "https://example.org", "Access-Control-Request-Method": "POST"}
    for answer in (client.get(FK, headers=headers), client.options("/v1/fk", headers=headers)):
        assert not [name for name in answer.headers if name.startswith("access-control")]


def test_named_origins_may_use_the_api_also_where_it_is_refused(serve):
    _, key = new_key("a", Scope.READ)
    settings = {"cors_origins": "https://lab.example.org", "api_keys": key.line}
    with (
        serve(**settings) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        origin = {"Origin": "https://lab.example.org"}
        wanted = {
            "Access-Control-Request-Method": "POST",
            "Access-Control-Request-Headers": "content-type, authorization",
        }
        flight = client.options("/v1/fk", headers={**origin, **wanted})
        assert flight.status_code == 200
        assert flight.headers["access-control-allow-origin"] == origin["Origin"]
        refused = client.get(FK, headers=origin)
        assert refused.status_code == 401
        assert refused.headers["access-control-allow-origin"] == origin["Origin"]
        assert "retry-after" in refused.headers["access-control-expose-headers"].lower()
        other = client.get(FK, headers={"Origin": "https://evil.example.org"})
        assert "access-control-allow-origin" not in other.headers


@pytest.mark.parametrize(
    "path",
    [
        FK,
        "/",
        "/nothing",
        "/docs",
        "/openapi.json",
        "/health/live",
        "/guide",
        "/labs/fr/4-jacobian",
        "/v1/robots",
        FK + "&format=text",
    ],
)
def test_every_answer_has_safe_headers(client, path):
    headers = client.get(path).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"]
    assert "default-src 'none'" in headers["content-security-policy"]
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert headers["x-frame-options"] == "DENY"
    assert headers["cross-origin-opener-policy"] == "same-origin"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    assert "server" not in headers


@pytest.mark.parametrize(
    ("origins", "policy"), [("https://lab.example.org", "same-origin"), ("*", "cross-origin")]
)
def test_answers_are_embedded_where_all_may_read_them(serve, origins, policy):
    with serve(cors_origins=origins) as server:
        answer = httpx.get(server.address + FK, timeout=PATIENCE)
        assert answer.headers["cross-origin-resource-policy"] == policy


@pytest.mark.scene
def test_the_docs_run_their_own_scripts_only(client):
    page = client.get("/docs")
    policy = page.headers["content-security-policy"]
    script = policy.partition("script-src")[2].partition(";")[0]
    assert "'self'" in script
    assert "'sha256-" in script
    assert "unsafe" not in script
