"""Keys, rate limits, CORS and the headers of every answer, on real servers."""

import os
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from app.access.keys import InvalidKeys, Scope, new_key, read_keys
from app.access.rates import BoundedMemory, InvalidRate, RateLimits, network_of
from tests.conftest import PATIENCE

SCRIPTS = Path(sys.executable).parent
FK = "/v1/robots/panda/fk?q=0,0,0,0,0,0,0"
TABLE = {"convention": "standard", "joints": [{"type": "R", "a": 1, "alpha": 0, "d": 0}]}


def bearer(secret: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {secret}"}


def test_keys_open_what_their_scope_says(serve, tmp_path):
    reader, read_key = new_key("reader", Scope.READ)
    writer, write_key = new_key("writer", Scope.WRITE)
    file = tmp_path / "keys"
    file.write_text(f"# keys of the lab\n{write_key.line}  # Ada\n\n")
    with (
        serve("--workers", "2", api_keys=read_key.line, api_keys_file=file) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        nobody = client.get(FK)
        assert nobody.status_code == 401
        assert nobody.headers["www-authenticate"] == 'Bearer realm="denavit"'
        assert nobody.headers["content-type"] == "application/problem+json"
        assert nobody.json()["request_id"] == nobody.headers["x-request-id"]
        for wrong in (bearer("dnv_wrong"), {"X-API-Key": ""}, bearer(read_key.digest.hex())):
            answer = client.get(FK, headers=wrong)
            assert answer.status_code == 401
            assert 'error="invalid_token"' in answer.headers["www-authenticate"]
        assert client.get(FK, headers={"Authorization": "Basic eDp5"}).status_code == 401
        for headers in (bearer(reader), bearer(writer), {"X-API-Key": reader},
                        {"authorization": f"bearer {reader}"}):  # fmt: skip
            assert client.get(FK, headers=headers).status_code == 200
            inline = {"robot": TABLE, "q": [0]}
            assert client.post("/v1/fk", json=inline, headers=headers).status_code == 200
        for method, path in (("PUT", "/v1/robots/a"), ("POST", "/v1/robots"),
                             ("POST", "/v1/robots/"), ("DELETE", "/v1/robots/a")):  # fmt: skip
            refused = client.request(method, path, json=TABLE, headers=bearer(reader))
            assert refused.status_code == 403, path
            assert 'scope="write"' in refused.headers["www-authenticate"]
        put = client.put("/v1/robots/a", json=TABLE, headers=bearer(writer))
        assert put.status_code == 201
        assert client.delete("/v1/robots/a", headers=bearer(writer)).status_code == 204
        pages = ("/docs", "/openapi.json", "/guide", "/guide/settings", "/guide/guide.css")
        for path in ("/", "/health/live", "/health/ready", *pages):
            assert client.get(path).status_code == 200, path
        document = client.get("/openapi.json").json()
        assert set(document["components"]["securitySchemes"]) == {"bearer", "apiKey"}
        assert document["paths"]["/v1/robots"]["get"]["security"]
        assert "security" not in document["paths"]["/health/live"]["get"]
        assert "private" in client.get(FK, headers=bearer(reader)).headers["cache-control"]


def test_every_route_that_stores_needs_a_key_that_writes(serve):
    secret, key = new_key("reader", Scope.READ)
    with (
        serve(api_keys=key.line) as server,
        httpx.Client(base_url=server.address, headers=bearer(secret), timeout=PATIENCE) as client,
    ):
        before = client.get("/v1/robots?page_size=1000").json()
        paths = client.get("/openapi.json").json()["paths"]
        for path, item in paths.items():
            for method in item:
                if method != "get":
                    url = path.replace("{robot_id}", "panda")
                    client.request(method, url, json=TABLE | {"name": "stored"})
        assert client.get("/v1/robots?page_size=1000").json() == before


def test_without_keys_none_is_needed_and_the_docs_say_nothing_of_them(client):
    assert client.get(FK).status_code == 200
    document = client.get("/openapi.json").json()
    assert "securitySchemes" not in document["components"]
    assert "503" in document["paths"]["/v1/robots/{robot_id}/fk"]["post"]["responses"]


def test_the_command_makes_keys_that_work(serve):
    command = [str(SCRIPTS / "denavit"), "key", "--name", "lab", "--scope", "write"]
    out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    secret, line = (one.rsplit(" ", 1)[1] for one in out.splitlines())
    assert secret not in line
    with serve(api_keys=line) as server:
        answer = httpx.put(
            f"{server.address}/v1/robots/a", json=TABLE, headers=bearer(secret), timeout=PATIENCE
        )
        assert answer.status_code == 201


@pytest.mark.parametrize(
    ("name", "value"),
    [("API_KEYS", "secret-password"), ("API_KEYS_FILE", "/nowhere/keys"), ("RATE_LIMIT", "often")],
)
def test_wrong_settings_stop_the_start_and_are_not_repeated(name, value, tmp_path):
    found = subprocess.run(
        [str(SCRIPTS / "denavit"), "serve", "--data-dir", str(tmp_path)],
        env={**os.environ, f"DENAVIT_{name}": value},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert found.returncode == 1
    assert found.stderr.startswith(f"Error: DENAVIT_{name}")
    assert "secret-password" not in found.stderr


def test_hash_lines_are_strict():
    _, key = new_key("a", Scope.READ)
    assert read_keys(f"{key.line}, {new_key('b', Scope.WRITE)[1].line}")
    assert not read_keys(" ,\n")
    for text in (key.line[:-1], key.line.upper(), f"{key.line},{key.line}", "a:admin:" + "0" * 64):
        with pytest.raises(InvalidKeys):
            read_keys(text)
    with pytest.raises(InvalidKeys):
        new_key("a:b", Scope.READ)


def test_who_asks_too_often_is_told_when_to_come_back(serve):
    with (
        serve(rate_limit="5/minute") as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        answers = [client.get(FK) for _ in range(8)]
        assert [answer.status_code for answer in answers] == [200] * 5 + [429] * 3
        left = [int(answer.headers["ratelimit-remaining"]) for answer in answers]
        assert left == [4, 3, 2, 1, 0, 0, 0, 0]
        last = answers[-1]
        assert last.headers["ratelimit-limit"] == "5"
        assert 1 <= int(last.headers["retry-after"]) <= 60
        assert last.json()["type"] == "/problems/too-many-requests"
        assert client.get("/health/live").status_code == 200
        # Nobody is trusted to say who asks.
        forged = client.get(FK, headers={"X-Forwarded-For": "203.0.113.7"})
        assert forged.status_code == 429


def test_behind_a_trusted_proxy_the_clients_are_counted(serve):
    settings = {"rate_limit": "2/minute", "trusted_proxies": "127.0.0.1"}
    with (
        serve(**settings) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):

        def status(forwarded: str) -> int:
            return client.get(FK, headers={"X-Forwarded-For": forwarded}).status_code

        assert [status("203.0.113.7") for _ in range(3)] == [200, 200, 429]
        assert [status(f"2001:db8::{k}") for k in range(1, 4)] == [200, 200, 429]
        assert status("2001:db8:0:1::1") == 200
        assert status("10.9.8.7, 203.0.113.7") == 429, "what the client itself wrote counts not"


def test_keys_have_limits_of_their_own(serve):
    (one, first), (two, second) = new_key("one", Scope.READ), new_key("two", Scope.READ)
    settings = {"rate_limit": "2/minute", "api_keys": f"{first.line},{second.line}"}
    with (
        serve(**settings) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        for secret in (one, two):
            statuses = [client.get(FK, headers=bearer(secret)).status_code for _ in range(3)]
            assert statuses == [200, 200, 429]
        guesses = [client.get(FK, headers=bearer(f"dnv_{k}")).status_code for k in range(3)]
        assert guesses == [401, 401, 429]


def test_memory_of_counters_is_bounded():
    memory = BoundedMemory(1000)
    for k in range(5000):
        assert memory.incr(f"client {k}", 60) == 1
    assert len(memory) == 1000
    assert memory.incr("client 4999", 60) == 2
    assert memory.get("client 0") == 0


def test_rates_are_read_or_refused():
    limits = RateLimits("2/hour; 3/day")
    assert [limits.count("a").allowed for _ in range(3)] == [True, True, False]
    for text in ("often", "600", "0/minute", "-1/minute"):
        with pytest.raises(InvalidRate):
            RateLimits(text)


@pytest.mark.parametrize(
    ("host", "network"),
    [("203.0.113.7", "203.0.113.7"), ("2001:db8:1:2:3::4", "2001:db8:1:2::"),
     ("::ffff:203.0.113.7", "203.0.113.7"), ("fe80::1%eth0", "fe80::"), ("testclient", "unknown")],
)  # fmt: skip
def test_addresses_are_grouped(host, network):
    assert network_of(host) == network


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
        wanted = {"Access-Control-Request-Method": "POST",
                  "Access-Control-Request-Headers": "content-type, authorization"}  # fmt: skip
        flight = client.options("/v1/fk", headers={**origin, **wanted})
        assert flight.status_code == 200
        assert flight.headers["access-control-allow-origin"] == origin["Origin"]
        refused = client.get(FK, headers=origin)
        assert refused.status_code == 401
        assert refused.headers["access-control-allow-origin"] == origin["Origin"]
        assert "retry-after" in refused.headers["access-control-expose-headers"].lower()
        other = client.get(FK, headers={"Origin": "https://evil.example.org"})
        assert "access-control-allow-origin" not in other.headers


@pytest.mark.parametrize("path", [FK, "/", "/nothing", "/docs", "/openapi.json", "/health/live",
                                  "/guide", "/v1/robots", FK + "&format=text"])  # fmt: skip
def test_every_answer_has_safe_headers(client, path):
    headers = client.get(path).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cache-control"]
    assert "default-src 'none'" in headers["content-security-policy"]
    assert "frame-ancestors" in headers["content-security-policy"]
    assert "server" not in headers


def test_the_docs_run_their_own_scripts_only(client):
    page = client.get("/docs")
    policy = page.headers["content-security-policy"]
    script = policy.partition("script-src")[2].partition(";")[0]
    assert "'self'" in script
    assert "'sha256-" in script
    assert "unsafe" not in script
