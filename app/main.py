"""``create_app(settings)``: wiring only. ``uvicorn app.main:app`` works too."""

from __future__ import annotations

import sys
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

from anyio.to_thread import run_sync
from fastapi import FastAPI

from app import docs, page
from app.access.wiring import describe, protect
from app.admission import thread_pool as admission
from app.dependencies import Services
from app.guide import routes as guide
from app.http import handlers
from app.labs import routes as labs
from app.middleware.request_id import RequestIds
from app.middleware.request_line import RequestLine
from app.openapi.document import build_openapi
from app.operations import OPERATIONS, Operation
from app.readiness import Readiness, ReadinessReport
from app.routes import (
    compute,
    convert,
    diff,
    exercises,
    health,
    link_matrix,
    mesh_lines,
    meshes,
    metrics,
    robots,
    tables,
)
from app.serving.connections import STATE, ConnectionGuard, ConnectionLimits
from app.serving.kernels import loaded_kernels
from app.serving.short_requests import short_requests
from app.settings import Settings
from app.telemetry.metrics import Metrics, shared_directory
from app.telemetry.observed import Observed, Records
from app.telemetry.tracing import telemetry_config

SWITCH_SECONDS = 0.0005
"""How long a computation keeps the event loop waiting for the interpreter, at each of its turns."""
DESCRIPTION = """Kinematics over HTTP: post a Denavit-Hartenberg table or a URDF, ask for forward
kinematics, Jacobians, singularities and inverse kinematics.

Angles are rad unless `?angle=deg`; lengths are m. `Accept: text/plain` or `?format=text` prints
aligned matrices; batches also travel as `application/x-npy`."""


def create_app(
    settings: Settings | None = None,
    operations: Sequence[Operation] | None = None,
    *,
    counters: Path | None = None,
) -> FastAPI:
    """Return the application.

    Args:
        settings: What a deployment chose; default from the environment, read at start-up.
        operations: The computations that it offers; default all of ``app.operations``.
        counters: The file in which all workers of the service count requests; None: this process
            serves alone.
    """
    chosen = settings or Settings()
    offered = OPERATIONS if operations is None else operations

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[dict[str, Any]]:
        sys.setswitchinterval(SWITCH_SECONDS)
        app.state.services = Services(chosen)
        await run_sync(app.state.services.check_uploads)
        async with loaded_kernels(app, app.state.services, offered) as kernels:
            health.add_checks(app.state.readiness, app.state.services, lambda: kernels.check)
            short = short_requests(app.state.services, computations, records, ids)
            yield {STATE: ConnectionGuard(_limits(chosen), short)}
            app.state.readiness.stop()
        if counted is not None:
            counted.write_pending()
        app.state.services.close()

    app = FastAPI(
        title="Denavit",
        version=version("denavit"),
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        lifespan=lifespan,
        redirect_slashes=False,
        root_path=chosen.root_path,
        telemetry=telemetry_config(),
    )
    app.state.readiness = Readiness()
    app.state.metrics = counted = Metrics(shared_directory()) if chosen.metrics else None
    records = Records(counted, access_log=chosen.access_log, log_clients=chosen.log_clients)
    computations = compute.add_routes(app, offered, chosen.max_compute_bytes)
    app.include_router(health.router)
    app.include_router(robots.build_router(chosen.max_document_bytes))
    app.include_router(meshes.router)
    app.include_router(convert.build_router(chosen.max_document_bytes))
    app.include_router(tables.build_router(chosen.max_document_bytes))
    app.include_router(diff.build_router(chosen.max_document_bytes))
    app.include_router(link_matrix.build_router())
    app.include_router(exercises.router)
    if counted is not None:
        metrics.add_route(app, counted)
    app.state.page = page.load_page()
    page.install(app, app.state.page)
    docs.install(app)
    guide.install(app, guide.load_guide())
    labs.install(app, labs.load_labs(), teacher_edition=chosen.teacher_edition)
    handlers.install(app)
    app.add_middleware(RequestLine)
    admission.install(app)
    ids = RequestIds()
    app.state.keys = protect(app, chosen, ids, counters)
    app.add_middleware(Observed, records=records)

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            types = (
                robots.RobotView,
                robots.RobotList,
                mesh_lines.MeshList,
                health.Health,
                ReadinessReport,
                diff.DiffRequest,
                diff.InlineDiffRequest,
                diff.DiffResponse,
                *exercises.TYPES,
            )
            app.openapi_schema = build_openapi(app, offered, types)
            describe(app.openapi_schema, needs_keys=app.state.keys.required)
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]
    return app


def _limits(settings: Settings) -> ConnectionLimits:
    return ConnectionLimits(
        settings.max_connections,
        settings.head_seconds,
        settings.body_seconds,
        settings.write_seconds,
    )


def __getattr__(name: str) -> Any:
    """Builds ``app`` when a server asks for it, so that importing this module reads no settings."""
    if name == "app":
        return create_app()
    raise AttributeError(name)
