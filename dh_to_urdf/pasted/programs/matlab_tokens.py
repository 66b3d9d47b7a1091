"""MATLAB and Octave text -> tokens, with comments, continued lines and block comments."""

from __future__ import annotations

import re

from dh_to_urdf.errors import DHError, DHSyntaxError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.tree import Comment
from dh_to_urdf.pasted.source_tokens import MAX_TOKENS, Token

_NUMBER = r"(?:[0-9]+(?:\.(?![*/^'])[0-9]*)?|\.[0-9]+)(?:[eEdD][+-]?[0-9]+)?"
_TOKEN = re.compile(
    rf"(?P<space>[ \t\r\f\v\u00a0]+)|(?P<newline>\n)|(?P<joined>\.\.\.[^\n]*\n?)"
    rf"|(?P<comment>[%#][^\n]*)|(?P<number>{_NUMBER})|(?P<word>[^\W\d]\w*)"
    r"|(?P<symbol>\+\+|--|&&|\|\||==|~=|!=|<=|>=|\.\*|\./|\.\\|\.\^|\.'|\+=|-=|\*=|/=|.)",
    re.DOTALL,
)
_SINGLE = re.compile(r"'((?:[^'\n]|'')*)'")
_DOUBLE = re.compile(r'"((?:[^"\n]|"")*)"')
_SIGNS = str.maketrans({"−": "-", "–": "-", "‘": "'", "’": "'", "“": '"', "”": '"'})


def matlab_tokens(text: str) -> tuple[list[Token], tuple[Comment, ...]]:
    """Return the tokens of a text, and its comments.

    Raises:
        DHError: Too many tokens.
        DHSyntaxError: A text that is not closed on its line.
    """
    text = text.translate(_SIGNS)
    tokens: list[Token] = []
    comments: list[Comment] = []
    position, line, spaced, depth = 0, 1, False, 0
    while position < len(text):
        found = _TOKEN.match(text, position)
        assert found is not None
        kind, word = found.lastgroup or "", found[0]
        if kind == "comment" and _opens_block(text, position, word):
            end = _block_end(text, position)
            comments.extend(
                Comment(line + k, part.strip("%# \t"))
                for k, part in enumerate(text[position:end].split("\n"))
            )
            line += text.count("\n", position, end)
            position = end
            continue
        if kind == "symbol" and word in ("'", '"') and not _transposes(tokens, spaced, word, depth):
            quotes = (_SINGLE if word == "'" else _DOUBLE).match(text, position)
            if quotes is None:
                raise DHSyntaxError.single(
                    (),
                    say("line {line}: the text after {word} is not closed", line=line, word=word),
                )
            tokens.append(Token("string", quotes[1].replace(word * 2, word), line, spaced))
            position, spaced = quotes.end(), False
            continue
        position = found.end()
        if kind == "comment":
            comments.append(Comment(line, word.strip("%# \t")))
        elif kind in ("space", "joined"):
            spaced = True
        else:
            if word in ("[", "{"):
                depth += 1
            elif word in ("]", "}"):
                depth -= 1
            tokens.append(Token(kind, word, line, spaced))
            spaced = False
            if len(tokens) > MAX_TOKENS:
                raise DHError.single((), say("the text is too long for a table"))
        line += word.count("\n")
    tokens.append(Token("newline", "\n", line, False))
    tokens.append(Token("end", "", line, False))
    return tokens, tuple(comments)


def _transposes(tokens: list[Token], spaced: bool, quote: str, depth: int) -> bool:
    """Return whether a quote stands right after an operand and is a transpose."""
    if quote != "'" or not tokens or (spaced and depth):
        return False
    last = tokens[-1]
    operand = last.kind in ("number", "word") or last.text in (")", "]", "}", "'", ".'")
    return operand and last.kind != "string" and not (spaced and last.kind == "word")


def _opens_block(text: str, position: int, comment: str) -> bool:
    start = text.rfind("\n", 0, position) + 1
    return comment.strip() in ("%{", "#{") and not text[start:position].strip()


def _block_end(text: str, position: int) -> int:
    """Return where a block comment ends; blocks within it are part of it."""
    depth, end = 0, position
    while end < len(text):
        stop = text.find("\n", end)
        stop = len(text) if stop < 0 else stop
        mark = text[end:stop].strip()
        depth += (mark in ("%{", "#{")) - (mark in ("%}", "#}"))
        if depth == 0:
            return stop
        end = stop + 1
    return len(text)
