"""Seven turning joints, spherical shoulder, elbow, spherical wrist, for a given swivel angle.

Shimizu et al., *Analytical Inverse Kinematic Computation for 7-DOF Redundant Manipulators With
Joint Limits and Its Application to Redundancy Resolution*, IEEE T-RO 24(5), 2008. The swivel is
that of ``ik/solutions``, see :mod:`kinematics.inverse.closed_form.srs`.
"""

from __future__ import annotations

from dh_to_urdf.messages import say
from kinematics.symbolic.inverse_model.arm import Arm, pose_of
from kinematics.symbolic.inverse_model.builder import Builder, about_x, about_z, twist
from kinematics.symbolic.inverse_model.plane_arm import out_of_reach
from kinematics.symbolic.inverse_model.wrist import wrist
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial
from kinematics.symbolic.steps import Rotation, Vector, added, cross, times

SENSE = ("positive", "negative")
STRETCHED, UPRIGHT = 1e-7, 1e-6
"""As in :mod:`kinematics.inverse.closed_form.srs`."""


def ends(builder: Builder, arm: Arm) -> tuple[Vector, Vector]:
    """Return the shoulder, and the wrist before joint 4 turns, seen from axis 4."""
    third, fourth, fifth = arm.links[2:5]
    c3, s3 = twist(builder.names, third.alpha)
    c4, s4 = twist(builder.names, fourth.alpha)
    x, y, z = about_x(c4, s4, (ZERO, ZERO, fifth.slide))
    shoulder = about_x(c3, -s3, (-third.a, ZERO, -third.slide))
    return shoulder, (x + fourth.a, y, z + fourth.slide)


def shoulder_elbow_wrist(builder: Builder, arm: Arm, R: Rotation, w: Vector, swivel: str) -> None:
    """Solve all seven joints.

    Args:
        builder: The derivation.
        arm: The arm.
        R: Rotation of the target, as named.
        w: The centre of the wrist, seen from axis 1.
        swivel: Name of the swivel angle.
    """
    shoulder, end = ends(builder, arm)
    fourth = arm.links[3]
    builder.step(say("{angle} from the distance of shoulder and wrist", angle="theta4"))
    height = w[2] - arm.links[0].slide
    line = _named(builder, "l", (w[0], w[1], height))
    square = _dot(line, line)
    C4, S4 = builder.cos_sin((4, 1))
    sine = (end[1] * shoulder[0] - end[0] * shoulder[1]).scaled(2)
    cosine = (end[0] * shoulder[0] + end[1] * shoulder[1]).scaled(-2)
    fixed = _dot(end, end) + _dot(shoulder, shoulder) - (end[2] * shoulder[2]).scaled(2)
    builder.equation(sine * S4 + cosine * C4, square - fixed)
    length = builder.root("l", square, 2, is_sum=True, is_divisor=True)
    e = builder.sine_cosine(
        4,
        sine,
        cosine,
        square - fixed,
        2,
        Polynomial.constant(fourth.sign),
        "e4",
        fails=out_of_reach(),
    )
    builder.remark(say("Positive: joint 4 bends the arm positively about its axis."))
    builder.posture(1, SENSE, e)
    R03 = _turn_of_forearm(builder, arm, line, length, swivel)
    c3, s3 = twist(builder.names, arm.links[2].alpha)
    before = _mixed(R03, c3, -s3)
    identity = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
    wrist(builder, arm, 0, identity, before, 0, SENSE)
    c4, s4 = twist(builder.names, fourth.alpha)
    x = added(times(R03[0], C4), times(R03[1], S4))
    y = added(times(R03[1], C4), times(R03[0], -S4))
    R04 = _mixed((x, y, R03[2]), c4, s4)
    builder.step(say("The turn of the first four joints"))
    named = [_named(builder, f"h{j}", R04[j]) for j in range(3)]
    wrist(builder, arm, 4, (named[0], named[1], named[2]), R, 2, SENSE)


def _turn_of_forearm(
    builder: Builder, arm: Arm, line: Vector, length: Polynomial, swivel: str
) -> Rotation:
    """Return the rotation of the first three joints: of the arm's plane to where swivel has it."""
    shoulder, end = ends(builder, arm)
    mount = pose_of(arm.mount, builder.names).axes
    along_axis_1 = abs(builder.constant(mount[2][0])) < 0.9
    beside = tuple(axis[0 if along_axis_1 else 1] for axis in mount)
    builder.step(
        say(
            "The plane of the arm, turned by {angle} about the line from shoulder to wrist",
            angle=swivel,
        )
    )
    builder.remark(
        say("{angle} is the swivel angle of ik/solutions: 0 where axis 1 is in it.", angle=swivel)
    )
    n = _divided(builder, "n", line, length)
    up = (ZERO, ZERO, Polynomial.constant(arm.links[0].sign))
    r = builder.across("r", (up, (beside[0], beside[1], beside[2])), n, UPRIGHT, 0)
    Cs, Ss = builder.turn("s", swivel)
    o = _named(builder, "o", added(times(r, Cs), times(cross(n, r), Ss)))
    b = _named(builder, "b", cross(n, o))
    builder.step(say("The same plane seen from axis 4, with joints 1 to 3 at 0"))
    C4, S4 = builder.cos_sin((4, 1))
    x, y, z = about_z(C4, S4, end)
    k = _divided(builder, "k", (x - shoulder[0], y - shoulder[1], z - shoulder[2]), length)
    bent = Polynomial.constant(arm.links[3].sign)
    v = builder.across(
        "f",
        ((-shoulder[0], -shoulder[1], ZERO), (-k[1] * bent, k[0] * bent, ZERO)),
        k,
        STRETCHED,
        1,
    )
    c = _named(builder, "c", cross(k, v))
    builder.step(say("The rotation that brings one to the other"))
    found = []
    for j in range(3):
        column = added(added(times(n, k[j]), times(o, v[j])), times(b, c[j]))
        found.append(_named(builder, f"g{j}", column))
    return found[0], found[1], found[2]


def _mixed(R: Rotation, c: Polynomial, s: Polynomial) -> Rotation:
    """Return ``R Rx(α)`` of cosine and sine."""
    x, y, z = R
    return x, added(times(y, c), times(z, s)), added(times(z, c), times(y, -s))


def _named(builder: Builder, name: str, v: Vector) -> Vector:
    x, y, z = (builder.let(f"{name}{a}", p) for a, p in zip("xyz", v, strict=True))
    return x, y, z


def _divided(builder: Builder, name: str, v: Vector, length: Polynomial) -> Vector:
    x, y, z = (
        builder.define(f"{name}{a}", p, length) if p else ZERO
        for a, p in zip("xyz", v, strict=True)
    )
    return x, y, z


def _dot(v: Vector, w: Vector) -> Polynomial:
    return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]
