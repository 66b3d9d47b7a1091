"""The slips of working with a D-H table, each a pure function from a situation to another one.

A slip names what was done in the place of what: ``modified_for_standard`` reads a standard table
as a modified one. One that changes nothing for this robot is not given.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from dh_to_urdf.table import Convention
from kinematics.checking.situation import BoolArray, Situation, Structure, with_columns
from robots.robot import FloatArray

EXACT = 1e-12
"""Changes below it are none, rad and m."""
DEGREE = np.pi / 180


@dataclass(frozen=True)
class Slip:
    """One slip at one place.

    Attributes:
        code: Its kind.
        where: The joint or row; empty where it concerns all of them.
        detail: What of it, where the kind leaves that open.
        cost: How unlikely it is; 1 for the most usual ones.
    """

    code: str
    where: str = ""
    detail: str = ""
    cost: float = 1.0


@dataclass(frozen=True, eq=False)
class SituationSlip:
    """A slip, and what it makes of a situation."""

    slip: Slip
    apply: Callable[[Situation], Situation]


Found = Iterator[SituationSlip]


def _with_q(situation: Situation, q: FloatArray) -> Situation:
    return replace(situation, q=q)


def angles_in_wrong_unit(structure: Structure, situation: Situation) -> Found:
    """Degrees put into sin and cos that take radians, and the other way round."""
    turns = structure.turning

    def scaled(factor: float, everything: bool, one: Situation) -> Situation:
        changed = _with_q(one, np.where(turns, one.q * factor, one.q))
        if not everything:
            return changed
        offset = np.where(structure.revolute, one.offset * factor, one.offset)
        alpha, theta = one.alpha * factor, one.theta * factor
        return replace(changed, alpha=alpha, theta=theta, offset=offset)

    constants = situation.alpha.any() or (situation.offset * structure.revolute).any()
    for code, factor in (("degrees_for_radians", 1 / DEGREE), ("radians_for_degrees", DEGREE)):
        if (situation.q * turns).any():
            yield SituationSlip(Slip(code, cost=1.0), partial(scaled, factor, False))
        if constants:
            slip = Slip(code, detail="all angles", cost=1.4)
            yield SituationSlip(slip, partial(scaled, factor, True))


def other_convention(structure: Structure, _: Situation) -> Found:
    """A standard table read as a modified one, or the other way round."""
    if not structure.count:
        return
    names = {
        Convention.STANDARD: "modified_for_standard",
        Convention.MODIFIED: "standard_for_modified",
        Convention.KHALIL: "standard_for_khalil",
    }
    code = names[structure.convention]

    def flipped(one: Situation) -> Situation:
        return replace(one, standard=not one.standard)

    yield SituationSlip(Slip(code, cost=1.0), flipped)


def constants_of_neighbour_rows(structure: Structure, situation: Situation) -> Found:
    """α or a taken from the row above or below: of all rows, or of one."""
    count = structure.count

    def moved(
        columns: tuple[str, ...], step: int, row: int | None, around: bool, one: Situation
    ) -> Situation:
        changes = {}
        for name in columns:
            values = getattr(one, name)
            shifted = np.roll(values, -step, axis=-1)
            if not around:
                shifted[..., -1 if step > 0 else 0] = 0.0
            if row is not None:
                shifted = np.where(np.arange(count) == row, shifted, values)
            changes[name] = shifted
        return with_columns(one, changes)

    choices: tuple[tuple[tuple[str, ...], str, float], ...] = (
        (("alpha",), "alpha_of_neighbour_row", 1.1),
        (("a",), "a_of_neighbour_row", 1.6),
        (("alpha", "a"), "alpha_and_a_of_neighbour_row", 1.5),
    )
    for columns, code, cost in choices:
        if count < 2 or any(not getattr(situation, name).any() for name in columns):
            continue
        for step, side in ((1, "below"), (-1, "above")):
            slip = Slip(code, detail=side, cost=cost)
            yield SituationSlip(slip, partial(moved, columns, step, None, False))
            last = [getattr(situation, name)[..., 0 if step > 0 else -1] for name in columns]
            if any(np.any(values) for values in last):
                slip = Slip(code, detail=side, cost=cost + 0.05)
                yield SituationSlip(slip, partial(moved, columns, step, None, True))
            if len(columns) > 1:
                continue
            for row in range(count):
                if 0 <= row + step < count:
                    slip = Slip(code, structure.rows[row], side, cost + 0.1)
                    yield SituationSlip(slip, partial(moved, columns, step, row, False))


def opposite_signs(structure: Structure, situation: Situation) -> Found:
    """The sign of one α, a, d or offset, of any row."""

    def negated(column: str, row: int | None, one: Situation) -> Situation:
        values = getattr(one, column)
        rows = np.arange(structure.count)
        chosen = rows >= 0 if row is None else rows == row
        return with_columns(one, {column: np.where(chosen, -values, values)})

    for column, cost in (("alpha", 1.1), ("a", 1.3), ("d", 1.3), ("offset", 1.3)):
        values = getattr(situation, column)
        present = np.flatnonzero(np.atleast_2d(np.abs(values)).max(axis=0) > EXACT)
        if len(present) > 1:
            slip = Slip(f"{column}_sign", cost=cost + 0.1)
            yield SituationSlip(slip, partial(negated, column, None))
        for row in present:
            slip = Slip(f"{column}_sign", structure.rows[row], cost=cost)
            yield SituationSlip(slip, partial(negated, column, int(row)))


def missing_constants(structure: Structure, situation: Situation) -> Found:
    """An offset of θ (or of a slide), an a or a d left out; or a whole row."""

    def without(column: str, rows: BoolArray, one: Situation) -> Situation:
        return with_columns(one, {column: np.where(rows, 0.0, getattr(one, column))})

    def without_row(row: int, one: Situation) -> Situation:
        return replace(one, missing=one.missing | (np.arange(structure.count) == row))

    for column, cost in (("offset", 1.1), ("a", 1.4), ("d", 1.4)):
        present = np.abs(getattr(situation, column)).max(axis=0, initial=0.0) > EXACT
        places = np.flatnonzero(present).tolist()
        for row in places:
            only = np.arange(structure.count) == row
            slip = Slip(f"{column}_missing", structure.rows[row], cost=cost)
            yield SituationSlip(slip, partial(without, column, only))
        if len(places) > 1 and column == "offset":
            slip = Slip("offset_missing", cost=cost)
            yield SituationSlip(slip, partial(without, column, present))
    for row in range(structure.count if structure.count > 1 else 0):
        slip = Slip("row_missing", structure.rows[row], cost=1.5)
        yield SituationSlip(slip, partial(without_row, row))


def forgotten_placements(_: Structure, situation: Situation) -> Found:
    """The tool or the base left out."""

    def without(name: str, one: Situation) -> Situation:
        return with_columns(one, {name: np.broadcast_to(np.eye(4), getattr(one, name).shape)})

    for name in ("tool", "base"):
        if np.abs(getattr(situation, name) - np.eye(4)).max() > EXACT:
            yield SituationSlip(Slip(f"{name}_forgotten", cost=1.0), partial(without, name))


def wrong_joint_values(structure: Structure, situation: Situation) -> Found:
    """The sign of one joint value, values in another order, a slide in mm."""
    q, dof = situation.q, len(structure.joints)
    used = np.flatnonzero(np.abs(structure.matrix).max(axis=0, initial=0.0) > 0.0)

    def negated(joint: int, one: Situation) -> Situation:
        return _with_q(one, np.where(np.arange(dof) == joint, -one.q, one.q))

    def ordered(order: tuple[int, ...], one: Situation) -> Situation:
        return _with_q(one, one.q[:, list(order)])

    def in_millimetres(joint: int, one: Situation) -> Situation:
        return _with_q(one, np.where(np.arange(dof) == joint, 1000.0 * one.q, one.q))

    def turned_round(joint: int, one: Situation) -> Situation:
        moved = structure.matrix[:, joint] != 0.0
        return replace(one, sign=np.where(moved, -one.sign, one.sign))

    for joint in used:
        slip = Slip("joint_sign", structure.joints[joint], "direction", 1.1)
        yield SituationSlip(slip, partial(turned_round, int(joint)))
        if np.abs(q[:, joint]).max() > EXACT:
            slip = Slip("joint_sign", structure.joints[joint], "value", 1.1)
            yield SituationSlip(slip, partial(negated, int(joint)))
            if not structure.turning[joint]:
                slip = Slip("mm_for_m", structure.joints[joint], "q", 1.4)
                yield SituationSlip(slip, partial(in_millimetres, int(joint)))
    orders = [(tuple(reversed(range(dof))), "reversed")] if dof > 2 else []
    for first, second in pairwise(used.tolist()):
        order = list(range(dof))
        order[first], order[second] = second, first
        orders.append((tuple(order), f"{structure.joints[first]}, {structure.joints[second]}"))
    for chosen, how in orders:
        if np.abs(q[:, list(chosen)] - q).max() > EXACT:
            slip = Slip("joints_in_other_order", detail=how, cost=1.4)
            yield SituationSlip(slip, partial(ordered, chosen))


def reversed_product(structure: Structure, _: Situation) -> Found:
    """The link matrices multiplied in the other order."""
    if structure.count > 1:

        def backwards(one: Situation) -> Situation:
            return replace(one, reversed_order=not one.reversed_order)

        yield SituationSlip(Slip("order_reversed", cost=1.2), backwards)


TABLE_SLIPS = (
    other_convention,
    constants_of_neighbour_rows,
    opposite_signs,
    missing_constants,
    forgotten_placements,
)
"""Slips in reading a table and its placements."""


def slips_of(
    structure: Structure,
    situation: Situation,
    *,
    written: bool = True,
    product: bool = True,
    units: bool = True,
) -> list[SituationSlip]:
    """Return all slips that can be made, the most usual first.

    Args:
        structure: The chain.
        situation: The right numbers.
        written: Whether there is a table that can be misread; of a URDF only joint values can.
        product: Whether link matrices are multiplied.
        units: Whether q is given, and may be taken in another unit.
    """
    kinds: list[Callable[[Structure, Situation], Found]] = [wrong_joint_values]
    if units:
        kinds.append(angles_in_wrong_unit)
    if written:
        kinds += TABLE_SLIPS
    if written and product:
        kinds.append(reversed_product)
    found = [slip for kind in kinds for slip in kind(structure, situation)]
    return sorted(found, key=lambda one: one.slip.cost)
