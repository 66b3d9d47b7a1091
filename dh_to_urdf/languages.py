"""The languages that messages are said in: English, the source, and those with a catalogue.

Catalogues are gettext's: ``locale/<code>/LC_MESSAGES/denavit.po``, which people edit, and beside it
the compiled ``denavit.mo``, which is read (``make messages``; a test asks that they agree). They
hold sentences; in the context ``heading`` what texts and CSV call the fields of answers, and in
``word: <field>`` the words that stand in a field, such as ``converged``.
"""

from __future__ import annotations

import gettext
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from dh_to_urdf.messages import Message, Template

DOMAIN: Final = "denavit"
HEADING: Final = "heading"
"""Context of names of fields, as headings."""
WORD: Final = "word: {}"
"""Context of the words of a field."""
LOCALE = Path(__file__).parent / "locale"


@dataclass(frozen=True)
class Language:
    """A language, and how to say things in it.

    Attributes:
        code: Its tag, such as ``fr``.
        catalogue: Its translations; None for English.
        colon: What follows a heading.
    """

    code: str
    catalogue: gettext.NullTranslations | None = None
    colon: str = ":"

    @property
    def is_source(self) -> bool:
        """Whether messages are in this language already."""
        return self.catalogue is None

    def text(self, text: str) -> str:
        """Return a message in this language; other texts as they are."""
        if self.catalogue is not None and isinstance(text, Message):
            return text.translated(self._template)
        return text

    def told(self, value: Any) -> Any:
        """Return an answer with its messages in this language; lists and objects are copied."""
        if self.catalogue is None:
            return value
        if isinstance(value, str):
            return self.text(value)
        if isinstance(value, Mapping):
            return {key: self.told(one) for key, one in value.items()}
        return [self.told(one) for one in value] if isinstance(value, (list, tuple)) else value

    def heading(self, name: str) -> str:
        """Return what a field is called; the names of others, such as joints, as they are."""
        return name if self.catalogue is None else self.catalogue.pgettext(HEADING, name)

    def word(self, name: str, word: str) -> str:
        """Return a word that stands in a field; other texts as they are."""
        return word if self.catalogue is None else self.catalogue.pgettext(WORD.format(name), word)

    def _template(self, template: Template) -> str:
        assert self.catalogue is not None
        if template.many:
            return self.catalogue.ngettext(template.one, template.many, template.number)
        return self.catalogue.gettext(template.one)


ENGLISH = Language("en")


@cache
def language(code: str) -> Language:
    """Return a language by its tag.

    Raises:
        OSError: It has no catalogue.
    """
    if code == ENGLISH.code:
        return ENGLISH
    catalogue = gettext.translation(DOMAIN, LOCALE, [code])
    return Language(code, catalogue, colon="\N{NO-BREAK SPACE}:")


@cache
def codes() -> tuple[str, ...]:
    """Return the tags of all languages, English first."""
    found = LOCALE.glob(f"*/LC_MESSAGES/{DOMAIN}.mo")
    return (ENGLISH.code, *sorted(path.parts[-3] for path in found))
