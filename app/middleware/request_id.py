"""Pure ASGI middleware: a request id on every answer."""

from __future__ import annotations

import itertools
import logging
import re
import secrets
from asyncio import CancelledError

from fastapi import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.http.problems import INTERNAL, STOPPING, ErrorEntry, problem_response
from app.telemetry.lines import REQUEST_ID
from dh_to_urdf.messages import say

_LOG = logging.getLogger("denavit")
_ID = re.compile(rb"[A-Za-z0-9._-]{1,64}")


class RequestIds:
    """Ids of requests: the client's ``X-Request-ID`` if it is harmless, else a new one."""

    def __init__(self) -> None:
        self.prefix = secrets.token_hex(6)
        self.counter = itertools.count(1)

    def of(self, given: bytes) -> str:
        """Return the id of a request.

        Args:
            given: Its ``X-Request-ID``, empty where there is none.
        """
        if given and _ID.fullmatch(given):
            return given.decode("ascii")
        return f"{self.prefix}-{next(self.counter):x}"


class RequestId:
    """Gives each request an id.

    Args:
        app: What is behind.
        ids: Those of the application.
    """

    def __init__(self, app: ASGIApp, ids: RequestIds) -> None:
        self.app = app
        self.ids = ids

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        given = next((value for name, value in scope["headers"] if name == b"x-request-id"), b"")
        request_id = self.ids.of(given)
        scope.setdefault("state", {})["request_id"] = request_id
        REQUEST_ID.set(request_id)

        started = False

        async def send_with_id(message: Message) -> None:
            nonlocal started
            started = True
            if message["type"] == "http.response.start":
                message["headers"] = [
                    *message["headers"],
                    (b"x-request-id", request_id.encode("ascii")),
                ]
            await send(message)

        try:
            await self.app(scope, receive, send_with_id)
        except CancelledError:
            if started:
                raise
            message = say("the service stopped before this was done; ask again")
            problems, headers = [ErrorEntry("", message)], {"Retry-After": "1"}
            response = problem_response(Request(scope), STOPPING, problems, headers)
            await response(scope, receive, send_with_id)
        except Exception:
            if started:
                raise
            _LOG.exception("request failed")
            message = say("this should not happen; please report it with the request_id")
            response = problem_response(Request(scope), INTERNAL, [ErrorEntry("", message)])
            await response(scope, receive, send_with_id)
