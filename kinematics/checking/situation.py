"""The numbers that an answer follows from, and many variants of them computed at once.

A slip turns one situation into another; a stack of situations is computed in a few array
operations, so that thousands of explanations can be tried for one answer.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.couplings import joint_map, moving_joints
from dh_to_urdf.table import Convention, DHTable, JointType
from robots.robot import FloatArray, Robot

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Structure:
    """What no slip changes: the joints of a chain of n rows, and how q moves them.

    Attributes:
        rows: Names of the rows, from the base to the frame.
        numbers: Their numbers in the table, from 1.
        revolute: Which rows turn, shape (n,).
        prismatic: Which rows slide, shape (n,).
        matrix: Values of the rows per entry of q, shape (n, dof).
        constant: Values of the rows at q = 0, without their offsets, shape (n,).
        joints: Names of the entries of q.
        turning: Which entries of q are angles, shape (dof,).
        convention: Of the table.
    """

    rows: tuple[str, ...]
    numbers: tuple[int, ...]
    revolute: BoolArray
    prismatic: BoolArray
    matrix: FloatArray
    constant: FloatArray
    joints: tuple[str, ...]
    turning: BoolArray
    convention: Convention

    @property
    def count(self) -> int:
        """Return the number of rows."""
        return len(self.rows)


@dataclass(frozen=True, eq=False)
class Situation:
    """The numbers of a table and of q, at P points.

    Attributes:
        q: Joint values, shape (P, dof), rad and m.
        alpha: Twists, shape (n,), rad.
        a: Lengths along x, shape (P, n), m.
        d: Lengths along z, shape (P, n), m; 0 where q slides.
        theta: Angles about z of rows that do not turn, shape (n,), rad.
        offset: Shape (P, n), rad and m.
        sign: Shape (n,).
        gamma: Khalil's γ, shape (n,), rad.
        b: Khalil's b, shape (P, n), m.
        base: Shape (P, 4, 4).
        tool: Shape (P, 4, 4).
        standard: Whether rows are taken as in the standard convention.
        reversed_order: Whether the link matrices are multiplied from the tip to the base.
        missing: Rows that are left out, shape (n,).
    """

    q: FloatArray
    alpha: FloatArray
    a: FloatArray
    d: FloatArray
    theta: FloatArray
    offset: FloatArray
    sign: FloatArray
    gamma: FloatArray
    b: FloatArray
    base: FloatArray
    tool: FloatArray
    standard: bool
    reversed_order: bool
    missing: BoolArray


@dataclass(frozen=True, eq=False)
class Motion:
    """Frames of N situations at P points, in base axes.

    Attributes:
        structure: The chain.
        A: Link matrices, shape (N, P, n, 4, 4).
        before: The frame that each row starts from, shape (N, P, n, 4, 4).
        after: The frame of each row, shape (N, P, n, 4, 4).
        pose: Shape (N, P, 4, 4).
        base: Shape (N, P, 4, 4).
        sign: Shape (N, n).
        standard: Shape (N,).
    """

    structure: Structure
    A: FloatArray
    before: FloatArray
    after: FloatArray
    pose: FloatArray
    base: FloatArray
    sign: FloatArray
    standard: BoolArray

    def jacobian(self, point: FloatArray | None = None, *, neighbours: bool = False) -> FloatArray:
        """Return geometric Jacobians in base axes, shape (N, P, 6, dof), linear rows first.

        Args:
            point: The point whose velocity the linear rows are, shape (N, P, 3); default the
                origin of the frame.
            neighbours: Whether the axis of each joint is taken from the wrong one of the two
                frames beside it.
        """
        joints = self.structure
        starts = (self.standard ^ neighbours)[:, None, None, None, None]
        frames = np.where(starts, self.before, self.after)
        z, origin = frames[..., :3, 2], frames[..., :3, 3]
        if point is None:
            point = self.pose[..., :3, 3]
        turns = joints.revolute[:, None]
        linear = np.where(turns, np.cross(z, point[..., None, :] - origin), z)
        columns = np.concatenate((linear, np.where(turns, z, 0.0)), axis=-1)
        columns = columns * self.sign[:, None, :, None]
        return np.asarray(np.swapaxes(columns, -1, -2) @ joints.matrix)


def situation_of(
    robot: Robot,
    table: DHTable,
    q: FloatArray,
    frame: str | None = None,
    rows: Sequence[int] | None = None,
) -> tuple[Structure, Situation]:
    """Return structure and situation of a table's chain to a frame.

    Args:
        robot: The robot, for the order of q.
        table: Its table, or one that was worked out from its joint axes.
        q: Shape (P, dof), rad and m, in the order of ``robot.joints``.
        frame: ``tool`` or ``frame_k``; default the tool. ``base_link`` and ``frame_0`` have no
            rows.
        rows: Indices of the rows, where they are not those from the base to the frame.
    """
    matrix, constant = _values_of_rows(robot, table)
    tip = "tool" if frame is None else frame
    chosen = rows_to(table, tip) if rows is None else list(rows)
    chain = [table.rows[k] for k in chosen]
    tool = table.tool if tip == "tool" else np.eye(4)
    base = np.eye(4) if tip == "base_link" else table.base
    points, count = len(q), len(chain)
    types = [row.type for row in chain]

    def column(name: str) -> FloatArray:
        return np.array([float(getattr(row, name)) for row in chain])

    def at_points(values: FloatArray) -> FloatArray:
        return np.repeat(values[None], points, axis=0)

    structure = Structure(
        tuple(row.name for row in chain),
        tuple(k + 1 for k in chosen),
        np.array([kind.is_revolute for kind in types], dtype=bool),
        np.array([kind is JointType.PRISMATIC for kind in types], dtype=bool),
        matrix[chosen],
        constant[chosen],
        tuple(joint.name for joint in robot.joints),
        robot.is_revolute,
        table.convention,
    )
    situation = Situation(
        q=q,
        alpha=column("alpha"),
        a=at_points(column("a")),
        d=at_points(column("d")),
        theta=column("theta"),
        offset=at_points(column("offset")),
        sign=column("sign"),
        gamma=column("gamma"),
        b=at_points(column("b")),
        base=at_points(base),
        tool=at_points(tool),
        standard=table.convention is Convention.STANDARD,
        reversed_order=False,
        missing=np.zeros(count, dtype=bool),
    )
    return structure, situation


def with_columns(situation: Situation, columns: Mapping[str, Any]) -> Situation:
    """Return a situation with some of its fields changed, by name."""
    return replace(situation, **columns)


def at_first_points(situation: Situation, count: int) -> Situation:
    """Return a situation at fewer points."""
    names = ("q", "a", "d", "offset", "b", "base", "tool")
    return with_columns(situation, {name: getattr(situation, name)[:count] for name in names})


def rows_to(table: DHTable, frame: str) -> list[int]:
    """Return the indices of the rows from the base to a frame, none for a frame of the base."""
    if frame in ("base_link", "frame_0"):
        return []
    number = table.tip_row if frame == "tool" else int(frame.removeprefix("frame_"))
    found: list[int] = []
    while number > 0:
        found.append(number - 1)
        number = table.rows[number - 1].parent
    return found[::-1]


def _values_of_rows(robot: Robot, table: DHTable) -> tuple[FloatArray, FloatArray]:
    """Return C and c of ``C q + c``, the values of all rows, shapes (rows, dof) and (rows,)."""
    places = {joint.name: k for k, joint in enumerate(robot.joints)}
    moving, fixed = moving_joints(table)
    matrix, constant = np.zeros((len(table.rows), robot.dof)), np.zeros(len(table.rows))
    rows = list(table.moving_rows)
    if table.is_coupled:
        found = joint_map(moving, fixed)
        columns = [places[moving[k].name] for k in found.free]
        matrix[np.ix_(rows, columns)] = found.matrix
        constant[rows] = found.offset
    else:
        for k in rows:
            matrix[k, places[table.rows[k].name]] = 1.0
    return matrix, constant


def evaluate(structure: Structure, situations: Sequence[Situation]) -> Motion:
    """Return the frames of several situations of one structure, with as many points each."""

    def stacked(name: str) -> FloatArray:
        return np.stack([getattr(one, name) for one in situations])

    q, sign, offset = stacked("q"), stacked("sign"), stacked("offset")
    values = q @ structure.matrix.T + structure.constant
    v = sign[:, None, :] * values + offset
    theta = np.where(structure.revolute, v, stacked("theta")[:, None, :])
    d = np.where(structure.prismatic, v, stacked("d"))
    a, alpha = stacked("a"), np.broadcast_to(stacked("alpha")[:, None, :], v.shape)
    standard = np.array([one.standard for one in situations], dtype=bool)
    A = _link_matrices(theta, d, a, alpha, standard)
    gamma, b = stacked("gamma"), stacked("b")
    if gamma.any() or b.any():
        zero = np.zeros_like(v)
        turned = np.broadcast_to(gamma[:, None, :], v.shape)
        A = _link_matrices(turned, b, zero, zero, standard) @ A
    missing = np.stack([one.missing for one in situations])
    if missing.any():
        A = np.where(missing[:, None, :, None, None], np.eye(4), A)
    base, tool = stacked("base"), stacked("tool")
    before, after = np.empty_like(A), np.empty_like(A)
    current = base
    for k in range(structure.count):
        before[..., k, :, :] = current
        current = current @ A[..., k, :, :]
        after[..., k, :, :] = current
    pose = current @ tool
    backwards = np.array([one.reversed_order for one in situations], dtype=bool)
    if backwards.any():
        product = base[backwards]
        for k in reversed(range(structure.count)):
            product = product @ A[backwards, :, k]
        pose[backwards] = product @ tool[backwards]
    return Motion(structure, A, before, after, pose, base, sign, standard)


def _link_matrices(
    theta: FloatArray, d: FloatArray, a: FloatArray, alpha: FloatArray, standard: BoolArray
) -> FloatArray:
    """Return link matrices of rows, shape (N, P, n) + (4, 4), of either convention."""
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    A = np.zeros((*theta.shape, 4, 4))
    A[..., 3, 3] = 1.0
    A[..., 0, 0], A[..., 1, 1], A[..., 2, 2] = ct, ct * ca, ca
    first = standard[:, None, None]
    A[..., 0, 1] = np.where(first, -st * ca, -st)
    A[..., 0, 2] = np.where(first, st * sa, 0.0)
    A[..., 0, 3] = np.where(first, a * ct, a)
    A[..., 1, 0] = np.where(first, st, st * ca)
    A[..., 1, 2] = np.where(first, -ct * sa, -sa)
    A[..., 1, 3] = np.where(first, a * st, -d * sa)
    A[..., 2, 0] = np.where(first, 0.0, st * sa)
    A[..., 2, 1] = np.where(first, sa, ct * sa)
    A[..., 2, 3] = np.where(first, d, d * ca)
    return A
