"""The text of a SYMORO ``.par`` file: comments, scalars and lists, without their meaning."""

from __future__ import annotations

import re
from dataclasses import dataclass

from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.messages import say

MAX_PAR_LENGTH = 500_000
GEOMETRY = ("ant", "sigma", "b", "d", "r", "gamma", "alpha", "mu", "theta")
DYNAMICS = (
    *("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M"),
    *("IA", "FV", "FS", "FX", "FY", "FZ", "CX", "CY", "CZ"),
)
MOTION = ("eta", "k", "QP", "QDP", "GAM", "GAMMA", "W0", "WP0", "V0", "VP0", "G", "Z")
SCALARS = ("NF", "NL", "NJ", "Type", "is_mobile", "is_floating")
_STATEMENT = re.compile(r"\s*([A-Za-z_]\w{0,31})[ \t]*=\s*(?:\{([^{}=]*)\}|([^\s{}=][^\n{}=]*))")
_ROBOT_NAME = re.compile(r"\s*Robotname\s*=\s*'([^'\n]{0,200})'")


@dataclass(frozen=True)
class ParText:
    """Content of a file.

    Attributes:
        lists: Entries of ``key = {…}``; keys of the geometry in lower case.
        scalars: Texts of ``key = …``.
        comments: Texts between ``(*`` and ``*)``.
    """

    lists: dict[str, list[str]]
    scalars: dict[str, str]
    comments: list[str]

    @property
    def robot_name(self) -> str | None:
        """Return the name in the comment ``(* Robotname = '…' *)``."""
        for comment in self.comments:
            match = _ROBOT_NAME.match(comment)
            if match:
                return match[1].strip()
        return None


def parse_par(text: str | bytes) -> ParText:
    """Read the statements of a file.

    Raises:
        DHError: Too long, no statements of this format, or a key that is unknown or stands twice.
    """
    if len(text) > MAX_PAR_LENGTH:
        raise DHError.single(
            (),
            say(
                "the .par text is longer than {max_par_length} characters",
                max_par_length=MAX_PAR_LENGTH,
            ),
        )
    code, comments = _without_comments(_decoded(text))
    lists: dict[str, list[str]] = {}
    scalars: dict[str, str] = {}
    position, end = 0, len(code.rstrip())
    while position < end:
        match = _STATEMENT.match(code, position)
        if match is None:
            raise _stray(code, position)
        key, inside, scalar = match[1], match[2], match[3]
        if key.lower() in GEOMETRY and key != "GAMMA":
            key = key.lower()
        known = (*GEOMETRY, *DYNAMICS, *MOTION) if inside is not None else SCALARS
        if key not in known:
            line = code.count("\n", 0, match.start(1)) + 1
            what = say("list") if inside is not None else say("parameter")
            raise DHError.single(
                (key,),
                say(
                    "line {line}: {key} is no {what} of SYMORO; known are {known}",
                    line=line,
                    key=key,
                    what=what,
                    known=", ".join(known),
                ),
            )
        if key in lists or key in scalars:
            raise DHError.single((key,), say("{key} stands twice; keep one", key=key))
        if inside is not None:
            lists[key] = _entries(inside)
        else:
            scalars[key] = scalar.strip()
        position = match.end()
    if not lists:
        raise DHSyntaxError.single(
            (), say("the text is no .par file: it has no list such as Alpha = {{…}}")
        )
    return ParText(lists, scalars, comments)


def _decoded(text: str | bytes) -> str:
    """Decode UTF-8, or Latin-1 as SYMORO+ wrote it."""
    if isinstance(text, str):
        return text.lstrip("\ufeff")
    try:
        return text.decode("utf-8-sig")
    except UnicodeDecodeError:
        return text.decode("latin-1")


def _without_comments(text: str) -> tuple[str, list[str]]:
    """Return the text with comments blanked out, and the comments; they may be nested."""
    code: list[str] = []
    comments: list[str] = []
    depth = start = kept = 0
    for match in re.finditer(r"\(\*|\*\)", text):
        if match[0] == "(*":
            if depth == 0:
                code.append(text[kept : match.start()])
                start = match.end()
            depth += 1
        elif depth:
            depth -= 1
            if depth == 0:
                comments.append(text[start : match.start()].strip())
                code.append("\n" * text.count("\n", start, match.start()) + " ")
                kept = match.end()
    if depth:
        line = text.count("\n", 0, start) + 1
        raise DHSyntaxError.single(
            (), say("line {line}: the comment is not closed; write *)", line=line)
        )
    code.append(text[kept:])
    return "".join(code), comments


def _stray(code: str, position: int) -> DHSyntaxError:
    rest = code[position : position + 2000].lstrip()
    at = len(code) - len(code[position:].lstrip())
    line = code.count("\n", 0, at) + 1
    shown = rest.partition("\n")[0]
    return DHSyntaxError.single(
        (),
        say(
            "line {line}: {shown} is neither key = number nor key = {{…}}",
            line=line,
            shown=quoted(shown),
        ),
    )


def _entries(inside: str) -> list[str]:
    """Split entries at commas outside parentheses (``atan2(y, x)``)."""
    if not inside.strip():
        return []
    entries, depth, start = [], 0, 0
    for match in re.finditer(r"[(),]", inside):
        if match[0] == "(":
            depth += 1
        elif match[0] == ")":
            depth = max(0, depth - 1)
        elif depth == 0:
            entries.append(inside[start : match.start()].strip())
            start = match.end()
    entries.append(inside[start:].strip())
    return entries
