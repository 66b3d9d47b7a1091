"""Bytes of large bodies and answers that this process holds, and their bound."""

from __future__ import annotations

from contextlib import suppress

from fastapi import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.admission.thread_pool import Admission
from app.http.problems import BUSY, RequestProblem
from kinematics.deadline import Cancelled

SMALL_BODY = 100_000
"""Bytes of a body or an answer that do not count."""


class AdmittedResponse(Response):
    """An answer that takes memory: its request stays admitted until it is sent."""

    def __init__(
        self, response: Response, admission: Admission, buffers: Buffers, size: int
    ) -> None:
        self.response, self.admission, self.buffers, self.size = response, admission, buffers, size
        buffers.used += size

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Sends the answer, as far as somebody reads it."""
        try:
            with suppress(Cancelled):
                await self.response(scope, receive, send)
        finally:
            self.buffers.used -= self.size
            self.admission.leave()


class Buffers:
    """Bytes of large bodies and large answers that this process holds, and their bound."""

    def __init__(self, most: int) -> None:
        self.most = most
        self.used = 0

    def check(self) -> None:
        """Goes on where there is room.

        Raises:
            RequestProblem: 503, there is none.
        """
        if self.used > self.most:
            raise RequestProblem(
                BUSY,
                "other large requests fill the memory that there is for them; ask again soon",
                headers={"Retry-After": "2"},
            )


class BodyBudget:
    """ASGI middleware: bodies above some size count, while they arrive and until the answer."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http" or _is_small(scope):
            await self.app(scope, receive, send)
            return
        buffers: Buffers = scope["app"].state.services.buffers
        held = 0

        async def counted() -> Message:
            nonlocal held
            message = await receive()
            size = len(message.get("body", b""))
            held += size
            buffers.used += size
            if size:
                buffers.check()
            return message

        try:
            await self.app(scope, counted, send)
        finally:
            buffers.used -= held


def _is_small(scope: Scope) -> bool:
    """True where there is no body, or it says that it is small."""
    for name, value in scope["headers"]:
        if name == b"content-length":
            return len(value) <= 9 and value.isdigit() and int(value) <= SMALL_BODY
        if name == b"transfer-encoding":
            return False
    return True
