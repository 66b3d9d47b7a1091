"""No English is left in any answer to the recorded requests, in a language made up for tests."""

from __future__ import annotations

import re
import sys
from dataclasses import replace

import pytest

from tests.conftest import running_server
from tests.messages.left import english
from tests.messages.pseudo import CODE
from tests.recorded.exchange import Connection
from tests.recorded.replay import chosen_records

SPEAKER = (sys.executable, "-m", "tests.messages.pseudo")
OTHERS = re.compile(r"ＹＡＭＬ|(?:ｌｉｎｅ|ｃｏｌｕｍｎ) \d+: [a-z(]")
"""What parsers of YAML and Python say, word for word."""


def test_what_is_left_is_found():
    text = '{"detail": "ｊｏｉｎｔ 1 is ｗｒｏｎｇ", "title": "the robot", "q": ["ｏｋ", "j1"]}'
    assert english("application/json", text) == ["ｊｏｉｎｔ 1 is ｗｒｏｎｇ"]
    assert english("text/plain", "ｑ: 1\nwarnings: give more\n") == ["warnings: give more"]


@pytest.mark.slow
def test_no_english_is_left(tmp_path):
    found, count = {}, 0
    with running_server(tmp_path, program=SPEAKER) as (address, _):
        connection = Connection(address)
        for one in chosen_records(every=9):
            sent = one.asked.sent
            spoken = replace(sent, headers=(*sent.headers, ("Accept-Language", CODE)))
            status, headers, body = connection.send(spoken)
            assert status < 500, spoken.shown()
            kind = headers.get("content-type", "").partition(";")[0]
            if not (kind.endswith(("json", "ndjson")) or kind in ("text/plain", "text/csv")):
                continue
            count += 1
            for left in english(kind, body.decode()):
                if not OTHERS.search(left):
                    found.setdefault(re.sub(r"[\d.]+", "#", left), (spoken.target, left))
        connection.close()
    assert count > 3000
    assert not found, "\n".join(f"{target}: {left}" for target, left in found.values())
