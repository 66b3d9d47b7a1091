"""What ``app.serving`` overrides and reads of uvicorn's own, which promises none of it.

A new version of uvicorn that renames one of these would not fail: the service would merely stop
guarding its connections, or its way to stop. Each test is of one member.
"""

import asyncio
import signal
import socket
from collections import deque

import pytest
import uvicorn
from uvicorn.protocols.http.httptools_impl import (
    STATUS_LINE,
    HttpToolsProtocol,
    RequestResponseCycle,
)

REQUEST = b"POST /one?x=1 HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\nhi"
OVERRIDDEN = (
    "connection_made",
    "connection_lost",
    "data_received",
    "on_message_begin",
    "on_url",
    "on_header",
    "on_headers_complete",
    "on_body",
    "on_message_complete",
    "on_response_complete",
    "send_400_response",
    "_start_asgi_task",
)
"""Methods of the protocol that uvicorn or its parser calls."""
SERVER_METHODS = ("capture_signals", "startup", "shutdown", "handle_exit")


def recording(base, names, calls):
    """A subclass that notes with which arguments its methods are called."""

    def method(name):
        def called(self, *arguments, **options):
            calls.setdefault(name, []).append(arguments)
            return getattr(super(made, self), name)(*arguments, **options)

        return called

    made = type("Recording", (base,), {name: method(name) for name in names})
    return made


class Exchange:
    """Two pipelined requests, the first of which waits until both were looked at; then rubbish."""

    def __init__(self) -> None:
        self.calls: dict[str, list[tuple]] = {}
        self.before: dict[str, object] = {}
        self.waiting: dict[str, object] = {}
        self.scopes: list[dict] = []
        self.received = b""
        asyncio.run(self.run())

    async def run(self) -> None:
        both = asyncio.Event()

        async def app(scope, receive, send) -> None:
            self.scopes.append(scope)
            await both.wait()
            headers = [(b"content-length", b"2")]
            await send({"type": "http.response.start", "status": 200, "headers": headers})
            await send({"type": "http.response.body", "body": b"ok"})

        config = uvicorn.Config(app, lifespan="off", log_config=None, http="httptools", ws="none")
        config.load()
        made = []

        def protocol():
            kind = recording(HttpToolsProtocol, OVERRIDDEN, self.calls)
            made.append(kind(config, uvicorn.server.ServerState(), {"state": 1}))
            self.before = dict(vars(made[0]))
            return made[0]

        loop = asyncio.get_running_loop()
        server = await loop.create_server(protocol, "127.0.0.1", 0)
        async with server:
            host = server.sockets[0].getsockname()
            reader, writer = await asyncio.open_connection(*host)
            writer.write(REQUEST + REQUEST.replace(b"one", b"two"))
            while not (made and made[0].pipeline):
                await asyncio.sleep(0)
            self.waiting = dict(vars(made[0]))
            self.newest = made[0].pipeline[0][0]
            self.cycle = dict(vars(self.newest))
            self.read_paused = made[0].flow.read_paused
            both.set()
            while self.received.count(b"ok") < 2:
                self.received += await reader.read(1000)
            self.answered = dict(vars(self.newest))
            writer.write(b"rubbish\r\n\r\n")
            self.received += await reader.read()
            writer.close()
            while "connection_lost" not in self.calls:
                await asyncio.sleep(0)
            self.after = dict(vars(made[0]))


@pytest.fixture(scope="module")
def exchange() -> Exchange:
    return Exchange()


@pytest.mark.parametrize("name", OVERRIDDEN)
def test_uvicorn_calls_what_the_guard_overrides(exchange, name):
    assert name in vars(HttpToolsProtocol)
    assert exchange.calls[name]


def test_a_request_begins_by_start_asgi_task_with_its_cycle_and_the_application(exchange):
    first, second = exchange.calls["_start_asgi_task"]
    assert isinstance(first[0], RequestResponseCycle)
    assert callable(first[1])
    assert second[0] is exchange.newest


def test_the_protocol_is_made_with_the_state_of_the_lifespan(exchange):
    assert exchange.before["app_state"] == {"state": 1}


def test_the_loop_is_known_before_the_connection(exchange):
    assert isinstance(exchange.before["loop"], asyncio.AbstractEventLoop)


def test_the_time_of_an_idle_connection_is_a_number(exchange):
    assert exchange.before["timeout_keep_alive"] > 0


def test_the_prefix_of_paths_is_known(exchange):
    assert exchange.before["root_path"] == ""


def test_the_parser_is_there_until_the_connection_is_lost(exchange):
    assert exchange.waiting["parser"] is not None
    assert exchange.after["parser"] is None


def test_the_transport_is_that_of_the_connection(exchange):
    (given,) = exchange.calls["connection_made"]
    assert exchange.waiting["transport"] is given[0]


def test_the_pipeline_holds_cycles_that_wait_the_newest_first(exchange):
    assert isinstance(exchange.waiting["pipeline"], deque)
    assert [scope["path"] for scope in exchange.scopes] == ["/one", "/two"]
    assert exchange.newest.scope["path"] == "/two"


def test_the_newest_request_is_the_cycle(exchange):
    assert exchange.waiting["cycle"] is exchange.newest


def test_reading_is_paused_while_a_request_waits(exchange):
    assert exchange.read_paused is True


@pytest.mark.parametrize("name", ["response_started", "response_complete"])
def test_a_cycle_says_how_far_its_answer_is(exchange, name):
    assert exchange.cycle[name] is False
    assert exchange.answered[name] is True


def test_a_cycle_may_be_told_that_its_client_is_gone(exchange):
    assert exchange.cycle["disconnected"] is False


def test_a_cycle_is_woken_by_its_event(exchange):
    assert isinstance(exchange.cycle["message_event"], asyncio.Event)


def test_a_status_has_its_line():
    assert STATUS_LINE[408].startswith(b"HTTP/1.1 408 ")
    assert STATUS_LINE[431].endswith(b"\r\n")


def test_a_refusal_is_written_by_send_400_response(exchange):
    assert b"HTTP/1.1 400" in exchange.received


@pytest.fixture(scope="module")
def stopped() -> tuple[dict[str, list[tuple]], list[tuple[bool, bool, bool]], list[str]]:
    """Calls of a server that a signal stops, its flags before and after, events of its lifespan."""
    calls: dict[str, list[tuple]] = {}
    flags, events = [], []

    async def app(scope, receive, send) -> None:
        assert scope["type"] == "lifespan"
        for kind in ("startup", "shutdown"):
            assert (await receive())["type"] == f"lifespan.{kind}"
            events.append(kind)
            await send({"type": f"lifespan.{kind}.complete"})

    class Stopping(recording(uvicorn.Server, SERVER_METHODS, calls)):
        async def startup(self, sockets=None) -> None:
            flags.append((self.started, self.should_exit, self.force_exit))
            await super().startup(sockets)
            flags.append((self.started, self.should_exit, self.force_exit))
            signal.raise_signal(signal.SIGINT)

    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        server = Stopping(uvicorn.Config(app, log_config=None, ws="none"))
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            with pytest.raises(KeyboardInterrupt):  # uvicorn raises the signal again
                server.run([bound])
        finally:
            signal.signal(signal.SIGINT, before)
    flags.append((server.started, server.should_exit, server.force_exit))
    events.append(callable(server.lifespan.shutdown))
    return calls, flags, events


@pytest.mark.parametrize("name", SERVER_METHODS)
def test_uvicorn_calls_what_the_server_overrides(stopped, name):
    calls, _, _ = stopped
    assert name in vars(uvicorn.Server)
    assert calls[name]


@pytest.mark.parametrize(
    ("position", "expected"),
    [(0, [False, True, True]), (1, [False, False, True]), (2, [False, False, False])],
    ids=["started", "should_exit", "force_exit"],
)
def test_a_server_says_what_it_is_at(stopped, position, expected):
    _, flags, _ = stopped
    assert [moment[position] for moment in flags] == expected


def test_the_lifespan_can_be_ended(stopped):
    _, _, events = stopped
    assert events == ["startup", "shutdown", True]
