"""Classify chains by the geometry of their axes: which closed form they have.

Postures, each a choice, decided at q by where the parts of the arm are; two solutions of one target
never have the same ones. z_k is the direction of axis k.

*up*: of two parallel axes that bear the arm, the second (the elbow) is above the line from the
first (the shoulder) to the end of the forearm, as seen along them with the base's +z up; see
:mod:`elbow` for arms in a horizontal plane. The end of the forearm is the wrist centre, axis 4 of
an arm with parallel axes 2, 3 and 4, axis 3 or the tip of an arm in a plane.

Spherical wrist. *front*: the wrist centre is on the forward side of axis 1; forward is where axis
2 is offset from axis 1, and where it is not, upwards × z_2, with upwards the direction of axis 1
towards the base's +z. *flip*: (z_4 × z_6) · z_5 > 0, which for D-H tables such as the PUMA's is
sin q5 > 0. By the first three axes: 2 and 3 parallel: front, up. 1 and 2 meet: front, and
*positive* where joint 3 bends the arm positively about z_3. 1 and 2 parallel: up, and *positive*
where the wrist centre is on the z_1 × z_3 side of axis 3. In general position: *first* to *fourth*
by the value of joint 3 in (-pi, pi]. Joint 3 slides: front, and *extended* or *retracted* from
where the wrist centre is nearest to the shoulder.

Parallel axes 2, 3, 4. *left*: the point where axes 5 and 6 meet is on the -(z_1 × z_2) side of
axis 1; where they do not meet, *first* to *fourth* by the value of joint 1. *in*:
(z_4' × z_6) · z_5 > 0 with z_4' = z_2, which is sin q5 > 0 where z_4 = z_2.

Shoulder, elbow, wrist. *positive*: (z_1 × z_3) · z_2 > 0; joint 4 bends the arm positively about
z_4; (z_5 × z_7) · z_6 > 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from dh_to_urdf.messages import say
from kinematics.chain import Chain
from kinematics.inverse.closed_form import parallel_axes, planar, spherical_wrist, srs
from kinematics.inverse.closed_form.geometry import ANGLE, LENGTH, AxisLines, axis_lines
from kinematics.inverse.closed_form.spherical import triple
from robots.robot import FloatArray

Kind = Literal["spherical_wrist", "parallel_axes", "planar_2r", "planar_3r", "scara", "srs"]

_FRONT, _ELBOW, _SIGN = ("front", "back"), ("up", "down"), ("positive", "negative")
_RANKS = ("first", "second", "third", "fourth")
_ARMS = {
    spherical_wrist.ELBOW: (_FRONT, _ELBOW),
    spherical_wrist.SHOULDER: (_FRONT, _SIGN),
    spherical_wrist.COLUMN: (_ELBOW, _SIGN),
    spherical_wrist.GENERAL: (_RANKS, ("",)),
    spherical_wrist.TELESCOPE: (_FRONT, ("extended", "retracted")),
}
"""Choices of the first three joints."""


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """What a solver needs to know of a chain.

    Attributes:
        kind: The class of arm.
        constants: Numbers for the compiled solver of this class, shape (n,).
        description: For people: what was recognised.
        tasks: Names of the tasks it solves.
        postures: The choices, each with the names of its values 0, 1, …
        most: Largest number of solutions (for one swivel angle).
        ranked: The joint by whose values solutions get the first choice's names, smallest first;
            None where the first choice is decided by geometry.
    """

    kind: Kind
    constants: FloatArray
    description: str
    tasks: tuple[str, ...]
    postures: tuple[tuple[str, ...], ...]
    most: int
    ranked: int | None = None


def classify(chain: Chain) -> ClosedForm | None:
    """Return the closed form of a chain, or None where none is known.

    Args:
        chain: Base to frame; joints of any zero position and direction.
    """
    if not 2 <= chain.length <= 7:
        return None
    lines = axis_lines(chain)
    turning = int(np.count_nonzero(lines.is_revolute))
    if all(lines.parallel(0, k) for k in range(1, chain.length)):
        return _flat(lines, turning)
    if chain.length == 6:
        return _spherical_wrist(lines) or _parallel_axes(lines)
    if chain.length == 7 and turning == 7:
        return _srs(lines)
    return None


def _flat(lines: AxisLines, turning: int) -> ClosedForm | None:
    """Classify planar 2R and 3R, SCARA: all axes parallel."""
    slides = len(lines.is_revolute) - turning
    if (turning, slides) not in ((2, 0), (3, 0), (3, 1)):
        return None
    upright = bool(np.linalg.norm(lines.directions[0][:2]) <= ANGLE)
    if not upright and slides == 0:
        return None
    u = lines.directions[0]
    leading = u[2] if abs(u[2]) > ANGLE else u[int(np.argmax(np.abs(u)))]
    u = u if leading > 0 else -u
    order = [
        int(k) for k in (*np.flatnonzero(lines.is_revolute), *np.flatnonzero(~lines.is_revolute))
    ]
    tip = lines.pose[:3, 3]
    points = [p - (p @ u) * u for p in (*lines.points[order[:turning]], tip)]
    links = [float(np.linalg.norm(b - a)) for a, b in pairwise(points)]
    if min(links[:2]) <= LENGTH * lines.size:
        return None
    signs = np.ones(4)
    joints = np.full(4, -1.0)
    slots = [0, 1, 2, 3] if turning == 3 else [0, 1]
    for slot, k in zip(slots, order, strict=False):
        joints[slot], signs[slot] = k, np.sign(lines.directions[k] @ u)
    constants = np.concatenate(
        (
            [lines.size],
            u,
            *points[:3],
            points[-1],
            [tip @ u],
            signs,
            joints,
            lines.pose[:3, :3].T.reshape(9),
        )
    )
    elbow = (_ELBOW,)
    if slides:
        tasks = ("pose", "xyz_phi") if upright else ("pose",)
        text = say("SCARA: three turns and a slide about and along parallel axes")
        return ClosedForm("scara", constants, text, tasks, elbow, planar.MOST)
    if turning == 3:
        text = say("planar 3R: three parallel axes")
        return ClosedForm("planar_3r", constants, text, ("xy_phi",), elbow, planar.MOST)
    text = say("planar 2R: two parallel axes")
    return ClosedForm("planar_2r", constants, text, ("xy", "position"), elbow, planar.MOST)


def _spherical_wrist(lines: AxisLines) -> ClosedForm | None:
    """Classify six joints, the axes of the last three through one point."""
    if not (lines.is_revolute[[0, 1, 3, 4, 5]].all()):
        return None
    wrist = lines.centre(3)
    if wrist is None:
        return None
    found = _first_three(lines, wrist)
    if found is None:
        return None
    variant, p1, p2, p3, text = found
    h, size = lines.directions, lines.size
    up = -h[0] if h[0][2] < -ANGLE else h[0]
    offset = p2 - p1
    shifted = variant != spherical_wrist.COLUMN and np.linalg.norm(offset) > LENGTH * size
    forward = offset if shifted else np.cross(up, h[1])
    middle = -float(h[2] @ (wrist - p1))
    wrist_axes = triple(h[3], h[4], h[5])
    constants = np.concatenate(
        (
            [variant, size],
            wrist,
            lines.point_in_tip(wrist),
            lines.in_tip(h[5]),
            lines.in_tip(wrist_axes[12:15]),
            *h[:3],
            p1,
            p2,
            p3,
            forward,
            [middle],
            wrist_axes,
        )
    )
    flip = ("noflip", "flip")
    return ClosedForm(
        "spherical_wrist",
        constants,
        say("spherical wrist; {text}", text=text),
        ("pose",),
        (*_ARMS[variant], flip),
        spherical_wrist.MOST,
        2 if variant == spherical_wrist.GENERAL else None,
    )


def _first_three(
    lines: AxisLines, wrist: FloatArray
) -> tuple[int, FloatArray, FloatArray, FloatArray, str] | None:
    """Classify how the first three joints place the wrist centre; None where none is known."""
    small = LENGTH * lines.size
    if not lines.is_revolute[2]:
        p = lines.meeting_point(0, 1)
        if p is None or lines.parallel(1, 2):
            return None
        return (
            spherical_wrist.TELESCOPE,
            p,
            p,
            lines.foot(2, p),
            say("axes 1 and 2 meet, joint 3 slides"),
        )
    if lines.lever(2, wrist) <= small:
        return None
    p1, p2 = lines.feet(0, 1)
    if lines.parallel(1, 2) and not lines.parallel(0, 1):
        p3 = lines.foot(2, p2)
        if np.linalg.norm(p3 - p2) <= small:
            return None
        return spherical_wrist.ELBOW, p1, p2, p3, say("axes 2 and 3 parallel")
    if lines.parallel(0, 1):
        if lines.parallel(1, 2) or np.linalg.norm(p2 - p1) <= small:
            return None
        return spherical_wrist.COLUMN, p1, p2, lines.foot(2, p2), say("axes 1 and 2 parallel")
    p = lines.meeting_point(0, 1)
    if p is not None:
        if lines.lever(2, p) <= small:
            return None
        return spherical_wrist.SHOULDER, p, p, lines.foot(2, p), say("axes 1 and 2 meet")
    return (
        spherical_wrist.GENERAL,
        p1,
        p2,
        lines.foot(2, p2),
        say("axes 1, 2 and 3 in general position"),
    )


def _parallel_axes(lines: AxisLines) -> ClosedForm | None:
    """Classify six revolute joints, axes 2, 3 and 4 parallel."""
    if not lines.is_revolute.all():
        return None
    if not (lines.parallel(1, 2) and lines.parallel(1, 3)):
        return None
    if lines.parallel(0, 1) or lines.parallel(3, 4) or lines.parallel(4, 5):
        return None
    h, size = lines.directions, lines.size
    small = LENGTH * size
    p5, p6 = lines.feet(4, 5)
    meets = float(np.linalg.norm(p6 - p5)) <= small
    p1, p2 = lines.feet(0, 1)
    p3, p4 = lines.foot(2, p2), lines.foot(3, p2)
    if np.linalg.norm(p3 - p2) <= small or np.linalg.norm(p4 - p3) <= small:
        return None
    wrist_axes = triple(h[1], h[4], h[5])
    constants = np.concatenate(
        (
            [float(meets), size],
            p6,
            lines.point_in_tip(p6),
            lines.in_tip(h[5]),
            lines.in_tip(wrist_axes[12:15]),
            h[0],
            p1,
            p2,
            p3,
            p4,
            p5,
            [np.sign(h[2] @ h[1]), np.sign(h[3] @ h[1])],
            np.cross(h[0], h[1]),
            wrist_axes,
        )
    )
    text = (
        say("axes 2, 3 and 4 parallel, axes 5 and 6 meeting")
        if meets
        else say("axes 2, 3 and 4 parallel, axes 5 and 6 apart")
    )
    return ClosedForm(
        "parallel_axes",
        constants,
        text,
        ("pose",),
        (("left", "right") if meets else _RANKS, _ELBOW, ("in", "out")),
        8 if meets else parallel_axes.MOST,
        None if meets else 0,
    )


def _srs(lines: AxisLines) -> ClosedForm | None:
    """Classify seven revolute joints: spherical shoulder, elbow, spherical wrist."""
    shoulder, wrist = lines.centre(0), lines.centre(4)
    small = LENGTH * lines.size
    if shoulder is None or wrist is None:
        return None
    if lines.lever(3, shoulder) <= small or lines.lever(3, wrist) <= small:
        return None
    h = lines.directions
    first, last = triple(h[0], h[1], h[2]), triple(h[4], h[5], h[6])
    constants = np.concatenate(
        (
            [lines.size],
            shoulder,
            lines.foot(3, shoulder),
            wrist,
            lines.point_in_tip(wrist),
            lines.in_tip(h[6]),
            lines.in_tip(last[12:15]),
            h[3],
            first,
            last,
        )
    )
    sign = _SIGN
    text = say("spherical shoulder, elbow, spherical wrist")
    return ClosedForm("srs", constants, text, ("pose",), (sign, sign, sign), srs.MOST)
