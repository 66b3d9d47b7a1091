"""A service whose kernels are not compiled yet: what it answers, and how they come."""

import asyncio
import logging
import subprocess
import sys
import threading

import httpx
import pytest

from app.main import create_app
from app.serving import kernels
from app.settings import Settings

Q = [0.1, 0.2, -0.3, 0.4, 0.5, 0.6]
FK = "/v1/robots/puma560/fk"


def readiness(app) -> dict:
    return {name: check.status for name, check in app.state.readiness.report().checks.items()}


def run_cold(tmp_path, monkeypatch, command, meanwhile):
    """Runs an application that finds its cache empty, with another process that fills it."""
    started = []

    def fill(*options, inherited=None):
        started.append(subprocess.Popen([sys.executable, "-c", command], pass_fds=[inherited]))
        return started[0]

    monkeypatch.setattr(kernels, "fill", fill)
    monkeypatch.setattr(kernels, "LOOK_SECONDS", 0.01)

    async def run():
        app = create_app(Settings(data_dir=tmp_path, preload=False))
        async with app.router.lifespan_context(app):
            await until(lambda: started)
            await meanwhile(app)
        return started

    return asyncio.run(run())


async def until(condition):
    async with asyncio.timeout(120):
        while not condition():
            await asyncio.sleep(0.01)


def test_the_service_is_ready_while_they_are_compiled_and_says_so(tmp_path, monkeypatch):
    full = threading.Event()
    monkeypatch.setattr(kernels, "is_full", full.is_set)

    async def meanwhile(app):
        assert app.state.readiness.report().status == "ready"
        assert readiness(app)["kernels"] == "warning"
        full.set()
        await until(lambda: readiness(app)["kernels"] == "ok")

    (child,) = run_cold(tmp_path, monkeypatch, "import time; time.sleep(600)", meanwhile)
    assert child.returncode is not None, "the process that compiles outlives its service"


def test_a_service_that_stops_ends_the_process_that_compiles(tmp_path, monkeypatch):
    monkeypatch.setattr(kernels, "is_full", lambda: False)

    async def meanwhile(app):
        assert readiness(app)["kernels"] == "warning"

    (child,) = run_cold(tmp_path, monkeypatch, "import time; time.sleep(600)", meanwhile)
    assert child.returncode == -15


def test_where_that_process_fails_the_service_compiles_itself(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(kernels, "is_full", lambda: False)

    async def meanwhile(app):
        await until(lambda: readiness(app)["kernels"] == "ok")

    with caplog.at_level(logging.INFO, "denavit.serving"):
        run_cold(tmp_path, monkeypatch, "raise SystemExit(3)", meanwhile)
    assert "the process that compiles ended with status 3" in caplog.text


def test_what_cannot_be_compiled_makes_the_service_unready(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(kernels, "is_full", lambda: False)

    def broken():
        raise RuntimeError("no compiler")

    monkeypatch.setattr(kernels, "warm_up", broken)

    async def meanwhile(app):
        await until(lambda: readiness(app)["kernels"] == "failed")
        assert app.state.readiness.report().status == "unready"

    run_cold(tmp_path, monkeypatch, "raise SystemExit(3)", meanwhile)
    assert "no compiler" in caplog.text


@pytest.mark.slow
def test_a_first_service_answers_at_once_and_correctly(
    tmp_path, start_server, server, wait_for, monkeypatch
):
    """With an empty cache: poses at once, also while others compile; everything else in time."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))
    with start_server(tmp_path / "data", "--workers", "2") as (address, _):
        check = httpx.get(f"{address}/health/ready").json()["checks"]["kernels"]
        assert check["status"] == "warning"
        pose = httpx.post(f"{server}{FK}", json={"q": Q}).json()["poses"]["tool"]
        target = {"target": {"matrix": pose["matrix"]}, "time_budget_ms": 100}
        order, answers = [], {}

        def solve():
            answers["ik"] = httpx.post(
                f"{address}/v1/robots/puma560/ik", json=target, timeout=900
            ).json()
            order.append("ik")

        solving = threading.Thread(target=solve)
        solving.start()
        for _ in range(20):
            found = httpx.post(f"{address}{FK}", json={"q": Q}, timeout=60).json()
            assert found["poses"]["tool"] == pose
        order.append("fk")
        solving.join()
        assert order == ["fk", "ik"], "a pose waited for a compiler"
        # Compiled or not: the same answer, and its time is that of the solve.
        expected = httpx.post(f"{server}/v1/robots/puma560/ik", json=target).json()
        assert answers["ik"] | {"elapsed_ms": 0} == expected | {"elapsed_ms": 0}
        assert answers["ik"]["status"] == "converged"

        def compiled():
            said = httpx.get(f"{address}/health/ready").json()["checks"]["kernels"]["status"]
            return said == "ok"

        wait_for(compiled)
    with start_server(tmp_path / "data") as (address, _):
        assert httpx.get(f"{address}/health/ready").json()["checks"]["kernels"]["status"] == "ok"
