"""Orientations as the makers of robots write them, both ways.

Triples of angles are Euler angles in one order of axes or another; what makers call them differs:

=================  =====================  ====================================
format             values                 rotation
=================  =====================  ====================================
rotation_vector    axis times angle       exp of the vector
quaternion_wxyz    w, x, y, z
kuka_abc           A, B, C                Rz(A) Ry(B) Rx(C)
fanuc_wpr          W, P, R                Rz(R) Ry(P) Rx(W)
abb_quaternion     q1, q2, q3, q4         q1 is the real part
ur_rotation_vector rx, ry, rz             exp of the vector
staubli_rxryrz     rx, ry, rz             Rx(rx) Ry(ry) Rz(rz)
yaskawa_rxryrz     Rx, Ry, Rz             Rz(Rz) Ry(Ry) Rx(Rx)
kawasaki_oat       O, A, T                Rz(O) Ry(A) Rz(T)
denso_rxryrz       RX, RY, RZ             Rz(RZ) Ry(RY) Rx(RX)
comau_euler        E1, E2, E3             Rz(E1) Ry(E2) Rz(E3)
=================  =====================  ====================================
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.orientation import (
    DEGENERATE,
    euler_angles,
    quaternion_xyzw,
    rotation_from_euler,
    rotation_from_quaternion,
)
from robots.robot import FloatArray

UNIT = 1e-3
"""Largest difference of a quaternion's norm from 1."""
_LEAST = 1e-9
"""Half an angle, rad, below which its sine is itself to rounding."""


@dataclass(frozen=True, slots=True)
class OrientationFormat:
    """One way to write an orientation.

    Attributes:
        name: Its name in requests and answers.
        kind: Euler angles, a rotation vector, or a quaternion with its real part first.
        sequence: Order of the axes of Euler angles, see :mod:`kinematics.orientation`.
        description: Its values and what they mean, for documents.
    """

    name: str
    kind: Literal["euler", "vector", "quaternion_wxyz"]
    sequence: str = ""
    description: str = ""

    @property
    def size(self) -> int:
        """Return the number of values."""
        return 4 if self.kind == "quaternion_wxyz" else 3

    @property
    def is_angular(self) -> bool:
        """Return whether its values are angles."""
        return self.kind != "quaternion_wxyz"

    def rotation(self, values: FloatArray) -> FloatArray:
        """Return the rotation matrix of values, (size,) -> (3, 3); angles in rad.

        Raises:
            ValueError: A quaternion's norm is farther than 1e-3 from 1.
        """
        if self.kind == "euler":
            return rotation_from_euler(self.sequence, values)
        if self.kind == "vector":
            return rotation_from_quaternion(_quaternion_of_vector(values))
        if not abs(float(np.linalg.norm(values)) - 1.0) <= UNIT:
            raise ValueError(say("is no unit quaternion (w, x, y, z); divide it by its norm"))
        return rotation_from_quaternion(values[[1, 2, 3, 0]])

    def values(self, R: FloatArray) -> FloatArray:
        """Return the values of rotations, (…, 3, 3) -> (…, size); angles in rad.

        Of both triples of Euler angles the one with the second angle in [-π/2, π/2] (three axes)
        or [0, π] (first and third the same); where only sum or difference of the outer angles is
        determined, see :func:`kinematics.orientation.euler_angles`. Rotation vectors are at most
        π long, and quaternions have w ≥ 0.
        """
        if self.kind == "euler":
            return euler_angles(R, self.sequence).solutions[..., 0, :]
        quaternions = quaternion_xyzw(R)
        if self.kind == "vector":
            return _vector_of_quaternion(quaternions)
        return np.asarray(quaternions[..., [3, 0, 1, 2]])

    def is_degenerate(self, R: FloatArray) -> NDArray[np.bool_]:
        """Return where other values give the same rotation to rounding; (…, 3, 3) -> (…).

        Of a half turn the rotation vector may point either way.
        """
        if self.kind == "euler":
            return euler_angles(R, self.sequence).degenerate
        if self.kind == "vector":
            return np.asarray(quaternion_xyzw(R)[..., 3] < DEGENERATE)
        return np.zeros(R.shape[:-2], dtype=bool)


def _quaternion_of_vector(vector: FloatArray) -> FloatArray:
    half = float(np.linalg.norm(vector)) / 2.0
    # sin(h) / (2 h): its series where h is small.
    factor = 0.5 if half < _LEAST else np.sin(half) / (2.0 * half)
    return np.append(factor * vector, np.cos(half))


def _vector_of_quaternion(quaternions: FloatArray) -> FloatArray:
    axis, w = quaternions[..., :3], quaternions[..., 3]
    sine = np.linalg.norm(axis, axis=-1)
    angle = 2.0 * np.arctan2(sine, w)
    factor = np.where(sine < _LEAST, 2.0, angle / np.maximum(sine, _LEAST))
    return np.asarray(factor[..., None] * axis) + 0.0


FORMATS = {
    one.name: one
    for one in (
        OrientationFormat("rotation_vector", "vector", description="axis times angle"),
        OrientationFormat("quaternion_wxyz", "quaternion_wxyz", description="quaternion w,x,y,z"),
        OrientationFormat(
            "kuka_abc", "euler", sequence="ZYX", description="KUKA A,B,C = Rz(A) Ry(B) Rx(C)"
        ),
        OrientationFormat(
            "fanuc_wpr", "euler", sequence="xyz", description="Fanuc W,P,R = Rz(R) Ry(P) Rx(W)"
        ),
        OrientationFormat(
            "abb_quaternion", "quaternion_wxyz", description="ABB q1,q2,q3,q4 with q1 real"
        ),
        OrientationFormat(
            "ur_rotation_vector",
            "vector",
            description="Universal Robots rx,ry,rz = axis times angle",
        ),
        OrientationFormat(
            "staubli_rxryrz", "euler", sequence="XYZ", description="Stäubli rx,ry,rz = Rx Ry Rz"
        ),
        OrientationFormat(
            "yaskawa_rxryrz", "euler", sequence="xyz", description="Yaskawa Rx,Ry,Rz = Rz Ry Rx"
        ),
        OrientationFormat(
            "kawasaki_oat",
            "euler",
            sequence="ZYZ",
            description="Kawasaki O,A,T = Rz(O) Ry(A) Rz(T)",
        ),
        OrientationFormat(
            "denso_rxryrz", "euler", sequence="xyz", description="Denso RX,RY,RZ = Rz Ry Rx"
        ),
        OrientationFormat(
            "comau_euler", "euler", sequence="ZYZ", description="Comau E1,E2,E3 = Rz Ry Rz"
        ),
    )
}
"""Besides quaternion_xyzw, rpy and euler."""
