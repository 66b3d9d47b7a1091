"""The meshes of robots: a list, the files, and those that people upload."""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterable
from functools import lru_cache
from typing import Annotated, Any

from fastapi import APIRouter, Path, Request, Response

from app.access.control import key_of
from app.dependencies import RobotDep, Services, ServicesDep
from app.documents import BINARY
from app.http.bodies import read_body
from app.http.conditions import if_match_of, if_none_match_of
from app.http.language import language_of
from app.http.negotiation import JSON, TEXT, wanted_type
from app.http.query import check_query, flag_of
from app.http.responses import respond
from app.openapi.answers import REF
from app.openapi.problems import PROBLEMS
from app.routes.mesh_lines import mesh_lines, missing_meshes, uploaded_line
from robots.errors import AmbiguousMesh, MeshNotFound, ReadOnlyRobot
from robots.meshes import Mesh, digest_of, mesh_of
from robots.shapes import mesh_users
from robots.uploaded_mesh import MEDIA_TYPE
from robots.writer import Writer

AGE = "public, max-age=86400"
OWN_AGE = "private, no-cache"
"""Of an uploaded mesh, which may change and which not all may see: asked for again by its ETag."""
KEPT_FILES = 64
"""Compressed files in memory; those of one arm are about 2 MB."""
LEVEL = 5
OVERWRITE = "overwrite"

_OVERWRITING = {
    "parameters": [
        {
            "name": OVERWRITE,
            "in": "query",
            "required": False,
            "schema": {"type": "boolean", "default": False},
            "description": "Change a robot that another key has stored.",
        }
    ]
}
_NAME = Path(
    description="As the URDF writes it, with or without package://, or its end where that is"
    " enough.",
    examples=["panda_description/meshes/visual/link0.dae"],
)
_LINE: dict[int | str, dict[str, Any]] = {
    status: {
        "description": text,
        "content": {
            JSON: {"schema": {"$ref": REF.format(name="MeshLine")}},
            TEXT: {"schema": {"type": "string"}},
        },
    }
    for status, text in ((200, "The mesh, replaced."), (201, "The mesh."))
}

router = APIRouter(prefix="/v1/robots/{robot_id}/meshes", tags=["robots"], responses=PROBLEMS)


@router.get(
    "",
    summary="Meshes of a robot",
    responses={
        200: {
            "description": "The list.",
            "content": {JSON: {"schema": {"$ref": REF.format(name="MeshList")}}},
        }
    },
)
async def list_meshes(request: Request, stored: RobotDep, services: ServicesDep) -> Response:
    """Of the library visual meshes, where they are installed; of uploads those that came."""
    check_query(request, common=("format", "lang"))
    wanted = wanted_type(request, JSON, TEXT)
    answer = await services.loaded(
        lambda: {"meshes": mesh_lines(stored), "missing": missing_meshes(stored)}
    )
    return respond(answer, wanted, language_of(request))


@router.get(
    "/{name:path}",
    summary="A mesh file",
    response_class=Response,
    responses={200: {"description": "The file.", "content": {"application/octet-stream": {}}}},
)
async def read_mesh(
    request: Request, stored: RobotDep, name: Annotated[str, _NAME], services: ServicesDep
) -> Response:
    """Compressed where the client takes gzip; with an ETag."""
    check_query(request, common=())
    packed = "gzip" in request.headers.get("accept-encoding", "")
    if stored.shipped:
        mesh = await services.loaded(lambda: mesh_of(stored.id, name))
        tag = f'"{await services.loaded(lambda: digest_of(mesh))}"'
        known = _not_modified(request, tag, AGE)
        if known is not None:
            return known
        content = await services.loaded(lambda: _compressed(mesh) if packed else _read(mesh))
        return _file(content, tag, AGE, mesh.media_type, packed=packed)
    full = found_name(stored.id, name, [mesh.name for mesh in stored.robot.meshes])
    digest = next(mesh.digest for mesh in stored.robot.meshes if mesh.name == full)
    known = _not_modified(request, f'"{digest}"', OWN_AGE)
    if known is not None:
        return known
    store = services.store_of(request)

    def own() -> tuple[str, bytes]:
        mesh, content = store.mesh_file(stored.id, full)
        return mesh.digest, gzip.compress(content, LEVEL, mtime=0) if packed else content

    digest, content = await services.loaded(own)
    return _file(content, f'"{digest}"', OWN_AGE, MEDIA_TYPE, packed=packed)


@router.put(
    "/{name:path}",
    summary="Upload or replace a mesh",
    responses=_LINE,
    openapi_extra=_OVERWRITING
    | {
        "requestBody": {
            "required": True,
            "content": {"application/octet-stream": {"schema": BINARY}},
        }
    },
)
async def put_mesh(
    request: Request, stored: RobotDep, name: Annotated[str, _NAME], services: ServicesDep
) -> Response:
    """STL, OBJ, PLY, glTF or COLLADA, for a mesh that the robot's URDF names.

    If-Match and If-None-Match take the ETag of the mesh or of the robot.
    """
    check_query(request, OVERWRITE, common=("format", "lang"))
    wanted = wanted_type(request, JSON, TEXT)
    if stored.shipped:
        raise ReadOnlyRobot(stored.id)
    full = found_name(stored.id, name, await services.loaded(lambda: mesh_users(stored.robot)))
    writer, store = _writer(request, services), services.store_of(request)
    if_match, unless = if_match_of(request), if_none_match_of(request)
    body = await read_body(request, services.settings.max_mesh_bytes)
    mesh = await services.mesh_read(lambda: services.meshes.mesh(full, body), request, len(body))

    def put() -> tuple[dict[str, Any], bool]:
        changed, is_new = store.change_mesh(
            stored.id, full, mesh, writer=writer, if_match=if_match, if_none_match=unless
        )
        robot = changed.robot
        line = uploaded_line(stored.id, robot, mesh[0], mesh_users(robot)[full])
        return line, is_new

    line, is_new = await services.stored(put)
    headers = {"ETag": f'"{mesh[0].digest}"'}
    if is_new:
        headers["Location"] = f"{request.scope.get('root_path', '')}/{line['href']}"
    status = 201 if is_new else 200
    return respond(line, wanted, language_of(request), status=status, headers=headers)


@router.delete("/{name:path}", status_code=204, summary="Delete a mesh", openapi_extra=_OVERWRITING)
async def delete_mesh(
    request: Request, stored: RobotDep, name: Annotated[str, _NAME], services: ServicesDep
) -> Response:
    """Only meshes that were uploaded; the robot and its other meshes stay."""
    check_query(request, OVERWRITE)
    if stored.shipped:
        raise ReadOnlyRobot(stored.id)
    full = found_name(stored.id, name, [mesh.name for mesh in stored.robot.meshes])
    writer, store = _writer(request, services), services.store_of(request)
    if_match, unless = if_match_of(request), if_none_match_of(request)
    await services.stored(
        lambda: store.change_mesh(
            stored.id, full, None, writer=writer, if_match=if_match, if_none_match=unless
        )
    )
    return Response(status_code=204)


def found_name(robot_id: str, given: str, names: Iterable[str]) -> str:
    """The mesh that a path names: whole, or by its end where one mesh ends so.

    Raises:
        MeshNotFound: No mesh ends so.
        AmbiguousMesh: Several do.
    """
    known = tuple(names)
    # Servers in between join slashes.
    name = re.sub(r"^package:/+", "", given)
    if name in known:
        return name
    ends = tuple(one for one in known if one.endswith(f"/{name}"))
    if not name or not ends:
        raise MeshNotFound(robot_id, name, known)
    if len(ends) > 1:
        raise AmbiguousMesh(name, ends)
    return ends[0]


def _writer(request: Request, services: Services) -> Writer:
    """Who changes the robot's meshes; without keys nobody is known, and each may."""
    overwrite = flag_of(request, OVERWRITE) or key_of(request.scope) is None
    return services.writer_of(request, overwrite=overwrite)


def _not_modified(request: Request, tag: str, age: str) -> Response | None:
    if tag not in request.headers.get("if-none-match", ""):
        return None
    return Response(status_code=304, headers=_headers(tag, age))


def _headers(tag: str, age: str) -> dict[str, str]:
    return {"ETag": tag, "Cache-Control": age, "Vary": "Accept-Encoding"}


def _file(content: bytes, tag: str, age: str, media_type: str, *, packed: bool) -> Response:
    headers = _headers(tag, age) | ({"Content-Encoding": "gzip"} if packed else {})
    return Response(content, headers=headers, media_type=media_type)


def _read(mesh: Mesh) -> bytes:
    return mesh.path.read_bytes()


@lru_cache(maxsize=KEPT_FILES)
def _compressed(mesh: Mesh) -> bytes:
    return gzip.compress(mesh.path.read_bytes(), 6, mtime=0)
