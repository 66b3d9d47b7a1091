"""The polyline of an arm: from frame to frame as its D-H table goes, or from joint to joint.

An arm whose joints all turn goes straight from the origin of a joint to that of the next. One with
slides from a table goes as the table is read: from frame k-1 along z by d, then along x by a, to
frame k (standard); along x by a, then along z by d (modified); along z by b first (Khalil, where a
branch has it). One with slides from a URDF reaches a sliding joint at its origin for q = 0 and
leaves it at the slid one. So no corner is cut to where a joint has slid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dh_to_urdf import Convention, DHTable, JointType
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.skeleton import row_corners
from robots.robot import FloatArray

BASE = -1
"""Carrier of what no joint moves."""
POINT = 1e-12
"""Length of a piece that counts as none, m."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A straight piece of the polyline.

    Attributes:
        link: Index of the link that it belongs to, 0 to K - 1: of the joint where it begins.
        carriers: The joints of the chain that carry start and end; ``BASE`` for none.
        ends: Start and end at q = 0, base axes, m, shape (2, 3).
    """

    link: int
    carriers: tuple[int, int]
    ends: FloatArray

    @property
    def is_point(self) -> bool:
        """Return whether it has no length at any q."""
        rigid = self.carriers[0] == self.carriers[1]
        return rigid and float(np.linalg.norm(self.ends[1] - self.ends[0])) <= POINT


def polyline(arm: Arm) -> tuple[Piece, ...]:
    """Return the pieces of an arm that its joints carry, from the base on.

    Every link has one: a point where it has no length.
    """
    table = arm.robot.table
    rows = [] if table is None else _path(table, arm.frame)
    moving = sum(table.rows[k - 1].type is not JointType.FIXED for k in rows) if table else 0
    if table is None or moving != arm.chain.length or arm.chain.is_revolute.all():
        pieces = _of_joints(arm)
    else:
        pieces = _of_table(arm, table, rows)
    carried = [piece for piece in pieces if piece.carriers != (BASE, BASE)]
    long = {piece.link for piece in carried if not piece.is_point}
    kept: list[Piece] = []
    for piece in carried:
        if not piece.is_point:
            kept.append(piece)
        elif piece.link not in long:
            long.add(piece.link)
            kept.append(piece)
    return tuple(kept)


def home_values(arm: Arm) -> FloatArray:
    """Return the values of the joints of the chain at q = 0, rad and m."""
    return arm.chain.values(np.zeros(arm.K))


def carrier_poses(arm: Arm, values: FloatArray) -> list[FloatArray]:
    """Return the pose of each joint of the chain, and of the frame, in base axes, 4x4.

    Args:
        arm: The arm.
        values: Of the joints of the chain, rad and m.
    """
    chain, poses = arm.chain, []
    T = _square(chain.placements[0])
    for k in range(chain.length):
        M = np.eye(4)
        if chain.is_revolute[k]:
            c, s = math.cos(values[k]), math.sin(values[k])
            M[:2, :2] = [[c, -s], [s, c]]
        else:
            M[2, 3] = values[k]
        T = T @ M
        poses.append(T)
        T = T @ _square(chain.placements[k + 1])
    return [*poses, T]


def _square(rows: FloatArray) -> FloatArray:
    return np.vstack((rows.reshape(3, 4), [0.0, 0.0, 0.0, 1.0]))


def _path(table: DHTable, frame: str) -> list[int]:
    """Return the numbers of the rows between the base and a frame, from the base on."""
    k = int(frame.removeprefix("frame_")) if frame.startswith("frame_") else table.tip_row
    rows: list[int] = []
    while k > 0:
        rows.append(k)
        k = table.rows[k - 1].parent
    return rows[::-1]


def _of_table(arm: Arm, table: DHTable, rows: list[int]) -> list[Piece]:
    home, bare = np.zeros(arm.robot.dof), arm.robot.bare
    frames = fk(bare, home, arm.robot.frames)
    standard = table.convention is Convention.STANDARD
    pieces: list[Piece] = []
    before = BASE
    for k in rows:
        row = table.rows[k - 1]
        after = before if row.type is JointType.FIXED else before + 1
        parent, own = frames[f"frame_{row.parent}"], frames[f"frame_{k}"]
        points = row_corners(row, table.convention, parent, own)
        link = max(after if standard else before, 0)
        # The piece along z of the joint is its own: of a turning joint it is on the axis.
        along_z = (before if row.type is JointType.PRISMATIC else after, after)
        others = (after, after) if standard else (before, before)
        carriers = [along_z, others] if standard else [others] * (len(points) - 2) + [along_z]
        for pair, (a, b) in zip(carriers, pairwise(points), strict=True):
            pieces.append(Piece(link, pair, np.array([a, b])))
        before = after
    tip = f"frame_{rows[-1]}"
    if arm.frame != tip or bare is not arm.robot:
        end = fk(arm.robot, home, [arm.frame])[arm.frame]
        ends = np.array([frames[tip][:3, 3], end[:3, 3]])
        pieces.append(Piece(max(before, 0), (before, before), ends))
    return pieces


def _of_joints(arm: Arm) -> list[Piece]:
    K, values = arm.chain.length, home_values(arm)
    poses = carrier_poses(arm, values)
    origins = [T[:3, 3] for T in poses]
    pieces: list[Piece] = []
    for k in range(K + 1):
        link = max(k - 1, 0)
        slides = k < K and not arm.chain.is_revolute[k]
        # A sliding joint is reached where it is at 0, and left where it has slid.
        reached = origins[k] - values[k] * poses[k][:3, 2] if slides else origins[k]
        if k > 0:
            pieces.append(Piece(link, (k - 1, k - 1), np.array([origins[k - 1], reached])))
        if slides:
            pieces.append(Piece(link, (k - 1, k), np.array([reached, origins[k]])))
    return pieces
