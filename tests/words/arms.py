"""Random arms from tables, and their axes and Jacobians by matrix products alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dh_to_urdf import Convention, read_mapping
from dh_to_urdf.matrices import dh_matrices
from robots.robot import Robot, robot_from_table

QUARTER = math.pi / 2
CONVENTIONS = ("standard", "modified", "khalil")


def arm_from(rows, convention="standard", tool=None, base=None) -> Robot:
    """The robot of rows ``(type, alpha, a, d or theta, offset, sign)``."""
    joints = []
    for kind, alpha, a, other, offset, sign in rows:
        names = ("d", "r") if convention == "khalil" else ("a", "d")
        row = {"type": kind, "alpha": alpha, names[0]: a, "offset": offset, "sign": sign}
        row |= {"theta": other} if kind == "P" else {names[1]: other}
        joints.append(row)
    document = {"name": "arm", "convention": convention, "joints": joints}
    document |= {"tool": tool} if tool else {}
    document |= {"base": base} if base else {}
    return robot_from_table(read_mapping(document))


def placement(generator, turned=True):
    """A tool or base, anywhere."""
    rpy = generator.uniform(-3, 3, 3) if turned else np.zeros(3)
    return {"xyz": generator.uniform(-0.3, 0.3, 3).tolist(), "rpy": rpy.tolist()}


def _length(generator):
    return float(generator.choice([0.0, 0.0, 0.3, -0.45, generator.uniform(-0.6, 0.6)]))


def _angle(generator):
    choices = [0.0, QUARTER, -QUARTER, math.pi, generator.uniform(-3, 3)]
    return float(generator.choice(choices, p=[0.3, 0.25, 0.25, 0.05, 0.15]))


def random_row(generator, kinds, alpha=None, a=None, other=None):
    kind = str(generator.choice(list(kinds)))
    return (
        kind,
        _angle(generator) if alpha is None else alpha,
        _length(generator) if a is None else a,
        (_angle(generator) if kind == "P" else _length(generator)) if other is None else other,
        _length(generator) if kind == "P" else _angle(generator),
        int(generator.choice([1, -1])),
    )


def wrist_arm(generator, convention):
    """Three joints of any kind, then three axes through one point."""
    first = [random_row(generator, "RRRP") for _ in range(3)]
    twist = [float(generator.choice([QUARTER, -QUARTER, 0.7])) for _ in range(2)]
    if convention == "standard":
        last = [
            random_row(generator, "R", alpha=twist[0], a=0.0),
            random_row(generator, "R", alpha=twist[1], a=0.0, other=0.0),
            random_row(generator, "R", a=_length(generator)),
        ]
    else:
        last = [
            random_row(generator, "R"),
            random_row(generator, "R", alpha=twist[0], a=0.0, other=0.0),
            random_row(generator, "R", alpha=twist[1], a=0.0),
        ]
    return first + last


def parallel_arm(generator, convention):
    """Six turns, axes 2, 3 and 4 parallel."""
    apart = float(generator.choice([0.0, 0.11]))
    alpha = [QUARTER, 0.0, 0.0, QUARTER, -QUARTER, 0.0]
    a = [0.05, -0.425, 0.39, 0.0, apart, 0.0]
    if convention != "standard":
        alpha, a = [0.0, *alpha[:5]], [0.0, *a[:5]]
    return [random_row(generator, "R", alpha=x, a=y) for x, y in zip(alpha, a, strict=True)]


def srs_arm(generator, convention):
    """Seven turns: shoulder, elbow, wrist."""
    alpha = [-QUARTER, QUARTER, -QUARTER, QUARTER, -QUARTER, QUARTER, 0.0]
    lengths = [0.3, 0.0, 0.45, 0.0, 0.5, 0.0, 0.1]
    if convention != "standard":
        alpha = [0.0, *alpha[:6]]
    return [
        random_row(generator, "R", alpha=x, a=0.0, other=y)
        for x, y in zip(alpha, lengths, strict=True)
    ]


def flat_arm(generator, convention):
    """Axes that are all parallel: 2R, 3R, SCARA."""
    kinds = str(generator.choice(["RR", "RRR", "RRPR", "RRRP", "PRRR"]))
    rows = []
    for k, kind in enumerate(kinds):
        alpha = float(generator.choice([0.0, math.pi]))
        alpha = 0.0 if convention != "standard" and k == 0 else alpha
        length = float(generator.choice([0.3, 0.45, 0.275]))
        rows.append(random_row(generator, kind, alpha=alpha, a=length))
    return rows


def any_arm(generator, convention):
    """Three to six joints of any kind."""
    count = int(generator.choice([2, 3, 3, 3, 4, 5, 6]))
    return [random_row(generator, "RRP") for _ in range(count)]


FAMILIES = (wrist_arm, parallel_arm, srs_arm, flat_arm, any_arm)


def random_arm(number: int) -> Robot:
    """Arm ``number``: its family and convention take turns."""
    generator = np.random.default_rng(number)
    family = FAMILIES[number % len(FAMILIES)]
    convention = CONVENTIONS[number // len(FAMILIES) % 3]
    upright = family is flat_arm and generator.random() < 0.7
    base = None if upright or generator.random() < 0.5 else placement(generator)
    tool = placement(generator, turned=not upright) if generator.random() < 0.7 else None
    return arm_from(family(generator, convention), convention, tool, base)


@dataclass(frozen=True)
class Axes:
    """Axes of an arm at n configurations by products of its link matrices.

    Attributes:
        Z: Directions of the joints, positive sense of q, shape (n, K, 3).
        O: A point of each, shape (n, K, 3).
        T: Pose of the tool, shape (n, 4, 4).
        frames: Poses of frames 0 to K, shape (n, K + 1, 4, 4).
        turns: True for turning joints, shape (K,).
    """

    Z: np.ndarray
    O: np.ndarray
    T: np.ndarray
    frames: np.ndarray
    turns: np.ndarray

    @property
    def jacobian(self) -> np.ndarray:
        """Geometric Jacobian at the tool's origin, shape (n, 6, K)."""
        lever = self.T[:, None, :3, 3] - self.O
        turning = np.concatenate((np.cross(self.Z, lever), self.Z), axis=-1)
        sliding = np.concatenate((self.Z, np.zeros_like(self.Z)), axis=-1)
        columns = np.where(self.turns[None, :, None], turning, sliding)
        return np.swapaxes(columns, 1, 2)


def axes_of(robot: Robot, q: np.ndarray) -> Axes:
    """The axes at q of shape (n, dof)."""
    table = robot.table
    found = dh_matrices(table, q)
    base = np.broadcast_to(table.base, (len(q), 1, 4, 4))
    frames = np.concatenate((base, table.base @ found.T0), axis=1)
    on = frames[:, :-1] if table.convention is Convention.STANDARD else frames[:, 1:]
    signs = np.array([row.sign for row in table.rows], dtype=float)
    return Axes(
        on[..., :3, 2] * signs[None, :, None],
        on[..., :3, 3],
        found.T,
        frames,
        np.array([row.type.is_revolute for row in table.rows]),
    )


def polyline_of(robot: Robot, frames: np.ndarray) -> np.ndarray:
    """Corners of the way that the table describes, from frame 0 on, frames (K + 1, 4, 4)."""
    points = [frames[0, :3, 3]]
    standard = robot.table.convention is Convention.STANDARD
    for before, after, row in zip(frames[:-1], frames[1:], robot.table.rows, strict=True):
        way = after[:3, 3] - before[:3, 3]
        axis = before[:3, 2] if standard else before[:3, 0]
        length = (axis @ way) if standard else row.a
        points += [before[:3, 3] + length * axis, after[:3, 3]]
    return np.array(points)
