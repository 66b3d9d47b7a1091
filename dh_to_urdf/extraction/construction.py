"""The classical construction: axis lines -> D-H frames and the parameters between them.

Rows are made in the standard convention, frame k on axis k + 1 (Paul 1981; Spong, Hutchinson and
Vidyasagar, *Robot Modeling and Control*, section 3.2); ``conversion`` gives the others, whose
parameters are the same. Each parameter is measured from the frame that the ones before it really
make, so that rounding does not accumulate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dh_to_urdf.extraction.arrangement import Arrangement
from dh_to_urdf.extraction.axes import AxisLine
from dh_to_urdf.extraction.normals import ROUNDING, Case, CommonNormal, common_normal
from dh_to_urdf.matrices import link_matrix
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, JointType

DIGITS = 12
TIE = 1e-9
"""|cosine| between a normal and the x before it below which neither sense is the nearer one."""


@dataclass(frozen=True)
class ConstructedPair:
    """Two successive lines and the frame that their common normal makes.

    Attributes:
        first: The line of the row's joint.
        second: The next line; the tip's z in the last pair.
        normal: Their common normal.
        x: Direction of the frame's x axis in base axes.
        foot_on_first: Where the normal meets the first line, in base axes, m.
        foot_on_second: Where it meets the second line.
        row: The row, in the standard convention.
    """

    first: AxisLine
    second: AxisLine
    normal: CommonNormal
    x: Matrix
    foot_on_first: Matrix
    foot_on_second: Matrix
    row: DHRow


@dataclass(frozen=True)
class Construction:
    """Frames and rows of a chain, standard convention.

    Attributes:
        base: Frame 0 in base axes, 4x4.
        pairs: One a row.
        tool: The tip in the last frame, 4x4.
    """

    base: Matrix
    pairs: tuple[ConstructedPair, ...]
    tool: Matrix


def construct(
    arrangement: Arrangement,
    tip: Matrix,
    size: float,
    *,
    last_at_tip: bool,
    positive_a: bool = False,
) -> Construction:
    """Run the construction.

    Args:
        arrangement: The lines.
        tip: Pose of the tip at q = 0 in base axes, 4x4.
        size: Length of the robot, m.
        last_at_tip: Where the tip's z is parallel to the last axis: True lets the last row lead
            up to the tip, False keeps it short and leaves the way to the tool.
        positive_a: True turns every x from axis to axis, so that no a is negative; False turns
            it to the side nearer to the x before, so that offsets stay small.
    """
    lines = arrangement.lines
    normals = [common_normal(a, b, size) for a, b in pairwise(lines)]
    base = _frame_zero(lines[0], normals[0], size)
    frame, pairs = base, []
    for k, (first, normal) in enumerate(zip(lines, normals, strict=False)):
        at_tip = last_at_tip and k == len(normals) - 1
        target = _x_target(lines, normals, k, frame[:3, 0], tip if at_tip else None, positive_a)
        foot = _foot(first, normal, frame[:3, 3], tip[:3, 3] if at_tip else None)
        row, frame = _row(k, first, lines[k + 1], frame, target, foot, size)
        on_first = frame[:3, 3] - row.a * frame[:3, 0]
        pairs.append(
            ConstructedPair(first, lines[k + 1], normal, frame[:3, 0], on_first, frame[:3, 3], row)
        )
    tool = np.eye(4)
    tool[:3, :3] = frame[:3, :3].T @ tip[:3, :3]
    tool[:3, 3] = frame[:3, :3].T @ (tip[:3, 3] - frame[:3, 3])
    return Construction(tidy_placement(base, size), tuple(pairs), tidy_placement(tool, size))


def _frame_zero(axis: AxisLine, normal: CommonNormal, size: float) -> Matrix:
    """Return the base frame where its z is axis 1, else a frame on axis 1.

    Else z along axis 1, the origin on it nearest to the base's, and x the base's x where that is
    at right angles, or else x of frame 1.
    """
    u = axis.direction
    origin = axis.point - (axis.point @ u) * u
    origin[np.abs(origin) <= ROUNDING * size] = 0.0
    z = np.where(np.abs(u) <= ROUNDING, 0.0, u)
    x = np.array([1.0, 0.0, 0.0])
    if abs(float(u[0])) > ROUNDING:
        x = normal.direction if normal.direction is not None else _any_perpendicular(u)
    z = z / np.linalg.norm(z)
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = x, np.cross(z, x), z, origin
    return frame


def _any_perpendicular(u: Matrix) -> Matrix:
    helper = np.eye(3)[2 if abs(u[2]) < 0.9 else 1]
    return np.asarray(helper - (helper @ u) * u)


def _x_target(
    lines: tuple[AxisLine, ...],
    normals: list[CommonNormal],
    k: int,
    previous: Matrix,
    tip: Matrix | None,
    positive_a: bool,
) -> Matrix:
    """Return the direction of x_k: along the common normal, unchanged where that is any."""
    normal = normals[k]
    if normal.direction is not None:
        keep = positive_a and normal.length > 0.0
        return normal.direction if keep else _nearer(normal.direction, previous)
    if tip is not None:
        return tip[:3, 0]
    if lines[k].type.is_revolute and not lines[k + 1].type.is_revolute:
        # The angle before a prismatic joint on the same axis belongs to the revolute joint.
        for later in normals[k + 1 :]:
            if later.direction is not None:
                return _nearer(later.direction, previous)
    return previous


def _nearer(direction: Matrix, previous: Matrix) -> Matrix:
    cosine = float(direction @ previous)
    return -direction if cosine < -TIE else direction


def _foot(
    first: AxisLine, normal: CommonNormal, previous: Matrix, tip_origin: Matrix | None
) -> Matrix:
    """Return where x_k leaves axis k, m; near the previous origin where it may be anywhere."""
    if not normal.case.is_parallel:
        return normal.foot
    if tip_origin is not None:
        return tip_origin
    return first.point if first.type is JointType.PRISMATIC else previous


def _row(
    k: int,
    first: AxisLine,
    second: AxisLine,
    frame: Matrix,
    x: Matrix,
    foot: Matrix,
    size: float,
) -> tuple[DHRow, Matrix]:
    """Measure θ, d, a, α from the frame before; return the row and the frame that it gives."""
    x0, y0, z0, origin = frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3]
    theta = _tidy_angle(math.atan2(float(x @ y0), float(x @ x0)))
    d = _tidy_length(float((foot - origin) @ z0), size)
    x1 = math.cos(theta) * x0 + math.sin(theta) * y0
    y1 = np.cross(z0, x1)
    a = _tidy_length(float((second.point - origin) @ x1), size)
    if common_normal(first, second, size).case in (Case.INTERSECTING, Case.COINCIDENT):
        a = 0.0
    u = second.direction
    alpha = _tidy_angle(math.atan2(-float(u @ y1), float(u @ z0)))
    is_revolute, slides = first.type.is_revolute, first.type is JointType.PRISMATIC
    row = DHRow(
        name=first.name,
        type=first.type,
        alpha=alpha,
        a=a,
        d=0.0 if slides else d,
        theta=0.0 if is_revolute else theta,
        parent=k,
        offset=theta if is_revolute else d if slides else 0.0,
        limits=first.limits,
    )
    return row, frame @ link_matrix(row, Convention.STANDARD, row.offset)


def _tidy_angle(angle: float) -> float:
    """Remove rounding around multiples of 15 degrees (rad); -π becomes π."""
    step = math.pi / 12
    nearest = round(angle / step)
    if abs(angle - nearest * step) <= 1e-15:
        angle = math.pi * nearest / 12
    return math.pi if angle == -math.pi else angle + 0.0


def _tidy_length(length: float, size: float) -> float:
    """Remove rounding beyond the twelfth decimal (m)."""
    rounded = round(length, DIGITS)
    return rounded + 0.0 if abs(length - rounded) <= 1e-15 * max(1.0, size) else length


def tidy_placement(T: Matrix, size: float) -> Matrix:
    """Remove rounding around entries 0, 1 and -1, and beyond the lengths' twelfth decimal."""
    tidied = T.copy()
    nearest = np.round(T[:3, :3])
    tidied[:3, :3] = np.where(np.abs(T[:3, :3] - nearest) <= 1e-15, nearest, T[:3, :3])
    tidied[:3, 3] = [_tidy_length(float(value), size) for value in T[:3, 3]]
    return tidied + 0.0
