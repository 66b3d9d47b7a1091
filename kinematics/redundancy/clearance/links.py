"""Parts of an arm that keep clear of obstacles: capsules fixed to its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dh_to_urdf.messages import say
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.link_points import OFFSET, RADIUS, TURNED, WHOLE
from kinematics.redundancy.clearance.polyline import (
    BASE,
    POINT,
    Piece,
    carrier_poses,
    home_values,
    polyline,
)
from robots.robot import FloatArray

COLUMNS = 11


@dataclass(frozen=True, eq=False)
class Links:
    """L capsules.

    Attributes:
        rows: Shape (L, 11), for the compiled distances: the carriers of start and end (a joint of
            the chain counted from 0, K for the frame, -1 for the base), the radius, start and end
            in the carriers' axes from their origins, whether the start counts for a half-space as
            well, and whether start and end lie off the carriers' origins. Lengths in m.
        names: Name of each in messages.
        segments: Index of the link of the skeleton that each belongs to; -1 for a shape.
    """

    rows: FloatArray
    names: tuple[str, ...]
    segments: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.rows)


def skeleton(arm: Arm, radii: FloatArray | float) -> Links:
    """Return capsules about the pieces of the arm's :func:`~.polyline.polyline`.

    For a half-space, the start of a piece counts only where the piece before is thinner, so that no
    point counts twice. The start of the first piece, which nothing moves, never counts: an arm may
    stand on a floor.

    Args:
        arm: The arm.
        radii: Of each entry of q, m; shape (K,), or one for all. A piece after a follower has that
            of the joint that it follows.
    """
    pieces = polyline(arm)
    poses = carrier_poses(arm, home_values(arm))
    radii = np.broadcast_to(np.asarray(radii, dtype=np.float64), (arm.K,))[arm.chain.leaders]
    rows = np.array([_row(arm, poses, piece, float(radii[piece.link])) for piece in pieces])
    rows[1:, WHOLE] = rows[1:, RADIUS] > rows[:-1, RADIUS]
    links = tuple(piece.link for piece in pieces)
    return Links(rows, tuple(say("link {k}", k=k + 1) for k in links), links)


def _row(arm: Arm, poses: list[FloatArray], piece: Piece, radius: float) -> FloatArray:
    row = np.zeros(COLUMNS)
    row[RADIUS] = radius
    for end in range(2):
        carrier, point = piece.carriers[end], piece.ends[end]
        row[end], at = carrier, slice(OFFSET + 3 * end, OFFSET + 3 * end + 3)
        # A joint's origin needs no offset; that of the next turning joint is on this link too.
        near = [carrier] if carrier >= 0 else []
        if carrier + 1 == arm.chain.length or arm.chain.is_revolute[carrier + 1]:
            near.append(carrier + 1)
        found = [k for k in near if np.linalg.norm(point - poses[k][:3, 3]) <= POINT]
        if found:
            row[end] = found[0]
        elif carrier == BASE:
            row[at] = point
        else:
            row[at] = poses[carrier][:3, :3].T @ (point - poses[carrier][:3, 3])
            row[TURNED] = 1.0
    return row


def carried(carrier: int, start: FloatArray, end: FloatArray, radius: float) -> FloatArray:
    """Return the row of a capsule in the axes of one joint, shape (11,)."""
    row = np.zeros(COLUMNS)
    row[:2] = carrier
    row[RADIUS] = radius
    row[OFFSET : OFFSET + 3], row[OFFSET + 3 : OFFSET + 6] = start, end
    row[WHOLE] = row[TURNED] = 1.0
    return row
