"""Axis lines -> lines that a D-H table can hold: points of prismatic joints, nearly parallel axes.

A prismatic joint has a direction only; its line is put through the next origin (Paul 1981,
*Robot Manipulators*, section 2.9), so that the row after it needs no length. The common normal of
nearly parallel axes is far away, at a distance ~ 1/tilt. Axes tilted by less than ``snap`` are
taken as parallel, which costs accuracy; for others whose normal would lie far outside the robot, a
fixed line at right angles to both is inserted, which costs a fixed row and no accuracy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from dh_to_urdf.extraction.axes import AxisLine
from dh_to_urdf.extraction.normals import ROUNDING, Case, common_normal, tilt_of
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import JointType

FAR = 20.0
"""Distance of a common normal, in sizes of the robot, beyond which a fixed line is inserted."""


@dataclass(frozen=True)
class Arrangement:
    """The lines that the construction runs along, the tip's z last.

    Attributes:
        lines: The axes, fixed lines between them, and the tip's z.
        snapped: For each line its tilt to the line before that was taken for zero, rad; 0 if none.
        bridged: For each line the tilt for which a fixed line stands before it, rad; 0 if none.
    """

    lines: tuple[AxisLine, ...]
    snapped: tuple[float, ...]
    bridged: tuple[float, ...]


def arrange(
    axes: tuple[AxisLine, ...],
    tip: Matrix,
    size: float,
    snap: float,
    *,
    bridge: bool = True,
    from_base: bool = True,
) -> Arrangement:
    """Prepare the lines of a chain for the construction.

    Args:
        axes: The axes at q = 0, in base axes.
        tip: Pose of the tip at q = 0, 4x4.
        size: Length of the robot, m.
        snap: Axes tilted by less than this are taken as parallel, rad.
        bridge: Whether to put fixed lines between nearly parallel axes.
        from_base: Whether the line of a first joint that slides along the base's z is drawn
            through the base's origin.
    """
    end = AxisLine("tip", JointType.FIXED, tip[:3, 3], tip[:3, 2] / np.linalg.norm(tip[:3, 2]))
    aligned, snapped = _snap((*axes, end), snap)
    placed, at_tip = _align_tip(_place_prismatic(aligned, size, from_base), size)
    snapped = (*snapped[:-1], at_tip or snapped[-1])
    if not bridge:
        return Arrangement(placed, snapped, (0.0,) * len(placed))
    names = {line.name for line in axes}
    lines, tilts, bridged = [placed[0]], [0.0], [0.0]
    for before, line, tilt in zip(placed[:-1], placed[1:], snapped[1:], strict=True):
        between = None if line is placed[-1] else _bridge(before, line, size, names)
        if between is not None:
            lines.append(between)
            tilts.append(0.0)
            bridged.append(0.0)
        lines.append(line)
        tilts.append(tilt)
        bridged.append(tilt_of(before.direction, line.direction) if between else 0.0)
    return Arrangement(tuple(lines), tuple(tilts), tuple(bridged))


def _snap(
    lines: tuple[AxisLine, ...], snap: float
) -> tuple[tuple[AxisLine, ...], tuple[float, ...]]:
    """Turn each line that is nearly parallel to the one before it into a parallel one."""
    found, tilts = [lines[0]], [0.0]
    for line in lines[1:]:
        tilt = tilt_of(found[-1].direction, line.direction)
        parallel = tilt <= max(snap, ROUNDING)
        found.append(_parallel_to(found[-1], line) if parallel else line)
        tilts.append(tilt if parallel and tilt > ROUNDING else 0.0)
    return tuple(found), tuple(tilts)


def _parallel_to(before: AxisLine, line: AxisLine) -> AxisLine:
    same = math.copysign(1.0, float(before.direction @ line.direction))
    return replace(line, direction=same * before.direction)


def _align_tip(lines: tuple[AxisLine, ...], size: float) -> tuple[tuple[AxisLine, ...], float]:
    """Make the tip's z parallel where its common normal would be far away.

    That costs nothing: the tool carries what is left, exactly.

    Returns:
        The lines, and the tilt that was taken for zero, 0 if none.
    """
    before, tip = lines[-2:]
    if not _is_far(before, tip, size):
        return lines, 0.0
    return (*lines[:-1], _parallel_to(before, tip)), tilt_of(before.direction, tip.direction)


def _place_prismatic(
    lines: tuple[AxisLine, ...], size: float, from_base: bool
) -> tuple[AxisLine, ...]:
    """Put the line of each prismatic joint through the origin on the next line."""
    placed = list(lines)
    for k in range(len(lines) - 2, -1, -1):
        if lines[k].type is JointType.PRISMATIC:
            placed[k] = replace(lines[k], point=_origin_on(placed, k + 1, size))
    first = lines[0]
    slides = first.type is JointType.PRISMATIC
    if from_base and slides and tilt_of(first.direction, Z) <= ROUNDING:
        placed[0] = replace(first, point=np.zeros(3))
    return tuple(placed)


Z = np.array([0.0, 0.0, 1.0])


def _origin_on(lines: list[AxisLine], k: int, size: float) -> Matrix:
    """Return the origin of the frame on line k, m: at its common normal with the next line.

    Where these are parallel, beside the origin on the next line; at the end, in the tip.
    """
    line = lines[k]
    if k == len(lines) - 1 or line.type is JointType.PRISMATIC:
        return line.point
    normal = common_normal(line, lines[k + 1], size)
    near = float(np.linalg.norm(normal.foot - line.point)) <= FAR * size
    if not normal.case.is_parallel and near:
        return normal.foot
    following = _origin_on(lines, k + 1, size)
    u = line.direction
    return np.asarray(line.point + ((following - line.point) @ u) * u)


def _is_far(before: AxisLine, line: AxisLine, size: float) -> bool:
    """Return True where the common normal lies far outside the robot."""
    normal = common_normal(before, line, size)
    if normal.case.is_parallel:
        return False
    return float(np.linalg.norm(normal.foot - before.point)) > FAR * size


def _bridge(before: AxisLine, line: AxisLine, size: float, names: set[str]) -> AxisLine | None:
    """Return a fixed line at right angles between two axes, None where none is needed."""
    if common_normal(before, line, size).case is Case.PARALLEL or not _is_far(before, line, size):
        return None
    u = before.direction
    across = line.point - before.point
    across = across - (across @ u) * u
    across -= (across @ u) * u
    length = float(np.linalg.norm(across))
    name = f"fixed_before_{line.name}"[:60]
    while name in names:
        name += "_"
    names.add(name)
    return AxisLine(name, JointType.FIXED, line.point, across / length)
