"""Answers as lines of text in the notation of lectures, or as LaTeX."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from dh_to_urdf.messages import chained, say
from kinematics.symbolic.inverse_model.view import latex_lines, text_lines
from kinematics.symbolic.latex import bracketed

WIDTH = 100
_AXES = {"x": "u", "y": "v", "z": "w"}
"""Letters of the tip's axes beside X, Y, Z of the position."""


def text_listing(answer: Mapping[str, Any]) -> str:
    """Return lines ``X = …``, after the definitions of the short names; valid in Python."""
    lines: list[str] = [chained("", ("# ", line)) for line in _heading(answer)]
    lines += [f"{name} = {value!r}" for name, value in answer["values"].items()]
    lines += [f"{name} = {value}" for name, value in answer["definitions"].items()]
    for block in _blocks(answer):
        lines += ["", *block]
    if answer.get("inverse"):
        lines += ["", *text_lines(answer["inverse"], answer["frame"], answer["base"])]
    lines += [chained("", ("# ", note)) for note in answer["notes"]]
    return chained("\n", (*lines, ""))


def latex_listing(answer: Mapping[str, Any]) -> str:
    r"""Return ``\[ … \]`` for each quantity, after the values of the lengths as a comment."""
    lines: list[str] = [chained("", ("% ", line)) for line in _heading(answer)]
    lines += [f"% {name} = {value!r}" for name, value in answer["values"].items()]
    for label, rows in _matrices(answer):
        lines.append(f"\\[ {label} = {bracketed(rows)} \\]")
    inverse = answer.get("inverse_jacobian")
    if inverse:
        over = "" if inverse["divisor"] == "1" else f"\\frac{{1}}{{{inverse['divisor']}}} "
        lines.append(f"\\[ J^{{-1}} = {over}{bracketed(inverse['matrix'])} \\]")
    aligned = [f"{label} &= {entry}" for label, entry in _single(answer, latex=True)]
    if aligned:
        joined = " \\\\\n".join(aligned)
        lines.append(f"\\[ \\begin{{aligned}}\n{joined}\n\\end{{aligned}} \\]")
    if answer.get("inverse"):
        lines += latex_lines(answer["inverse"], answer["frame"], answer["base"])
    lines += [chained("", ("% ", note)) for note in answer["notes"]]
    return chained("\n", (*lines, ""))


def _heading(answer: Mapping[str, Any]) -> list[str]:
    joints = ", ".join(f"q{k} = {name}" for k, name in enumerate(answer["columns"], start=1))
    return [
        say(
            "{frame} in {base}, {convention} convention; rad, m",
            frame=answer["frame"],
            base=answer["base"],
            convention=answer["convention"],
        ),
        joints,
    ]


def _blocks(answer: Mapping[str, Any]) -> list[list[str]]:
    blocks = []
    for label, rows in _matrices(answer):
        blocks.append(_matrix_lines(label, rows))
    inverse = answer.get("inverse_jacobian")
    if inverse:
        blocks.append(
            [
                f"J_divisor = {inverse['divisor']}",
                *_matrix_lines("J_adjugate", inverse["matrix"]),
                say("# the inverse of J is J_adjugate / J_divisor"),
            ]
        )
    single = [f"{label} = {entry}" for label, entry in _single(answer, latex=False)]
    return [*blocks, *([single] if single else [])]


def _matrices(answer: Mapping[str, Any]) -> list[tuple[str, list[list[str]]]]:
    latex = answer["notation"] == "latex"
    found = []
    for k, grid in enumerate(answer.get("A") or (), start=1):
        found.append((f"A_{{{k}}}" if latex else f"A{k}", grid))
    for k, grid in enumerate(answer.get("T0") or (), start=1):
        found.append((f"{{}}^{{0}}A_{{{k}}}" if latex else f"T0_{k}", grid))
    for name, label in (("T", "T"), ("jacobian", "J")):
        if answer.get(name):
            grid = answer[name]["matrix"] if name == "jacobian" else answer[name]
            found.append((label, grid))
    return found


def _single(answer: Mapping[str, Any], *, latex: bool) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    for axis, column in (answer.get("rotation") or {}).items():
        for row, entry in zip("xyz", column, strict=True):
            letter = _AXES[axis]
            found.append((f"{letter}_{row}" if latex else f"{letter}{row}", entry))
    found += list((answer.get("position") or {}).items())
    determinant = answer.get("det_jacobian")
    if not determinant:
        return found
    if determinant["expression"] is not None:
        found.append((r"\det J" if latex else "det_J", determinant["expression"]))
    for minor in determinant.get("minors", ()):
        if minor["expression"] is None:
            continue
        numbers = [answer["columns"].index(name) + 1 for name in minor["without"]]
        without = ",".join(map(str, numbers)) if latex else "_".join(map(str, numbers))
        label = rf"\det J_{{\setminus {without}}}" if latex else f"det_J_without_{without}"
        found.append((label, minor["expression"]))
    return found


def _matrix_lines(label: str, rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(row[j]) for row in rows) for j in range(len(rows[0]))]
    if sum(widths) + 2 * len(widths) + len(label) + 6 <= WIDTH:
        lines = []
        for i, row in enumerate(rows):
            start = f"{label} = [[" if i == 0 else " " * (len(label) + 4) + "["
            cells = ", ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True))
            lines.append(f"{start}{cells}{']]' if i == len(rows) - 1 else '],'}")
        return lines
    return [
        f"{label}_{i}{j} = {cell}"
        for i, row in enumerate(rows[:3] if len(rows) == 4 else rows, start=1)
        for j, cell in enumerate(row, start=1)
    ]
