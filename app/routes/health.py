"""Whether the service is alive and ready, and where everything is."""

from __future__ import annotations

import os

import msgspec
from fastapi import APIRouter, Request, Response

from app.dependencies import ServicesDep
from app.page import Page
from app.problems import ALL_TYPES, ProblemType, RequestProblem
from app.wire import HTML, JSON, TEXT, respond, wanted_type

router = APIRouter()


class Health(msgspec.Struct, kw_only=True):
    """State of the service."""

    status: str


@router.get("/health/live", tags=["health"], summary="Is the process alive?")
async def live() -> Response:
    """Answers as long as the event loop turns."""
    return Response(b'{"status":"live"}', media_type=JSON)


@router.get("/health/ready", tags=["health"], summary="Can it do its work?")
async def ready(services: ServicesDep) -> Response:
    """Loads a shipped robot and checks that uploads can be written."""
    await services.robot("planar_2r")
    writable = os.access(services.settings.data_dir, os.W_OK)
    state = "ready" if writable else "data directory is not writable"
    return respond({"status": state}, status=200 if writable else 503)


@router.api_route("/", methods=["GET", "HEAD"], include_in_schema=False)
async def index(request: Request) -> Response:
    """The page for browsers; what there is, for people who ask with curl."""
    page = request.app.state.page
    assert isinstance(page, Page)
    wanted = wanted_type(request, JSON, TEXT, *((HTML,) if page.is_built else ()))
    if wanted == HTML:
        return page.index(request)
    base = str(request.base_url).rstrip("/")
    payload = {
        "service": "denavit",
        "docs": f"{base}/docs",
        "openapi": f"{base}/openapi.json",
        "robots": f"{base}/v1/robots",
        "try": f"curl '{base}/v1/robots/puma560/fk?q=0,45,-90,0,45,0&angle=deg&format=text'",
    }
    return respond(payload, wanted, headers={"Vary": "Accept"})


@router.get("/problems/{slug}", include_in_schema=False)
async def problem(slug: str) -> Response:
    """What a problem's type means."""
    found = ALL_TYPES.get(slug)
    if found is None:
        unknown = ProblemType("not-found", 404, "Not Found")
        raise RequestProblem(unknown, f"there is no problem type {slug[:64]!r}")
    return respond({"slug": found.slug, "status": found.status, "title": found.title})
