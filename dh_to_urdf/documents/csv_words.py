"""Column names and joint types of CSV tables, in every language."""

from __future__ import annotations

import unicodedata
from functools import cache

from dh_to_urdf.documents.limits import LIMIT_FIELDS
from dh_to_urdf.languages import codes, language
from dh_to_urdf.table import JointType

COLUMNS = (
    *("name", "type", "ant", "sigma", "mu", "gamma", "b", "alpha", "a", "d", "theta", "r"),
    *("offset", "sign", *LIMIT_FIELDS, "mimic", "coupling"),
)


def column_of(heading: str) -> str:
    """Return the column of a heading in any language; what is none, as it is."""
    return _columns().get(_plain(heading), heading)


def type_of(word: str) -> str:
    """Return the type of a joint by its name in any language; what is none, as it is."""
    return _types().get(_plain(word), word)


@cache
def _columns() -> dict[str, str]:
    spoken = [language(code) for code in codes()]
    found = {_plain(one.heading(column)): column for one in reversed(spoken) for column in COLUMNS}
    return {**found, **{column: column for column in COLUMNS}}


@cache
def _types() -> dict[str, str]:
    spoken = [language(code) for code in codes()]
    return {_plain(one.word("type", kind)): kind.value for one in spoken for kind in JointType}


def _plain(text: str) -> str:
    """Return a text in lower case without accents."""
    parts = unicodedata.normalize("NFD", text.strip().casefold())
    return "".join(c for c in parts if not unicodedata.combining(c))
