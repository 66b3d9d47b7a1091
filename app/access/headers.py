"""Headers of every answer: what a browser must not do with it.

A page of its own (``/``, ``/docs``) says itself what it may load; everything else is data, of
which nothing runs, is framed, or is kept without asking again.
"""

from __future__ import annotations

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
]
SCRIPTS = b"text/javascript"


class SafeHeaders:
    """ASGI middleware: adds them where the answer does not say otherwise.

    Args:
        app: What is behind.
        private: Whether answers are for the holder of a key, and not for shared caches.
    """

    def __init__(self, app: ASGIApp, private: bool) -> None:
        self.app = app
        self.caching = b"private, no-cache" if private else b"no-cache"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = self._completed(list(message["headers"]))
            await send(message)

        await self.app(scope, receive, sending)

    def _completed(self, headers: list[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
        policy, caching, script = DATA_POLICY, self.caching, False
        for name, value in headers:
            if name == POLICY:
                policy = b""
            elif name == CACHING:
                caching = b""
            elif name == b"content-type" and value.startswith(SCRIPTS):
                script = True
        headers += SAFE
        if caching:
            headers.append((CACHING, caching))
        if policy and not script:
            # A script that a page runs in a worker would have to obey it.
            headers += [(POLICY, policy), (b"x-frame-options", b"DENY")]
        return headers
