"""A service that speaks a language made up for tests: ``python -m tests.messages.pseudo serve``.

In it every letter of a sentence, heading or word that can be translated is a full-width one. What
stands in ASCII letters in an answer is what was sent, a name, a code, or could not be translated.
"""

from __future__ import annotations

import gettext
import string
import sys

from dh_to_urdf import languages

CODE = "qps"
_WIDE = {ord(c): ord(c) + 0xFEE0 for c in string.ascii_letters}
_real = languages.language
_codes = languages.codes()


def widened(template: str) -> str:
    """Return a template with full-width letters, and its placeholders as they are."""
    parts = []
    for literal, name, spec, conversion in string.Formatter().parse(template):
        parts.append(literal.translate(_WIDE).replace("{", "{{").replace("}", "}}"))
        if name is not None:
            shown = f"!{conversion}" if conversion else ""
            parts.append(f"{{{name}{shown}{f':{spec}' if spec else ''}}}")
    return "".join(parts)


class Pseudo(gettext.NullTranslations):
    """A catalogue that has everything."""

    def gettext(self, message: str) -> str:
        return widened(message)

    def ngettext(self, msgid1: str, msgid2: str, n: int) -> str:
        return widened(msgid1 if n == 1 else msgid2)

    def pgettext(self, context: str, message: str) -> str:
        return message.translate(_WIDE)


def speak() -> None:
    """Offer the language beside the others; before the service is imported."""
    pseudo = languages.Language(CODE, Pseudo())
    languages.codes = lambda: (*_codes, CODE)  # type: ignore[assignment]
    languages.language = lambda code: pseudo if code == CODE else _real(code)  # type: ignore[assignment]


if __name__ == "__main__":
    speak()
    from app.cli import main

    sys.exit(main())
