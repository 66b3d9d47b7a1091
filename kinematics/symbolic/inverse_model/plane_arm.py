"""Two parallel axes: the law of cosines, and the name of the elbow."""

from __future__ import annotations

from collections.abc import Sequence

from dh_to_urdf.messages import say
from kinematics.symbolic.inverse_model.builder import Builder
from kinematics.symbolic.polynomial import ONE, Polynomial

ELBOW = ("up", "down")


def plane_arm(
    builder: Builder,
    joints: tuple[int, int],
    goal: tuple[Polynomial, Polynomial],
    links: tuple[tuple[Polynomial, Polynomial], tuple[Polynomial, Polynomial]],
    sense: int,
    normal: Sequence[Polynomial],
    choice: int,
) -> None:
    """Solve ``Rz(θi) (l1 + Rz(± θj) l2) = goal`` in a plane.

    Args:
        builder: The derivation.
        joints: Numbers i and j.
        goal: The end, from axis i.
        links: l1 and l2.
        sense: -1 where axis j points against axis i.
        normal: z × goal along +z, +y, +x of base_link, see :mod:`elbow` of the closed forms.
        choice: Which choice of the posture the elbow is.
    """
    i, j = joints
    (ax, ay), (bx, by) = links
    x, y = goal
    builder.step(say("{angle} from the distance to the end (law of cosines)", angle=f"theta{j}"))
    builder.remark(
        say(
            "Squares added, {angle} vanishes, as it does not change the distance:",
            angle=f"theta{i}",
        )
    )
    C, S = builder.cos_sin((j, 1))
    sine = (ay * bx - ax * by).scaled(2 * sense)
    cosine = (ax * bx + ay * by).scaled(2)
    fixed = ax * ax + ay * ay + bx * bx + by * by
    square = x * x + y * y
    left, right = sine * S + cosine * C, square - fixed
    if builder.sum(left).terms[0].coefficient < 0:
        left, right = -left, -right
    builder.equation(left, right)
    orient = Polynomial.constant(-sense)
    facing = [p for p in normal if p]
    e = builder.sine_cosine(
        j, sine, cosine, square - fixed, 2, orient, f"e{j}", fails=out_of_reach()
    )
    builder.remark(
        say(
            "Up: axis {j} is above the line from axis {i} to the end, seen along the axes.",
            i=i,
            j=j,
        )
    )
    up = builder.upwards(f"k{j}", facing) if facing else ONE
    builder.posture(choice, ELBOW, e * up)
    builder.step(say("{angle} from both components in the plane", angle=f"theta{i}"))
    first = ax + bx * C - by * S.scaled(sense), ay + by * C + bx * S.scaled(sense)
    Ci, Si = builder.cos_sin((i, 1))
    k1, k2 = builder.let(f"f{i}", first[0]), builder.let(f"g{i}", first[1])
    builder.equation(k1 * Ci - k2 * Si, x)
    builder.equation(k1 * Si + k2 * Ci, y)
    builder.two_equations(i, (k1, k2), (x, y), 2, free=on_axis(i))


def out_of_reach() -> str:
    """Say what a root that is not real means."""
    return say("Out of reach where what is under the root is negative: no solution.")


def on_axis(axis: int) -> str:
    """Say where an angle is free."""
    return say(
        "Both arguments are 0 where the point is on axis {axis}: there {angle} is free.",
        axis=axis,
        angle=f"theta{axis}",
    )
