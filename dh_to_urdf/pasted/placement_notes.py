"""Base and tool beside a pasted table: ``tool = [1 0 0 0; 0 1 0 0; 0 0 1 0.1; 0 0 0 1]``."""

from __future__ import annotations

import re
from typing import Any

from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.pose_text import printed_pose
from dh_to_urdf.pasted.source_tokens import closing, matrix_rows, text_of, tokens_of

_NOTE = re.compile(
    r"^[ \t%#<>!*|\-]{0,20}(?:[^\W\d]\w{0,30}[ \t]?\.[ \t]?)?"
    r"(base|tool|outil)[ \t]{0,20}[=:][ \t]{0,20}(?=\S|\n[ \t]+[-\d])",
    re.IGNORECASE | re.MULTILINE,
)
_KEYS = {"base": "base", "tool": "tool", "outil": "tool"}
_NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
_WRITTEN = re.compile(
    r"[ \t]?:[ \t]*(?:(?:identity|identité)[ \t]*$"
    rf"|(?P<rows>(?:\n[ \t]+{_NUMBER}(?:[ \t]+{_NUMBER}){{3}}[ \t]*){{4}})$)",
    re.MULTILINE,
)
"""Base and tool as this service writes them in texts."""
_POSE = re.compile(r"t[ \t]*=[^\n]{1,200}")
_REST = re.compile(r"[ \t;>|\-]{0,20}$", re.MULTILINE)


def placement_notes(text: str) -> tuple[str, dict[str, Any]]:
    """Extract ``base = [4x4]`` and ``tool = [4x4]`` from a text.

    Args:
        text: The text.

    Returns:
        The text with these lines blanked, and the fields of the document.

    Raises:
        DHError: A base or tool in another form, or twice.
    """
    placements: dict[str, Any] = {}
    parts: list[str] = []
    kept = 0
    for match in _NOTE.finditer(text):
        if match.start() < kept:
            continue
        key, line = _KEYS[match[1].lower()], text.count("\n", 0, match.start()) + 1
        written = _WRITTEN.match(text, match.end(1))
        if written and key not in placements:
            if written["rows"]:
                lines = written["rows"].strip().splitlines()
                placements[key] = {"matrix": [row.split() for row in lines]}
            parts += [
                text[kept : match.start()],
                "\n" * text.count("\n", match.start(), written.end()),
            ]
            kept = written.end()
            continue
        pose = _POSE.match(text, match.end())
        T = printed_pose(pose[0]) if pose else None
        if pose and T is not None and key not in placements:
            placements[key] = {"matrix": T.tolist()}
            parts.append(text[kept : match.start()])
            kept = pose.end()
            continue
        if key in placements:
            raise DHError.single(
                (key,), say("line {line}: {key} stands twice; keep one", line=line, key=key)
            )
        rows, end = _matrix(text, match.end())
        if [len(row) for row in rows] != [4, 4, 4, 4]:
            shown = text[match.end() : match.end() + 60].partition("\n")[0]
            raise DHError.single(
                (key,),
                say(
                    "line {line}: {key} is {shown}; write its 4x4 matrix on one line, as"
                    " {key} = [1 0 0 0; 0 1 0 0; 0 0 1 0.1; 0 0 0 1]",
                    line=line,
                    key=key,
                    shown=quoted(shown),
                ),
            )
        placements[key] = {"matrix": rows}
        parts += [text[kept : match.start()], "\n" * text.count("\n", match.start(), end)]
        rest = _REST.match(text, end)
        kept = rest.end() if rest else end
    parts.append(text[kept:])
    return "".join(parts), placements


def without_notes(text: str) -> str:
    """Return a text without what :func:`placement_notes` extracts, faults passed over."""
    parts, kept = [], 0
    for match in _NOTE.finditer(text):
        if match.start() >= kept:
            parts.append(text[kept : match.start()])
            kept = _matrix(text, match.end())[1]
    return "".join([*parts, text[kept:]])


def _matrix(text: str, start: int) -> tuple[list[list[str]], int]:
    """Return the rows of the bracket that starts here, and its end; no rows if there is none."""
    if text[start] != "[":
        return [], start
    depth = 0
    for end in range(start, min(len(text), start + 2000)):
        depth += (text[end] == "[") - (text[end] == "]")
        if depth == 0:
            tokens = tokens_of(text[start : end + 1])
            inside = tokens[1 : closing(tokens, 0)]
            return [[text_of(element) for element in row] for row in matrix_rows(inside)], end + 1
    return [], start
