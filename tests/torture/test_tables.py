"""The short form of ``python -m tests.torture.tables``, and the same by hypothesis."""

import random
import time
from dataclasses import replace

import pytest
from hypothesis import given, note, settings
from hypothesis import strategies as st

from dh_to_urdf import DHError
from tests.cost import within
from tests.torture.large_tables import LARGE
from tests.torture.table_grammar import FORMATS, Text, random_text
from tests.torture.table_mutations import mutate
from tests.torture.table_oracle import NotPlain, check_refusal, judge, read, second_reading, shown
from tests.torture.tables import text


@pytest.mark.parametrize("hundred", range(4))
def test_mutated_tables_are_refused_or_computed_right(hundred):
    outcomes = {judge(*text(0, case)) for case in range(100 * hundred, 100 * hundred + 100)}
    assert outcomes == {"refused", "accepted", "accepted, read twice"}


@settings(max_examples=100, deadline=None)
@given(st.randoms())
def test_right_tables_are_read(chance):
    assert judge(random_text(chance), random.Random(0)).startswith("accepted")


@settings(max_examples=100, deadline=None)
@given(st.randoms())
def test_tables_with_something_wrong_are_refused_or_computed_right(chance):
    document = mutate(chance, random_text(chance))
    note(repr(document))
    judge(document, random.Random(0))


def test_every_format_is_in_the_cases():
    kinds = {text(0, case)[0].format for case in range(200)}
    assert kinds == {"json", "yaml", "csv", "par", "pasted"}
    assert len(set(FORMATS)) == 8


def test_half_of_the_right_tables_are_read_twice():
    def twice(case):
        try:
            second_reading(random_text(random.Random(case)))
        except NotPlain:
            return False
        return True

    assert sum(twice(case) for case in range(200)) > 80


TABLE = (
    b'{"convention": "modified", "joints": [{"type": "R", "alpha": 0.1, "a": 0.2, "d": 0.3},'
    b' {"type": "P", "alpha": 0.4, "a": 0.5, "theta": 0.6}], "tool": {"xyz": [0.1, 0, 0]}}'
)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"0.1,", b"0.1001,"),
        (b"modified", b"standard"),
        (b'"theta": 0.6', b'"theta": -0.6'),
        (b"[0.1, 0, 0]", b"[0, 0.1, 0]"),
        (b'"d": 0.3', b'"d": 0.31'),
    ],
)
def test_the_judge_sees_a_reader_that_lies(monkeypatch, old, new):
    from tests.torture import table_oracle

    document = Text("json", TABLE, "")
    assert judge(document, random.Random(0)) == "accepted, read twice"
    told = replace(document, content=TABLE.replace(old, new, 1))
    assert told != document
    monkeypatch.setattr(table_oracle, "read", lambda _text: read(told))
    with pytest.raises(AssertionError):
        judge(document, random.Random(0))


@pytest.mark.parametrize("name", LARGE)
def test_large_documents_are_refused_soon(name):
    document = LARGE[name]
    started = time.thread_time()
    with pytest.raises(DHError) as caught:
        read(document)
    assert within(time.thread_time() - started, 2.5)
    check_refusal(shown(caught.value))
