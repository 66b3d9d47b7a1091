"""Machine code of the solvers: loaded at the start, or compiled while requests are answered."""

from __future__ import annotations

import asyncio
import gc
import logging
import subprocess
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass

from anyio.to_thread import run_sync
from fastapi import FastAPI

from app.dependencies import Services
from app.operations import Operation
from app.readiness import Check
from app.serving.warm_up import rehearse
from kinematics.kernel_cache import FOLDER, is_full, try_to_fill
from kinematics.warm import fill, warm_up

LOG = logging.getLogger("denavit.serving")
LOOK_SECONDS = 0.25
"""Between two looks at whether the cache is full."""
NICE = 10
"""How much lower the priority of the process that compiles is."""

_READY = Check(status="ok", detail="compiled")
_COMPILING = Check(
    status="warning",
    detail="being compiled, once, for about a minute: until then a request that needs one takes"
    " seconds longer",
)
_FAILED = Check(status="failed", detail="they cannot be compiled; the log says why")


@dataclass
class Kernels:
    """What ``/health/ready`` says of the machine code of this process."""

    check: Check = _COMPILING


@asynccontextmanager
async def loaded_kernels(
    app: FastAPI, services: Services, operations: Sequence[Operation]
) -> AsyncIterator[Kernels]:
    """Load the machine code before the first request, where the cache on disk is full.

    Where it is not, requests are answered from the start, and each compiles what it needs in its
    thread, while one child process of all workers fills the cache. Once it is full, this process
    loads from it what it has not compiled, and does the rest of the warm-up.
    """
    kernels = Kernels()
    if is_full():
        await _load(app, services, operations, kernels)
        yield kernels
        return
    beside = asyncio.create_task(_fill_and_load(app, services, operations, kernels))
    try:
        yield kernels
    finally:
        beside.cancel()
        await asyncio.wait([beside])


async def _fill_and_load(
    app: FastAPI, services: Services, operations: Sequence[Operation], kernels: Kernels
) -> None:
    try:
        await _filled()
        await _load(app, services, operations, kernels)
        LOG.info("all solvers are compiled")
    except Exception:
        kernels.check = _FAILED
        LOG.exception("the solvers cannot be compiled")


async def _filled() -> None:
    """Wait until the cache is full, or nothing else will fill it."""
    if FOLDER is None:
        return
    child: subprocess.Popen[bytes] | None = None
    try:
        while not is_full():
            if child is None:
                with try_to_fill() as lock:
                    # The child keeps the lock: other workers wait, and try where it ends early.
                    child = None if lock is None else fill("--nice", str(NICE), inherited=lock)
            elif child.poll() is not None:
                LOG.error("the process that compiles ended with status %d", child.returncode)
                return
            await asyncio.sleep(LOOK_SECONDS)
    finally:
        if child is not None:
            child.terminate()
            child.wait()


async def _load(
    app: FastAPI, services: Services, operations: Sequence[Operation], kernels: Kernels
) -> None:
    await run_sync(warm_up, abandon_on_cancel=True)
    if services.settings.preload:
        await rehearse(app, services, operations)
    # What is here now stays: no collection needs to walk through it while requests wait.
    gc.collect()
    gc.freeze()
    kernels.check = _READY
