"""The shipped configuration of nginx, with the service behind it under a prefix."""

import json
import os
import re
import shutil
import socket
import subprocess
from pathlib import Path

import httpx
import pytest

from tests.app.conftest import served
from tests.conftest import PATIENCE, until, unused_port

CONFIGURATION = Path(__file__).parents[2] / "deploy" / "nginx.conf"
ARM = {"convention": "standard", "joints": [{"type": "R", "a": 1, "alpha": 0, "d": 0}]}
pytestmark = pytest.mark.skipif(shutil.which("nginx") is None, reason="nginx is not installed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("nginx")


def nginx(folder, text, *options):
    """nginx with a configuration, in a folder that takes all it writes."""
    path = folder / "nginx.conf"
    paths = "".join(
        f"{name}_temp_path {folder}/{name};\n"
        for name in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    path.write_text(text.replace("http {\n", f"http {{\n{paths}"))
    options = ("-p", str(folder), "-c", str(path), "-e", str(folder / "error.log"), *options)
    user = "user root; " if os.geteuid() == 0 else ""  # else its workers may not write there
    return [shutil.which("nginx"), *options, "-g", f"{user}pid {folder}/pid; daemon off;"]


@pytest.mark.scene
def test_the_syntax_is_right(folder):
    command = nginx(folder, CONFIGURATION.read_text(), "-t")
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def behind(folder, tmp_path_factory):
    """A client of the service behind nginx, and the service."""
    settings = {"root_path": "/denavit", "body_seconds": 10 * PATIENCE}
    with served(tmp_path_factory.mktemp("service"), **settings) as server:
        address = server.address
        port = unused_port()
        text = CONFIGURATION.read_text()
        text = text.replace("listen 8080", f"listen 127.0.0.1:{port}")
        text = text.replace("127.0.0.1:8000", address.removeprefix("http://"))
        text, count = re.subn(r"client_(header|body)_timeout 10s", r"client_\1_timeout 1s", text)
        assert count == 2
        proxy = subprocess.Popen(nginx(folder, text), stdout=subprocess.DEVNULL)
        try:
            url = f"http://127.0.0.1:{port}/denavit"
            with httpx.Client(base_url=url, timeout=PATIENCE) as client:

                def answers():
                    try:
                        return client.get("/health/live").status_code == 200
                    except httpx.TransportError:
                        return False

                until(answers)
                yield client, server
        finally:
            proxy.terminate()
            proxy.wait(PATIENCE)


@pytest.fixture
def client(behind):
    return behind[0]


def test_computations(client):
    answer = client.get("/v1/robots/puma560/fk?q=0,0,0,0,0,0")
    assert answer.status_code == 200
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_links_carry_the_prefix(client):
    made = client.put("/v1/robots/mine", json=ARM)
    assert made.headers["location"] == "/denavit/v1/robots/mine"
    where = client.base_url.copy_with(path=made.headers["location"])
    assert client.get(where).json()["id"] == "mine"
    assert client.delete(where).status_code == 204
    problem = client.get("/v1/robots/none").json()
    assert problem["type"] == "/denavit/problems/robot-not-found"
    assert client.get(client.base_url.copy_with(path=problem["type"])).status_code == 200
    index = client.get("/").json()
    assert index["docs"] == f"{str(client.base_url).rstrip('/')}/docs"


def test_the_docs_and_what_they_load(client):
    page = client.get("/docs")
    assert page.status_code == 200
    links = re.findall(r'(?:src|href)="([^"]+)"', page.text)
    links += re.findall(r"url: '([^']+)'", page.text)
    assert len(links) >= 3
    for link in links:
        assert link.startswith("/denavit/"), link
        assert client.get(client.base_url.copy_with(path=link)).status_code == 200, link
    assert {"url": "/denavit"} in client.get("/openapi.json").json()["servers"]


def test_the_guide_and_what_it_links(client):
    for path in ("/guide", "/guide/operate", "/labs/fr", "/labs/fr/1-sixteen-steps"):
        page = client.get(path)
        links = set(re.findall(r'(?:src|href)="([^"#:]+)["#]', page.text))
        assert len(links) > 8
        for link in links:
            address = page.url.join(link)
            assert address.path.startswith("/denavit/"), link
            assert client.get(address).status_code == 200, link


def test_metrics_are_not_for_strangers(client):
    assert client.get("/metrics").status_code == 404


def test_what_the_proxy_refuses_is_a_problem_too(client):
    with socket.create_connection((client.base_url.host, client.base_url.port)) as connection:
        connection.sendall(
            b"POST /denavit/v1/fk HTTP/1.1\r\nHost: x\r\nContent-Length: 70000000\r\n\r\n"
        )
        head, _, body = connection.recv(65536).partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 413 ")
    assert b"Content-Type: application/problem+json" in head
    assert json.loads(body)["type"] == "/denavit/problems/too-large"


def test_slow_clients_are_cut_off_before_they_reach_the_service(client):
    host, port = client.base_url.host, client.base_url.port
    with socket.create_connection((host, port), timeout=PATIENCE) as slow:
        slow.sendall(b"POST /denavit/v1/fk HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\n{")
        while slow.recv(4096):
            pass


def test_streams_pass_line_by_line(behind):
    client, server = behind
    headers = {"Accept": "application/x-ndjson"}
    url = "/v1/robots/panda/endless"
    with client.stream("POST", url, json={"q": [0.1] * 7}, headers=headers) as answer:
        assert answer.status_code == 200, answer.read()
        lines = answer.iter_lines()
        # Its end is not written before the gate is open: what comes now was passed on at once.
        early = [json.loads(next(lines)) for _ in range(20)]
        assert early == [{"index": k} for k in range(20)]
        server.open_gate()
        *_, last = lines
    assert set(json.loads(last)) == {"last"}


def test_a_whole_path_passes_as_a_stream(client):
    body = {
        "q": [1.9, -0.25, -0.45, -0.5, -0.5, -0.35, 0, 0.2],
        "target": {"position": [1.15, -0.15]},
        "task": "xy",
        "obstacles": [{"type": "circle", "center": [0.73, 0.22], "radius": 0.08}],
        "method": "sqp",
        "samples": 2000,
    }
    headers = {"Accept": "application/x-ndjson"}
    with client.stream("POST", "/v1/robots/planar_8r/path", json=body, headers=headers) as answer:
        assert answer.status_code == 200, answer.read()
        assert len(list(answer.iter_lines())) >= 2000


def test_last_without_the_service_the_proxy_says_so(behind):
    client, server = behind
    server.process.terminate()
    server.process.wait(PATIENCE)
    answer = client.get("/v1/robots")
    assert answer.status_code == 503
    assert answer.headers["retry-after"] == "5"
    assert answer.json()["status"] == 503
