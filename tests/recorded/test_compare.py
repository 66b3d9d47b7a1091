"""What counts as the same answer, and what does not."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace

import pytest

from tests.recorded.compare import differences
from tests.recorded.fixture import Asked, Recorded, records, written
from tests.recorded.intended import adapted
from tests.recorded.normalise import LONGEST, normalised, text_digest
from tests.torture.exchange import Sent

FK = Asked("fk", "form", Sent("POST", "/v1/robots/ur5/fk", "", (), b"{}", what="a"))
ADDRESS = "http://127.0.0.1:8000"
DOUBT = "q of joint a is 9 rad, outside its limits -1 to 1; the robot cannot be there"


def answer(body, kind="application/json", status=200, **headers):
    content = body if isinstance(body, bytes) else body.encode()
    return normalised(status, {"content-type": kind, **headers}, content, ADDRESS)[0]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('{"a":1.0}', '{"a":1.0000000001}'),
        ('{"a":1e-17}', '{"a":-3e-16}'),
        ('{"a":[0.0,2000000.0]}', '{"a":[-0.0,2000000.001]}'),
        ('{"elapsed_ms":1.5,"a":1}', '{"elapsed_ms":17,"a":1}'),
        ('{"elapsed_ms":[1.5,2],"a":1}', '{"elapsed_ms":[1,3e-5],"a":1}'),
        ('{"request_id":"a-1"}', '{"request_id":"b-2"}'),
    ],
)
def test_the_same_in_json(old, new):
    assert differences(answer(old), answer(new)) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('{"a":1.0}', '{"a":1.00001}'),
        ('{"a":1}', '{"a":2}'),
        ('{"a":1}', '{"a":1.0}'),
        ('{"a":1}', '{"a":true}'),
        ('{"a":1,"b":2}', '{"b":2,"a":1}'),
        ('{"a":1}', '{"a":1,"b":2}'),
        ('{"a":[1.5]}', '{"a":[1.5,1.5]}'),
        ('{"a":"x"}', '{"a":"y"}'),
        ('{"a":"x 1.0"}', '{"a":"x 1.0000000000001"}'),
        ('{"a":null}', '{"a":0.0}'),
    ],
)
def test_different_in_json(old, new):
    assert differences(answer(old), answer(new))


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ("a: 0.123456789\n", "a: 0.123456790\n", True),
        ("a: [ 0.000000000]\n", "a: [-0.000000000]\n", True),
        ("a: 0.123456789\n", "a: 0.123456799\n", False),
        ("n: 7\n", "n: 8\n", False),
        ("elapsed_ms: 2.25\n", "elapsed_ms: 13.5\n", True),
        ("a: x\n", "a: y\n", False),
    ],
)
def test_text(old, new, same):
    kind = "text/plain; charset=utf-8"
    assert (differences(answer(old, kind), answer(new, kind)) == []) is same


def test_statuses_and_headers():
    assert differences(answer("{}"), answer("{}", status=201)) == ["status: 200 -> 201"]
    assert differences(answer("{}"), answer("{}", etag='"a"'))
    assert differences(answer("{}"), answer("{}", date="now")) == []


def test_long_bodies():
    def numbers(change):
        return json.dumps({"a": [[k / 7 + change * (k == 100)] for k in range(3000)]})

    old = answer(numbers(0))
    assert old.text is None
    assert differences(old, answer(numbers(0))) == []
    assert differences(old, answer(numbers(1e-10))) == []
    assert differences(old, answer(numbers(0.01)))
    assert differences(old, answer(numbers(0).replace('"a"', '"b"')))


@pytest.mark.parametrize("size", [3, LONGEST])
@pytest.mark.parametrize(
    ("kind", "old", "new"),
    [
        ("application/json", '{{"a":[{0}],"b":1}}', '{{"a":[{0}],"warnings":[],"b":1}}'),
        (
            "application/json",
            '{{"a":[{0}],"b":1}}',
            '{{"a":[{0}],"warnings":["{1}"],"b":1}}',
        ),
        ("text/plain", "a: [{0}]\nb: 1\n", "a: [{0}]\nwarnings:\n  - {1}\nb: 1\n"),
        ("text/plain", "a: [{0}]\nb: 1\n", "a: [{0}]\nb: 1\nwarnings: (none)\n"),
    ],
)
def test_warnings_may_be_added(size, kind, old, new):
    numbers = ",".join(["0.25"] * (size // 4 + 1))
    before = answer(old.format(numbers), kind)
    headers = {"content-type": kind}
    after, text = normalised(200, headers, new.format(numbers, DOUBT).encode(), ADDRESS)
    assert differences(before, after)
    assert differences(before, adapted(FK, before, after, text)) == []


def test_the_shape_of_a_long_text_is_that_of_the_recorded_digests():
    shape = text_digest("a: 2\n   0.5 -0.7\n")["shape"]
    assert shape == hashlib.sha256(b"a: #\n # #\n").hexdigest()


@pytest.mark.parametrize("warned", [False, True])
def test_where_a_text_said_that_it_has_no_warnings_matters_not(warned):
    kind = "text/plain"
    before = answer("links: -\nwarnings: (none)\nretimed: -\n", kind)
    told = "warnings:\n  - q of joint a is 9 rad, outside its limits -1 to 1\n" * warned
    after, text = normalised(
        200, {"content-type": kind}, f"links: -\n{told}retimed: -\n".encode(), ADDRESS
    )
    assert differences(before, adapted(FK, before, after, text)) == []


def test_lines_are_adapted_one_by_one():
    kind = "application/x-ndjson"
    before = answer('{"a":1}\n{"b":1}\n', kind)
    after, text = normalised(
        200, {"content-type": kind}, b'{"a":1,"explanation":["x"]}\n{"b":1}\n', ADDRESS
    )
    asked = replace(FK, operation="ik")
    assert differences(before, adapted(asked, before, after, text)) == []
    after, text = normalised(200, {"content-type": kind}, b'{"a":2}\n{"b":1}\n', ADDRESS)
    assert differences(before, adapted(asked, before, after, text))


@pytest.mark.parametrize(
    ("kind", "old", "new"),
    [
        ("application/json", '{"a":1}', '{{"a":1,"warnings":["{0}"]}}'),
        ("application/json", '{"warnings":[]}', '{{"warnings":["{0}"]}}'),
        ("text/plain", "a: 1\n", "a: 1\nwarnings:\n  - {0}\n"),
    ],
)
def test_a_new_warning_is_meant_where_it_tells_a_doubt(kind, old, new):
    before = answer(old, kind)
    for told, same in ((DOUBT, True), ("the robot is on fire", False)):
        after, text = normalised(200, {"content-type": kind}, new.format(told).encode(), ADDRESS)
        assert (differences(before, adapted(FK, before, after, text)) == []) is same


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ('{"success":false,"retimed":null,"x":1}', '{"success":false,"retimed":null,"x":2}', True),
        ('{"success":true,"retimed":{"success":false}}', '{"success":true,"retimed":null}', False),
        (
            '{"rows":[{"method":"a","success":false,"x":1.0},{"method":"b","success":true,"x":1.0}],'
            '"messages":{"a":"k","b":"l"}}',
            '{"rows":[{"method":"a","success":false,"x":2.0},{"method":"b","success":true,"x":1.0}],'
            '"messages":{"a":"m","b":"l"}}',
            True,
        ),
        (
            '{"rows":[{"method":"a","success":false,"x":1.0},{"method":"b","success":true,"x":1.0}],'
            '"messages":{"a":"k","b":"l"}}',
            '{"rows":[{"method":"a","success":false,"x":2.0},{"method":"b","success":true,"x":2.0}],'
            '"messages":{"a":"m","b":"l"}}',
            False,
        ),
    ],
)
def test_only_what_is_lost_of_a_path_may_change(old, new, same):
    asked = replace(FK, operation="path")
    before = answer(old)
    after, text = normalised(200, {"content-type": "application/json"}, new.encode(), ADDRESS)
    assert (differences(before, adapted(asked, before, after, text)) == []) is same


def test_warnings_that_were_there_may_not_change():
    before = answer('{"warnings":["a"]}')
    after, text = normalised(
        200, {"content-type": "application/json"}, b'{"warnings":["b"]}', ADDRESS
    )
    assert differences(before, adapted(FK, before, after, text))


def test_the_file_gives_back_what_was_written(tmp_path):
    sent = Sent("POST", "/a", "b=%ff", (("A", "b"),), b"\x93\xff", what="é")
    kept = [
        Recorded(Asked("fk", "x", sent), answer("{}")),
        Recorded(Asked("fk", "x", Sent("GET", "/", "", (), None)), answer("", "")),
        Recorded(Asked("fk", "x", Sent("PUT", "/", "", (), b"")), answer(b"\x93", "image/x")),
        Recorded(Asked("fk", "x", Sent("PUT", "/", "", (), b"\xc3")), answer("0" * LONGEST * 2)),
    ]
    file = tmp_path / "a"
    file.write_bytes(written(kept))
    assert list(records(file)) == kept
    assert written(kept) == file.read_bytes()
