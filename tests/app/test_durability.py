"""Damaged files, quotas and full disks as a client sees them: refused by name, never a crash."""

import os
import resource
import shutil

import httpx
import pytest

from tests.conftest import PATIENCE, running_server
from tests.scenes import one_scene
from tests.torture.disks import small_disk

TABLE = {"convention": "standard", "joints": [{"type": "R", "a": 1, "alpha": 0, "d": 0}]}
OVERWRITE = {"overwrite": "true"}
LARGE = {"convention": "standard", "joints": TABLE["joints"] * 60}


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    directory = tmp_path_factory.mktemp("durability")
    with (
        running_server(directory) as (address, _),
        httpx.Client(base_url=address, timeout=PATIENCE) as client,
    ):
        client.directory = directory
        yield client


def named_when_ready(client, name):
    """Whether a service that is ready names a robot as one that it cannot serve."""
    answer = client.get("/health/ready")
    assert answer.status_code == 200
    return f'"{name}"' in answer.text


def damage(path, kind):
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "directory":
        path.mkdir()
    else:
        path.write_text("{}")


@pytest.mark.parametrize("kind", one_scene(["json", "pipe", "directory"]))
def test_a_damaged_robot_is_refused_by_name_until_it_is_replaced_or_deleted(service, kind):
    path = "/v1/robots/dented-arm"
    file = service.directory / "robots" / "dented-arm.json"
    for mend in (lambda: service.put(path, json=TABLE), lambda: service.delete(path)):
        assert service.put(path, json=TABLE).status_code in (200, 201)
        damage(file, kind)
        for _ in range(2):
            for answer in (
                service.get(path),
                service.get(f"{path}/fk?q=0"),
                service.post("/v1/fk", json={"robot": "dented-arm", "q": [0]}),
            ):
                assert answer.status_code == 409
                assert answer.json()["type"] == "/problems/damaged-robot"
                assert "moved to quarantine; upload the robot again (PUT" in answer.text
                assert str(service.directory) not in answer.text
        assert service.post("/v1/robots", json=TABLE | {"name": "dented-arm"}).status_code == 409
        assert named_when_ready(service, "dented-arm")
        listed = service.get("/v1/robots?page_size=1000")
        assert listed.status_code == 200
        assert "dented-arm" not in [line["id"] for line in listed.json()["robots"]]
        assert mend().status_code in (200, 204)
        assert not named_when_ready(service, "dented-arm")
    assert service.get(path).status_code == 404


def test_a_start_names_what_was_damaged_before(tmp_path, start_server):
    (tmp_path / "robots").mkdir()
    for name in ("dented-a", "dented-b"):
        (tmp_path / "robots" / f"{name}.json").write_text("damaged")
    (tmp_path / "robots" / ".c.tmp").write_text("half")
    with start_server(tmp_path) as (address, _):
        with httpx.Client(base_url=address, timeout=PATIENCE) as client:
            assert named_when_ready(client, "dented-a")
            assert named_when_ready(client, "dented-b")
        assert list((tmp_path / "robots").iterdir()) == []


def test_quotas_and_a_full_disk_refuse_uploads_only(tmp_path, start_server, monkeypatch):
    monkeypatch.setenv("DENAVIT_MAX_ROBOTS", "50")
    with (
        small_disk(tmp_path / "disk", size="280k") as directory,
        start_server(directory or tmp_path / "data") as (address, _),
        httpx.Client(base_url=address, timeout=PATIENCE) as client,
    ):
        for k in range(10):
            assert client.put(f"/v1/robots/r{k}", json=TABLE).status_code == 201
        if directory is not None:
            answers = [client.put(f"/v1/robots/l{k}", json=LARGE) for k in range(35)]
            assert {answer.status_code for answer in answers} == {201, 507}
            last = answers[-1]
            assert last.headers["content-type"] == "application/problem+json"
            assert "disk of the service is full" in last.json()["detail"]
            assert client.get("/v1/robots/r3/fk?q=0").status_code == 200
            assert client.get("/v1/robots/l34").status_code == 404
            for k in range(35):
                assert client.delete(f"/v1/robots/l{k}").status_code in (204, 404)
        answers = [client.put(f"/v1/robots/q{k}", json=TABLE) for k in range(41)]
        assert [answer.status_code for answer in answers] == [201] * 40 + [409]
        assert answers[-1].json()["type"] == "/problems/quota-reached"
        assert "DENAVIT_MAX_ROBOTS" in answers[-1].json()["detail"]
        assert client.put("/v1/robots/q0", json=TABLE).status_code == 200
        assert client.delete("/v1/robots/q0").status_code == 204
        assert client.put("/v1/robots/q40", json=TABLE).status_code == 201


def test_a_lock_that_cannot_be_had_refuses_uploads_and_says_when_to_come_back(service):
    path = "/v1/robots/kept"
    assert service.put(path, json=TABLE).status_code == 201
    lock = service.directory / "robots.lock"
    lock.unlink()
    lock.mkdir()
    answer = service.put(path, json=LARGE, params=OVERWRITE)
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "5")
    assert answer.json()["type"] == "/problems/storage-unavailable"
    assert service.get(path).json()["dof"] == 1
    lock.rmdir()
    assert service.put(path, json=LARGE, params=OVERWRITE).status_code == 200
    assert service.delete(path).status_code == 204


def test_a_directory_removed_under_the_service(service):
    path = "/v1/robots/gone"
    assert service.put(path, json=TABLE).status_code == 201
    shutil.rmtree(service.directory / "robots")
    assert service.get(path).status_code == 404
    assert service.get("/v1/robots").status_code == 200
    assert service.get("/health/ready").status_code == 200
    assert service.put(path, json=TABLE).status_code == 201
    assert service.delete(path).status_code == 204


def test_a_service_short_of_file_descriptors_answers_and_recovers(tmp_path, start_server):
    with start_server(tmp_path) as (address, process):
        client = httpx.Client(base_url=address, timeout=PATIENCE)
        with client:
            assert client.put("/v1/robots/arm", json=TABLE).status_code == 201
            pid = process.pid
            open_now = len(os.listdir(f"/proc/{pid}/fd"))  # noqa: PTH208
            limits = resource.prlimit(pid, resource.RLIMIT_NOFILE)
            resource.prlimit(pid, resource.RLIMIT_NOFILE, (open_now, limits[1]))
            answer = client.put("/v1/robots/new", json=TABLE)
            assert answer.status_code == 503
            assert "too many files open" in answer.json()["detail"]
            assert client.get("/v1/robots/pa10/fk?q=0,0,0,0,0,0,0").status_code == 200
            resource.prlimit(pid, resource.RLIMIT_NOFILE, limits)
            assert client.get("/v1/robots/arm").status_code == 200
            assert client.put("/v1/robots/new", json=TABLE).status_code == 201
            assert not named_when_ready(client, "arm")
