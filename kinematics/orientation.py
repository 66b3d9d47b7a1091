"""Orientations: quaternion, roll-pitch-yaw, and every Euler sequence with both solutions.

An upper-case sequence such as ``ZXZ`` is intrinsic (axes of the moving body):
``R = Rz(φ) Rx(θ) Rz(ψ)``. A lower-case one such as ``xyz`` is extrinsic (fixed axes):
``R = Rz(γ) Ry(β) Rx(α)``, which is URDF's rpy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from dh_to_urdf.poses import rows_to_rpy
from kinematics.errors import RepresentationSingularity, UnknownSequence
from robots.robot import FloatArray

DEGENERATE = 1e-12
"""|sin θ| (proper) or |cos θ| (three axes) below which only φ ± ψ is determined."""

CHUNK = 4096
"""Rotations given to SciPy at once: it holds the GIL meanwhile."""

_AXES = "XYZ"
_EVEN = {(0, 1, 2), (1, 2, 0), (2, 0, 1)}


@dataclass(frozen=True)
class EulerAngles:
    """Both triples of Euler angles of a rotation.

    Attributes:
        sequence: The sequence as given.
        solutions: Shape (..., 2, 3), rad in (-π, π]. The first has θ in [0, π] (proper
            sequences) or [-π/2, π/2]; the second is (φ+π, -θ or π-θ, ψ+π).
        degenerate: Shape (...): True where infinitely many triples exist; φ is then set to 0.
    """

    sequence: str
    solutions: FloatArray
    degenerate: NDArray[np.bool_]


def parse_sequence(
    sequence: str, argument: str = "euler", index: Location = ()
) -> tuple[tuple[int, int, int], bool]:
    """Return the axis numbers of an intrinsic sequence, and whether the text was extrinsic.

    Extrinsic angles about a, b, c are the intrinsic ones about c, b, a in reverse order.

    Args:
        sequence: Such as ``ZXZ`` or ``xyz``; see the head of this module.
        argument: Name of the argument in errors.
        index: Place of the sequence within that argument, for errors.

    Raises:
        UnknownSequence: Not three letters of one case out of XYZ without a repetition in a row.
    """
    upper = sequence.upper()
    if (
        len(sequence) != 3
        or sequence not in (upper, sequence.lower())
        or any(letter not in _AXES for letter in upper)
        or upper[0] == upper[1]
        or upper[1] == upper[2]
    ):
        raise UnknownSequence(
            say(
                "{sequence!r} is no Euler sequence; give three axes such as ZXZ or ZYX"
                " (upper case: moving axes) or xyz (lower case: fixed axes), no axis"
                " twice in a row",
                sequence=sequence[:16],
            ),
            argument=argument,
            index=index,
            value=sequence,
        )
    extrinsic = sequence != upper
    order = upper[::-1] if extrinsic else upper
    return (_AXES.index(order[0]), _AXES.index(order[1]), _AXES.index(order[2])), extrinsic


def euler_angles(R: FloatArray, sequence: str) -> EulerAngles:
    """Return both Euler triples of rotations, rad, exact at every orientation.

    φ comes from the third body axis, θ and ψ from the rotation with φ taken out, so that the
    product of the three rotations is R to rounding, however close to the degenerate case.

    Args:
        R: Shape (..., 3, 3).
        sequence: See the head of this module.

    Returns:
        The triples.

    Raises:
        UnknownSequence: Not a sequence.
    """
    (i, j, k), extrinsic = parse_sequence(sequence)
    proper = i == k
    last = 3 - i - j if proper else k
    sign = 1.0 if (i, j, last) in _EVEN else -1.0
    w = R[..., :, k]
    if proper:
        y, x = w[..., j], -sign * w[..., last]
    else:
        y, x = -sign * w[..., j], w[..., last]
    degenerate = np.hypot(x, y) < DEGENERATE
    phi = np.where(degenerate, 0.0, np.arctan2(y, x))
    cos, sin = np.cos(phi), np.sin(phi)
    across = sin * y + cos * x
    theta = np.arctan2(across, w[..., i]) if proper else np.arctan2(sign * w[..., i], across)
    row = cos[..., None] * R[..., j, :] + sign * sin[..., None] * R[..., last, :]
    psi = np.arctan2((-sign if proper else sign) * row[..., last if proper else i], row[..., j])
    first = np.stack((phi, theta, psi), axis=-1)
    second = np.stack((phi + np.pi, -theta if proper else np.pi - theta, psi + np.pi), axis=-1)
    solutions = np.stack((first, wrap(second)), axis=-2)
    if extrinsic:
        solutions = solutions[..., ::-1]
    return EulerAngles(sequence, solutions + 0.0, np.asarray(degenerate))


def wrap(angles: FloatArray) -> FloatArray:
    """Return angles in (-π, π]."""
    return np.asarray(np.pi - np.mod(np.pi - angles, 2 * np.pi))


def rotation_from_euler(
    sequence: str, angles: FloatArray, argument: str = "euler", index: Location = ()
) -> FloatArray:
    """Return the rotation matrix (3, 3) of Euler angles in rad.

    Raises:
        UnknownSequence: Not a sequence.
    """
    if sequence == "xyz":
        return np.asarray(pin.rpy.rpyToMatrix(*angles))
    parse_sequence(sequence, argument, index)
    return np.asarray(Rotation.from_euler(sequence, angles).as_matrix())


def rotation_from_quaternion(quaternion_xyzw: FloatArray) -> FloatArray:
    """Return the rotation matrix (3, 3) of a quaternion x, y, z, w, normalised to norm 1.

    Raises:
        ValueError: Its norm is farther than 1e-3 from 1.
    """
    norm = float(np.linalg.norm(quaternion_xyzw))
    if not abs(norm - 1.0) <= 1e-3:
        raise ValueError(say("is no unit quaternion (x, y, z, w); divide it by its norm"))
    return np.asarray(pin.Quaternion(quaternion_xyzw / norm).matrix())


def euler_rates_matrix(sequence: str, angles: FloatArray) -> FloatArray:
    """Return E with ``ω = E [φ̇, θ̇, ψ̇]``, ω in base axes.

    Args:
        sequence: See the head of this module.
        angles: Shape (..., 3), rad, in the order of the sequence.

    Returns:
        Shape (..., 3, 3).

    Raises:
        UnknownSequence: Not a sequence.
    """
    (i, j, k), extrinsic = parse_sequence(sequence)
    ordered = angles[..., ::-1] if extrinsic else angles
    first = _about(i, ordered[..., 0])
    second = first @ _about(j, ordered[..., 1])
    unit = np.eye(3)
    axes = (np.broadcast_to(unit[i], first.shape[:-1]), first[..., :, j], second[..., :, k])
    E = np.stack(axes, axis=-1)
    return E[..., ::-1] if extrinsic else E


def _about(axis: int, angle: FloatArray) -> FloatArray:
    rotvec = np.zeros((*np.shape(angle), 3))
    rotvec[..., axis] = angle
    shape = rotvec.shape[:-1]
    matrices = Rotation.from_rotvec(rotvec.reshape(-1, 3)).as_matrix()
    return np.asarray(matrices.reshape(*shape, 3, 3))


def analytic_map(R: FloatArray, sequence: str) -> FloatArray:
    """Return ``inv(E)``, which maps ω in base axes to Euler rates of the first triple.

    Args:
        R: Shape (..., 3, 3).
        sequence: See the head of this module.

    Returns:
        Shape (..., 3, 3).

    Raises:
        UnknownSequence: Not a sequence.
        RepresentationSingularity: E has no inverse: θ is at the sequence's singular value.
    """
    E = euler_rates_matrix(sequence, euler_angles(R, sequence).solutions[..., 0, :])
    determinant = np.abs(np.linalg.det(E))
    if (determinant < 1e-9).any():
        raise RepresentationSingularity(
            say(
                "at this orientation the {sequence} angles have no rates (|det E| ="
                " {min:.1e}); choose another Euler sequence or the geometric Jacobian",
                sequence=sequence,
                min=float(determinant.min()),
            ),
            argument="euler",
            value=sequence,
            sequence=sequence,
            determinant=float(determinant.min()),
        )
    return np.asarray(np.linalg.inv(E), dtype=np.float64)


def quaternion_xyzw(R: FloatArray) -> FloatArray:
    """Return unit quaternions x, y, z, w with w ≥ 0; shape (..., 3, 3) -> (..., 4)."""
    if R.ndim == 2:
        single: FloatArray = pin.Quaternion(R).coeffs()
        return -single if single[3] < 0.0 else single
    shape, flat = R.shape[:-2], R.reshape(-1, 3, 3)
    quaternions = np.empty((len(flat), 4))
    for k in range(0, len(flat), CHUNK):
        part = Rotation.from_matrix(flat[k : k + CHUNK], assume_valid=True)
        quaternions[k : k + CHUNK] = part.as_quat(canonical=True)
    return quaternions.reshape(*shape, 4)


def rpy(R: FloatArray) -> FloatArray:
    """Return URDF's roll, pitch, yaw (fixed axes x, y, z), rad; shape (..., 3, 3) -> (..., 3).

    At a pitch of ±90°, see :func:`is_locked`, yaw is 0, as the sequence xyz has it.
    """
    if R.ndim == 2:
        return np.array(rows_to_rpy(R.tolist(), DEGENERATE)) + 0.0
    return euler_angles(R, "xyz").solutions[..., 0, :]


def is_locked(R: FloatArray) -> NDArray[np.bool_]:
    """Return whether only roll ± yaw of a rotation is determined; (..., 3, 3) -> (...)."""
    return np.asarray(np.hypot(R[..., 0, 0], R[..., 1, 0]) < DEGENERATE)
