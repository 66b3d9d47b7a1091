"""``GET /metrics`` for Prometheus."""

from __future__ import annotations

import anyio
from anyio.to_thread import run_sync
from fastapi import FastAPI, Request, Response
from prometheus_client import CONTENT_TYPE_PLAIN_0_0_4

from app.telemetry.metrics import Metrics
from robots.shipped import shipped_ids


def add_route(app: FastAPI, metrics: Metrics) -> None:
    """Adds the route.

    One scrape is made at a time, in a thread of its own: it must not hold up computations, nor
    wait for them.
    """
    limiter = anyio.CapacityLimiter(1)

    async def scrape(request: Request) -> Response:
        services = request.app.state.services

        def robots() -> int:
            if services.namespaces is not None:
                return int(services.namespaces.usage().robots)
            return len(services.store.ids()) - len(shipped_ids())

        metrics.write_pending()
        body = await run_sync(metrics.exposition, robots, limiter=limiter)
        return Response(body, media_type=CONTENT_TYPE_PLAIN_0_0_4)

    app.add_route("/metrics", scrape, ["GET"], include_in_schema=False)
