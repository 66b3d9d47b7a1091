"""Keys, on real servers."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

from app.access.keys import InvalidKeys, KeySource, Scope, new_key, read_keys
from tests.app.access.requests import FK, TABLE, bearer
from tests.conftest import PATIENCE, until

SCRIPTS = Path(sys.executable).parent


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
        for headers in (
            bearer(reader),
            bearer(writer),
            {"X-API-Key": reader},
            {"authorization": f"bearer {reader}"},
        ):
            assert client.get(FK, headers=headers).status_code == 200
            inline = {"robot": TABLE, "q": [0]}
            assert client.post("/v1/fk", json=inline, headers=headers).status_code == 200
        for method, path in (
            ("PUT", "/v1/robots/a"),
            ("POST", "/v1/robots"),
            ("POST", "/v1/robots/"),
            ("DELETE", "/v1/robots/a"),
        ):
            refused = client.request(method, path, json=TABLE, headers=bearer(reader))
            assert refused.status_code == 403, path
            assert 'scope="write"' in refused.headers["www-authenticate"]
        put = client.put("/v1/robots/a", json=TABLE, headers=bearer(writer))
        assert put.status_code == 201
        assert client.delete("/v1/robots/a", headers=bearer(writer)).status_code == 204
        pages = ("/docs", "/openapi.json", "/guide", "/guide/settings", "/labs/en", "/labs/fr")
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


@pytest.mark.scene
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


def test_hash_lines_are_strict():
    _, key = new_key("a", Scope.READ)
    assert read_keys(f"{key.line}, {new_key('b', Scope.WRITE)[1].line}")
    assert not read_keys(" ,\n")
    for text in (key.line[:-1], key.line.upper(), f"{key.line},{key.line}", "a:admin:" + "0" * 64):
        with pytest.raises(InvalidKeys):
            read_keys(text)
    with pytest.raises(InvalidKeys):
        new_key("a:b", Scope.READ)


def test_a_key_is_revoked_while_the_service_runs(serve, tmp_path):
    ada, ada_key = new_key("ada", Scope.READ)
    bob, bob_key = new_key("bob", Scope.READ)
    file = tmp_path / "keys"
    file.write_text(f"{ada_key.line}\n{bob_key.line}\n")

    def status(server, secret):
        answer = httpx.get(f"{server.address}{FK}", headers=bearer(secret), timeout=PATIENCE)
        return answer.status_code

    with serve("--workers", "2", api_keys_file=file) as server:
        assert [status(server, one) for one in (ada, bob)] == [200, 200]
        file.write_text(f"{bob_key.line}\n")
        until(lambda: {status(server, ada) for _ in range(8)} == {401})
        assert status(server, bob) == 200
        file.write_text("what is no key\n")  # keeps what was known
        time.sleep(3)
        assert {status(server, bob) for _ in range(8)} == {200}
        file.write_text("")  # nobody is let in, instead of everybody
        until(lambda: {status(server, bob) for _ in range(8)} == {401})


def test_keys_are_read_again_on_a_hangup(tmp_path):
    _, key = new_key("ada", Scope.READ)
    file = tmp_path / "keys"
    file.write_text(f"{key.line}\n")
    source = KeySource("", file)
    secret, other = new_key("bob", Scope.READ)
    file.write_text(f"{other.line}\n")
    source.read_again()
    assert source.find(secret.encode()) == other


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_hangup_leaves_the_service_running(serve, tmp_path, workers):
    secret, key = new_key("ada", Scope.READ)
    file = tmp_path / "keys"
    file.write_text(f"{key.line}\n")
    with serve("--workers", workers, api_keys_file=file) as server:
        os.kill(server.pid, signal.SIGHUP)
        time.sleep(1)
        answer = httpx.get(f"{server.address}{FK}", headers=bearer(secret), timeout=PATIENCE)
        assert answer.status_code == 200
        assert server.process.poll() is None


def test_two_different_keys_in_one_request_are_refused(serve):
    secret, key = new_key("ada", Scope.READ)
    with serve(api_keys=key.line) as server:
        for headers, status in (
            ({"Authorization": f"Bearer {secret}", "X-API-Key": "dnv_other"}, 400),
            ({"Authorization": "Bearer dnv_other", "X-API-Key": secret}, 400),
            ({"Authorization": f"Bearer {secret}", "X-API-Key": secret}, 200),
        ):
            answer = httpx.get(f"{server.address}{FK}", headers=headers, timeout=PATIENCE)
            assert answer.status_code == status


def test_a_file_that_is_emptied_leaves_the_document_of_the_api_readable(serve, tmp_path):
    _, key = new_key("ada", Scope.READ)
    file = tmp_path / "keys"
    file.write_text(f"{key.line}\n")
    with serve(api_keys_file=file) as server:
        file.write_text("")
        answer = httpx.get(f"{server.address}/openapi.json", timeout=PATIENCE)
        assert answer.status_code == 200
        assert "securitySchemes" in answer.json()["components"]
