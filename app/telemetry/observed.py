"""Pure ASGI middleware: measures each request, counts it, and writes its line."""

from __future__ import annotations

import logging
from asyncio import CancelledError
from time import perf_counter, time
from typing import Any, TypeAlias

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.telemetry.lines import (
    REQUEST_ID,
    LineFormatter,
    LineHandler,
    LineTemplate,
    duration_ms,
    head,
)
from app.telemetry.metrics import Metrics

ACCESS = logging.getLogger("denavit.access")
LOG = logging.getLogger("denavit")
UNMATCHED = "unmatched"
"""Stands for the route of requests that no route takes."""
REFUSED_ROUTE = "denavit.refused_route"
"""Entry of the scope of a request that is turned away before it is routed: the template."""
REHEARSAL = "denavit.rehearsal"
"""Marks the scope of requests that the service sends itself; they are not counted."""
Client: TypeAlias = tuple[str, int]
"""Address and port."""
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
        self._templates: dict[tuple[LineFormatter, str, str, int], LineTemplate | None] = {}

    def keep(
        self,
        method: str,
        route: str,
        status: int,
        seconds: float,
        size: int,
        client: Client | None,
    ) -> None:
        """Count a request that has been answered, and write its line.

        Args:
            method: Its method.
            route: The template of its route.
            status: 0 where the client went away before there was one.
            seconds: How long it took.
            size: Bytes of the answer's body.
            client: Address and port of the client.
        """
        if self.metrics is not None:
            self.metrics.count(method, route, status, seconds, size)
        if self._is_told(route, status):
            self._write(method, route, status, seconds, size, client)

    def keep_soon(
        self,
        method: str,
        route: str,
        status: int,
        seconds: float,
        size: int,
        client: Client | None,
        request_id: str,
    ) -> None:
        """Do as :meth:`keep` does, in a fraction of the time, for many requests together.

        Args:
            method: Its method.
            route: The template of its route.
            status: The answer's status.
            seconds: How long it took.
            size: Bytes of the answer's body.
            client: Address and port of the client.
            request_id: The id of the request.
        """
        if self.metrics is not None:
            self.metrics.count_soon(method, route, status, seconds, size)
        if not self._is_told(route, status):
            return
        handler = None if self._log_clients else _page_writer()
        template = None if handler is None else self._template(handler, method, route, status)
        if handler is None or template is None:
            token = REQUEST_ID.set(request_id)
            self._write(method, route, status, seconds, size, client)
            REQUEST_ID.reset(token)
        else:
            handler.write_line_soon(template.line(time(), request_id, seconds, size))

    def _template(
        self, handler: LineHandler, method: str, route: str, status: int
    ) -> LineTemplate | None:
        """What writes the lines of a route; None: each is made singly."""
        key = handler.form, method, route, status
        if key not in self._templates:
            fields = {"method": method, "route": route, "status": status}
            self._templates[key] = handler.form.template("request", ACCESS.name, fields)
        return self._templates[key]

    def _is_told(self, route: str, status: int) -> bool:
        """Whether a request gets a line."""
        if not self._access_log or (status < 400 and route in _QUIET):
            return False
        return ACCESS.isEnabledFor(logging.INFO)

    def _write(
        self,
        method: str,
        route: str,
        status: int,
        seconds: float,
        size: int,
        client: Client | None,
    ) -> None:
        event = "request" if status else "request aborted"
        fields: dict[str, Any] = {
            "method": method,
            "route": route,
            "status": status or None,
            "duration_ms": duration_ms(seconds),
            "bytes": size,
        }
        if self._log_clients and client:
            fields["client"] = client[0]
        handler = _page_writer()
        if handler is not None:
            handler.write_soon(head(time(), "info", event, ACCESS.name) | fields)
        else:
            ACCESS.info(event, extra={"fields": fields})


def _page_writer() -> LineHandler | None:
    """The handler that writes lines of requests a page at a time, where there is one."""
    handler = logging.root.handlers[0] if logging.root.handlers else None
    return handler if isinstance(handler, LineHandler) and not handler.filters else None


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
            self._records.keep(scope["method"], route, status, seconds, size, scope.get("client"))

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
