"""A derivation for people: steps with their lines, in text that is valid Python, or in LaTeX."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from dh_to_urdf.messages import Message, chained, plural, say
from kinematics.symbolic.angles import turn_text
from kinematics.symbolic.inverse_model.notation import LATEX, PYTHON, Style
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
)
from kinematics.symbolic.latex import bracketed

REMARK, EQUATION, FORMULA = "remark", "equation", "formula"
_SYMBOL = re.compile(r"(theta|[dr])\d+")
_SPECIAL = re.compile(r"([_&%#$])")


def model_view(d: Derivation, *, latex: bool) -> dict[str, Any]:
    """Return an inverse model as an answer has it.

    Args:
        d: The derivation.
        latex: Whether formulas are LaTeX.
    """
    style = LATEX if latex else PYTHON
    elements = {(row, column): name for name, row, column in d.target}
    matrix = [[style.name(elements[i, j]) for j in range(4)] for i in range(3)]
    steps = [
        {
            "title": step.title,
            "lines": [
                {"kind": kind, "text": text}
                for one in step.statements
                for kind, text in _lines(one, style)
            ],
        }
        for step in d.steps
    ]
    return {
        "kind": d.kind,
        "description": d.description,
        "target": [*matrix, ["0", "0", "0", "1"]],
        "steps": steps,
        "q": {style.name(one.name): _coordinate(one, style) for one in d.coordinates},
        "postures": [list(names) for names in d.postures if names[0]],
        "most_solutions": d.most,
    }


def _coordinate(one: Any, style: Style) -> str:
    turn = turn_text(abs(one.turn))
    if style.is_latex:
        turn = re.sub(r"(?:(\d+)\*)?pi/(\d+)", r"\\frac{\1 \\pi}{\2}", turn)
        turn = turn.replace("{ ", "{").replace("*pi", r" \pi")
        turn = re.sub(r"(?<!\\)\bpi\b", r"\\pi", turn)
    return style.coordinate(one, turn)


def _lines(one: Statement, style: Style) -> Iterator[tuple[str, str]]:
    latex = style.is_latex
    if isinstance(one, Remark):
        yield REMARK, one.text
    elif isinstance(one, Equation):
        yield EQUATION, f"{style.sum(one.left)} = {style.sum(one.right)}"
    elif isinstance(one, Let):
        yield FORMULA, f"{style.name(one.name)} = {style.let(one)}"
    elif isinstance(one, Root):
        square = style.sum(one.square)
        root = rf"\sqrt{{{square}}}" if latex else f"sqrt({square})"
        yield FORMULA, f"{style.name(one.name)} = {root}"
    elif isinstance(one, Branch):
        sign = style.name(one.sign)
        yield FORMULA, rf"{sign} = \pm 1" if latex else f"{sign} = 1  # +-1"
    elif isinstance(one, Trig):
        yield from _trig(one, style)
    elif isinstance(one, Upwards):
        yield from _upwards(one, style)
    elif isinstance(one, Require):
        yield REMARK, say("There is no solution but where")
        for left, right in one.pairs:
            yield EQUATION, f"{style.sum(left)} = {style.sum(right)}"
    elif isinstance(one, Across):
        yield from _across(one, style)
    elif isinstance(one, Posture):
        yield FORMULA, _posture(one, style)
    elif isinstance(one, Angle):
        yield FORMULA, f"{style.name(one.name)} = {style.angle(one)}"
    else:
        yield from _roots(one, style)


def _trig(one: Trig, style: Style) -> Iterator[tuple[str, str]]:
    argument = style.argument(one)
    if style.is_latex:
        inside = (
            argument if len(one.terms) == 1 and not one.constant else rf"\left({argument}\right)"
        )
        C, S = (style.name(f"{letter}{one.label}") for letter in "CS")
        yield FORMULA, rf"{C} = \cos {inside}, \quad {S} = \sin {inside}"
    else:
        yield FORMULA, f"C{one.label}, S{one.label} = cos({argument}), sin({argument})"


def _upwards(one: Upwards, style: Style) -> Iterator[tuple[str, str]]:
    first, *rest = map(style.sum, one.values)
    name = style.name(one.name)
    if style.is_latex:
        yield FORMULA, rf"{name} = \mathrm{{sgn}}\left({first}\right)"
        if rest:
            yield REMARK, say("Where that is 0, the sign of what comes next counts:")
            yield EQUATION, r", \quad ".join(rest)
        return
    if rest:
        yield (
            REMARK,
            say(
                "The sign of the first that is not 0 of {values}:", values=", ".join([first, *rest])
            ),
        )
    yield FORMULA, f"{name} = (1, -1)[{first} < 0]"


def _posture(one: Posture, style: Style) -> str:
    rule = style.sum(one.rule)
    first, second = one.names
    if style.is_latex:
        return rf"{rule} \geq 0: \; \mathrm{{{first}}}, \quad {rule} < 0: \; \mathrm{{{second}}}"
    return f'posture{one.choice + 1} = ("{first}", "{second}")[{rule} < 0]'


def _across(one: Across, style: Style) -> Iterator[tuple[str, str]]:
    names = [style.name(name) for name in one.names]
    v, n = ([*map(style.sum, vector)] for vector in (one.of[0], one.to))
    yield (
        REMARK,
        say(
            "The part of ({v}) across ({n}), divided by its length:",
            v=", ".join(map(PYTHON.sum, one.of[0])),
            n=", ".join(map(PYTHON.sum, one.to)),
        ),
    )
    if style.is_latex:
        left, first, second = (rf"\left({', '.join(part)}\right)" for part in (names, v, n))
        yield EQUATION, rf"v = {first}, \quad n = {second}"
        part = r"v - \left(v \cdot n\right) n"
        yield FORMULA, rf"{left} = \frac{{{part}}}{{\left|{part}\right|}}"
        return
    call = f"across(({', '.join(n)}), {one.least!r}, ({', '.join(v)}))"
    yield FORMULA, f"{', '.join(names)} = {call}"


def _roots(one: Roots, style: Style) -> Iterator[tuple[str, str]]:
    angle = style.name(one.name)
    k = [style.sum(value) for value in one.coefficients]
    yield (
        REMARK,
        say(
            "With t = tan({angle}/2) an equation of the fourth degree: up to four real roots.",
            angle=one.name,
        ),
    )
    if style.is_latex:
        C, S = rf"\cos {angle}", rf"\sin {angle}"
        parts = [
            k[0],
            *(
                f"{p} \\, {q}"
                for p, q in zip(k[1:], (C, S, rf"\cos^2 {angle}", rf"{C} \, {S}"), strict=True)
            ),
        ]
        yield FORMULA, f"{' + '.join(parts)} = 0"
        return
    yield EQUATION, f"{k[0]} + {k[1]}*C + {k[2]}*S + {k[3]}*C**2 + {k[4]}*C*S = 0"
    yield FORMULA, f"{angle} = angles({', '.join(k)})[0]  # 0, 1, 2, 3"


def text_lines(view: dict[str, Any], frame: str, base: str) -> list[str]:
    """Return the lines of a listing, valid in Python.

    Args:
        view: What :func:`model_view` gives.
        frame: Frame whose pose is the target.
        base: Frame in which it is given.
    """
    lines: list[str] = [chained("", ("# ", one)) for one in _about(view, frame, base)]
    for start, row in zip(("T = [", *["     "] * 3), view["target"], strict=True):
        lines.append(f"#   {start}[{', '.join(row)}]")
    for number, step in enumerate(view["steps"], start=1):
        lines += ["", chained("", (f"# {number}. ", step["title"]))]
        for line in step["lines"]:
            mark = {REMARK: "#    ", EQUATION: "#        "}.get(line["kind"], "")
            lines.append(chained("", (mark, line["text"])))
    lines += ["", chained("", ("# ", say("The joint coordinates, angles in (-pi, pi]")))]
    return [*lines, *(f"{name} = {value}" for name, value in view["q"].items())]


def latex_lines(view: dict[str, Any], frame: str, base: str) -> list[str]:
    """Return paragraphs and formulas in LaTeX; arguments as of :func:`text_lines`."""
    lines: list[str] = [latex_text(one) for one in _about(view, frame, base)]
    lines.append(f"\\[ T = {bracketed(view['target'])} \\]")
    for number, step in enumerate(view["steps"], start=1):
        title = latex_text(step["title"])
        lines += ["", chained("", (r"\textbf{", f"{number}. ", title, "}"))]
        for line in step["lines"]:
            if line["kind"] == REMARK:
                lines.append(chained("", ("\n", latex_text(line["text"]))))
            else:
                lines.append(f"\\[ {line['text']} \\]")
    lines += ["", latex_text(say("The joint coordinates, angles in (-pi, pi]"))]
    return [*lines, *(f"\\[ {name} = {value} \\]" for name, value in view["q"].items())]


def _about(view: dict[str, Any], frame: str, base: str) -> list[str]:
    return [
        chained("", (say("Inverse model"), ": ", view["description"], ".")),
        plural(
            "At most {count} solution.",
            "At most {count} solutions, one for each choice of the signs.",
            count=view["most_solutions"],
        ),
        say(
            "The target T is {frame} in {base}, with columns u, v, w (n, o, a of Paul) and the"
            " position X, Y, Z:",
            frame=frame,
            base=base,
        ),
    ]


def latex_text(text: str) -> str:
    """Return a sentence with its symbols as formulas, and what LaTeX takes for its own escaped."""
    if not isinstance(text, Message):
        return _escaped(text)
    if text.template is None:
        return chained("", (latex_text(str(part)) for part in text.values.values()))
    values = {
        name: latex_text(value) if isinstance(value, str) else value
        for name, value in text.values.items()
    }
    return text.having(**values)


def _escaped(text: str) -> str:
    if _SYMBOL.fullmatch(text):
        return f"${LATEX.name(text)}$"
    return _SPECIAL.sub(r"\\\1", text)
