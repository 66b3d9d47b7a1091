"""Whether the service is alive and ready, and where everything is."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
from anyio.to_thread import run_sync
from fastapi import APIRouter, Request, Response

from app.dependencies import Services
from app.http.negotiation import HTML, JSON, TEXT, wanted_type
from app.http.problems import ProblemType, RequestProblem
from app.http.rendering import ALL_TYPES
from app.http.responses import respond
from app.page import Page, waiting
from app.readiness import Check, Readiness, WritableDirectory
from robots.shipped import shipped_ids

router = APIRouter()
MAX_NAMED = 100


class Health(msgspec.Struct, kw_only=True):
    """State of the process."""

    status: str


@router.get("/health/live", tags=["health"], summary="Is the process alive?")
async def live() -> Response:
    """Answers as long as the event loop turns."""
    return Response(b'{"status":"live"}', media_type=JSON)


def add_checks(readiness: Readiness, services: Services, kernels: Callable[[], Check]) -> None:
    """Adds what this service needs.

    Args:
        readiness: Where.
        services: What is checked.
        kernels: What is said of the machine code of the solvers.
    """

    def library() -> Check:
        services.store.get("planar_2r")
        return Check(status="ok", detail=f"{len(shipped_ids())} robots")

    readiness.add("kernels", kernels)
    readiness.add("library", library)

    def damaged() -> Check:
        if services.namespaces is None:
            names, unnamed = services.store.damaged(), 0
        else:
            # Anybody may ask: of namespaces only the number is told.
            names, unnamed = services.namespaces.damaged()
        count = len(names) + unnamed
        if not count:
            return Check(status="ok", detail="no upload is known to be damaged")
        detail = f"{count} uploads are damaged and not served; upload them again or delete them"
        if unnamed:
            detail += f"; {unnamed} of them are in namespaces, the log names their files"
        return Check(status="warning", detail=detail, names=names[:MAX_NAMED])

    readiness.add("robots", damaged)
    readiness.add("uploads", WritableDirectory(services.settings.data_dir))


@router.get("/health/ready", tags=["health"], summary="Can it do its work?")
async def ready(request: Request) -> Response:
    """Runs each check; 503 where one has failed and while the service is stopping."""
    report = await run_sync(request.app.state.readiness.report)
    return respond(msgspec.to_builtins(report), status=200 if report.status == "ready" else 503)


@router.api_route("/", methods=["GET", "HEAD"], include_in_schema=False)
async def index(request: Request) -> Response:
    """The page for browsers; what there is, for people who ask with curl."""
    page = request.app.state.page
    assert isinstance(page, Page)
    wanted = wanted_type(request, JSON, TEXT, HTML)
    if wanted == HTML:
        await run_sync(page.refresh)
        return page.index(request) if page.is_built else waiting()
    base = str(request.base_url).rstrip("/")
    payload = {
        "service": "denavit",
        "docs": f"{base}/docs",
        "guide": f"{base}/guide",
        "labs": f"{base}/labs",
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
