"""The meshes of shipped robots: a list, and the files, compressed and cached."""

from __future__ import annotations

import gzip
from functools import lru_cache
from typing import Annotated

import msgspec
from fastapi import APIRouter, Path, Request, Response

from app.dependencies import RobotDep, ServicesDep
from app.http.language import language_of
from app.http.negotiation import JSON, TEXT, wanted_type
from app.http.query import check_query
from app.http.responses import respond
from app.openapi.answers import REF
from app.openapi.problems import PROBLEMS
from robots.meshes import Mesh, digest_of, mesh_of, meshes_of

AGE = "public, max-age=86400"
KEPT_FILES = 64
"""Compressed files in memory; those of one arm are about 2 MB."""

router = APIRouter(prefix="/v1/robots/{robot_id}/meshes", tags=["robots"], responses=PROBLEMS)


class MeshLine(msgspec.Struct, kw_only=True):
    """One mesh: how the URDF names it, and where to get it, relative to the service's root."""

    filename: str
    href: str
    bytes: int
    media_type: str


class MeshList(msgspec.Struct, kw_only=True):
    """The visual meshes of a robot; empty for uploads, whose files are never asked for."""

    meshes: list[MeshLine]


@router.get(
    "",
    summary="Visual meshes of a robot",
    responses={
        200: {
            "description": "The list.",
            "content": {JSON: {"schema": {"$ref": REF.format(name="MeshList")}}},
        }
    },
)
async def list_meshes(request: Request, stored: RobotDep, services: ServicesDep) -> Response:
    """Empty where the files are not installed or the robot was uploaded."""
    check_query(request, common=("format", "lang"))
    wanted = wanted_type(request, JSON, TEXT)
    found = await services.loaded(lambda: meshes_of(stored.id))
    lines = [
        {
            "filename": mesh.filename,
            "href": f"v1/robots/{stored.id}/meshes/{mesh.name}",
            "bytes": mesh.size,
            "media_type": mesh.media_type,
        }
        for mesh in found.values()
    ]
    return respond({"meshes": lines}, wanted, language_of(request))


@router.get(
    "/{name:path}",
    summary="A mesh file",
    response_class=Response,
    responses={200: {"description": "The file.", "content": {"application/octet-stream": {}}}},
)
async def read_mesh(
    request: Request,
    stored: RobotDep,
    name: Annotated[str, Path(examples=["panda_description/meshes/visual/link0.dae"])],
    services: ServicesDep,
) -> Response:
    """Compressed where the client takes gzip; with an ETag."""
    check_query(request, common=())
    mesh = await services.loaded(lambda: mesh_of(stored.id, name))
    tag = f'"{await services.loaded(lambda: digest_of(mesh))}"'
    headers = {"ETag": tag, "Cache-Control": AGE, "Vary": "Accept-Encoding"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    if "gzip" in request.headers.get("accept-encoding", ""):
        content = await services.loaded(lambda: _compressed(mesh))
        headers["Content-Encoding"] = "gzip"
    else:
        content = await services.loaded(mesh.path.read_bytes)
    return Response(content, headers=headers, media_type=mesh.media_type)


@lru_cache(maxsize=KEPT_FILES)
def _compressed(mesh: Mesh) -> bytes:
    return gzip.compress(mesh.path.read_bytes(), 6, mtime=0)
