"""Conversions that store nothing."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.dependencies import ServicesDep
from app.documents import (
    BINARY,
    DECODED_TYPES,
    SPREADSHEET_TYPES,
    TABLES,
    XML_TYPES,
    memory_beside,
    robot_from_body,
)
from app.http.bodies import read_body
from app.http.language import language_of
from app.http.negotiation import media_type, unsupported
from app.http.responses import told_in_header
from app.openapi.answers import REF
from app.openapi.problems import PROBLEMS


def build_router(max_body: int) -> APIRouter:
    """Routes of conversions.

    Args:
        max_body: Largest document in bytes.
    """
    router = APIRouter(prefix="/v1", tags=["convert"], responses=PROBLEMS)

    @router.post(
        "/dh-to-urdf",
        summary="D-H table to URDF",
        response_class=Response,
        responses={200: {"description": "URDF.", "content": {"application/xml": {}}}},
        openapi_extra={
            "requestBody": {
                "required": True,
                "content": {
                    "application/json": {"schema": {"$ref": REF.format(name="DHTable")}},
                    "application/yaml": {"schema": {"$ref": REF.format(name="DHTable")}},
                    **{
                        kind: {"schema": {"type": "string"}}
                        for kind in ("text/csv", "text/x-symoro", "text/plain")
                    },
                    **{kind: {"schema": BINARY} for kind in SPREADSHEET_TYPES},
                },
            }
        },
    )
    async def dh_to_urdf(request: Request, services: ServicesDep) -> Response:
        if media_type(request) in XML_TYPES:
            raise unsupported(media_type(request), TABLES)
        body = await read_body(request, max_body, DECODED_TYPES)
        robot = await services.loaded(
            lambda: robot_from_body(request, body, "robot"), len(body), memory_beside(request)
        )
        told = told_in_header(robot.warnings, language_of(request))
        return Response(robot.urdf, headers=told, media_type="application/xml")

    return router
