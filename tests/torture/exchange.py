"""Requests as bytes: what is sent, what came back, and nothing that a client would tidy up."""

from __future__ import annotations

import http.client
import time
from dataclasses import dataclass, replace

HANG = 300.0


@dataclass(frozen=True)
class Sent:
    """A request; ``path`` is raw, as it stands on the request line."""

    method: str
    path: str
    query: str = ""
    headers: tuple[tuple[str, str], ...] = ()
    body: bytes | None = None
    chunked: bool = False
    what: str = ""

    @property
    def target(self) -> str:
        return f"{self.path}?{self.query}" if self.query else self.path

    def header(self, name: str) -> str:
        return next((v for k, v in self.headers if k.lower() == name), "")

    def with_header(self, name: str, value: str) -> Sent:
        kept = tuple(pair for pair in self.headers if pair[0].lower() != name.lower())
        return replace(self, headers=(*kept, (name, value)))

    def shown(self) -> str:
        body = b"" if self.body is None else self.body
        return f"{self.method} {self.target[:300]} {self.headers} {len(body)} B {body[:600]!r}"


@dataclass(frozen=True)
class Received:
    status: int
    headers: dict[str, str]
    body: bytes
    seconds: float


class RawConnection(http.client.HTTPConnection):
    """One that sends targets as they are given."""

    def _validate_path(self, url: str) -> None:
        pass

    def _encode_request(self, request: str) -> bytes:
        return request.encode("latin-1", "replace")


class Client:
    """A connection that is kept, and opened anew where the server closed it."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.connection = self._fresh()

    def _fresh(self) -> RawConnection:
        return RawConnection("127.0.0.1", self.port, timeout=HANG)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.connection.close()

    def send(self, sent: Sent) -> Received:
        """The answer.

        Raises:
            OSError, HTTPException: The connection broke twice, or nothing came in time.
        """
        for attempt in (0, 1):
            started = time.perf_counter()
            try:
                return self._send(sent, started)
            except (http.client.HTTPException, OSError):
                self.connection.close()
                self.connection = self._fresh()
                # A server may close a kept connection at any time: only a fresh one tells.
                if attempt or time.perf_counter() - started > HANG / 2:
                    raise
        raise AssertionError

    def _send(self, sent: Sent, started: float) -> Received:
        connection = self.connection
        connection.putrequest(sent.method, sent.target, skip_accept_encoding=True)
        for name, value in sent.headers:
            connection.putheader(name, value.encode("latin-1", "replace"))
        if sent.chunked:
            connection.putheader("Transfer-Encoding", "chunked")
        elif sent.body is not None:
            connection.putheader("Content-Length", str(len(sent.body)))
        body: object = sent.body
        if sent.chunked:
            data = sent.body or b""
            body = iter([data[k : k + 4096] for k in range(0, len(data), 4096)])
        connection.endheaders(body, encode_chunked=sent.chunked)  # type: ignore[arg-type]
        answer = connection.getresponse()
        content = answer.read()
        headers = {name.lower(): value for name, value in answer.getheaders()}
        return Received(answer.status, headers, content, time.perf_counter() - started)
