"""What is doubtful of a mesh on its robot."""

from __future__ import annotations

import math

from dh_to_urdf.messages import say
from robots.robot import Robot
from robots.shapes import scales_of
from robots.uploaded_mesh import UploadedMesh

LARGE = 20.0
"""Times the reach of a robot beyond which a part of it is taken to be in another unit. A part of a
twentieth of the reach is beyond it when it is given in mm."""
SMALL = 1e-4
"""Part of the reach below which the same holds."""


def doubts_of_mesh(robot: Robot, mesh: UploadedMesh) -> tuple[str, ...]:
    """Return warnings where a mesh, scaled as the URDF says, is far larger or smaller than reach.

    The reach is a bound of the distance of any frame from the root.
    """
    reach = robot.span
    if not 0.0 < reach < math.inf:
        return ()
    lengths = [b - a for a, b in zip(mesh.lower, mesh.upper, strict=True)]
    found = []
    for scale in scales_of(robot, mesh.name):
        size = max(abs(s) * length for s, length in zip(scale, lengths, strict=True))
        if size > LARGE * reach:
            found.append(
                say(
                    "it is {size:.4g} m large, and the robot reaches {reach:.4g} m: it is probably"
                    ' in mm; write scale="0.001 0.001 0.001" in the URDF\'s <mesh>',
                    size=size,
                    reach=reach,
                )
            )
        elif size < SMALL * reach:
            found.append(
                say(
                    "it is {size:.4g} m large, and the robot reaches {reach:.4g} m; look at the"
                    " scale in the URDF's <mesh>",
                    size=size,
                    reach=reach,
                )
            )
    return tuple(found)
