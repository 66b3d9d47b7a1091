"""Connections of uvicorn, guarded: slow clients are cut off, floods wait their turn.

For ``http=`` of ``uvicorn.run``; ``denavit serve`` says so. The application hands the guard over
in its lifespan state, so one guard serves all connections of a process.
"""

from __future__ import annotations

import asyncio
import logging
import re
import resource
import secrets
import sys
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from fcntl import ioctl
from termios import TIOCOUTQ
from time import monotonic, perf_counter
from typing import Any, NamedTuple

import orjson
from uvicorn._types import ASGI3Application
from uvicorn.protocols.http.httptools_impl import (
    STATUS_LINE,
    HttpToolsProtocol,
    RequestResponseCycle,
)

from app.http.problems import HEAD_TOO_LARGE, TOO_MANY, TOO_SLOW, UNREADABLE, ProblemType
from app.routes.compute import TRIED
from app.serving.short_requests import Declined, ShortAnswer, ShortRequest, ShortRequests

LOG = logging.getLogger("denavit")
STATE = "connections"
"""Name of the guard in the lifespan state."""
BYTES_A_SECOND = 10_000
"""Who sends or reads more slowly than this is cut off, after the seconds of grace."""
MAX_HEAD_BYTES = 65_536
MAX_HEADERS = 100
MAX_OVERHEAD = 65_536
"""Bytes of chunk sizes, extensions and trailers, beside sixteen for each byte of a body."""
MAX_PIPELINED = 64
UNANSWERED = (
    f"more than {MAX_PIPELINED} requests wait for their answers on this connection; read the"
    " answers first, then send the others on a new connection"
)
AT_ONCE = 24
TURN_SECONDS = 0.004
"""Requests begun in one turn of the event loop, and the time after which no other is: milliseconds,
so that health is seldom late."""
SPARE_FILES = 100
"""File descriptors that are left for robots and worker processes."""
TICK = 0.01
"""Seconds that do not matter to a connection that idles."""
LINGER = 2.0
"""Seconds in which a client may read why it was refused."""
UNREAD = (
    "this is no HTTP request that is read here; check its first line (in an address, blanks and"
    " letters beyond ASCII are written as %20, %C2%B0, …), its headers and its lengths"
)
_UPGRADE = re.compile(rb"(?<=\n)upgrade(?=[ \t]*:)", re.IGNORECASE)
FIRST = ("/health/live", "/health/ready", "/metrics")
"""Begun at once, however many wait."""


@dataclass(frozen=True)
class ConnectionLimits:
    """What a connection may take.

    Attributes:
        connections: At a time; beyond, the one that has idled or dawdled longest is closed.
        head_seconds: For the head of a request to arrive.
        body_seconds: The same for a body, beside its size by ``BYTES_A_SECOND``.
        write_seconds: In which the client reads something, at least ``BYTES_A_SECOND``.
    """

    connections: int = 1000
    head_seconds: float = 10.0
    body_seconds: float = 20.0
    write_seconds: float = 20.0

    @property
    def most(self) -> int:
        """Connections at a time, no more than there are file descriptors for."""
        soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        if soft == resource.RLIM_INFINITY:
            return self.connections
        return max(1, min(self.connections, soft - min(SPARE_FILES, soft // 2)))


class Phase(Enum):
    """What a connection is at."""

    IDLE = "idle"
    HEAD = "head"
    BODY = "body"
    ANSWER = "answer"
    LINGER = "linger"


class ConnectionGuard:
    """What the connections of one process share: their number, the clock, and the turnstile.

    Args:
        limits: What each may take.
        short: Answers short computations without a task; None: all go to the application.
    """

    def __init__(self, limits: ConnectionLimits, short: ShortRequests | None = None) -> None:
        self.limits = limits
        self.short = short
        self.most = limits.most
        self.open: dict[GuardedProtocol, None] = {}
        self._queue: deque[Callable[[], None]] = deque()
        self._begun = 0
        self._turned = 0.0
        self._turning = False
        self._sweeping = False

    @property
    def waiting(self) -> int:
        """Requests that have not begun."""
        return len(self._queue)

    def enter(self, connection: GuardedProtocol) -> None:
        """Takes a connection in; where there are too many, the slowest gives way."""
        self.open[connection] = None
        if len(self.open) > self.most:
            self._make_room(connection)
        if not self._sweeping:
            self._sweeping = True
            connection.loop.call_later(self._pause, self._sweep, connection.loop)

    def leave(self, connection: GuardedProtocol) -> None:
        """A connection is lost."""
        self.open.pop(connection, None)

    def begin(self, start: Callable[[], None], loop: asyncio.AbstractEventLoop) -> None:
        """Starts a request in its turn: so many in each turn of the event loop."""
        if self.admits(loop):
            start()
        else:
            self._queue.append(start)

    def admits(self, loop: asyncio.AbstractEventLoop) -> bool:
        """Counts a request that begins now; returns False where it has to wait for its turn."""
        self._take_turns(loop)
        if self._queue or not self._has_room():
            return False
        self._begun += 1
        return True

    def admits_short(self, loop: asyncio.AbstractEventLoop) -> bool:
        """As :meth:`admits`, of a request that ends where it begins: only its time counts."""
        self._take_turns(loop)
        if self._queue or monotonic() - self._turned >= TURN_SECONDS:
            return False
        self._begun = self._begun or 1
        return True

    def _take_turns(self, loop: asyncio.AbstractEventLoop) -> None:
        if not self._turning:
            self._turning = True
            self._new_turn()
            loop.call_soon(self._turn, loop)

    def _new_turn(self) -> None:
        self._begun, self._turned = 0, monotonic()

    def _has_room(self) -> bool:
        """Whether one more request begins in this turn; the first always does."""
        if self._begun == 0:
            return True
        return self._begun < AT_ONCE and monotonic() - self._turned < TURN_SECONDS

    def _turn(self, loop: asyncio.AbstractEventLoop) -> None:
        self._new_turn()
        while self._queue and self._has_room():
            self._begun += 1
            self._queue.popleft()()
        if self._begun:
            loop.call_soon(self._turn, loop)
        else:
            self._turning = False

    @property
    def _pause(self) -> float:
        """Seconds between two looks at all connections."""
        limits = self.limits
        return min(1.0, limits.head_seconds / 4, limits.body_seconds / 4, limits.write_seconds / 4)

    def _sweep(self, loop: asyncio.AbstractEventLoop) -> None:
        now = monotonic()
        for connection in tuple(self.open):
            connection.look(now)
        if self.open:
            loop.call_later(self._pause, self._sweep, loop)
        else:
            self._sweeping = False

    def _make_room(self, newest: GuardedProtocol) -> None:
        # Oldest first: who has waited longest in a phase in which nothing is owed to it.
        for phases in ((Phase.IDLE, Phase.LINGER), (Phase.HEAD,)):
            waiting = [one for one in self.open if one.phase in phases and one is not newest]
            if waiting:
                min(waiting, key=lambda one: one.since).cut_off()
                return
        newest.cut_off()


class _Held(NamedTuple):
    """A request that may be answered at once, whose body is awaited.

    Attributes:
        cycle: Its cycle.
        app: What answers it else.
        found: What its head says.
        begun: When its head had been read, as ``perf_counter`` tells.
    """

    cycle: RequestResponseCycle
    app: ASGI3Application
    found: ShortRequest
    begun: float


class GuardedProtocol(HttpToolsProtocol):
    """One connection: uvicorn's own protocol, with an eye on the clock and on sizes."""

    guard: ConnectionGuard

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        guard = self.app_state.get(STATE)
        if not isinstance(guard, ConnectionGuard):
            raise RuntimeError(f"the application's lifespan gives no {STATE}")
        self.guard = guard
        self.phase = Phase.HEAD
        self.since = monotonic()
        self._allowed = guard.limits.head_seconds
        self._unread_since: float | None = None
        self._unread = -1
        self._raw = self._payload = self._head = self._count = 0
        self._refusal: tuple[ProblemType, str] = (UNREADABLE, UNREAD)
        self._head_end = b""
        self._running: RequestResponseCycle | None = None
        self._held: _Held | None = None
        self._counted = False  # whether what is held counts as in progress
        self._between = True  # the parser has no part of a request
        self._whole = b""
        self._declined: Declined | None = None
        self._parting = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """The connection is there; its first request is awaited."""
        super().connection_made(transport)
        self.guard.enter(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """The connection is gone."""
        self.guard.leave(self)
        self._release()
        if self._running is not None and not self._running.response_complete:
            # Of several requests, uvicorn tells the newest only.
            self._running.disconnected = True
            self._running.message_event.set()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Reads on, as far as sizes allow."""
        if self.phase is Phase.LINGER or self._parting or self.parser is None:
            return
        if self._between and self._answered_again(data):
            return
        self._whole = data if self._between else b""
        if self.phase is Phase.IDLE:
            self._enter(Phase.HEAD, self.guard.limits.head_seconds)
            self._raw = 0
        if self.phase is Phase.HEAD:
            data = self._without_upgrade(data)
        self._raw += len(data)
        super().data_received(data)
        if self._held is not None and not self._counted and self.guard.short is not None:
            self._counted = True
            self.guard.short.await_body(1)
        if self.phase is Phase.HEAD and self._raw > MAX_HEAD_BYTES:
            self._refuse_head()
        elif self.phase is Phase.BODY and self._raw > 16 * self._payload + MAX_OVERHEAD:
            self._refusal = (UNREADABLE, "the body has more framing than content")
            self.send_400_response("")

    def _without_upgrade(self, data: bytes) -> bytes:
        """Renames the header Upgrade, which is refused here by going on as if it were not there.

        The parser would take what follows the head for another protocol, and lose the body that
        clients send with an offer of HTTP/2.
        """
        before = b"" if self._raw == 0 else self._head_end
        joined = before + data
        end = joined.find(b"\r\n\r\n")
        head = data if end < 0 else data[: max(0, end - len(before))]
        self._head_end = joined[-3:]
        renamed = _UPGRADE.sub(b"x-upgra", head)
        return data if renamed == head else renamed + data[len(head) :]

    def eof_received(self) -> None:
        """The client sends no more; uvicorn takes it for gone, and so do its computations."""

    def on_message_begin(self) -> None:
        """A request begins."""
        super().on_message_begin()
        self._between = False
        self._head = self._count = 0

    def on_url(self, url: bytes) -> None:
        """A part of the target."""
        self._grow(len(url))
        super().on_url(url)

    def on_header(self, name: bytes, value: bytes) -> None:
        """A header, or a trailer."""
        self._count += 1
        self._grow(len(name) + len(value) + 4)
        super().on_header(name, value)

    def on_headers_complete(self) -> None:
        """The head is there; the body is awaited."""
        if len(self.pipeline) >= MAX_PIPELINED:
            self._refusal = (TOO_MANY, UNANSWERED)
            raise ValueError(UNANSWERED)
        super().on_headers_complete()
        self._enter(Phase.BODY, self.guard.limits.body_seconds)
        self._raw = self._payload = 0

    def on_body(self, body: bytes) -> None:
        """A part of the body."""
        self._payload += len(body)
        super().on_body(body)

    def on_message_complete(self) -> None:
        """The request is there; the answer is awaited."""
        if self.phase is Phase.BODY:
            done = self.cycle.response_complete and not self.pipeline
            self._enter(Phase.IDLE if done else Phase.ANSWER, 0.0)
        self._raw = 0
        super().on_message_complete()
        self._between = True
        whole, self._whole = self._whole, b""
        held = self._held
        if held is None or held.cycle is not self.cycle:
            return
        self._release()
        short, cycle = self.guard.short, held.cycle
        if short is not None and whole and cycle.keep_alive and self.limit_concurrency is None:
            short.remember(whole, held.found, bytes(cycle.body))
        self._begin(held.cycle, held.app, held)

    def on_response_complete(self) -> None:
        """The answer is written."""
        last = not self.pipeline
        super().on_response_complete()
        if last and self._parting:
            self._part()
        elif last and self.phase is Phase.ANSWER:
            self._enter(Phase.IDLE, 0.0)

    def timeout_keep_alive_handler(self) -> None:
        """Closes the connection where it has idled for the whole time.

        Its timer is not set anew for requests that are answered where their bytes arrive.
        """
        left = self.timeout_keep_alive - (monotonic() - self.since)
        if self.phase is Phase.IDLE and left > TICK:
            self._wait_for_more(left)
        else:
            super().timeout_keep_alive_handler()

    def pause_writing(self) -> None:
        """More is written than the client reads."""
        super().pause_writing()
        self._unread_since, self._unread = monotonic(), -1

    def resume_writing(self) -> None:
        """The client has read on."""
        super().resume_writing()
        self._unread_since = None

    def look(self, now: float) -> None:
        """Cuts the connection off where its time is up; asked every second or so."""
        limits = self.guard.limits
        if self.transport.is_closing() and self.transport.get_write_buffer_size():
            self._unread_since = self._unread_since or now
        if self._unread_since is not None:
            unread, passed = self._outstanding(), now - self._unread_since
            if self._unread < 0:
                self._unread = unread
            elif passed > limits.write_seconds:
                if self._unread - unread < BYTES_A_SECOND * passed:
                    self.cut_off()
                self._unread_since, self._unread = now, unread
            return
        waited = now - self.since
        if self.phase is Phase.HEAD and waited > self._allowed:
            self._refusal = (TOO_SLOW, "the head of the request took too long")
            self._too_slow()
        elif self.phase is Phase.BODY and not self.flow.read_paused:
            if waited > self._allowed + self._payload / BYTES_A_SECOND:
                self._refusal = (TOO_SLOW, "the body of the request took too long")
                self._too_slow()
        elif self.phase is Phase.LINGER and waited > LINGER:
            self.cut_off()
        elif self.phase is Phase.IDLE and waited > limits.head_seconds + self.timeout_keep_alive:
            self.transport.close()

    def _outstanding(self) -> int:
        """Bytes that are written and that the client has not taken."""
        queued = bytearray(4)
        with suppress(OSError):
            ioctl(self.transport.get_extra_info("socket").fileno(), TIOCOUTQ, queued)
        kernel = int.from_bytes(queued, sys.byteorder)
        return kernel + self.transport.get_write_buffer_size()

    def cut_off(self) -> None:
        """Ends the connection, whatever is on its way."""
        self.transport.abort()

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002  uvicorn's text
        """Says why the request is not read, and ends the connection once that was read.

        Requests that came whole before it get their answers first.
        """
        if self.transport.is_closing():
            return
        due = self._running is not None and not self._running.response_complete
        if self.phase is Phase.BODY:
            if self.pipeline:
                self.pipeline.popleft()  # the newest, of which the rest is not read
            elif self.cycle.response_complete:
                # The answer is given already, before the body was read.
                self._linger()
                return
            elif self.cycle.response_started:
                self.cut_off()
                return
            else:
                self.cycle.disconnected = True
                self.cycle.message_event.set()
                due = False
        if due:
            self._parting = True
            self._enter(Phase.ANSWER, 0.0)
        else:
            self._part()

    def _part(self) -> None:
        """Sends the refusal, and no more after it."""
        if self.transport.is_closing():
            return
        type_, detail = self._refusal
        status, slug = type_.status, type_.slug
        request_id = secrets.token_hex(8)
        fields = {"request_id": request_id, "status": status, "problem": slug}
        LOG.info("request not read", extra={"fields": fields})
        body = orjson.dumps(
            {
                "type": f"{self.root_path}/problems/{slug}",
                "title": str(type_.title),
                "status": status,
                "detail": detail,
                "errors": [{"pointer": "", "message": detail}],
                "request_id": request_id,
            }
        )
        head = [
            STATUS_LINE[status],
            b"content-type: application/problem+json\r\n",
            b"content-length: %d\r\n" % len(body),
            b"x-content-type-options: nosniff\r\ncache-control: no-store\r\n",
            b"x-request-id: %b\r\n" % request_id.encode(),
            b"connection: close\r\n\r\n",
        ]
        self.transport.write(b"".join([*head, body]))
        self._linger()

    def _linger(self) -> None:
        self._enter(Phase.LINGER, LINGER)
        # A close with unread data would reset the connection, and the client not see why.
        if self.transport.can_write_eof():
            self.transport.write_eof()
        else:
            self.transport.close()

    def _start_asgi_task(self, cycle: RequestResponseCycle, app: ASGI3Application) -> None:
        self._running = cycle
        if cycle.scope["path"] in FIRST:
            super()._start_asgi_task(cycle, app)
            return

        short, declined = self.guard.short, self._declined
        self._declined = None
        if declined is not None:
            _tell(cycle, declined)
        found = None if short is None or declined is not None else short.find(cycle.scope)
        held = None if found is None else _Held(cycle, app, found, perf_counter())
        if held is not None and cycle.more_body:
            self._held = held
        else:
            self._begin(cycle, app, held)

    def _begin(
        self, cycle: RequestResponseCycle, app: ASGI3Application, held: _Held | None
    ) -> None:
        """Answer a request in its turn."""

        def start() -> None:
            if not (cycle.disconnected or (held is not None and self._answered(held))):
                super(GuardedProtocol, self)._start_asgi_task(cycle, app)

        self.guard.begin(start, self.loop)

    def _release(self) -> None:
        """The body of what is held has come, or never will."""
        self._held = None
        if self._counted and self.guard.short is not None:
            self._counted = False
            self.guard.short.await_body(-1)

    def _answered(self, held: _Held) -> bool:
        """Answer a short request here, if it is one; return whether it was."""
        short, cycle = self.guard.short, held.cycle
        if short is None or self.flow.write_paused or self.transport.is_closing():
            return False
        answer = short.answer(held.found, bytes(cycle.body))
        if isinstance(answer, Declined):
            _tell(cycle, answer)
            return False
        cycle.response_started = cycle.response_complete = True
        self._write_short(answer, keep_alive=cycle.keep_alive)
        self.on_response_complete()
        short.keep(held.found, answer, held.begun, self.client)
        return True

    def _answered_again(self, data: bytes) -> bool:
        """Answer a short request whose head has come before, if it is one; return whether it was.

        The parser, which is between two requests, does not see it.
        """
        short = self.guard.short
        if short is None or self.phase not in (Phase.IDLE, Phase.HEAD) or self.pipeline:
            return False
        known = short.known(data)
        if known is None or self.flow.write_paused or self.transport.is_closing():
            return False
        if not self.guard.admits_short(self.loop):
            return False
        begun = perf_counter()
        found, body = known
        answer = short.answer(found, body)
        if isinstance(answer, Declined):
            self._declined = answer
            return False
        self._write_short(answer, keep_alive=True)
        self.server_state.total_requests += 1
        self._enter(Phase.IDLE, 0.0)
        if self.timeout_keep_alive_task is None:
            self._wait_for_more(self.timeout_keep_alive)
        short.keep(found, answer, begun, self.client)
        return True

    def _write_short(self, answer: ShortAnswer, *, keep_alive: bool) -> None:
        head = [b"HTTP/1.1 200 OK\r\n"]
        for name, value in self.server_state.default_headers:
            head += (name, b": ", value, b"\r\n")
        head.append(answer.head)
        if not keep_alive:
            head.append(b"connection: close\r\n")
        self.transport.write(b"".join((*head, b"\r\n", answer.body)))
        if not keep_alive:
            self.transport.close()

    def _wait_for_more(self, seconds: float) -> None:
        self.timeout_keep_alive_task = self.loop.call_later(
            seconds, self.timeout_keep_alive_handler
        )

    def _enter(self, phase: Phase, allowed: float) -> None:
        self.phase, self.since, self._allowed = phase, monotonic(), allowed

    def _grow(self, size: int) -> None:
        self._head += size
        if self._head > MAX_HEAD_BYTES or self._count > MAX_HEADERS:
            self._refusal = (
                HEAD_TOO_LARGE,
                f"the head is larger than {MAX_HEAD_BYTES} bytes or {MAX_HEADERS} headers; large"
                " requests go into the body",
            )
            raise ValueError(self._refusal[1])

    def _refuse_head(self) -> None:
        try:
            self._grow(MAX_HEAD_BYTES + 1)
        except ValueError:
            self.send_400_response("")

    def _too_slow(self) -> None:
        started = self._raw > 0 or self.phase is Phase.BODY
        if started:
            self.send_400_response("")
        else:
            self.transport.close()


def _tell(cycle: RequestResponseCycle, declined: Declined) -> None:
    """Tell the ordinary way what is known of a request."""
    if declined is Declined.LONGER:
        cycle.scope[TRIED] = True  # type: ignore[literal-required]


def raise_file_limit() -> None:
    """Takes as many file descriptors as this process may: connections are files."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = 65_536 if hard == resource.RLIM_INFINITY else min(65_536, hard)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
