"""Options and results of inverse kinematics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.errors import dotted
from robots.robot import FloatArray


class IKStatus(StrEnum):
    """How a solve ended, by the measured task error and the limits alone.

    ``converged``: q reaches the target within the tolerance and the joint limits.
    ``unreachable``: proven: the target is farther away than the arm is long.
    ``timeout``: the time budget ended first.
    ``not_converged``: all starts were used.
    """

    CONVERGED = "converged"
    NOT_CONVERGED = "not_converged"
    TIMEOUT = "timeout"
    UNREACHABLE = "unreachable"


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Largest accepted task error.

    Attributes:
        position: Norm of the position error in the task's axes, m.
        orientation: Norm of the rotation error in the task's axes, rad.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {
        "position": Bounds(1e-12, 1e3),
        "orientation": Bounds(1e-12, 4.0),
    }

    position: float = 1e-6
    orientation: float = 1e-6


@dataclass(frozen=True)
class IKOptions:
    """What a caller may choose.

    Attributes:
        tolerance: Largest accepted task error.
        max_restarts: Random starts after the seed.
        max_iterations: Steps of one start.
        random_seed: Seed of the random starts; the same request gives the same answer.
        time_budget: Seconds for one target.

    Raises:
        InvalidOption: A value out of its range.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {
        "max_restarts": Bounds(0, 10_000),
        "max_iterations": Bounds(1, 10_000),
        "random_seed": Bounds(0, 2**53),
        "time_budget": Bounds(0, 60),
    }

    tolerance: Tolerance = field(default_factory=Tolerance)
    max_restarts: int = 200
    max_iterations: int = 100
    random_seed: int = 0
    time_budget: float = 1.0

    @cached_property
    def criteria(self) -> FloatArray:
        """Squared tolerances, most steps of a start, most restarts, as the kernel takes them."""
        steps = self.max_iterations if self.time_budget > 0 else 0
        restarts = self.max_restarts if self.time_budget > 0 else 0
        tolerance = self.tolerance
        return np.array([tolerance.position**2, tolerance.orientation**2, steps, restarts])

    def within(self, seconds: float) -> IKOptions:
        """Return the same with a time budget of at most ``seconds``."""
        return self if seconds >= self.time_budget else replace(self, time_budget=seconds)

    def __post_init__(self) -> None:
        for name, bounds in self.tolerance.BOUNDS.items():
            _check(getattr(self.tolerance, name), bounds, "tolerance", (name,))
        for name, bounds in self.BOUNDS.items():
            _check(getattr(self, name), bounds, name)


def _check(value: float, bounds: Bounds, argument: str, index: Location = ()) -> None:
    if value not in bounds:
        raise bounds.refusal(
            say(
                "{argument} is {value}; give {lower} to {upper}",
                argument=dotted(argument, index),
                value=quoted(value),
                lower=bounds.lower,
                upper=bounds.upper,
            ),
            value,
            argument,
            index,
        )


@dataclass(frozen=True)
class IKBatch:
    """Many answers; see :class:`IKResult` for each.

    Attributes:
        codes: Location into ``tuple(IKStatus)`` of each status; shape (n,).
        q: Shape (n, dof).
        seed: The start of all; shape (dof,).
        position_error: Shape (n,).
        orientation_error: Shape (n,).
        iterations: Shape (n,).
        restarts: Shape (n,).
        elapsed: Seconds, the mean of those that were solved together; shape (n,).
    """

    codes: NDArray[np.int64]
    q: FloatArray
    seed: FloatArray
    position_error: FloatArray
    orientation_error: FloatArray
    iterations: NDArray[np.int64]
    restarts: NDArray[np.int64]
    elapsed: FloatArray

    @property
    def statuses(self) -> list[IKStatus]:
        """Status of each."""
        names = tuple(IKStatus)
        return [names[code] for code in self.codes]


class IKResult(NamedTuple):
    """One answer, checked by forward kinematics on the model.

    A named tuple: a frozen dataclass takes a microsecond longer to make.

    Attributes:
        status: How the solve ended.
        q: The solution, or the best q within the limits that was found; shape (dof,).
        seed: The start that was used, brought within the limits; shape (dof,).
        position_error: Measured norm of the position error in the task's axes, m.
        orientation_error: Measured norm of the rotation error in the task's axes, rad.
        iterations: Steps of all starts.
        restarts: Random starts used.
        elapsed: Seconds.
    """

    status: IKStatus
    q: FloatArray
    seed: FloatArray
    position_error: float
    orientation_error: float
    iterations: int
    restarts: int
    elapsed: float
