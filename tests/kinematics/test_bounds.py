"""Bounds of options: stated once, and checked as they are stated."""

import math

import numpy as np
import pytest

from kinematics.bounds import Bounds
from kinematics.errors import InvalidOption
from kinematics.inverse import IKOptions, Tolerance
from kinematics.redundancy.path.geometry import Circle, Sampling
from kinematics.redundancy.problem import Gains, PathOptions, PathTolerance
from kinematics.redundancy.timing.toppra import RetimeOptions


def sampling(**options):
    return Sampling(**options)


def circle(turns):
    return Circle(np.zeros(3), np.array([0.0, 0.0, 1.0]), turns)


def tolerance(**options):
    return IKOptions(Tolerance(**options))


def gains(**options):
    return PathOptions(gains=Gains(**options))


def retiming(samples):
    return RetimeOptions(np.ones(2), samples=samples)


OPTIONS = [
    (make, name, bounds)
    for make, stated in (
        (IKOptions, IKOptions.BOUNDS),
        (tolerance, Tolerance.BOUNDS),
        (sampling, Sampling.BOUNDS),
        (circle, Circle.BOUNDS),
        (PathTolerance, PathTolerance.BOUNDS),
        (PathOptions, PathOptions.BOUNDS),
        (gains, Gains.BOUNDS),
        (retiming, {"samples": RetimeOptions.BOUNDS["samples"]}),
    )
    for name, bounds in stated.items()
]


def test_both_ends_are_included_unless_said_otherwise():
    both, below = Bounds(0.0, 1.0), Bounds(0.0, 1.0, upper_included=False)
    for value in (0.0, 0.5, math.nextafter(1.0, 0.0)):
        assert value in both
        assert value in below
    assert 1.0 in both
    assert 1.0 not in below
    for value in (-1e-300, 1.0 + 1e-15, math.nan, math.inf, -math.inf):
        assert value not in both
        assert value not in below


@pytest.mark.parametrize(("make", "name", "bounds"), OPTIONS)
def test_options_are_checked_against_the_bounds_that_are_stated(make, name, bounds):
    for value in (bounds.lower, bounds.upper):
        make(**{name: value})
    step = 1 if isinstance(bounds.lower, int) else 1e-9 * max(1.0, abs(bounds.upper))
    for value in (bounds.lower - step, bounds.upper + step):
        with pytest.raises(InvalidOption) as caught:
            make(**{name: value})
        error = caught.value
        assert error.location[-1] == name
        assert (error.value, error.lower, error.upper) == (value, bounds.lower, bounds.upper)
