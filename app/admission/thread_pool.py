"""Who may compute now: threads for each kind of work, and a bounded queue in front of them.

More than the queue holds is turned away at once, with the time after which to ask again. Who
goes away leaves the queue, and calls off the computation that was begun for it.
"""

from __future__ import annotations

import asyncio
import math
from collections import deque
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from contextvars import copy_context
from time import monotonic
from typing import TypeVar

from fastapi import FastAPI, Request, Response
from starlette.requests import ClientDisconnect

from app.http.problems import BUSY, ErrorEntry, ProblemType, RequestProblem, problem_response
from dh_to_urdf.messages import say
from kinematics.deadline import Cancelled, Deadline, checkpoint, under

T = TypeVar("T")
GONE = ProblemType("client-closed-request", 499, say("The client went away"))
"""For logs and metrics: nobody reads it."""
LONGEST_RETRY = 60.0
MEMORY = 0.2
"""Weight of the last computation in the mean of their durations."""


class Admission:
    """One request's stay with a pool: from its admission until its answer is on the way.

    Attributes:
        deadline: Of what is computed for it; its time begins with the first call.
        begun: Whether there was a call.
    """

    def __init__(self, pool: ThreadPool, seconds: float) -> None:
        self._pool = pool
        self._seconds = seconds
        self._whole = Deadline()
        self.deadline = self._whole
        self.begun = False

    def begin(self) -> None:
        """Starts the clock, with the first call."""
        if not self.begun:
            self.begun = True
            self.deadline = Deadline(self._seconds, of=self._whole)

    def drop(self) -> None:
        """Calls off what is computed or waits: nobody wants it."""
        self._whole.drop()

    def leave(self) -> None:
        """The answer is on the way, or nobody wants it."""
        self._pool.leave(self)

    async def run(self, call: Callable[[], T]) -> T:
        """Runs a call in a thread of the pool, as soon as one is free.

        Raises:
            RequestProblem: 503, none was free in time.
            Cancelled: The client went away.
        """
        return await self._pool.run_for(self, call)


class ThreadPool:
    """Threads for one kind of work.

    Args:
        name: What the threads are called.
        threads: How many calls run at a time.
        waiting: Requests besides that may wait for a thread.
        patience: Longest that one waits for its first call, s.
    """

    def __init__(self, name: str, threads: int, waiting: int, patience: float) -> None:
        self._pool = ThreadPoolExecutor(threads, f"denavit-{name}")
        self._threads, self._free = threads, threads
        self._most, self._patience = threads + waiting, patience
        self._admissions: set[Admission] = set()
        self._queue: deque[asyncio.Future[None]] = deque()
        self._duration = 0.1

    @property
    def running(self) -> int:
        """Calls that run."""
        return self._threads - self._free

    @property
    def waiting(self) -> int:
        """Calls that wait for a thread."""
        return len(self._queue)

    @asynccontextmanager
    async def admission(self, seconds: float = math.inf) -> AsyncIterator[Admission]:
        """Admits a request.

        Args:
            seconds: Longest computation, without waiting; the first call starts the clock.

        Raises:
            RequestProblem: 503, too many are here.
        """
        admission = self.enter(seconds)
        try:
            yield admission
        finally:
            self.leave(admission)

    def enter(self, seconds: float = math.inf) -> Admission:
        """Admits a request; see :meth:`admission`."""
        if len(self._admissions) >= self._most:
            raise self._overloaded()
        admission = Admission(self, seconds)
        self._admissions.add(admission)
        return admission

    def leave(self, admission: Admission) -> None:
        """The request's answer is on the way, or nobody wants it."""
        self._admissions.discard(admission)

    async def run(self, call: Callable[[], T]) -> T:
        """Runs one call for a request that does nothing else here.

        Raises:
            RequestProblem: 503, too many are here, or no thread was free in time.
        """
        async with self.admission() as admission:
            return await admission.run(call)

    async def run_for(self, admission: Admission, call: Callable[[], T]) -> T:
        """See :meth:`Admission.run`."""
        await self._thread(None if admission.begun else self._patience)
        admission.begin()
        started = monotonic()
        # In the request's own context, so that what is logged in the thread names the request.
        context = copy_context()

        def work() -> T:
            with under(admission.deadline):
                checkpoint()
                return call()

        try:
            future = asyncio.get_running_loop().run_in_executor(self._pool, context.run, work)
        except BaseException:
            self._release()
            raise
        future.add_done_callback(lambda done: self._done(done, started))
        try:
            return await asyncio.shield(future)
        except asyncio.CancelledError:
            admission.drop()
            raise

    def close(self) -> None:
        """Calls off what still runs; for the end of the process."""
        for admission in self._admissions:
            admission.drop()
        self._pool.shutdown(wait=False, cancel_futures=True)

    async def _thread(self, patience: float | None) -> None:
        """Waits for a free thread and takes it; no longer than so many seconds."""
        if self._free > 0:
            self._free -= 1
            return
        turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._queue.append(turn)
        try:
            await asyncio.wait_for(asyncio.shield(turn), patience)
        except BaseException as error:
            if turn.done():
                self._release()
            else:
                turn.cancel()
                self._queue.remove(turn)
            if isinstance(error, TimeoutError):
                raise self._overloaded() from None
            raise

    def _release(self) -> None:
        """Gives a thread to who has waited longest."""
        while self._queue:
            turn = self._queue.popleft()
            if not turn.done():
                turn.set_result(None)
                return
        self._free += 1

    def _done(self, future: asyncio.Future[T], started: float) -> None:
        self._release()
        self._duration += MEMORY * (monotonic() - started - self._duration)
        if not future.cancelled():
            future.exception()  # looked at, where nobody waits for it any more

    def _overloaded(self) -> RequestProblem:
        ahead = self._duration * (1 + len(self._queue)) / self._threads
        seconds = math.ceil(min(max(ahead, 1.0), LONGEST_RETRY))
        return RequestProblem(
            BUSY,
            say(
                "{count} requests are at work or wait already; ask again in {seconds} s",
                count=len(self._admissions),
                seconds=seconds,
            ),
            headers={"Retry-After": str(seconds)},
        )


@asynccontextmanager
async def while_connected(request: Request, admission: Admission) -> AsyncIterator[None]:
    """Calls a computation off as soon as the client goes away; its body must have been read.

    Raises:
        Cancelled: The client went away.
    """
    task = asyncio.current_task()
    assert task is not None
    left = False

    async def watch() -> None:
        nonlocal left
        message, ends = await request.receive(), 0
        while message["type"] != "http.disconnect":
            # The body of a GET, which nobody reads, may come first; an end that comes twice is not
            # from a server that would tell.
            ends += not message.get("more_body", False)
            if ends > 1:
                return
            message = await request.receive()
        left = True
        admission.drop()
        task.cancel()

    watching = asyncio.create_task(watch())
    try:
        yield
    except asyncio.CancelledError:
        if not left:
            raise
        task.uncancel()
        raise Cancelled from None
    finally:
        watching.cancel()


def install(app: FastAPI) -> None:
    """Registers what a request of somebody who went away ends with."""

    async def gone(request: Request, error: Exception) -> Response:  # noqa: ARG001
        return problem_response(request, GONE, [ErrorEntry("", say("the client went away"))])

    app.add_exception_handler(Cancelled, gone)
    app.add_exception_handler(ClientDisconnect, gone)
