"""What is left in English in an answer in the language of :mod:`tests.messages.pseudo`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

_WORDS = re.compile(
    r"(?<![\w/.$<_-])(?:the|is|are|was|were|be|of|give|gives|which|and|with|has|have|not|from|than"
    r"|that|this|its|only|must|write|keep|remove|known|more|most|beyond|cannot|each|would|for"
    r"|or|in|an|no|as|on|it|one|at|by|if|so)(?![\w/=.\[(:_-])"
)
_QUOTED = re.compile(r"'(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\"|'[^']*…|<[^>]*>")
_OF_OTHERS = re.compile(r" *(?:ｔｉｔｌｅ|ｓｏｕｒｃｅ): ")
"""Lines of text with what others have written."""
DATA = frozenset(
    {"title", "source", "id", "name", "href", "filename", "code", "docs", "guide", "openapi", "try"}
    | {"request_id", "type", "media_type", "robots", "revision", "pointer", "next_page_token"}
    | {"frame", "frames", "base_frame", "tip_frame", "joint", "joints", "columns", "link", "links"}
    | {"method", "label", "reference_frame", "posture", "axes"}
)
"""Fields that hold names, codes and texts of others."""


def english(kind: str, text: str) -> list[str]:
    """Return the sentences, or parts of them, that are in English.

    Args:
        kind: Media type of the answer.
        text: The answer.
    """
    if kind.endswith("json"):
        lines = text.splitlines() if kind.endswith("ndjson") else [text]
        found = [one for line in lines if line for one in _texts(json.loads(line))]
    else:
        found = [line for line in text.splitlines() if not _OF_OTHERS.match(line)]
    return [one for one in found if _WORDS.search(_QUOTED.sub("'…'", one))]


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in DATA:
                yield from _texts(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _texts(inner)
    elif isinstance(value, str):
        yield value
