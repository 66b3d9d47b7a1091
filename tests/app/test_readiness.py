"""/health/ready: what is checked, what is wrong, and nothing of the server's own."""

import errno
import shutil

import httpx

from app import readiness
from app.readiness import Check, Readiness, WritableDirectory
from tests.conftest import PATIENCE

OK = Check(status="ok", detail="")


def test_what_fails_makes_unready_and_what_warns_does_not():
    checks = Readiness()
    assert checks.report().status == "unready"  # nothing has been checked yet
    checks.add("kernels", lambda: OK)
    assert checks.report().status == "ready"
    checks.add("robots", lambda: Check(status="warning", detail="1 damaged"))
    assert checks.report().status == "ready"
    checks.add("uploads", lambda: Check(status="failed", detail="no space"))
    report = checks.report()
    assert report.status == "unready"
    assert [check.status for check in report.checks.values()] == ["ok", "warning", "failed"]
    checks.add("uploads", lambda: OK)
    assert checks.report().status == "ready"
    checks.stop()
    assert checks.report().status == "stopping"


def test_a_check_that_fails_itself_has_failed_and_tells_no_secret():
    checks = Readiness()
    checks.add("broken", lambda: open("/nowhere/secret"))  # noqa: PTH123, SIM115
    report = checks.report()
    assert report.status == "unready"
    assert report.checks["broken"] == Check(
        status="failed", detail="the check failed: FileNotFoundError"
    )


def test_a_full_disk_is_seen_and_asked_once_a_second(tmp_path, monkeypatch):
    times, written = [0.0], []
    monkeypatch.setattr(readiness.time, "monotonic", lambda: times[0])

    def full(directory):
        written.append(directory)
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(readiness, "written_to", full)
    check = WritableDirectory(tmp_path)
    expected = Check(status="failed", detail="uploads cannot be written: No space left on device")
    assert [check(), check(), check()] == [expected] * 3
    assert len(written) == 1
    times[0] = 1.5
    monkeypatch.undo()
    monkeypatch.setattr(readiness.time, "monotonic", lambda: 1.5)
    assert check().status == "ok"
    assert not list(tmp_path.iterdir())


def test_a_server_whose_directory_goes_says_so(tmp_path, start_server, wait_for):
    data = tmp_path / "data"
    with start_server(data) as (address, _):
        answer = httpx.get(f"{address}/health/ready", timeout=PATIENCE)
        assert answer.json()["status"] == "ready"
        assert set(answer.json()["checks"]) >= {"kernels", "library", "uploads"}
        data.rename(tmp_path / "elsewhere")
        wait_for(lambda: httpx.get(f"{address}/health/ready", timeout=PATIENCE).status_code == 503)
        answer = httpx.get(f"{address}/health/ready", timeout=PATIENCE)
        assert answer.json()["status"] == "unready"
        assert answer.json()["checks"]["uploads"] == {
            "status": "failed",
            "detail": "uploads cannot be written: No such file or directory",
        }
        assert str(tmp_path) not in answer.text
        assert httpx.get(f"{address}/health/live", timeout=PATIENCE).status_code == 200
        shutil.move(tmp_path / "elsewhere", data)
        wait_for(lambda: httpx.get(f"{address}/health/ready", timeout=PATIENCE).status_code == 200)
