"""What students read, in the languages that there are files for."""

from __future__ import annotations

from functools import cache
from typing import Any

from fastapi import Request

from app.exercises.catalogue import read_yaml_file
from app.http.negotiation import accepted_ranges
from app.http.problems import INVALID_REQUEST, RequestProblem

LANGUAGES = ("en", "fr")


@cache
def texts(language: str) -> Any:
    """Return the texts of a language: ``words``, ``forms``, ``exercises`` by name."""
    return read_yaml_file("texts", language)


def language_of(request: Request) -> str:
    """Return the language of an answer: ``?lang=``, else ``Accept-Language``, else English.

    Raises:
        RequestProblem: ``lang`` is none of the languages.
    """
    named = request.query_params.get("lang")
    if named is not None:
        if named not in LANGUAGES:
            raise RequestProblem(
                INVALID_REQUEST, f"lang is {named[:16]!r}; give {' or '.join(LANGUAGES)}", "/lang"
            )
        return named
    ranges = accepted_ranges(request.headers.get("accept-language", ""))
    for tag, (weight, _) in sorted(ranges.items(), key=lambda item: item[1]):
        short = tag.split("-")[0]
        if short in LANGUAGES and weight < 0.0:
            return short
    return LANGUAGES[0]
