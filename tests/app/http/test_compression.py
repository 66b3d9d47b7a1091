"""Large texts as gzip: by the weights of Accept-Encoding, and what is never compressed."""

import gzip
import http.client
import io
import json
from urllib.parse import urlsplit

import numpy as np
import pytest
from starlette.requests import Request

from app.http.compression import COMPRESSED, compressed, needs_coding
from app.http.negotiation import JSON, NPY
from app.http.responses import PartsResponse

FK = "/v1/robots/panda/fk"
ROWS = np.random.default_rng(0).uniform(-1, 1, (500, 7)).tolist()
GZIP = (
    "gzip",
    "x-gzip",
    "GZIP",
    "*",
    "br, gzip;q=0.2",
    "gzip;q=0.5, identity;q=0.1",
    "gzip, identity",
    "identity;q=0, *",
    "*;q=0.1, identity;q=0",
    "deflate, zstd, br, gzip",
    "gzip;q=1.000",
)
PLAIN = (
    None,
    "",
    "identity",
    "br",
    "gzip;q=0",
    "gzip;q=0.000",
    "gzip;q=0, *",
    "*;q=0",
    "gzip;q=0.5, identity",
    "gzip;q=2",
    "identity;q=0",
)


def asked(server, body, headers, path=FK):
    """One request, without a client that decodes, or adds what it accepts."""
    connection = http.client.HTTPConnection(urlsplit(server).netloc, timeout=600)
    connection.putrequest("POST", path, skip_accept_encoding=True)
    for name, value in {"Content-Type": JSON, "Content-Length": str(len(body)), **headers}.items():
        if value is not None:
            connection.putheader(name, value)
    connection.endheaders(body)
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    assert answer.status == 200, content[:200]
    return answer.headers, content


def without_time(content):
    return {key: value for key, value in json.loads(content).items() if key != "elapsed_ms"}


@pytest.mark.scene
def test_the_weights_of_accept_encoding_are_honoured(server):
    body = json.dumps({"q": ROWS}).encode()
    _, plain = asked(server, body, {})
    assert len(plain) > COMPRESSED
    for accepted in (*GZIP, *PLAIN):
        headers, content = asked(server, body, {"Accept-Encoding": accepted})
        assert "Accept-Encoding" in headers["vary"], accepted
        assert int(headers["content-length"]) == len(content)
        assert headers["content-type"] == JSON
        if accepted in GZIP:
            assert headers["content-encoding"] == "gzip", accepted
            assert len(content) < 0.6 * len(plain)
            content = gzip.decompress(content)
        else:
            assert headers["content-encoding"] is None, accepted
        assert content == plain


def test_small_answers_are_compressed_only_where_they_must_be(server):
    body = json.dumps({"q": ROWS[0]}).encode()
    for path in (FK, "/v1/robots/panda/jacobian", "/v1/robots/panda/singularity"):
        headers, plain = asked(server, body, {"Accept-Encoding": "gzip, *"}, path)
        assert headers["content-encoding"] is None
        for refusing in ("identity;q=0, gzip", "gzip, *;q=0", "Identity;q=0, *;q=0.4"):
            headers, content = asked(server, body, {"Accept-Encoding": refusing}, path)
            assert headers["content-encoding"] == "gzip"
            assert gzip.decompress(content) == plain


def test_every_text_is_compressed_and_nothing_else(server):
    body = json.dumps({"q": ROWS}).encode()
    for kind in ("text/csv", JSON):
        headers, content = asked(server, body, {"Accept-Encoding": "gzip", "Accept": kind})
        plain = asked(server, body, {"Accept": kind})[1]
        assert headers["content-encoding"] == "gzip"
        assert gzip.decompress(content) == plain
    file = io.BytesIO()
    np.save(file, np.repeat(ROWS, 20, axis=0))
    headers, content = asked(
        server,
        file.getvalue(),
        {"Content-Type": NPY, "Accept": NPY, "Accept-Encoding": "gzip"},
    )
    assert len(content) > COMPRESSED
    assert headers["content-encoding"] is None
    poses = np.load(io.BytesIO(content))
    one = json.loads(asked(server, json.dumps({"q": ROWS[-1]}).encode(), {})[1])
    np.testing.assert_allclose(poses[-1], one["poses"]["tool"]["matrix"], atol=1e-12)
    assert poses.shape == (10_000, 4, 4)


def test_lines_are_sent_as_they_are_computed(server):
    body = {"start": {"q": [0.1] * 7}, "target": {"position": [0.4, 0.1, 0.5]}, "task": "position"}
    body = {"q": [0, -0.5, 0, -2, 0, 1.5, 0], "samples": 400, **body}
    del body["start"]
    accepted = {"Accept": "application/x-ndjson", "Accept-Encoding": "gzip"}
    headers, content = asked(server, json.dumps(body).encode(), accepted, "/v1/robots/panda/path")
    assert len(content) > COMPRESSED
    assert headers["content-encoding"] is None
    assert all(json.loads(line) for line in content.splitlines())


def test_what_varies_already_and_large_parts(monkeypatch):
    def request(value):
        return Request({"type": "http", "headers": [(b"accept-encoding", value)]})

    parts = [b"0.123456789," * 200_000, b"", b"1.5" * 100_000]
    whole = b"".join(parts)
    given = PartsResponse(list(parts), 200, {"vary": "Accept-Language", "x-a": "b"}, "text/csv")
    found = compressed(given, request(b"gzip"))
    assert found.headers["vary"] == "Accept-Language, Accept-Encoding"
    assert found.headers["x-a"] == "b"
    assert gzip.decompress(b"".join(found.parts)) == whole
    again = compressed(found, request(b"gzip"))
    assert again is found
    assert not needs_coding(request(b"gzip, identity;q=0.1"))
    assert needs_coding(request(b"gzip, identity;q=0"))
