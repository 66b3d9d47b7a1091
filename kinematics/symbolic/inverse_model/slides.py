"""Three joints with two or three slides that bring a point to its place."""

from __future__ import annotations

from dh_to_urdf.messages import say
from kinematics.symbolic.inverse_model.arm import Arm
from kinematics.symbolic.inverse_model.builder import Builder
from kinematics.symbolic.inverse_model.first_three import REACH, in_third
from kinematics.symbolic.inverse_model.plane_arm import on_axis, out_of_reach
from kinematics.symbolic.polynomial import ZERO, Polynomial
from kinematics.symbolic.steps import (
    AboutX,
    Pose,
    Step,
    Vector,
    Walker,
    about_z,
    added,
    along,
    combination,
    times,
)


def directions(builder: Builder, arm: Arm, c: Vector) -> tuple[Vector, list[Vector]]:
    """Return where the point is with all slides at 0, and the directions of the three joints.

    Seen from axis 1, a first turn at 0.
    """
    pose, found = Pose(), []
    steps: list[Step] = []
    for k, link in enumerate(arm.links[:3]):
        pose = Walker(builder.names).go(steps)
        found.append(pose.axes[2])
        if k < 2:
            turn = [] if link.is_revolute else about_z(link.turn)
            fixed = link.slide if link.is_revolute else ZERO
            steps += [*turn, *along(z=fixed), *along(x=link.a), AboutX(link.alpha)]
    return added(pose.origin, combination(pose.axes, c)), found


def three_slides(builder: Builder, arm: Arm, w: Vector, distance: Polynomial) -> None:
    """Solve three slides: linear equations (Cramer's rule)."""
    start, axes = directions(builder, arm, in_third(builder, arm, distance))
    goal = added(w, times(start, Polynomial.constant(-1)))
    builder.step(say("The three slides, by three linear equations"))
    names = [Polynomial.symbol(builder.slide_name(k)) for k in (1, 2, 3)]
    for i in range(3):
        left = sum((axis[i] * d for axis, d in zip(axes, names, strict=True)), ZERO)
        builder.equation(left, goal[i])
    determinant = _determinant(axes[0], axes[1], axes[2])
    for k in range(3):
        replaced = [goal if j == k else axis for j, axis in enumerate(axes)]
        builder.slide(k + 1, _determinant(*replaced), determinant)


def turn_and_slides(builder: Builder, arm: Arm, w: Vector, distance: Polynomial) -> None:
    """Solve a turn and two slides after it (a cylindrical arm)."""
    start, (_, second, third) = directions(builder, arm, in_third(builder, arm, distance))
    sizes = [abs(builder.constant(axis[2])) for axis in (second, third)]
    up, out = (2, 3) if sizes[0] >= sizes[1] - 1e-8 else (3, 2)
    a, b = (second, third) if up == 2 else (third, second)
    rise = w[2] - start[2]
    # D_up = (rise - b_z D) / a_z; the point across axis 1 is foot + D e, both times a_z
    e = (b[0] * a[2] - a[0] * b[2], b[1] * a[2] - a[1] * b[2])
    name = builder.slide_name(out)
    builder.step(say("{angle} from the distance to axis 1", angle=name))
    foot = (
        builder.let("xs", start[0] * a[2] + a[0] * rise),
        builder.let("ys", start[1] * a[2] + a[1] * rise),
    )
    builder.remark(
        say("Squares of the components across axis 1 added, {angle} vanishes:", angle="theta1")
    )
    d = Polynomial.symbol(name)
    square = e[0] * e[0] + e[1] * e[1]
    mixed = builder.let("ms", foot[0] * e[0] + foot[1] * e[1])
    reach = (w[0] * w[0] + w[1] * w[1]) * a[2] * a[2]
    rest = foot[0] * foot[0] + foot[1] * foot[1]
    builder.equation(square * d * d + mixed.scaled(2) * d, reach - rest)
    builder.remark(say("A quadratic equation in {angle}: both roots.", angle=name))
    builder.remark(out_of_reach())
    root = builder.root(f"w{out}", mixed * mixed + square * (reach - rest), 2)
    sign = builder.branch(f"e{out}", root)
    sense = arm.links[out - 1].sign
    builder.remark(say("Extended: the slide drives the point away from axis 1."))
    builder.posture(0, REACH, sign)
    found = builder.slide(out, (sign * root).scaled(sense) - mixed, square)
    other = builder.slide_name(up)
    builder.step(say("{angle} from the component along axis 1", angle=other))
    builder.slide(up, rise - b[2] * found, a[2])
    builder.step(say("{angle} from both components in the plane", angle="theta1"))
    scale = Polynomial.constant(builder.sign(a[2]))
    x = builder.let("f1", (foot[0] + e[0] * found) * scale)
    y = builder.let("g1", (foot[1] + e[1] * found) * scale)
    C1, S1 = builder.cos_sin((1, 1))
    height = a[2] * scale
    builder.equation(x * C1 - y * S1, height * w[0])
    builder.equation(x * S1 + y * C1, height * w[1])
    builder.two_equations(1, (x, y), (w[0], w[1]), 2, free=on_axis(1))


def _determinant(x: Vector, y: Vector, z: Vector) -> Polynomial:
    return (
        x[0] * (y[1] * z[2] - y[2] * z[1])
        - y[0] * (x[1] * z[2] - x[2] * z[1])
        + z[0] * (x[1] * y[2] - x[2] * y[1])
    )
