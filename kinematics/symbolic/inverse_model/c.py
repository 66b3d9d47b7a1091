"""A derivation as a function of C99."""

from __future__ import annotations

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.inverse_model.code import Code
from kinematics.symbolic.inverse_model.notation import C
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


_ACROSS = """
/* The unit vector across the unit vector n nearest to the first of two not along it. */
static void across(const double n[3], double least, const double v[2][3], double out[3])
{
    for (int i = 0; i < 2; i++) {
        const double along = v[i][0]*n[0] + v[i][1]*n[1] + v[i][2]*n[2];
        double square = 0;
        for (int k = 0; k < 3; k++) {
            out[k] = v[i][k] - along*n[k];
            square += out[k]*out[k];
        }
        const double length = sqrt(square);
        for (int k = 0; k < 3; k++) out[k] /= length;
        if (length > least) return;
    }
}
"""


class CSource(Code):
    """Writes C."""

    style = C
    comment_mark = "/*"
    comment_end = " */"

    def head(self) -> list[str]:
        """Return the lines before the body."""
        d = self.derivation
        lengths = "".join(f"double {name}, " for name, _ in self.lengths())
        values = ", ".join(f"{name} = {value!r}" for name, value in self.lengths())
        helpers = [
            *([_ROOT] if self.has(Root) else []),
            *([_WRAP] if any(one.is_angle for one in d.coordinates) else []),
            *([_UPWARDS] if self.has(Upwards) else []),
            *([_ROOTS] if self.has(Roots) else []),
            *([_ACROSS] if self.has(Across) else []),
        ]
        swivel = f"double {d.swivel}, " if d.swivel else ""
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
            f"    const char *posture[{len(self.named())}];",
            f"    int free[{d.links}]; /* 1: free */",
            "} inverse_solution;",
            *(line for part in helpers for line in part.splitlines()),
            "",
            *(
                chained("", ("/* " if k == 0 else "   ", one, "" if k < len(about) - 1 else " */"))
                for k, one in enumerate(about)
            ),
            f"int inverse_model(const double T[4][4], {lengths}const double given[{d.dof}],",
            f"                  {swivel}inverse_solution out[{d.most}])",
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
        """Return the lines after it."""
        return ["    return count;", "}"]

    def define(self, name: str, value: str) -> None:
        """Add ``name = value``."""
        self.put(f"const double {name} = {value};")

    def root(self, one: Root, size: str) -> None:
        """Add a root."""
        self.put(f"const double {one.name} = root({self.style.sum(one.square)}, {size});")
        none = f"!({one.name} > 0)" if one.is_divisor else f"isnan({one.name})"
        self.put(f"if ({none}) {'continue' if self.in_loop else 'return count'};")

    def branch(self, one: Branch) -> None:
        """Open a loop over both signs."""
        last = f"({one.root} > 0 ? -1 : 1)" if one.root else "-1"
        self.put(f"for (int {one.sign} = 1; {one.sign} >= {last}; {one.sign} -= 2) {{")
        self.in_loop += 1

    def roots(self, one: Roots) -> None:
        """Open a loop over the roots of a trigonometric polynomial."""
        values = ", ".join(map(self.style.sum, one.coefficients))
        self.put(f"double {one.name}s[4];")
        self.put(f"const int {one.name}_end = angles({values}, {one.name}s);")
        self.put(f"for (int i = 0; i < {one.name}_end; i++) {{")
        self.put(f"    const double {one.name} = {one.name}s[i];")
        self.in_loop += 1

    def trig(self, one: Trig) -> None:
        """Add a cosine and a sine."""
        argument = self.style.argument(one)
        self.put(f"const double C{one.label} = cos({argument}), S{one.label} = sin({argument});")

    def upwards(self, one: Upwards) -> None:
        """Add the sign of the first number that is not 0."""
        values = [*map(self.style.sum, one.values), "0", "0"][:3]
        self.put(f"const int {one.name} = first_sign({', '.join(values)});")

    def posture(self, one: Posture) -> None:
        """Add a name of the posture."""
        rule, name = self.style.sum(one.rule), f"posture{one.choice + 1}"
        self.put(f'const char *{name} = {rule} >= 0 ? "{one.names[0]}" : "{one.names[1]}";')

    def require(self, values: list[str]) -> None:
        """Add the end of the search where numbers are not 0."""
        self.put(f"if ({' || '.join(f'fabs({value}) > 1e-9' for value in values)}) return count;")

    def across(self, one: Across, least: str) -> None:
        """Add the unit vector across another."""
        to, *of = self.vectors(one, "{", "}")
        name = one.names[0][:-1]
        self.put(f"const double {name}_to[3] = {to}, {name}_of[2][3] = {{{', '.join(of)}}};")
        self.put(f"double {name}[3];")
        self.put(f"across({name}_to, {least}, {name}_of, {name});")
        parts = ", ".join(f"{part} = {name}[{k}]" for k, part in enumerate(one.names))
        self.put(f"const double {parts};")

    def angle_or_given(self, one: Angle, is_free: str) -> None:
        """Add an angle, or the given one where it is free."""
        self.put(f"const int free{one.link} = {is_free};")
        given = self.given(one.link or 0, "given[{k0}]")
        self.put(f"const double {one.name} = free{one.link} ? {given} : {self.style.angle(one)};")

    def solution(self) -> None:
        """Add what keeps a solution."""
        d = self.derivation
        for k, value in enumerate(self.entries("", "given[{k0}]", "wrap({})")):
            self.put(f"out[count].q[{k}] = {value};")
        for k, name in enumerate(self.named()):
            found = name or '""'
            self.put(f"out[count].posture[{k}] = {found};")
        for k in range(1, d.links + 1):
            self.put(f"out[count].free[{k - 1}] = {f'free{k}' if k in self.free else '0'};")
        self.put("count++;")

    def close_all(self) -> None:
        """Close all blocks."""
        while self.depth > 1:
            self.depth -= 1
            self.put("}")

    def ranks(self) -> None:
        """Add what gives the first names by the order of an entry of q."""
        k = self.derivation.ranked - 1
        names = ", ".join(f'"{name}"' for name in self.derivation.postures[0])
        self.put(f"static const char *const ranks[] = {{{names}}};")
        self.put("for (int i = 0; i < count; i++) {")
        self.put("    int rank = 0;")
        self.put("    for (int j = 0; j < count; j++) {")
        self.put(f"        int below = out[j].q[{k}] < out[i].q[{k}] - 1e-7;")
        self.put("        for (int n = 0; n < j; n++) {")
        self.put(f"            if (fabs(out[n].q[{k}] - out[j].q[{k}]) <= 1e-7) below = 0;")
        self.put("        }")
        self.put("        rank += below;")
        self.put("    }")
        self.put("    out[i].posture[0] = ranks[rank];")
        self.put("}")


_ROOTS = """
static double polynomial(const double *p, int n, double t)
{
    double total = 0;
    for (int i = 0; i <= n; i++) total = total*t + p[i];
    return total;
}

/* The real roots of a polynomial, highest power first, each once; their number. */
static int real_roots(const double *p, int n, double *out)
{
    if (n == 1) {
        out[0] = -p[1]/p[0];
        return 1;
    }
    double slope[4], ends[6], bound = 0, scale = 0;
    for (int i = 0; i < n; i++) slope[i] = (n - i)*p[i];
    const int turning = real_roots(slope, n - 1, ends + 1);
    for (int i = 0; i <= n; i++) {
        bound = fmax(bound, fabs(p[i]/p[0]));
        scale += fabs(p[i]);
    }
    ends[0] = -1 - bound, ends[turning + 1] = 1 + bound;
    int count = 0;
    for (int i = 0; i <= turning; i++) {
        double low = ends[i], high = ends[i + 1];
        const double first = polynomial(p, n, low), last = polynomial(p, n, high);
        if (fabs(last) <= 1e-14*scale*pow(fmax(1, fabs(high)), n)) {
            out[count++] = high;
        } else if (first*last < 0) {
            if (first > 0) {
                const double kept = low;
                low = high, high = kept;
            }
            for (int k = 0; k < 200; k++) {
                const double middle = (low + high)/2;
                if (middle == low || middle == high) break;
                if (polynomial(p, n, middle) < 0) low = middle;
                else high = middle;
            }
            out[count++] = (low + high)/2;
        }
    }
    return count;
}

/* All angles with k0 + k1 cos + k2 sin + k3 cos^2 + k4 cos sin = 0; their number. */
static int angles(double k0, double k1, double k2, double k3, double k4, double *out)
{
    /* t = tan((a - s)/2), with s so that a = s + pi, where t has no value, is far from one */
    double s = 0, most = -1;
    for (int n = 0; n < 16; n++) {
        const double a = (n + 8)*0.39269908169872414;
        const double f = k0 + k1*cos(a) + k2*sin(a) + cos(a)*(k3*cos(a) + k4*sin(a));
        if (fabs(f) > most) most = fabs(f), s = n*0.39269908169872414;
    }
    const double mean = k0 + k3/2, a = k1*cos(s) + k2*sin(s), b = k2*cos(s) - k1*sin(s);
    const double c = (k3*cos(2*s) + k4*sin(2*s))/2, d = (k4*cos(2*s) - k3*sin(2*s))/2;
    const double p[5] = {mean - a + c, 2*b - 4*d, 2*mean - 6*c, 2*b + 4*d, mean + a + c};
    const int count = p[0] != 0 ? real_roots(p, 4, out) : 0;
    for (int i = 0; i < count; i++) out[i] = wrap(2*atan(out[i]) + s);
    return count;
}
"""
