"""Tables as people paste them, from a generator; the arm of each is known.

A layout is drawn by parts that are independent of each other: the form (pipes, tabs, blanks, LaTeX,
HTML, lists, a matrix, a data frame, a print of the Robotics Toolbox, a transposed table), how
columns are called, in which order, how angles, lengths and variables are written, where the units
stand, and what stands beside the table. Some parts leave something open, which must be refused.
"""

import html
import math
import random
from dataclasses import dataclass, field

ANGLES = (0.0, math.pi / 2, -math.pi / 2, math.pi, math.pi / 4)
LENGTHS = (0.0, 0.4, 0.3, 0.05, 0.125, -0.1)
HEADS = {
    "alpha": ("α", "alpha", "αi", "$\\alpha_i$", "Twist α", "link twist", "ɑ", "Torsion α"),
    "a": ("a", "ai", "a_i", "$a_i$", "Link length a", "Link length", "Longueur a"),
    "d": ("d", "di", "d_i", "$d_i$", "Link offset d", "Décalage d", "Link offset"),
    "theta": ("θ", "theta", "θi", "$\\theta_i$", "Joint angle θ", "Ө", "ϑ", "Angle θ"),
}
INDEX = ("i", "Joint", "Link", "Links", "Link#", "#", "Joint No.", "Articulation", "Axis", "j")
SHORT = {"alpha": ("α", "alpha"), "a": ("a",), "d": ("d",), "theta": ("θ", "theta")}
LAST = ("EE", "flange", "Tool", "TCP", "end effector", "outil", "3->EE")
FIRST = ("0", "base", "Base", "B")


@dataclass
class Layout:
    """A text and what it means.

    Attributes:
        text: The text.
        rows: Type, alpha, a, d, theta of each row; theta or d of a moving row is its offset.
        query: What the request gives.
        kind: The form.
    """

    text: str
    rows: list[tuple[str, float, float, float, float]]
    query: dict[str, str] = field(default_factory=dict)
    kind: str = ""


def layout(seed: int) -> Layout:
    """Return a layout by number."""
    r = random.Random(seed)
    kind = r.choice(sorted(FORMS))
    count = r.randint(2, 6)
    degrees = r.random() < 0.5
    millimetres = r.random() < 0.4
    # Where plain numbers are written, the text, the heading or the request says the units.
    where = r.choice(("title", "heading", "cells", "row", "query"))
    prismatic = r.random() < 0.3 and kind not in ("lists", "matrix", "frame", "composed")
    rows = []
    for k in range(count):
        slides = prismatic and k == count - 1
        offset = r.choice((0.0, 0.0, math.pi / 2, -math.pi / 2))
        rows.append(
            (
                "P" if slides else "R",
                r.choice(ANGLES),
                r.choice(LENGTHS),
                r.choice((0.0, 0.1)) if slides else r.choice(LENGTHS),
                r.choice((0.0, math.pi / 2)) if slides else offset,
            )
        )
    if not any(row[2] or row[3] for row in rows):
        rows[0] = (*rows[0][:2], 0.3, *rows[0][3:])
    return FORMS[kind](_Drawn(r, kind, rows, degrees, millimetres, where))


class _Drawn:
    def __init__(self, r, kind, rows, degrees, millimetres, where):
        self.r, self.kind, self.rows = r, kind, rows
        self.degrees, self.millimetres, self.where = degrees, millimetres, where
        self.style = r.randrange(6)
        self.comma = r.random() < 0.15
        self.query = {"convention": r.choice(("standard", "dh"))}
        if where == "query":
            self.query |= {"angle": "deg" if degrees else "rad"}
            self.query |= {"length": "mm"} if millimetres else {}

    def angle(self, value):
        if self.where == "cells" or not self.degrees:
            return self.angle_with_unit(value) if self.where == "cells" else self.radians(value)
        return f"{round(math.degrees(value), 6):g}"

    def radians(self, value):
        if value == 0:
            return "0"
        return repr(value) if self.style == 0 else self.angle_with_unit(value, degrees=False)

    def angle_with_unit(self, value, degrees=True):
        if value == 0:
            return "0"
        ratio = value / math.pi
        sign, part = ("-" if ratio < 0 else ""), {0.5: "/2", 0.25: "/4", 1.0: ""}[abs(ratio)]
        shown = round(math.degrees(abs(value)))
        forms = [f"{sign}pi{part}", f"{sign}π{part}", f"{sign}np.pi{part}", f"{sign}M_PI{part}"]
        forms += [f"{sign}{shown}°", f"{sign}{shown}*deg"] if degrees else []
        forms += [f"{sign}½π"] if part == "/2" else []
        if self.kind == "latex":
            forms = [f"${sign}\\frac{{\\pi}}{{{part[1]}}}$"] if part else [f"${sign}\\pi$"]
        return forms[self.style % len(forms)]

    def length(self, value):
        if self.millimetres:
            number = f"{round(value * 1000, 6):g}"
            return f"{number} mm" if self.where == "cells" and value else number
        text = f"{value:g}"
        return text.replace(".", ",") if self.comma and self.kind != "commas" else text

    def variable(self, k, letter):
        names = {"theta": ("θ{}", "theta{}", "q{}", "θ_{}", "theta{}(t)", "θ{}*"), "d": ("d{}",)}
        name = names[letter][self.style % len(names[letter])].format(k)
        if self.kind == "latex":
            name = f"$\\theta_{{{k}}}$" if letter == "theta" else f"$d_{{{k}}}$"
        return name

    def cells(self, k):
        """Return the cells of row k by column, with its joint variable."""
        type_, alpha, a, d, theta = self.rows[k]
        found = {"alpha": self.angle(alpha), "a": self.length(a)}
        found |= {"d": self.length(d), "theta": self.angle(theta)}
        if type_ == "R":
            found["theta"] = self._sum(self.variable(k + 1, "theta"), self.angle(theta), theta)
        elif type_ == "P":
            found["d"] = self._sum(self.variable(k + 1, "d"), self.length(d), d)
        return found

    def _sum(self, variable, constant, value):
        if value == 0:
            return variable
        if self.kind == "latex":
            variable, constant = variable.strip("$"), constant.strip("$")
        text = constant.removeprefix("-")
        joined = f"{variable} {'-' if constant.startswith('-') else '+'} {text}"
        return f"${joined}$" if self.kind == "latex" else joined

    def heads(self, order, names=HEADS):
        found = {}
        for key in order:
            text = self.r.choice(names[key])
            if self.kind != "latex":
                text = text.replace("$", "") if "\\" not in text else SHORT[key][0]
            if self.where == "heading":
                angle, length = self._units()
                text += f" ({angle if key in ('alpha', 'theta') else length})"
            found[key] = text
        return found

    def _units(self):
        return "deg" if self.degrees else "rad", "mm" if self.millimetres else "m"

    def order(self):
        return self.r.sample(["alpha", "a", "d", "theta"], 4)

    def title(self):
        """Return lines above the table, with the units if they stand there."""
        angle, length = self._units()
        if self.where != "title":
            return self.r.choice(("", "", "DH parameters of the arm\n", "Table 2.\n"))
        long = {"deg": "degrees", "rad": "radians", "mm": "mm", "m": "m"}
        return self.r.choice(
            (
                f"D-H parameters (angles in {long[angle]}, lengths in {length})\n",
                f"Units: {length}, {angle}\n",
                f"DH table [{length}, {angle}]\n",
                f"Paramètres D-H, longueurs en {length}, angles en {long[angle]}\n".replace(
                    "degrees", "degrés"
                ).replace("radians", "radians"),
            )
        )

    def grid(self):
        """Return heading and rows as lists of cells; the rows that do not move are added."""
        order, r = self.order(), self.r
        heads = self.heads(order)
        index = r.choice((*INDEX, None))
        first, last = r.random() < 0.15, r.random() < 0.2
        lines = [[heads[key] for key in order]]
        if self.where == "row":
            angle, length = self._units()
            lines.append([angle if key in ("alpha", "theta") else length for key in order])
        labels = [str(k + 1) for k in range(len(self.rows))]
        body = [[self.cells(k)[key] for key in order] for k in range(len(self.rows))]
        if index is not None and first:
            body.insert(0, [self._still(key, 0.2) for key in order])
            labels.insert(0, r.choice(FIRST))
            self.rows = [("F", 0.0, 0.0, 0.2, 0.0), *self.rows]
        if index is not None and last:
            body.append([self._still(key, 0.125) for key in order])
            labels.append(r.choice(LAST))
            self.rows = [*self.rows, ("F", 0.0, 0.0, 0.125, 0.0)]
        lines += body
        if index is None:
            return lines
        blank = [""] if self.where == "row" else []
        return [[mark, *line] for mark, line in zip([index, *blank, *labels], lines, strict=True)]

    def _still(self, key, d):
        return self.length(d) if key == "d" else "0"

    def made(self, text):
        return Layout(text, self.rows, self.query, self.kind)


def _pipes(x):
    lines = x.grid()
    rule = ["---"] * len(lines[0])
    piped = [f"| {' | '.join(cells)} |" for cells in [lines[0], rule, *lines[1:]]]
    return x.made(x.title() + "\n" + "\n".join(piped))


def _tabs(x):
    return x.made(x.title() + "\n".join("\t".join(line) for line in x.grid()))


def _semicolons(x):
    return x.made(x.title() + "\n".join(";".join(line) for line in x.grid()))


def _commas(x):
    return x.made(x.title() + "\n".join(",".join(line) for line in x.grid()))


def _blanks(x):
    lines = x.grid()
    lines = [[cell or "-" for cell in line] for line in lines]
    widths = [max(len(line[k]) for line in lines) + 3 for k in range(len(lines[0]))]
    rows = ("".join(cell.ljust(w) for cell, w in zip(line, widths, strict=True)) for line in lines)
    return x.made(x.title() + "\n".join(row.rstrip() for row in rows))


def _latex(x):
    heading, *lines = x.grid()
    body = " \\\\\n".join(" & ".join(line).replace("°", "^\\circ") for line in [heading, *lines])
    body = body.replace("#", "\\#")
    caption = x.title().strip() or "D-H parameters"
    columns = "c" * len(heading)
    return x.made(
        f"\\begin{{table}}\\caption{{{caption}}}\n\\begin{{tabular}}{{{columns}}}\\hline\n"
        f"{body} \\\\ \\hline\n\\end{{tabular}}\\end{{table}}"
    )


def _html(x):
    heading, *lines = x.grid()
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in heading)
    rows = (
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in line) + "</tr>\n"
        for line in lines
    )
    title = x.title()
    return x.made(f"<p>{title}</p><table><tr>{head}</tr>\n{''.join(rows)}</table>")


def _turned(x):
    order = x.order()
    heads = x.heads(order, SHORT)
    if x.where == "row":
        x.where, x.query = "query", {**x.query, "angle": "deg" if x.degrees else "rad"}
        x.query |= {"length": "mm"} if x.millimetres else {}
    labels = [str(k + 1) for k in range(len(x.rows))]
    lines = [[x.r.choice(("", "Parameter", "joint")), *labels]]
    lines += [[heads[key], *(x.cells(k)[key] for k in range(len(labels)))] for key in order]
    return x.made(x.title() + "\n" + "\n".join(f"| {' | '.join(line)} |" for line in lines))


def _numbers(x, key):
    """Return the numbers of a column as a program writes them."""
    column = {"alpha": 1, "a": 2, "d": 3, "theta": 4}[key]
    values = [row[column] for row in x.rows]
    if key in ("a", "d"):
        return [f"{round(v * 1000, 6):g}" if x.millimetres else f"{v:g}" for v in values]
    if x.degrees:
        return [f"{round(math.degrees(v), 6):g}" for v in values]
    return [repr(v) if x.style % 2 else _of_pi(v) for v in values]


def _of_pi(value):
    ratio = value / math.pi
    return "0" if ratio == 0 else f"{'-' if ratio < 0 else ''}pi*{abs(ratio):g}"


def _program_units(x):
    x.query |= {"angle": "deg" if x.degrees else "rad"}
    x.query |= {"length": "mm"} if x.millimetres else {}


def _lists(x):
    _program_units(x)
    apart, end = x.r.choice(((", ", ""), (" ", ";"), (", ", ";"), ("; ", ";")))
    lines = [f"{key} = [{apart.join(_numbers(x, key))}]{end}" for key in x.order()]
    return x.made(x.r.choice(("\n", "\n\n") if not end else ("\n", " ")).join(lines))


def _matrix(x):
    _program_units(x)
    order = x.order()
    columns = [_numbers(x, key) for key in order]
    rows = [" ".join(row) for row in zip(*columns, strict=True)]
    names = " ".join(order)
    comment = x.r.choice(
        (f"% {names}", f"%  {', '.join(order)}", f"% DH = [{names}]", f"% columns: {names}", None)
    )
    if comment is None:
        # Without names of its columns it must be refused.
        comment = "% the arm"
        x.query["hidden columns"] = ",".join(order)
    body = ";\n      ".join(rows)
    return x.made(f"{comment}\nDH = [{body}];")


def _composed(x):
    _program_units(x)
    order = x.order()
    lines = [f"{key} = [{'; '.join(_numbers(x, key))}];" for key in order]
    return x.made("\n".join([*lines, f"DH = [{' '.join(x.r.sample(order, 4))}];"]))


def _frame(x):
    _program_units(x)
    order = x.order()
    columns = [_numbers(x, key) for key in order]
    first = x.r.choice((0, 1))
    labels = [str(k + first) for k in range(len(x.rows))]
    widths = [max(map(len, [key, *column])) + 2 for key, column in zip(order, columns, strict=True)]
    lines = ["  " + "".join(key.rjust(w) for key, w in zip(order, widths, strict=True))]
    lines += ["index"] if x.r.random() < 0.2 else []
    for k, label in enumerate(labels):
        cells = (column[k].rjust(w) for column, w in zip(columns, widths, strict=True))
        lines.append(label.ljust(2) + "".join(cells))
    return x.made("\n".join(lines))


def _print(x):
    x.query.pop("angle", None)
    x.query.pop("length", None)
    if x.r.random() < 0.5:
        x.query.pop("convention")
    lines = [["θⱼ", "dⱼ", "aⱼ", "⍺ⱼ"]]
    for k, (type_, alpha, a, d, theta) in enumerate(x.rows, start=1):
        sign, size = "-" if theta < 0 else "+", f"{abs(math.degrees(theta)):.3g}"
        turn = f"q{k} {sign} {size}°" if theta else f"q{k}"
        slide = f"q{k} + {d}" if d else f"q{k}"
        cells = [turn, f"{d:.4g}"] if type_ == "R" else [f"{math.degrees(theta)}°", slide]
        lines.append([*cells, f"{a:.4g}", f"{math.degrees(alpha)}°"])
    text = f"DHRobot: arm, {len(x.rows)} joints, dynamics, standard DH parameters\n" + _box(lines)
    if x.r.random() < 0.5:
        text += "\n" + _box([["tool", "t = 0, 0, 0.125; rpy/xyz = 0°, 0°, 0°"]])
        x.rows = [*x.rows, ("F", 0.0, 0.0, 0.125, 0.0)]
    names = [f"q{k}" for k in range(len(lines) - 1)]
    text += "\n" + _box([["name", *names], ["qz", *(["0°"] * len(names))]])
    return x.made(text)


def _box(lines):
    widths = [max(len(line[k]) for line in lines) + 2 for k in range(len(lines[0]))]

    def rule(left, middle, right):
        return left + middle.join("─" * w for w in widths) + right

    body = [
        "│" + "│".join(c.center(w) for c, w in zip(line, widths, strict=True)) + "│"
        for line in lines
    ]
    head = [body[0], rule("├", "┼", "┤"), *body[1:]] if len(body) > 1 else body
    return "\n".join([rule("┌", "┬", "┐"), *head, rule("└", "┴", "┘"), ""])


FORMS = {
    "pipes": _pipes,
    "tabs": _tabs,
    "semicolons": _semicolons,
    "commas": _commas,
    "blanks": _blanks,
    "latex": _latex,
    "html": _html,
    "turned": _turned,
    "lists": _lists,
    "matrix": _matrix,
    "composed": _composed,
    "frame": _frame,
    "print": _print,
}
