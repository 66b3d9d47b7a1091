"""Constants of the chain between base and frame, in the form that compiled solvers take.

The pose of the frame in the base's axes is ``C_0 M(q_1) C_1 M(q_2) … M(q_K) C_K``: constant
placements, and motions about or along z. Joints between the root and the base count backwards,
so a chain may run from one branch of a tree to another. Where joints depend on others, the values
of the joints are ``C q + c`` of the entries of q that move the frame.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.couplings import WHOLE
from kinematics.lanes.links import links_of
from kinematics.tree import Tree, tree_of
from robots.robot import FloatArray, Robot

_FLIP = np.diag([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Chain:
    """Constants of one chain of K joints, moved by n entries of q, n = K where all are free.

    Attributes:
        placements: C_0 … C_K, each the upper three rows of a 4x4 matrix, row by row; shape
            (K + 1, 12).
        is_revolute: True for an angle, False for a length; shape (K,).
        columns: The entries of q that move the frame; those of its joints where all are free;
            shape (n,).
        lower: Lower limits of these entries, -inf where none; shape (n,).
        upper: Upper limits, inf where none; shape (n,).
        names: Names of the joints.
        angles: Where joints depend on others, True for an entry of q that is an angle; shape (n,).
        coupling: C, shape (K, n) with n ≤ K; (0, 0) where joint k is entry k.
        offset: c, shape (K,); (0,) where joint k is entry k.
    """

    placements: FloatArray
    is_revolute: NDArray[np.bool_]
    columns: NDArray[np.intp]
    lower: FloatArray
    upper: FloatArray
    names: tuple[str, ...] = ()
    angles: NDArray[np.bool_] | None = None
    coupling: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    offset: FloatArray = field(default_factory=lambda: np.empty(0))

    @property
    def is_angle(self) -> NDArray[np.bool_]:
        """Return True for an entry of q that is an angle, shape (n,)."""
        return self.is_revolute if self.angles is None else self.angles

    @property
    def length(self) -> int:
        """Number of joints, K."""
        return len(self.is_revolute)

    @property
    def dof(self) -> int:
        """Number of entries of q that move the frame, n."""
        return len(self.columns)

    @property
    def is_coupled(self) -> bool:
        """Return whether a joint is anything but an entry of q."""
        return bool(self.coupling.shape[1] > 0)

    def values(self, q: FloatArray) -> FloatArray:
        """Return the joint values, (…, n) -> (…, K), rad and m."""
        return np.asarray(q @ self.coupling.T + self.offset) if self.is_coupled else q

    def in_q(self, columns: FloatArray) -> FloatArray:
        """Return derivatives by the entries of q of derivatives by joints, (…, K) -> (…, n)."""
        return np.asarray(columns @ self.coupling) if self.is_coupled else columns

    @cached_property
    def leaders(self) -> NDArray[np.intp]:
        """Return the number of the entry of q that each joint is, or follows; shape (K,)."""
        if not self.is_coupled:
            return np.arange(self.length)
        return np.asarray(np.abs(self.coupling).argmax(axis=1))

    @cached_property
    def links(self) -> FloatArray:
        """Return the constants that many configurations at once are computed with."""
        return links_of(self.placements, self.is_revolute)

    @cached_property
    def is_periodic(self) -> NDArray[np.bool_]:
        """Return True where the frame is the same after a turn of an entry of q; shape (n,)."""
        if not self.is_coupled:
            return self.is_revolute
        C = self.coupling
        whole = np.abs(C - np.round(C)) <= WHOLE * np.maximum(1.0, np.abs(C))
        same = np.where(self.is_revolute[:, None], whole, C == 0.0).all(axis=0)
        return np.asarray(self.is_angle & same)

    @cached_property
    def mechanism(self) -> Chain:
        """Return the chain whose joints are all free, without limits."""
        if not self.is_coupled:
            return self
        none = np.full(self.length, np.inf)
        return replace(
            self,
            columns=np.arange(self.length),
            lower=-none,
            upper=none,
            angles=None,
            coupling=np.empty((0, 0)),
            offset=np.empty(0),
        )

    @cached_property
    def inverse(self) -> FloatArray | None:
        """Return C⁻¹ where joint values that are known up to whole turns give q likewise.

        None where they do not: the chain has followers, or turns are coupled by fractions, or
        with slides.
        """
        C, turns = self.coupling, self.is_revolute
        if not self.is_coupled or C.shape[0] != C.shape[1]:
            return None
        if not np.array_equal(turns, self.is_angle):
            return None
        among = C[np.ix_(turns, turns)]
        if not np.array_equal(among, np.round(among)) or C[np.ix_(~turns, turns)].any():
            return None
        if abs(abs(np.linalg.det(among)) - 1.0) > 1e-6 or abs(np.linalg.det(C)) < 1e-9:
            return None
        return np.asarray(np.linalg.inv(C))

    @cached_property
    def reach(self) -> float:
        """Radius of a sphere about the first joint that the frame never leaves, m.

        Sum of the distances between successive joints and the extents of prismatic joints;
        infinite where a prismatic joint has no limit.
        """
        links = np.linalg.norm(self.placements[1:, [3, 7, 11]], axis=1).sum()
        if self.is_coupled:
            return float(links + self._largest_slides().sum())
        extents = np.maximum(np.abs(self.lower), np.abs(self.upper))[~self.is_revolute].sum()
        return float(links + extents)

    def _largest_slides(self) -> FloatArray:
        """Return the largest magnitudes of the values of prismatic joints, m."""
        C = self.coupling[~self.is_revolute]
        largest = np.maximum(np.abs(self.lower), np.abs(self.upper))
        parts = np.where(C == 0.0, 0.0, np.abs(C) * np.where(C == 0.0, 0.0, largest))
        return np.asarray(parts.sum(axis=1) + np.abs(self.offset[~self.is_revolute]))


def chain_of(robot: Robot, frame: str) -> Chain:
    """Return the chain from a robot's base frame to a frame.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    chains = _CHAINS.get(robot)
    if chains is None:
        chains = _CHAINS[robot] = {}
    if frame not in chains:
        robot.frame_id(frame)
        chains[frame] = _build(robot, tree_of(robot), frame)
    return chains[frame]


_CHAINS: WeakKeyDictionary[Robot, dict[str, Chain]] = WeakKeyDictionary()


def _build(robot: Robot, tree: Tree, frame: str) -> Chain:
    base_path, frame_path = tree.path(robot.base_frame), tree.path(frame)
    shared = sum(1 for a, b in zip(base_path, frame_path, strict=False) if a == b)
    constant = _inverse(tree.frames[robot.base_frame][1])
    placements: list[FloatArray] = []
    indices: list[int] = []
    for index in reversed(base_path[shared:]):
        # The inverse of placement * M(q) is M(-q) * inverse; a flip about x turns M(-q) to M(q).
        placements.append(constant @ _FLIP)
        indices.append(index)
        constant = _FLIP @ _inverse(tree.joints[index].placement)
    for index in frame_path[shared:]:
        placements.append(constant @ tree.joints[index].placement)
        indices.append(index)
        constant = np.eye(4)
    placements.append(constant @ tree.frames[frame][1])
    columns = np.array([tree.joints[index].column for index in indices], dtype=np.intp)
    is_revolute = np.array([tree.joints[index].is_revolute for index in indices], dtype=bool)
    names = [robot.moving[column].name for column in columns]
    C, c = np.empty((0, 0)), np.empty(0)
    if robot.coupled is not None:
        C, c = robot.coupled.matrix[columns], robot.coupled.map.offset[columns]
        # In the order in which they first move a joint, so that free joints alone give identity.
        first = {int(n): int(np.flatnonzero(C[:, n])[0]) for n in np.flatnonzero(C.any(axis=0))}
        used = np.array(sorted(first, key=lambda n: (first[n], n)), dtype=np.intp)
        C, columns = C[:, used], used
        kept = _together(placements, is_revolute)
        placements = [*(placements[k] for k in kept), placements[-1]]
        names = [names[k - 1] for k in [*kept[1:], len(c)]] if len(kept) else []
        is_revolute = is_revolute[kept]
        C = np.add.reduceat(C, kept, axis=0) if len(kept) else C
        c = np.add.reduceat(c, kept) if len(kept) else c
        if np.array_equal(C, np.eye(len(c))) and not c.any():
            C, c = np.empty((0, 0)), np.empty(0)
        elif len(columns) > len(c):
            # Joints that stay at 0 make room: compiled functions take no more columns than joints.
            more = len(columns) - len(c)
            C, c = np.vstack((C, np.zeros((more, len(columns))))), np.append(c, np.zeros(more))
            placements += [np.eye(4)] * more
            is_revolute = np.append(is_revolute, np.ones(more, dtype=bool))
            names += [names[-1]] * more
    return Chain(
        placements=np.array([T[:3].reshape(12) for T in placements]),
        is_revolute=is_revolute,
        columns=columns,
        lower=robot.lower[columns],
        upper=robot.upper[columns],
        names=tuple(names),
        angles=robot.is_revolute[columns] if C.shape[1] else None,
        coupling=np.ascontiguousarray(C),
        offset=c,
    )


def _together(placements: list[FloatArray], is_revolute: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return the joints that do not move about or along the very axis of the one before."""
    apart = [
        k
        for k in range(len(is_revolute))
        if k == 0
        or is_revolute[k] != is_revolute[k - 1]
        or not np.array_equal(placements[k], np.eye(4))
    ]
    return np.array(apart, dtype=np.intp)


def _inverse(T: FloatArray) -> FloatArray:
    result = np.eye(4)
    result[:3, :3] = T[:3, :3].T
    result[:3, 3] = -T[:3, :3].T @ T[:3, 3]
    return result
