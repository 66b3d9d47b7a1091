"""A derivation as a function that runs alone: the statements, and what is said as comments."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.angles import turn_text
from kinematics.symbolic.expressions import Sum, symbols
from kinematics.symbolic.inverse_model.notation import Style
from kinematics.symbolic.inverse_model.statements import (
    Across,
    Angle,
    Branch,
    Derivation,
    Equation,
    Let,
    Posture,
    Remark,
    Require,
    Root,
    Roots,
    Statement,
    Trig,
    Upwards,
    symbols_of,
)

_INDENT = "    "


class Code:
    """Source of one function; languages derive from it.

    Attributes:
        derivation: What is written.
        lines: Lines of the body so far.
        depth: Blocks around the next line.
    """

    style: Style
    comment_mark: str
    comment_end = ""

    def __init__(self, derivation: Derivation) -> None:
        self.derivation = derivation
        self.lines: list[str] = []
        self.depth = 1
        self.used: set[str] = set()
        self.in_loop = 0
        self.free: list[int] = []

    def source(self) -> str:
        """Return the file."""
        for number, step in enumerate(self.derivation.steps, start=1):
            self.put("")
            self.comment(chained("", (f"{number}. ", step.title)))
            for statement in step.statements:
                self.statement(statement)
        self.put("")
        self.comment(say("The joint coordinates"))
        self.solution()
        self.close_all()
        if self.derivation.ranked:
            self.put("")
            self.comment(say("Names by the order of q{joint}", joint=self.derivation.ranked))
            self.ranks()
        return chained("\n", (*self.head(), *self.lines, *self.tail(), ""))

    def head(self) -> list[str]:
        """Return the lines before the body."""
        raise NotImplementedError

    def tail(self) -> list[str]:
        """Return the lines after it."""
        raise NotImplementedError

    def put(self, line: str) -> None:
        """Add a line."""
        self.lines.append(f"{_INDENT * self.depth}{line}" if line else "")

    def comment(self, text: str) -> None:
        """Add a comment."""
        start = f"{_INDENT * self.depth}{self.comment_mark} "
        self.lines.append(chained("", (start, text, self.comment_end)))

    def about(self) -> list[str]:
        """Return what the function does, in sentences."""
        d = self.derivation
        return [
            say("All q that bring {frame} to T in {base}; rad and m.", frame=d.frame, base=d.base),
            chained("", (d.description, ".")),
            say("given: q of joints that are free in a singular posture."),
        ]

    def lengths(self) -> list[tuple[str, float]]:
        """Return the lengths that occur."""
        return [(n, v) for n, v in self.derivation.lengths.items() if n in self.used]

    def elements(self) -> list[tuple[str, int, int]]:
        """Return the elements of the target that occur, with row and column."""
        return [one for one in self.derivation.target if one[0] in self.used]

    def has(self, kind: type) -> bool:
        """Return whether a kind of statement occurs."""
        return any(
            isinstance(one, kind) for step in self.derivation.steps for one in step.statements
        )

    def statement(self, one: Statement) -> None:
        """Add a statement."""
        self.used |= symbols_of(one)
        if isinstance(one, Remark):
            self.comment(one.text)
        elif isinstance(one, Equation):
            self.comment(f"    {self.style.sum(one.left)} = {self.style.sum(one.right)}")
        elif isinstance(one, Let):
            self.define(one.name, self.style.let(one))
        elif isinstance(one, Root):
            size = {0: "1", 2: "size*size", 4: "size*size*size*size"}[one.power]
            if one.is_sum:
                size = f"1e-11*{size}" if one.power else "1e-11"
            self.root(one, size)
        elif isinstance(one, Branch):
            self.branch(one)
            self.depth += 1
        elif isinstance(one, Trig):
            self.trig(one)
        elif isinstance(one, Upwards):
            self.upwards(one)
        elif isinstance(one, Posture):
            self.posture(one)
        elif isinstance(one, Require):
            self.require([self.difference(*pair) for pair in one.pairs])
        elif isinstance(one, Across):
            self.across(one, f"{one.least!r}{'*size' * one.power}")
        elif isinstance(one, Angle):
            self.angle(one)
        else:
            assert isinstance(one, Roots)
            self.roots(one)
            self.depth += 1

    def angle(self, one: Angle) -> None:
        """Add an angle that may be free."""
        if one.link is None:
            self.define(one.name, self.style.angle(one))
            return
        self.free.append(one.link)
        first = one.parts[0]
        y, x = self.style.sum(first.y), self.style.sum(first.x)
        size = {0: "", 1: "*size", 2: "*size*size"}[one.power]
        self.angle_or_given(one, f"hypot({y}, {x}) <= 1e-12{size}")

    def given(self, link: int, index: str) -> str:
        """Return the angle of a link from the given q; ``index`` formats an entry's number."""
        terms, constant = self.derivation.given[link]
        parts = [
            index.format(k=k, k0=k - 1) if n == 1 else f"{n!r}*{index.format(k=k, k0=k - 1)}"
            for k, n in terms
        ]
        return " + ".join([*parts, *([repr(constant)] if constant else [])])

    def entries(self, pi: str, given: str, wrap: str) -> list[str]:
        """Return the entries of q."""
        known = {int(one.name[1:]): one for one in self.derivation.coordinates}
        found = []
        for number in range(1, self.derivation.dof + 1):
            one = known.get(number)
            if one is None:
                found.append(given.format(k=number, k0=number - 1))
                continue
            self.used |= symbols(one.value)
            value = self.style.coordinate(one, turn_in(one.turn, pi))
            found.append(wrap.format(value) if one.is_angle else value)
        return found

    def define(self, name: str, value: str) -> None:
        """Add ``name = value``."""
        raise NotImplementedError

    def root(self, one: Root, size: str) -> None:
        """Add a root."""
        raise NotImplementedError

    def branch(self, one: Branch) -> None:
        """Open a loop over both signs."""
        raise NotImplementedError

    def roots(self, one: Roots) -> None:
        """Open a loop over the roots of a trigonometric polynomial."""
        raise NotImplementedError

    def trig(self, one: Trig) -> None:
        """Add a cosine and a sine."""
        raise NotImplementedError

    def upwards(self, one: Upwards) -> None:
        """Add the sign of the first number that is not 0."""
        raise NotImplementedError

    def posture(self, one: Posture) -> None:
        """Add a name of the posture."""
        raise NotImplementedError

    def across(self, one: Across, least: str) -> None:
        """Add the unit vector across another."""
        raise NotImplementedError

    def require(self, values: list[str]) -> None:
        """Add the end of the search where numbers are not 0."""
        raise NotImplementedError

    def difference(self, left: Sum, right: Sum) -> str:
        """Return a difference as text."""
        known = self.style.sum(right)
        if known == "0":
            return self.style.sum(left)
        sign, size = ("+", known[1:]) if known.startswith("-") else ("-", known)
        return f"{self.style.sum(left)} {sign} {size}"

    def vectors(self, one: Across, opening: str, closing: str) -> list[str]:
        """Return the vectors of a statement, the unit vector first."""
        return [
            f"{opening}{', '.join(map(self.style.sum, vector))}{closing}"
            for vector in (one.to, *one.of)
        ]

    def angle_or_given(self, one: Angle, is_free: str) -> None:
        """Add an angle, or the given one where it is free."""
        raise NotImplementedError

    def solution(self) -> None:
        """Add what keeps a solution."""
        raise NotImplementedError

    def close_all(self) -> None:
        """Close all blocks."""
        raise NotImplementedError

    def ranks(self) -> None:
        """Add what gives the first names by the order of an entry of q."""
        raise NotImplementedError

    def named(self) -> list[str]:
        """Return the variables with the names of the posture, as strings of Python."""
        d = self.derivation
        found = [f"posture{k + 1}" for k in range(len(d.postures))]
        if d.ranked:
            found[0] = ""
        return [
            name for name, names in zip(found, d.postures, strict=True) if name == "" or names[0]
        ]


def turn_in(turn: float, pi: str) -> str:
    """Return the size of a constant turn: a number, or by π where a language has it."""
    found = turn_text(abs(turn))
    return found.replace("pi", pi) if pi and "pi" in found else repr(abs(turn))
