"""Names of columns in a program: in comments beside a matrix, and of its variables."""

from __future__ import annotations

import re
from collections.abc import Sequence

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.headings import COLUMN_QUANTITIES, Heading, read_heading, unit_factor
from dh_to_urdf.pasted.programs.tree import Comment

MAX_COMMENT = 300
_VARIABLE = re.compile(
    r"(?:dh_?|link_?)?(a|d|r|alpha|alfa|theta|th|offset|theta_?offset|sigma|type|gamma|b)s?"
    r"(?:_?(?:i|list|vec|vector|values?|vals?|params?|arr|array|dh|all))?(?:_(deg|rad|mm|cm|m))?"
)
_KEYS = {"sigma": "type", "alfa": "alpha", "th": "theta"}
_UNIT_APART = re.compile(r"\s+(?=[\[(](?:deg|rad|degrees|radians|°|mm|cm|m)[\])])")
_OTHERS = {"offset", "type", "sign", "lower", "upper", "index", "name"}


def column_of_variable(name: str) -> Heading | None:
    """Return the column that a variable names (``alpha``, ``dh_a``, ``d_mm``), None for none."""
    match = _VARIABLE.fullmatch(name.lower())
    if match is None:
        return None
    stem = match[1].replace("_", "")
    key = "offset" if stem.endswith("offset") else _KEYS.get(stem, stem)
    return Heading(key, name, unit_factor(match[2]) if match[2] else None)


def in_comments(comments: Sequence[Comment], sizes: Sequence[int]) -> list[Heading] | None:
    """Return the columns that comments name, None where none does.

    Args:
        comments: The comments.
        sizes: Numbers of columns that there may be; a number of joints before them is dropped.

    Raises:
        DHError: Two comments name them in different orders.
    """
    found: list[tuple[int, list[Heading]]] = []
    for comment in comments:
        if len(comment.text) > MAX_COMMENT:
            continue
        run = _run(comment.text)
        if len(run) - 1 in sizes and run[0].key == "index":
            run = run[1:]
        if len(run) in sizes:
            found.append((comment.line, run))
    if not found:
        return None
    line, first = found[0]
    for other_line, other in found[1:]:
        if [heading.key for heading in other] != [heading.key for heading in first]:
            raise DHError.single(
                (),
                say(
                    "the comments of lines {line} and {other} name the columns in different"
                    " orders; keep one, or give columns=theta,d,a,alpha",
                    line=line,
                    other=other_line,
                ),
            )
    return first


def _run(text: str) -> list[Heading]:
    """Return the longest row of words that name columns, alpha among them."""
    text = _UNIT_APART.sub("", text.strip("%#/ \t"))
    words = [_bare(word) for word in re.split(r"[\s,;|&=:]+", text)]
    best: list[Heading] = []
    run: list[Heading] = []
    for word in [*words, ""]:
        heading = read_heading(word) if word else None
        known = heading is not None and (heading.key in COLUMN_QUANTITIES or heading.key in _OTHERS)
        if heading is not None and known:
            run.append(heading)
            continue
        keys = [one.key for one in run]
        named = set(keys) & set(COLUMN_QUANTITIES)
        if "alpha" in named and len(named) > 2 and len(keys) == len(set(keys)):
            best = max(best, run, key=len)
        run = []
    return best


def _bare(word: str) -> str:
    """Return a word without a bracket that is not closed within it."""
    word = word.strip(".'\"`")
    for opening, closing in ("[]", "()"):
        if word.count(opening) != word.count(closing):
            word = word.strip(opening + closing)
    return word


def of_rows(comments: Sequence[Comment], lines: Sequence[int]) -> list[Heading] | None:
    """Return the parameters that the comments at the ends of rows name, None for others.

    Args:
        comments: The comments.
        lines: Lines of the rows of a matrix.
    """
    by_line = {comment.line: comment.text for comment in comments}
    texts = [by_line.get(line, "").strip("%#/ \t:") for line in lines]
    found = [read_heading(text) if text else None for text in texts]
    keys = [heading.key for heading in found if heading is not None]
    if len(keys) != len(lines) or "alpha" not in keys or len(set(keys)) != len(keys):
        return None
    return [heading for heading in found if heading is not None]
