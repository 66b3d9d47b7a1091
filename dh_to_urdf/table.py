"""D-H tables: conventions, rows and tables as frozen dataclasses, in rad, m and kg.

Whatever the columns are called in a document, a row is stored with the four names of Craig and
Paul: ``a`` along x, ``alpha`` about x, ``d`` along z, ``theta`` about z. Khalil and Kleinfinger
write ``d`` for the first and ``r`` for the third.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from dh_to_urdf.poses import Matrix


class Convention(StrEnum):
    """Place of frame k on link k.

    ``standard`` (distal; Paul 1981): ``A_k = Rz(θ) Tz(d) Tx(a) Rx(α)``.
    ``modified`` (proximal; Craig, *Introduction to Robotics*, ch. 3):
    ``A_k = Tx(a) Rx(α) Rz(θ) Tz(d)``, so that row k holds a_{k-1} and α_{k-1}.
    ``khalil`` (Khalil and Kleinfinger 1986): modified, preceded by ``Rz(γ) Tz(b)`` for trees.
    """

    STANDARD = "standard"
    MODIFIED = "modified"
    KHALIL = "khalil"


class JointType(StrEnum):
    """How a row moves. ``continuous`` turns without limits; ``fixed`` does not move."""

    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"
    CONTINUOUS = "continuous"
    FIXED = "fixed"

    @property
    def is_revolute(self) -> bool:
        """Return True where the joint variable is an angle."""
        return self in (JointType.REVOLUTE, JointType.CONTINUOUS)


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds on q (not on ``sign*q + offset``); None where there is none.

    Attributes:
        lower: Smallest q, rad or m.
        upper: Largest q, rad or m.
        velocity: Largest ``|dq/dt|``, rad/s or m/s.
        effort: Largest torque or force, N m or N.
    """

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass properties of link k.

    Attributes:
        mass: kg.
        com: Centre of mass in frame k, m.
        inertia: 3x3 matrix about the centre of mass in the axes of frame k, kg m².
    """

    mass: float
    com: tuple[float, float, float]
    inertia: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, slots=True)
class Mimic:
    """What a follower follows: its coordinate is ``multiplier * (that of the other) + offset``.

    Attributes:
        joint: Name of the other joint.
        multiplier: Units of this joint, rad or m, in one of the other.
        offset: rad or m.
    """

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class DHRow:
    """One row: the placement of frame k in its parent frame.

    The joint variable ``v = sign*q + offset`` stands for θ (revolute, continuous) or d
    (prismatic); the constant of that column is part of ``offset`` and stored as 0. In the place
    of q, a follower has the coordinate that its ``mimic`` says, and a coupled joint its q plus
    the coordinates of others; see :mod:`dh_to_urdf.couplings`.

    Attributes:
        name: Name of the joint.
        type: How it moves.
        alpha: Twist about x, rad.
        a: Length along x, m (Khalil's d).
        d: Length along z, m (Khalil's r).
        theta: Angle about z, rad.
        offset: Value of the variable at q = 0, rad or m.
        sign: +1, or -1 where q runs against the axis.
        limits: Bounds on q.
        gamma: Khalil's γ about z of the parent, rad.
        b: Khalil's b along z of the parent, m.
        parent: Number of the parent frame of this row: 0 is the base frame, k the frame of
            the k-th row.
        inertial: Mass properties, if known.
        visual: False to draw nothing for this row.
        mimic: What the joint follows; None where it is a coordinate of q.
        coupling: Names of other joints and the coefficients by which they move this one too.
        symbols: What the table calls its lengths: pairs of ``a``, ``d`` or ``b`` and a name, with
            a minus sign where the length is minus what the name stands for.
    """

    name: str
    type: JointType
    alpha: float
    a: float
    d: float
    theta: float
    parent: int
    offset: float = 0.0
    sign: int = 1
    limits: Limits = field(default_factory=Limits)
    gamma: float = 0.0
    b: float = 0.0
    inertial: Inertial | None = None
    visual: bool = True
    mimic: Mimic | None = None
    coupling: tuple[tuple[str, float], ...] = ()
    symbols: tuple[tuple[str, str], ...] = field(default=(), compare=False)


@dataclass(frozen=True)
class DHTable:
    """A robot as a D-H table.

    Attributes:
        name: Name of the robot.
        convention: What the rows mean.
        rows: The joints, in the order of the document. A row's parent comes before it.
        base: Placement of frame 0 in ``base_link``, 4x4.
        tool: Placement of ``tool`` in the last frame of the longest chain, 4x4.
        warnings: Assumptions and doubts of the reader, as sentences, the gravest first.
        doubts: Those of them about values that are probably meant in another unit.
    """

    name: str
    convention: Convention
    rows: tuple[DHRow, ...]
    base: Matrix = field(default_factory=lambda: np.eye(4))
    tool: Matrix = field(default_factory=lambda: np.eye(4))
    warnings: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

    @property
    def moving_rows(self) -> tuple[int, ...]:
        """Return the indices of the rows that move: free ones and followers."""
        return tuple(k for k, row in enumerate(self.rows) if row.type is not JointType.FIXED)

    @property
    def free_rows(self) -> tuple[int, ...]:
        """Return the indices of the rows that are coordinates of q, in its order."""
        return tuple(k for k in self.moving_rows if self.rows[k].mimic is None)

    @property
    def is_coupled(self) -> bool:
        """Return whether a joint follows another, or is coupled with one."""
        return any(row.mimic is not None or row.coupling for row in self.rows)

    @property
    def dof(self) -> int:
        """Return the number of entries of q."""
        return len(self.free_rows)

    @property
    def tip_row(self) -> int:
        """Return the number of the frame that carries the tool (leaf of the longest chain).

        Of several longest chains, the one whose leaf is last in the document; 0 if empty.
        """
        depth = [0]
        for row in self.rows:
            depth.append(depth[row.parent] + (row.type is not JointType.FIXED))
        parents = {row.parent for row in self.rows}
        leaves = [k for k in range(len(depth)) if k not in parents]
        return max(leaves, key=lambda k: (depth[k], k))
