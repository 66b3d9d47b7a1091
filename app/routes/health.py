"""Whether the service is alive and ready, and where everything is."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
from anyio.to_thread import run_sync
from fastapi import APIRouter, Request, Response

from app.dependencies import Services
from app.http.language import language_of
from app.http.negotiation import HTML, JSON, TEXT, wanted_type
from app.http.problems import ProblemType, RequestProblem
from app.http.rendering import ALL_TYPES
from app.http.responses import respond
from app.page import Page, waiting
from app.readiness import Check, Readiness, WritableDirectory
from dh_to_urdf.messages import say
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
        return Check(status="ok", detail=say("{count} robots", count=len(shipped_ids())))

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
            return Check(status="ok", detail=say("no upload is known to be damaged"))
        detail = say(
            "{count} uploads are damaged and not served; upload them again or delete them",
            count=count,
        )
        if unnamed:
            detail += say(
                "; {unnamed} of them are in namespaces, the log names their files", unnamed=unnamed
            )
        return Check(status="warning", detail=detail, names=names[:MAX_NAMED])

    readiness.add("robots", damaged)
    readiness.add("uploads", WritableDirectory(services.settings.data_dir))


@router.get("/health/ready", tags=["health"], summary="Can it do its work?")
async def ready(request: Request) -> Response:
    """Runs each check; 503 where one has failed and while the service is stopping."""
    report = await run_sync(request.app.state.readiness.report)
    checks = {name: _plain(check) for name, check in report.checks.items()}
    status = 200 if report.status == "ready" else 503
    payload = {"status": report.status, "checks": checks}
    return respond(payload, JSON, language_of(request), status=status)


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
    return respond(payload, wanted, language_of(request), headers={"Vary": "Accept"})


@router.get("/problems/{slug}", include_in_schema=False)
async def problem(slug: str, request: Request) -> Response:
    """What a problem's type means."""
    found = ALL_TYPES.get(slug)
    if found is None:
        unknown = ProblemType("not-found", 404, say("Not Found"))
        raise RequestProblem(unknown, say("there is no problem type {slug!r}", slug=slug[:64]))
    payload = {"slug": found.slug, "status": found.status, "title": found.title}
    return respond(payload, JSON, language_of(request))


def _plain(check: Check) -> dict[str, object]:
    """A check as the report shows it; msgspec has no way with messages."""
    found: dict[str, object] = {"status": check.status, "detail": check.detail}
    return {**found, "names": check.names} if check.names else found
