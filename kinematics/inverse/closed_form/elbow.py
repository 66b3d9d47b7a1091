"""Names of the elbow's postures, one meaning for all arms; compiled.

The shoulder S is the axis before the elbow's axis E; both have the direction h; W is the end of the
forearm. Seen along h, S and E are points, and E is on one side of the line from S to W. *Up* is the
side towards the base's +z; where +z is along that line as seen (or along h, as for arms that move
in a horizontal plane), the side towards +y, and where that is too, towards +x.
"""

from __future__ import annotations

from kinematics.compiled import inner
from kinematics.inverse.closed_form.vectors import Vector, cross, dot, norm

UP, DOWN = 0, 1
ALONG = 1e-9
"""Sine of the angle to the line below which an axis of the base counts as along it."""


@inner
def elbow_code(h: Vector, line: Vector, elbow: Vector) -> int:
    """Return whether an elbow is above the line from shoulder to wrist, all in base axes.

    Args:
        h: Unit direction of the axes of shoulder and elbow.
        line: From a point of the shoulder's axis to W, m.
        elbow: From a point of the shoulder's axis to a point of the elbow's, m.

    Returns:
        0 for up, 1 for down.
    """
    n = cross(h, line)
    least = ALONG * norm(n)
    upwards = n[2]
    if abs(upwards) <= least:
        upwards = n[1]
    if abs(upwards) <= least:
        upwards = n[0]
    return UP if dot(elbow, n) * upwards >= 0.0 else DOWN
