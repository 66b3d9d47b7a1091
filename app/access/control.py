"""ASGI middleware: keys and rate limits, before anything else is done for a request."""

from __future__ import annotations

from fastapi import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.access.keys import Key, KeyRing
from app.access.keys import Scope as KeyScope
from app.access.rates import RateLimits, Standing, network_of
from app.http.problems import (
    FORBIDDEN,
    TOO_MANY,
    UNAUTHORISED,
    ErrorEntry,
    ProblemType,
    problem_response,
)

OPEN = ("/", "/docs", "/guide", "/openapi.json", "/favicon.ico")
OPEN_BELOW = ("/health/", "/docs-assets/", "/guide/", "/assets/", "/problems/")
"""Open to everybody: whether the service lives, and documents that tell nothing about robots."""
UNCOUNTED = ("/health/live", "/health/ready")
"""Asked by load balancers, which must not be turned away."""
CHANGING = ("PUT", "DELETE", "PATCH")
UPLOADS = "/v1/robots"
CALLER, ITSELF = "denavit.caller", object()
"""Entry of the scope of a request that the service makes to itself; no client can set it."""
BEARER = 'Bearer realm="denavit"'


class AccessControl:
    """Turns away who shows no key that is needed, or asks too often.

    Args:
        app: What is behind.
        keys: The keys that are accepted; empty: none is needed.
        rates: Counts; None: everybody may ask as often as they like.
    """

    def __init__(self, app: ASGIApp, keys: KeyRing, rates: RateLimits | None) -> None:
        self.app = app
        self.keys = keys
        self.rates = rates

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http" or scope.get(CALLER) is ITSELF:
            await self.app(scope, receive, send)
            return
        path = scope["path"].removeprefix(scope.get("root_path", "").rstrip("/"))
        key = self._key_of(scope) if self.keys else None
        if self.rates is not None and path not in UNCOUNTED:
            standing = self.rates.count(_client_of(scope, key))
            send = _with_headers(send, standing)
            if not standing.allowed:
                detail = f"more than {standing.limit} requests; ask again in {standing.reset} s"
                await _refuse(scope, receive, send, TOO_MANY, detail)
                return
        if self.keys and not _is_open(path):
            if key is None:
                shown = _secret_of(scope) is not None
                await _refuse(
                    scope,
                    receive,
                    send,
                    UNAUTHORISED,
                    "this key is not known"
                    if shown
                    else "send a key as Authorization: Bearer … or as X-API-Key",
                    BEARER + (', error="invalid_token"' if shown else ""),
                )
                return
            if key.scope is not KeyScope.WRITE and _changes(scope["method"], path):
                await _refuse(
                    scope,
                    receive,
                    send,
                    FORBIDDEN,
                    "this key reads and computes; robots are changed with one of scope write",
                    BEARER + ', error="insufficient_scope", scope="write"',
                )
                return
        await self.app(scope, receive, send)

    def _key_of(self, scope: Scope) -> Key | None:
        secret = _secret_of(scope)
        return None if secret is None else self.keys.find(secret)


def _secret_of(scope: Scope) -> bytes | None:
    """What a request shows as its key: a bearer token, else X-API-Key."""
    found = None
    for name, value in scope["headers"]:
        if name == b"authorization" and value[:7].lower() == b"bearer ":
            return bytes(value[7:].strip())
        if name == b"x-api-key":
            found = bytes(value.strip())
    return found


def _client_of(scope: Scope, key: Key | None) -> str:
    """Whose requests are counted together."""
    if key is not None:
        return f"key {key.name}"
    client = scope.get("client")
    return network_of(client[0]) if client else "unknown"


def _is_open(path: str) -> bool:
    return path in OPEN or path.startswith(OPEN_BELOW)


def _changes(method: str, path: str) -> bool:
    """Whether a request changes stored robots."""
    return method in CHANGING or (method == "POST" and path.rstrip("/") == UPLOADS)


def _with_headers(send: Send, standing: Standing) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message["headers"], *standing.headers]
        await send(message)

    return sending


async def _refuse(
    scope: Scope,
    receive: Receive,
    send: Send,
    type_: ProblemType,
    detail: str,
    challenge: str | None = None,
) -> None:
    headers = {} if challenge is None else {"WWW-Authenticate": challenge}
    response = problem_response(Request(scope), type_, [ErrorEntry("", detail)], headers)
    await response(scope, receive, send)
