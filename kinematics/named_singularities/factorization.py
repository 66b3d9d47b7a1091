"""Factors of the determinant of a chain's task Jacobian, from the geometry of its axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain, chain_of
from kinematics.configuration import configuration
from kinematics.deadline import svd
from kinematics.inverse.closed_form.geometry import LENGTH
from kinematics.jacobian import task_jacobian
from kinematics.named_singularities import parts
from kinematics.named_singularities.posture import Factor, cross, dot, norm, posture
from kinematics.named_singularities.relations import Relations, relations_of
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

EXACT = 1e-12
LARGEST_DIFFERENCE = 1e-6


@dataclass(frozen=True, eq=False)
class Factorization:
    """``det J = constant · Π factors``; arrays have shape (n,), or () for one q.

    Attributes:
        structure: The recognised structure, in words; None where there is none.
        of: ``determinant`` of the chain's task Jacobian, its columns from base to frame; or
            ``manipulability`` where it is not square.
        constant: The factor that does not depend on q: lengths and sines of link twists.
        factors: The factors.
        product: Constant times factors.
        difference: |product - the model's own determinant or manipulability|.
        exact: Whether the difference is rounding, at most 1e-12 relative. It is more where a file
            holds rounded angles, so that axes are parallel, or meet, only nearly.
        reason: Why there are no factors, where there are none.
    """

    structure: str | None
    of: str
    constant: FloatArray
    factors: tuple[Factor, ...]
    product: FloatArray
    difference: FloatArray
    exact: NDArray[np.bool_]
    reason: str | None


def factorization(
    robot: Robot, q: FloatArray, task: Task = POSE, frame: str | None = None
) -> Factorization:
    """Return the named singularities of an arm whose structure is known.

    Known are: in ``pose`` six joints with a spherical wrist, six with axes 2, 3 and 4 parallel,
    and seven of shoulder, elbow and wrist (S-R-S); in ``position`` three joints, in
    ``orientation`` three revolute ones; planar 2R (``xy``, ``position``) and 3R (``xy_phi``,
    ``pose``), SCARA (``xyz_phi``, ``pose``). The product is compared with the model before it is
    returned.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        task: The task space, in base axes.
        frame: Frame name; default the tip.

    Returns:
        The factors, or the reason why there are none.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    frame = frame or robot.tip_frame
    chain = chain_of(robot, frame)
    q = configuration(robot, q)
    batch = np.atleast_2d(q)
    if chain.is_coupled:
        return _none(
            "joints of this chain depend on others; factors are known of chains whose joints are"
            " all free"
        )
    axes = relations_of(chain)
    found = _product(chain, axes, batch, task) if axes is not None else None
    if axes is None or found is None:
        return _none(
            f"no factors of {'det J' if chain.length == len(task.rows) else 'the manipulability'}"
            f" are known for the {chain.length} joints of this chain in task {task.name}"
        )
    structure, constant, factors = found
    bounds = [np.abs(constant), *(factor.largest for factor in factors)]
    if min(bound.max() for bound in bounds) <= LENGTH * min(1.0, axes.size):
        return _none(f"{structure}, but such that task {task.name} is singular at every q")
    product = constant * np.prod([factor.value for factor in factors], axis=0)
    J = task_jacobian(robot, batch, task, frame)[:, :, chain.columns]
    square = J.shape[1] == J.shape[2]
    measured = np.linalg.det(J) if square else np.prod(svd(J, compute_uv=False), axis=-1)
    if not square:
        product = np.abs(product)
    difference = np.abs(product - measured)
    # A determinant near zero is a difference of large products and has their rounding error.
    rounding = 64 * np.finfo(float).eps * np.prod(np.linalg.norm(J, axis=1), axis=-1)
    if np.any(difference > LARGEST_DIFFERENCE * np.abs(measured) + 1e4 * rounding):
        return _none(f"{structure}, but the product of its factors is not that of task {task.name}")
    exact = difference <= EXACT * np.abs(measured) + rounding
    if q.ndim == 1:
        factors = [_single(factor) for factor in factors]
        constant, product, difference, exact = constant[0], product[0], difference[0], exact[0]
    of = "determinant" if square else "manipulability"
    return Factorization(structure, of, constant, tuple(factors), product, difference, exact, None)


def _none(reason: str) -> Factorization:
    nothing = np.zeros(0)
    return Factorization(
        None, "determinant", nothing, (), nothing, nothing, nothing.astype(bool), reason
    )


def _single(factor: Factor) -> Factor:
    return Factor(
        factor.name,
        factor.value[0],
        factor.largest[0],
        factor.unit,
        factor.joints,
        factor.vanishes_where,
    )


def _product(
    chain: Chain, axes: Relations, q: FloatArray, task: Task
) -> tuple[str, FloatArray, list[Factor]] | None:
    count, key = chain.length, (task.name, chain.length)
    if count > 1 and axes.parallel[0].all():
        return _flat(chain, axes, q, task)
    if key == ("pose", 6):
        return _spherical_wrist(chain, axes, q) or _parallel_axes(chain, axes, q)
    if key == ("pose", 7):
        return _srs(chain, axes, q)
    if key == ("position", 3):
        at = posture(chain, q)
        return "three joints that place a point", *parts.arm(at, axes, at.p)
    if key == ("orientation", 3) and axes.is_revolute.all():
        return "three turning joints", *parts.wrist(posture(chain, q), 0, 1, 2)
    return None


def _spherical_wrist(
    chain: Chain, axes: Relations, q: FloatArray
) -> tuple[str, FloatArray, list[Factor]] | None:
    if not axes.is_revolute[3:].all() or axes.wrist is None:
        return None
    at = posture(chain, q)
    first, arm = parts.arm(at, axes, at.point(axes.wrist))
    last, wrist = parts.wrist(at, 3, 4, 5)
    return "spherical wrist: axes 4, 5 and 6 meet", first * last, [*arm, *wrist]


def _parallel_axes(
    chain: Chain, axes: Relations, q: FloatArray
) -> tuple[str, FloatArray, list[Factor]] | None:
    if not axes.is_revolute[1:].all() or not axes.parallel[1, 2:4].all():
        return None
    at = posture(chain, q)
    meets = axes.last_two is not None
    point = at.point(axes.on_last if axes.last_two is None else axes.last_two)
    n = cross(at.z(0), at.z(1))
    n /= np.maximum(norm(n), 1e-300)[:, None]
    reach = (
        np.abs(dot(at.O[:, 1] - at.O[:, 0], n))
        + at.lever(1, at.O[:, 2])
        + at.lever(2, at.O[:, 3])
        + at.lever(3, point)
    )
    first, elbow = parts.three_parallel(at, 1, 2, 3)
    last, others = parts.around_parallel(at, axes.is_revolute, point, meets, reach)
    order = {"shoulder": 0, "elbow": 1}
    factors = sorted([*elbow, *others], key=lambda factor: order.get(factor.name, 2))
    return "axes 2, 3 and 4 parallel", first * last, factors


def _srs(
    chain: Chain, axes: Relations, q: FloatArray
) -> tuple[str, FloatArray, list[Factor]] | None:
    if not axes.is_revolute.all() or axes.shoulder is None or axes.wrist is None:
        return None
    at = posture(chain, q)
    constant, factors = parts.srs(at, axes.shoulder, at.point(axes.wrist))
    return "spherical shoulder, elbow, spherical wrist", constant, factors


def _flat(
    chain: Chain, axes: Relations, q: FloatArray, task: Task
) -> tuple[str, FloatArray, list[Factor]] | None:
    """Factor an arm with parallel axes: revolute joints and at most one prismatic joint."""
    turning = [int(k) for k in np.flatnonzero(axes.is_revolute)]
    slides = [int(k) for k in np.flatnonzero(~axes.is_revolute)]
    kind = (len(turning), len(slides), task.name)
    at = posture(chain, q)
    u = at.z(turning[0]) if turning else None
    if u is None or len(slides) > 1:
        return None
    if kind in ((2, 0, "xy"), (2, 0, "position"), (2, 1, "position")):
        constant, factors = parts.bend(at, turning[0], turning[1], at.p)
        constant = constant * np.sign(dot(u, at.z(turning[1])))
        text = "planar 2R: two parallel axes"
    elif kind in ((3, 0, "xy_phi"), (3, 0, "pose"), (3, 1, "xyz_phi"), (3, 1, "pose")):
        constant, factors = parts.three_parallel(at, turning[0], turning[1], turning[2])
        text = "planar 3R: three parallel axes"
    else:
        return None
    if slides:
        text = "SCARA: turns about and a slide along parallel axes"
        # The slide's column moved behind the others, and its row likewise.
        moved = (-1.0) ** (chain.length - 1 - slides[0] + (len(turning) == 3))
        constant = constant * moved * np.sign(at.z(slides[0])[:, 2])
    if len(turning) == 2 and task.name == "xy":
        constant = constant * u[:, 2]
    return text, constant, factors
