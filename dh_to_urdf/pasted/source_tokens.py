"""Tokens of MATLAB and Python text, as far as tables need them; nothing is ever run."""

from __future__ import annotations

import re
from dataclasses import dataclass

from dh_to_urdf.errors import DHError, DHSyntaxError
from dh_to_urdf.messages import say

MAX_TOKENS, MAX_DEPTH = 40_000, 20
_NUMBER = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_TOKEN = re.compile(
    rf"(?P<space>[ \t\r\f\v]+)|(?P<newline>\n)|(?P<comment>[%#][^\n]*)|(?P<joined>\.\.\.[^\n]*\n)"
    rf"|(?P<number>{_NUMBER})|(?P<word>[^\W\d]\w*(?:\.[^\W\d]\w*)*)"
    r"|(?P<string>'[^'\n]*'|\"[^\"\n]*\")|(?P<symbol>.)",
    re.DOTALL,
)
_PAIRS = {"(": ")", "[": "]", "{": "}"}
_PREFIX = re.compile(r"^(?:np|numpy|math|rtb|roboticstoolbox|sym|sp|sympy)\.")


@dataclass(frozen=True, slots=True)
class Token:
    """A token.

    Attributes:
        kind: ``number``, ``word``, ``string`` (text without quotes), ``symbol``, ``newline``,
            ``comment``, or ``end`` of a program.
        text: What it says.
        line: From 1.
        spaced: Whether blanks stand before it.
    """

    kind: str
    text: str
    line: int
    spaced: bool


def tokens_of(text: str) -> list[Token]:
    """The tokens of a text; prefixes such as ``np.`` are taken off words.

    Raises:
        DHError: Too many tokens.
    """
    tokens: list[Token] = []
    line, spaced = 1, False
    for match in _TOKEN.finditer(text):
        kind, found = match.lastgroup or "", match[0]
        if kind in ("space", "joined"):
            spaced = True
        else:
            if kind == "string":
                found = found[1:-1]
            elif kind == "word":
                found = _PREFIX.sub("", found)
            tokens.append(Token(kind, found, line, spaced))
            spaced = False
            if len(tokens) > MAX_TOKENS:
                raise DHError.single((), say("the text is too long for a table"))
        line += match[0].count("\n")
    return tokens


def closing(tokens: list[Token], start: int) -> int:
    """Index of the bracket that closes the one at ``start``.

    Raises:
        DHError: It is never closed, or by another kind.
    """
    stack: list[str] = []
    for index in range(start, len(tokens)):
        token = tokens[index]
        if token.kind != "symbol":
            continue
        if token.text in _PAIRS:
            stack.append(_PAIRS[token.text])
            if len(stack) > MAX_DEPTH:
                raise DHSyntaxError.single(
                    (), say("line {line}: brackets are nested too deeply", line=token.line)
                )
        elif stack and token.text in ")]}":
            if token.text != stack.pop():
                raise DHSyntaxError.single(
                    (),
                    say("line {line}: {token!r} closes nothing", line=token.line, token=token.text),
                )
            if not stack:
                return index
    opened = tokens[start]
    raise DHSyntaxError.single(
        (), say("line {line}: {opened!r} is never closed", line=opened.line, opened=opened.text)
    )


def text_of(tokens: list[Token]) -> str:
    """Tokens as one text again."""
    parts = []
    for index, token in enumerate(tokens):
        if token.kind in ("newline", "comment"):
            continue
        parts.append((" " if token.spaced and index else "") + token.text)
    return "".join(parts)


def arguments(tokens: list[Token]) -> list[list[Token]]:
    """Tokens between commas that stand in no bracket."""
    found: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        if token.kind in ("newline", "comment"):
            continue
        if token.kind == "symbol":
            depth += (token.text in _PAIRS) - (token.text in ")]}")
            if token.text == "," and depth == 0:
                found.append([])
                continue
        found[-1].append(token)
    return [argument for argument in found if argument]


def matrix_rows(tokens: list[Token]) -> list[list[list[Token]]]:
    """Elements of the rows between brackets (the outer ones taken off).

    ``[1 -2; 3, 4]`` has rows apart by ``;`` or line ends and elements apart by blanks or commas;
    ``[[1, -2], [3, 4]]`` has a bracket a row.
    """
    plain = [token for token in tokens if token.kind != "comment"]
    rows: list[list[list[Token]]] = []
    first = next((token for token in plain if token.kind != "newline"), None)
    if first is not None and first.kind == "symbol" and first.text in "[(" and _nested(plain):
        inner = [token for token in plain if token.kind != "newline"]
        index = 0
        while index < len(inner):
            if inner[index].kind == "symbol" and inner[index].text in "[(":
                end = closing(inner, index)
                rows.append(_elements(inner[index + 1 : end]))
                index = end
            index += 1
        return rows
    row: list[Token] = []
    depth = 0
    for token in plain:
        if token.kind == "symbol":
            depth += (token.text in _PAIRS) - (token.text in ")]}")
        if depth == 0 and (token.kind == "newline" or token.text == ";"):
            rows.append(_elements(row))
            row = []
        elif token.kind != "newline":
            row.append(token)
    rows.append(_elements(row))
    return [row for row in rows if row]


def _nested(tokens: list[Token]) -> bool:
    """True for rows in brackets: the first bracket closes before a comma, a ``;`` or the end."""
    start = next(i for i, token in enumerate(tokens) if token.kind != "newline")
    end = closing(tokens, start)
    after = next((t for t in tokens[end + 1 :] if t.kind != "newline"), None)
    inside = tokens[start + 1 : end]
    return (after is None or after.text in (",", ";")) and any(t.text == "," for t in inside)


def _elements(tokens: list[Token]) -> list[list[Token]]:
    found: list[list[Token]] = []
    depth, apart = 0, True
    for index, token in enumerate(tokens):
        symbol = token.kind == "symbol"
        if symbol and token.text == "," and depth == 0:
            apart = True
            continue
        before = tokens[index - 1] if index else None
        if depth == 0 and not apart and token.spaced and before is not None:
            operand_before = before.kind != "symbol" or before.text in ")]}'°"
            tight = index + 1 < len(tokens) and not tokens[index + 1].spaced
            starts = not symbol or token.text in "([{'" or (token.text in "+-−" and tight)
            apart = operand_before and starts
        if apart:
            found.append([])
            apart = False
        found[-1].append(token)
        if symbol:
            depth += (token.text in _PAIRS) - (token.text in ")]}")
    return found
