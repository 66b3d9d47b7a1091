"""What is to be followed, and how: the same for every method."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from kinematics.bounds import Bounds
from kinematics.errors import InvalidOption, Location, WrongConfiguration, dotted
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.link_geometry import LinkGeometry
from kinematics.redundancy.clearance.links import Links, skeleton
from kinematics.redundancy.path.geometry import Path
from robots.robot import FloatArray

TOUCH = 1e-9
"""A limit exceeded by no more than this is rounding, rad or m."""
MAX_OBSTACLES = 100
MAX_PAIRS = 200_000
"""Most samples times obstacles times links of a path."""


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
                    f"tolerance.{name} is {value:g}; give 1e-9 to 1e3", value, "tolerance", (name,)
                )


@dataclass(frozen=True, eq=False)
class PathProblem:
    """A path for an arm among obstacles.

    Attributes:
        arm: The arm and its task space.
        start: Whole configuration of sample 0, shape (dof,).
        path: The path; its first target is the arm's pose at the start.
        obstacles: See :func:`kinematics.redundancy.clearance.obstacles.encoded`; shape (M, 16).
        link_radius: Radius of the capsules about the segments between joint origins, m: one for
            all, or of each, shape (K,).
        d_safe: Clearance that is to be kept, m.
        tolerance: What counts as on the path.
        shaped: The arm's own shapes, which then keep clear instead of those segments.

    Raises:
        WrongConfiguration: The start is outside the joint limits.
        InvalidOption: A length is negative, or there is too much of something.
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
                raise bounds.refusal(f"{name} is {least:g}; give 0 to 1e6", least, name)
        if len(self.obstacles) > MAX_OBSTACLES:
            raise InvalidOption(
                f"there are {len(self.obstacles)} obstacles; give at most {MAX_OBSTACLES}",
                argument="obstacles",
                value=len(self.obstacles),
                lower=0,
                upper=MAX_OBSTACLES,
            )
        pairs = self.path.samples * len(self.obstacles) * len(self.links)
        if pairs > MAX_PAIRS * 10:
            raise InvalidOption(
                f"{self.path.samples} samples, {len(self.obstacles)} obstacles and"
                f" {len(self.links)} links are too many together; give fewer samples or obstacles",
                argument="samples",
                value=self.path.samples,
            )
        q, chain = self.arm.reduced(self.start), self.arm.chain
        outside = np.maximum(chain.lower - q, q - chain.upper)
        worst = int(np.argmax(outside))
        if outside[worst] > TOUCH:
            raise WrongConfiguration(
                f"q of joint {self.arm.names[worst]} is {q[worst]:.6g}, outside its limits"
                f" [{chain.lower[worst]:.6g}, {chain.upper[worst]:.6g}]"
                f" {'rad' if chain.is_revolute[worst] else 'm'}; start within them",
                argument="q",
                index=(int(chain.columns[worst]),),
                joint=self.arm.names[worst],
                value=float(q[worst]),
                lower=float(chain.lower[worst]),
                upper=float(chain.upper[worst]),
            )

    @cached_property
    def links(self) -> Links:
        """What is to keep clear of the obstacles."""
        if self.shaped is not None:
            return self.shaped.links
        return skeleton(self.arm, self.link_radius)

    @cached_property
    def first(self) -> FloatArray:
        """The chain's joints at the start, within the limits; shape (K,)."""
        chain = self.arm.chain
        return np.clip(self.arm.reduced(self.start), chain.lower, chain.upper)

    @cached_property
    def scale(self) -> float:
        """Length of the arm, m: the distances between successive joints added up."""
        lengths = np.linalg.norm(self.arm.chain.placements[1:, [3, 7, 11]], axis=1).sum()
        return float(lengths) or 1.0

    @cached_property
    def most_per_step(self) -> FloatArray:
        """Largest motion of each joint between samples, by its speed; shape (K,)."""
        return np.asarray(self.arm.velocity * self.path.dt)


@dataclass(frozen=True)
class Gains:
    """Weights of the potentials that the null-space motion goes down.

    The null-space motion of a whole path is about a gain times the gradient, whatever its number
    of samples. Lengths in m, angles in rad.

    Attributes:
        limits: Of Liégeois' centring between the limits.
        manipulability: Of the manipulability, which grows.
        obstacles: Of the repulsion by obstacles nearer than ``influence``.
        posture: Of the distance to ``posture_q``.
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
    """A task of lower priority: a frame is drawn to a pose, as far as the tasks before allow.

    Attributes:
        arm: The chain to the frame, and the task space.
        target: Pose, 12 numbers.
        gain: Part of the error that is taken away in a sample, 0 to 1.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {"gain": Bounds(0, 1)}

    arm: Arm
    target: FloatArray
    gain: float = 0.1


@dataclass(frozen=True, eq=False)
class PathOptions:
    """What methods may be told; each takes what concerns it.

    Attributes:
        closed_loop: Of ``pseudo_inverse``: steps towards the path, not along it.
        damping: λ of the damped methods, in the units of the Jacobian.
        iterations: Most corrections in a sample.
        gains: Of ``null_space``; None: its own.
        posture_q: Wanted posture of the chain, shape (K,); None: the start.
        influence: Clearance from which on an obstacle repels, m; None: from the arm's size.
        obstacle_weight: w of ``sqp``: weight of the repulsion in its objective.
        margin: Of ``sqp``, ``qp`` and ``whole_path``: kept on top of d_safe where the path leaves
            room for it, m.
        secondary: Of ``task_priority``, the highest priority first.
        perturb: Joint values by which the arm leaves the start, rad or m; 0: not.
        seconds: Longest computation.
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

    def __post_init__(self) -> None:
        for name, bounds in self.BOUNDS.items():
            _check(getattr(self, name), bounds, name)
        if self.gains is not None:
            for name, bounds in self.gains.BOUNDS.items():
                _check(getattr(self.gains, name), bounds, "gains", (name,))
        for k, task in enumerate(self.secondary):
            _check(task.gain, task.BOUNDS["gain"], "secondary", (k, "gain"))

    def reach_of_obstacles(self, problem: PathProblem) -> float:
        """The clearance from which on an obstacle repels, m; above d_safe."""
        if self.influence is None:
            return problem.d_safe + 0.1 * problem.scale
        if self.influence <= problem.d_safe:
            raise InvalidOption(
                f"influence is {self.influence:g}; give more than d_safe, {problem.d_safe:g}",
                argument="influence",
                value=self.influence,
                lower=problem.d_safe,
            )
        return self.influence


def _check(value: float | None, bounds: Bounds, argument: str, index: Location = ()) -> None:
    if value is not None and value not in bounds:
        raise bounds.refusal(
            f"{dotted(argument, index)} is {value:g}; give {bounds.lower:g} to {bounds.upper:g}",
            value,
            argument,
            index,
        )


def departure(problem: PathProblem, options: PathOptions) -> FloatArray:
    """Where the arm sets out from: the start, or a little off it where that is asked for.

    Joints are bent to alternate sides, by unequal parts of ``perturb``, so that a stretched arm
    is no more so.
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
