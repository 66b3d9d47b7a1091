"""Followers and couplings: the affine map from the free joints of a robot to all that move.

A joint that moves is free, a coordinate of q, or it follows another: its coordinate is
``multiplier * (coordinate of the other) + offset``, with as many others between as there are. What
the geometry turns by, or slides by, is the coordinate plus the coordinates of the joints that it is
coupled with, times their coefficients. So the values of all joints are ``C q + c``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import DHTable, JointType, Limits, Mimic

WHOLE = 1e-12
"""Distance from a whole number below which a multiplier counts as one."""


def coefficient_in(turn: float, coefficient: float, *, turns: bool, leader_turns: bool) -> float:
    """Return a coefficient between joint values in rad and m for values with another angle unit.

    Args:
        turn: One rad in that unit, such as 180/π.
        coefficient: Of the leader's value, in rad and m.
        turns: Whether the joint that depends is an angle.
        leader_turns: Whether its leader is.
    """
    return float(coefficient * turn ** (turns - leader_turns))


class CouplingError(ValueError):
    """Joints that depend on each other in a way that is no robot.

    Attributes:
        joint: Number of the joint at fault among those that move.
        field: ``mimic``, ``coupling`` or ``limits``.
    """

    def __init__(self, joint: int, field: str, message: str) -> None:
        self.joint = joint
        self.field = field
        super().__init__(message)


@dataclass(frozen=True, slots=True)
class MovingJoint:
    """What a joint that moves depends on.

    Attributes:
        name: Its name.
        type: How it moves.
        limits: Bounds on its coordinate.
        mimic: What it follows; None of a free joint.
        coupling: Name and coefficient of each joint that moves its geometry as well.
    """

    name: str
    type: JointType
    limits: Limits
    mimic: Mimic | None = None
    coupling: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, eq=False)
class JointMap:
    """The map from q to the values of m joints that move.

    Attributes:
        free: Numbers of the free joints among the m, in order; n of them.
        matrix: C, m/m, rad/rad, m/rad or rad/m, shape (m, n).
        offset: c, rad and m, shape (m,).
        coordinates: As C, without couplings, shape (m, n).
        own: As c, without couplings, shape (m,).
        limits: Bounds of q: of each free joint, and of those that follow it.
    """

    free: tuple[int, ...]
    matrix: Matrix
    offset: Matrix
    coordinates: Matrix
    own: Matrix
    limits: tuple[Limits, ...]

    @property
    def is_identity(self) -> bool:
        """Return True where every joint is free and turns or slides by its own coordinate."""
        return np.array_equal(self.matrix, np.eye(*self.matrix.shape)) and not self.offset.any()


def joint_map(joints: Sequence[MovingJoint], fixed: Sequence[str] = ()) -> JointMap:
    """Return the map of joints that depend on each other.

    Args:
        joints: The joints that move, with unique names.
        fixed: Names of the joints that do not.

    Raises:
        CouplingError: A joint depends on one that is unknown or does not move, or on itself;
            a continuous joint leads by a fraction; limits leave nothing; or a motion of q moves
            no joint.
    """
    numbers = {joint.name: k for k, joint in enumerate(joints)}
    for k, joint in enumerate(joints):
        _check_names(k, joint, numbers, fixed)
    roots = [_root(k, joints, numbers) for k in range(len(joints))]
    free = tuple(k for k, joint in enumerate(joints) if joint.mimic is None)
    columns = {k: n for n, k in enumerate(free)}
    coordinates, offset = np.zeros((len(joints), len(free))), np.zeros(len(joints))
    for k, (root, multiplier, constant) in enumerate(roots):
        coordinates[k, columns[root]] = multiplier
        offset[k] = constant
    matrix, moved = coordinates.copy(), offset.copy()
    for k, joint in enumerate(joints):
        for name, coefficient in joint.coupling:
            matrix[k] += coefficient * coordinates[numbers[name]]
            moved[k] += coefficient * offset[numbers[name]]
    if not np.isfinite(matrix).all() or max(np.abs(matrix).max(initial=0.0), 0.0) > 1e6:
        k = int(np.argmax(np.abs(np.nan_to_num(matrix, nan=np.inf)).max(axis=1)))
        raise CouplingError(
            k,
            "mimic",
            say(
                "joint {joint!r} moves over 1e6 times as much as what it follows",
                joint=joints[k].name,
            ),
        )
    if np.abs(moved).max(initial=0.0) > 1e6:
        k = int(np.argmax(np.abs(moved)))
        raise CouplingError(
            k,
            "mimic",
            say(
                "joint {joint!r} is beyond ±1e6 where q is 0; check its offset",
                joint=joints[k].name,
            ),
        )
    _check_turns(joints, free, matrix)
    _check_independent(joints, free, matrix)
    limits = tuple(
        _narrowed(k, joints, [f for f, (root, *_) in enumerate(roots) if root == k], roots)
        for k in free
    )
    return JointMap(free, matrix + 0.0, moved + 0.0, coordinates + 0.0, offset + 0.0, limits)


def moving_joints(table: DHTable) -> tuple[tuple[MovingJoint, ...], tuple[str, ...]]:
    """Return the joints of a table that move, and the names of those that do not."""
    moving = tuple(
        MovingJoint(row.name, row.type, row.limits, row.mimic, row.coupling)
        for row in (table.rows[k] for k in table.moving_rows)
    )
    return moving, tuple(row.name for row in table.rows if row.type is JointType.FIXED)


def uncoupled(table: DHTable) -> DHTable:
    """Return the table of the mechanism, every joint that moves free."""
    if not table.is_coupled:
        return table
    rows = tuple(replace(row, mimic=None, coupling=()) for row in table.rows)
    return replace(table, rows=rows)


def _check_names(
    k: int, joint: MovingJoint, numbers: Mapping[str, int], fixed: Sequence[str]
) -> None:
    wanted = [("mimic", joint.mimic.joint)] if joint.mimic is not None else []
    wanted += [("coupling", name) for name, _ in joint.coupling]
    for field, name in wanted:
        verb = say("mimics") if field == "mimic" else say("is coupled with")
        if name == joint.name:
            raise CouplingError(
                k,
                field,
                say(
                    "joint {name!r} {verb} itself; remove its {field}",
                    name=name,
                    verb=verb,
                    field=field,
                ),
            )
        if name in fixed:
            raise CouplingError(
                k,
                field,
                say(
                    "joint {joint!r} {verb} {name}, which does not move; remove the"
                    " {field}, or name a joint that moves",
                    joint=joint.name,
                    verb=verb,
                    name=quoted(name, 64),
                    field=field,
                ),
            )
        if name not in numbers:
            known = ", ".join(list(numbers)[:12])
            raise CouplingError(
                k,
                field,
                say(
                    "joint {joint!r} {verb} {name}, which does not exist; mend the name or"
                    " remove the {field}; known are {known}",
                    joint=joint.name,
                    verb=verb,
                    name=quoted(name, 64),
                    field=field,
                    known=known,
                ),
            )
    if joint.mimic is not None and joint.coupling:
        bounded = joint.limits.lower is not None or joint.limits.upper is not None
        if bounded:
            raise CouplingError(
                k,
                "limits",
                say(
                    "joint {joint!r} follows several joints, so that its limits would bound"
                    " them together; leave its limits out, and give those of the joints"
                    " that it follows",
                    joint=joint.name,
                ),
            )


def _root(
    k: int, joints: Sequence[MovingJoint], numbers: Mapping[str, int]
) -> tuple[int, float, float]:
    """Return the free joint that a joint follows at last, the multiplier and the offset."""
    seen = [k]
    multiplier, constant = 1.0, 0.0
    while (mimic := joints[seen[-1]].mimic) is not None:
        constant += multiplier * mimic.offset
        multiplier *= mimic.multiplier
        leader = numbers[mimic.joint]
        if leader in seen:
            by = joints[seen[-1]].name
            name = joints[leader].name
            raise CouplingError(
                leader,
                "mimic",
                say("joint {name!r} mimics itself", name=name)
                + (say(" by way of {by!r}", by=by) if by != name else "")
                + say("; remove one mimic"),
            )
        seen.append(leader)
    return seen[-1], multiplier, constant


def _check_turns(joints: Sequence[MovingJoint], free: Sequence[int], matrix: Matrix) -> None:
    """Refuse what differs after a turn of a joint that has no limits by its type."""
    for n, leader in enumerate(free):
        for k, joint in enumerate(joints):
            factor = float(matrix[k, n])
            whole = abs(factor - round(factor)) <= WHOLE * max(1.0, abs(factor))
            fraction = not whole or (factor != 0.0 and not joint.type.is_revolute)
            follows = joint.mimic is not None and joint.type is JointType.CONTINUOUS
            bounds = joints[leader].limits
            endless = joints[leader].type is JointType.CONTINUOUS or (
                follows
                and joints[leader].type.is_revolute
                and (bounds.lower is None or bounds.upper is None)
            )
            if k == leader or not fraction or not endless:
                continue
            field = "mimic" if joint.mimic is not None else "coupling"
            which = joint if joint.type is JointType.CONTINUOUS else joints[leader]
            raise CouplingError(
                k,
                field,
                say(
                    "joint {joint!r} moves {factor:g} times as much as {joint_2!r}, and"
                    " {which!r} is continuous: after a turn the robot would be another;"
                    " make {which!r} revolute, with limits",
                    joint=joint.name,
                    factor=factor,
                    joint_2=joints[leader].name,
                    which=which.name,
                ),
            )


def _check_independent(joints: Sequence[MovingJoint], free: Sequence[int], matrix: Matrix) -> None:
    """Refuse couplings by which a motion of q moves nothing."""
    if not any(joint.coupling for joint in joints) or not free:
        return
    _, sigma, rows = np.linalg.svd(matrix / np.abs(matrix).max(axis=0, initial=1e-300))
    if sigma[-1] > 1e-12 * sigma[0]:
        return
    still = [joints[k].name for k, part in zip(free, rows[-1], strict=True) if abs(part) > 1e-6]
    k = next(k for k in free if joints[k].name in still and joints[k].coupling)
    raise CouplingError(
        k,
        "coupling",
        say(
            "joints {still} are coupled in a cycle: they can turn together without"
            " moving anything; remove one coupling",
            still=", ".join(map(repr, still[:6])),
        ),
    )


def _narrowed(
    leader: int,
    joints: Sequence[MovingJoint],
    followers: Sequence[int],
    roots: Sequence[tuple[int, float, float]],
) -> Limits:
    """Return the bounds of a free joint: its own, and those that its followers put on it."""
    own = joints[leader].limits
    if list(followers) == [leader]:
        return own
    lower, upper = _bounds(own)
    velocity = math.inf if own.velocity is None else own.velocity
    for k in followers:
        if k == leader:
            continue
        name, limits = joints[k].name, joints[k].limits
        _, multiplier, constant = roots[k]
        low, high = _bounds(limits)
        if multiplier == 0.0:
            if not low <= constant <= high:
                raise CouplingError(
                    k,
                    "limits",
                    say(
                        "joint {name!r} stays at {constant:g}, outside its limits",
                        name=name,
                        constant=constant,
                    ),
                )
            continue
        ends = [
            _inward((end - constant) / multiplier, multiplier, constant, low, high)
            for end in (low, high)
        ]
        lower, upper = max(lower, min(ends)), min(upper, max(ends))
        if limits.velocity is not None:
            velocity = min(velocity, limits.velocity / abs(multiplier))
        if lower > upper:
            raise CouplingError(
                k,
                "limits",
                say(
                    "the limits of joint {name!r} leave no value to {joint!r}, which it"
                    " follows; mend one of the two",
                    name=name,
                    joint=joints[leader].name,
                ),
            )
    return Limits(
        None if lower == -math.inf else lower + 0.0,
        None if upper == math.inf else upper + 0.0,
        None if velocity == math.inf else velocity,
        own.effort,
    )


def narrow_warnings(joints: Sequence[MovingJoint], found: JointMap) -> tuple[str, ...]:
    """Return a warning for each free joint to which the limits of followers leave one value."""
    warnings = []
    for k, limits in zip(found.free, found.limits, strict=True):
        own = joints[k].limits
        if limits.lower is None or limits.lower != limits.upper or own.lower == own.upper:
            continue
        warnings.append(
            say(
                "the limits of the joints that follow {joint!r} leave it one value,"
                " {lower:g}; mend their limits or multipliers if it is to move",
                joint=joints[k].name,
                lower=limits.lower,
            )
        )
    return tuple(warnings)


def _bounds(limits: Limits) -> tuple[float, float]:
    lower = -math.inf if limits.lower is None else limits.lower
    return lower, math.inf if limits.upper is None else limits.upper


def _inward(bound: float, multiplier: float, constant: float, low: float, high: float) -> float:
    """Move a bound of a leader by the last digits, until its follower is within its limits."""
    if not math.isfinite(bound):
        return bound
    middle = 0.5 * (low + high) if math.isfinite(low + high) else (low if low > -math.inf else high)
    inner = (middle - constant) / multiplier
    if not math.isfinite(inner):
        return bound
    if inner == bound:
        inner += math.copysign(1.0, multiplier) * (1.0 if low > -math.inf else -1.0)
    for _ in range(64):
        if low <= multiplier * bound + constant <= high:
            return bound
        bound = math.nextafter(bound, inner)
    return bound
