"""Compiled: the constants of a solver by their addresses, as lanes take them."""

from __future__ import annotations

from typing import NamedTuple

from kinematics.compiled import inner
from kinematics.inverse.solver_constants import layout_of
from kinematics.kernels import Array
from kinematics.lanes.memory import Pointer, past, start_of


class Problem(NamedTuple):
    """A chain of K joints, moved by n unknowns, and a task; see :class:`~.SolverConstants`.

    Attributes:
        n: Number of unknowns.
        K: Number of joints.
        is_coupled: Whether joints are anything but unknowns.
        mask: The task, 7 numbers.
        limits: 3 n numbers.
        starts: 4 n numbers.
        coupling: K n numbers where joints are coupled.
        offset: K numbers where joints are coupled.
        links: Constants of the chain, ``(K + 2) WIDTH`` numbers.
    """

    n: int
    K: int
    is_coupled: bool
    mask: Pointer
    limits: Pointer
    starts: Pointer
    coupling: Pointer
    offset: Pointer
    links: Pointer


@inner
def problem_of(P: Array) -> Problem:
    """Return the parts of packed constants; the array must be in use as long as they are."""
    layout, start = layout_of(P), start_of(P)
    return Problem(
        layout.n,
        layout.K,
        layout.is_coupled,
        past(start, layout.mask),
        past(start, layout.limits),
        past(start, layout.starts),
        past(start, layout.coupling),
        past(start, layout.offset),
        past(start, layout.links),
    )
