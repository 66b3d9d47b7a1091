"""Compiled poses and Jacobians of one chain at many configurations, eight at once."""

from __future__ import annotations

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.kernels import Array
from kinematics.lanes.memory import (
    Pointer,
    gather,
    lane_memory,
    load,
    scatter,
    scatter_four,
    start_of,
    store,
)
from kinematics.lanes.vector import LANES, Vector, eight_lanes, splat
from kinematics.lanes.walk import Pose, columns, walk


@inner
def _filled_up(Q: Array) -> Array:
    """Return at least as many rows as there are lanes: the last one again and again."""
    if len(Q) >= LANES or len(Q) == 0:
        return Q
    filled = np.empty((LANES, Q.shape[1]))
    for i in range(LANES):
        filled[i] = Q[min(i, len(Q) - 1)]
    return filled


@inner
def _values(Q: Array, first: int, places: Array, q: Pointer, like: Vector) -> None:
    """Put the joint values of a chain from rows of Q into lane memory."""
    for k in range(len(places)):
        store(q, k, gather(Q, first, places[k], like))


@inner
def _put_poses(pose: Pose, first: int, out: Array, like: Vector) -> None:
    """Write poses as 4x4 matrices, a row of 16 numbers each."""
    scatter_four(out, first, 0, pose[0], pose[1], pose[2], pose[3])
    scatter_four(out, first, 4, pose[4], pose[5], pose[6], pose[7])
    scatter_four(out, first, 8, pose[8], pose[9], pose[10], pose[11])
    none = splat(0.0, like)
    scatter_four(out, first, 12, none, none, none, splat(1.0, like))


@jit
def forward_many(links: Array, places: Array, Q: Array, out: Array) -> None:
    """Compute the poses of a frame at many configurations.

    The pose of a row does not depend on the rows beside it.

    Args:
        links: Constants of the chain; see :func:`kinematics.lanes.links.links_of`.
        places: Entry of a configuration for each joint, shape (K,).
        Q: Configurations, shape (n, dof).
        out: Filled, shape (n, 16): 4x4 matrices.
    """
    like, n, K = eight_lanes(), len(Q), len(places)
    memory, rows, poses = lane_memory(K + 1, LANES), _filled_up(Q), _filled_up(out)
    q = start_of(memory)
    for i in range(0, len(rows) if n > 0 else 0, LANES):
        first = min(i, len(rows) - LANES)
        _values(rows, first, places, q, like)
        _put_poses(walk(start_of(links), K, q, None, None, like), first, poses, like)
    memory[0, 0] = 0.0  # the memory is in use until here
    if n < LANES:
        out[:] = poses[:n]


@inner
def _put_row(
    axes: Pointer, row: int, places: Array, first: int, start: int, out: Array, like: Vector
) -> None:
    """Write a row of Jacobians from column ``start`` on; four columns at once where they follow."""
    K = len(places)
    side_by_side = K >= 4
    for k in range(1, K):
        side_by_side = side_by_side and places[k] == places[k - 1] + 1
    if side_by_side:
        for k in range(0, K, 4):
            b = min(k, K - 4)
            scatter_four(
                out,
                first,
                start + places[b],
                load(axes, 6 * b + row, like),
                load(axes, 6 * b + 6 + row, like),
                load(axes, 6 * b + 12 + row, like),
                load(axes, 6 * b + 18 + row, like),
            )
        return
    for k in range(K):
        scatter(out, first, start + places[k], load(axes, 6 * k + row, like))


@jit
def jacobian_many(links: Array, places: Array, Q: Array, poses: Array, out: Array) -> None:
    """Compute geometric Jacobians at the frame's origin, in base axes, at many configurations.

    Args:
        links: Constants of the chain; see :func:`kinematics.lanes.links.links_of`.
        places: Entry of a configuration for each joint, shape (K,).
        Q: Configurations, shape (n, dof).
        poses: Filled, shape (n, 16).
        out: Zeros, filled, shape (n, 6 dof): rows of 6, columns in the order of a configuration.
    """
    like, n, K = eight_lanes(), len(Q), len(places)
    dof, rows = Q.shape[1], _filled_up(Q)
    memory = lane_memory(7 * K + 1, LANES)
    q, axes = start_of(memory), start_of(memory[K:])
    filled, J = _filled_up(poses), _filled_up(out)
    for i in range(0, len(rows) if n > 0 else 0, LANES):
        first = min(i, len(rows) - LANES)
        _values(rows, first, places, q, like)
        pose = walk(start_of(links), K, q, None, axes, like)
        columns(start_of(links), K, axes, pose, like)
        _put_poses(pose, first, filled, like)
        for row in range(6):
            _put_row(axes, row, places, first, row * dof, J, like)
    memory[0, 0] = 0.0  # the memory is in use until here
    if n < LANES:
        poses[:], out[:] = filled[:n], J[:n]
