"""The constants of a solver: one array for the call from Python, named parts for compiled code.

An array is quicker to hand over than a named tuple of arrays (0.1 against 0.8 µs), which counts in
the outermost call alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner
from kinematics.inverse.damped_step import JointLimits
from kinematics.inverse.task_error import TaskChain
from kinematics.kernels import Array

NUMERIC = -1
"""Kind of a chain without closed form."""
_MASK, _ROWS = 3, 10
"""Places of the mask and of the first row of joint constants in the array."""


class Starts(NamedTuple):
    """Where starts are taken from; see :func:`kinematics.inverse.starts.starts`.

    Start s of a joint is ``low + frac(offset + s * ratio) * span``, rad or m; each of shape (K,).
    """

    offset: Array
    ratio: Array
    low: Array
    span: Array


class SolverConstants(NamedTuple):
    """What a solve knows of a chain and a task.

    Attributes:
        chain: The chain and the task.
        limits: Limits of its joints.
        starts: Where starts are taken from.
        reach: See :attr:`kinematics.chain.Chain.reach`; m.
        kind: Class of its closed form, or ``NUMERIC``.
        form: Constants of its closed form; empty without one.
    """

    chain: TaskChain
    limits: JointLimits
    starts: Starts
    reach: float
    kind: int
    form: Array


def packed(constants: SolverConstants) -> Array:
    """Return the constants in one array, as :func:`unpacked` takes them apart."""
    chain, K = constants.chain, len(constants.chain.is_revolute)
    rows = (*constants.limits[:2], *constants.starts, chain.is_revolute, constants.limits.wraps)
    head = [K, constants.reach, constants.kind], chain.mask
    return np.concatenate((*head, *rows, chain.C.reshape(-1), constants.form))


@inner
def unpacked(P: Array) -> SolverConstants:
    """Return the parts of what :func:`packed` made, as views."""
    K = int(P[0])
    rows = P[_ROWS : _ROWS + 8 * K].reshape((8, K))
    end = _ROWS + 20 * K + 12
    C = P[_ROWS + 8 * K : end].reshape((K + 1, 12))
    return SolverConstants(
        TaskChain(C, rows[6], P[_MASK:_ROWS]),
        JointLimits(rows[0], rows[1], rows[7]),
        Starts(rows[2], rows[3], rows[4], rows[5]),
        P[1],
        int(P[2]),
        P[end:],
    )
