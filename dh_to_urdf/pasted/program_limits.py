"""What is never run: comments, loops that make links, arithmetic on a whole matrix, later changes.

All but comments would give another table than the numbers as they stand, and are refused.
"""

from __future__ import annotations

from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.pasted.source_tokens import Token, closing, text_of

_LOOPS = ("for", "while", "parfor")
_ARRAYS = ("array", "asarray", "matrix", "Matrix", "mat", "sym", "double", "tensor", "return")
_ALONE = "paste the table with its numbers as they are used"


def without_blocks(text: str) -> str:
    """The text with block comments (``%{`` to ``%}``) and triple-quoted strings blanked out."""
    lines: list[str] = []
    inside = False
    for line in text.split("\n"):
        mark = line.strip()
        inside = inside or mark == "%{"
        lines.append("" if inside else line)
        inside = inside and mark != "%}"
    text = text if inside else "\n".join(lines)
    for quotes in ('"""', "'''"):
        parts = text.split(quotes)
        if len(parts) % 2:
            parts[1::2] = ["\n" * part.count("\n") for part in parts[1::2]]
            text = "".join(parts)
    return text


def refuse_loops(tokens: list[Token], end: int) -> None:
    """Refuses a loop before the token ``end`` of the last link, or on its line.

    Raises:
        DHError: There is one.
    """
    last = tokens[min(end, len(tokens) - 1)].line
    for index, token in enumerate(tokens):
        if index > end and token.line > last:
            return
        if token.kind == "word" and token.text in _LOOPS:
            raise DHError.single(
                (), f"line {token.line}: a loop is not run; write each link on a line of its own"
            )


def refuse_reworked_list(tokens: list[Token], end: int) -> None:
    """Refuses ``[…]*3`` and ``[…][::-1]`` of a list that ends at ``end``.

    Raises:
        DHError: Something is done to the list.
    """
    after = tokens[end + 1] if end + 1 < len(tokens) else None
    if after is not None and after.kind == "symbol" and after.text in "*[+":
        raise DHError.single(
            (),
            f"line {after.line}: {quoted(after.text)} after the list of links is not run;"
            " write each link on a line of its own",
        )


def refuse_reworked_matrix(tokens: list[Token], start: int, name: str) -> None:
    """Refuses a matrix that the text scales, transposes or changes.

    Args:
        tokens: The text.
        start: Index of its opening bracket.
        name: What it is assigned to, if anything.

    Raises:
        DHError: With the line of what is done to it.
    """
    line, before = tokens[start].line, start - 1
    while before >= 0 and (tokens[before].text == "(" or tokens[before].text in _ARRAYS):
        before -= 1
    if before >= 0 and not _ends(tokens[before]) and tokens[before].text != "=":
        raise DHError.single(
            (), f"line {line}: {quoted(tokens[before].text)} before the matrix is not run; {_ALONE}"
        )
    after = closing(tokens, start) + 1
    while after < len(tokens) and tokens[after].text == ")":
        after += 1
    if text_of(tokens[after : after + 3]).replace(" ", "") == ",dtype=":
        after += 4
    while after < len(tokens) and tokens[after].text == ")":
        after += 1
    if after < len(tokens) and not _ends(tokens[after]):
        raise DHError.single(
            (),
            f"line {tokens[after].line}: {quoted(tokens[after].text)} after the matrix is not"
            f" run; {_ALONE}",
        )
    for index, token in enumerate(tokens):
        starts = index == 0 or tokens[index - 1].kind in ("newline", "comment")
        starts = starts or tokens[index - 1].text == ";"
        if not name or token.kind != "word" or token.text != name or not starts:
            continue
        equals = _equals(tokens, index + 1)
        if equals is not None and equals != before:
            raise DHError.single(
                (), f"line {token.line}: {quoted(name)} is set more than once; {_ALONE}"
            )


def _equals(tokens: list[Token], index: int) -> int | None:
    """Index of the = of ``(:, 3) =``, ``[0] *=`` or ``=``; None if no such thing stands here."""
    while index < len(tokens) and tokens[index].text in ("(", "["):
        index = closing(tokens, index) + 1
    if index < len(tokens) and tokens[index].text in ("+", "-", "*", "/"):
        index += 1
    return index if index < len(tokens) and tokens[index].text == "=" else None


def _ends(token: Token) -> bool:
    """Whether a token stands between statements."""
    return token.kind in ("newline", "comment") or (token.kind == "symbol" and token.text in ";,")
