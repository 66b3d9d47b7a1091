"""Whether the service is alive and ready, and where everything is."""

from __future__ import annotations

import os

import msgspec
from fastapi import APIRouter, Request, Response

from app.dependencies import ServicesDep
from app.problems import ALL_TYPES, ProblemType, RequestProblem
from app.wire import JSON, TEXT, respond, wanted_type
from robots.errors import StorageUnavailable

router = APIRouter()
MAX_NAMED = 100


class Health(msgspec.Struct, kw_only=True):
    """State of the service.

    ``damaged`` names uploaded robots whose files cannot be served, until they are uploaded again
    or deleted; the service works all the same.
    """

    status: str
    damaged: list[str]
    damaged_count: int


@router.get("/health/live", tags=["health"], summary="Is the process alive?")
async def live() -> Response:
    """Answers as long as the event loop turns."""
    return Response(b'{"status":"live"}', media_type=JSON)


@router.get("/health/ready", tags=["health"], summary="Can it do its work?")
async def ready(services: ServicesDep) -> Response:
    """Loads a shipped robot, checks that uploads can be written, and names the damaged ones."""
    await services.robot("planar_2r")
    try:
        damaged = await services.loaded(services.store.damaged)
    except StorageUnavailable as error:
        return respond({"status": str(error), "damaged": [], "damaged_count": 0}, status=503)
    writable = os.access(services.settings.data_dir, os.W_OK)
    state = "ready" if writable else "data directory is not writable"
    return respond(
        {"status": state, "damaged": damaged[:MAX_NAMED], "damaged_count": len(damaged)},
        status=200 if writable else 503,
    )


@router.get("/", include_in_schema=False)
async def index(request: Request) -> Response:
    """What there is, for people who ask with curl."""
    base = str(request.base_url).rstrip("/")
    payload = {
        "service": "denavit",
        "docs": f"{base}/docs",
        "openapi": f"{base}/openapi.json",
        "robots": f"{base}/v1/robots",
        "try": f"curl '{base}/v1/robots/puma560/fk?q=0,45,-90,0,45,0&angle=deg&format=text'",
    }
    return respond(payload, wanted_type(request, JSON, TEXT))


@router.get("/problems/{slug}", include_in_schema=False)
async def problem(slug: str) -> Response:
    """What a problem's type means."""
    found = ALL_TYPES.get(slug)
    if found is None:
        unknown = ProblemType("not-found", 404, "Not Found")
        raise RequestProblem(unknown, f"there is no problem type {slug[:64]!r}")
    return respond({"slug": found.slug, "status": found.status, "title": found.title})
