"""Problem and options of path following, the same for every method."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.errors import InvalidOption, WrongConfiguration, dotted
from kinematics.processes.pool import ProcessPool
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.distances import Scene
from kinematics.redundancy.clearance.link_geometry import LinkGeometry
from kinematics.redundancy.clearance.links import Links, skeleton
from kinematics.redundancy.path.geometry import Path
from robots.robot import FloatArray

TOUCH = 1e-9
"""Excess of a limit that counts as rounding, rad or m."""
NEAR_STEP, LONGEST_STEP = 0.3, 1.0
"""Motion of a turning joint in a sample, rad: one that needs no question, and the largest."""
GENEROUS = 10.0
"""Motion of a joint for that of the frame, relative to an arm stretched out."""
MAX_OBSTACLES = 100
MAX_PAIRS = 200_000
"""Largest product of samples, obstacles and links of a path."""


@dataclass(frozen=True)
class PathTolerance:
    """Largest errors at a sample that count as on the path.

    Attributes:
        position: m.
        orientation: rad.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {
        "position": Bounds(1e-9, 1e3),
        "orientation": Bounds(1e-9, 1e3),
    }

    position: float = 1e-4
    orientation: float = 1e-4

    def __post_init__(self) -> None:
        for name, bounds in self.BOUNDS.items():
            value = getattr(self, name)
            if value not in bounds:
                raise bounds.refusal(
                    say("tolerance.{name} is {value:g}; give 1e-9 to 1e3", name=name, value=value),
                    value,
                    "tolerance",
                    (name,),
                )


@dataclass(frozen=True, eq=False)
class PathProblem:
    """A path for an arm among obstacles.

    Attributes:
        arm: The arm and its task space.
        start: Configuration of all joints at sample 0, shape (dof,), rad and m.
        path: The path; its first target is the arm's pose at the start.
        obstacles: See :func:`kinematics.redundancy.clearance.obstacles.encoded`; shape (M, 16).
        link_radius: Radius of the capsules about the arm's polyline, m: one for all links, or one
            for each, shape (K,).
        d_safe: Clearance to keep, m.
        tolerance: Largest errors that count as on the path.
        shaped: The arm's own shapes, which replace those segments.

    Raises:
        WrongConfiguration: The start is outside the joint limits.
        InvalidOption: A length is negative, or samples, obstacles or links are too many.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {
        "link_radius": Bounds(0.0, 1e6),
        "d_safe": Bounds(0.0, 1e6),
    }

    arm: Arm
    start: FloatArray
    path: Path
    obstacles: FloatArray
    link_radius: float | FloatArray = 0.0
    d_safe: float = 0.0
    tolerance: PathTolerance = field(default_factory=PathTolerance)
    shaped: LinkGeometry | None = None

    def __post_init__(self) -> None:
        for name, bounds in self.BOUNDS.items():
            values = np.atleast_1d(getattr(self, name))
            if not ((values >= bounds.lower) & (values <= bounds.upper)).all():
                least = float(values.min())
                raise bounds.refusal(
                    say("{name} is {least:g}; give 0 to 1e6", name=name, least=least), least, name
                )
        if len(self.obstacles) > MAX_OBSTACLES:
            raise InvalidOption(
                say(
                    "there are {count} obstacles; give at most {max_obstacles}",
                    count=len(self.obstacles),
                    max_obstacles=MAX_OBSTACLES,
                ),
                argument="obstacles",
                value=len(self.obstacles),
                lower=0,
                upper=MAX_OBSTACLES,
            )
        pairs = self.path.samples * len(self.obstacles) * len(self.links)
        if pairs > MAX_PAIRS * 10:
            raise InvalidOption(
                say(
                    "{samples} samples, {count} obstacles and {count_2} links are too many"
                    " together; give fewer samples or obstacles",
                    samples=self.path.samples,
                    count=len(self.obstacles),
                    count_2=len(self.links),
                ),
                argument="samples",
                value=self.path.samples,
            )
        q, chain = self.arm.reduced(self.start), self.arm.chain
        outside = np.maximum(chain.lower - q, q - chain.upper)
        worst = int(np.argmax(outside))
        if outside[worst] > TOUCH:
            raise WrongConfiguration(
                say(
                    "q of joint {name} is {q:.6g}, outside its limits [{lower:.6g},"
                    " {upper:.6g}] {which}; start within them",
                    name=self.arm.names[worst],
                    q=q[worst],
                    lower=chain.lower[worst],
                    upper=chain.upper[worst],
                    which="rad" if chain.is_angle[worst] else "m",
                ),
                argument="q",
                index=(int(chain.columns[worst]),),
                joint=self.arm.names[worst],
                value=float(q[worst]),
                lower=float(chain.lower[worst]),
                upper=float(chain.upper[worst]),
            )

    @cached_property
    def links(self) -> Links:
        """Links that keep clear of the obstacles."""
        if self.shaped is not None:
            return self.shaped.links
        return skeleton(self.arm, self.link_radius)

    @cached_property
    def scene(self) -> Scene:
        """Links and obstacles, as compiled functions take them."""
        return Scene(self.obstacles, self.links.rows)

    @cached_property
    def first(self) -> FloatArray:
        """The chain's joint values at the start, within the limits; shape (K,), rad and m."""
        chain = self.arm.chain
        return np.clip(self.arm.reduced(self.start), chain.lower, chain.upper)

    @cached_property
    def scale(self) -> float:
        """Length of the arm, m: sum of the distances between successive joints."""
        lengths = np.linalg.norm(self.arm.chain.placements[1:, [3, 7, 11]], axis=1).sum()
        return float(lengths) or 1.0

    @cached_property
    def near_step(self) -> FloatArray:
        """Motion of each joint to the next sample that stays in the branch, (K,), rad or m."""
        return self._steps(NEAR_STEP)

    @cached_property
    def longest_step(self) -> FloatArray:
        """Largest motion of each joint to the next sample, shape (K,), rad or m.

        A larger one leads to another branch, or is the next equivalent angle.
        """
        return self._steps(LONGEST_STEP)

    def _steps(self, least: float) -> FloatArray:
        """Return a motion that leaves room for the path's own in one sample, shape (K,)."""
        turn = min(math.pi, max(least, GENEROUS * self.largest_increment / self.scale))
        return np.where(self.arm.chain.is_revolute, turn, turn * self.scale)

    @cached_property
    def largest_increment(self) -> float:
        """Largest motion of the target from a sample to the next, m; angles by the arm's length."""
        poses = self.path.targets.reshape(-1, 3, 4)
        moved = np.linalg.norm(np.diff(poses[:, :, 3], axis=0), axis=1)
        cosines = (np.einsum("kij,kij->k", poses[1:, :, :3], poses[:-1, :, :3]) - 1) / 2
        turned = np.arccos(np.clip(cosines, -1, 1))
        return float((moved + self.scale * turned).max(initial=0.0))

    @cached_property
    def most_per_step(self) -> FloatArray:
        """Largest motion of each joint between samples by its speed limit, rad or m; shape (K,)."""
        return np.asarray(self.arm.velocity * self.path.dt)


@dataclass(frozen=True)
class Gains:
    """Weights of the potentials that the null-space motion descends.

    The null-space motion over a whole path is about a gain times the gradient, independent of the
    number of samples. Lengths in m, angles in rad.

    Attributes:
        limits: Weight of Liégeois' potential, which centres joints between their limits.
        manipulability: Weight of the negative manipulability.
        obstacles: Weight of the repulsion by obstacles nearer than ``influence``.
        posture: Weight of the distance to ``posture_q``.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {
        "limits": Bounds(0, 1e6),
        "manipulability": Bounds(0, 1e6),
        "obstacles": Bounds(0, 1e6),
        "posture": Bounds(0, 1e6),
    }

    limits: float = 0.0
    manipulability: float = 0.0
    obstacles: float = 0.0
    posture: float = 0.0


@dataclass(frozen=True, eq=False)
class SecondaryTask:
    """A task of lower priority: a frame is moved to a pose as far as the tasks before allow.

    Attributes:
        arm: The chain to the frame, and the task space.
        target: Pose in base axes, upper three rows of a 4x4 matrix, shape (12,).
        gain: Part of the error that is corrected in a sample, 0 to 1.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {"gain": Bounds(0, 1)}

    arm: Arm
    target: FloatArray
    gain: float = 0.1


@dataclass(frozen=True, eq=False)
class PathOptions:
    """Options of the methods; each uses those that concern it.

    Attributes:
        closed_loop: Of ``pseudo_inverse``: correct the error to the path in every step.
        damping: λ of the damped methods, in the units of the Jacobian.
        iterations: Largest number of corrections in a sample.
        gains: Of ``null_space``; None: its default.
        posture_q: Wanted posture of the chain, shape (K,), rad and m; None: the start.
        influence: Clearance below which an obstacle repels, m; None: from the arm's size.
        obstacle_weight: Of ``sqp``: weight w of the repulsion in its objective.
        margin: Of ``sqp``, ``qp`` and ``whole_path``: clearance beyond d_safe, kept where the path
            leaves room for it, m.
        secondary: Tasks of ``task_priority``, the highest priority first.
        perturb: Joint displacement at the start, rad or m, out of a singular posture; 0: none.
        seconds: Time limit, s.
        processes: Of ``whole_path``: where its program is solved; None: in a process that is
            started for it.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {
        "damping": Bounds(1e-9, 1e3),
        "iterations": Bounds(1, 100),
        "influence": Bounds(1e-9, 1e6),
        "obstacle_weight": Bounds(0, 1e6),
        "margin": Bounds(0, 1e3),
        "perturb": Bounds(0, 1),
    }

    closed_loop: bool = True
    damping: float = 0.01
    iterations: int = 10
    gains: Gains | None = None
    posture_q: FloatArray | None = None
    influence: float | None = None
    obstacle_weight: float = 0.0
    margin: float = 1e-3
    secondary: tuple[SecondaryTask, ...] = ()
    perturb: float = 0.0
    seconds: float = math.inf
    processes: ProcessPool | None = None

    def __post_init__(self) -> None:
        for name, bounds in self.BOUNDS.items():
            _check(getattr(self, name), bounds, name)
        if self.gains is not None:
            for name, bounds in self.gains.BOUNDS.items():
                _check(getattr(self.gains, name), bounds, "gains", (name,))
        for k, task in enumerate(self.secondary):
            _check(task.gain, task.BOUNDS["gain"], "secondary", (k, "gain"))

    def reach_of_obstacles(self, problem: PathProblem) -> float:
        """Return the clearance below which an obstacle repels, m; above d_safe."""
        if self.influence is None:
            return problem.d_safe + 0.1 * problem.scale
        if self.influence <= problem.d_safe:
            raise InvalidOption(
                say(
                    "influence is {influence:g}; give more than d_safe, {d_safe:g}",
                    influence=self.influence,
                    d_safe=problem.d_safe,
                ),
                argument="influence",
                value=self.influence,
                lower=problem.d_safe,
            )
        return self.influence


def _check(value: float | None, bounds: Bounds, argument: str, index: Location = ()) -> None:
    if value is not None and value not in bounds:
        raise bounds.refusal(
            say(
                "{argument} is {value:g}; give {lower:g} to {upper:g}",
                argument=dotted(argument, index),
                value=value,
                lower=bounds.lower,
                upper=bounds.upper,
            ),
            value,
            argument,
            index,
        )


def departure(problem: PathProblem, options: PathOptions) -> FloatArray:
    """Return the first configuration of a method: the start, or one near it for ``perturb``.

    Joints are displaced to alternate sides by unequal parts of ``perturb``, so that a stretched
    arm is bent.
    """
    q = problem.first
    if options.perturb == 0.0:
        return q
    k = np.arange(len(q))
    bend = np.where(k % 2 == 0, 1.0, -1.0) * (0.5 + 0.5 * (k + 1) / len(q))
    chain = problem.arm.chain
    off = q + options.perturb * bend
    blocked = (off < chain.lower) | (off > chain.upper)
    off = np.where(blocked, q - options.perturb * bend, off)
    return np.clip(off, chain.lower, chain.upper)
