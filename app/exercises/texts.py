"""What students read, in the languages that there are files for."""

from __future__ import annotations

from functools import cache
from typing import Any

from fastapi import Request

from app.exercises.catalogue import read_yaml_file
from app.http.language import language_of as spoken_in

LANGUAGES = ("en", "fr")


@cache
def texts(language: str) -> Any:
    """Return the texts of a language: ``words``, ``forms``, ``exercises`` by name."""
    return read_yaml_file("texts", language)


def language_of(request: Request) -> str:
    """Return the language of an answer, of those that there are texts in."""
    code = spoken_in(request).code
    return code if code in LANGUAGES else LANGUAGES[0]
