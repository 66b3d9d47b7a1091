"""ASGI middleware: keys and rate limits, before anything else is done for a request."""

from __future__ import annotations

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.access.keys import Key, KeySource
from app.access.rates import RateLimits, Standing, network_of
from app.access.refusal import changes_robots, is_from_outside, path_of, refuse
from app.http.problems import FORBIDDEN, TOO_MANY, TWO_KEYS, UNAUTHORISED
from dh_to_urdf.messages import say

OPEN = ("/", "/docs", "/guide", "/labs", "/openapi.json", "/favicon.ico")
OPEN_BELOW = ("/health/", "/docs-assets/", "/guide/", "/labs/", "/assets/", "/problems/")
"""Open to everybody: whether the service lives, and documents that tell nothing about robots."""
CLOSED_BELOW = "/labs/teacher"
"""But these: solutions of the lab sheets."""
UNCOUNTED = ("/", "/docs", "/guide", "/labs", "/health/live", "/health/ready")
UNCOUNTED_BELOW = ("/assets/", "/docs-assets/", "/guide/", "/labs/")
"""Asked by load balancers, which must not be turned away; and pages with their parts, which a
browser asks for many at a time, without a key, and a classroom by one address."""
KEY = "denavit.key"
"""Entry of the scope of a request: the key that it shows."""
BEARER = 'Bearer realm="denavit"'


class AccessControl:
    """Turns away who shows no key that is needed, or asks too often.

    Args:
        app: What is behind.
        keys: The keys that are accepted, if any is needed.
        rates: Counts; None: everybody may ask as often as they like.
    """

    def __init__(self, app: ASGIApp, keys: KeySource, rates: RateLimits | None) -> None:
        self.app = app
        self.keys = keys
        self.rates = rates

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if not is_from_outside(scope):
            await self.app(scope, receive, send)
            return
        path = path_of(scope)
        secrets = _secrets_of(scope) if self.keys.required else ()
        key = self.keys.find(secrets[0]) if len(secrets) == 1 else None
        if key is not None:
            scope[KEY] = key
        if self.rates is not None and not _is_uncounted(path):
            standing = self.rates.count(_client_of(scope, key))
            send = _with_headers(send, standing)
            if not standing.allowed:
                detail = say(
                    "more than {limit} requests; ask again in {reset} s",
                    limit=standing.limit,
                    reset=standing.reset,
                )
                await refuse(scope, receive, send, TOO_MANY, detail)
                return
        if self.keys.required and not _is_open(path):
            if len(secrets) > 1:
                await refuse(
                    scope,
                    receive,
                    send,
                    TWO_KEYS,
                    say("two different keys are shown; send one"),
                    BEARER + ', error="invalid_request"',
                )
                return
            if key is None:
                await refuse(
                    scope,
                    receive,
                    send,
                    UNAUTHORISED,
                    say("this key is not known")
                    if secrets
                    else say("send a key as Authorization: Bearer … or as X-API-Key"),
                    BEARER + (', error="invalid_token"' if secrets else ""),
                )
                return
            if not key.scope.changes and changes_robots(scope):
                await refuse(
                    scope,
                    receive,
                    send,
                    FORBIDDEN,
                    say("this key reads and computes; robots are changed with one of scope write"),
                    BEARER + ', error="insufficient_scope", scope="write"',
                )
                return
        await self.app(scope, receive, send)


def key_of(scope: Scope) -> Key | None:
    """Return the key that a request shows, where keys are needed and it is known."""
    key = scope.get(KEY)
    assert key is None or isinstance(key, Key)
    return key


def _secrets_of(scope: Scope) -> list[bytes]:
    """Return the different keys that a request shows, as bearer token and as X-API-Key."""
    found: list[bytes] = []
    for name, value in scope["headers"]:
        if name == b"authorization" and value[:7].lower() == b"bearer ":
            found.append(bytes(value[7:].strip()))
        elif name == b"x-api-key":
            found.append(bytes(value.strip()))
    return list(dict.fromkeys(found))


def _client_of(scope: Scope, key: Key | None) -> str:
    """Whose requests are counted together."""
    if key is not None:
        return f"key {key.name}"
    client = scope.get("client")
    return network_of(client[0]) if client else "unknown"


def _is_open(path: str) -> bool:
    if path.startswith(CLOSED_BELOW):
        return False
    return path in OPEN or path.startswith(OPEN_BELOW)


def _is_uncounted(path: str) -> bool:
    if path.startswith(CLOSED_BELOW):
        return False
    return path in UNCOUNTED or path.startswith(UNCOUNTED_BELOW)


def _with_headers(send: Send, standing: Standing) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message["headers"], *standing.headers]
        await send(message)

    return sending
