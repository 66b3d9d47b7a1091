"""Poses of a program: ``transl``, ``trotx``, ``rpy2tr``, ``SE3(…)``, ``SE3.Rx`` and their like."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.arrays import as_array, flat_numbers, of_matrix, to_matrix
from dh_to_urdf.pasted.programs.numbers import in_radians, known
from dh_to_urdf.pasted.programs.values import Array, Items, Pose, Unread, Value
from dh_to_urdf.poses import Matrix

_TURN = 2 * math.pi * (1 + 1e-9)
_AXES = {"x": 0, "y": 1, "z": 2}


@dataclass
class PoseCall:
    """A call that makes a pose.

    Attributes:
        name: The function, such as ``trotx`` or ``SE3.Rx``.
        line: Where it stands.
        arguments: Its values.
        keywords: Its named values.
        is_matlab: Whether the program is MATLAB.
        angle: Unit of bare angles as the user says it, ``rad``, ``deg`` or None.
        warnings: Receives what was assumed.
    """

    name: str
    line: int
    arguments: list[Value]
    keywords: dict[str, Value]
    is_matlab: bool
    angle: str | None
    warnings: list[str] = field(default_factory=list)
    words: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Take options such as ``'deg'`` and ``unit='deg'`` out of the arguments."""
        self.words = [str(a).lower() for a in self.arguments if isinstance(a, str)]
        self.words += [str(v).lower() for k, v in self.keywords.items() if k in ("unit", "order")]
        self.arguments = [a for a in self.arguments if not isinstance(a, str)]
        named = {k: v for k, v in self.keywords.items() if k not in ("unit", "order", "check")}
        self.keywords = named
        unknown = [w for w in self.words if w not in _OPTIONS]
        if unknown:
            raise Unread(
                say("has an option {unknown} that is not read", unknown=quoted(unknown[0]))
            )

    def turn(self, total: Sum) -> float:
        """Return an angle in rad.

        Raises:
            DHError: A bare angle that looks like degrees.
        """
        if "deg" in self.words:
            return math.radians(in_radians(total))
        if "rad" in self.words or total.plain == 0.0:
            return in_radians(total)
        if self.angle == "deg":
            return math.radians(total.plain) + total.angle
        if self.angle is None and abs(total.plain) > _TURN:
            raise DHError.single(
                (),
                say(
                    "line {line}: {plain:g} in {name} has no unit and is no angle in rad as"
                    " people write them; write {plain:g}*pi/180, or give angle=deg (or"
                    " angle=rad if it is meant)",
                    line=self.line,
                    plain=total.plain,
                    name=self.name,
                ),
            )
        return in_radians(total)

    def numbers(self, size: int) -> list[Sum]:
        """Return so many numbers, as arguments of their own or as one vector.

        Raises:
            Unread: Other arguments.
        """
        if self.keywords:
            raise Unread(
                say(
                    "has an argument {keywords} that is not read",
                    keywords=quoted(next(iter(self.keywords))),
                )
            )
        if len(self.arguments) == 1 and isinstance(self.arguments[0], (Items, Array)):
            return flat_numbers(self.arguments[0], size)
        if len(self.arguments) != size:
            raise Unread(say("needs {size} numbers", size=size))
        return [known(value) for value in self.arguments]


_OPTIONS = ("deg", "rad", "zyx", "xyz", "yxz", "vehicle", "arm", "camera")


def turned(axis: str, angle: float) -> Matrix:
    """Return the rotation about an axis, 4x4."""
    T = np.eye(4)
    first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    c, s = math.cos(angle), math.sin(angle)
    # cos(pi/2) is 6e-17 in floats; the program holds the same.
    T[first, first] = T[second, second] = c
    T[first, second], T[second, first] = -s, s
    return T


def shifted(x: float, y: float, z: float) -> Matrix:
    """Return the translation, 4x4."""
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def _rotation(axis: str) -> Callable[[PoseCall], Matrix]:
    def of(call: PoseCall) -> Matrix:
        T = np.eye(4)
        if "t" in call.keywords:
            T[:3, 3] = [in_radians(n) for n in flat_numbers(call.keywords.pop("t"), 3)]
        (angle,) = call.numbers(1)
        T[:3, :3] = turned(axis, call.turn(angle))[:3, :3]
        return T

    return of


def _along(axis: str) -> Callable[[PoseCall], Matrix]:
    def of(call: PoseCall) -> Matrix:
        (length,) = call.numbers(1)
        T = np.eye(4)
        T[_AXES[axis], 3] = in_radians(length)
        return T

    return of


def _translation(call: PoseCall) -> Matrix:
    x, y, z = (in_radians(length) for length in call.numbers(3))
    return shifted(x, y, z)


def _roll_pitch_yaw(call: PoseCall) -> Matrix:
    roll, pitch, yaw = (call.turn(angle) for angle in call.numbers(3))
    order = next((w for w in call.words if w not in ("deg", "rad")), None)
    order = {"vehicle": "zyx", "arm": "xyz", "camera": "yxz"}.get(order or "zyx", order or "zyx")
    if call.is_matlab and sum(angle != 0.0 for angle in (roll, pitch, yaw)) > 1:
        call.warnings.append(
            say(
                "line {line}: {call} is read as release 10 of the Toolbox does, R ="
                " Rz(yaw) Ry(pitch) Rx(roll), or Rx(roll) Ry(pitch) Rz(yaw) with 'xyz'"
                " (which was the default up to release 9)",
                line=call.line,
                call=call.name,
            )
        )
    first, last = (roll, yaw) if call.is_matlab and order == "xyz" else (yaw, roll)
    turns = zip(order, (first, pitch, last), strict=True)
    return _product([turned(axis, angle) for axis, angle in turns])


def _euler(call: PoseCall) -> Matrix:
    phi, theta, psi = (call.turn(angle) for angle in call.numbers(3))
    return _product([turned("z", phi), turned("y", theta), turned("z", psi)])


def _about_vector(call: PoseCall) -> Matrix:
    if len(call.arguments) != 2:
        raise Unread(say("needs an angle and a vector"))
    angle = call.turn(known(call.arguments[0]))
    v = np.array([in_radians(n) for n in flat_numbers(call.arguments[1], 3)])
    size = float(np.linalg.norm(v))
    if size == 0.0:
        raise Unread(say("turns about a vector of zeros"))
    x, y, z = v / size
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4)
    T[:3, :3] = np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K
    return T


def _product(matrices: Sequence[Matrix]) -> Matrix:
    T = matrices[0]
    for other in matrices[1:]:
        T = T @ other
    return T


def _rotation_and_translation(call: PoseCall) -> Matrix:
    if "t" in call.keywords:
        call.arguments.append(call.keywords.pop("t"))
    if not 1 <= len(call.arguments) <= 2 or call.keywords:
        raise Unread(say("needs a rotation and a translation"))
    T = np.eye(4)
    R = to_matrix(call.arguments[0])
    if R.shape not in ((3, 3), (4, 4)):
        raise Unread(say("needs a rotation, 3x3"))
    T[:3, :3] = R[:3, :3]
    if len(call.arguments) == 2:
        T[:3, 3] = [in_radians(n) for n in flat_numbers(call.arguments[1], 3)]
    return T


def _se3(call: PoseCall) -> Matrix:
    """Return what ``SE3()``, ``SE3(x, y, z)``, ``SE3([x, y, z])`` and ``SE3(T)`` make."""
    arguments = call.arguments
    if not arguments and not call.keywords:
        return np.eye(4)
    if len(arguments) == 1:
        matrix = pose_matrix(arguments[0])
        if matrix is not None:
            return matrix
    if len(arguments) == 2 and not isinstance(arguments[0], Sum):
        return _rotation_and_translation(call)
    return _translation(call)


def pose_matrix(value: Value) -> Matrix | None:
    """Return a 4x4 matrix that a value holds, None where it holds none.

    Raises:
        Unread: An element is unknown.
    """
    if isinstance(value, Pose):
        return value.matrix
    if not isinstance(value, (Array, Items)):
        return None
    array = as_array(value)
    return to_matrix(array) if array.shape == (4, 4) and not array.flat else None


_OBJECTS: dict[str, Callable[[PoseCall], Matrix]] = {
    "SE3": _se3,
    **{f"SE3.R{axis}": _rotation(axis) for axis in "xyz"},
    **{f"SE3.T{axis}": _along(axis) for axis in "xyz"},
    **{f"SE3.t{axis}": _along(axis) for axis in "xyz"},
    **dict.fromkeys(("SE3.Trans", "SE3.transl"), _translation),
    **dict.fromkeys(("SE3.RPY", "SE3.rpy"), _roll_pitch_yaw),
    **dict.fromkeys(("SE3.Eul", "SE3.eul"), _euler),
    **dict.fromkeys(("SE3.AngVec", "SE3.AngleAxis", "SE3.angvec"), _about_vector),
    **dict.fromkeys(("SE3.Rt",), _rotation_and_translation),
}
_MATRICES: dict[str, Callable[[PoseCall], Matrix]] = {
    **{f"trot{axis}": _rotation(axis) for axis in "xyz"},
    "transl": _translation,
    "trvec2tform": _translation,
    "rpy2tr": _roll_pitch_yaw,
    "eul2tr": _euler,
    "angvec2tr": _about_vector,
    "rt2tr": _rotation_and_translation,
    "r2t": _rotation_and_translation,
}
_ROTATIONS: dict[str, Callable[[PoseCall], Matrix]] = {
    **{f"rot{axis}": _rotation(axis) for axis in "xyz"},
    "rpy2r": _roll_pitch_yaw,
    "eul2r": _euler,
    "angvec2r": _about_vector,
}
NAMES = frozenset((*_OBJECTS, *_MATRICES, *_ROTATIONS))
"""Functions that make poses and rotations."""


def make_pose(call: PoseCall) -> Value:
    """Return what a function of :data:`NAMES` makes.

    Raises:
        Unread: Its arguments are not read.
        DHError: A bare angle that looks like degrees.
    """
    if call.name in _OBJECTS:
        return Pose(_OBJECTS[call.name](call))
    if call.name == "transl" and len(call.arguments) == 1:
        matrix = pose_matrix(call.arguments[0])
        if matrix is not None:
            column = Array(tuple((Sum(plain=float(x)),) for x in matrix[:3, 3]))
            return (
                column
                if call.is_matlab
                else Array((tuple(Sum(plain=float(x)) for x in matrix[:3, 3]),), flat=True)
            )
    if call.name in _MATRICES:
        return of_matrix(_MATRICES[call.name](call))
    return of_matrix(_ROTATIONS[call.name](call)[:3, :3])
