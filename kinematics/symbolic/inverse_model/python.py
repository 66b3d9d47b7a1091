"""A derivation as a module of Python that needs ``math`` alone."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.inverse_model.code import Code
from kinematics.symbolic.inverse_model.notation import PYTHON
from kinematics.symbolic.inverse_model.statements import (
    Angle,
    Branch,
    Posture,
    Root,
    Roots,
    Trig,
    Upwards,
)

_ROOT = '''
def root(square, size):
    """Return the square root, 0 where only rounding is left, None of a negative number."""
    if abs(square) <= 1e-13*size:
        return 0.0
    return sqrt(square) if square > 0 else None


def signs(root):
    """Return both signs; one where they make no difference."""
    return (1, -1) if root > 0 else (1,)


def wrap(angle):
    """Return an angle in (-pi, pi]."""
    return atan2(sin(angle), cos(angle))
'''
_UPWARDS = '''
def first_sign(*values):
    """Return the sign of the first value that is not 0 beside the others."""
    least = 1e-9*hypot(*values)
    return next((1 if value > 0 else -1 for value in values if abs(value) > least), 1)
'''


class Python(Code):
    """Writes Python."""

    style = PYTHON
    comment_mark = "#"

    def head(self) -> list[str]:
        d = self.derivation
        lengths = "".join(f", {name}={value!r}" for name, value in self.lengths())
        helpers = [_ROOT, *([_UPWARDS] if self.has(Upwards) else []), *self.polynomials()]
        first, *more = self.about()
        return [
            "from math import atan2, cos, hypot, pi, sin, sqrt",
            *(line for part in helpers for line in f"\n{part}".splitlines()),
            "",
            "",
            f"def inverse_model(T{lengths}, given=(0,) * {d.dof}):",
            chained("", ('    """', first)),
            "",
            *(chained("", ("    ", one)) for one in more),
            chained(
                "", ("    ", say("Returns a list of q, names of the posture, and free joints."))
            ),
            '    """',
            f"    size = {d.size!r}",
            *(f"    {name} = T[{row}][{column}]" for name, row, column in self.elements()),
            "    solutions = []",
        ]

    def polynomials(self) -> list[str]:
        return [_ROOTS] if self.has(Roots) else []

    def tail(self) -> list[str]:
        return ["    return solutions"]

    def define(self, name: str, value: str) -> None:
        self.put(f"{name} = {value}")

    def root(self, one: Root, size: str) -> None:
        self.put(f"{one.name} = root({self.style.sum(one.square)}, {size})")
        self.put(f"if {one.name} is None:")
        self.put("    continue" if self.in_loop else "    return solutions")

    def branch(self, one: Branch) -> None:
        over = f"signs({one.root})" if one.root else "(1, -1)"
        self.put(f"for {one.sign} in {over}:")
        self.in_loop += 1

    def roots(self, one: Roots) -> None:
        values = ", ".join(map(self.style.sum, one.coefficients))
        self.put(f"for {one.rank}, {one.name} in enumerate(angles({values})):")
        self.in_loop += 1

    def trig(self, one: Trig) -> None:
        argument = self.style.argument(one)
        self.put(f"C{one.label}, S{one.label} = cos({argument}), sin({argument})")

    def upwards(self, one: Upwards) -> None:
        self.put(f"{one.name} = first_sign({', '.join(map(self.style.sum, one.values))})")

    def posture(self, one: Posture) -> None:
        rule, name = self.style.sum(one.rule), f"posture{one.choice + 1}"
        if one.is_rank:
            self.put(f"{name} = {list(one.names)!r}[{rule}]".replace("'", '"'))
        else:
            self.put(f'{name} = "{one.names[0]}" if {rule} >= 0 else "{one.names[1]}"')

    def angle_or_given(self, one: Angle, is_free: str) -> None:
        self.put(f"free{one.link} = {is_free}")
        given = self.given(one.link or 0, "given[{k0}]")
        self.put(f"{one.name} = {given} if free{one.link} else {self.style.angle(one)}")

    def solution(self) -> None:
        for number, value in enumerate(self.entries("pi", "given[{k0}]", "wrap({})"), start=1):
            self.put(f"q{number} = {value}")
        q = ", ".join(f"q{k}" for k in range(1, self.derivation.dof + 1))
        names = ", ".join(f"posture{k + 1}" for k in range(len(self.derivation.postures)))
        pairs = ", ".join(f"{link}: free{link}" for link in sorted(self.free))
        self.put("solutions.append({")
        self.put(f'    "q": [{q}],')
        self.put(f'    "posture": [{names}],')
        self.put(f'    "free": [k for k, is_free in {{{pairs}}}.items() if is_free],')
        self.put("})")

    def close_all(self) -> None:
        self.depth = 1


_ROOTS = ""
