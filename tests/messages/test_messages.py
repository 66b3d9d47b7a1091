"""Messages are plain English for who only prints them, and keep what they are made of."""

from __future__ import annotations

import copy
import json
import pickle

import orjson
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dh_to_urdf import DHError, read_json
from dh_to_urdf.errors import Fault
from dh_to_urdf.languages import ENGLISH, language
from dh_to_urdf.messages import Message, as_data, chained, from_data, plural, say

FRENCH = language("fr")
INNER = say("is {shown}; give a finite number", shown="'x'")
OUTER = say("{label}: {column} {error}", label=say("joint {k}", k=3), column="alpha", error=INNER)
ENGLISH_TEXT = "joint 3: alpha is 'x'; give a finite number"
NBSP = "\N{NO-BREAK SPACE}"
FRENCH_TEXT = f"articulation 3{NBSP}: alpha vaut 'x'{NBSP}; donnez un nombre fini"


def ways(message):
    """The message after what happens to messages on their way."""
    yield message
    yield str(message)
    yield str(ValueError(message))
    yield pickle.loads(pickle.dumps(message))
    yield pickle.loads(pickle.dumps(ValueError(message))).args[0]
    yield copy.deepcopy(message)
    yield message + ""
    yield "" + message
    yield chained("; ", [message])
    yield from_data(json.loads(json.dumps(as_data(message))))


def test_a_message_is_its_english_sentence():
    for one in ways(OUTER):
        assert one == ENGLISH_TEXT
        assert orjson.dumps([one]) == orjson.dumps([ENGLISH_TEXT])
        assert ENGLISH.text(one) is one


def test_a_message_keeps_what_it_is_made_of():
    for one in ways(OUTER):
        assert isinstance(one, Message)
        assert FRENCH.text(one) == FRENCH_TEXT


def test_messages_are_joined_with_texts():
    both = "a " + OUTER + " b"
    assert both == f"a {ENGLISH_TEXT} b"
    assert FRENCH.text(both) == f"a {FRENCH_TEXT} b"
    text = ""
    text += OUTER
    assert FRENCH.text(text) == FRENCH_TEXT
    listed = chained(say(" or "), ("a", "b", INNER))
    assert listed == f"a or b or {INNER}"
    assert FRENCH.text(listed).startswith("a ou b ou vaut")


def test_numbers_have_the_forms_of_each_language():
    def cells(count):
        return plural("one cell differs", "{count} cells differ", count=count)

    assert [str(cells(n)) for n in (0, 1, 2)] == [
        "0 cells differ",
        "one cell differs",
        "2 cells differ",
    ]
    assert FRENCH.text(cells(1)) == "une cellule diffère"
    assert FRENCH.text(cells(3)) == "3 cellules diffèrent"


def test_texts_of_users_are_not_translated():
    assert FRENCH.text("the robot") == "the robot"
    named = say("there is no robot {robot_id!r}; {shown}", robot_id="the robot", shown="")
    assert "'the robot'" in FRENCH.text(named)


@given(st.text(), st.floats(allow_nan=False), st.integers())
def test_values_survive_as_data(text, number, integer):
    made = say("{what} is {value} {raw!r}", what=text, value=number, raw=integer)
    read = from_data(json.loads(json.dumps(as_data(made))))
    assert read == made
    assert isinstance(read, Message)
    assert read.values == made.values


@pytest.mark.parametrize(
    "data", [None, 1, [], {}, {"template": 1}, {"template": [1], "values": {}}]
)
def test_other_data_is_no_message(data):
    with pytest.raises(ValueError, match="no message"):
        from_data(data)


def test_errors_are_told_in_french():
    with pytest.raises(DHError) as caught:
        read_json('{"convention": "dh", "joints": [{"type": "R", "alpha": "pi/0"}]}')
    error = caught.value
    assert FRENCH.text(str(error)).startswith("articulation 1")
    assert "divise par zéro" in FRENCH.text(str(error))
    assert FRENCH.text(str(Fault(("joints", 0), OUTER))) == f"joints[0]{NBSP}: {FRENCH_TEXT}"
