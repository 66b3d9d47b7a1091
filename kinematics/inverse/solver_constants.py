"""The constants of a solver: one array for the call from Python, named parts for compiled code.

An array is quicker to hand over than a named tuple of arrays (0.1 against 0.8 µs), which counts in
the outermost call alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner
from kinematics.inverse.task_error import TaskChain
from kinematics.kernels import Array
from kinematics.lanes.links import WIDTH

NUMERIC = -1
"""Kind of a chain without closed form."""
_MASK, _LIMITS = 4, 11
"""Places of the mask and of the limits in the array."""


class SolverConstants(NamedTuple):
    """What a solve knows of a chain and a task; K is the number of unknowns here.

    Attributes:
        chain: The chain and the task.
        limits: Limits of its joints, see :mod:`~.damped_step`; shape (3, K).
        starts: Where starts are taken from, see :func:`kinematics.inverse.starts.starts`;
            shape (4, K).
        reach: See :attr:`kinematics.chain.Chain.reach`; m.
        links: Constants of the chain for lanes, see :func:`kinematics.lanes.links.links_of`.
        kind: Class of its closed form, or ``NUMERIC``.
        form: Constants of its closed form; empty without one.
    """

    chain: TaskChain
    limits: Array
    starts: Array
    reach: float
    links: Array
    kind: int
    form: Array


def packed(constants: SolverConstants) -> Array:
    """Return the constants in one array, as :func:`unpacked` takes them apart."""
    chain = constants.chain
    head = [
        len(chain.is_revolute),
        constants.reach,
        constants.kind,
        chain.coupling.shape[1],
    ]
    arrays = (
        chain.mask,
        constants.limits,
        constants.starts,
        chain.is_revolute,
        chain.C,
        chain.coupling,
        chain.offset,
        constants.links,
        constants.form,
    )
    return np.concatenate((head, *(array.reshape(-1) for array in arrays)))


class Layout(NamedTuple):
    """Where the parts of packed constants begin, for n unknowns and K joints."""

    n: int
    K: int
    is_coupled: bool
    mask: int
    limits: int
    starts: int
    turns: int
    placements: int
    coupling: int
    offset: int
    links: int
    form: int


@inner
def layout_of(P: Array) -> Layout:
    """Return where the parts of what :func:`packed` made begin."""
    K, coupled = int(P[0]), int(P[3])
    n = coupled if coupled > 0 else K
    starts, turns = _LIMITS + 3 * n, _LIMITS + 7 * n
    placements, coupling = turns + K, turns + 13 * K + 12
    offset = coupling + K * coupled
    links = offset + (K if coupled > 0 else 0)
    form = links + (K + 2) * WIDTH
    return Layout(
        n,
        K,
        coupled > 0,
        _MASK,
        _LIMITS,
        starts,
        turns,
        placements,
        coupling,
        offset,
        links,
        form,
    )


@inner
def unpacked(P: Array) -> SolverConstants:
    """Return the parts of what :func:`packed` made, as views."""
    at = layout_of(P)
    n, K = at.n, at.K
    return SolverConstants(
        TaskChain(
            P[at.placements : at.coupling].reshape((K + 1, 12)),
            P[at.turns : at.placements],
            P[_MASK:_LIMITS],
            P[at.coupling : at.offset].reshape((K, n if at.is_coupled else 0)),
            P[at.offset : at.links],
        ),
        P[_LIMITS : at.starts].reshape((3, n)),
        P[at.starts : at.turns].reshape((4, n)),
        P[1],
        P[at.links : at.form].reshape((K + 2, WIDTH)),
        int(P[2]),
        P[at.form :],
    )
