"""Parts of an arm that keep clear of obstacles: capsules fixed to its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.link_points import OFFSET, RADIUS, TURNED, WHOLE
from robots.robot import FloatArray

COLUMNS = 11


@dataclass(frozen=True, eq=False)
class Links:
    """L capsules.

    Attributes:
        rows: Shape (L, 11), for the compiled distances: the carriers of start and end (a joint of
            the chain counted from 0, or K for the frame), the radius, start and end in the
            carriers' axes from their origins, whether the start counts for a half-space as well,
            and whether start and end lie off the carriers' origins. Lengths in m.
        names: Name of each in messages.
    """

    rows: FloatArray
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.rows)


def skeleton(arm: Arm, radii: FloatArray | float) -> Links:
    """Return capsules about the segments between successive joint origins, the last to the frame.

    For a half-space, the start of a segment counts only where the segment before is thinner, so
    that no point counts twice. The origin of a revolute first joint, which nothing moves, never
    counts: an arm may stand on a floor.

    Args:
        arm: The arm.
        radii: Of each entry of q, m; shape (K,), or one for all. A segment after a follower has
            that of the joint that it follows.
    """
    K = arm.chain.length
    if np.ndim(radii):
        radii = np.asarray(radii)[arm.chain.leaders]
    rows = np.zeros((K, COLUMNS))
    rows[:, 0], rows[:, 1] = np.arange(K), np.arange(1, K + 1)
    rows[:, RADIUS] = radii
    rows[1:, WHOLE] = rows[1:, RADIUS] > rows[:-1, RADIUS]
    rows[0, WHOLE] = not arm.chain.is_revolute[0]
    return Links(rows, tuple(f"link {k + 1}" for k in range(K)))


def carried(carrier: int, start: FloatArray, end: FloatArray, radius: float) -> FloatArray:
    """Return the row of a capsule in the axes of one joint, shape (11,)."""
    row = np.zeros(COLUMNS)
    row[:2] = carrier
    row[RADIUS] = radius
    row[OFFSET : OFFSET + 3], row[OFFSET + 3 : OFFSET + 6] = start, end
    row[WHOLE] = row[TURNED] = 1.0
    return row
