"""Sends requests in order on one kept connection, with the ETags that they name filled in."""

from __future__ import annotations

import re
import socket
from dataclasses import replace
from types import TracebackType

from tests.recorded.fixture import MINE, Answer, Asked
from tests.recorded.normalise import normalised
from tests.torture.exchange import Sent

PATIENCE = 600.0
_TAG = re.compile(r"\{etag:([^}]*)\}")


class Connection:
    """A kept connection that sends targets and headers as they are given.

    Args:
        address: Of the service, such as http://127.0.0.1:8000.
    """

    def __init__(self, address: str) -> None:
        host, _, port = address.partition("://")[2].partition(":")
        self.place = (host, int(port))
        self.host = f"{host}:{port}".encode()
        self.socket: socket.socket | None = None
        self.rest = b""

    def send(self, sent: Sent) -> tuple[int, dict[str, str], bytes]:
        """Status, headers by lower-case name, and body.

        Raises:
            OSError: No answer.
        """
        kept = self.socket is not None
        try:
            return self._send(sent)
        except (ConnectionError, EOFError):
            self.close()
            if not kept:
                raise
        # A server may close a kept connection at any time: only a fresh one tells.
        try:
            return self._send(sent)
        except EOFError as error:
            raise ConnectionError("closed without an answer") from error

    def close(self) -> None:
        """Closes the connection; the next request opens another."""
        if self.socket is not None:
            self.socket.close()
        self.socket, self.rest = None, b""

    def _send(self, sent: Sent) -> tuple[int, dict[str, str], bytes]:
        if self.socket is None:
            self.socket = socket.create_connection(self.place, PATIENCE)
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        lines = [f"{sent.method} {sent.target} HTTP/1.1".encode("latin-1", "replace")]
        lines.append(b"Host: " + self.host)
        lines += [f"{name}: {value}".encode("latin-1", "replace") for name, value in sent.headers]
        if sent.body is not None:
            lines.append(b"Content-Length: %d" % len(sent.body))
        self.socket.sendall(b"\r\n".join(lines) + b"\r\n\r\n" + (sent.body or b""))
        head = self._until(b"\r\n\r\n").decode("latin-1").split("\r\n")
        status = int(head[0].split(" ")[1])
        headers = {
            name.lower(): value.strip()
            for name, _, value in (line.partition(":") for line in head[1:])
        }
        if sent.method == "HEAD" or status in (204, 304):
            body = b""
        elif headers.get("transfer-encoding", "").lower() == "chunked":
            body = self._chunks()
        else:
            body = self._take(int(headers["content-length"]))
        if headers.get("connection", "").lower() == "close":
            self.close()
        return status, headers, body

    def _chunks(self) -> bytes:
        parts = []
        while size := int(self._until(b"\r\n").partition(b";")[0], 16):
            parts.append(self._take(size))
            self._until(b"\r\n")
        self._until(b"\r\n")
        return b"".join(parts)

    def _until(self, mark: bytes) -> bytes:
        while (end := self.rest.find(mark)) < 0:
            self._more()
        found, self.rest = self.rest[:end], self.rest[end + len(mark) :]
        return found

    def _take(self, size: int) -> bytes:
        while len(self.rest) < size:
            self._more()
        found, self.rest = self.rest[:size], self.rest[size:]
        return found

    def _more(self) -> None:
        assert self.socket is not None
        received = self.socket.recv(1 << 20)
        if not received:
            raise EOFError
        self.rest += received


class Session:
    """A connection to a service, and the ETags seen on it.

    Args:
        address: Of the service, such as http://127.0.0.1:8000.
    """

    def __init__(self, address: str) -> None:
        self.address = address.rstrip("/")
        self.connection = Connection(self.address)
        self.tags: dict[str, str] = {}

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.connection.close()

    def clear(self) -> None:
        """Deletes the robots that an earlier run has left."""
        _, _, body = self.connection.send(Sent("GET", "/v1/robots", "page_size=1000"))
        for robot_id in re.findall(rf'"id":"((?:{MINE}|corpus)[^"]*)"', body.decode()):
            self.connection.send(Sent("DELETE", f"/v1/robots/{robot_id}"))

    def ask(self, asked: Asked) -> tuple[Answer, str | None]:
        """The answer, normalised, and its whole text, None where it is no text."""
        sent = asked.sent
        if any("{etag:" in value for _, value in sent.headers):
            filled = tuple((name, self._filled(value)) for name, value in sent.headers)
            sent = replace(sent, headers=filled)
        status, headers, body = self.connection.send(sent)
        if "etag" in headers and status in (200, 201):
            self.tags[headers.get("location", sent.path)] = headers["etag"]
        return normalised(status, headers, body, self.address)

    def _filled(self, value: str) -> str:
        return _TAG.sub(lambda found: self.tags.get(found[1], '"none"'), value)
