"""Headers that say what a body is and what the answer shall be."""

import gzip

import pytest

from tests.app.http.requests import JSON, check, post


@pytest.mark.parametrize(
    ("headers", "status", "words"),
    [
        ({"Content-Encoding": "gzip"}, 415, "compressed"),
        ({"Content-Encoding": "br, gzip"}, 415, "compressed"),
        ({"Content-Type": "application/json; charset=utf-16"}, 415, "UTF-8"),
        ({"Content-Type": "application/json; charset=latin-1"}, 415, "UTF-8"),
        ({"Content-Type": "text/html"}, 415, "application/json"),
        ({"Content-Type": ""}, 415, "--json"),
        ({"Content-Type": ";"}, 415, "--json"),
        ({"Accept": "image/png"}, 406, "application/json"),
        ({"Accept": "*/*;q=0"}, 406, "application/json"),
        ({"Accept": "application/json;q=nan"}, 406, "application/json"),
        ({"Accept": "application/json;q=0, image/svg+xml"}, 406, "application/json"),
    ],
)
def test_headers_that_are_not_served(client, headers, status, words):
    body = gzip.compress(b'{"q": [0, 0]}') if "Content-Encoding" in headers else b'{"q": [0, 0]}'
    check(post(client, body, headers=JSON | headers), status, "", words)


@pytest.mark.parametrize(
    ("headers", "kind"),
    [
        ({"Content-Type": "Application/JSON; Charset=UTF-8"}, "application/json"),
        ({"Content-Encoding": "identity"}, "application/json"),
        ({"Accept": ""}, "application/json"),
        ({"Accept": "text/*;q=0.5, application/json;q=0.4"}, "text/plain"),
        ({"Accept": "text/plain;q=1e999, */*;q=0.1"}, "application/json"),
        ({"Accept": "application/json;q=0, */*"}, "text/plain"),
        ({"Accept": "," * 3000 + "text/plain"}, "application/json"),
        ({"Expect": "100-continue"}, "application/json"),
        ({"X-Request-ID": "a b\tc"}, "application/json"),
    ],
)
def test_headers_that_are(client, headers, kind):
    answer = post(client, b'{"q": [0, 0]}', headers=JSON | headers)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].startswith(kind)


def test_a_doubled_content_type_is_refused(client):
    twice = [("Content-Type", "application/json"), ("Content-Type", "application/x-npy")]
    check(post(client, b'{"q": [0, 0]}', headers=twice), 400, "", "twice")
