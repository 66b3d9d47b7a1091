"""Bytes of texts -> texts: UTF-8, or UTF-16 or Windows-1252, which is told."""

from __future__ import annotations

import codecs
import re
from contextlib import suppress

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
MOSTLY = 0.7
"""Share of bytes of zero at one place of each character, in texts of wide characters."""
_TEXT_ENCODINGS = re.compile(
    r"(?:utf-?(?:8|16|32)(?:-?(?:le|be|sig))?|us-ascii|ascii|iso-?8859-?\d{1,2}|latin-?\d{1,2}|l\d"
    r"|(?:windows-?|cp-?)\d{3,4}|mac-?(?:roman|greek|cyrillic)|koi8-[ru]|gb(?:k|2312|18030)|big5"
    r"|shift[_-]?jis|euc[_-](?:jp|kr))",
    re.IGNORECASE,
)
"""Names of encodings of texts; others of Python's codecs (zip, hex, idna) are none."""


def decoded(
    text: str | bytes, encoding: str | None = None, max_length: int = 100_000
) -> tuple[str, list[str]]:
    """Return a text, and a warning where its bytes are not UTF-8 and no encoding was named.

    Args:
        text: The text, or its bytes.
        encoding: The encoding that they are said to have (``charset=``); None to detect it.
        max_length: Most characters or bytes.

    Raises:
        DHError: Too long, not in the encoding that is named, or in none that is known.
    """
    if len(text) > max_length:
        raise DHError.single(
            (),
            say(
                "the text is longer than {max_pasted_length} characters",
                max_pasted_length=max_length,
            ),
        )
    if isinstance(text, str):
        return text.lstrip("\ufeff"), []
    if encoding is not None and encoding.lower() not in ("utf-8", "utf8"):
        return _named(text, encoding), []
    codec = _wide_codec(text)
    if codec == "utf-32":
        raise DHError.single((), say("the text is in UTF-32, which is not read; save it as UTF-8"))
    if codec:
        with suppress(UnicodeDecodeError):
            return text.decode(codec).lstrip("\ufeff"), [
                say("the text was read as UTF-16, which was detected; save it as UTF-8")
            ]
    try:
        return text.decode("utf-8-sig"), []
    except UnicodeDecodeError as error:
        if encoding is not None:
            raise _not_in(encoding, error) from None
    try:
        found = text.decode("cp1252")
    except UnicodeDecodeError:
        found = "\0"
    if _CONTROL.search(found):
        raise DHError.single(
            (),
            say(
                "the text is not UTF-8; save it as UTF-8, or name its encoding, such as"
                " charset=iso-8859-1 in Content-Type"
            ),
        )
    return found, [
        say(
            "the text is not UTF-8 and was read as Windows-1252 (Latin-1); save it as UTF-8, or"
            " name its encoding, such as charset=iso-8859-1 in Content-Type"
        )
    ]


def _wide_codec(text: bytes) -> str:
    """Return the codec of a text of wide characters; empty for others.

    Where no mark tells it: texts of tables are ASCII in the main, of whose characters UTF-16 makes
    one byte of zero and another, and UTF-32 three of zero.
    """
    if text.startswith((codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE)):
        return "utf-32"
    if text.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    zeros = [text[k::4].count(0) / max(1, len(text[k::4])) for k in range(4)]
    if len(text) % 4 == 0 and (min(zeros[:3]) > MOSTLY or min(zeros[1:]) > MOSTLY):
        return "utf-32"
    if len(text) % 2 == 0 and min(zeros[1::2]) > MOSTLY and max(zeros[::2]) < 1 - MOSTLY:
        return "utf-16-le"
    if len(text) % 2 == 0 and min(zeros[::2]) > MOSTLY and max(zeros[1::2]) < 1 - MOSTLY:
        return "utf-16-be"
    return ""


def _named(text: bytes, encoding: str) -> str:
    name = encoding.strip().strip("\"'")
    try:
        if not _TEXT_ENCODINGS.fullmatch(name):
            raise LookupError(name)
        # Browsers and Windows say Latin-1 of Windows-1252, which has letters where it has none.
        codec = codecs.lookup(name).name
        found = text.decode("cp1252" if codec == "iso8859-1" and _is_windows(text) else codec)
    except LookupError:
        raise DHError.single(
            (),
            say(
                "the encoding {name!r} is unknown; give charset=utf-8, iso-8859-1 or windows-1252",
                name=name[:40],
            ),
        ) from None
    except UnicodeDecodeError as error:
        raise _not_in(name, error) from None
    return found.lstrip("\ufeff")


def _is_windows(text: bytes) -> bool:
    """Return whether bytes are letters in Windows-1252 that are controls in Latin-1."""
    if not re.search(rb"[\x80-\x9f]", text):
        return False
    try:
        text.decode("cp1252")
    except UnicodeDecodeError:
        return False
    return True


def _not_in(encoding: str, error: UnicodeDecodeError) -> DHError:
    return DHError.single(
        (),
        say(
            "byte {position} of the text is not in {encoding}, which charset names; name the"
            " encoding that it has, or leave charset out",
            position=error.start + 1,
            encoding=encoding,
        ),
    )
