"""Keys with robots of their own, on real servers: every route looks into one namespace."""

import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from app.access.keys import Scope, new_key
from tests.app.access.requests import bearer
from tests.conftest import PATIENCE

SCRIPTS = Path(sys.executable).parent


def table(a):
    return {"convention": "standard", "joints": [{"type": "R", "a": a, "alpha": 0, "d": 0}]}


@contextmanager
def clients(serve, *names, arguments=(), **settings):
    """A service, and a client for each name; one whose name begins with share shares."""
    keys = {
        name: new_key(name, Scope.SHARE if name.startswith("share") else Scope.WRITE)
        for name in names
    }
    lines = ",".join(key.line for _, key in keys.values())
    with serve(*arguments, api_keys=lines, **settings) as server:
        found = [
            httpx.Client(base_url=server.address, headers=bearer(secret), timeout=PATIENCE)
            for secret, _ in keys.values()
        ]
        try:
            yield found
        finally:
            for client in found:
                client.close()


def x_of(client, robot="arm"):
    answer = client.get(f"/v1/robots/{robot}/fk", params={"q": 0})
    assert answer.status_code == 200, answer.text
    return answer.json()["poses"]["tool"]["position"][0]


def ids(client):
    return {one["id"] for one in client.get("/v1/robots?page_size=1000").json()["robots"]}


@pytest.mark.scene
def test_robots_of_one_key_are_not_seen_or_changed_by_another(serve):
    names = ("ada", "bob", "share-teacher")
    options = {"arguments": ("--workers", "2"), "namespaces": "true"}
    with clients(serve, *names, **options) as (ada, bob, teacher):
        made = [one.put("/v1/robots/arm", json=table(k + 1)) for k, one in enumerate((ada, bob))]
        assert [answer.status_code for answer in made] == [201, 201]
        assert {answer.headers["location"] for answer in made} == {"/v1/robots/arm"}
        for _ in range(4):
            assert (x_of(ada), x_of(bob)) == (1, 2)
        assert ada.put("/v1/robots/arm", json=table(3)).status_code == 200
        assert (x_of(ada), x_of(bob)) == (3, 2)
        tag = made[1].headers["etag"]
        assert bob.get("/v1/robots/arm", headers={"If-None-Match": tag}).status_code == 304
        assert ada.get("/v1/robots/arm", headers={"If-None-Match": tag}).status_code == 200

        assert ada.put("/v1/robots/only-ada", json=table(5)).status_code == 201
        assert "only-ada" in ids(ada)
        assert "only-ada" not in ids(bob) | ids(teacher)
        for method, path, body in other_routes("only-ada"):
            mine = ada.request(method, path, json=body)
            assert mine.status_code == 200, (path, mine.text)
            theirs = bob.request(method, path, json=body)
            assert theirs.status_code == 404, (path, theirs.text)
        assert bob.delete("/v1/robots/only-ada").status_code == 404
        look_alike = bob.put("/v1/robots/Only-Ada", json=table(1)).json()
        assert "only-ada" not in str(look_alike["warnings"])

        assert teacher.put("/v1/robots/arm", json=table(9)).status_code == 201
        assert (x_of(ada), x_of(bob), x_of(teacher)) == (3, 2, 9)
        assert teacher.put("/v1/robots/for-all", json=table(7)).status_code == 201
        assert x_of(ada, "for-all") == x_of(bob, "for-all") == 7
        refused = ada.delete("/v1/robots/for-all")
        assert (refused.status_code, refused.json()["type"]) == (403, "/problems/shared-robot")
        own = ada.put("/v1/robots/for-all", json=table(8))
        assert own.status_code == 201
        assert "shared robot" in str(own.json()["warnings"])
        assert (x_of(ada, "for-all"), x_of(bob, "for-all")) == (8, 7)
        assert ada.delete("/v1/robots/for-all").status_code == 204
        assert x_of(ada, "for-all") == 7


def other_routes(robot):
    """Every kind of route that takes a robot's id, in the path or in the body."""
    q = {"q": [0.1]}
    return [
        ("GET", f"/v1/robots/{robot}", None),
        ("GET", f"/v1/robots/{robot}/urdf", None),
        ("GET", f"/v1/robots/{robot}/dh?convention=modified", None),
        ("GET", f"/v1/robots/{robot}/meshes", None),
        ("GET", f"/v1/robots/{robot}/jacobian?q=0.1", None),
        ("POST", f"/v1/robots/{robot}/fk", q),
        ("POST", f"/v1/robots/{robot}/diff", {"other": robot}),
        ("POST", "/v1/robots/planar_2r/diff", {"other": robot}),
        ("POST", "/v1/diff", {"robot": robot, "other": robot}),
        ("POST", "/v1/fk", {"robot": robot, **q}),
        ("POST", f"/v1/robots/{robot}/ik", {"target": {"position": [5, 0, 0]}, "task": "position"}),
    ]


def test_what_was_stored_before_is_shared_and_quotas_are_told(serve):
    with clients(serve, "ada", "bob") as (ada, bob):
        assert ada.put("/v1/robots/old", json=table(4)).status_code == 201
        assert x_of(bob, "old") == 4
    settings = {"namespaces": "true", "max_namespace_robots": 2, "max_robots": 4}
    with clients(serve, "ada", "bob", **settings) as (ada, bob):
        assert x_of(ada, "old") == x_of(bob, "old") == 4
        assert ada.delete("/v1/robots/old").status_code == 403
        assert [ada.put(f"/v1/robots/r{k}", json=table(1)).status_code for k in (1, 2)] == [201] * 2
        refused = ada.put("/v1/robots/r3", json=table(1))
        assert refused.status_code == 409
        assert "DENAVIT_MAX_NAMESPACE_ROBOTS" in refused.json()["detail"]
        assert bob.put("/v1/robots/r1", json=table(1)).status_code == 201
        refused = bob.put("/v1/robots/r2", json=table(1))
        assert "(DENAVIT_MAX_ROBOTS)" in refused.json()["detail"]


def test_health_names_no_robot_of_a_namespace(serve, tmp_path):
    with clients(serve, "ada", namespaces="true") as (ada,):
        assert ada.put("/v1/robots/secret-name", json=table(4)).status_code == 201
        file = tmp_path / "data" / "namespaces" / "ada" / "robots" / "secret-name.json"
        file.write_bytes(file.read_bytes()[:-9])
        assert ada.get("/v1/robots/secret-name/urdf").status_code == 409
        check = ada.get("/health/ready").json()["checks"]["robots"]
        assert check["status"] == "warning"
        assert check["detail"].startswith("1 uploads are damaged")
        assert "secret-name" not in str(check)
        assert ada.put("/v1/robots/secret-name", json=table(4)).status_code in (200, 201)
        assert "\ndenavit_robots 1.0\n" in ada.get("/metrics").text


def test_namespaces_without_keys_stop_the_start(tmp_path):
    found = subprocess.run(
        [str(SCRIPTS / "denavit"), "serve", "--data-dir", str(tmp_path)],
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "DENAVIT_NAMESPACES": "true"},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert found.returncode == 1
    assert found.stderr.startswith("Error: DENAVIT_NAMESPACES")
    assert "denavit key" in found.stderr


def test_the_robots_of_a_namespace_are_listed_for_who_runs_the_service(serve, tmp_path):
    with clients(serve, "ada", namespaces="true") as (ada,):
        assert ada.put("/v1/robots/hers", json=table(4)).status_code == 201
    command = [str(SCRIPTS / "denavit"), "robots"]
    environment = {
        "PATH": "/usr/bin:/bin",
        "HOME": str(tmp_path),
        "DENAVIT_DATA_DIR": str(tmp_path / "data"),
    }
    for more, seen in (((), False), (("--namespace", "ada"), True), (("--namespace", "x"), False)):
        out = subprocess.run(
            [*command, *more], env=environment, capture_output=True, text=True, check=True
        )
        assert ("hers " in out.stdout) is seen
        assert "panda " in out.stdout
