"""The general link matrix of a convention, of no robot in particular."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response

from app.http.language import language_of
from app.http.negotiation import JSON, LATEX, TEXT, wanted_type
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import check_query
from app.http.responses import respond
from app.openapi.problems import PROBLEMS
from dh_to_urdf import Convention
from dh_to_urdf.documents.mapping import CONVENTION_ALIASES
from dh_to_urdf.messages import say
from kinematics.symbolic.link_matrix import LINK_MATRICES, LinkMatrix

OFFERS = (JSON, TEXT, LATEX)
_TEXTS = {"type": "array", "items": {"type": "string"}}
_SCHEMA: dict[str, Any] = {
    "type": "object",
    "required": ["convention", "label", "product", "matrix", "latex", "index", "source"],
    "properties": {
        "convention": {"enum": list(Convention)},
        "label": {"type": "string"},
        "product": _TEXTS,
        "matrix": {"type": "array", "items": _TEXTS},
        "latex": {"type": "array", "items": _TEXTS},
        "index": {"type": "object", "additionalProperties": {"type": "string"}},
        "source": {"type": "string"},
    },
}


def build_router() -> APIRouter:
    """Return the route of the general link matrix."""
    router = APIRouter(prefix="/v1", responses=PROBLEMS)

    @router.get(
        "/dh-matrices",
        summary="The link matrix A_i of a convention, in symbols",
        tags=["convert"],
        responses={
            200: {
                "description": "The product of elementary transformations, and the matrix.",
                "content": {
                    JSON: {"schema": _SCHEMA},
                    **{kind: {"schema": {"type": "string"}} for kind in OFFERS[1:]},
                },
            }
        },
        openapi_extra={
            "parameters": [
                {
                    "name": "convention",
                    "in": "query",
                    "required": True,
                    "description": "standard, modified or khalil.",
                    "schema": {"type": "string"},
                    "example": "standard",
                },
                {
                    "name": "format",
                    "in": "query",
                    "required": False,
                    "description": "json (default), text or latex; or by Accept.",
                    "schema": {"type": "string", "enum": ["json", "text", "latex"]},
                },
            ]
        },
    )
    async def link_matrix(request: Request) -> Response:
        """With alpha, a, d and theta as symbols; needs no robot."""
        check_query(request, "convention", common=("format", "lang"))
        wanted = wanted_type(request, *OFFERS)
        found = LINK_MATRICES[_convention(request)]
        if wanted == JSON:
            return respond(_view(found), JSON, language_of(request))
        text = found.latex() if wanted == LATEX else found.text()
        return Response(text, media_type=f"{wanted}; charset=utf-8", headers={"Vary": "Accept"})

    return router


def _view(found: LinkMatrix) -> dict[str, Any]:
    return {
        "convention": found.convention.value,
        "label": found.label,
        "product": list(found.product),
        "matrix": [list(row) for row in found.matrix],
        "latex": found.latex_matrix(),
        "index": found.index,
        "source": found.source,
    }


def _convention(request: Request) -> Convention:
    raw = request.query_params.get("convention")
    found = None if raw is None else CONVENTION_ALIASES.get(raw.strip().lower())
    if found is None:
        given = say("is missing") if raw is None else say("{raw!r} is unknown", raw=raw[:40])
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "convention {given}; give {convention}",
                given=given,
                convention=", ".join(Convention),
            ),
            "/convention",
        )
    return found
