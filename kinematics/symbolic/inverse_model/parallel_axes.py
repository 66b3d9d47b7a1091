"""Six turning joints, axes 2, 3 and 4 parallel (Universal Robots and alike)."""

from __future__ import annotations

from dh_to_urdf.messages import say
from kinematics.symbolic.inverse_model.arm import Arm
from kinematics.symbolic.inverse_model.builder import Builder, flat, twist
from kinematics.symbolic.inverse_model.first_three import from_axis_2, shoulder_angle
from kinematics.symbolic.inverse_model.plane_arm import plane_arm
from kinematics.symbolic.inverse_model.target import turned, upright
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial
from kinematics.symbolic.steps import Rotation, Vector

SIDES, TURNS = ("left", "right"), ("in", "out")


def parallel_axes(builder: Builder, arm: Arm, R: Rotation, w: Vector) -> None:
    """Solve all six joints.

    Args:
        builder: The derivation.
        arm: The arm.
        R: Rotation of the target, as named.
        w: Where axes 5 and 6 meet, or the point of axis 6 nearest to axis 5, seen from axis 1.
    """
    one, two, three, four, five, _ = arm.links
    b2, b3 = flat(two.alpha), flat(three.alpha)
    b = b2 * b3
    c4, s4 = twist(builder.names, four.alpha)
    c5, s5 = twist(builder.names, five.alpha)
    _, s1 = twist(builder.names, one.alpha)
    wrist = four.slide + c4 * five.slide
    along = two.slide + three.slide.scaled(b2) + wrist.scaled(b)
    left = -one.sign * two.sign * builder.sign(s1)
    first = turned(builder, arm, 0, 1)
    if five.a:
        seen = _apart(builder, arm, R, w, along, b)
    else:
        seen = shoulder_angle(builder, arm, w, along, SIDES, left)
    _fifth(builder, arm, R, first, b)
    _sum_of_three(builder, R, first, (c4, s4, c5, s5), b)
    C234, S234 = builder.cos_sin((SUM, 1))
    builder.step(say("The end of link 3 in the plane of links 2 and 3"))
    C5, S5 = builder.cos_sin((5, 1))
    ax = four.a + five.a * C5
    ay = (c4 * five.a * S5 - s4 * five.slide).scaled(b)
    x = builder.let("xs", seen[0] - (ax * C234 - ay * S234))
    y = builder.let("ys", seen[1] - (ax * S234 + ay * C234))
    normal = upright(builder, arm, first, (-y, x, ZERO))
    plane_arm(builder, (2, 3), (x, y), ((two.a, ZERO), (three.a, ZERO)), b2, normal, 1)
    builder.step(say("{angle} from what is left of the sum", angle="theta4"))
    total, second, third = (builder.theta(link) for link in (SUM, 2, 3))
    builder.sum_of_angles(4, (total - second - third.scaled(b2)).scaled(b))


SUM = 234
"""Number of the sum of joints 2, 3 and 4 among the angles."""


def _apart(builder: Builder, arm: Arm, R: Rotation, w: Vector, along: Polynomial, b: int) -> Vector:
    """Solve joints 1 and 5 where axes 5 and 6 do not meet; return w seen from axis 2."""
    one, _, _, four, five, _ = arm.links
    c1, s1 = twist(builder.names, one.alpha)
    c4, s4 = twist(builder.names, four.alpha)
    c5, s5 = twist(builder.names, five.alpha)
    (x, y, rest), seen = from_axis_2(builder, arm, w)
    builder.step(
        say("{one} and {two} from the components along axis 2", one="theta1", two="theta5")
    )
    builder.remark(
        say(
            "Multiplied by the inverse of {matrix} from the left: joint 1 turned back.",
            matrix=builder.first_matrix,
        )
    )
    builder.remark(say("The point, and axis 6, along axis 2:"))
    C1, S1 = builder.cos_sin((1, 1))
    C5, S5 = builder.cos_sin((5, 1))
    x, y, rest = (value.scaled(b) for value in (x, y, rest - along))
    u = (s1 * R[2][0]).scaled(b), -(s1 * R[2][1]).scaled(b), (c1 * R[2][2]).scaled(b) - c4 * c5
    lever, lean = s4 * five.a, -(s4 * s5)
    builder.equation(lever * S5, x * S1 + y * C1 + rest)
    builder.equation(lean * C5, u[0] * S1 + u[1] * C1 + u[2])
    builder.remark(say("Squares added, {angle} vanishes:", angle="theta5"))
    # (x S + y C + rest)² lean² + (…)² lever² = lean² lever²
    k = [ZERO] * 5
    for (sine, cosine, fixed), factor in (((x, y, rest), lean), (u, lever)):
        square = factor * factor
        sine, cosine, fixed = (
            builder.let(f"{'l' if factor is lean else 'o'}{n}", value)
            for n, value in zip("scf", (sine, cosine, fixed), strict=True)
        )
        k[0] += square * (fixed * fixed + sine * sine)
        k[1] += square * (fixed * cosine).scaled(2)
        k[2] += square * (fixed * sine).scaled(2)
        k[3] += square * (cosine * cosine - sine * sine)
        k[4] += square * (sine * cosine).scaled(2)
    k[0] = k[0] - lean * lean * lever * lever
    builder.roots(1, k)
    sine = builder.define("s5", x * S1 + y * C1 + rest, lever)
    cosine = builder.define("c5", u[0] * S1 + u[1] * C1 + u[2], lean)
    builder.angle(5, (ONE, sine, cosine), power=0, free=False)
    return seen


def _fifth(builder: Builder, arm: Arm, R: Rotation, first: Rotation, b: int) -> None:
    """Solve joints 5 and 6 from the component of the target's axes along axis 2."""
    _, two, _, four, five, six = arm.links
    c4, s4 = twist(builder.names, four.alpha)
    c5, s5 = twist(builder.names, five.alpha)
    known = -(s4 * s5)
    builder.step(
        say(
            "{one}, {two} from the rotation, its components along axis 2",
            one="theta5",
            two="theta6",
        )
    )
    m1, m2, m3 = (
        builder.let(f"m3{j + 1}", sum((first[2][n] * R[j][n] for n in range(3)), ZERO))
        for j in range(3)
    )
    C5, S5 = builder.cos_sin((5, 1))
    C6, S6 = builder.cos_sin((6, 1))
    h1, h2 = s4 * S5, s4 * C5 * c5 + c4 * s5
    builder.equation((c4 * c5 - s4 * s5 * C5).scaled(b), m3)
    builder.equation((h1 * C6 + h2 * S6).scaled(b), m1)
    builder.equation((h2 * C6 - h1 * S6).scaled(b), m2)
    free = say(
        "Both arguments are 0 where axis 6 is parallel to axes 2, 3 and 4: there {angle} is free.",
        angle="theta6",
    )
    senses = two.sign * five.sign * six.sign * b
    if five.a:
        builder.two_equations(6, (h2, h1), (m2.scaled(b), m1.scaled(b)), 0, free=free)
        e = (S5 * known).scaled(senses)
    elif not c4 and not c5:
        # in: -s4 s5 S5 senses > 0
        root = builder.root("w5", m1 * m1 + m2 * m2, 0, is_sum=True)
        e = builder.branch("e5", root)
        side = known.scaled(senses) * e
        builder.angle(5, (ONE, side * root, known.scaled(b) * m3), power=0, free=False)
        builder.remark(free)
        builder.angle(6, (ONE, (s4 * side * m2).scaled(-b), (s4 * side * m1).scaled(b)), power=0)
    else:
        e = builder.sine_cosine(
            5, ZERO, -(s4 * s5), m3.scaled(b) - c4 * c5, 0, ONE.scaled(senses), "e5"
        )
        builder.two_equations(6, (h2, h1), (m2.scaled(b), m1.scaled(b)), 0, free=free)
    builder.remark(say("In: (z4 x z6) . z5 > 0 with z4 along axis 2."))
    builder.posture(2, TURNS, e)


def _sum_of_three(
    builder: Builder,
    R: Rotation,
    first: Rotation,
    twists: tuple[Polynomial, Polynomial, Polynomial, Polynomial],
    b: int,
) -> None:
    """Find the turn of joints 2, 3 and 4 together from the direction of axis 5."""
    _, s4, c5, s5 = twists
    builder.step(
        say(
            "The turn {angle} of joints 2, 3 and 4 together, from the direction of axis 5",
            angle="theta234",
        )
    )
    C6, S6 = builder.cos_sin((6, 1))
    axis = [s5 * (S6 * R[0][n] + C6 * R[1][n]) + c5 * R[2][n] for n in range(3)]
    named = [builder.let(f"a{a}", p) for a, p in zip("xyz", axis, strict=True)]
    x, y = (
        builder.let(name, sum((first[j][n] * named[n] for n in range(3)), ZERO))
        for j, name in enumerate(("bx", "by"))
    )
    builder.remark(
        say("Its angle to axis 2 is the twist of link 4; seen along axis 2 it has this direction:")
    )
    builder.angle(SUM, (ONE, (s4 * x).scaled(b), (s4 * y).scaled(-b)), power=0, free=False)
