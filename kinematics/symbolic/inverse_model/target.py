"""The target's elements, and the target without base and tool."""

from __future__ import annotations

from dataclasses import dataclass

from dh_to_urdf.messages import say
from kinematics.symbolic.angles import Angle, twelfths
from kinematics.symbolic.inverse_model.arm import Arm, pose_of
from kinematics.symbolic.inverse_model.builder import Builder, transposed
from kinematics.symbolic.inverse_model.notation import PYTHON
from kinematics.symbolic.polynomial import ZERO, Polynomial
from kinematics.symbolic.steps import (
    AboutX,
    AboutZ,
    Pose,
    Rotation,
    Step,
    Vector,
    Walker,
    about_z,
    added,
    along,
    combination,
    negated,
)

ELEMENTS = (*(f"{letter}{row}" for letter in "uvw" for row in "xyz"), "X", "Y", "Z")
"""Columns of the target: the axes u, v, w of the frame, and its origin."""


@dataclass(frozen=True)
class Target:
    """A target that was given, as symbols.

    Attributes:
        axes: Columns u, v, w.
        origin: X, Y, Z.
        places: Name, row and column of each element.
    """

    axes: Rotation
    origin: Vector
    places: tuple[tuple[str, int, int], ...]


def target_of(builder: Builder) -> Target:
    """Return the symbols of a target."""
    found = [builder.names.fresh(name) for name in ELEMENTS]
    p = [Polynomial.symbol(name) for name in found]
    u, v, w, origin = ((p[k], p[k + 1], p[k + 2]) for k in (0, 3, 6, 9))
    places = tuple((name, k % 3, k // 3) for k, name in enumerate(found))
    return Target((u, v, w), origin, places)


def without_base_and_tool(
    builder: Builder, arm: Arm, target: Target, last: Polynomial = ZERO
) -> tuple[Rotation, Vector]:
    """Return the rotation and origin of the last joint's frame, seen from axis 1's.

    Args:
        builder: The derivation.
        arm: The arm.
        target: What is given.
        last: A length along the last axis that is taken off, too.
    """
    names = builder.names
    before, after = pose_of(arm.before, names), pose_of([*along(z=last), *arm.after], names)
    offset = transposed(after.axes, after.origin)
    origin = added(target.origin, negated(combination(target.axes, offset)))
    origin = added(origin, negated(before.origin))
    inside = transposed(before.axes, origin)
    columns = [transposed(before.axes, axis) for axis in target.axes]
    rows = [[column[i] for column in columns] for i in range(3)]
    # R_U = R_Bᵀ R R_Eᵀ: row i, column j is row i of R_Bᵀ R along row j of R_E.
    turned = [
        [sum((row[k] * after.axes[k][j] for k in range(3)), ZERO) for j in range(3)] for row in rows
    ]
    return (
        (turned[0][0], turned[1][0], turned[2][0]),
        (turned[0][1], turned[1][1], turned[2][1]),
        (turned[0][2], turned[1][2], turned[2][2]),
    ), inside


def end_of_three(builder: Builder, arm: Arm, target: Target) -> Vector:
    """Return the target's position seen from axis 1."""
    before = pose_of(arm.before, builder.names)
    origin = added(target.origin, negated(before.origin))
    return transposed(before.axes, origin)


def named_rotation(builder: Builder, R: Rotation, columns: str = "123") -> Rotation:
    """Return a rotation with its entries named r11 … r33 where they are not single terms."""
    found = [
        [
            builder.let(f"r{i + 1}{j + 1}", R[j][i]) if str(j + 1) in columns else R[j][i]
            for i in range(3)
        ]
        for j in range(3)
    ]
    x, y, z = ((one[0], one[1], one[2]) for one in found)
    return x, y, z


def turned(builder: Builder, arm: Arm, first: int, count: int) -> Rotation:
    """Return the rotation of ``count`` joints with the links after them, from joint ``first``."""
    steps: list[Step] = []
    for k in range(first, first + count):
        link = arm.links[k]
        steps += [AboutZ(Angle(((k + 1, 1),)))] if link.is_revolute else about_z(link.turn)
        steps.append(AboutX(link.alpha))
    return Walker(builder.names).go(steps).axes


def upright(builder: Builder, arm: Arm, R: Rotation, normal: Vector) -> list[Polynomial]:
    """Return the components of a vector along +z, +y and +x of base_link.

    Args:
        builder: The derivation.
        arm: The arm.
        R: Rotation of the axes in which the vector is given, seen from axis 1's.
        normal: The vector.
    """
    mount = pose_of(arm.mount, builder.names).axes
    seen = combination(mount, combination(R, normal))
    return [seen[2], seen[1], seen[0]]


def say_taken_off(builder: Builder, arm: Arm, last: Polynomial) -> None:
    """Say what is taken off the target."""
    after = pose_of(arm.after, builder.names)
    base, tool = pose_of(arm.before, builder.names) != Pose(), after != Pose()
    if base and tool:
        builder.remark(
            say(
                "The base and the tool are taken off: the inverse of the base, T, the inverse of"
                " the tool."
            )
        )
    elif base:
        builder.remark(say("The base is taken off: the inverse of the base from the left."))
    elif tool:
        builder.remark(say("The tool is taken off: the inverse of the tool from the right."))
    if last:
        builder.remark(
            say("Back along the last axis by {length}.", length=PYTHON.sum(builder.plain(last)))
        )


__all__ = ["ELEMENTS", "Target", "named_rotation", "target_of", "turned", "twelfths"]
