"""Builds a derivation: names what is found, defines cosines when they are needed, solves types.

The types are those of Paul's method (Paul, *Robot Manipulators*, 1981, ch. 3; numbered as in
Khalil and Dombre, *Modeling, Identification and Control of Robots*, table 4.1).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from dh_to_urdf.messages import say
from kinematics.symbolic.angles import Angle as JointAngle
from kinematics.symbolic.arrange import expanded, folded, shortest_form
from kinematics.symbolic.expressions import Sum, symbols
from kinematics.symbolic.inverse_model.arm import constant
from kinematics.symbolic.inverse_model.statements import (
    Across,
    Angle,
    Branch,
    Equation,
    Let,
    Posture,
    Remark,
    Require,
    Root,
    Roots,
    Statement,
    Step,
    Towards,
    Trig,
    Upwards,
)
from kinematics.symbolic.names import ROOTS, Kind, Names
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial
from kinematics.symbolic.steps import Rotation, Vector
from kinematics.symbolic.trigonometry import shortest

AXES = "xyz"


class InverseNames(Names):
    """Symbols of an inverse model: besides lengths and cosines, the target and what is found."""

    def __init__(self, dof: int, symbolic: bool, chosen: Mapping[str, str], *, rounded: bool):
        super().__init__(dof, symbolic, chosen, rounded=rounded)
        self.found: dict[str, int] = {}

    def fresh(self, name: str, *, is_sign: bool = False) -> str:
        """Enter a symbol, under another name where a length has this one; signs stand first."""
        while name in self.lengths or name in self.found:
            name += "_"
        self.found[name] = len(self.found) - (1000 if is_sign else 0)
        return name

    def kind(self, name: str) -> Kind:
        """Return the kind of a symbol."""
        return Kind.VARIABLE if name in self.found else super().kind(name)

    def order(self, name: str) -> tuple[int, tuple[int, ...], str]:
        """Return the sort key of a factor: what was found stands after cosines."""
        if name in self.found:
            rank = self.found[name]
            return (Kind.NUMBER if rank < 0 else len(Kind)), (rank,), name
        return super().order(name)


class Builder:
    """Steps so far.

    Attributes:
        names: The symbols.
        steps: The steps; statements go to the last.
        khalil: Whether a slide is called r.
        first_matrix: What the table's convention calls the matrix of joint 1.
    """

    def __init__(
        self, names: InverseNames, *, khalil: bool = False, first_matrix: str = "A1"
    ) -> None:
        self.first_matrix = first_matrix
        self.names = names
        self.steps: list[Step] = []
        self.khalil = khalil
        self._defined: set[str] = set()
        self._thetas: dict[int, str] = {}
        self._slides: dict[int, str] = {}

    def step(self, title: str) -> None:
        """Begin a step."""
        self.steps.append(Step(title))

    def remark(self, text: str) -> None:
        """Say something."""
        self.steps[-1].statements.append(Remark(text))

    def equation(self, left: Polynomial, right: Polynomial) -> None:
        """Show an equation."""
        self.steps[-1].statements.append(Equation(self.plain(left), self.plain(right)))

    def sum(self, p: Polynomial) -> Sum:
        """Return the shortest form of a polynomial, a positive term first."""
        return _positive_first(shortest_form(shortest(p, self.names), self.names))

    def plain(self, p: Polynomial) -> Sum:
        """Return a polynomial multiplied out, a positive term first."""
        return _positive_first(expanded(folded(p, self.names), self.names))

    def constant(self, p: Polynomial) -> float:
        """Return the value of a polynomial of lengths and numbers."""
        return constant(p, self.names)

    def is_constant(self, p: Polynomial) -> bool:
        """Return whether a polynomial is one of lengths and numbers."""
        known = self.names.lengths.keys() | self.names.numbers.keys() | ROOTS.keys()
        return p.symbols() <= known

    def sign(self, p: Polynomial) -> int:
        """Return the sign of a polynomial of lengths and numbers."""
        return -1 if self.constant(p) < 0 else 1

    def cos_sin(self, *links: tuple[int, int]) -> tuple[Polynomial, Polynomial]:
        """Return cosine and sine of a sum of angles, each a link's number and a factor."""
        return self.names.cos_sin(JointAngle(tuple(sorted(links)), 0.0))

    def let(self, name: str, p: Polynomial, over: Polynomial = ONE) -> Polynomial:
        """Return a polynomial by a name of its own, or as it is where it is one term."""
        if over == ONE and len(p) <= 1 and not isinstance(next(iter(p.terms.values()), 0), float):
            return p
        return self.define(name, p, over)

    def define(self, name: str, p: Polynomial, over: Polynomial = ONE) -> Polynomial:
        """Return a polynomial by a name of its own."""
        value, below = self.sum(p), None
        if over != ONE:
            divided = self.sum(over)
            below = None if divided == self.sum(ONE) else divided
        name = self._added(name, lambda fresh: Let(fresh, value, below), value, below)
        return Polynomial.symbol(name)

    def root(
        self,
        name: str,
        square: Polynomial,
        power: int,
        *,
        plain: bool = False,
        is_sum: bool = False,
        is_divisor: bool = False,
    ) -> Polynomial:
        """Return a square root that must be real; ``plain`` leaves 1 - C² as it is."""
        value = self.plain(square) if plain else self.sum(square)
        name = self._added(name, lambda fresh: Root(fresh, value, power, is_sum, is_divisor), value)
        return Polynomial.symbol(name)

    def branch(self, sign: str, root: Polynomial | None = None) -> Polynomial:
        """Go on with both signs."""
        over = "" if root is None else next(iter(root.symbols()))
        sign = self.names.fresh(sign, is_sign=True)
        self.steps[-1].statements.append(Branch(sign, over))
        return Polynomial.symbol(sign)

    def roots(self, link: int, coefficients: Iterable[Polynomial]) -> None:
        """Go on with each angle at which ``k0 + k1 C + k2 S + k3 C² + k4 C S`` is 0."""
        names = [f"k{link}{letter}" for letter in "abcde"]
        found = [self.let(name, p) for name, p in zip(names, coefficients, strict=True)]
        values = tuple(self.sum(p) for p in found)
        self._thetas[link] = self._added(
            f"theta{link}", lambda fresh: Roots(fresh, values), *values
        )

    def angle(
        self,
        link: int,
        *parts: tuple[Polynomial, Polynomial, Polynomial],
        power: int,
        free: bool = True,
    ) -> None:
        """Find an angle from parts ``sign * atan2(y, x)``, given as (sign, y, x)."""
        towards = tuple(
            Towards(self.sum(y), self.sum(x), None if sign == ONE else self.sum(sign))
            for sign, y, x in parts
        )
        used = [one for part in towards for one in (part.y, part.x, part.sign)]
        self._thetas[link] = self._added(
            f"theta{link}",
            lambda fresh: Angle(fresh, towards, power, link if free else None),
            *used,
        )

    def sum_of_angles(self, link: int, p: Polynomial) -> None:
        """Find an angle as a sum of others."""
        value = self.sum(p)
        name = self._added(f"theta{link}", lambda fresh: Let(fresh, value), value)
        self._thetas[link] = name

    def theta(self, link: int) -> Polynomial:
        """Return an angle that was found."""
        return Polynomial.symbol(self._thetas[link])

    def upwards(self, name: str, values: Iterable[Polynomial]) -> Polynomial:
        """Return the sign of the first of some numbers that is not 0."""
        found = tuple(self.sum(p) for p in values)
        found = tuple(one for one in found if one.terms)
        name = self._added(name, lambda fresh: Upwards(fresh, found), *found)
        return Polynomial.symbol(name)

    def across(
        self, name: str, of: Iterable[Vector], to: Vector, least: float, power: int
    ) -> Vector:
        """Return the unit vector across another that is nearest to the first of some vectors."""
        given = [(self.sum(x), self.sum(y), self.sum(z)) for x, y, z in of]
        axis = self.sum(to[0]), self.sum(to[1]), self.sum(to[2])
        self._require(*axis, *(value for one in given for value in one))
        x, y, z = (self.names.fresh(f"{name}{a}") for a in AXES)
        self.steps[-1].statements.append(Across((x, y, z), tuple(given), axis, least, power))
        return Polynomial.symbol(x), Polynomial.symbol(y), Polynomial.symbol(z)

    def require(self, *pairs: tuple[Polynomial, Polynomial]) -> None:
        """Go on only where the two of each pair are equal, which are of the size of 1."""
        found = tuple((self.sum(left), self.sum(right)) for left, right in pairs)
        self._require(*(value for pair in found for value in pair))
        self.steps[-1].statements.append(Require(found))

    def turn(self, label: str, angle: str) -> tuple[Polynomial, Polynomial]:
        """Return cosine and sine, under a label, of an angle that is given."""
        cosine, sine = (Polynomial.symbol(self.names.fresh(f"{one}{label}")) for one in "CS")
        self.steps[-1].statements.append(Trig(label, ((angle, 1),), 0.0))
        return cosine, sine

    def posture(self, choice: int, names: tuple[str, str], rule: Polynomial) -> None:
        """Name a posture."""
        value = self.sum(rule)
        self._added("", lambda _: Posture(choice, names, value), value)

    def slide(self, link: int, p: Polynomial, over: Polynomial = ONE) -> Polynomial:
        """Find a slide, a quotient."""
        if over == -ONE:
            p, over = -p, ONE
        value, name = self.sum(p), self.slide_name(link)
        below = None if self.sum(over) == self.sum(ONE) else self.sum(over)
        self._require(value)
        self.steps[-1].statements.append(Let(name, value, below))
        return Polynomial.symbol(name)

    def slide_name(self, link: int) -> str:
        """Return the name of a slide: d3, in Khalil's convention r3."""
        if link not in self._slides:
            self._slides[link] = self.names.fresh(f"{'r' if self.khalil else 'd'}{link}")
        return self._slides[link]

    def sine_cosine(
        self,
        link: int,
        x: Polynomial,
        y: Polynomial,
        z: Polynomial,
        power: int,
        orient: Polynomial,
        sign: str,
        *,
        fails: str = "",
        free: str = "",
    ) -> Polynomial:
        """Solve ``x sin θ + y cos θ = z``, type 2, with both signs; return the sign.

        Of the solutions, ``x cos θ - y sin θ`` has the sign ``-orient * sign``.

        Args:
            link: Whose angle it is.
            x: Factor of the sine.
            y: Factor of the cosine.
            z: Right-hand side.
            power: Power of a length that the three are.
            orient: 1 or -1, or a sign that was found.
            sign: Name for the sign.
            fails: What it means that the root is not real.
            free: What it means that x and y are both 0.
        """
        C, S = (f"{letter}{link}" for letter in "CS")
        alone = (not x and self.is_constant(y)) or (not y and self.is_constant(x))
        if alone:
            turned, over = (C, y) if not x else (S, x)
            factor, value = over, z
            if self.sum(over).terms[0].coefficient < 0:
                factor, value = -over, -z
            self.remark(
                say("The cosine alone is known: both signs of the sine.")
                if not x
                else say("The sine alone is known: both signs of the cosine.")
            )
            known = self._define_trig(turned, value, factor)
            self._remark(fails)
            w = self.root(f"w{link}", ONE - known * known, 0, plain=True)
            e = self.branch(sign, w)
            side = orient.scaled(self.sign(over) * (1 if not x else -1))
            other = self._define_trig(S if not x else C, side * e * w, ONE)
            sine, cosine = (other, known) if not x else (known, other)
            self.angle(link, (ONE, sine, cosine), power=0, free=False)
            return e
        self._say_type_2(link, z)
        x, y, z = (self._coefficient(f"{a}{link}", p) for a, p in zip(AXES, (x, y, z), strict=True))
        self._remark(fails)
        is_sum = not z
        w = self.root(f"w{link}", x * x + y * y - z * z, 2 * power, is_sum=is_sum)
        e = self.branch(sign, w)
        self._remark(free)
        if is_sum:
            self.angle(link, (ONE, orient * e * y, -(orient * e * x)), power=power)
        else:
            self.angle(link, (ONE, x, y), (orient * e, w, z), power=power)
        return e

    def _say_type_2(self, link: int, z: Polynomial) -> None:
        angle = f"theta{link}"
        if not z:
            self.remark(
                say("Type 2 with z = 0, x sin {angle} + y cos {angle} = 0: the ratio.", angle=angle)
            )
            return
        self.remark(say("Type 2, x sin {angle} + y cos {angle} = z, solved by", angle=angle))
        self.remark(
            say(
                "{angle} = atan2(x, y) +- atan2(w, z) with w the root of x*x + y*y - z*z.",
                angle=angle,
            )
        )

    def _remark(self, text: str) -> None:
        if text:
            self.remark(text)

    def _coefficient(self, name: str, p: Polynomial) -> Polynomial:
        """Return a factor by a name of its own, but for one symbol or number and 0."""
        if not p:
            return p
        if len(p) == 1:
            ((monomial, value),) = p.terms.items()
            if abs(value) == 1 and sum(exponent for _, exponent in monomial) <= 1:
                return p
        return self.define(name, p)

    def _define_trig(self, name: str, p: Polynomial, over: Polynomial) -> Polynomial:
        """Return C3 or S3 itself as what is found; its angle follows."""
        label = name[1:]
        cosine, _ = self.cos_sin((int(label), 1))
        del cosine  # enters the label
        value, below = self.sum(p), None if over == ONE else self.sum(over)
        self._require(value, below)
        self.steps[-1].statements.append(Let(name, value, below))
        self._defined.add(name)
        return Polynomial.symbol(name)

    def two_equations(
        self,
        link: int,
        factors: tuple[Polynomial, Polynomial],
        values: tuple[Polynomial, Polynomial],
        power: int,
        free: str = "",
    ) -> None:
        """Solve ``k1 C - k2 S = v1, k1 S + k2 C = v2``, type 3: one solution."""
        (k1, k2), (v1, v2) = factors, values
        self.remark(say("Type 3, two equations in sine and cosine: one angle."))
        self._remark(free)
        self.angle(link, (ONE, k1 * v2 - k2 * v1, k1 * v1 + k2 * v2), power=power)

    def _added(self, name: str, make: object, *used: Sum | None) -> str:
        self._require(*used)
        fresh = self.names.fresh(name) if name else ""
        self.steps[-1].statements.append(make(fresh))  # type: ignore[operator]
        return fresh

    def _require(self, *used: Sum | None) -> None:
        """Define the cosines and sines that expressions use, from angles that are known."""
        names = set().union(*(symbols(one) for one in used if one is not None))
        turning = [n for n in names if self.names.kind(n) is Kind.TRIGONOMETRIC]
        missing = {name[1:] for name in turning if name not in self._defined}
        for label in sorted(missing, key=lambda one: self.names.order(f"C{one}")):
            angle = self.names.angles[label]
            terms = tuple((self._thetas[link], n) for link, n in angle.multiples)
            statement: Statement = Trig(label, terms, angle.constant)
            self.steps[-1].statements.append(statement)
            self._defined |= {f"C{label}", f"S{label}"}


def _positive_first(value: Sum) -> Sum:
    """Return a sum that starts with a minus sign only where every term has one."""
    if not value.terms or value.terms[0].coefficient > 0:
        return value
    return Sum(tuple(sorted(value.terms, key=lambda term: term.coefficient < 0)))


def vector(x: Polynomial, y: Polynomial, z: Polynomial) -> Vector:
    """Return a vector."""
    return x, y, z


def turned_back(c: Polynomial, s: Polynomial, v: Vector) -> Vector:
    """Return ``Rz(-θ) v``."""
    return (c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])


def about_z(c: Polynomial, s: Polynomial, v: Vector) -> Vector:
    """Return ``Rz(θ) v``."""
    return (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])


def about_x(c: Polynomial, s: Polynomial, v: Vector) -> Vector:
    """Return ``Rx(α) v``."""
    return (v[0], c * v[1] - s * v[2], s * v[1] + c * v[2])


def twist(names: Names, alpha: float) -> tuple[Polynomial, Polynomial]:
    """Return cosine and sine of a twist."""
    return names.cos_sin(JointAngle((), alpha))


def transposed(R: Rotation, v: Vector) -> Vector:
    """Return ``Rᵀ v``, of the columns of R."""
    x, y, z = (a[0] * v[0] + a[1] * v[1] + a[2] * v[2] for a in R)
    return x, y, z


def flat(alpha: float) -> int:
    """Return cos α of a twist that is 0 or π; 0 of any other."""
    if abs(math.sin(alpha)) > 1e-12:
        return 0
    return 1 if math.cos(alpha) > 0 else -1


__all__ = [
    "ZERO",
    "Builder",
    "InverseNames",
    "about_x",
    "about_z",
    "flat",
    "transposed",
    "turned_back",
    "twist",
    "vector",
]
