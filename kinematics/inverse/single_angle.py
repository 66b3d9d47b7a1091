"""One angle about an axis that all joints turn about, written as a whole orientation."""

from __future__ import annotations

import numpy as np

from kinematics.chain import Chain
from kinematics.inverse.closed_form.geometry import axis_lines
from kinematics.task import Task, task_from
from robots.robot import FloatArray

PARALLEL = 1e-12
"""Part of a unit axis across another up to which they are parallel."""
HALF_TURN = 1e-9
"""Cosine of half a rotation, of its part about the axis, below which that part has no angle."""


def as_orientation(chain: Chain, task: Task, target: FloatArray) -> tuple[Task, FloatArray] | None:
    """Return a task of one angle, such as xy_phi, and its target with the whole orientation.

    Where the joints turn about one base axis alone, the frame has the angle exactly where it has
    the orientation that is the rest of the target's turn about that axis from q = 0: of the
    target's turn ``D = R_target R_0ᵀ``, a quaternion (w, x, y, z), that by ``2 atan2(z, w)`` about
    z. Then the rotation vector of the error has no part along the axis.

    Args:
        chain: Its joints must all be free.
        task: The task.
        target: Pose of the frame in base axes, 4x4.

    Returns:
        None where the task has not one row of rotation in base axes, the joints turn about other
        axes too, or the target is half a turn about another axis, which leaves the angle open.
    """
    if task.own_axes or len(task.rotations) != 1:
        return None
    (axis,) = task.rotations
    lines = axis_lines(chain)
    across = np.delete(lines.directions[lines.is_revolute], axis, axis=1)
    if np.abs(across).max(initial=0.0) > PARALLEL:
        return None
    R = lines.pose[:3, :3]
    D = target[:3, :3] @ R.T
    i, j = (axis + 1) % 3, (axis + 2) % 3
    sine, cosine = D[j, i] - D[i, j], D[i, i] + D[j, j]
    if np.hypot(sine, cosine) < 2.0 * HALF_TURN**2:
        return None
    size = np.hypot(sine, cosine)
    turn = np.eye(3)
    turn[i, i] = turn[j, j] = cosine / size
    turn[j, i], turn[i, j] = sine / size, -sine / size
    pose = target.copy()
    pose[:3, :3] = turn @ R
    return task_from([int(row in task.positions or row >= 3) for row in range(6)]), pose
