"""Geometric Jacobian as polynomials, at any frame's origin and in any frame's axes."""

from __future__ import annotations

from typing import TypeAlias

from kinematics.symbolic.chain import Axis, Chain, factor_of
from kinematics.symbolic.names import Names
from kinematics.symbolic.polynomial import (
    ZERO,
    Coefficient,
    Monomial,
    Polynomial,
    multiplied,
)
from kinematics.symbolic.steps import NOWHERE, Pose, Vector, added, cross, negated

Column: TypeAlias = tuple[Polynomial, ...]
"""vx, vy, vz, wx, wy, wz."""


def column(axis: Axis, poses: list[Pose], point: Vector) -> Column:
    """Return one joint's twist per unit of its speed.

    Args:
        axis: The joint.
        poses: All frames of the chain in the wanted axes.
        point: Where the linear velocity is taken, in these axes.

    Returns:
        ``[z x (p - o); z]`` for a revolute joint, ``[z; 0]`` for a prismatic one (Siciliano et
        al., *Robotics*, eq. 3.30), times the joint's sign.
    """
    pose = poses[axis.node]
    z = pose.axes[2] if axis.sign > 0 else negated(pose.axes[2])
    if not axis.is_revolute:
        return (*z, *NOWHERE)
    return (*cross(z, added(point, negated(pose.origin))), *z)


def jacobian_columns(chain: Chain, dof: int, axes: int, point: int) -> list[Column]:
    """Return all columns, in the order of q; zeros for joints that are not on the chain.

    Args:
        chain: The chain.
        dof: Length of q.
        axes: Index of the frame whose axes are used.
        point: Index of the frame at whose origin the linear velocity is taken.
    """
    poses = chain.poses(axes)
    columns: list[Column] = [(ZERO,) * 6] * dof
    known: set[int] = set()
    for axis in chain.axes:
        if axes == 0:
            made = _derivative(axis, poses, poses[point].origin, chain.names)
        else:
            made = column(axis, poses, poses[point].origin)
        # Of an entry of q that moves several joints, the derivative of the point is that of all.
        done = 3 if axes == 0 else 0
        if axis.factor != 1:
            by = factor_of(axis.factor, chain.names)
            made = (*made[:done], *(entry * by for entry in made[done:]))
        if axis.joint in known:
            before = columns[axis.joint - 1]
            made = (*made[:done], *(a + b for a, b in zip(before[done:], made[done:], strict=True)))
        columns[axis.joint - 1] = made
        known.add(axis.joint)
    return columns


def _derivative(axis: Axis, poses: list[Pose], point: Vector, names: Names) -> Column:
    """Return the same column in the base's axes, without products: ``[∂p/∂q; z]``."""
    moved = tuple(derivative(entry, axis.joint, names) for entry in point)
    z = poses[axis.node].axes[2]
    return (*moved, *((z if axis.sign > 0 else negated(z)) if axis.is_revolute else NOWHERE))


def derivative(p: Polynomial, joint: int, names: Names) -> Polynomial:
    """Return ``∂p/∂q`` of one joint."""
    terms: list[tuple[Monomial, Coefficient]] = []
    for monomial, coefficient in p:
        for name, exponent in monomial:
            inner = _inner(name, joint, names)
            if inner is None:
                continue
            other, factor = inner
            rest = tuple((n, e - 1 if n == name else e) for n, e in monomial)
            lowered = tuple(item for item in rest if item[1])
            grown = multiplied(lowered, ((other, 1),)) if other else lowered
            terms.append((grown, coefficient * exponent * factor))
    return Polynomial.collected(terms)


def _inner(name: str, joint: int, names: Names) -> tuple[str, int] | None:
    """Return the derivative of one symbol as (symbol, factor); an empty symbol for 1."""
    if names.variables.get(name) == joint:
        return "", 1
    angle = names.angle_of(name)
    factor = dict(angle.multiples).get(joint, 0) if angle is not None else 0
    if not factor:
        return None
    return (f"S{name[1:]}", -factor) if name[0] == "C" else (f"C{name[1:]}", factor)
