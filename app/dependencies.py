"""What routes share: the services of one application, and robots by path or inline."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Annotated, Any, TypeVar

import msgspec
from fastapi import Depends, Request

from app.access.control import key_of
from app.access.keys import Scope
from app.admission.memory import SMALL_BODY, Memory
from app.admission.need import Need, document_need
from app.admission.thread_pool import ThreadPool, while_connected
from app.documents import robot_from_inline
from app.http.problems import INVALID_REQUEST, TOO_LARGE, RequestProblem
from app.http.strict_json import decode_json, refuse_doubled_keys
from app.settings import Settings
from dh_to_urdf.messages import say
from kinematics.meshes.preparation import MeshReader
from kinematics.processes.pool import ProcessPool
from kinematics.redundancy.methods.whole_path import WORKER
from kinematics.symbolic import SymbolicWorkers
from robots.namespaces import Namespaces
from robots.robot import Robot
from robots.storage.usage_record import Quotas
from robots.store import RobotStore
from robots.stored_robot import StoredRobot
from robots.writer import Writer

T = TypeVar("T")
INLINE_WEIGHT = 20_000
"""Bound on the sum of dof² of inline robots in memory; a working memory grows with its square."""
LOADING_THREADS = 4
IDLE_PROCESSES = 1
"""Processes for whole paths that wait for the next."""
STORING_THREADS = 8
WAITING_UPLOADS = 4
"""Uploads of meshes that wait for the process that reads them; more get 503."""
CHECKED_AT_START = 0.5
"""Seconds for which a start waits for the check of the uploads, which then goes on beside."""
WAITING_THREADS = 8
"""Beside one for each symbolic worker: for those that wait for it, and for known answers."""


class InlineRobots:
    """The last inline robots by content, so that a repeated table is not built again."""

    def __init__(self, weight: int = INLINE_WEIGHT) -> None:
        self._weight = weight
        self._robots: OrderedDict[bytes, Robot] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, document: bytes) -> Robot:
        """The robot of a JSON document.

        Raises:
            DHError: Not a usable table.
            RobotError: Not a usable URDF.
            RequestProblem: Neither an object nor a name.
        """
        found = self.known(document)
        if found is not None:
            return found
        data = decode_json(document, Any, "/robot")
        refuse_doubled_keys(document, "/robot")
        if not isinstance(data, dict):
            raise RequestProblem(
                INVALID_REQUEST,
                say("{field} is neither a table nor the id of a robot", field="robot"),
                "/robot",
            )
        robot = robot_from_inline(data)
        with self._lock:
            self._robots[hashlib.sha256(document).digest()] = robot
            weight = sum(one.dof**2 for one in self._robots.values())
            while weight > self._weight and len(self._robots) > 1:
                _, dropped = self._robots.popitem(last=False)
                weight -= dropped.dof**2
        return robot

    def known(self, document: bytes) -> Robot | None:
        """The robot of a JSON document if it is in memory."""
        key = hashlib.sha256(document).digest()
        with self._lock:
            if key in self._robots:
                self._robots.move_to_end(key)
            return self._robots.get(key)


class Services:
    """What one application works with."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        total = Quotas(settings.max_robots, settings.max_stored_bytes)
        each = Quotas(settings.max_namespace_robots, settings.max_namespace_bytes, "namespace")
        self.namespaces = (
            Namespaces(settings.data_dir, total, each) if settings.namespaces else None
        )
        self.store = (
            self.namespaces.shared if self.namespaces else RobotStore(settings.data_dir, total)
        )
        self.inline = InlineRobots()
        self.symbolic = SymbolicWorkers(settings.symbolic_workers)
        self.programs = ProcessPool(WORKER, settings.compute_threads, idle=IDLE_PROCESSES)
        self.meshes = MeshReader(
            settings.max_mesh_bytes, settings.request_bytes // 2, WAITING_UPLOADS
        )
        self._stopping = threading.Event()
        self.memory = Memory(settings.request_bytes, settings.max_wait_seconds)
        queue = settings.max_waiting, settings.max_wait_seconds
        self.compute = ThreadPool("compute", settings.compute_threads, *queue)
        self.load = ThreadPool("load", LOADING_THREADS, *queue)
        self.writing = ThreadPool("writing", STORING_THREADS, *queue)
        self.out_of_process = ThreadPool(
            "out_of_process", settings.symbolic_workers + WAITING_THREADS, *queue
        )

    def close(self) -> None:
        """Ends what still runs, and what goes on besides requests."""
        self._stopping.set()
        for pool in (self.compute, self.load, self.writing, self.out_of_process):
            pool.close()
        self.symbolic.close()
        self.programs.close()
        self.meshes.close()

    async def computed(self, call: Callable[[], T], request: Request, size: int = 0) -> T:
        """Runs a computation in one of the compute threads, as long as the client is there.

        Args:
            call: The computation.
            request: For whom.
            size: Bytes of a document that it reads.

        Raises:
            RequestProblem: 503, too many are at work or wait; 413, there is too little memory.
            Cancelled: The client went away.
        """
        seconds = self.settings.max_request_seconds
        async with (
            self.compute.admission(seconds) as admission,
            while_connected(request, admission),
            self._read(size),
        ):
            return await admission.run(call)

    async def loaded(self, call: Callable[[], T], size: int = 0, beside: int = 0) -> T:
        """Reads robots in a thread: a pool of its own, not held up by computations.

        Args:
            call: What reads.
            size: Bytes of a document that it reads.
            beside: Bytes that this takes whatever the size of the document.

        Raises:
            RequestProblem: 503, too many are at work or wait; 413, there is too little memory.
        """
        async with self._read(size, beside):
            return await self.load.run(call)

    @asynccontextmanager
    async def _read(self, size: int, beside: int = 0) -> AsyncIterator[None]:
        """Holds the memory that reading a document takes."""
        reservation = self.memory.reservation(size)
        try:
            if size > SMALL_BODY or beside:
                await reservation.grow(document_need(size, beside))
            yield
        finally:
            reservation.end()

    async def mesh_read(self, call: Callable[[], T], request: Request, size: int) -> T:
        """Reads meshes in the process for them, as long as the client is there.

        Args:
            call: What has them read, and waits for it.
            request: For whom.
            size: Bytes of the files.

        Raises:
            RequestProblem: 503, too many are at work or wait; 413, there is too little memory.
            Cancelled: The client went away.
        """
        need = Need(0.0, fixed=self.meshes.memory(size), of=say("bytes in a body"), argument="")
        reservation = self.memory.reservation(size)
        async with (
            self.out_of_process.admission(self.settings.max_request_seconds) as admission,
            while_connected(request, admission),
        ):
            try:
                await reservation.grow(need)
                return await admission.run(call)
            finally:
                reservation.end()

    async def stored(self, call: Callable[[], T]) -> T:
        """Writes robots in a thread: may wait for other writers, and holds up no reader.

        Raises:
            RequestProblem: 503, too many are at work or wait.
        """
        return await self.writing.run(call)

    def check_uploads(self) -> None:
        """Checks all uploads, of many only the first ones before it returns."""
        check = threading.Thread(
            target=(self.namespaces or self.store).check,
            args=(self._stopping.is_set,),
            name="uploads",
            daemon=True,
        )
        check.start()
        check.join(CHECKED_AT_START)

    def store_of(self, request: Request) -> RobotStore:
        """The store of a request: that of its key's namespace, else what all see."""
        if self.namespaces is None:
            return self.store
        key = key_of(request.scope)
        if key is None or key.scope is Scope.SHARE:
            return self.store
        return self.namespaces.of(key.name)

    def writer_of(self, request: Request, *, overwrite: bool) -> Writer:
        """Who changes robots by a request, and whether those of others are spared.

        In a namespace there are no others. Without keys nobody is known, so all are others.
        """
        key = key_of(request.scope)
        own = self.store_of(request) is not self.store
        return Writer(key.name if key else None, spares=not (own or overwrite))

    async def robot(self, robot_id: str, request: Request) -> StoredRobot:
        """A robot by id, as a request sees it; loaded in a thread where it is not in memory.

        Raises:
            RobotNotFound: No robot has this id.
        """
        store = self.store_of(request)
        loaded = store.in_memory(robot_id)
        if loaded is not None:
            return loaded
        return await self.loaded(lambda: store.get(robot_id))

    async def inline_robot(
        self, raw: msgspec.Raw, request: Request
    ) -> tuple[Robot, tuple[str, ...]]:
        """The robot of a body's ``robot`` field, and what its answer says of it.

        The field holds a table, a URDF or an id. Of a stored robot the answer tells the doubts; of
        one in the body every warning, as nothing else answers that document.

        Raises:
            RobotNotFound: No robot has this id.
            DHError: Not a usable table.
        """
        document, limit = bytes(raw), self.settings.max_document_bytes
        if len(document) > limit:
            raise RequestProblem(
                TOO_LARGE,
                say(
                    "{field} is larger than the {limit} bytes read here", field="robot", limit=limit
                ),
                "/robot",
            )
        if document[:1] == b'"':
            stored = await self.robot(decode_json(document, str, "/robot"), request)
            return stored.robot, stored.robot.doubts
        robot = self.inline.known(document)
        if robot is None:
            robot = await self.loaded(lambda: self.inline.get(document), len(document))
        return robot, robot.warnings


async def services_of(request: Request) -> Services:
    """The services of the application that serves a request."""
    services = request.app.state.services
    assert isinstance(services, Services)
    return services


ServicesDep = Annotated[Services, Depends(services_of)]


async def stored_robot(robot_id: str, request: Request, services: ServicesDep) -> StoredRobot:
    """The robot that a path names."""
    return await services.robot(robot_id, request)


RobotDep = Annotated[StoredRobot, Depends(stored_robot)]
