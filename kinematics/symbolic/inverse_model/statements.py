"""What a derivation is made of: statements that compute, and what is said about them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from kinematics.symbolic.expressions import Sum, symbols


@dataclass(frozen=True)
class Let:
    """``name = value / over``.

    Attributes:
        name: What it is called.
        value: The numerator.
        over: The denominator, of lengths alone; None for 1.
    """

    name: str
    value: Sum
    over: Sum | None = None


@dataclass(frozen=True)
class Root:
    """``name = sqrt(square)``; there is no solution where the square is negative.

    Attributes:
        name: What it is called.
        square: Under the root.
        power: The square's power of a length, for what counts as rounding: 0, 2 or 4.
        is_sum: Whether the square is a sum of squares, which is never negative.
        is_divisor: Whether there is no solution where it is 0, either.
    """

    name: str
    square: Sum
    power: int
    is_sum: bool = False
    is_divisor: bool = False


@dataclass(frozen=True)
class Branch:
    """Both signs from here on.

    Attributes:
        sign: Name of the sign, 1 or -1.
        root: Name of the root that it stands before: the signs are one where it is 0; empty for
            none.
    """

    sign: str
    root: str = ""


@dataclass(frozen=True)
class Roots:
    """All angles at which ``k0 + k1 cos + k2 sin + k3 cos² + k4 cos sin`` is 0.

    Attributes:
        name: The angle.
        coefficients: k0 to k4.
    """

    name: str
    coefficients: tuple[Sum, ...]


@dataclass(frozen=True)
class Towards:
    """``sign * atan2(y, x)``.

    Attributes:
        y: In proportion to the sine.
        x: In proportion to the cosine.
        sign: 1, -1, or a sign's name as an expression; None for 1.
    """

    y: Sum
    x: Sum
    sign: Sum | None = None


@dataclass(frozen=True)
class Angle:
    """``name = atan2(…) ± atan2(…)``; where both arguments of the first are 0, any angle does.

    Attributes:
        name: The angle.
        parts: One or two.
        power: Power of a length that the arguments of the first are.
        link: Number of the joint that is free then, from 1; None where it cannot happen.
    """

    name: str
    parts: tuple[Towards, ...]
    power: int
    link: int | None


@dataclass(frozen=True)
class Trig:
    """``C23 = cos(theta2 + theta3)``, and the sine.

    Attributes:
        label: ``23``.
        terms: Names of angles and their factors.
        constant: rad.
    """

    label: str
    terms: tuple[tuple[str, int], ...]
    constant: float


@dataclass(frozen=True)
class Upwards:
    """Sign of the first of some numbers that is not 0 beside the others.

    Attributes:
        name: The sign.
        values: The numbers; those that vanish for every target are left out.
    """

    name: str
    values: tuple[Sum, ...]


@dataclass(frozen=True)
class Posture:
    """A name of the posture.

    Attributes:
        choice: Which choice it is, from 0.
        names: The first where the rule is 0 or above, the second below.
        rule: The expression.
    """

    choice: int
    names: tuple[str, str]
    rule: Sum


@dataclass(frozen=True)
class Across:
    """The unit vector across a unit vector that is nearest to another.

    Attributes:
        names: Its components.
        of: The other; where it is along the unit vector, the next is taken: three components each.
        to: The unit vector.
        least: How small its part across may be, beside ``power`` of a length.
        power: Power of a length that it is.
    """

    names: tuple[str, str, str]
    of: tuple[tuple[Sum, Sum, Sum], ...]
    to: tuple[Sum, Sum, Sum]
    least: float
    power: int


@dataclass(frozen=True)
class Equation:
    """An equation that is shown, ``left = right``."""

    left: Sum
    right: Sum


@dataclass(frozen=True)
class Require:
    """Pairs that must be equal; else the target has no solution."""

    pairs: tuple[tuple[Sum, Sum], ...]


@dataclass(frozen=True)
class Remark:
    """A sentence."""

    text: str


Statement: TypeAlias = (
    Let
    | Root
    | Branch
    | Roots
    | Angle
    | Trig
    | Upwards
    | Posture
    | Across
    | Equation
    | Remark
    | Require
)


@dataclass
class Step:
    """A step of the derivation.

    Attributes:
        title: What it finds.
        statements: In order.
    """

    title: str
    statements: list[Statement] = field(default_factory=list)


@dataclass(frozen=True)
class Coordinate:
    """An entry of q from the angles and slides found.

    Attributes:
        name: ``q1``.
        value: In thetas and slides.
        turn: A constant that is added, rad.
        is_angle: Whether it is wrapped to (-π, π].
    """

    name: str
    value: Sum
    turn: float
    is_angle: bool


@dataclass(frozen=True)
class Derivation:
    """An inverse model.

    Attributes:
        kind: As ``ik/solutions`` has it.
        description: What was recognised, in words.
        frame: The frame whose pose is given.
        base: The frame in which it is.
        dof: Number of entries of q.
        links: Number of joints.
        target: Names of the target's elements that occur, with row and column.
        lengths: Values of the lengths that occur, m.
        size: Sum of all lengths, m: the measure of rounding.
        steps: The steps.
        coordinates: The entries of q.
        given: Of each link that may be free: its angle from the entries of q, which are named
            ``given1``, …: terms and a constant.
        postures: The choices with their names, as ``ik/solutions`` has them.
        most: Largest number of solutions.
        swivel: Name of the swivel angle that the function takes; empty where it takes none.
        ranked: The number of the entry of q by whose value solutions have the first name of the
            posture, the smallest first; 0 where that is decided by a sign.
        notes: What is to be known of it.
    """

    kind: str
    description: str
    frame: str
    base: str
    dof: int
    links: int
    target: tuple[tuple[str, int, int], ...]
    lengths: dict[str, float]
    size: float
    steps: tuple[Step, ...]
    coordinates: tuple[Coordinate, ...]
    given: dict[int, tuple[tuple[tuple[int, float], ...], float]]
    postures: tuple[tuple[str, ...], ...]
    most: int
    ranked: int = 0
    swivel: str = ""
    notes: tuple[str, ...] = ()


def symbols_of(one: Statement) -> set[str]:
    """Return the symbols that a statement reads."""
    values: list[Sum | None] = []
    if isinstance(one, Let):
        values = [one.value, one.over]
    elif isinstance(one, Root):
        values = [one.square]
    elif isinstance(one, Roots):
        values = [*one.coefficients]
    elif isinstance(one, Upwards):
        values = [*one.values]
    elif isinstance(one, Require):
        values = [value for pair in one.pairs for value in pair]
    elif isinstance(one, Across):
        values = [*one.to, *(value for vector in one.of for value in vector)]
    elif isinstance(one, Posture):
        values = [one.rule]
    elif isinstance(one, Angle):
        values = [v for part in one.parts for v in (part.y, part.x, part.sign)]
    return set().union(*(symbols(value) for value in values if value is not None))


def hoisted(step: Step) -> Step:
    """Return a step with its cosines and sines before the definitions they are used in."""
    found: list[Statement] = []
    for one in step.statements:
        place = len(found)
        if isinstance(one, Trig):
            needed = {name for name, _ in one.terms}
            while place and isinstance(found[place - 1], (Let, Equation, Remark, Trig)):
                before = found[place - 1]
                if isinstance(before, Trig) or (isinstance(before, Let) and before.name in needed):
                    break
                place -= 1
        found.insert(place, one)
    return Step(step.title, found)
