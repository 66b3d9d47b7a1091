"""Which language a request asks for, and the headers that tell it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from fastapi import Request

from app.http.ranges import accepted_ranges
from dh_to_urdf.languages import ENGLISH, Language, codes, language


def language_of(request: Request) -> Language:
    """Return the language of the answer: ``?lang=`` if given, else the best of Accept-Language.

    English where neither names one that is spoken; what is wrong with ``lang`` is said by
    :func:`app.http.query.check_query`, in this language.
    """
    if b"lang=" in request.scope["query_string"]:
        named = request.query_params.get("lang")
        if named in codes():
            return language(named)
    accept = request.headers.get("accept-language")
    return ENGLISH if not accept else _best(accept)


@lru_cache(maxsize=64)
def _best(accept: str) -> Language:
    """Return the language of the first range with the greatest weight (RFC 4647, lookup)."""
    for name, (weight, _) in sorted(accepted_ranges(accept).items(), key=lambda item: item[1]):
        code = name.partition("-")[0]
        if weight < 0 and code in codes():
            return language(code)
        if weight < 0 and code in ("*", "*/*"):
            break
    return ENGLISH


def language_headers(spoken: Language, headers: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return headers with those of an answer that is written in a language."""
    found = {} if headers is None else dict(headers)
    vary = found.get("Vary")
    found["Vary"] = f"{vary}, Accept-Language" if vary else "Accept-Language"
    found["Content-Language"] = spoken.code
    return found
