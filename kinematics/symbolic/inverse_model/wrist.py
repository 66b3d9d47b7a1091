"""Three axes through one point: Euler-like angles of what is left of the rotation."""

from __future__ import annotations

from dh_to_urdf.messages import say
from kinematics.symbolic.inverse_model.arm import Arm
from kinematics.symbolic.inverse_model.builder import (
    Builder,
    about_x,
    about_z,
    transposed,
    twist,
)
from kinematics.symbolic.polynomial import ONE, ZERO
from kinematics.symbolic.steps import Rotation, Vector

FLIP = ("noflip", "flip")


def wrist(
    builder: Builder,
    arm: Arm,
    first: int,
    arm_turned: Rotation,
    R: Rotation,
    choice: int,
    names: tuple[str, str] = FLIP,
) -> None:
    """Solve the last three joints of ``Rz(θ4) Rx(α4) Rz(θ5) Rx(α5) Rz(θ6) = arm_turnedᵀ R``.

    Args:
        builder: The derivation.
        arm: The arm.
        first: Index of the first of the three joints.
        arm_turned: Rotation of the joints before, in their sines and cosines.
        R: Rotation of the target, as named.
        choice: Which choice of the posture the wrist is.
        names: Of the choice; ``FLIP``, or one whose first is where ``(z4 × z6) · z5`` is positive.
    """
    i, j, k = first + 1, first + 2, first + 3
    links = arm.links
    (c1, s1), (c2, s2) = (twist(builder.names, links[n].alpha) for n in (first, first + 1))
    senses = links[first].sign * links[first + 1].sign * links[first + 2].sign
    senses = senses if names == FLIP else -senses
    builder.step(
        say(
            "{one}, {two}, {three} from this rotation",
            one=f"theta{i}",
            two=f"theta{j}",
            three=f"theta{k}",
        )
        if not first
        else say(
            "{one}, {two}, {three} from the rotation that is left, M = (R0{first} transposed) R",
            one=f"theta{i}",
            two=f"theta{j}",
            three=f"theta{k}",
            first=first,
        )
    )
    columns: list[Vector] = []
    for column in (0, 2):
        m = transposed(arm_turned, R[column])
        letter = "m" if first else "p"
        x, y, z = (builder.let(f"{letter}{n + 1}{column + 1}", p) for n, p in enumerate(m))
        columns.append((x, y, z))
    m1, m3 = columns
    C4, S4 = builder.cos_sin((i, 1))
    C5, S5 = builder.cos_sin((j, 1))
    C6, S6 = builder.cos_sin((k, 1))
    axis = about_x(c1, s1, (s2 * S5, (-s2) * C5, c2))
    right = not c1 and not c2
    shown = about_z(C4, S4, axis)
    for left, found in zip(shown, m3, strict=True):
        builder.equation(left, found)
    e_name = f"e{j}"
    if right:
        builder.remark(
            say(
                "The ratio of the first two gives {one}; then {two} has sine and cosine.",
                one=f"theta{i}",
                two=f"theta{j}",
            )
        )
        root = builder.root(f"w{j}", m3[0] * m3[0] + m3[1] * m3[1], 0, is_sum=True)
        e = builder.branch(e_name, root)
        rho = s1.scaled(senses) * e
        _say_in_line(builder, i, k)
        builder.angle(i, (ONE, rho * m3[1], rho * m3[0]), power=0)
        builder.angle(
            j, (ONE, s2 * (C4 * m3[0] + S4 * m3[1]), (-s1) * s2 * m3[2]), power=0, free=False
        )
    else:
        e = builder.sine_cosine(
            j,
            ZERO,
            -(s1 * s2),
            m3[2] - c1 * c2,
            0,
            ONE.scaled(-senses),
            e_name,
        )
        _say_in_line(builder, i, k)
        builder.two_equations(i, (s2 * S5, axis[1]), (m3[0], m3[1]), 0)
    builder.remark(
        say("Flip: (z{i} x z{k}) . z{j} > 0, z the directions of the axes.", i=i, j=j, k=k)
        if names == FLIP
        else say("Positive: (z{i} x z{k}) . z{j} > 0, z the directions of the axes.", i=i, j=j, k=k)
    )
    builder.posture(choice, names, e)
    x5 = about_z(C4, S4, about_x(c1, s1, (C5, S5, ZERO)))
    y5 = about_z(C4, S4, about_x(c1, s1, about_z(C5, S5, (ZERO, c2, s2))))
    cosine = x5[0] * m1[0] + x5[1] * m1[1] + x5[2] * m1[2]
    sine = y5[0] * m1[0] + y5[1] * m1[1] + y5[2] * m1[2]
    builder.remark(
        say(
            "{one} and {two} turned back, too, the first column gives:",
            one=f"theta{i}",
            two=f"theta{j}",
        )
    )
    builder.equation(C6, cosine)
    builder.equation(S6, sine)
    builder.angle(k, (ONE, sine, cosine), power=0, free=False)


def _say_in_line(builder: Builder, i: int, k: int) -> None:
    builder.remark(
        say(
            "Both arguments are 0 where axes {i} and {k} are in line: there {angle} is free.",
            i=i,
            k=k,
            angle=f"theta{i}",
        )
    )
