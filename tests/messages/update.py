"""Bring the catalogues up to the sources: ``python -m tests.messages.update``.

Adds what is new, with an empty translation that a test asks for, takes out what no source has any
more, and keeps the rest. Nothing is guessed: a sentence that changed is a new one.
"""

from __future__ import annotations

import sys
from pathlib import Path

import polib

from dh_to_urdf.languages import LOCALE
from tests.messages.collect import templates
from tests.messages.names import words

NAMES = "tests/messages/names.py"


def wanted() -> dict[tuple[str | None, str], polib.POEntry]:
    """Return an entry for each text of the sources, without a translation."""
    found: dict[tuple[str | None, str], polib.POEntry] = {}
    for one in templates():
        entry = found.setdefault((None, one.one), polib.POEntry(msgid=one.one))
        if one.many:
            entry.msgid_plural = one.many
            entry.msgstr_plural = {0: "", 1: ""}
        if (one.path, "") not in entry.occurrences:
            entry.occurrences.append((one.path, ""))
        if one.names and "python-brace-format" not in entry.flags:
            entry.flags.append("python-brace-format")
    for context, text in words():
        entry = polib.POEntry(msgid=text, msgctxt=context, occurrences=[(NAMES, "")])
        found[context, text] = entry
    return found


def compiled(path: Path) -> Path:
    """Return where the compiled form of a catalogue stands."""
    return path.with_suffix(".mo")


def update(path: Path) -> tuple[int, int]:
    """Write a catalogue anew; return how many entries came and went."""
    old = polib.pofile(str(path), encoding="utf-8", wrapwidth=100)
    known = {(entry.msgctxt, entry.msgid): entry for entry in old}
    new = polib.POFile(wrapwidth=100)
    new.header, new.metadata = old.header, old.metadata
    entries = wanted()
    for key, entry in entries.items():
        before = known.get(key)
        if before is not None:
            entry.msgstr = before.msgstr
            entry.tcomment = before.tcomment
            if entry.msgid_plural:
                entry.msgstr_plural = before.msgstr_plural or entry.msgstr_plural
        new.append(entry)
    new.save(str(path))
    compiled(path).write_bytes(new.to_binary())
    return len(entries.keys() - known.keys()), len(known.keys() - entries.keys())


def main() -> None:
    """Update every catalogue, and say what to do."""
    for path in sorted(LOCALE.glob("*/LC_MESSAGES/denavit.po")):
        come, gone = update(path)
        sys.stdout.write(f"{path}: {come} new, {gone} gone; translate the empty ones\n")


if __name__ == "__main__":
    main()
