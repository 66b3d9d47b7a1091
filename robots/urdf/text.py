"""Bytes -> text: one encoding, characters of XML only, no DOCTYPE."""

from __future__ import annotations

import codecs
import re

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from robots.errors import InvalidURDF, RobotTooLarge
from robots.urdf.limits import MAX_BYTES
from robots.urdf.notes import Notes

_BOMS = (
    (codecs.BOM_UTF32_LE, None),  # begins like UTF-16's
    (codecs.BOM_UTF32_BE, None),
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_ENCODINGS = {
    "utf-8": "utf-8",
    "utf8": "utf-8",
    "us-ascii": "ascii",
    "ascii": "ascii",
    "iso-8859-1": "latin-1",
    "latin-1": "latin-1",
    "iso-8859-15": "iso-8859-15",
    "windows-1252": "cp1252",
}
_BLANKS = " \t\r\n"
_DECLARATION = re.compile(
    r"""<\?xml(?=[ \t\r\n?])"""
    r"""((?:[ \t\r\n]*+[A-Za-z]{1,20}+[ \t\r\n]*+=[ \t\r\n]*+"""
    r"""(?:"[^"<>]{0,200}+"|'[^'<>]{0,200}+')){0,8}+)"""
    r"""[ \t\r\n]*+\?>"""
)
"""A declaration of any version; readers of URDF do not look at it."""
_ENCODING = re.compile(r"""encoding[ \t\r\n]*=[ \t\r\n]*["']([^"'<>]{0,200})["']""")
_DECLARED = re.compile(r"<\?xml(?![\w.:-])", re.IGNORECASE)
_NO_XML_CHARACTER = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_DOCTYPE = re.compile(r"(?:[ \t\r\n]++|<!--(?s:.*?)-->|<\?(?s:.*?)\?>)*+<!(?!--)")


def decode(document: str | bytes, notes: Notes) -> str:
    """Decode a document and remove its XML declaration.

    Bytes are UTF-8 unless a byte order mark or the declaration says otherwise; UTF-16 needs the
    mark.

    Args:
        document: The document, at most ``MAX_BYTES``.
        notes: Takes what is left out.

    Raises:
        RobotTooLarge: It is longer.
        InvalidURDF: Another encoding, bytes that are not in it, characters that no XML has, or
            a DOCTYPE, which is the one place where entities are declared.
    """
    size = len(document) if isinstance(document, bytes) else _size(document)
    if size > MAX_BYTES:
        raise RobotTooLarge(
            say(
                "the URDF has {size} bytes; at most {max_bytes} are read",
                size=size,
                max_bytes=MAX_BYTES,
            )
        )
    text = document.removeprefix("\ufeff") if isinstance(document, str) else _decoded(document)
    stray = _NO_XML_CHARACTER.search(text)
    if stray is not None:
        line = text.count("\n", 0, stray.start()) + 1
        raise InvalidURDF(
            say(
                "the text is not well-formed XML: line {line} holds the character"
                " U+{stray:04X}, which XML does not have; remove it",
                line=line,
                stray=ord(stray[0]),
            )
        )
    if text.startswith("\ufeff"):
        raise InvalidURDF(
            say("the text is not well-formed XML: it starts with two byte order marks; keep one")
        )
    # Line ends instead of declarations keep the line numbers of errors.
    text = text.rstrip(_BLANKS)
    body = text.lstrip(_BLANKS)
    text = "\n" * text.count("\n", 0, len(text) - len(body)) + body
    first = _DECLARATION.match(body)
    if first is None and _DECLARED.match(body):
        raise InvalidURDF(say('the XML declaration has no end; write <?xml version="1.0"?>'))
    declarations = list(_DECLARATION.finditer(text))
    if declarations[:1] and (len(declarations) > 1 or first is None):
        notes.add(say("an XML declaration after the start of the text is left out"))
    text = _DECLARATION.sub(lambda found: "\n" * found[0].count("\n"), text)
    if _DOCTYPE.match(text):
        raise InvalidURDF(say("the URDF has a DOCTYPE or entities; remove them"))
    return text


def _size(text: str) -> int:
    try:
        return len(text.encode()) if len(text) <= MAX_BYTES else len(text)
    except UnicodeEncodeError:
        raise InvalidURDF(say("the text holds characters that are no Unicode text")) from None


def _decoded(document: bytes) -> str:
    mark, encoding = next(
        ((mark, encoding) for mark, encoding in _BOMS if document.startswith(mark)), (b"", "")
    )
    if encoding is None:
        raise InvalidURDF(say("the URDF is UTF-32; save it as UTF-8"))
    start = document[len(mark) : len(mark) + 400].decode(encoding or "latin-1", "replace")
    declaration = _DECLARATION.search(start)
    found = _ENCODING.search(declaration[1]) if declaration is not None else None
    declared = found[1] if found is not None else None
    name = declared.lower() if declared is not None else encoding or "utf-8"
    if encoding:
        known = {encoding, encoding[:6]}
    else:
        known, encoding = set(_ENCODINGS), _ENCODINGS.get(name, "")
    if name not in known:
        raise InvalidURDF(
            say("the XML declaration says the encoding {name}, which", name=quoted(name))
            + (say(" is not that of its byte order mark") if mark else say(" is not read here"))
            + say("; save the URDF as UTF-8")
        )
    try:
        return document[len(mark) :].decode(encoding)
    except UnicodeDecodeError as error:
        line = document.count(b"\n", 0, len(mark) + error.start) + 1
        raise InvalidURDF(
            say(
                "the text is not well-formed XML: line {line} holds bytes that are not"
                " {name}; save the URDF as UTF-8",
                line=line,
                name=name.upper(),
            )
        ) from None
