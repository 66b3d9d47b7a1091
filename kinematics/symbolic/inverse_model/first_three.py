"""Three joints that bring a point, as a wrist centre, to its place.

With ``w`` the wrist centre seen from axis 1, ``w = A1 A2 A3 c`` and ``A3 c = v``. Each function
names the branches as ``ik/solutions`` does; see :mod:`kinematics.inverse.closed_form.classify`.
"""

from __future__ import annotations

from dh_to_urdf.messages import say
from kinematics.symbolic.inverse_model.arm import Arm, pose_of
from kinematics.symbolic.inverse_model.builder import (
    Builder,
    about_x,
    about_z,
    flat,
    turned_back,
    twist,
)
from kinematics.symbolic.inverse_model.plane_arm import on_axis, out_of_reach, plane_arm
from kinematics.symbolic.inverse_model.target import turned, upright
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial
from kinematics.symbolic.steps import Vector

FRONT, SENSE = ("front", "back"), ("positive", "negative")
REACH = ("extended", "retracted")
TWO = Polynomial.constant(2)


def in_third(builder: Builder, arm: Arm, along: Polynomial) -> Vector:
    """Return c, seen from joint 3 before it moves: ``along`` axis 4, or the end of three joints."""
    link = arm.links[2]
    if len(arm.links) == 3:
        x, y, z = pose_of(arm.after, builder.names).origin
    else:
        c, s = twist(builder.names, link.alpha)
        x, y, z = about_x(c, s, (link.a, ZERO, along))
    z = z + link.slide if link.is_revolute else z
    if link.is_revolute:
        return x, y, z
    ct, st = twist(builder.names, link.turn)
    return about_z(ct, st, (x, y, z))


def forward(builder: Builder, arm: Arm) -> int:
    """Return the sign of the front side along the common normal of axes 1 and 2."""
    first, second = arm.links[0], arm.links[1]
    if first.a:
        return builder.sign(first.a)
    up = upright(builder, arm, _identity(), (ZERO, ZERO, ONE))[0]
    rise = builder.constant(up) * first.sign
    upwards = -first.sign if rise < -1e-8 else first.sign
    _, s = twist(builder.names, first.alpha)
    return upwards * second.sign * builder.sign(s)


def _identity() -> tuple[Vector, Vector, Vector]:
    return (ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE)


def from_axis_2(
    builder: Builder, arm: Arm, w: Vector
) -> tuple[tuple[Polynomial, Polynomial, Polynomial], Vector]:
    """Return factors of type 2 for the component of w along axis 2, and w turned back.

    Returns:
        x, y and the constant of ``x S1 + y C1 + constant``, and the point seen from axis 2.
    """
    link = arm.links[0]
    c, s = twist(builder.names, link.alpha)
    C1, S1 = builder.cos_sin((1, 1))
    height = w[2] - link.slide
    back = turned_back(C1, S1, w)
    seen = about_x(c, -s, (back[0] - link.a, back[1], height))
    return (s * w[0], -(s * w[1]), c * height), seen


def shoulder_angle(
    builder: Builder, arm: Arm, w: Vector, along: Polynomial, names: tuple[str, str], front: int
) -> Vector:
    """Solve joint 1 from the component along axis 2; return the point seen from axis 2.

    Args:
        builder: The derivation.
        arm: The arm.
        w: The point, seen from axis 1.
        along: Its component along axis 2, of lengths alone.
        names: Names of the posture.
        front: Sign along the common normal of axes 1 and 2 of the first of these.
    """
    _, s = twist(builder.names, arm.links[0].alpha)
    (x, y, rest), seen = from_axis_2(builder, arm, w)
    builder.step(say("{angle} from the component along axis {axis}", angle="theta1", axis=2))
    builder.remark(
        say(
            "Multiplied by the inverse of {matrix} from the left: joint 1 turned back.",
            matrix=builder.first_matrix,
        )
    )
    builder.remark(
        say("The component along axis 2 does not change with the joints parallel to it:")
        if arm.links[2].is_revolute
        else say("The component along axis 2 does not change, as joint 3 slides across it:")
    )
    sense = builder.sign(s)
    unit = Polynomial.constant(sense)
    right = s == unit
    scale = unit if right else ONE
    x, y, z = x * scale, y * scale, (along - rest) * scale
    C1, S1 = builder.cos_sin((1, 1))
    builder.equation(x * S1 + y * C1, z)
    # x C1 - y S1 = s ξ, with ξ along the common normal: -orient e has the sign of s ξ.
    orient = Polynomial.constant(-front * (1 if right else sense))
    near = say("Too near to axis 1 where what is under the root is negative: no solution.")
    free = on_axis(1)
    e = builder.sine_cosine(
        1, x, y, z, 1, orient, "e1", fails=near if along or not right else "", free=free
    )
    say_side(builder, names)
    builder.posture(0, names, e)
    return seen


def say_side(builder: Builder, names: tuple[str, str]) -> None:
    """Say what the names of the first choice mean."""
    builder.remark(
        say("Front: the end of the forearm is on the forward side of axis 1.")
        if names == FRONT
        else say("Left: the point is on the -(z1 x z2) side of axis 1.")
    )


def elbow(builder: Builder, arm: Arm, w: Vector, along: Polynomial) -> None:
    """Solve axes 2 and 3 parallel."""
    c = in_third(builder, arm, along)
    second = arm.links[1]
    sense = flat(second.alpha)
    fixed = second.slide + c[2].scaled(sense)
    seen = shoulder_angle(builder, arm, w, fixed, FRONT, forward(builder, arm))
    builder.step(say("The end of the forearm in the plane of links 2 and 3"))
    x, y = builder.let("xs", seen[0]), builder.let("ys", seen[1])
    normal = upright(builder, arm, turned(builder, arm, 0, 1), (-y, x, ZERO))
    # seen from axis 2 the second link is mirrored where axis 3 points against it
    plane_arm(
        builder,
        (2, 3),
        (x, y),
        ((second.a, ZERO), (c[0], c[1].scaled(sense))),
        sense,
        normal,
        1,
    )


def _carried(builder: Builder, arm: Arm, v: Vector) -> Vector:
    """Return v seen from joint 2 before it turns."""
    link = arm.links[1]
    c, s = twist(builder.names, link.alpha)
    x, y, z = about_x(c, s, v)
    return x + link.a, y, z + link.slide


def _placed(builder: Builder, c: Vector) -> Vector:
    C3, S3 = builder.cos_sin((3, 1))
    return about_z(C3, S3, c)


def _split(builder: Builder, p: Polynomial, link: int) -> tuple[Polynomial, ...]:
    """Return factors of the sine and the cosine of a joint in a polynomial, and the rest."""
    C, S = (next(iter(one.symbols())) for one in builder.cos_sin((link, 1)))
    found: dict[str, list[tuple[tuple[tuple[str, int], ...], object]]] = {C: [], S: [], "": []}
    for monomial, value in p:
        inside = [name for name, _ in monomial if name in (C, S)]
        rest = tuple(item for item in monomial if item[0] not in (C, S))
        found[inside[0] if inside else ""].append((rest, value))
    sine, cosine, fixed = (
        Polynomial.collected(found[name])  # type: ignore[arg-type]
        for name in (S, C, "")
    )
    return sine, cosine, fixed


def _dot(v: Vector, w: Vector) -> Polynomial:
    return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]


def _length_of_arm(builder: Builder, arm: Arm, c: Vector) -> Polynomial:
    """Return the square of the distance from axis 2's frame to the end, linear in joint 3."""
    link = arm.links[1]
    cosine, sine = twist(builder.names, link.alpha)
    v = _placed(builder, c)
    lever = (link.a, link.slide * sine, link.slide * cosine)  # seen from frame 2
    return _dot(c, c) + _dot(lever, lever) + (_dot(lever, v)).scaled(2)


def shoulder(builder: Builder, arm: Arm, w: Vector, along: Polynomial) -> None:
    """Solve axes 1 and 2 that meet, joint 3 turning."""
    c = in_third(builder, arm, along)
    height = builder.let("zs", w[2] - arm.links[0].slide)
    builder.step(say("{angle} from the distance to where axes 1 and 2 meet", angle="theta3"))
    builder.remark(
        say(
            "Squares added, {one} and {two} vanish, as they do not change it:",
            one="theta1",
            two="theta2",
        )
    )
    sine, cosine, fixed = _split(builder, _length_of_arm(builder, arm, c), 3)
    square = w[0] * w[0] + w[1] * w[1] + height * height
    C3, S3 = builder.cos_sin((3, 1))
    builder.equation(sine * S3 + cosine * C3, square - fixed)
    orient = Polynomial.constant(arm.links[2].sign)
    e = builder.sine_cosine(3, sine, cosine, square - fixed, 2, orient, "e3", fails=out_of_reach())
    builder.remark(say("Positive: joint 3 bends the arm positively about its axis."))
    builder.posture(1, SENSE, e)
    _two_turns(builder, arm, w, height, _carried(builder, arm, _placed(builder, c)))


def telescope(builder: Builder, arm: Arm, w: Vector, along: Polynomial) -> None:
    """Solve axes 1 and 2 that meet, joint 3 sliding."""
    k = in_third(builder, arm, along)
    link = arm.links[2]
    cosine, sine = twist(builder.names, arm.links[1].alpha)
    if not cosine:
        _across(builder, arm, w, k, sine)
        return
    height = builder.let("zs", w[2] - arm.links[0].slide)
    second = arm.links[1]
    lever = (second.a, second.slide * sine, second.slide * cosine)
    middle = k[2] + lever[2]
    fixed = _dot(k, k) + _dot(lever, lever) + _dot(lever, k).scaled(2)
    name = builder.slide_name(3)
    builder.step(say("{angle} from the distance to where axes 1 and 2 meet", angle=name))
    builder.remark(
        say(
            "Squares added, {one} and {two} vanish, as they do not change it:",
            one="theta1",
            two="theta2",
        )
    )
    square = w[0] * w[0] + w[1] * w[1] + height * height
    under = square - fixed + middle * middle
    builder.remark(say("A quadratic equation in {angle}: both roots.", angle=name))
    builder.remark(out_of_reach())
    root = builder.root("w3", under, 2)
    e = builder.branch("e3", root)
    found = builder.slide(3, (e * root).scaled(link.sign) - middle)
    builder.remark(say("Extended: beyond where the end is nearest to the shoulder."))
    builder.posture(1, REACH, e)
    _two_turns(builder, arm, w, height, _carried(builder, arm, (k[0], k[1], k[2] + found)))


def column_slide(builder: Builder, arm: Arm, w: Vector, along: Polynomial) -> None:
    """Solve axes 1 and 2 parallel, joint 3 sliding along them or aslant."""
    k = in_third(builder, arm, along)
    first, second = arm.links[:2]
    sense = flat(first.alpha)
    cosine, sine = twist(builder.names, second.alpha)
    name = builder.slide_name(3)
    builder.step(say("{angle} from the component along axes 1 and 2", angle=name))
    rest = (w[2] - first.slide).scaled(sense) - second.slide - sine * k[1]
    found = Polynomial.symbol(name)
    builder.equation(cosine * (found + k[2]), rest)
    found = builder.slide(3, rest - cosine * k[2], cosine)
    builder.step(say("The arm across axes 1 and 2"))
    gx = builder.let("fs", second.a + k[0])
    gy = builder.let("gs", (cosine * k[1] - sine * (found + k[2])).scaled(sense))
    normal = upright(builder, arm, _identity(), (-w[1], w[0], ZERO))
    plane_arm(builder, (1, 2), (w[0], w[1]), ((first.a, ZERO), (gx, gy)), sense, normal, 0)


def _across(builder: Builder, arm: Arm, w: Vector, k: Vector, sine: Polynomial) -> None:
    """Solve a slide across axis 2 (Paul's solution of the Stanford arm)."""
    second, third = arm.links[1:3]
    fixed = second.slide + sine * k[1]
    front = forward(builder, arm)
    seen = shoulder_angle(builder, arm, w, fixed, FRONT, front)
    name = builder.slide_name(3)
    builder.step(say("{angle} from the two other components, squares added", angle=name))
    x, y = builder.let("xs", seen[0]), builder.let("ys", seen[1])
    near = second.a + k[0]
    if near:
        builder.remark(
            say("Too near to axis 2 where what is under the root is negative: no solution.")
        )
    root = builder.root("w3", x * x + y * y - near * near, 2, is_sum=not near)
    e = builder.branch("e3", root)
    found = builder.slide(3, (e * root).scaled(third.sign) - k[2])
    builder.remark(say("Extended: beyond where the end is nearest to the shoulder."))
    builder.posture(1, REACH, e)
    builder.step(say("{angle} from both components in the plane", angle="theta2"))
    out = (-sine) * (found + k[2])
    out = builder.let("g2", out)
    C2, S2 = builder.cos_sin((2, 1))
    builder.equation(near * C2 - out * S2, x)
    builder.equation(near * S2 + out * C2, y)
    builder.two_equations(2, (near, out), (x, y), 2, free=on_axis(2))


def _two_turns(builder: Builder, arm: Arm, w: Vector, height: Polynomial, g: Vector) -> None:
    """Solve joints 2 and 1 of axes that meet, where the end is known as seen from joint 2."""
    c, s = twist(builder.names, arm.links[0].alpha)
    builder.step(say("{angle} from the component along axis 1", angle="theta2"))
    gx, gy, gz = (builder.let(f"{a}2", p) for a, p in zip("fgh", g, strict=True))
    C2, S2 = builder.cos_sin((2, 1))
    z = height - c * gz
    builder.equation(s * (gx * S2 + gy * C2), z)
    unit = Polynomial.constant(builder.sign(s))
    right = s == unit
    scaled = (gx, gy, z * unit) if right else (s * gx, s * gy, z)
    # gx C2 - gy S2 is along the common normal's direction of axis 1 and 2: the front side.
    front = forward(builder, arm) * (1 if right else builder.sign(s))
    e = builder.sine_cosine(2, *scaled, 1, Polynomial.constant(-front), "e2", fails=out_of_reach())
    say_side(builder, FRONT)
    builder.posture(0, FRONT, e)
    builder.step(say("{angle} from both components in the plane", angle="theta1"))
    x = builder.let("f1", gx * C2 - gy * S2)
    y = builder.let("g1", c * (gx * S2 + gy * C2) - s * gz)
    C1, S1 = builder.cos_sin((1, 1))
    builder.equation(x * C1 - y * S1, w[0])
    builder.equation(x * S1 + y * C1, w[1])
    builder.two_equations(1, (x, y), (w[0], w[1]), 2, free=on_axis(1))


def column(builder: Builder, arm: Arm, w: Vector, along: Polynomial) -> None:
    """Solve axes 1 and 2 parallel, joint 3 turning across them."""
    c = in_third(builder, arm, along)
    first, second, third = arm.links[:3]
    sense = flat(first.alpha)
    cosine, sine = twist(builder.names, second.alpha)
    builder.step(say("{angle} from the component along axes 1 and 2", angle="theta3"))
    builder.remark(
        say(
            "The component along them does not change with {one} and {two}:",
            one="theta1",
            two="theta2",
        )
    )
    height = (w[2] - first.slide).scaled(sense) - second.slide - cosine * c[2]
    C3, S3 = builder.cos_sin((3, 1))
    x, y = sine * c[0], sine * c[1]
    builder.equation(x * S3 + y * C3, height)
    orient = Polynomial.constant(-first.sign * third.sign * sense)
    e = builder.sine_cosine(3, x, y, height, 1, orient, "e3", fails=out_of_reach())
    builder.remark(say("Positive: the end of the forearm is on the z1 x z3 side of axis 3."))
    builder.posture(1, SENSE, e)
    v = _placed(builder, c)
    builder.step(say("The arm across axes 1 and 2"))
    gx = builder.let("fs", second.a + v[0])
    gy = builder.let("gs", (cosine * v[1] - sine * c[2]).scaled(sense))
    normal = upright(builder, arm, _identity(), (-w[1], w[0], ZERO))
    plane_arm(builder, (1, 2), (w[0], w[1]), ((first.a, ZERO), (gx, gy)), sense, normal, 0)


RANKS = ("first", "second", "third", "fourth")


def general(builder: Builder, arm: Arm, w: Vector, along: Polynomial) -> None:
    """Solve axes 1 and 2 skew (Pieper): a trigonometric equation of degree 2 for joint 3.

    With g the end seen from joint 2, ``f = gx² + gy² + gz²`` and ``k = gx C2 - gy S2``:
    ``|w|² = a1² + f + 2 a1 k`` and the component along axis 1 gives ``gx S2 + gy C2``.
    """
    c = in_third(builder, arm, along)
    first = arm.links[0]
    cosine, sine = twist(builder.names, first.alpha)
    height = builder.let("zs", w[2] - first.slide)
    builder.step(say("{angle} without the others (Pieper)", angle="theta3"))
    builder.remark(
        say(
            "The squares added, and the component along axis 1, where {angle} is left out:",
            angle="theta1",
        )
    )
    g = _carried(builder, arm, _placed(builder, c))
    gx, gy, gz = (Polynomial.symbol(builder.names.fresh(n)) for n in ("gx", "gy", "gz"))
    cos2, sin2 = builder.cos_sin((2, 1))
    square = w[0] * w[0] + w[1] * w[1] + height * height
    for symbol, value in zip((gx, gy, gz), g, strict=True):
        builder.equation(symbol, value)
    builder.equation(
        (first.a * (gx * cos2 - gy * sin2)).scaled(2),
        square - first.a * first.a - gx * gx - gy * gy - gz * gz,
    )
    builder.equation(sine * (gx * sin2 + gy * cos2), height - cosine * gz)
    builder.remark(
        say(
            "Squares of both, divided by 2 a1 and by the sine of the twist, add up to gx*gx +"
            " gy*gy: {angle} vanishes, too.",
            angle="theta2",
        )
    )
    s3, c3, fixed = _split(builder, _length_of_arm(builder, arm, c), 3)
    hs, hc, h0 = _split(builder, g[2], 3)
    rest = builder.let("rs", square - first.a * first.a - fixed)
    up = builder.let("us", height - cosine * h0)
    # (rest - s3 S - c3 C)²/(4 a1²) + (up - cos α1 (hs S + hc C))²/sin² α1 + gz²
    # = fixed + s3 S + c3 C
    four = (first.a * first.a).scaled(4)
    s2 = sine * sine
    ms, mc = cosine * hs, cosine * hc
    # multiplied by 4 a1² sin²
    S2_, one, C1_, S1_, CS = (
        s2 * s3 * s3 + four * (ms * ms + s2 * hs * hs),
        s2 * (rest * rest - four * fixed) + four * (up * up + s2 * h0 * h0),
        s2 * (rest * c3).scaled(-2) - s2 * four * c3 + four * (s2 * h0 * hc - up * mc).scaled(2),
        s2 * (rest * s3).scaled(-2) - s2 * four * s3 + four * (s2 * h0 * hs - up * ms).scaled(2),
        (s2 * s3 * c3 + four * (ms * mc + s2 * hs * hc)).scaled(2),
    )
    CC = s2 * c3 * c3 + four * (mc * mc + s2 * hc * hc)
    builder.roots(3, (one + S2_, C1_, S1_, CC - S2_, CS))
    builder.step(say("{angle} from the same two equations", angle="theta2"))
    x, y, z = (builder.let(f"{a}2", p) for a, p in zip("fgh", g, strict=True))
    v1 = builder.define("p2", square - first.a * first.a - x * x - y * y - z * z, first.a.scaled(2))
    v2 = builder.define("r2", height - cosine * z, sine)
    # x C2 - y S2 = v1, x S2 + y C2 = v2
    builder.equation(x * cos2 - y * sin2, v1)
    builder.equation(x * sin2 + y * cos2, v2)
    builder.two_equations(2, (x, y), (v1, v2), 2, free=on_axis(2))
    builder.step(say("{angle} from both components in the plane", angle="theta1"))
    reach = builder.let("f1", v1 + first.a)
    side = builder.let("g1", cosine * v2 - sine * z)
    C1, S1 = builder.cos_sin((1, 1))
    builder.equation(reach * C1 - side * S1, w[0])
    builder.equation(reach * S1 + side * C1, w[1])
    builder.two_equations(1, (reach, side), (w[0], w[1]), 2, free=on_axis(1))
