"""Comparison of two serial chains up to base, tool and zero offsets.

Both chains are written as standard tables by the same construction. The parameters that the joint
axes determine (angle and distance of successive axes, distances along an axis between its two
common normals) are compared row by row. Zero offsets may differ. A difference that a change of the
base or the tool would hide is reported with that remark; any other is an arm of another shape. The
verdict is measured: with base, tool and zero offsets made equal, both FK are compared.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dh_to_urdf.errors import DHError
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.compared_dependences import compared
from dh_to_urdf.extraction.comparison_result import (
    Comparison,
    Difference,
    JointComparison,
    Verdict,
)
from dh_to_urdf.extraction.extract import Residual, deviation, random_configurations
from dh_to_urdf.extraction.gauge import settled, with_slides_centred
from dh_to_urdf.extraction.standard_form import (
    StandardForm,
    standard_form,
    with_fitting_senses,
    wrapped,
    zero_offset,
)
from dh_to_urdf.extraction.zeros import fit_axes, with_zeros
from dh_to_urdf.matrices import link_matrix
from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow

CONFIGURATIONS = 50
SNAPS = (1e-3, 1e-7)
"""Tilts (rad) below which axes count as parallel, tried in turn: rounded angles, exact ones."""
MAX_REVERSED = 16
FAR_APART = 1e-2
"""Sum of squared differences of axes beyond which two arms differ in shape."""


def compare(
    first: SerialChain, second: SerialChain, *, length: float = 1e-6, angle: float = 1e-6
) -> Comparison:
    """Compare two chains joint by joint, from the base on.

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
            raise DHError.single(
                ("tolerance", name),
                say("{name} is {tolerance:g}; give 0 to 1", name=name, tolerance=tolerance),
            )
    found = compared(_compare_mechanisms(first, second, length, angle), first, second, angle)
    if len(first.joints) != len(second.joints):
        return found
    # Of joints that are taken as free: what follows from what is compared above.
    values = random_configurations(first, CONFIGURATIONS)
    position, orientation = deviation(first.poses(values), second.poses(values))
    # Differences up to the tolerances add up from joint to joint.
    most = 2 * (len(first.joints) + 1)
    alike = position <= most * (length + angle * first.size) and orientation <= most * angle
    depend = any(one.parameter in ("mimic", "coupling") for one in found.differences)
    return replace(found, same_poses=alike and not depend)


def _compare_mechanisms(
    first: SerialChain, second: SerialChain, length: float, angle: float
) -> Comparison:
    """Compare two chains whose joints are taken as free."""
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
    """Compare again with the zeros of prismatic joints fitted to the axes."""
    fit = fit_axes(first, second, np.array([joint.zero_offset for joint in found.joints]))
    if fit.left > FAR_APART:
        return found
    origin = np.zeros(len(first.joints))
    moved = with_zeros(second, fit.zeros)
    # With the first chain's tip, on which the lines of prismatic joints depend.
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
    """Compare with each of ``SNAPS``; return the comparison with the smallest deviation."""
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
    one, two = standard_form(first, snap), standard_form(second, snap)
    two = replace(two, rows=with_fitting_senses(one.rows, two.rows, first.size))
    two = replace(two, rows=settled(one.construction, one.rows, two.rows))
    differences = _differences(one, two, length, angle)
    inner = any(difference.absorbed_by is None for difference in differences)
    pairs = list(zip(one.rows, two.rows, strict=True))
    offsets = np.array([zero_offset(a, b) for a, b in pairs])
    verdict = Verdict.DIFFERENT if inner else Verdict.EQUIVALENT
    if not differences and float(np.abs(offsets - slid + other_slid).max()) <= max(length, angle):
        verdict = Verdict.IDENTICAL
    q = random_configurations(first, CONFIGURATIONS)
    joints = _joint_by_joint(pairs, second, offsets, q, offsets - slid + other_slid)
    residual = _residual(first, second, one, two, offsets, q)
    drift = max(residual.position / (10 * first.size), residual.orientation / 10)
    if inner and residual.position <= length and residual.orientation <= angle:
        # The measured FK decides: what differs is the distribution of prismatic constants.
        differences = tuple(d for d in differences if d.absorbed_by is not None)
        verdict = Verdict.EQUIVALENT
    elif drift > len(pairs) * max(angle, length / first.size):
        verdict = Verdict.DIFFERENT
    return Comparison(verdict, differences, joints, (), residual)


def _structure(first: SerialChain, second: SerialChain) -> Difference | None:
    """Return the first joint that differs in kind, or is missing; None where none does."""
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
    """Return the first joints of a chain, with the tip on the axis of the joint after them."""
    following = chain.joints[count] if count < len(chain.joints) else None
    tip = chain.tip_placement if following is None else following.placement
    return replace(chain, joints=chain.joints[:count], tip_placement=tip)


def _differences(
    one: StandardForm, two: StandardForm, length: float, angle: float
) -> tuple[Difference, ...]:
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
            delta = b - a if is_length else wrapped(b - a)
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
    """Measure how far the frames drift apart along the chain, from a common frame 0."""
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
    first: SerialChain,
    second: SerialChain,
    one: StandardForm,
    two: StandardForm,
    offsets: Matrix,
    q: Matrix,
) -> Residual:
    """Measure the deviation of both FK, base and tool fitted at q = 0."""
    k = next(
        (k for k, pair in enumerate(one.construction.pairs) if not pair.normal.case.is_parallel),
        len(one.rows) - 1,
    )
    G = one.leading_pose(np.zeros(k + 1)) @ np.linalg.inv(two.leading_pose(offsets[: k + 1]))
    A, B = first.poses(q), G @ second.poses(q + offsets)
    B = B @ np.linalg.inv(B[0]) @ A[0]
    return Residual(*deviation(A, B), len(q))
