"""Two serial chains side by side: where they diverge, up to base, tool and zero offsets.

Both are written as standard tables by the same construction. What the joint axes fix by
themselves (angle and distance of successive axes, distances along an axis between its two common
normals) is then compared row by row. Zero offsets are free; so is what a move of the base or
another tool would hide, which is reported with that remark. The rest is an arm of another shape.
The verdict is measured: with base, tool and zero offsets made equal, both FK are compared.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import pairwise

import numpy as np

from dh_to_urdf.errors import DHError
from dh_to_urdf.extraction.arrangement import arrange
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.construction import Construction, construct
from dh_to_urdf.extraction.extract import Residual, deviation, random_configurations
from dh_to_urdf.extraction.gauge import settled, with_slides_centred
from dh_to_urdf.extraction.zeros import fit_axes, with_zeros
from dh_to_urdf.matrices import link_matrix
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow

CONFIGURATIONS = 50
SNAPS = (1e-3, 1e-7)
"""Tilts below which axes count as parallel, tried in turn: rounded angles, then meant ones."""
MAX_REVERSED = 16
FAR_APART = 1e-2
"""Sum of squares of what is left between axes, beyond which two arms have other shapes."""


class Verdict(StrEnum):
    """What the comparison comes to."""

    IDENTICAL = "identical"
    EQUIVALENT = "equivalent"
    DIFFERENT = "different"


@dataclass(frozen=True, slots=True)
class Difference:
    """One parameter that differs.

    Attributes:
        joint: Number of the joint, from 1.
        name: Its name in the first chain.
        parameter: alpha, a, d or theta of the standard row; type; or joints, for their number.
        first: Value in the first chain, rad or m; the type; the number.
        second: Value in the second chain.
        difference: second - first, rad (within ±π) or m; None where it is no number.
        absorbed_by: ``base`` or ``tool`` where a change of it would hide the difference.
    """

    joint: int
    name: str
    parameter: str
    first: float | str
    second: float | str
    difference: float | None
    absorbed_by: str | None


@dataclass(frozen=True, slots=True)
class JointComparison:
    """One joint in both chains.

    Attributes:
        first: Its name in the first chain.
        second: Its name in the second chain.
        is_revolute: True where zero_offset is an angle.
        zero_offset: What to add to q of the first chain to get q of the second, rad or m.
        position: Largest distance between the frames after this joint, m, over random q, with
            frames 0 and zero offsets made equal.
        orientation: Largest angle between them, rad.
    """

    first: str
    second: str
    is_revolute: bool
    zero_offset: float
    position: float
    orientation: float


@dataclass(frozen=True)
class Comparison:
    """Two chains side by side.

    Attributes:
        verdict: identical; equivalent, up to base, tool and zero offsets; or different.
        differences: What differs beyond the tolerances, base first.
        joints: Joint by joint, as far as both chains have the same kinds of joints.
        reversed: Joints of the second chain that run the other way, if that is all.
        residual: Largest deviation of the tips over random q with base, tool and zero offsets
            made equal; None where the kinds of joints differ.
    """

    verdict: Verdict
    differences: tuple[Difference, ...]
    joints: tuple[JointComparison, ...]
    reversed: tuple[str, ...]
    residual: Residual | None

    @property
    def words(self) -> str:
        """The verdict in one or two sentences."""
        if self.verdict is Verdict.IDENTICAL:
            return "The same arm."
        said = []
        if self.reversed:
            said.append(f"Joint {', '.join(self.reversed)} runs the other way.")
        if self.differences:
            said.append(f"They diverge first at {_sentence(self.differences[0])}.")
            inner = next((d for d in self.differences if d.absorbed_by is None), None)
            if self.verdict is Verdict.EQUIVALENT and not self.reversed:
                said.append("Otherwise the same arm" + self._offsets() + ".")
            elif inner is not None and inner is not self.differences[0]:
                said.append(f"What neither base nor tool can hide begins at {_sentence(inner)}.")
        if not said and self.verdict is Verdict.DIFFERENT and self.residual is not None:
            said.append(
                "No parameter differs by more than the tolerances, but the tips drift apart by"
                f" {self.residual.position:.3g} m and {self.residual.orientation:.3g} rad."
            )
        if (
            self.verdict is Verdict.DIFFERENT
            and sum(not one.is_revolute for one in self.joints) > 1
        ):
            said.append(
                "(Several joints slide: zeros that fit better may exist, and with them a later"
                " divergence.)"
            )
        return " ".join(said) or "The same arm" + self._offsets() + "."

    def _offsets(self) -> str:
        moved = sum(abs(joint.zero_offset) > 1e-9 for joint in self.joints)
        return f", with {moved} other zero(s) of the joints" if moved else ""


def _sentence(difference: Difference) -> str:
    what = f"joint {difference.joint} ({difference.name}): {difference.parameter} is"
    if difference.difference is None:
        return f"{what} {difference.first} in the first and {difference.second} in the second"
    unit = "m" if difference.parameter in ("a", "d") else "rad"
    hidden = f", which another {difference.absorbed_by} hides" if difference.absorbed_by else ""
    return (
        f"{what} {difference.first:.9g} {unit} in the first and {difference.second:.9g} {unit} in"
        f" the second, a difference of {abs(difference.difference):.3g} {unit}{hidden}"
    )


def compare(
    first: SerialChain, second: SerialChain, *, length: float = 1e-6, angle: float = 1e-6
) -> Comparison:
    """Compares two chains joint by joint, in their order from the base.

    Args:
        first: The chain to compare with.
        second: The other one.
        length: Differences up to this are none, m.
        angle: Differences up to this are none, rad.

    Raises:
        DHError: A tolerance is not positive.
    """
    for name, tolerance in (("length", length), ("angle", angle)):
        if not 0.0 < tolerance <= 1.0:
            raise DHError.single(("tolerance", name), f"{name} is {tolerance:g}; give 0 to 1")
    found = _compare_tilted(first, second, length, angle)
    if found.verdict is not Verdict.DIFFERENT or found.residual is None:
        return found
    if any(not joint.type.is_revolute for joint in first.joints):
        found = _compare_at_common_zeros(first, second, length, angle, found)
        if found.verdict is not Verdict.DIFFERENT:
            return found
    for k in range(len(second.joints) if len(second.joints) <= MAX_REVERSED else 0):
        turned = _compare_tilted(first, _reverse(second, k), length, angle)
        if turned.verdict is not Verdict.DIFFERENT:
            return replace(turned, verdict=Verdict.DIFFERENT, reversed=(second.joints[k].name,))
    return found


def _compare_at_common_zeros(
    first: SerialChain, second: SerialChain, length: float, angle: float, found: Comparison
) -> Comparison:
    """The comparison after the zeros of slides, which rows do not fix, were fitted to the axes."""
    fit = fit_axes(first, second, np.array([joint.zero_offset for joint in found.joints]))
    if fit.left > FAR_APART:
        return found
    origin = np.zeros(len(first.joints))
    moved = with_zeros(second, fit.zeros)
    # With the first chain's tip: where lines of slides run, depends on it.
    tip = np.linalg.solve(fit.placement @ moved.poses(origin), first.poses(origin))
    moved = replace(moved, tip_placement=moved.tip_placement @ tip)
    again = _compare_tilted(first, moved, length, angle)
    if again.residual is None or found.residual is None or _drift(again) > _drift(found):
        return found
    joints = tuple(
        replace(joint, zero_offset=joint.zero_offset + float(zero))
        for joint, zero in zip(again.joints, fit.zeros, strict=True)
    )
    verdict = Verdict.EQUIVALENT if again.verdict is Verdict.IDENTICAL else again.verdict
    return replace(again, verdict=verdict, joints=joints)


def _reverse(chain: SerialChain, k: int) -> SerialChain:
    joints = list(chain.joints)
    joints[k] = replace(joints[k], axis=-joints[k].axis)
    return replace(chain, joints=tuple(joints))


def _compare_tilted(
    first: SerialChain, second: SerialChain, length: float, angle: float
) -> Comparison:
    """The comparison that makes the chains equal, or as equal as can be."""
    tried = [_compare(first, second, length, angle, SNAPS[0])]
    for snap in SNAPS[1:]:
        residual = tried[-1].residual
        if residual is None or (residual.position <= length and residual.orientation <= angle):
            break
        tried.append(_compare(first, second, length, angle, snap))
    equal = [one for one in tried if one.verdict is not Verdict.DIFFERENT and one.residual]
    return min(equal, key=_drift) if equal else tried[0]


def _drift(found: Comparison) -> float:
    return max(found.residual.position, found.residual.orientation) if found.residual else 0.0


def _compare(
    first: SerialChain, second: SerialChain, length: float, angle: float, snap: float
) -> Comparison:
    structural = _structure(first, second)
    if structural is not None:
        shared = structural.joint - 1
        if shared == 0:
            return Comparison(Verdict.DIFFERENT, (structural,), (), (), None)
        before = _compare(_cut(first, shared), _cut(second, shared), length, angle, snap)
        real = tuple(d for d in before.differences if d.absorbed_by != "tool")
        return Comparison(Verdict.DIFFERENT, (*real, structural), before.joints, (), None)
    first, slid = with_slides_centred(first, snap)
    second, other_slid = with_slides_centred(second, snap)
    one, two = _made(first, snap), _made(second, snap)
    two = replace(two, rows=_flipped(one.rows, two.rows, first.size))
    two = replace(two, rows=settled(one.construction, one.rows, two.rows))
    differences = _differences(one, two, length, angle)
    inner = any(difference.absorbed_by is None for difference in differences)
    pairs = list(zip(one.rows, two.rows, strict=True))
    offsets = np.array([_offset(a, b) for a, b in pairs])
    verdict = Verdict.DIFFERENT if inner else Verdict.EQUIVALENT
    if not differences and float(np.abs(offsets - slid + other_slid).max()) <= max(length, angle):
        verdict = Verdict.IDENTICAL
    q = random_configurations(first, CONFIGURATIONS)
    joints = _joint_by_joint(pairs, second, offsets, q, offsets - slid + other_slid)
    residual = _residual(first, second, one, two, offsets, q)
    drift = max(residual.position / (10 * first.size), residual.orientation / 10)
    if inner and residual.position <= length and residual.orientation <= angle:
        # The FK has the last word: what is left is how slides share out their constants.
        differences = tuple(d for d in differences if d.absorbed_by is not None)
        verdict = Verdict.EQUIVALENT
    elif drift > len(pairs) * max(angle, length / first.size):
        verdict = Verdict.DIFFERENT
    return Comparison(verdict, differences, joints, (), residual)


def _structure(first: SerialChain, second: SerialChain) -> Difference | None:
    """The first joint that turns in one chain and slides in the other, or is missing."""
    for k, (a, b) in enumerate(zip(first.joints, second.joints, strict=False), start=1):
        if a.type.is_revolute != b.type.is_revolute:
            return Difference(k, a.name, "type", a.type.value, b.type.value, None, None)
    n, m = len(first.joints), len(second.joints)
    if n == m:
        return None
    k = min(n, m) + 1
    longer = first if n > m else second
    return Difference(k, longer.joints[k - 1].name, "joints", str(n), str(m), None, None)


def _cut(chain: SerialChain, count: int) -> SerialChain:
    """The first joints of a chain; its tip on the axis of the joint after them."""
    following = chain.joints[count] if count < len(chain.joints) else None
    tip = chain.tip_placement if following is None else following.placement
    return replace(chain, joints=chain.joints[:count], tip_placement=tip)


@dataclass(frozen=True)
class _Made:
    """A chain in standard form, and the true angles between its directed axes, 0 to π."""

    construction: Construction
    angles: tuple[float, ...]
    rows: tuple[DHRow, ...]


def _made(chain: SerialChain, snap: float) -> _Made:
    tip = chain.poses(np.zeros(len(chain.joints)))
    axes = chain.lines()
    lines = arrange(axes, tip, chain.size, snap, bridge=False, from_base=False)
    made = construct(lines, tip, chain.size, last_at_tip=True)
    directions = [*(axis.direction for axis in axes), tip[:3, 2]]
    angles = tuple(
        math.atan2(float(np.linalg.norm(np.cross(u, v))), float(u @ v))
        for u, v in pairwise(directions)
    )
    return _Made(made, angles, tuple(pair.row for pair in made.pairs))


def _flipped(rows: tuple[DHRow, ...], others: tuple[DHRow, ...], size: float) -> tuple[DHRow, ...]:
    """The other rows with each x turned to the sense that fits the first rows better."""
    fitted = list(others)
    for k, (row, other) in enumerate(zip(rows, others, strict=True)):
        here = abs(other.a - row.a) / size + abs(_wrapped(other.alpha - row.alpha))
        there = abs(-other.a - row.a) / size + abs(_wrapped(-other.alpha - row.alpha))
        if there < here - 1e-9:
            fitted[k] = _turned(replace(fitted[k], a=-other.a, alpha=-other.alpha), math.pi)
            if k + 1 < len(fitted):
                fitted[k + 1] = _turned(fitted[k + 1], -math.pi)
    return tuple(fitted)


def _turned(row: DHRow, angle: float) -> DHRow:
    if row.type.is_revolute:
        return replace(row, offset=row.offset + angle)
    return replace(row, theta=row.theta + angle)


def _offset(first: DHRow, second: DHRow) -> float:
    """What to add to q of the first row to get q of the second."""
    offset = first.offset - second.offset
    return _wrapped(offset) if first.type.is_revolute else offset


def _differences(one: _Made, two: _Made, length: float, angle: float) -> tuple[Difference, ...]:
    found = []
    beside_base = True
    for k, (row, other) in enumerate(zip(one.rows, two.rows, strict=True)):
        last = k == len(one.rows) - 1
        for name in ("d" if row.type.is_revolute else "theta", "a", "alpha"):
            a, b = getattr(row, name), getattr(other, name)
            if name == "alpha":
                a = -one.angles[k] if a < 0.0 else one.angles[k]
                b = -two.angles[k] if b < 0.0 else two.angles[k]
            is_length = name in ("a", "d")
            delta = b - a if is_length else _wrapped(b - a)
            if abs(delta) <= (length if is_length else angle):
                continue
            moved_base = beside_base and name in ("d", "theta")
            hidden = "tool" if last else "base" if moved_base else None
            found.append(Difference(k + 1, row.name, name, a, a + delta, delta, hidden))
        beside_base = beside_base and one.construction.pairs[k].normal.case.is_parallel
    return tuple(found)


def _joint_by_joint(
    pairs: list[tuple[DHRow, DHRow]],
    second: SerialChain,
    offsets: Matrix,
    q: Matrix,
    told: Matrix,
) -> tuple[JointComparison, ...]:
    """How far the frames drift apart along the chain, from a common frame 0."""
    A = B = np.broadcast_to(np.eye(4), (len(q), 4, 4))
    found = []
    for k, (row, other) in enumerate(pairs):
        A = A @ link_matrix(row, Convention.STANDARD, q[:, k] + row.offset)
        B = B @ link_matrix(other, Convention.STANDARD, q[:, k] + offsets[k] + other.offset)
        name = second.joints[k].name
        found.append(
            JointComparison(row.name, name, row.type.is_revolute, float(told[k]), *deviation(A, B))
        )
    return tuple(found)


def _residual(
    first: SerialChain, second: SerialChain, one: _Made, two: _Made, offsets: Matrix, q: Matrix
) -> Residual:
    """Both FK on the chains themselves, base and tool fitted at q = 0."""
    k = next(
        (k for k, pair in enumerate(one.construction.pairs) if not pair.normal.case.is_parallel),
        len(one.rows) - 1,
    )
    G = _up_to(one, np.zeros(k + 1)) @ np.linalg.inv(_up_to(two, offsets[: k + 1]))
    A, B = first.poses(q), G @ second.poses(q + offsets)
    B = B @ np.linalg.inv(B[0]) @ A[0]
    return Residual(*deviation(A, B), len(q))


def _up_to(made: _Made, q: Matrix) -> Matrix:
    """Base, rows before the last of q, and θ and d of that last one."""
    T = made.construction.base
    for row, value in zip(made.rows, q, strict=False):
        cut = replace(row, a=0.0, alpha=0.0) if row is made.rows[len(q) - 1] else row
        T = T @ link_matrix(cut, Convention.STANDARD, value + row.offset)
    return T


def _wrapped(angle: float) -> float:
    """An angle within ±π."""
    return math.remainder(angle, 2 * math.pi)
