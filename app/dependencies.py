"""What routes share: the services of one application, and robots by path or inline."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import Annotated, Any, TypeVar

import anyio
import msgspec
from anyio.to_thread import run_sync
from fastapi import Depends, Request

from app.documents import robot_from_inline
from app.problems import INVALID_REQUEST, RequestProblem
from app.settings import Settings
from app.wire import decode_json
from robots.robot import Robot
from robots.store import RobotStore, StoredRobot

T = TypeVar("T")
INLINE_ROBOTS = 128


class InlineRobots:
    """The last inline robots by content, so that a repeated table is not built again."""

    def __init__(self, size: int = INLINE_ROBOTS) -> None:
        self._size = size
        self._robots: OrderedDict[bytes, Robot] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, document: bytes) -> Robot:
        """The robot of a JSON document.

        Raises:
            DHError: Not a usable table.
            RobotError: Not a usable URDF.
            RequestProblem: Neither an object nor a name.
        """
        key = hashlib.sha256(document).digest()
        with self._lock:
            if key in self._robots:
                self._robots.move_to_end(key)
                return self._robots[key]
        data = decode_json(document, Any, "/robot")
        if not isinstance(data, dict):
            raise RequestProblem(
                INVALID_REQUEST, "robot is neither a table nor the id of a robot", "/robot"
            )
        robot = robot_from_inline(data)
        with self._lock:
            self._robots[key] = robot
            while len(self._robots) > self._size:
                self._robots.popitem(last=False)
        return robot


class Services:
    """What one application works with."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.store = RobotStore(settings.data_dir)
        self.inline = InlineRobots()
        self._limiter: anyio.CapacityLimiter | None = None

    async def in_thread(self, call: Callable[[], T]) -> T:
        """Runs a blocking call in one of the compute threads."""
        if self._limiter is None:
            self._limiter = anyio.CapacityLimiter(self.settings.compute_threads)
        return await run_sync(call, limiter=self._limiter)

    async def robot(self, robot_id: str) -> StoredRobot:
        """A robot by id; loaded in a thread where it is not in memory.

        Raises:
            RobotNotFound: No robot has this id.
        """
        loaded = self.store.in_memory(robot_id)
        if loaded is not None:
            return loaded
        return await self.in_thread(lambda: self.store.get(robot_id))

    async def inline_robot(self, raw: msgspec.Raw) -> Robot:
        """The robot of a body's ``robot`` field: a table, a URDF or an id.

        Raises:
            RobotNotFound: No robot has this id.
            DHError: Not a usable table.
        """
        document = bytes(raw)
        if document[:1] == b'"':
            return (await self.robot(decode_json(document, str, "/robot"))).robot
        return await self.in_thread(lambda: self.inline.get(document))


async def services_of(request: Request) -> Services:
    """The services of the application that serves a request."""
    services = request.app.state.services
    assert isinstance(services, Services)
    return services


ServicesDep = Annotated[Services, Depends(services_of)]


async def stored_robot(robot_id: str, services: ServicesDep) -> StoredRobot:
    """The robot that a path names."""
    return await services.robot(robot_id)


RobotDep = Annotated[StoredRobot, Depends(stored_robot)]
