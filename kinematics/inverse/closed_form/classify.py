"""Classify chains by the geometry of their axes: which closed form they have.

Postures, each a choice, decided at q by where the parts of the arm are; two solutions of one target
never have the same ones. z_k is the direction of axis k.

*up*: of two parallel axes that bear the arm, the second (the elbow) is above the line from the
first (the shoulder) to the end of the forearm, as seen along them with the base's +z up; see
:mod:`elbow` for arms in a horizontal plane. The end of the forearm is the wrist centre, axis 4 of
an arm with parallel axes 2, 3 and 4, axis 3 or the tip of an arm in a plane.

Three joints that place a point, which is the tip, or the wrist centre of an arm with a spherical
wrist. *front*: the point is on the forward side of axis 1; forward is where axis 2 is offset from
axis 1, and where it is not, upwards × z_2, with upwards the direction of axis 1 towards the base's
+z. Three turns: 2 and 3 parallel: front, up. 1 and 2 meet: front, and *positive* where joint 3
bends the arm positively about z_3. 1 and 2 parallel: up, and *positive* where the point is on the
z_1 × z_3 side of axis 3. In general position: *first* to *fourth* by the value of joint 3 in
(-pi, pi]. Joint 3 slides: 1 and 2 parallel: up. 1 and 2 meet, or the slide is across axis 2: front,
and *extended* or *retracted*, beyond or before the value where the point is nearest to the
shoulder. Else *first* to *fourth* by the value of joint 3. Joint 1 slides: 2 and 3 parallel: up.
2 and 3 meet, or the slide is across axis 2: front, here the upwards × z_3 side of axis 3, and
extended, beyond the value where axis 2 is nearest to the point. Else first to fourth by the value
of joint 1. Joint 2 slides between turns: along parallel axes: up. Across both: positive where a
turn of joint 3 moves the point towards +z_1, and extended. Else first to fourth by the value of
joint 3, or of joint 1 where the slide is closer to axis 3 than to axis 1. One turn: *extended*
where the point is on that side of the turning axis to which the slide that is less along it drives
the point away from the axis. Three slides: one solution. *flip*, of a spherical wrist:
(z_4 × z_6) · z_5 > 0, which for D-H tables such as the PUMA's is sin q5 > 0.

Plane arms. Two turns, beside a third turn and a slide along the axes or none: up. One turn and one
slide, with or without the third turn: extended, the slide is beyond the value where its two ends,
the turning axis and what the arm places, are nearest to each other. Two slides: one solution.

Parallel axes 2, 3, 4. *left*: the point where axes 5 and 6 meet is on the -(z_1 × z_2) side of
axis 1; where they do not meet, *first* to *fourth* by the value of joint 1. *in*:
(z_4' × z_6) · z_5 > 0 with z_4' = z_2, which is sin q5 > 0 where z_4 = z_2.

Shoulder, elbow, wrist. *positive*: (z_1 × z_3) · z_2 > 0; joint 4 bends the arm positively about
z_4; (z_5 × z_7) · z_6 > 0.
"""

from __future__ import annotations

import numpy as np

from dh_to_urdf.messages import say
from kinematics.chain import Chain
from kinematics.inverse.closed_form import parallel_axes, spherical_wrist, srs
from kinematics.inverse.closed_form.classify_flat import flat
from kinematics.inverse.closed_form.classify_regional import placing
from kinematics.inverse.closed_form.form import ELBOW, RANKS, SIGN, ClosedForm, types_of
from kinematics.inverse.closed_form.geometry import LENGTH, AxisLines, axis_lines
from kinematics.inverse.closed_form.spherical import triple


def classify(chain: Chain) -> ClosedForm | None:
    """Return the closed form of a chain, or None where none is known.

    Args:
        chain: Base to frame; joints of any zero position and direction.
    """
    if not 2 <= chain.length <= 7:
        return None
    lines = axis_lines(chain)
    found = flat(lines)
    if found is not None:
        return found
    if chain.length == 3:
        return _three_joints(lines)
    if chain.length == 6:
        return _spherical_wrist(lines) or _parallel_axes(lines)
    if chain.length == 7 and lines.is_revolute.all():
        return _srs(lines)
    return None


def _three_joints(lines: AxisLines) -> ClosedForm | None:
    """Classify three joints that place the tip."""
    tip = lines.pose[:3, 3]
    found = placing(lines, tip)
    if found is None:
        return None
    constants = np.concatenate(
        ([found.variant, lines.size], tip, np.zeros(9), found.constants(lines))
    )
    types = types_of(lines.is_revolute.tolist())
    return ClosedForm(
        "three_joints",
        constants,
        say("{types} to a point; {text}", types=types, text=found.description),
        ("position",),
        (*found.postures, ("",)),
        spherical_wrist.MOST_OF_THREE,
        found.ranked,
    )


def _spherical_wrist(lines: AxisLines) -> ClosedForm | None:
    """Classify six joints, the axes of the last three through one point."""
    if not lines.is_revolute[3:].all():
        return None
    wrist = lines.centre(3)
    if wrist is None:
        return None
    found = placing(lines, wrist)
    if found is None:
        return None
    h = lines.directions
    wrist_axes = triple(h[3], h[4], h[5])
    constants = np.concatenate(
        (
            [found.variant, lines.size],
            wrist,
            lines.point_in_tip(wrist),
            lines.in_tip(h[5]),
            lines.in_tip(wrist_axes[12:15]),
            found.constants(lines),
            wrist_axes,
        )
    )
    return ClosedForm(
        "spherical_wrist",
        constants,
        say("spherical wrist; {text}", text=found.description),
        ("pose",),
        (*found.postures, ("noflip", "flip")),
        spherical_wrist.MOST,
        found.ranked,
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
        (("left", "right") if meets else RANKS, ELBOW, ("in", "out")),
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
    text = say("spherical shoulder, elbow, spherical wrist")
    return ClosedForm("srs", constants, text, ("pose",), (SIGN, SIGN, SIGN), srs.MOST)
