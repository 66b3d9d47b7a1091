"""All solutions of one general complex target, which every other target is followed from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle, pairwise

import numpy as np
from numpy.typing import NDArray

from kinematics.deadline import checkpoint
from kinematics.inverse.continuation.closure import LEAST_PIVOT, SquareSystem
from kinematics.inverse.continuation.complex_chain import Way
from kinematics.inverse.continuation.following import ARRIVED, follow, pose_of
from kinematics.inverse.windings import on_circle
from robots.robot import FloatArray

ComplexArray = NDArray[np.complex128]

HIGHEST_DEGREE = 16
"""Solutions of six joints in general position (Raghavan and Roth, 1990); no other six have more."""
IDLE_POINTS, IDLE_LOOPS, IDLE_MIRRORS = 30, 8, 3
"""Random points, loops and real targets in a row that lead to known solutions only, at which the
search ends."""
LIKE = 1e-4
"""Difference, rad or sizes, of two complex solutions that are the same."""
MIRRORED = 1e-5
"""Difference between a solution of a real target and the conjugate of another, which it should be,
in parts of its imaginary part."""
LARGE_STEP, SAFE_STEP = 0.3, 0.1
"""Largest correction of a step: usual, and where it must not slip."""
SPREAD, WIDE_SPREAD = 0.5, 0.9
"""Standard deviations of the imaginary parts of general points, rad: usual, and of every other
loop, around targets that are farther from the real ones."""
ATTEMPTS = 8


@dataclass(frozen=True, eq=False)
class Fibre:
    """The solutions of one general complex target.

    Attributes:
        system: The equations.
        pose: The target, 12 complex numbers, lengths in units of the system's size.
        driven: Values of the given joints there, shape (K - m,).
        q: The solutions, one a row, shape (degree, K).
    """

    system: SquareSystem
    pose: ComplexArray
    driven: ComplexArray
    q: ComplexArray

    @property
    def degree(self) -> int:
        """Number of complex solutions of a general target."""
        return len(self.q)

    def followed(
        self, pose: ComplexArray, driven: ComplexArray, step: float = LARGE_STEP
    ) -> tuple[ComplexArray, NDArray[np.int64]]:
        """Follow all solutions to another target.

        Args:
            pose: Its 12 numbers.
            driven: Values of the given joints there.
            step: Largest correction of a step, rad.

        Returns:
            Joint values, shape (degree, K), and how each ended.
        """
        return carried(self.system, self.q, (self.pose, self.driven), (pose, driven), step)


def carried(
    system: SquareSystem,
    q: ComplexArray,
    start: tuple[ComplexArray, ComplexArray],
    end: tuple[ComplexArray, ComplexArray],
    step: float = LARGE_STEP,
) -> tuple[ComplexArray, NDArray[np.int64]]:
    """Follow solutions from one target to another.

    Args:
        system: The equations.
        q: The solutions at the start, shape (N, K).
        start: Pose and values of the given joints.
        end: Likewise.
        step: Largest correction of a step, rad.

    Returns:
        Joint values, shape (N, K), and how each ended.
    """
    way = Way(
        start[0],
        rotation_vector(end[0], start[0]),
        (end[0] - start[0])[[3, 7, 11]],
        start[1],
        end[1] - start[1],
    )
    moved, ends = q.copy(), np.empty(len(q), dtype=np.int64)
    follow(system.closure, way, moved, step, ends)
    return moved, ends


def rotation_vector(pose: ComplexArray, other: ComplexArray) -> ComplexArray:
    """Return w with ``exp([w])`` the rotation from another pose to a pose; complex, shape (3,)."""
    R = pose.reshape(3, 4)[:, :3] @ other.reshape(3, 4)[:, :3].T
    cosine = (np.trace(R) - 1.0) / 2.0
    angle = np.arccos(cosine)
    skew = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = np.sin(angle)
    return np.asarray(skew * (0.5 if abs(angle) < 1e-8 else angle / (2.0 * sine)))


def apart(system: SquareSystem, q: ComplexArray, others: ComplexArray) -> FloatArray:
    """Return the largest differences of q from others, (…, K) -> (…), angles on the circle."""
    difference = others - q
    real = on_circle(difference.real, system.is_revolute)
    return np.asarray(np.maximum(np.abs(real), np.abs(difference.imag)).max(axis=-1, initial=0.0))


def fibre_of(system: SquareSystem, seed: int = 0) -> Fibre | None:
    """Return all solutions of one general target.

    Random points of the space of joint values, each with its own target, are followed to one
    target, and the solutions there around loops of targets, until neither leads to a new one. All
    solutions are connected by such ways, as the space of joint values is in one piece. Then they
    are followed to real targets, where the conjugate of each must be among them, and back.

    Args:
        system: The equations.
        seed: Of the random target.

    Returns:
        None where no target of the chain is general: its Jacobian has lost rank everywhere.
    """
    random = np.random.default_rng(seed)
    first = _point(system, random)
    base = _target(system, first)
    if not _is_regular(system, first):
        return None
    known = first[None]
    idle = [0, 0, 0]
    loops = _loops(system, random, base)
    while len(known) < HIGHEST_DEGREE or system.rows < 6:
        checkpoint()
        if idle[0] < IDLE_POINTS:
            way, found = 0, _from_point(system, _point(system, random), base)
        elif idle[1] < IDLE_LOOPS:
            way, found = 1, _around(system, known, next(loops))
        elif idle[2] < IDLE_MIRRORS:
            way, found = 2, _mirrored(system, known, base, _point(system, random).real)
        else:
            break
        fresh = _fresh(system, known, found, base)
        idle[way] = 0 if len(fresh) else idle[way] + 1
        known = np.vstack((known, fresh))
    return Fibre(system, base[0], base[1], known)


def moved_fibre(fibre: Fibre, seed: int) -> Fibre:
    """Return the same for another general target, which other ways lead from."""
    random = np.random.default_rng(seed)
    for _ in range(ATTEMPTS):
        target = _target(fibre.system, _point(fibre.system, random))
        q, ends = fibre.followed(*target, SAFE_STEP)
        if (ends == ARRIVED).all():
            return Fibre(fibre.system, *target, q)
    return fibre


Target = tuple[ComplexArray, ComplexArray]


def _point(
    system: SquareSystem, random: np.random.Generator, spread: float = SPREAD
) -> ComplexArray:
    K = len(system.is_revolute)
    real = np.where(system.is_revolute, random.uniform(-np.pi, np.pi, K), random.normal(size=K))
    return np.asarray(real + 1j * spread * random.normal(size=K))


def _target(system: SquareSystem, q: ComplexArray) -> Target:
    pose = np.empty(12, dtype=np.complex128)
    pose_of(system.closure, q, pose)
    return pose, q[system.closure.driven]


def _is_regular(system: SquareSystem, q: ComplexArray) -> bool:
    K, steps = len(q), 1e-6
    pose = _target(system, q)[0]
    columns = []
    for k in system.closure.unknowns:
        moved = q.copy()
        moved[k] += steps
        other = _target(system, moved)[0]
        w = rotation_vector(other, pose)
        columns.append(np.concatenate(((other - pose)[[3, 7, 11]], w)) / steps)
    J = np.array(columns).T
    if system.closure.own_axes:
        J[3:] = pose.reshape(3, 4)[:, :3].T @ J[3:]
    sigma = np.linalg.svd(J[system.closure.rows], compute_uv=False)
    return bool(K > 0 and sigma[-1] > LEAST_PIVOT * sigma[0])


def _loops(
    system: SquareSystem, random: np.random.Generator, base: Target
) -> Iterator[list[Target]]:
    for spread in cycle((SPREAD, WIDE_SPREAD)):
        yield [base, *(_target(system, _point(system, random, spread)) for _ in range(2)), base]


def _from_point(system: SquareSystem, q: ComplexArray, base: Target) -> ComplexArray:
    """Return where a point leads to, a solution of the base in one row, or none."""
    found, ends = carried(system, q[None], _target(system, q), base)
    return np.asarray(found[ends == ARRIVED])


def _mirrored(
    system: SquareSystem, known: ComplexArray, base: Target, real: FloatArray
) -> ComplexArray:
    """Return solutions of the base that the conjugates of those at a real target lead to."""
    target = _target(system, real.astype(np.complex128))
    q, ends = carried(system, known, base, target, SAFE_STEP)
    q = q[ends == ARRIVED]
    missing = [one.conj() for one in q if apart(system, one.conj(), q).min() > MIRRORED]
    if not missing:
        return np.empty((0, known.shape[1]), dtype=np.complex128)
    found, ends = carried(system, np.array(missing), target, base, SAFE_STEP)
    return np.asarray(found[ends == ARRIVED])


def _around(system: SquareSystem, known: ComplexArray, loop: list[Target]) -> ComplexArray:
    """Return where solutions of a loop's first target lead to along the loop."""
    q = known
    for start, end in pairwise(loop):
        q, ends = carried(system, q, start, end)
        q = q[ends == ARRIVED]
    return q


def _fresh(
    system: SquareSystem, known: ComplexArray, found: ComplexArray, base: Target
) -> ComplexArray:
    """Return those of the solutions that were found which are not known yet."""
    fresh: list[ComplexArray] = []
    for q in found:
        pose = _target(system, q)[0]
        if system.rows == 6 and np.abs(pose - base[0]).max() > LIKE:
            continue
        so_far = np.vstack((known, *(one[None] for one in fresh)))
        if apart(system, q, so_far).min() > LIKE:
            fresh.append(q)
    return np.array(fresh, dtype=np.complex128).reshape(-1, known.shape[1])
