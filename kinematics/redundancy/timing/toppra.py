"""Time-optimal timing of a followed path within speed and acceleration limits of the joints.

The joint path is the cubic spline through the samples, parametrised by length in joint space; its
timing is computed by TOPP-RA (Pham and Pham, IEEE T-RO 34(3), 2018) of the package toppra, an
optional extra. The result is measured in :mod:`~.timing.result`, and slowed down as a whole where
it would exceed a limit between the grid points of toppra.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.errors import InvalidOption, MethodUnavailable
from kinematics.redundancy.path.geometry import Sampling
from robots.robot import FloatArray

GRID, MOST_GRID = 1000, 20_000
"""Smallest and largest number of grid points of toppra; see :func:`fastest`."""
NEAREST = 1e-5
"""Part of the whole length below which neighbouring samples count as one."""
SCATTER = 2e-8
"""Length, rad and m, within which samples scatter about the path: as near as they are solved."""
STILL = 1e-7
"""Motion, rad or m, below which there is nothing to time."""


UNTIMED = say(
    "no timing from rest to rest was found within these limits: the path"
    " turns back or bends sharply between samples; ask for more samples, or"
    " another method"
)


@dataclass(frozen=True, eq=False)
class RetimeOptions:
    """Limits that the timing keeps, and samples of the result.

    Attributes:
        acceleration: Largest accelerations of the arm's joints, rad/s² or m/s², shape (K,).
        velocity: Largest speeds, rad/s or m/s, lower than the robot's, shape (K,); None: those.
        samples: Samples of the result, equally spaced in time.
    """

    BOUNDS: ClassVar[Mapping[str, Bounds]] = {
        "acceleration": Bounds(1e-9, 1e12),
        "velocity": Bounds(1e-9, 1e12),
        "samples": Sampling.BOUNDS["samples"],
    }

    acceleration: FloatArray
    velocity: FloatArray | None = None
    samples: int = 101

    def __post_init__(self) -> None:
        for name, values in (("acceleration", self.acceleration), ("velocity", self.velocity)):
            low, high = self.BOUNDS[name].lower, self.BOUNDS[name].upper
            if values is not None and not ((values >= low) & (values <= high)).all():
                raise InvalidOption(
                    say(
                        "retime.{name} is not within {low:g} to {high:g} for every joint",
                        name=name,
                        low=low,
                        high=high,
                    ),
                    argument="retime",
                    index=(name,),
                    lower=low,
                    upper=high,
                )
        count = self.BOUNDS["samples"]
        if self.samples not in count:
            raise count.refusal(
                say(
                    "retime.samples is {samples}; give {lower} to {upper}",
                    samples=self.samples,
                    lower=count.lower,
                    upper=count.upper,
                ),
                self.samples,
                "retime",
                ("samples",),
            )


@dataclass(frozen=True, eq=False)
class Spline:
    """A joint path.

    The interpolated motion is that from the first sample, whose largest is made 1.

    Attributes:
        unit: toppra's interpolator of the motion.
        start: The first sample, rad and m, shape (K,).
        size: Largest motion of a joint, rad or m.
        grid: Lengths, those of the samples included, shape (g,), from 0 to 1.
        index: Their position between the samples, shape (g,), 0 to n - 1.
    """

    unit: Any
    start: FloatArray
    size: float
    grid: FloatArray
    index: FloatArray

    def at(self, s: FloatArray, order: int) -> FloatArray:
        """Return values (order 0) or derivatives (1, 2) at lengths s, (n,) -> (n, K)."""
        found = np.asarray(self.unit(s, order)) * self.size
        return found + self.start if order == 0 else found

    def finer(self, times: int) -> Spline:
        """Return the spline with a grid refined by a factor."""
        places = np.arange(len(self.grid), dtype=np.float64)
        parts = np.arange((len(places) - 1) * times + 1) / times
        return replace(
            self,
            grid=np.interp(parts, places, self.grid),
            index=np.interp(parts, places, self.index),
        )


@dataclass(frozen=True, eq=False)
class Timing:
    """Timing of a spline.

    Attributes:
        spline: The spline.
        rate: ds/dt at the points of its grid, 1/s, shape (g,); d²s/dt² is constant between them.
    """

    spline: Spline
    rate: FloatArray

    @property
    def times(self) -> FloatArray:
        """Times at the points of the grid, s, shape (g,)."""
        steps = 2 * np.diff(self.spline.grid) / (self.rate[1:] + self.rate[:-1])
        return np.concatenate(([0.0], np.cumsum(steps)))

    @property
    def accelerations(self) -> FloatArray:
        """d²s/dt² between the points of the grid, shape (g - 1,)."""
        return np.asarray(np.diff(self.rate**2) / (2 * np.diff(self.spline.grid)))

    def slowed(self, factor: float) -> Timing:
        """Return the timing slowed down by a factor."""
        return Timing(self.spline, self.rate / factor)

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return joint values, velocities and accelerations at times, shape (n, K) each."""
        times, u = self.times, self.accelerations
        k = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(u) - 1)
        return self.within(k, t - times[k])

    def within(
        self, k: NDArray[np.intp], since: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return values, velocities and accelerations some time after points k of the grid."""
        u, v = self.accelerations[k], self.rate[k]
        s = np.minimum(self.spline.grid[k] + v * since + u * since**2 / 2, self.spline.grid[k + 1])
        rate, u = (v + u * since)[:, None], u[:, None]
        slope = self.spline.at(s, 1)
        return self.spline.at(s, 0), slope * rate, self.spline.at(s, 2) * rate**2 + slope * u


def spline_through(Q: FloatArray) -> Spline | None:
    """Return the spline through samples of shape (n, K); None for an arm that does not move.

    Raises:
        MethodUnavailable: toppra is not installed.
    """
    toppra = _toppra()
    if not np.isfinite(Q).all() or np.abs(Q - Q[0]).max() < STILL:
        return None
    steps = np.linalg.norm(np.diff(Q, axis=0), axis=1)
    s = np.concatenate(([0.0], np.cumsum(steps)))
    apart = max(NEAREST, SCATTER / s[-1])
    s /= s[-1]
    kept = [0]
    for k in range(1, len(s) - 1):
        if s[k] - s[kept[-1]] >= apart and s[-1] - s[k] >= apart:
            kept.append(k)
    kept.append(len(s) - 1)
    knots = s[kept]
    knots[-1] = 1.0
    size = float(np.abs(Q - Q[0]).max())
    made = toppra.SplineInterpolator(knots, (Q[kept] - Q[0]) / size)
    spline = Spline(made, Q[0].copy(), size, knots, np.array(kept, dtype=np.float64))
    return spline.finer(max(2, -(-GRID // (len(kept) - 1))))


def fastest(spline: Spline, velocity: FloatArray, acceleration: FloatArray) -> Timing | str:
    """Return the fastest timing of a spline from rest to rest, or in words why there is none.

    Args:
        spline: The spline.
        velocity: Largest speeds of its joints, rad/s or m/s, inf where unknown, shape (K,).
        acceleration: Largest accelerations, rad/s² or m/s², shape (K,).
    """
    toppra = _toppra()
    Q = spline.at(spline.grid, 0)
    way = np.abs(np.diff(Q, axis=0)).sum(axis=0)
    # toppra's tolerances are absolute: motion and time are scaled to about 1.
    Q, velocity, acceleration = Q / spline.size, velocity / spline.size, acceleration / spline.size
    unit = float(np.max(np.maximum(way / velocity, np.sqrt(way / acceleration))))
    most = acceleration * unit**2
    # Under the acceleration limits a speed beyond this is never reached: no limit.
    speeds = np.minimum(velocity * unit, 4 * np.sqrt(most * way) + 1.0)
    box = toppra.constraint
    with np.errstate(all="ignore"):
        try:
            limits = [
                box.JointVelocityConstraint(np.column_stack((-speeds, speeds))),
                box.JointAccelerationConstraint(
                    np.column_stack((-most, most)),
                    discretization_scheme=box.DiscretizationType.Interpolation,
                ),
            ]
            work = toppra.algorithm.TOPPRA(limits, spline.unit, gridpoints=spline.grid)
            work.compute_parameterization(0, 0)
        except Exception:  # without a timing the path stays valid
            return UNTIMED
    found, code = work.problem_data.sd_vec, work.problem_data.return_code
    if code is not toppra.algorithm.ParameterizationReturnCode.Ok or found is None:
        return UNTIMED
    rate = np.asarray(found, dtype=np.float64) / unit
    if not np.isfinite(rate).all() or not (rate[1:] + rate[:-1] > 0).all() or (rate < 0).any():
        return say("no timing was found: the motion would come to a stop on its way")
    return Timing(spline, rate)


def require_toppra() -> None:
    """Check that toppra is installed.

    Raises:
        MethodUnavailable: It is not.
    """
    _toppra()


@cache
def _toppra() -> Any:
    """Return the package, imported when first needed: it imports a plotting library.

    Raises:
        MethodUnavailable: It is not installed.
    """
    # The plotting library, which is not used, warns where it cannot write its cache.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    # It logs while it is imported; later its outcome is read from the return code.
    logging.getLogger("toppra").setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import toppra
            import toppra.algorithm
            import toppra.constraint
    except ImportError:
        raise MethodUnavailable(
            say(
                "retime needs toppra, which is not installed; pip install"
                " 'denavit[retiming]', or leave retime out"
            ),
            package="toppra",
            extra="retiming",
            argument="retime",
        ) from None
    return toppra
