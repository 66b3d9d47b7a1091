"""Memory of a worker: what requests will need is reserved before they are computed.

Bodies count as they arrive, computations by their :class:`~app.admission.need.Need`, answers until
they are sent. What does not fit now waits for its turn; what can never fit is refused with the size
that would. Only the event loop calls this, so that there is nothing to lock.
"""

from __future__ import annotations

import asyncio
import ctypes
import math
from collections import deque
from contextlib import suppress

from fastapi import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.admission.need import SMALL, Need
from app.admission.thread_pool import Admission
from app.http.problems import BUSY, TOO_LARGE, RequestProblem
from dh_to_urdf.messages import say
from kinematics.deadline import Cancelled

SMALL_BODY = 100_000
"""Bytes of a body or an answer that do not count."""
RETURNED = 16_000_000
"""Bytes whose release is worth giving free memory back to the system."""
SETTLING = 0.05
"""Seconds after which what a request held is free."""


class Memory:
    """The bytes that this process has for requests.

    Args:
        most: All of them.
        patience: Longest that a request waits for its part, s.

    Attributes:
        used: Bytes that are reserved.
    """

    def __init__(self, most: int, patience: float) -> None:
        self.most = most
        self.used = 0
        self._patience = patience
        self._queue: deque[tuple[int, asyncio.Future[None]]] = deque()
        self._returning = False

    @property
    def waiting(self) -> int:
        """Requests that wait for memory."""
        return len(self._queue)

    def reservation(self, body: int = 0) -> Reservation:
        """Return a reservation, of nothing yet, for a request with so many bytes of body."""
        return Reservation(self, body if body > SMALL_BODY else 0)

    def check(self, need: Need, body: int) -> None:
        """Refuse what can never fit beside its body.

        Raises:
            RequestProblem: 413, with the size that would.
        """
        most = self.most - body
        if need.bytes > most:
            pointer = f"/{need.argument}" if need.argument else ""
            raise RequestProblem(TOO_LARGE, _too_much(need, most), pointer)

    async def take(self, size: int) -> None:
        """Wait for so many bytes and take them: first come, first served, but for small ones.

        Raises:
            RequestProblem: 503, they were not free in time.
        """
        fits = self.used + size <= self.most
        if fits and (not self._queue or size <= SMALL):
            self.used += size
            return
        turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        entry = (size, turn)
        self._queue.append(entry)
        try:
            await asyncio.wait_for(asyncio.shield(turn), self._patience)
        except BaseException as error:
            if turn.done():
                self.release(size)
            else:
                turn.cancel()
                self._queue.remove(entry)
                self._admit()
            if isinstance(error, TimeoutError):
                raise self.busy() from None
            raise

    def check_bodies(self) -> None:
        """Refuse more of a body where there is no room.

        Raises:
            RequestProblem: 503, it may come again.
        """
        if self.used > self.most:
            raise self.busy()

    def hold(self, size: int) -> None:
        """Count bytes that are there already."""
        self.used += size

    def release(self, size: int) -> None:
        """Give bytes back, to whom waits for them."""
        self.used -= size
        self._admit()
        if size >= RETURNED and not self._returning:
            with suppress(RuntimeError):  # no loop: the service has ended
                asyncio.get_running_loop().call_later(SETTLING, self._return)
                self._returning = True

    def busy(self) -> RequestProblem:
        """Return the refusal of a request that may come again."""
        seconds = math.ceil(self._patience / 2)
        return RequestProblem(
            BUSY,
            say(
                "other large requests fill the memory that there is for them; ask again"
                " in {seconds} s",
                seconds=seconds,
            ),
            headers={"Retry-After": str(seconds)},
        )

    def _admit(self) -> None:
        while self._queue:
            size, turn = self._queue[0]
            if self.used + size > self.most:
                return
            self._queue.popleft()
            if not turn.done():
                self.used += size
                turn.set_result(None)

    def _return(self) -> None:
        """Give what is free back to the system, in a thread: it takes some milliseconds."""
        done = asyncio.get_running_loop().run_in_executor(None, return_free_memory)
        done.add_done_callback(self._returned)

    def _returned(self, done: asyncio.Future[None]) -> None:
        self._returning = False
        done.exception()


class Reservation:
    """The bytes that one request has.

    Attributes:
        size: How many.
    """

    def __init__(self, memory: Memory, body: int = 0) -> None:
        self._memory, self._body = memory, body
        self.size = 0

    async def grow(self, need: Need) -> None:
        """Wait until the request has what it needs.

        Raises:
            RequestProblem: 413, it can never have it; 503, it was not free in time.
        """
        self._memory.check(need, self._body)
        more = need.bytes - self.size
        if more > 0:
            await self._memory.take(more)
            self.size += more

    def settle(self, size: int) -> None:
        """Have so many bytes, without waiting: they are there already."""
        more = size - self.size
        self.size = size
        if more > 0:
            self._memory.hold(more)
        else:
            self._memory.release(-more)

    def end(self) -> None:
        """Have nothing any more."""
        self.settle(0)


class AdmittedResponse(Response):
    """An answer that takes memory: its request stays admitted until it is sent."""

    def __init__(
        self, response: Response, admission: Admission, reservation: Reservation, size: int
    ) -> None:
        self.response: Response | None = response
        self.status_code, self.background = response.status_code, None
        self.admission, self.reservation = admission, reservation
        reservation.settle(size)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Sends the answer, as far as somebody reads it."""
        assert self.response is not None
        try:
            with suppress(Cancelled):
                await self.response(scope, receive, send)
        finally:
            self.response = None
            self.reservation.end()
            self.admission.leave()


class BodyBudget:
    """ASGI middleware: bodies above some size count, while they arrive and until the answer."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http" or _is_small(scope):
            await self.app(scope, receive, send)
            return
        memory: Memory = scope["app"].state.services.memory
        reservation = memory.reservation()

        async def counted() -> Message:
            message = await receive()
            size = len(message.get("body", b""))
            if size:
                reservation.settle(reservation.size + size)
                memory.check_bodies()
            return message

        try:
            await self.app(scope, counted, send)
        finally:
            reservation.end()


def _is_small(scope: Scope) -> bool:
    """True where there is no body, or it says that it is small."""
    for name, value in scope["headers"]:
        if name == b"content-length":
            return len(value) <= 9 and value.isdigit() and int(value) <= SMALL_BODY
        if name == b"transfer-encoding":
            return False
    return True


def _too_much(need: Need, most: int) -> str:
    """Return why something can never fit, and what would."""
    fitting = need.fitting(most)
    size = say(
        "this needs about {bytes:.0f} MB, and there are {most:.0f} MB for it",
        bytes=need.bytes / 1000000.0,
        most=most / 1000000.0,
    )
    if fitting < 1:
        return say("{size}; it does not fit on this service", size=size)
    of_what = say("{of} of this robot", of=need.of) if need.argument else need.of
    return say(
        "{size}; give at most {fitting} {of_what} at once",
        size=size,
        fitting=fitting,
        of_what=of_what,
    )


def return_free_memory() -> None:
    """Give memory that is free in this process back to the system, where glibc is used."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
