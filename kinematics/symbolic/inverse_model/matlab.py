"""A derivation as a function of MATLAB."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.inverse_model.code import Code
from kinematics.symbolic.inverse_model.notation import MATLAB
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
function w = root(square, size)
% The square root, 0 where only rounding is left, NaN of a negative number.
    if abs(square) <= 1e-13*size
        w = 0;
    elseif square > 0
        w = sqrt(square);
    else
        w = NaN;
    end
end

function s = signs(root)
% Both signs; one where they make no difference.
    if root > 0
        s = [1 -1];
    else
        s = 1;
    end
end

function name = either(rule, first, second)
% One of two names.
    if rule >= 0
        name = first;
    else
        name = second;
    end
end

function a = wrap(angle)
% An angle in (-pi, pi].
    a = atan2(sin(angle), cos(angle));
end
"""
_UPWARDS = """
function s = first_sign(values)
% The sign of the first value that is not 0 beside the others.
    least = 1e-9*norm(values);
    s = 1;
    for value = values
        if abs(value) > least
            s = sign(value);
            return
        end
    end
end
"""


class Matlab(Code):
    """Writes MATLAB."""

    style = MATLAB
    comment_mark = "%"

    def head(self) -> list[str]:
        d = self.derivation
        return [
            "function solutions = inverse_model(T, given)",
            *(chained("", ("% ", one)) for one in self.about()),
            chained("", ("% ", say("Returns structs: q, names of the posture, and free joints."))),
            "    if nargin < 2",
            f"        given = zeros(1, {d.dof});",
            "    end",
            f"    size = {d.size!r};",
            *(f"    {name} = {value!r};" for name, value in self.lengths()),
            *(
                f"    {name} = T({row + 1}, {column + 1});"
                for name, row, column in self.elements()
            ),
            "    solutions = struct('q', {}, 'posture', {}, 'free', {});",
        ]

    def tail(self) -> list[str]:
        helpers = [
            _ROOT,
            *([_UPWARDS] if self.has(Upwards) else []),
            *([_ROOTS] if self.has(Roots) else []),
        ]
        return ["end", *(line for part in helpers for line in part.splitlines())]

    def define(self, name: str, value: str) -> None:
        self.put(f"{name} = {value};")

    def root(self, one: Root, size: str) -> None:
        self.put(f"{one.name} = root({self.style.sum(one.square)}, {size});")
        self.put(f"if isnan({one.name})")
        self.put("    continue" if self.in_loop else "    return")
        self.put("end")

    def branch(self, one: Branch) -> None:
        self.put(f"for {one.sign} = {f'signs({one.root})' if one.root else '[1 -1]'}")
        self.in_loop += 1

    def roots(self, one: Roots) -> None:
        values = ", ".join(map(self.style.sum, one.coefficients))
        self.put(f"{one.name}s = angles({values});")
        self.put(f"for {one.rank} = 0:numel({one.name}s) - 1")
        self.put(f"    {one.name} = {one.name}s({one.rank} + 1);")
        self.in_loop += 1

    def trig(self, one: Trig) -> None:
        argument = self.style.argument(one)
        self.put(f"C{one.label} = cos({argument});")
        self.put(f"S{one.label} = sin({argument});")

    def upwards(self, one: Upwards) -> None:
        values = ", ".join(map(self.style.sum, one.values))
        self.put(f"{one.name} = first_sign([{values}]);")

    def posture(self, one: Posture) -> None:
        rule, name = self.style.sum(one.rule), f"posture{one.choice + 1}"
        if one.is_rank:
            names = ", ".join(f"'{text}'" for text in one.names)
            self.put(f"{name}s = {{{names}}};")
            self.put(f"{name} = {name}s{{{rule} + 1}};")
        else:
            self.put(f"{name} = either({rule}, '{one.names[0]}', '{one.names[1]}');")

    def angle_or_given(self, one: Angle, is_free: str) -> None:
        given = self.given(one.link or 0, "given({k})")
        self.put(f"free{one.link} = {is_free};")
        self.put(f"if free{one.link}")
        self.put(f"    {one.name} = {given};")
        self.put("else")
        self.put(f"    {one.name} = {self.style.angle(one)};")
        self.put("end")

    def solution(self) -> None:
        for number, value in enumerate(self.entries("pi", "given({k})", "wrap({})"), start=1):
            self.put(f"q{number} = {value};")
        q = ", ".join(f"q{k}" for k in range(1, self.derivation.dof + 1))
        names = ", ".join(f"posture{k + 1}" for k in range(len(self.derivation.postures)))
        free = ", ".join(
            f"free{k}" if k in self.free else "false"
            for k in range(1, self.derivation.links + 1)
        )
        self.put(
            f"solutions(end + 1) = struct('q', [{q}], 'posture', {{{{{names}}}}},"
            f" 'free', find([{free}]));"
        )

    def close_all(self) -> None:
        while self.depth > 1:
            self.depth -= 1
            self.put("end")


_ROOTS = ""
