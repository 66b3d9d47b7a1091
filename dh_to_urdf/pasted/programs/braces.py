"""Arrays of C, Java and Mathematica, in braces -> lists in brackets."""

from __future__ import annotations

import re

_NESTED = re.compile(r"\{\s*\{[^{}=:\\\n]*\}")
_DECLARATION = re.compile(
    r"^[ \t]*(?:(?:static|const|constexpr|final|public|private|auto|var|let|inline|float|double"
    r"|real)\b[ \t]*)*(?:std::\w+\s*<[^;={}]{1,60}>\s*)?(?:\[\s*\]\s*)*"
    r"(\w+)[ \t]*(?:\[[^\]\n]{0,20}\][ \t]*){0,3}:?=?[ \t]*(?=\{)",
    re.MULTILINE,
)


def with_brackets(text: str) -> str:
    """Return a text whose nested braces are brackets and whose comments are those of Python.

    Other texts are returned as they are.
    """
    if _NESTED.search(text) is None or "\\" in text or re.search(r"\{[^{}]*:", text):
        return text
    text = re.sub(r"/\*(.*?)\*/", lambda found: "# " + found[1].strip(), text)
    text = re.sub(r"//", "#", text)
    text = _DECLARATION.sub(r"\1 = ", text)
    text = re.sub(r"\}\s*;", "}", text)
    return text.translate(str.maketrans("{}", "[]"))
