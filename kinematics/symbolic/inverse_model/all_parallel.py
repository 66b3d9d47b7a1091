"""All axes parallel: planar 2R and 3R, SCARA."""

from __future__ import annotations

import math

from dh_to_urdf.messages import say
from kinematics.symbolic.angles import Angle as JointAngle
from kinematics.symbolic.inverse_model.arm import LENGTH, Arm, pose_of
from kinematics.symbolic.inverse_model.builder import Builder, flat, transposed
from kinematics.symbolic.inverse_model.plane_arm import plane_arm
from kinematics.symbolic.inverse_model.target import (
    Target,
    named_rotation,
    say_taken_off,
    upright,
    without_base_and_tool,
)
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial
from kinematics.symbolic.steps import added, negated

Plane = tuple[Polynomial, Polynomial]


def all_parallel(builder: Builder, arm: Arm, target: Target) -> bool:
    """Solve two or three turns, and a slide anywhere among them; False without two links.

    Args:
        builder: The derivation.
        arm: The arm.
        target: What is given; of two turns without a third its position alone.
    """
    senses, links, height, constant = _links(builder, arm)
    turning = [k for k, link in enumerate(arm.links) if link.is_revolute]
    sliding = [k for k, link in enumerate(arm.links) if not link.is_revolute]
    builder.step(say("The target seen from axis 1"))
    names = builder.names
    if len(turning) == 2:
        builder.remark(say("Of the target X and Y count alone."))
        before, after = pose_of(arm.before, names), pose_of(arm.after, names)
        offset = added(target.origin, negated(before.origin))
        point = transposed(before.axes, offset)
        end = after.origin[1].scaled(senses[-1])
        links[2] = (links[2][0] + after.origin[0], links[2][1] + end)
    else:
        say_taken_off(builder, arm, ZERO)
        R, point = without_base_and_tool(builder, arm, target)
        R = named_rotation(builder, R, "13" if sliding else "1")
        if sliding:
            down = Polynomial.constant(senses[-1])
            builder.require((R[2][0], ZERO), (R[2][1], ZERO), (R[2][2], down))
        else:
            builder.remark(say("Of the target X, Y and the angle about z count alone."))
    if point == target.origin:
        builder.remark(say("It is the origin of the frame itself: X, Y, Z."))
    for link in links[1:3]:
        if math.hypot(*map(builder.constant, link)) <= LENGTH * arm.size:
            return False
    x, y = builder.let("xp", point[0] - links[0][0]), builder.let("yp", point[1] - links[0][1])
    z = builder.let("zp", point[2])
    if len(turning) == 3:
        i, j, k = (n + 1 for n in turning)
        builder.step(
            say("The sum of the turns, {angle}, from the direction of the x axis", angle="theta123")
        )
        c, s = builder.names.cos_sin(JointAngle((), constant))
        sine, cosine = c * R[0][1] - s * R[0][0], c * R[0][0] + s * R[0][1]
        builder.angle(SUM, (ONE, sine, cosine), power=0, free=False)
        C, S = builder.cos_sin((SUM, 1))
        last = links[3]
        if last[0] or last[1]:
            builder.step(say("Back along the last link to the end of the second"))
            x = builder.let("xs", x - (last[0] * C - last[1] * S))
            y = builder.let("ys", y - (last[0] * S + last[1] * C))
    else:
        i, j = (n + 1 for n in turning)
    identity = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
    # seen from below where the first turn points down, so that it counts forwards
    m = senses[turning[0]]
    normal = upright(builder, arm, identity, (-y.scaled(m), x.scaled(m), ZERO))
    plane_arm(
        builder,
        (i, j),
        (x, y.scaled(m)),
        ((links[1][0], links[1][1].scaled(m)), (links[2][0], links[2][1].scaled(m))),
        senses[turning[1]] * m,
        normal,
        0,
    )
    if len(turning) == 3:
        builder.step(say("{angle} from what is left of the sum", angle=f"theta{k}"))
        first, second = builder.theta(i), builder.theta(j)
        rest = builder.theta(SUM) - first.scaled(m) - second.scaled(senses[turning[1]])
        builder.sum_of_angles(k, rest.scaled(senses[turning[2]]))
    for n in sliding:
        name = builder.slide_name(n + 1)
        builder.step(say("{angle} from the component along the axes", angle=name))
        found = Polynomial.symbol(name)
        builder.equation(found.scaled(senses[n]) + height, z)
        builder.slide(n + 1, (z - height).scaled(senses[n]))
    return True


SUM = 123
"""Number of the sum of the turns among the angles."""


def _links(builder: Builder, arm: Arm) -> tuple[list[int], list[Plane], Polynomial, float]:
    """Return the senses of the axes, the vector after each turn, height and turn of constants.

    The vector before the first turn comes first. Each is seen as it is where the turns so far
    are 0, mirrored where the axes point down.
    """
    senses: list[int] = []
    vectors: list[Plane] = [(ZERO, ZERO)]
    height, sense, constant = ZERO, 1, 0.0
    for link in arm.links:
        senses.append(sense)
        height = height + link.slide.scaled(sense) if link.is_revolute else height
        if link.is_revolute:
            vectors.append((ZERO, ZERO))
        else:
            constant += sense * link.turn
        c, s = builder.names.cos_sin(JointAngle((), constant))
        x, y = vectors[-1]
        vectors[-1] = (x + link.a * c, y + link.a * s)
        sense *= flat(link.alpha) or 1
    vectors += [(ZERO, ZERO)] * (4 - len(vectors))
    return senses, vectors, height, constant


__all__ = ["SUM", "all_parallel"]
