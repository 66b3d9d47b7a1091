"""Rigid placements as 4x4 matrices: check, and conversion from and to xyz and rpy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from dh_to_urdf.messages import say

Matrix: TypeAlias = NDArray[np.float64]

GIMBAL = 3e-16
"""cos(pitch) below which only roll ± yaw is determined; yaw is then 0."""
ROUNDING = 1e-5
"""Largest entry of RᵀR - I that counts as rounding and is removed."""


PRINTED = 1e-3
"""Largest difference of an entry from that of the nearest rotation, where a matrix may be one that
was printed with few decimals."""


def rigid_transform(matrix: ArrayLike, *, printed: bool = False) -> Matrix:
    """Check a 4x4 homogeneous matrix and remove its rounding.

    Entries rounded to about six digits are accepted; the nearest rotation is returned then.

    Args:
        matrix: 4x4, rotation and translation in m.
        printed: Whether entries rounded to three digits are accepted too.

    Returns:
        A 4x4 matrix whose rotation is orthonormal to machine precision.

    Raises:
        ValueError: Wrong shape, not finite, no rotation, or a last row other than 0 0 0 1.
    """
    try:
        T = np.array(matrix, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(
            say("is not a 4x4 matrix of numbers; give four rows of four numbers")
        ) from None
    if T.shape != (4, 4):
        raise ValueError(say("is not a 4x4 matrix; give four rows of four numbers"))
    if not np.isfinite(T).all():
        raise ValueError(say("has an entry that is not finite"))
    if not np.array_equal(T[3], [0.0, 0.0, 0.0, 1.0]):
        raise ValueError(say("has a last row other than 0 0 0 1"))
    R = T[:3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        deviation = float(np.abs(R.T @ R - np.eye(3)).max())
        proper = float(np.linalg.det(R)) > 0
    most = 4.0 * PRINTED if printed else ROUNDING
    if deviation <= most and not proper:
        raise ValueError(
            say(
                "has a reflection in its upper left 3x3 block, which is no rotation: its columns"
                " are left-handed, as where two of them are exchanged or one has the wrong sign;"
                " give right-handed columns"
            )
        )
    # Products of huge numbers may be NaN, for which every comparison is False.
    near = R
    if 1e-14 < deviation <= most:
        U, _, Vt = np.linalg.svd(R)
        near = U @ Vt
    if not deviation <= most or (printed and float(np.abs(near - R).max()) > PRINTED):
        raise ValueError(
            say(
                "has no rotation in its upper left 3x3 block: its columns must be"
                " orthonormal to {rounding} and right-handed; give more digits, or rpy or"
                " quaternion_xyzw instead",
                rounding="1e-3" if printed else "1e-5",
            )
        )
    T[:3, :3] = near
    return T


def rigid_transforms(matrices: Matrix, *, printed: bool = False) -> Matrix:
    """Apply :func:`rigid_transform` to many matrices, shape (n, 4, 4), at once.

    Args:
        matrices: Shape (n, 4, 4).
        printed: As there.

    Raises:
        ValueError: As for one; the message ends with the index of the first that is refused.
    """
    T = np.array(matrices, dtype=np.float64)
    R = T[:, :3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        deviation = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2))
        good = np.isfinite(T).all(axis=(1, 2)) & (
            deviation <= (4.0 * PRINTED if printed else ROUNDING)
        )
        good &= (T[:, 3] == [0.0, 0.0, 0.0, 1.0]).all(axis=1) & (_determinants(R) > 0)
    if not good.all():
        first = int(np.flatnonzero(~good)[0])
        rigid_transform(T[first], printed=printed)
        raise ValueError(say("is no rigid placement"))
    mend = deviation > 1e-14
    if mend.any():
        U, _, Vt = np.linalg.svd(R[mend])
        near = U @ Vt
        far = np.abs(near - R[mend]).max(axis=(1, 2)) > PRINTED
        if printed and far.any():
            rigid_transform(T[np.flatnonzero(mend)[far][0]], printed=printed)
        T[mend, :3, :3] = near
    return T


def _determinants(R: Matrix) -> Matrix:
    """Return the determinants of matrices, (n, 3, 3) -> (n,), without factorisations."""
    a, b, c = R[:, 0], R[:, 1], R[:, 2]
    found: Matrix = (
        a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1])
        + a[:, 1] * (b[:, 2] * c[:, 0] - b[:, 0] * c[:, 2])
        + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    )
    return found


def is_mended(matrix: ArrayLike) -> bool:
    """Return True where :func:`rigid_transform` changes the matrix by more than 1e-12."""
    return bool(np.abs(rigid_transform(matrix) - np.asarray(matrix)).max() > 1e-12)


def from_xyz_rpy(xyz: ArrayLike, rpy: ArrayLike) -> Matrix:
    """Return the placement of URDF's xyz (m), rpy (rad): ``Rz(yaw) Ry(pitch) Rx(roll)``."""
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("xyz", np.asarray(rpy, dtype=np.float64)).as_matrix()
    T[:3, 3] = xyz
    return T


def from_xyz_quaternion(xyz: ArrayLike, quaternion_xyzw: ArrayLike) -> Matrix:
    """Return the placement of xyz (m) and a unit quaternion x, y, z, w (either sign).

    Raises:
        ValueError: The quaternion's norm is farther than 1e-3 from 1.
    """
    quaternion = np.asarray(quaternion_xyzw, dtype=np.float64)
    if abs(float(np.linalg.norm(quaternion)) - 1.0) > 1e-3:
        raise ValueError(say("is no unit quaternion (x, y, z, w); divide it by its norm"))
    T = np.eye(4)
    T[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
    T[:3, 3] = xyz
    return T


def to_rpy(R: Matrix) -> tuple[float, float, float]:
    """Return URDF's roll, pitch, yaw of a rotation, rad, exact at every pitch.

    Pitch by ``atan2(-R31, hypot(R11, R21))``: the arcsine loses half the digits near ±90°. Roll
    and pitch are computed from ``R`` without yaw, so that the product is ``R`` near ±90° too.
    """
    return rows_to_rpy(R.tolist())


def rows_to_rpy(
    rows: Sequence[Sequence[float]], lock: float = GIMBAL
) -> tuple[float, float, float]:
    """Return roll, pitch, yaw of a rotation or placement given as rows of numbers, rad.

    Args:
        rows: The first three rows.
        lock: Size of cos(pitch) up to which only roll ± yaw is determined; yaw is 0 then.
    """
    (r11, r12, r13, *_), (r21, r22, r23, *_), (r31, *_) = rows[:3]
    yaw = math.atan2(r21, r11) if math.hypot(r11, r21) > lock else 0.0
    cos, sin = math.cos(yaw), math.sin(yaw)
    pitch = math.atan2(-r31, cos * r11 + sin * r21)
    roll = math.atan2(sin * r13 - cos * r23, cos * r22 - sin * r12)
    return roll, pitch, yaw
