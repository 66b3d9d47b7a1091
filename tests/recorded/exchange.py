"""Sends requests in order on one kept connection, with the ETags that they name filled in."""

from __future__ import annotations

import re
from dataclasses import replace
from types import TracebackType

from tests.recorded.fixture import MINE, Answer, Asked
from tests.recorded.normalise import normalised
from tests.torture.exchange import Client, Sent

_TAG = re.compile(r"\{etag:([^}]*)\}")


class Session:
    """A connection to a service.

    Args:
        address: Of the service, such as http://127.0.0.1:8000.
    """

    def __init__(self, address: str) -> None:
        self.address = address.rstrip("/")
        self.client = Client(int(self.address.rsplit(":", 1)[1]))
        self.tags: dict[str, str] = {}

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.client.connection.close()

    def clear(self) -> None:
        """Deletes the robots that an earlier run has left."""
        body = self.client.send(Sent("GET", "/v1/robots", "page_size=1000")).body.decode()
        for robot_id in re.findall(rf'"id":"((?:{MINE}|corpus)[^"]*)"', body):
            self.client.send(Sent("DELETE", f"/v1/robots/{robot_id}"))

    def ask(self, asked: Asked) -> tuple[Answer, str | None]:
        """The answer, normalised, and its whole text, None where it is no text."""
        sent = asked.sent
        if any("{etag:" in value for _, value in sent.headers):
            filled = tuple((name, self._filled(value)) for name, value in sent.headers)
            sent = replace(sent, headers=filled)
        got = self.client.send(sent)
        if "etag" in got.headers and got.status in (200, 201):
            self.tags[got.headers.get("location", sent.path)] = got.headers["etag"]
        return normalised(got.status, got.headers, got.body, self.address)

    def _filled(self, value: str) -> str:
        return _TAG.sub(lambda found: self.tags.get(found[1], '"none"'), value)
