"""A derivation as a function of MATLAB."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.inverse_model.code import Code
from kinematics.symbolic.inverse_model.notation import MATLAB
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


_ACROSS = """
function part = across(n, least, vectors)
% The unit vector across the unit vector n nearest to the first row that is not along it.
    for k = 1:2
        part = vectors(k, :) - (vectors(k, :)*n')*n;
        if norm(part) > least
            break
        end
    end
    part = part/norm(part);
end
"""


class Matlab(Code):
    """Writes MATLAB."""

    style = MATLAB
    comment_mark = "%"

    def head(self) -> list[str]:
        """Return the lines before the body."""
        d = self.derivation
        swivel = f", {d.swivel}" if d.swivel else ""
        default = ["    if nargin < 3", f"        {d.swivel} = 0;", "    end"]
        return [
            f"function solutions = inverse_model(T, given{swivel})",
            *(chained("", ("% ", one)) for one in self.about()),
            chained("", ("% ", say("Returns structs: q, names of the posture, and free joints."))),
            "    if nargin < 2",
            f"        given = zeros(1, {d.dof});",
            "    end",
            *(default if d.swivel else []),
            f"    size = {d.size!r};",
            *(f"    {name} = {value!r};" for name, value in self.lengths()),
            *(f"    {name} = T({row + 1}, {column + 1});" for name, row, column in self.elements()),
            "    solutions = struct('q', {}, 'posture', {}, 'free', {});",
        ]

    def tail(self) -> list[str]:
        """Return the lines after it."""
        helpers = [
            _ROOT,
            *([_UPWARDS] if self.has(Upwards) else []),
            *([_ROOTS] if self.has(Roots) else []),
            *([_ACROSS] if self.has(Across) else []),
        ]
        return ["end", *(line for part in helpers for line in part.splitlines())]

    def define(self, name: str, value: str) -> None:
        """Add ``name = value``."""
        self.put(f"{name} = {value};")

    def root(self, one: Root, size: str) -> None:
        """Add a root."""
        self.put(f"{one.name} = root({self.style.sum(one.square)}, {size});")
        self.put(f"if ~({one.name} > 0)" if one.is_divisor else f"if isnan({one.name})")
        self.put("    continue" if self.in_loop else "    return")
        self.put("end")

    def branch(self, one: Branch) -> None:
        """Open a loop over both signs."""
        self.put(f"for {one.sign} = {f'signs({one.root})' if one.root else '[1 -1]'}")
        self.in_loop += 1

    def roots(self, one: Roots) -> None:
        """Open a loop over the roots of a trigonometric polynomial."""
        values = ", ".join(map(self.style.sum, one.coefficients))
        self.put(f"for {one.name} = angles({values})")
        self.in_loop += 1

    def trig(self, one: Trig) -> None:
        """Add a cosine and a sine."""
        argument = self.style.argument(one)
        self.put(f"C{one.label} = cos({argument});")
        self.put(f"S{one.label} = sin({argument});")

    def upwards(self, one: Upwards) -> None:
        """Add the sign of the first number that is not 0."""
        values = ", ".join(map(self.style.sum, one.values))
        self.put(f"{one.name} = first_sign([{values}]);")

    def posture(self, one: Posture) -> None:
        """Add a name of the posture."""
        rule, name = self.style.sum(one.rule), f"posture{one.choice + 1}"
        self.put(f"{name} = either({rule}, '{one.names[0]}', '{one.names[1]}');")

    def require(self, values: list[str]) -> None:
        """Add the end of the search where numbers are not 0."""
        self.put(f"if norm([{', '.join(values)}]) > 1e-9")
        self.put("    return")
        self.put("end")

    def across(self, one: Across, least: str) -> None:
        """Add the unit vector across another."""
        to, *of = self.vectors(one, "[", "]")
        rows = "; ".join(row[1:-1] for row in of)
        name = one.names[0][:-1]
        self.put(f"{name} = across({to}, {least}, [{rows}]);")
        for k, part in enumerate(one.names, start=1):
            self.put(f"{part} = {name}({k});")

    def angle_or_given(self, one: Angle, is_free: str) -> None:
        """Add an angle, or the given one where it is free."""
        given = self.given(one.link or 0, "given({k})")
        self.put(f"free{one.link} = {is_free};")
        self.put(f"if free{one.link}")
        self.put(f"    {one.name} = {given};")
        self.put("else")
        self.put(f"    {one.name} = {self.style.angle(one)};")
        self.put("end")

    def solution(self) -> None:
        """Add what keeps a solution."""
        for number, value in enumerate(self.entries("pi", "given({k})", "wrap({})"), start=1):
            self.put(f"q{number} = {value};")
        q = ", ".join(f"q{k}" for k in range(1, self.derivation.dof + 1))
        names = ", ".join(name or "''" for name in self.named())
        free = ", ".join(
            f"free{k}" if k in self.free else "false" for k in range(1, self.derivation.links + 1)
        )
        self.put(
            f"solutions(end + 1) = struct('q', [{q}], 'posture', {{{{{names}}}}},"
            f" 'free', find([{free}]));"
        )

    def close_all(self) -> None:
        """Close all blocks."""
        while self.depth > 1:
            self.depth -= 1
            self.put("end")

    def ranks(self) -> None:
        """Add what gives the first names by the order of an entry of q."""
        k = self.derivation.ranked
        names = ", ".join(f"'{name}'" for name in self.derivation.postures[0])
        self.put(f"ranks = {{{names}}};")
        self.put("values = [];")
        self.put("for i = 1:numel(solutions)")
        self.put(f"    if all(abs(values - solutions(i).q({k})) > 1e-7)")
        self.put(f"        values = [values, solutions(i).q({k})];")
        self.put("    end")
        self.put("end")
        self.put("for i = 1:numel(solutions)")
        self.put(f"    rank = 1 + sum(values < solutions(i).q({k}) - 1e-7);")
        self.put("    solutions(i).posture{1} = ranks{rank};")
        self.put("end")


_ROOTS = """
function found = angles(k0, k1, k2, k3, k4)
% All angles with k0 + k1 cos + k2 sin + k3 cos^2 + k4 cos sin = 0.
    % t = tan((a - s)/2), with s so that a = s + pi, where t has no value, is far from one
    s = 0;
    most = -1;
    for n = 0:15
        a = (n + 8)*pi/8;
        f = abs(k0 + k1*cos(a) + k2*sin(a) + cos(a)*(k3*cos(a) + k4*sin(a)));
        if f > most
            most = f;
            s = n*pi/8;
        end
    end
    mean = k0 + k3/2;
    a = k1*cos(s) + k2*sin(s);
    b = k2*cos(s) - k1*sin(s);
    c = (k3*cos(2*s) + k4*sin(2*s))/2;
    d = (k4*cos(2*s) - k3*sin(2*s))/2;
    t = roots([mean - a + c, 2*b - 4*d, 2*mean - 6*c, 2*b + 4*d, mean + a + c]);
    found = [];
    for k = 1:numel(t)
        if abs(imag(t(k))) <= 1e-8*(1 + abs(t(k)))
            found = [found, wrap(2*atan(real(t(k))) + s)];
        end
    end
end
"""
