"""Each sentence of the sources has a translation, with its placeholders; none is left over."""

from __future__ import annotations

import re
import string

import polib
import pytest

from dh_to_urdf.languages import LOCALE, codes, language
from tests.messages.collect import templates
from tests.messages.names import words
from tests.messages.prose import FILES, FOLDERS, TEXTS, plain_sentences
from tests.messages.update import compiled, wanted

PATHS = sorted(LOCALE.glob("*/LC_MESSAGES/*.po"))
_NARROW = re.compile(r"(?<=[^\W\d]) [;:?!](?= |$)")


def placeholders(template: str) -> list[tuple[str, str | None, str | None]]:
    parts = string.Formatter().parse(template)
    return sorted({(name, spec, kind) for _, name, spec, kind in parts if name is not None})


def translations(entry: polib.POEntry) -> list[str]:
    return list(entry.msgstr_plural.values()) if entry.msgid_plural else [entry.msgstr]


@pytest.fixture(params=PATHS, ids=lambda path: path.parts[-3])
def path(request):
    return request.param


@pytest.fixture
def catalogue(path):
    return polib.pofile(str(path), encoding="utf-8")


def test_french_is_spoken():
    assert codes() == ("en", "fr")
    assert len(templates()) > 1300


def test_every_text_has_a_translation_and_no_other_is_left(catalogue):
    known = {(entry.msgctxt, entry.msgid) for entry in catalogue}
    new, gone = wanted().keys() - known, known - wanted().keys()
    assert not new | gone, f"run make messages and translate what is new: {new}, gone: {gone}"
    empty = [entry.msgid for entry in catalogue if not all(translations(entry))]
    assert not empty, f"not translated: {empty}"
    assert not [entry.msgid for entry in catalogue if entry.fuzzy or entry.obsolete]


def test_translations_have_the_placeholders_of_the_english(catalogue):
    for entry in catalogue:
        if entry.msgctxt is not None:
            continue
        for text in translations(entry):
            forms = [placeholders(form) for form in (entry.msgid, entry.msgid_plural) if form]
            assert placeholders(text) in forms, entry.msgid


def test_translations_keep_the_blanks_at_both_ends(catalogue):
    for entry in catalogue:
        for text in translations(entry):
            ends = [one[:1].isspace() or one[:1] in ",;:" for one in (entry.msgid, text)]
            assert ends[0] == ends[1], entry.msgid
            assert entry.msgid[-1:].isspace() == text[-1:].isspace(), entry.msgid


def test_french_has_no_break_spaces_before_its_signs(catalogue, path):
    if path.parts[-3] != "fr":
        pytest.skip("French only")
    odd = [text for entry in catalogue for text in translations(entry) if _NARROW.search(text)]
    assert not odd


def test_the_compiled_catalogue_is_that_of_the_text(catalogue, path):
    assert compiled(path).read_bytes() == catalogue.to_binary(), "run make messages"


def test_templates_are_given_what_they_name():
    for one in templates():
        for text in filter(None, (one.one, one.many)):
            named = {name for name, _, _ in placeholders(text)}
            assert named <= one.names, f"{one.path}:{one.line}: {named - one.names} is not given"
        if not one.many:
            assert named == one.names, f"{one.path}:{one.line}: {one.names - named} is not used"


def test_no_sentence_is_a_plain_text():
    """A new sentence goes through ``say``; others are listed in :mod:`tests.messages.prose`."""
    assert list(plain_sentences()) == []


def test_what_is_listed_as_no_sentence_is_there():
    from tests.messages.collect import ROOT

    for name in (*FILES, *FOLDERS, *TEXTS):
        assert (ROOT / name).exists(), f"{name} is gone: take it out of the list"
    for name, beginnings in TEXTS.items():
        source = (ROOT / name).read_text()
        for one in beginnings:
            assert one.partition("{")[0].strip(" .") in source, f"{name}: {one!r} is gone"


def test_headings_and_words_are_told_apart_from_names():
    french = language("fr")
    assert french.heading("jacobian") == "matrice jacobienne"
    assert french.heading("panda_joint1") == "panda_joint1"
    assert french.word("status", "converged") == "convergé"
    assert french.word("title", "converged") == "converged"
    assert len(words()) > 300
