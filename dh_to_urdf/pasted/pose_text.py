"""Poses as the Robotics Toolbox prints them: ``t = 0, 0, 0.1; rpy/xyz = 0°, 90°, 0°``.

Corke and Haviland, *Not your grandmother's toolbox*, ICRA 2021: the line that ``SE3.strline`` and
MATLAB's ``trprint`` write.
"""

from __future__ import annotations

import math
import re

import numpy as np

from dh_to_urdf.poses import Matrix

_NUMBER = r"[-+−]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?|[-+−]?\.\d+(?:[eE][-+]?\d+)?"
_POSE = re.compile(
    r"\s*t\s*=\s*\(?([^;()=]{1,80}?)\)?\s*[;,]\s*"
    r"(rpy/xyz|rpy/zyx|rpy/yxz|rpy/arm|rpy/vehicle|rpy/camera|rpy|eul|angvec)"
    r"\s*=\s*\(?([^()=]{1,100})\)?\s*(deg|rad)?\s*",
    re.IGNORECASE,
)
_ORDERS = {
    **dict.fromkeys(("rpy/xyz", "rpy/arm"), "xyz"),
    **dict.fromkeys(("rpy/zyx", "rpy/vehicle", "rpy"), "zyx"),
    **dict.fromkeys(("rpy/yxz", "rpy/camera"), "yxz"),
}


def printed_pose(text: str) -> Matrix | None:
    """Return a printed pose as a 4x4 matrix, None for another text.

    Roll, pitch and yaw turn about the last, the middle and the first axis of ``xyz``, ``zyx`` or
    ``yxz``: ``R = Rx(yaw) Ry(pitch) Rz(roll)`` for ``rpy/xyz``. ``eul`` is ZYZ.

    Args:
        text: The line.
    """
    found = _POSE.fullmatch(text)
    if found is None:
        return None
    position, angles = _numbers(found[1]), _numbers(found[3])
    form = found[2].lower()
    if len(position) != 3 or len(angles) != (4 if form == "angvec" else 3):
        return None
    degrees = "°" in found[3] or (found[4] or "").lower() == "deg"
    unit = math.pi / 180 if degrees else 1.0
    T: Matrix = np.eye(4)
    T[:3, 3] = position
    if form == "angvec":
        T[:3, :3] = _about_vector(angles[0] * unit, np.array(angles[1:]))
        return T
    first, second, third = (angle * unit for angle in angles)
    if form == "eul":
        T[:3, :3] = _about("z", first) @ _about("y", second) @ _about("z", third)
    else:
        x, y, z = tuple(_ORDERS[form])
        T[:3, :3] = _about(x, third) @ _about(y, second) @ _about(z, first)
    return T


def _numbers(text: str) -> list[float]:
    parts = re.split(r"[,|\s]+", text.replace("°", " ").strip(" ,|"))
    if not all(re.fullmatch(_NUMBER, part) for part in parts):
        return []
    return [float(part.replace("−", "-")) for part in parts]


def _about(axis: str, angle: float) -> Matrix:
    c, s = math.cos(angle), math.sin(angle)
    k = "xyz".index(axis)
    R = np.eye(3)
    i, j = (k + 1) % 3, (k + 2) % 3
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


def _about_vector(angle: float, axis: Matrix) -> Matrix:
    """Return the rotation about a vector; the identity where it is zero."""
    size = float(np.linalg.norm(axis))
    if size == 0.0:
        return np.eye(3)
    x, y, z = axis / size
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * (K @ K))
