"""A derivation as a function of C99."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.inverse_model.code import Code
from kinematics.symbolic.inverse_model.notation import C
from kinematics.symbolic.inverse_model.statements import (
    Angle,
    Branch,
    Posture,
    Root,
    Roots,
    Trig,
    Upwards,
)

_ROOT = """
/* The square root, 0 where only rounding is left, NAN of a negative number. */
static double root(double square, double size)
{
    if (fabs(square) <= 1e-13*size) return 0;
    return square > 0 ? sqrt(square) : NAN;
}
"""
_WRAP = """
/* An angle in (-pi, pi]. */
static double wrap(double angle)
{
    return atan2(sin(angle), cos(angle));
}
"""
_UPWARDS = """
/* The sign of the first of three values that is not 0 beside the others. */
static int first_sign(double a, double b, double c)
{
    const double values[3] = {a, b, c}, least = 1e-9*sqrt(a*a + b*b + c*c);
    for (int i = 0; i < 3; i++) {
        if (fabs(values[i]) > least) return values[i] > 0 ? 1 : -1;
    }
    return 1;
}
"""


class CSource(Code):
    """Writes C."""

    style = C
    comment_mark = "/*"
    comment_end = " */"

    def head(self) -> list[str]:
        d = self.derivation
        lengths = "".join(f"double {name}, " for name, _ in self.lengths())
        values = ", ".join(f"{name} = {value!r}" for name, value in self.lengths())
        helpers = [
            *([_ROOT] if self.has(Root) else []),
            *([_WRAP] if any(one.is_angle for one in d.coordinates) else []),
            *([_UPWARDS] if self.has(Upwards) else []),
            *([_ROOTS] if self.has(Roots) else []),
        ]
        about = [
            *self.about(),
            *([values] if values else []),
            say("Fills out with at most {most} solutions, and returns their number.", most=d.most),
        ]
        return [
            "#include <math.h>",
            "",
            "typedef struct {",
            f"    double q[{d.dof}];",
            f"    const char *posture[{len(d.postures)}];",
            f"    int free[{d.links}]; /* 1: free */",
            "} inverse_solution;",
            *(line for part in helpers for line in part.splitlines()),
            "",
            *(
                chained("", ("/* " if k == 0 else "   ", one, "" if k < len(about) - 1 else " */"))
                for k, one in enumerate(about)
            ),
            f"int inverse_model(const double T[4][4], {lengths}const double given[{d.dof}],",
            f"                  inverse_solution out[{d.most}])",
            "{",
            f"    const double size = {d.size!r};",
            *(
                f"    const double {name} = T[{row}][{column}];"
                for name, row, column in self.elements()
            ),
            "    int count = 0;",
            "    (void)size, (void)given;",
        ]

    def tail(self) -> list[str]:
        return ["    return count;", "}"]

    def define(self, name: str, value: str) -> None:
        self.put(f"const double {name} = {value};")

    def root(self, one: Root, size: str) -> None:
        self.put(f"const double {one.name} = root({self.style.sum(one.square)}, {size});")
        self.put(f"if (isnan({one.name})) {'continue' if self.in_loop else 'return count'};")

    def branch(self, one: Branch) -> None:
        last = f"({one.root} > 0 ? -1 : 1)" if one.root else "-1"
        self.put(f"for (int {one.sign} = 1; {one.sign} >= {last}; {one.sign} -= 2) {{")
        self.in_loop += 1

    def roots(self, one: Roots) -> None:
        values = ", ".join(map(self.style.sum, one.coefficients))
        self.put(f"double {one.name}s[4];")
        self.put(f"const int {one.rank}_end = angles({values}, {one.name}s);")
        self.put(f"for (int {one.rank} = 0; {one.rank} < {one.rank}_end; {one.rank}++) {{")
        self.put(f"    const double {one.name} = {one.name}s[{one.rank}];")
        self.in_loop += 1

    def trig(self, one: Trig) -> None:
        argument = self.style.argument(one)
        self.put(f"const double C{one.label} = cos({argument}), S{one.label} = sin({argument});")

    def upwards(self, one: Upwards) -> None:
        values = [*map(self.style.sum, one.values), "0", "0"][:3]
        self.put(f"const int {one.name} = first_sign({', '.join(values)});")

    def posture(self, one: Posture) -> None:
        rule, name = self.style.sum(one.rule), f"posture{one.choice + 1}"
        if one.is_rank:
            names = ", ".join(f'"{text}"' for text in one.names)
            self.put(f"const char *{name}_of[] = {{{names}}};")
            self.put(f"const char *{name} = {name}_of[{rule}];")
        else:
            self.put(
                f'const char *{name} = {rule} >= 0 ? "{one.names[0]}" : "{one.names[1]}";'
            )

    def angle_or_given(self, one: Angle, is_free: str) -> None:
        self.put(f"const int free{one.link} = {is_free};")
        given = self.given(one.link or 0, "given[{k0}]")
        self.put(
            f"const double {one.name} = free{one.link} ? {given} : {self.style.angle(one)};"
        )

    def solution(self) -> None:
        d = self.derivation
        for k, value in enumerate(self.entries("", "given[{k0}]", "wrap({})")):
            self.put(f"out[count].q[{k}] = {value};")
        for k in range(len(d.postures)):
            self.put(f"out[count].posture[{k}] = posture{k + 1};")
        for k in range(1, d.links + 1):
            self.put(f"out[count].free[{k - 1}] = {f'free{k}' if k in self.free else '0'};")
        self.put("count++;")

    def close_all(self) -> None:
        while self.depth > 1:
            self.depth -= 1
            self.put("}")


_ROOTS = ""
