"""A derivation as a module of Python that needs ``math`` alone."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.inverse_model.code import Code
from kinematics.symbolic.inverse_model.notation import PYTHON
from kinematics.symbolic.inverse_model.statements import (
    Across,
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


_ACROSS = '''
def across(n, least, *vectors):
    """Return the unit vector across the unit vector n nearest to the first that is not along it."""
    for v in vectors:
        along = sum(a*b for a, b in zip(v, n))
        part = [a - along*b for a, b in zip(v, n)]
        if hypot(*part) > least:
            break
    return [a/hypot(*part) for a in part]
'''


class Python(Code):
    """Writes Python."""

    style = PYTHON
    comment_mark = "#"

    def head(self) -> list[str]:
        """Return the lines before the body."""
        d = self.derivation
        lengths = "".join(f", {name}={value!r}" for name, value in self.lengths())
        helpers = [
            _ROOT,
            *([_UPWARDS] if self.has(Upwards) else []),
            *([_ROOTS] if self.has(Roots) else []),
            *([_ACROSS] if self.has(Across) else []),
        ]
        swivel = f", {d.swivel}=0.0" if d.swivel else ""
        first, *more = self.about()
        return [
            "from math import atan2, cos, hypot, pi, sin, sqrt",
            *(line for part in helpers for line in f"\n{part}".splitlines()),
            "",
            "",
            f"def inverse_model(T{lengths}, given=(0,) * {d.dof}{swivel}):",
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

    def tail(self) -> list[str]:
        """Return the lines after it."""
        return ["    return solutions"]

    def define(self, name: str, value: str) -> None:
        """Add ``name = value``."""
        self.put(f"{name} = {value}")

    def root(self, one: Root, size: str) -> None:
        """Add a root."""
        self.put(f"{one.name} = root({self.style.sum(one.square)}, {size})")
        self.put(f"if not {one.name}:" if one.is_divisor else f"if {one.name} is None:")
        self.put("    continue" if self.in_loop else "    return solutions")

    def branch(self, one: Branch) -> None:
        """Open a loop over both signs."""
        over = f"signs({one.root})" if one.root else "(1, -1)"
        self.put(f"for {one.sign} in {over}:")
        self.in_loop += 1

    def roots(self, one: Roots) -> None:
        """Open a loop over the roots of a trigonometric polynomial."""
        values = ", ".join(map(self.style.sum, one.coefficients))
        self.put(f"for {one.name} in angles({values}):")
        self.in_loop += 1

    def trig(self, one: Trig) -> None:
        """Add a cosine and a sine."""
        argument = self.style.argument(one)
        self.put(f"C{one.label}, S{one.label} = cos({argument}), sin({argument})")

    def upwards(self, one: Upwards) -> None:
        """Add the sign of the first number that is not 0."""
        self.put(f"{one.name} = first_sign({', '.join(map(self.style.sum, one.values))})")

    def posture(self, one: Posture) -> None:
        """Add a name of the posture."""
        rule, name = self.style.sum(one.rule), f"posture{one.choice + 1}"
        self.put(f'{name} = "{one.names[0]}" if {rule} >= 0 else "{one.names[1]}"')

    def require(self, values: list[str]) -> None:
        """Add the end of the search where numbers are not 0."""
        self.put(f"if hypot({', '.join(values)}) > 1e-9:")
        self.put("    return solutions")

    def across(self, one: Across, least: str) -> None:
        """Add the unit vector across another."""
        to, *of = self.vectors(one, "(", ")")
        self.put(f"{', '.join(one.names)} = across({to}, {least}, {', '.join(of)})")

    def angle_or_given(self, one: Angle, is_free: str) -> None:
        """Add an angle, or the given one where it is free."""
        self.put(f"free{one.link} = {is_free}")
        given = self.given(one.link or 0, "given[{k0}]")
        self.put(f"{one.name} = {given} if free{one.link} else {self.style.angle(one)}")

    def solution(self) -> None:
        """Add what keeps a solution."""
        for number, value in enumerate(self.entries("pi", "given[{k0}]", "wrap({})"), start=1):
            self.put(f"q{number} = {value}")
        q = ", ".join(f"q{k}" for k in range(1, self.derivation.dof + 1))
        names = ", ".join(name or '""' for name in self.named())
        pairs = ", ".join(f"{link}: free{link}" for link in sorted(self.free))
        self.put("solutions.append({")
        self.put(f'    "q": [{q}],')
        self.put(f'    "posture": [{names}],')
        self.put(f'    "free": [k for k, is_free in {{{pairs}}}.items() if is_free],')
        self.put("})")

    def close_all(self) -> None:
        """Close all blocks."""
        self.depth = 1

    def ranks(self) -> None:
        """Add what gives the first names by the order of an entry of q."""
        k = self.derivation.ranked - 1
        names = ", ".join(f'"{name}"' for name in self.derivation.postures[0])
        self.put(f'values = sorted(one["q"][{k}] for one in solutions)')
        self.put("values = [b for a, b in zip([-9, *values], values) if b - a > 1e-7]")
        self.put("for one in solutions:")
        self.put(f'    rank = sum(value < one["q"][{k}] - 1e-7 for value in values)')
        self.put(f'    one["posture"][0] = ({names})[rank]')


_ROOTS = '''
def real_roots(p):
    """Return the real roots of a polynomial, highest power first, each once."""
    n = len(p) - 1
    if n == 1:
        return [-p[1]/p[0]]

    def value(t):
        total = 0.0
        for c in p:
            total = total*t + c
        return total

    turning = real_roots([(n - i)*c for i, c in enumerate(p[:-1])])
    bound = 1 + max(abs(c/p[0]) for c in p)
    ends, found = [-bound, *turning, bound], []
    scale = sum(abs(c) for c in p)
    for low, high in zip(ends, ends[1:]):
        if abs(value(high)) <= 1e-14*scale*max(1, abs(high))**n:
            found.append(high)
        elif value(low)*value(high) < 0:
            if value(low) > 0:
                low, high = high, low
            for _ in range(200):
                middle = (low + high)/2
                if middle in (low, high):
                    break
                low, high = (middle, high) if value(middle) < 0 else (low, middle)
            found.append((low + high)/2)
    return found


def angles(k0, k1, k2, k3, k4):
    """Return all angles with k0 + k1 cos + k2 sin + k3 cos^2 + k4 cos sin = 0."""
    def value(a):
        return k0 + k1*cos(a) + k2*sin(a) + cos(a)*(k3*cos(a) + k4*sin(a))

    # t = tan((a - s)/2), with s so that a = s + pi, where t has no value, is far from a solution
    s = max((n*pi/8 for n in range(16)), key=lambda a: abs(value(a + pi)))
    mean = k0 + k3/2
    a, b = k1*cos(s) + k2*sin(s), k2*cos(s) - k1*sin(s)
    c, d = (k3*cos(2*s) + k4*sin(2*s))/2, (k4*cos(2*s) - k3*sin(2*s))/2
    p = [mean - a + c, 2*b - 4*d, 2*mean - 6*c, 2*b + 4*d, mean + a + c]
    return [wrap(2*atan2(t, 1) + s) for t in real_roots(p)] if p[0] else []
'''
