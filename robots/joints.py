"""The joints of a robot: the entries of q, and those that depend on them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf import JointType
from dh_to_urdf.couplings import WHOLE, JointMap, MovingJoint


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint that moves.

    Attributes:
        name: Its name.
        type: revolute, prismatic or continuous.
        lower: Smallest value, rad or m; None where there is no limit.
        upper: Largest value.
        velocity: Largest speed, rad/s or m/s; None where unknown.
        effort: Largest torque or force, N m or N; None where unknown.
        acceleration: Largest acceleration, rad/s² or m/s²; None where unknown.
        jerk: Largest jerk, rad/s³ or m/s³; None where unknown.
    """

    name: str
    type: JointType
    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None
    acceleration: float | None = None
    jerk: float | None = None


@dataclass(frozen=True, eq=False)
class CoupledJoints:
    """Joints of which some follow others, or are moved by others besides.

    Attributes:
        joints: All m joints that move, in the order of the document, with their own limits.
        relations: What each depends on.
        map: From q to their values.
    """

    joints: tuple[Joint, ...]
    relations: tuple[MovingJoint, ...]
    map: JointMap

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Return C, shape (m, dof)."""
        return self.map.matrix

    def values(self, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``C q + c``, (…, dof) -> (…, m), rad and m."""
        return np.asarray(q @ self.map.matrix.T + self.map.offset)

    @cached_property
    def is_periodic(self) -> NDArray[np.bool_]:
        """Return True where a turn of an entry of q turns every joint by whole turns."""
        turns = np.array([joint.type.is_revolute for joint in self.joints])
        C = self.map.matrix
        whole = np.abs(C - np.round(C)) <= WHOLE * np.maximum(1.0, np.abs(C))
        return np.asarray(np.where(turns[:, None], whole, C == 0.0).all(axis=0))

    @property
    def followers(self) -> tuple[MovingJoint, ...]:
        """Return the joints that are no entries of q."""
        return tuple(joint for joint in self.relations if joint.mimic is not None)

    @property
    def couplings(self) -> tuple[MovingJoint, ...]:
        """Return the joints that others move besides."""
        return tuple(joint for joint in self.relations if joint.coupling)
