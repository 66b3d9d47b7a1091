"""Pure ASGI middleware: what the first line of a request may be, and HEAD as GET without a body."""

from __future__ import annotations

from fastapi import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.http.problems import TOO_LONG, ErrorEntry, problem_response
from dh_to_urdf.messages import say

MAX_QUERY = 32_768
"""Bytes of a query; longer ones belong in a body."""
MAX_PATH = 4_096


class RequestLine:
    """Refuses lines that take long to read, and answers HEAD wherever there is GET."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        if len(scope["query_string"]) > MAX_QUERY or len(scope["path"]) > MAX_PATH:
            message = say(
                "the address is longer than {max_path} bytes of path and {max_query} of"
                " query; send a body with POST",
                max_path=MAX_PATH,
                max_query=MAX_QUERY,
            )
            short = {**scope, "query_string": b"", "path": "/"}
            response = problem_response(Request(short), TOO_LONG, [ErrorEntry("", message)])
            await response(short, receive, send)
        elif scope["method"] == "HEAD":
            await self.app({**scope, "method": "GET"}, receive, _without_body(send))
        else:
            await self.app(scope, receive, send)


def _without_body(send: Send) -> Send:
    async def send_head(message: Message) -> None:
        if message["type"] == "http.response.body":
            message = {**message, "body": b""}
        await send(message)

    return send_head
