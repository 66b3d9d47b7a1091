"""Answers for a terminal: what the words of a language may change, and what they may not."""

import typing

from app.http.text import BY_NAME, render_text
from app.operations import OPERATIONS
from dh_to_urdf.languages import language

FIELDS_OF_ONE_KIND = {"summary", "units", "rotation", "position", "simplified"}
"""Dictionaries whose keys are fields of ours."""


def fields(type_, name="", seen=()):
    """Each field of an answer with its type, inner ones too."""
    yield name, type_
    if typing.is_typeddict(type_) and type_ not in seen:
        for inner, one in typing.get_type_hints(type_).items():
            yield from fields(one, inner, (*seen, type_))
    for one in typing.get_args(type_):
        if isinstance(one, type) or typing.get_origin(one):
            yield from fields(one, name, seen)


def test_names_of_frames_and_joints_are_no_words():
    payload = {
        "frame": "tool",
        "poses": {"tool": {"position": [1.0, 2.0, 3.0], "base": 1}, "position": {"rpy": 2}},
        "joint_values": {"limit": 1.0, "angle": 2.0},
    }
    assert render_text(payload, None, language("fr")).splitlines() == [
        "repère : tool",
        "poses :",
        "  tool :",
        "    position : [1.000000000  2.000000000  3.000000000]",
        "    base : 1",
        "  position : rpy 2",
        "valeurs articulaires : limit 1  angle 2",
    ]


def test_all_fields_that_go_by_names_are_known():
    found = {
        name
        for operation in OPERATIONS
        for name, type_ in fields(operation.answer)
        if typing.get_origin(type_) is dict and typing.get_args(type_)[0] is str and name
    }
    assert found - FIELDS_OF_ONE_KIND == BY_NAME


def test_what_says_nothing_is_no_line():
    payload = {"correct": True, "note": "", "errors": [], "warnings": []}
    assert render_text(payload) == "correct: yes\nerrors: (none)\n"
