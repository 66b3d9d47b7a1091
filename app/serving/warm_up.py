"""What the first request would otherwise wait for, done before there is one."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import Any

import msgspec
from anyio.to_thread import run_sync
from fastapi import FastAPI

from app.access.refusal import CALLER, ITSELF
from app.dependencies import Services
from app.http.negotiation import JSON
from app.operations import Operation
from app.telemetry.observed import REHEARSAL
from kinematics.warm import warm_up_on
from robots.shipped import shipped_ids

ROUNDS = 10
"""After some calls of a function, Python has specialised its code."""


async def rehearse(app: FastAPI, services: Services, operations: Iterable[Operation]) -> None:
    """Loads the whole library, computes with each robot once, and sends examples as requests."""
    for robot_id in shipped_ids():
        stored = await run_sync(services.store.get, robot_id)
        await run_sync(warm_up_on, stored.robot)
    for operation in operations:
        if operation.needs is None:
            path = f"/v1/robots/{operation.example_robot}/{operation.name}"
            for _ in range(ROUNDS):
                await _request(app, path, msgspec.json.encode(operation.example))


async def _request(app: FastAPI, path: str, body: bytes) -> None:
    headers = {"host": "localhost", "content-type": JSON, "content-length": str(len(body))}
    scope = {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": "POST",
        "scheme": "http",
        "path": path,
        "raw_path": path.encode(),
        "root_path": "",
        "query_string": b"",
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
        "client": ("127.0.0.1", 0),
        "server": ("localhost", 80),
        "state": {},
        REHEARSAL: True,
        CALLER: ITSELF,
    }

    received = False

    async def receive() -> dict[str, Any]:
        nonlocal received
        if received:
            await asyncio.Event().wait()  # this client stays
        received = True
        return {"type": "http.request", "body": body, "more_body": False}

    async def send(message: Any) -> None:
        # 503: the machine is too busy at the moment, which is no fault of the example.
        if message["type"] == "http.response.start" and message["status"] not in (200, 503):
            raise RuntimeError(f"{path}: the example of the docs got {message['status']}")

    await app(scope, receive, send)
