"""Headers of every answer: what a browser must not do with it.

A page of its own (``/``, ``/docs``) says itself what it may load; everything else is data, of
which nothing runs, or is kept without asking again. No page frames any of it, embeds it from
another origin (Fetch Standard: ``Cross-Origin-Resource-Policy``), where an image that loads would
tell that a robot is there, or holds a window of it that it has opened (HTML Standard:
``Cross-Origin-Opener-Policy``).
"""

from __future__ import annotations

from collections.abc import Iterable

from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = b"content-security-policy"
CACHING = b"cache-control"
DATA_POLICY = (
    b"default-src 'none'; style-src 'unsafe-inline'; font-src data:; img-src data:;"
    b" base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""For data: of a picture (SVG), its own styles, fonts and images only."""
SAFE = [
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"x-frame-options", b"DENY"),
    (b"cross-origin-opener-policy", b"same-origin"),
]
SCRIPTS = b"text/javascript"


class SafeHeaders:
    """ASGI middleware: adds them where the answer does not say otherwise.

    Args:
        app: What is behind.
        private: Whether answers are for the holder of a key, and not for shared caches.
        embeddable: Whether pages of every origin may embed answers, as CORS lets them read all.
    """

    def __init__(self, app: ASGIApp, private: bool, embeddable: bool = False) -> None:
        self.app = app
        embedding = b"cross-origin" if embeddable else b"same-origin"
        self.safe = [*SAFE, (b"cross-origin-resource-policy", embedding)]
        self.caching = b"private, no-cache" if private else b"no-cache"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = self.completed(message["headers"])
            await send(message)

        await self.app(scope, receive, sending)

    def completed(self, given: Iterable[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
        """Return the headers of an answer with those that it lacks."""
        headers = list(given)
        policy, caching, script = DATA_POLICY, self.caching, False
        for name, value in headers:
            if name == POLICY:
                policy = b""
            elif name == CACHING:
                caching = b""
            elif name == b"content-type" and value.startswith(SCRIPTS):
                script = True
        headers += self.safe
        if caching:
            headers.append((CACHING, caching))
        if policy and not script:
            # A script that a page runs in a worker would have to obey it.
            headers.append((POLICY, policy))
        return headers
