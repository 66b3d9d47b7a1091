"""Arms that turn about one direction and slide across or along it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.inverse.closed_form import planar
from kinematics.inverse.closed_form.form import (
    ELBOW,
    EXTENDED,
    ONE,
    ClosedForm,
    Kind,
    Names,
    types_of,
)
from kinematics.inverse.closed_form.geometry import ANGLE, LENGTH, AxisLines
from robots.robot import FloatArray

_PLANES = ("yz", "xz", "xy")
"""Tasks in the plane across x, y and z."""
_PAIRS = {
    "RR": planar.TURN_TURN,
    "RP": planar.TURN_SLIDE,
    "PR": planar.SLIDE_TURN,
    "PP": planar.SLIDE_SLIDE,
}
_POSTURES: dict[str, Names] = {"RR": ELBOW, "RP": EXTENDED, "PR": EXTENDED, "PP": ONE}
_OF_THREE = {
    "RRR": ((0, 1), 2),
    "RPR": ((0, 1), 2),
    "PRR": ((0, 1), 2),
    "RRP": ((2, 0), 1),
    "RPP": ((1, 2), 0),
    "PRP": ((0, 2), 1),
    "PPR": ((0, 1), 2),
}
"""The pair that is left, and the turn that the heading fixes, of three joints."""


def flat(lines: AxisLines) -> ClosedForm | None:
    """Classify an arm whose joints turn about one direction, or slide across or along it."""
    u = _direction(lines)
    if u is None:
        return None
    along = np.abs(lines.directions @ u)
    lifts = ~lines.is_revolute & (along >= 1.0 - ANGLE)
    across = along <= ANGLE
    if not (lines.is_revolute | lifts | across).all():
        return None
    moving = [int(k) for k in np.flatnonzero(~lifts)]
    types, lift = types_of(lines.is_revolute[moving].tolist()), np.flatnonzero(lifts)
    if len(lift) > 1 or (len(moving), len(lift)) not in ((2, 0), (3, 0), (3, 1)):
        return None
    pair, third = ((0, 1), None) if len(moving) == 2 else _OF_THREE.get(types, (None, None))
    if pair is None:
        return None
    tip = lines.pose[:3, 3]
    # The rows that a planar pair does not reach at all are those along u.
    if not lines.are_independent(tip, slice(0, 3) if third is None else slice(0, 6)):
        return None
    joints = [moving[pair[0]], moving[pair[1]], -1 if third is None else moving[third]]
    joints.append(int(lift[0]) if len(lift) else -1)
    kinds = types_of([bool(lines.is_revolute[k]) for k in joints[:2]])
    if kinds == "RR" and not _has_links(lines, u, joints, tip):
        return None
    constants = _constants(lines, u, joints, kinds)
    tasks = _tasks(u, third is not None, bool(len(lift)))
    kind, text = _named(types, bool(len(lift)))
    return ClosedForm(kind, constants, text, tasks, (_POSTURES[kinds],), planar.MOST)


def _direction(lines: AxisLines) -> FloatArray | None:
    """Return the direction that all turning axes have, upwards; of two slides that across them."""
    turning = np.flatnonzero(lines.is_revolute)
    if len(turning):
        u = lines.directions[turning[0]]
        if not all(lines.parallel(int(turning[0]), int(k)) for k in turning):
            return None
    else:
        if len(lines.directions) != 2 or lines.parallel(0, 1):
            return None
        u = np.cross(*lines.directions)
        u = u / np.linalg.norm(u)
    leading = u[2] if abs(u[2]) > ANGLE else u[int(np.argmax(np.abs(u)))]
    return np.asarray(u if leading > 0 else -u)


def _has_links(lines: AxisLines, u: FloatArray, joints: list[int], tip: FloatArray) -> bool:
    ends = [*(lines.points[k] for k in joints[:3] if k >= 0), tip][:3]
    flat = [p - (p @ u) * u for p in ends]
    return min(float(np.linalg.norm(b - a)) for a, b in pairwise(flat)) > LENGTH * lines.size


def _constants(lines: AxisLines, u: FloatArray, joints: list[int], kinds: str) -> FloatArray:
    def shadow(p: FloatArray) -> FloatArray:
        return np.asarray(p - (p @ u) * u)

    tip, third, lift = lines.pose[:3, 3], joints[2], joints[3]
    turns = [k for k, kind in zip(joints, kinds, strict=False) if kind == "R"]
    pivot = lines.points[turns[0]] if turns else tip
    elbow = lines.points[turns[1]] if len(turns) > 1 else tip
    end = tip if third < 0 else lines.points[third]
    d1 = lines.directions[joints[0]] if kinds[0] == "P" else u
    d2 = lines.directions[joints[1]] if kinds[1] == "P" else u
    signs = np.ones(4)
    for place, k in enumerate(joints):
        if k >= 0 and (lines.is_revolute[k] or k == lift):
            signs[place] = np.sign(lines.directions[k] @ u)
    headed = [
        float(third >= 0 and kind == "P" and k > third)
        for k, kind in zip(joints, kinds, strict=False)
    ]
    return np.concatenate(
        (
            [lines.size],
            u,
            *(shadow(p) for p in (pivot, elbow, end, tip)),
            [tip @ u],
            signs,
            joints,
            lines.pose[:3, :3].T.reshape(9),
            [_PAIRS[kinds]],
            d1,
            d2,
            headed,
        )
    )


def _tasks(u: NDArray[np.float64], has_heading: bool, has_lift: bool) -> tuple[str, ...]:
    """Return the names of the tasks that such an arm has as many joints for."""
    planes = [name for k, name in enumerate(_PLANES) if abs(u[k]) >= 1.0 - ANGLE]
    upright = planes == ["xy"]
    if has_lift:
        return ("pose", "xyz_phi") if upright else ("pose",)
    if has_heading:
        return ("xy_phi", "pose") if upright else ("pose",)
    return (*planes, "position")


def _named(types: str, has_lift: bool) -> tuple[Kind, str]:
    if types == "RRR" and has_lift:
        return "scara", say("SCARA: three turns and a slide about and along parallel axes")
    if types == "RRR":
        return "planar_3r", say("planar 3R: three parallel axes")
    if types == "RR":
        return "planar_2r", say("planar 2R: two parallel axes")
    if has_lift:
        return "planar", say(
            "planar {types}, turns about one direction and slides across it, and a slide along it",
            types=types,
        )
    if types == "PP":
        return "planar", say("planar PP: two slides")
    return "planar", say("planar {types}: turns about one direction, slides across it", types=types)
