"""The meshes of a robot as answers list them."""

from __future__ import annotations

from typing import Any
from urllib.parse import quote

import msgspec

from kinematics.meshes.doubts import doubts_of_mesh
from robots.meshes import meshes_of
from robots.robot import Robot
from robots.shapes import MeshUse, mesh_users
from robots.stored_robot import StoredRobot
from robots.uploaded_mesh import MEDIA_TYPE, UploadedMesh


class MeshBounds(msgspec.Struct, kw_only=True):
    """The box about a mesh, in its own axes and before the URDF's scale, m."""

    lower: list[float]
    upper: list[float]


class MeshHull(msgspec.Struct, kw_only=True):
    """The convex solid that stands for a mesh in clearances: how far it may reach beyond, m."""

    vertices: int
    excess: float


class MeshLine(msgspec.Struct, kw_only=True):
    """One mesh: how the URDF names it, and where to get it, relative to the service's root.

    Of an uploaded mesh also what was read. ``triangles`` are those of the file, ``shown_triangles``
    those that are kept; every uploaded mesh is kept as binary glTF.
    """

    filename: str
    href: str
    bytes: int
    media_type: str
    links: list[str] | msgspec.UnsetType = msgspec.UNSET
    format: str | msgspec.UnsetType = msgspec.UNSET
    vertices: int | msgspec.UnsetType = msgspec.UNSET
    triangles: int | msgspec.UnsetType = msgspec.UNSET
    shown_triangles: int | msgspec.UnsetType = msgspec.UNSET
    bounds: MeshBounds | msgspec.UnsetType = msgspec.UNSET
    watertight: bool | msgspec.UnsetType = msgspec.UNSET
    hull: MeshHull | msgspec.UnsetType = msgspec.UNSET
    warnings: list[str] | msgspec.UnsetType = msgspec.UNSET


class MeshList(msgspec.Struct, kw_only=True):
    """The meshes of a robot: of the library its visual ones, else those that were uploaded.

    ``missing`` are meshes that the URDF of an uploaded robot names and that were not uploaded.
    """

    meshes: list[MeshLine]
    missing: list[str]


def mesh_lines(stored: StoredRobot) -> list[dict[str, Any]]:
    """What the API says of the meshes of a robot."""
    if not stored.shipped:
        users = mesh_users(stored.robot)
        return [
            uploaded_line(stored.id, stored.robot, mesh, users[mesh.name])
            for mesh in stored.robot.meshes
        ]
    return [
        {
            "filename": mesh.filename,
            "href": f"v1/robots/{stored.id}/meshes/{mesh.name}",
            "bytes": mesh.size,
            "media_type": mesh.media_type,
        }
        for mesh in meshes_of(stored.id).values()
    ]


def uploaded_line(robot_id: str, robot: Robot, mesh: UploadedMesh, use: MeshUse) -> dict[str, Any]:
    """What the API says of an uploaded mesh."""
    return {
        "filename": use.filename,
        "href": f"v1/robots/{robot_id}/meshes/{quote(mesh.name)}",
        "bytes": mesh.size,
        "media_type": MEDIA_TYPE,
        "links": list(use.links),
        "format": mesh.format,
        "vertices": mesh.vertices,
        "triangles": mesh.triangles,
        "shown_triangles": mesh.shown_triangles,
        "bounds": {"lower": list(mesh.lower), "upper": list(mesh.upper)},
        "watertight": mesh.watertight,
        "hull": {"vertices": len(mesh.hull.vertices), "excess": mesh.hull.excess},
        "warnings": [*mesh.warnings, *doubts_of_mesh(robot, mesh)],
    }


def missing_meshes(stored: StoredRobot) -> list[str]:
    """The meshes that the URDF of an uploaded robot names and that it does not have."""
    if stored.shipped:
        return []
    known = {mesh.name for mesh in stored.robot.meshes}
    return [name for name in mesh_users(stored.robot) if name not in known]
