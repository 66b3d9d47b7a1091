"""A derivation as a module of Python that needs ``math`` alone."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.expressions import Sum, symbols, text
from kinematics.symbolic.inverse_model.statements import (
    Angle,
    Branch,
    Derivation,
    Equation,
    Let,
    Posture,
    Remark,
    Root,
    Roots,
    Statement,
    Trig,
    Upwards,
)
from kinematics.symbolic.inverse_model.text import angle, coordinate, divided, factor, trig

HELPERS = '''TINY = 1e-13  # below it, relative to the arm, a number is rounding


def root(square, size):
    """The square root; 0 for rounding, None for a negative number."""
    if abs(square) <= TINY * size:
        return 0.0
    return sqrt(square) if square > 0 else None


def signs(root):
    return (1, -1) if root > 0 else (1,)
'''
UPWARDS = '''

def first_sign(*values):
    """The sign of the first value that is not 0 beside the others."""
    least = 1e-9 * hypot(*values)
    return next((1 if value > 0 else -1 for value in values if abs(value) > least), 1)
'''


def python_source(derivation: Derivation) -> str:
    """Return the module."""
    return _Python(derivation).module()


class _Python:
    def __init__(self, derivation: Derivation) -> None:
        self.derivation = derivation
        self.lines: list[str] = []
        self.depth = 1
        self.used: set[str] = set()

    def module(self) -> str:
        d = self.derivation
        for number, step in enumerate(d.steps, start=1):
            self._comment(chained("", (f"{number}. ", step.title)))
            for statement in step.statements:
                self._statement(statement)
        self._solution()
        body = self.lines
        statements = [one for step in d.steps for one in step.statements]
        lengths = "".join(
            f", {name}={value!r}" for name, value in d.lengths.items() if name in self.used
        )
        free = self._free()
        head: list[str] = [
            "from math import atan2, cos, hypot, pi, sin, sqrt",
            "",
            *HELPERS.splitlines(),
            *(UPWARDS.splitlines() if any(isinstance(s, Upwards) for s in statements) else []),
            "",
            "",
            f"def inverse_model(T{lengths}, given=(0.0,) * {d.dof}):",
            chained("", ('    """', say(
                "All q that bring {frame} to T, 4x4 in {base}: a list of q, posture and free"
                " joints, rad and m.", frame=d.frame, base=d.base))),
            "",
            chained("", ("    ", d.description, ".")),
            chained("", ("    ", say("given: values for joints that are free in a singular"
                " posture.") , '"""')),
            f"    size = {d.size!r}",
        ]
        head += [
            f"    {name} = T[{row}][{column}]"
            for name, row, column in d.target
            if name in self.used
        ]
        head.append("    solutions = []")
        del free
        return chained("\n", (*head, *body, "    return solutions", ""))

    def _free(self) -> list[int]:
        return [
            one.link
            for step in self.derivation.steps
            for one in step.statements
            if isinstance(one, Angle) and one.link is not None
        ]

    def _put(self, line: str) -> None:
        self.lines.append(f"{'    ' * self.depth}{line}")

    def _comment(self, text_: str) -> None:
        self.lines.append(chained("", ("    " * self.depth + "# ", text_)))

    def _use(self, *values: Sum | None) -> None:
        for value in values:
            if value is not None:
                self.used |= symbols(value)

    def _leave(self) -> str:
        return "return solutions" if self.depth == 1 else "continue"

    def _statement(self, one: Statement) -> None:
        if isinstance(one, Remark):
            self._comment(one.text)
        elif isinstance(one, Equation):
            self._comment(f"{text(one.left)} = {text(one.right)}")
        elif isinstance(one, Let):
            self._use(one.value, one.over)
            self._put(f"{one.name} = {divided(one.value, one.over)}")
        elif isinstance(one, Root):
            self._use(one.square)
            size = {0: "1.0", 2: "size**2", 4: "size**4"}[one.power]
            self._put(f"{one.name} = root({text(one.square)}, {size})")
            self._put(f"if {one.name} is None:")
            self._put(f"    {self._leave()}")
        elif isinstance(one, Branch):
            over = f"signs({one.root})" if one.root else "(1, -1)"
            self._put(f"for {one.sign} in {over}:")
            self.depth += 1
        elif isinstance(one, Trig):
            self._put(f"C{one.label}, S{one.label} = cos({trig(one)}), sin({trig(one)})")
        elif isinstance(one, Upwards):
            self._use(*one.values)
            self._put(f"{one.name} = first_sign({', '.join(map(text, one.values))})")
        elif isinstance(one, Posture):
            self._use(one.rule)
            first, second = one.names
            self._put(
                f'posture{one.choice + 1} = "{first}" if {text(one.rule)} >= 0 else "{second}"'
            )
        elif isinstance(one, Angle):
            self._angle(one)
        else:
            assert isinstance(one, Roots)
            raise NotImplementedError

    def _angle(self, one: Angle) -> None:
        for part in one.parts:
            self._use(part.y, part.x, part.sign)
        if one.link is None:
            self._put(f"{one.name} = {angle(one)}")
            return
        first = one.parts[0]
        size = {0: "1.0", 1: "size", 2: "size**2"}[one.power]
        self._put(
            f"free{one.link} = hypot({text(first.y)}, {text(first.x)}) <= 1e-12 * {size}"
        )
        terms, constant = self.derivation.given[one.link]
        given = " + ".join(
            [*(f"{n!r}*given[{k - 1}]" if n != 1 else f"given[{k - 1}]" for k, n in terms)]
            + ([repr(constant)] if constant else [])
        )
        self._put(f"{one.name} = {given} if free{one.link} else {angle(one)}")

    def _solution(self) -> None:
        d = self.derivation
        entries = {int(one.name[1:]): one for one in d.coordinates}
        values = []
        for number in range(1, d.dof + 1):
            one = entries.get(number)
            if one is None:
                values.append(f"given[{number - 1}]")
                continue
            self._use(one.value)
            value = coordinate(one)
            values.append(f"atan2(sin({value}), cos({value}))" if one.is_angle else value)
        self._comment(say("the joint coordinates"))
        self._put(f"q = [{', '.join(values)}]")
        names = ", ".join(f"posture{k + 1}" for k in range(len(d.postures)))
        pairs = ", ".join(f"({link}, free{link})" for link in self._free())
        self._put(f"free = [k for k, is_free in ({pairs}{',' if pairs else ''}) if is_free]")
        self._put(f'solutions.append({{"q": q, "posture": [{names}], "free": free}})')


__all__ = ["factor", "python_source"]
