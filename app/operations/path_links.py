"""What of the arm keeps clear of obstacles: fields of a path, and what the answer says of them."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from app.fields.per_joint import PerJoint, read_per_joint
from app.http.units import Units
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import chained, say
from kinematics.errors import InvalidOption
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.link_geometry import LinkGeometry, link_geometry, too_near
from kinematics.redundancy.problem import PathProblem
from robots.robot import FloatArray

GEOMETRIES = ("skeleton", "urdf")
MAX_RADIUS = 1e6


class LinkPart(TypedDict):
    """A capsule that is kept clear of obstacles: a shape of a link, or what bounds it.

    ``joint`` is the last joint that moves it; ``excess`` how far the capsule sticks out of the
    shape at most, 0 where it is the shape.
    """

    link: str
    joint: str
    shape: str
    radius: float
    length: float | None
    excess: float


def read_radius(value: PerJoint, arm: Arm) -> float | FloatArray:
    """link_radius: one for all, or that of the segment that begins at each joint, shape (K,)."""
    radii = read_per_joint(value, arm, 0.0, MAX_RADIUS, "link_radius")
    return value if isinstance(value, float | int) else arm.reduced(radii)


def read_geometry(
    name: str, radius: float | FloatArray, arm: Arm, q: FloatArray
) -> LinkGeometry | None:
    """The arm's own shapes, where the request asks for them.

    Raises:
        InvalidOption: There is no such geometry.
    """
    if name not in GEOMETRIES:
        raise InvalidOption(
            say(
                "link_geometry is {name}; give {geometries}",
                name=quoted(name),
                geometries=chained(say(" or "), GEOMETRIES),
            ),
            argument="link_geometry",
            value=name,
            known=GEOMETRIES,
        )
    if name == "skeleton":
        return None
    return link_geometry(arm, q, np.broadcast_to(np.asarray(radius, dtype=np.float64), (arm.K,)))


class LinksView(TypedDict):
    """Capsules of the links, where they come from the URDF."""

    links: list[LinkPart] | None


def links_view(problem: PathProblem, units: Units) -> tuple[LinksView, list[str]]:
    """Return the capsules for the answer, and warnings."""
    shaped = problem.shaped
    if shaped is None:
        return {"links": None}, []
    warnings = [*shaped.warnings, *too_near(shaped, problem.obstacles, problem.d_safe)]
    parts: list[LinkPart] = [
        {
            "link": part.link,
            "joint": part.joint,
            "shape": part.shape,
            "radius": units.length_out(part.radius),
            "length": None if part.length is None else units.length_out(part.length),
            "excess": units.length_out(part.excess),
        }
        for part in shaped.parts
    ]
    return {"links": parts}, warnings
