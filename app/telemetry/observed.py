"""Pure ASGI middleware: measures each request, counts it, and writes its line."""

from __future__ import annotations

import logging
from asyncio import CancelledError
from time import perf_counter, time
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.telemetry.lines import LineHandler, head
from app.telemetry.metrics import Metrics

ACCESS = logging.getLogger("denavit.access")
LOG = logging.getLogger("denavit")
UNMATCHED = "unmatched"
"""Stands for the route of requests that no route takes."""
REFUSED_ROUTE = "denavit.refused_route"
"""Entry of the scope of a request that is turned away before it is routed: the template."""
REHEARSAL = "denavit.rehearsal"
"""Marks the scope of requests that the service sends itself; they are not counted."""
_QUIET = frozenset(("/health/live", "/health/ready", "/metrics"))


class Records:
    """What is kept of each request: counts, and a line.

    Args:
        metrics: What counts; None counts nothing.
        access_log: Whether each request gets a line; probes that go well get none.
        log_clients: Whether the line names the client's address.
    """

    def __init__(self, metrics: Metrics | None, *, access_log: bool, log_clients: bool) -> None:
        self.metrics = metrics
        self._access_log = access_log
        self._log_clients = log_clients

    def keep(self, scope: Scope, route: str, status: int, seconds: float, size: int) -> None:
        """Count a request that has been answered, and write its line.

        Args:
            scope: Its ASGI scope.
            route: The template of its route.
            status: 0 where the client went away before there was one.
            seconds: How long it took.
            size: Bytes of the answer's body.
        """
        if self.metrics is not None:
            self.metrics.count(scope["method"], route, status, seconds, size)
        if self._access_log and (status >= 400 or route not in _QUIET):
            self._write(scope, route, status, seconds, size)

    def _write(self, scope: Scope, route: str, status: int, seconds: float, size: int) -> None:
        if not ACCESS.isEnabledFor(logging.INFO):
            return
        event = "request" if status else "request aborted"
        fields: dict[str, Any] = {
            "method": scope["method"],
            "route": route,
            "status": status or None,
            "duration_ms": round(seconds * 1e3, 3),
            "bytes": size,
        }
        if self._log_clients and scope["client"]:
            fields["client"] = scope["client"][0]
        handler = logging.root.handlers[0] if logging.root.handlers else None
        if isinstance(handler, LineHandler) and not handler.filters:
            handler.write_soon(head(time(), "info", event, ACCESS.name) | fields)
        else:
            ACCESS.info(event, extra={"fields": fields})


class Observed:
    """The outermost layer: all that is answered passes through it.

    Args:
        app: What answers.
        records: What is kept of each request.
    """

    def __init__(self, app: ASGIApp, records: Records) -> None:
        self.app = app
        self._records = records
        self._templates: dict[Any, str] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one ASGI connection."""
        if scope["type"] != "http" or REHEARSAL in scope:
            await self.app(scope, receive, send)
            return
        begun = perf_counter()
        status = size = 0

        async def observed_send(message: Message) -> None:
            nonlocal status, size
            if message["type"] == "http.response.start":
                status = message["status"]
            else:
                size += len(message.get("body", b""))
            await send(message)

        metrics = self._records.metrics
        if metrics is not None:
            metrics.in_progress.inc()
        try:
            await self.app(scope, receive, observed_send)
        except CancelledError:
            # The server stops. It closes the connection of an answer that does not end.
            LOG.warning("request cut off")
        finally:
            seconds = perf_counter() - begun
            route = self._route(scope)
            if metrics is not None:
                metrics.in_progress.dec()
            self._records.keep(scope, route, status, seconds, size)

    def _route(self, scope: Scope) -> str:
        """The template of the route that took the request, or would have taken it."""
        refused = scope.get(REFUSED_ROUTE)
        if refused is not None:
            return str(refused)
        route = scope.get("route")
        if route is not None:
            return str(route.path)
        endpoint = scope.get("endpoint")
        if endpoint is None:
            return UNMATCHED
        if not self._templates:
            for one in scope["app"].routes:
                key = getattr(one, "endpoint", None) or getattr(one, "app", None)
                if key is not None:
                    self._templates[key] = one.path_format
        return self._templates.get(endpoint, UNMATCHED)
