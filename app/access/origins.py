"""ASGI middleware: pages of other origins may not change robots.

A browser sends a simple request of any page, with the keys of nobody but from inside the network
of its user. It says so in ``Sec-Fetch-Site`` (Fetch Metadata, W3C) and ``Origin`` (RFC 6454);
programs that are no browsers send neither.
"""

from __future__ import annotations

from collections.abc import Sequence

from starlette.types import ASGIApp, Receive, Scope, Send

from app.access.refusal import changes_robots, is_from_outside, refuse
from app.http.problems import CROSS_ORIGIN
from dh_to_urdf.messages import say

OWN_SITES = (b"same-origin", b"none")
"""Of a page of the service itself; of the user, who typed an address or chose a bookmark."""


class CrossOrigin:
    """Refuses changes that a page of another origin asks for, unless CORS allows the origin.

    Args:
        app: What is behind.
        origins: Those that CORS allows, ``*`` for all.
    """

    def __init__(self, app: ASGIApp, origins: Sequence[str]) -> None:
        self.app = app
        self.origins = frozenset(origin.encode() for origin in origins)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if is_from_outside(scope) and changes_robots(scope) and self._is_foreign(scope):
            detail = say(
                "a page of another origin asks for this; who runs the service may add"
                " that origin to DENAVIT_CORS_ORIGINS"
            )
            await refuse(scope, receive, send, CROSS_ORIGIN, detail)
        else:
            await self.app(scope, receive, send)

    def _is_foreign(self, scope: Scope) -> bool:
        if b"*" in self.origins:
            return False
        found: dict[bytes, list[bytes]] = {b"origin": [], b"sec-fetch-site": [], b"host": []}
        for name, value in scope["headers"]:
            if name in found:
                found[name].append(value.strip())
        origins, sites = found[b"origin"], found[b"sec-fetch-site"]
        if origins and all(origin in self.origins for origin in origins):
            return False
        if sites:
            return any(site not in OWN_SITES for site in sites)
        return any(origin.partition(b"://")[2] not in found[b"host"] for origin in origins)
