"""Factors of the determinant of a chain's task Jacobian, from the geometry of its axes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.chain import Chain, chain_of
from kinematics.configuration import configuration
from kinematics.deadline import svd
from kinematics.jacobian import task_jacobian
from kinematics.named_singularities import parts
from kinematics.named_singularities.posture import Factor, cross, dot, norm, posture
from kinematics.named_singularities.reach import Reach
from kinematics.named_singularities.relations import Relations, relations_of
from kinematics.singularity import RANK_TOLERANCE, rank_of
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

EXACT = 1e-12
LARGEST_DIFFERENCE = 1e-6
OTHERS = 12
"""Other configurations at which the product is compared and the rank is looked at."""
NEAR = 1e-6
"""Normalised value up to which the smallest factor counts as zero where the rank is lost."""


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
    robot: Robot,
    q: FloatArray,
    task: Task = POSE,
    frame: str | None = None,
    tolerance: float = RANK_TOLERANCE,
) -> Factorization:
    """Return the named singularities of an arm whose structure is known.

    Known are: in ``pose`` six joints with a spherical wrist, six with axes 2, 3 and 4 parallel,
    and seven of shoulder, elbow and wrist (S-R-S); in ``position`` three joints, in
    ``orientation`` three revolute ones; planar 2R (``xy``, ``position``) and 3R (``xy_phi``,
    ``pose``), SCARA (``xyz_phi``, ``pose``). The product is compared with the model before it is
    returned, at q and at other configurations, so that it is not right by chance.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        task: The task space, in base axes.
        frame: Frame name; default the tip.
        tolerance: Relative tolerance of the rank.

    Returns:
        The factors, or the reason why there are none.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    frame = frame or robot.tip_frame
    chain = chain_of(robot, frame)
    q = configuration(robot, q)
    if chain.is_coupled:
        return _none(
            say(
                "joints of this chain depend on others; factors are known of chains"
                " whose joints are all free"
            )
        )
    known = _structure_of(robot, frame, task)
    if isinstance(known, str):
        return _none(known)
    given = np.atleast_2d(q)
    n = len(given)
    found = _product(chain, known.axes, given, task, known.others)
    assert found is not None
    structure, constant, factors = found
    values = _compared(robot, given, task, frame, constant, factors)
    if values.is_other:
        return _none(_another(structure, task))
    product, difference = values.product, values.difference
    exact = difference <= EXACT * np.abs(values.measured) + values.rounding
    singular = rank_of(values.sigma, tolerance) < values.sigma.shape[-1]
    names = [robot.joints[column].name for column in chain.columns]
    told = _told(factors, singular, tolerance, given[0, chain.columns], names)
    rows = slice(n) if q.ndim == 2 else 0
    return Factorization(
        structure,
        "determinant" if values.is_square else "manipulability",
        constant[rows],
        tuple(
            replace(
                factor,
                value=factor.value[rows],
                largest=factor.largest[rows],
                vanishes=factor.vanishes[rows],
                zeros=None,
            )
            for factor in told
        ),
        product[rows],
        difference[rows],
        exact[rows],
        None,
    )


@dataclass(frozen=True, eq=False)
class _Structure:
    """What is known of a chain whose factors were right at other configurations.

    Attributes:
        axes: How its axes lie.
        others: Largest magnitudes of its joint values there, shape (K,).
    """

    axes: Relations
    others: FloatArray


@dataclass(frozen=True, eq=False)
class _Compared:
    """A product beside what the model says; arrays of shape (n,), singular values (n, r)."""

    product: FloatArray
    measured: FloatArray
    difference: FloatArray
    rounding: FloatArray
    sigma: FloatArray
    is_square: bool

    @property
    def is_other(self) -> bool:
        """Whether the product is another at one configuration at least."""
        allowed = LARGEST_DIFFERENCE * np.abs(self.measured) + 1e4 * self.rounding
        return bool(np.any(self.difference > allowed))


_STRUCTURES: WeakKeyDictionary[Robot, dict[tuple[str, Task], _Structure | str]] = (
    WeakKeyDictionary()
)


def is_prepared(robot: Robot, task: Task, frame: str) -> bool:
    """Return whether it is known what structure a chain has, which takes a while to find."""
    return (frame, task) in _STRUCTURES.get(robot, ())


def _structure_of(robot: Robot, frame: str, task: Task) -> _Structure | str:
    """Return what is known of a chain, whatever q; or why there are no factors, in words."""
    known = _STRUCTURES.setdefault(robot, {})
    key = frame, task
    if key not in known:
        known[key] = _looked_for(robot, chain_of(robot, frame), frame, task)
    return known[key]


def _looked_for(robot: Robot, chain: Chain, frame: str, task: Task) -> _Structure | str:
    axes = relations_of(chain)
    found = None
    if axes is not None:
        q = _others(chain, np.zeros(robot.dof), axes.size)
        others = np.abs(q[:, chain.columns]).max(axis=0)
        found = _product(chain, axes, q, task, others)
    if axes is None or found is None:
        return say(
            "no factors of {value} are known for the {length} joints of this chain in task {task}",
            value=say("det J") if chain.length == len(task.rows) else say("the manipulability"),
            length=chain.length,
            task=task.name,
        )
    structure, constant, factors = found
    values = _compared(robot, q, task, frame, constant, factors)
    if np.all(rank_of(values.sigma) < values.sigma.shape[-1]):
        return say(
            "{structure}, but such that task {task} is singular at every q",
            structure=structure,
            task=task.name,
        )
    if values.is_other:
        return _another(structure, task)
    return _Structure(axes, others)


def _another(structure: str, task: Task) -> str:
    return say(
        "{structure}, but the product of its factors is not that of task {task}",
        structure=structure,
        task=task.name,
    )


def _compared(
    robot: Robot,
    q: FloatArray,
    task: Task,
    frame: str,
    constant: FloatArray,
    factors: list[Factor],
) -> _Compared:
    """Compare a product with the model at q, shape (n, dof)."""
    J = task_jacobian(robot, q, task, frame)[:, :, chain_of(robot, frame).columns]
    square = J.shape[1] == J.shape[2]
    sigma = svd(J, compute_uv=False)
    product = constant * np.prod([factor.value for factor in factors], axis=0)
    measured = np.linalg.det(J) if square else np.prod(sigma, axis=-1)
    if not square:
        product = np.abs(product)
    # A determinant near zero is a difference of large products and has their rounding error.
    rounding = 64 * np.finfo(float).eps * np.prod(np.linalg.norm(J, axis=1), axis=-1)
    return _Compared(product, measured, np.abs(product - measured), rounding, sigma, square)


def _others(chain: Chain, q: FloatArray, size: float) -> FloatArray:
    """Return configurations in general position, regardless of limits; shape (OTHERS, dof)."""
    span = np.where(chain.is_revolute, np.pi, size)
    drawn = np.random.default_rng(0).uniform(-span, span, (OTHERS, chain.length))
    others = np.repeat(q[None], OTHERS, axis=0)
    others[:, chain.columns] = drawn
    return others


def _told(
    factors: list[Factor],
    singular: NDArray[np.bool_],
    tolerance: float,
    q: FloatArray,
    names: list[str],
) -> list[Factor]:
    """Add which factors vanish, so that one does where the rank is lost and nowhere else.

    Args:
        factors: The factors, arrays of shape (n,).
        singular: Whether the rank is lost, shape (n,).
        tolerance: Of the rank.
        q: The first configuration of the chain.
        names: Of the joints of the chain.
    """
    sizes = np.array([np.abs(factor.normalised) for factor in factors])
    least = np.where(sizes.min(axis=0) <= NEAR, sizes.min(axis=0), 0.0)
    vanishes = singular & (sizes <= np.maximum(tolerance, least))
    return [
        replace(factor, vanishes=row, vanishes_where=factor.vanishes_where + _at(factor, q, names))
        for factor, row in zip(factors, vanishes, strict=True)
    ]


def _at(factor: Factor, q: FloatArray, names: list[str]) -> str:
    """Return the joint values at which a factor vanishes, in words; empty where not known."""
    zeros = factor.zeros
    values = None if zeros is None else zeros.values(q[zeros.joint])
    if zeros is None or values is None:
        return ""
    degrees = (float(np.round(np.rad2deg(value), 9)) + 0.0 for value in values)
    low, high = (f"{x:.12g}°" for x in sorted(180.0 if x == -180.0 else x for x in degrees))
    return f" ({names[zeros.joint]} = {low}, {high})"


def _none(reason: str) -> Factorization:
    nothing = np.zeros(0)
    return Factorization(
        None, "determinant", nothing, (), nothing, nothing, nothing.astype(bool), reason
    )


def _product(
    chain: Chain, axes: Relations, q: FloatArray, task: Task, others: FloatArray
) -> tuple[str, FloatArray, list[Factor]] | None:
    count, key = chain.length, (task.name, chain.length)
    reach = Reach.of(chain, q, axes.size, others)
    if count > 1 and axes.parallel[0].all():
        return _flat(chain, axes, q, task)
    if key == ("pose", 6):
        return _spherical_wrist(chain, axes, reach, q) or _parallel_axes(chain, axes, q)
    if key == ("pose", 7):
        return _srs(chain, axes, q)
    if key == ("position", 3):
        at = posture(chain, q)
        end = say("the frame's origin")
        return say("three joints that place a point"), *parts.arm(at, axes, reach, at.p, end)
    if key == ("orientation", 3) and axes.is_revolute.all():
        where = say("axes 1, 2 and 3 are directed along one plane")
        return say("three turning joints"), *parts.wrist(posture(chain, q), 0, 1, 2, where)
    return None


def _spherical_wrist(
    chain: Chain, axes: Relations, reach: Reach, q: FloatArray
) -> tuple[str, FloatArray, list[Factor]] | None:
    if not axes.is_revolute[3:].all() or axes.wrist is None:
        return None
    at = posture(chain, q)
    first, arm = parts.arm(at, axes, reach, at.point(axes.wrist), parts.WRIST_CENTRE)
    last, wrist = parts.wrist(at, 3, 4, 5, parts.in_one_plane(3, 4, 5))
    return say("spherical wrist: axes 4, 5 and 6 meet"), first * last, [*arm, *wrist]


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
        + at.lever(3, at.foot(4, point))
        + at.lever(4, point)
    )
    first, elbow = parts.three_parallel(at, 1, 2, 3)
    last, others = parts.around_parallel(at, axes.is_revolute, point, meets, reach)
    order = {"shoulder": 0, "elbow": 1}
    factors = sorted([*elbow, *others], key=lambda factor: order.get(factor.name, 2))
    return say("axes 2, 3 and 4 parallel"), first * last, factors


def _srs(
    chain: Chain, axes: Relations, q: FloatArray
) -> tuple[str, FloatArray, list[Factor]] | None:
    if not axes.is_revolute.all() or axes.shoulder is None or axes.wrist is None:
        return None
    at = posture(chain, q)
    constant, factors = parts.srs(at, axes.shoulder, at.point(axes.wrist))
    return say("spherical shoulder, elbow, spherical wrist"), constant, factors


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
        constant, factors = parts.bend(at, turning[0], turning[1], at.p, say("the frame's origin"))
        constant = constant * np.sign(dot(u, at.z(turning[1])))
        text = say("planar 2R: two parallel axes")
    elif kind in ((3, 0, "xy_phi"), (3, 0, "pose"), (3, 1, "xyz_phi"), (3, 1, "pose")):
        constant, factors = parts.three_parallel(at, turning[0], turning[1], turning[2])
        text = say("planar 3R: three parallel axes")
    else:
        return None
    if slides:
        text = say("SCARA: turns about and a slide along parallel axes")
        # The slide's column moved behind the others, and its row likewise.
        moved = (-1.0) ** (chain.length - 1 - slides[0] + (len(turning) == 3))
        constant = constant * moved * np.sign(at.z(slides[0])[:, 2])
    if len(turning) == 2 and task.name == "xy":
        constant = constant * u[:, 2]
    return text, constant, factors
