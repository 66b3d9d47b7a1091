"""ASGI middleware: by which names the service may be called, against DNS rebinding.

A page of a stranger can give its own name the address of this machine; what its scripts then ask
counts as of its own site, but still carries that name in ``Host``.
"""

from __future__ import annotations

import ipaddress
import re
from functools import lru_cache

from starlette.types import ASGIApp, Receive, Scope, Send

from app.access.refusal import is_from_outside, path_of, refuse
from app.http.problems import MALFORMED_HOST, MISDIRECTED
from app.settings import Settings, listed
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say

ANY = "*"
LOOPBACK = ("localhost", "127.0.0.1", "[::1]")
PROBES = ("/health/live", "/health/ready")
"""Asked by orchestrators by whatever address they know, which a page cannot give to its name."""
_AUTHORITY = re.compile(rb"(\[[0-9A-Fa-f:.]{2,45}\]|[A-Za-z0-9._~-]{1,253})(?::[0-9]{0,5})?")
_PATTERN = re.compile(r"\*|(\*\.)?[a-z0-9._~-]{1,253}|\[[0-9a-f:.]{2,45}\]")


class InvalidHosts(ValueError):
    """A list of host names that cannot be read."""


def allowed_hosts(settings: Settings) -> tuple[str, ...]:
    """Return the names by which a deployment may be called, in lower case.

    Those of the settings, without ports; ``*.`` stands for any names before it, ``*`` for all,
    which is the default of the application.

    Raises:
        InvalidHosts: One is no host name.
    """
    given = [one.lower() for one in listed(settings.allowed_hosts)]
    wrong = next((one for one in given if not _PATTERN.fullmatch(one)), None)
    if wrong is not None:
        raise InvalidHosts(
            say(
                "DENAVIT_ALLOWED_HOSTS has {wrong}; give names without scheme and port,"
                " such as robots.example.org *.example.org [::1], or *",
                wrong=quoted(wrong),
            )
        )
    return tuple(given) or (ANY,)


def named_by_address(settings: Settings) -> Settings:
    """Return the settings of a server that listens on their host.

    Where that is the loopback interface and no names are chosen, only those of the interface are
    allowed.
    """
    if settings.allowed_hosts.strip() or not _is_loopback(settings.host):
        return settings
    return settings.model_copy(update={"allowed_hosts": " ".join(LOOPBACK)})


def _is_address(host: bytes) -> bool:
    try:
        ipaddress.ip_address(host.decode().strip("[]"))
    except ValueError:
        return False
    return True


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host.lower() == "localhost"


class AllowedHosts:
    """Refuses requests without one valid ``Host``, and those that call the service otherwise.

    Args:
        app: What is behind.
        names: As :func:`allowed_hosts` returns them.
    """

    def __init__(self, app: ASGIApp, names: tuple[str, ...]) -> None:
        self.app = app
        self.names = names
        self._allows = lru_cache(maxsize=256)(self._matches)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if not is_from_outside(scope):
            await self.app(scope, receive, send)
            return
        hosts = [value for name, value in scope["headers"] if name == b"host"]
        match = _AUTHORITY.fullmatch(hosts[0]) if len(hosts) == 1 else None
        if match is None:
            if not hosts and scope["http_version"] == "1.0":
                await self.app(scope, receive, send)
                return
            detail = say("send exactly one Host header, with a name, such as Host: localhost:8000")
            await refuse(scope, receive, send, MALFORMED_HOST, detail)
        elif self._allows(match[1]) or (path_of(scope) in PROBES and _is_address(match[1])):
            await self.app(scope, receive, send)
        else:
            detail = say(
                "this service is not called {decode}; who runs it may add the name to"
                " DENAVIT_ALLOWED_HOSTS",
                decode=quoted(match[1].decode()),
            )
            await refuse(scope, receive, send, MISDIRECTED, detail)

    def allows(self, host: bytes) -> bool:
        """Return whether the value of a ``Host`` header is one of the names."""
        match = _AUTHORITY.fullmatch(host)
        return match is not None and self._allows(match[1])

    def _matches(self, host: bytes) -> bool:
        name = host.decode().lower().rstrip(".")
        return any(
            pattern in (ANY, name) or (pattern[:2] == "*." and name.endswith(pattern[1:]))
            for pattern in self.names
        )
