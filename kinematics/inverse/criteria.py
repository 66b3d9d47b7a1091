"""Compiled: when a solve ends, and the numbers of its method."""

from __future__ import annotations

import math
from typing import NamedTuple

from kinematics.compiled import inner
from kinematics.inverse.solver_constants import NUMERIC, layout_of
from kinematics.kernels import Array
from kinematics.lanes.memory import Pointer

DAMPING = 0.03
FLOOR = 1e-10
STALL_RATIO = 0.9
STALLS = 3
SETTLED = 1.0 - 1e-9
MAX_DAMPING = 1e6

CONVERGED, GIVEN_UP, UNREACHABLE, OUT_OF_STEPS = 1, 0, 2, 3
UNREACHABLE_RESTARTS = 2

EXACT = 1e-9
"""What a closed form promises, m and rad; a finer tolerance is the numeric solver's."""
DOUBTS = 20
"""Starts of the numeric solver before a closed form without solution is taken at its word."""


class Criteria(NamedTuple):
    """When a solve ends.

    Attributes:
        position: Square of the largest position error that is accepted, m².
        rotation: Square of the largest rotation error that is accepted, rad².
        steps: Most steps of a start; 0 where there is no time.
        restarts: Most starts after the first.
    """

    position: float
    rotation: float
    steps: float
    restarts: int


@inner
def criteria_from(values: Array) -> Criteria:
    """Return the criteria of :attr:`kinematics.inverse.result.IKOptions.criteria`."""
    return Criteria(values[0], values[1], values[2], int(values[3]))


@inner
def reached(criteria: Criteria, position: float, rotation: float) -> bool:
    """Return whether squared errors, m² and rad², are accepted."""
    return position <= criteria.position and rotation <= criteria.rotation


@inner
def beyond(P: Array, criteria: Criteria, G: Pointer) -> bool:
    """Return whether a target is provably farther away than the arm is long.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        criteria: The tolerance.
        G: Target, 12 numbers or more.
    """
    at = layout_of(P)
    away = 0.0
    for i in range(3):
        away += P[at.mask + i] * (G[4 * i + 3] - P[at.placements + 4 * i + 3]) ** 2
    limit = P[1] * (1.0 + 1e-9) + math.sqrt(criteria.position)
    return bool(away > limit * limit)


@inner
def is_proof(P: Array, criteria: Criteria) -> bool:
    """Return whether a closed form that finds nothing means that there is nothing.

    So it does where the tolerance is that of the form.
    """
    exact = criteria.position >= EXACT * EXACT and criteria.rotation >= EXACT * EXACT
    return exact and int(P[2]) != NUMERIC and criteria.steps > 0.0


@inner
def last_start(P: Array, criteria: Criteria, G: Pointer) -> int:
    """Return the number of the last start that a target is worth; see :func:`beyond`."""
    last = criteria.restarts
    if is_proof(P, criteria):
        last = min(last, DOUBTS)
    if beyond(P, criteria, G):
        last = min(last, UNREACHABLE_RESTARTS)
    return last
