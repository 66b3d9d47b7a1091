"""JSON bodies at the edges: exact or refused, at once."""

import json
import socket

import pytest

from tests.app.http.requests import FK, IK, check, post
from tests.app.meanwhile import others_are_served
from tests.conftest import PATIENCE


@pytest.mark.parametrize(
    ("path", "body", "pointer"),
    [
        (FK, b'{"q": [1, 2], "q": [0, 0]}', "/q"),
        (FK, b'{"q": [0, 0], "\\u0071": [0, 0]}', "/q"),
        (FK, b'{"q": {"j1": 0, "j1": 0, "j2": 0}}', "/q/j1"),
        (FK, b'{"q": [0, 0], "frames": ["q", "tool"], "q": [0, 0]}', "/q"),
        (FK, b'{"q": [0, 0], "euler": "ZXZ", "euler": "ZXZ"}', "/euler"),
        (
            IK,
            b'{"task": "xy", "target": {"position": [1, 0], "position": [0, 1]}}',
            "/target/position",
        ),
        (
            IK,
            b'{"task": "xy", "targets": [{"position": [1, 0]}, {"position": [1, 0],'
            b' "position": [0, 1]}]}',
            "/targets/1/position",
        ),
        ("/v1/fk", b'{"robot": "planar_2r", "robot": "ur5", "q": [0, 0]}', "/robot"),
        ("/v1/fk", b'{"robot": {"urdf": "a", "urdf": "a"}, "q": [0, 0]}', "/robot/urdf"),
        ("/v1/fk", b'{"robot": {"urdf": "a"}, "robot": {"urdf": "a"}, "q": [0, 0]}', "/robot"),
        ("/v1/fk", b'{"robot": {"a/b~": 1, "a/b~": 1}, "q": [0, 0]}', "/robot/a~1b~0"),
        ("/v1/diff", b'{"robot": "ur5", "other": "ur5", "robot": "ur5"}', "/robot"),
        ("/v1/axes-to-dh", b'{"joints": [], "joints": []}', "/joints"),
    ],
)
def test_a_key_twice_in_one_object_is_refused(client, path, body, pointer):
    check(post(client, body, path), 422, pointer, "stands twice")


@pytest.mark.parametrize(
    "body",
    [
        b'{"q": [0, 0], "frames": ["tool", "tool"]}',
        b'{"q": {"j1": 0, "j2": 0}, "frames": ["frame_1"], "euler": "ZXZ"}',
        b'{"q": [0, 0], "frames": ["\\u0074ool"]}',
        b' \r\n\t{"q"\t:\n[ -0 , 1e-400 ] } \n',
    ],
)
def test_texts_that_stand_twice_without_being_keys_are_not(client, body):
    assert post(client, body).status_code == 200


@pytest.mark.parametrize(
    ("body", "status", "words"),
    [
        (b"", 400, "it is empty"),
        (b"  \n", 400, "it is empty"),
        (b'\xef\xbb\xbf{"q": [0, 0]}', 400, "byte order mark"),
        ('{"q": [0, 0]}'.encode("utf-16"), 400, "byte order mark"),
        ('{"q": [0, 0]}'.encode("utf-16-le"), 400, "byte order mark"),
        (b'{"q": [0, 0]} x', 400, "trailing characters"),
        (b'{"q": [0, 0]}\0', 400, "trailing characters"),
        (b'{"q": [0, 0]', 400, "ends too early"),
        (b'{"q": [NaN, 0]}', 400, "NaN"),
        (b'{"q": [Infinity, 0]}', 400, "NaN"),
        (b'{"q": [1e999, 0]}', 422, "out of range"),
        (b'{"q": [' + b"9" * 400 + b", 0]}", 422, "q"),
        (b'{"q": [01, 0]}', 400, "invalid number"),
        (b'{"q": [0, 0], "euler": "\\ud800"}', 400, "surrogate"),
        (b'{"q": [0, 0], "euler": "\xff"}', 400, "UTF-8"),
        (b'{"q": [0, 0], "\xff": 0}', 400, "UTF-8"),
        (b'[{"q": [0, 0]}]', 422, "expected an object"),
        (b"null", 422, "expected an object"),
        (b'{"q": ' + b"[" * 5000 + b"]" * 5000 + b"}", 400, "deeply"),
        (b"[" * 100_000, 422, "expected an object"),
        (b'{"q": [0, 0], "euler": 3}', 422, "a text"),
        (b'{"q": [0, true]}', 422, "a number"),
    ],
)
def test_what_is_no_json_or_another_value(client, body, status, words):
    answer = post(client, body)
    assert answer.status_code == status, answer.text
    assert words in answer.json()["detail"], answer.text
    assert "codec" not in answer.text


def test_names_are_shown_cleaned_and_short(client):
    name = "\u202e\u0007a/b~" + "x" * 5000
    answer = post(client, json.dumps({"q": [0, 0], name: 0}))
    check(answer, 422, answer.json()["errors"][0]["pointer"], "unknown field")
    shown = answer.json()["errors"][0]
    assert shown["pointer"].startswith("/??a~1b~0x")
    assert len(shown["message"]) < 400
    assert not {"\u202e", "\u0007"} & set(answer.text)
    check(client.get("/v1/%E2%80%AEx/y~z"), 404, "", "/v1/ x/y~z")
    check(client.get(f"{FK}?q=0,0&a~b/c=1"), 422, "/a~0b~1c")


def fill(item, count):
    return b'{"q": [' + b",".join([item] * count) + b"]}"


@pytest.mark.parametrize(
    ("body", "status", "pointer"),
    [
        (fill(b'"x"', 100_000), 422, "/q"),
        (fill(b"null", 100_000), 422, "/q"),
        (fill(b'{"a": 1}', 100_000), 422, "/q"),
        (fill(b"0", 3_000_000), 422, "/q"),
        (fill(b"[0, 0, 0]", 100_000), 422, "/q/0"),
        (fill(b"[0, 0]", 150_000)[:-2] + b', [0, "x"]]}', 422, "/q/150000/1"),
        (fill(b"[0, 0]", 150_000)[:-2] + b", [0]]}", 422, "/q/150000"),
        (fill(b"[0, 0]", 150_000)[:-2] + b", [0, 1e7]]}", 422, "/q/150000/1"),
        (b'{"q": [[' + b"0," * 3_000_000 + b"0]]}", 422, "/q/0"),
        (fill(b"[0,0]", 250_000), 422, "/q"),
        (b'{"q": {' + b",".join(b'"k%d": 0' % k for k in range(100_000)) + b"}}", 422, "/q"),
        (b'{"q": [0, 0], "frames": [' + b'"a",' * 300_000 + b'"a"]}', 413, ""),
        (b'{"q": [0, 0], "euler": "' + b"a" * 1_100_000 + b'"}', 413, "/euler"),
        (b"{" + b",".join(b'"k%d": 0' % k for k in range(300_000)) + b"}", 413, ""),
    ],
)
def test_many_bad_items_are_refused_at_once_while_others_are_served(server, body, status, pointer):
    host, port = server.removeprefix("http://").split(":")

    def refused() -> None:
        with socket.create_connection((host, int(port)), PATIENCE) as raw:
            head = f"POST {FK} HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
            raw.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n".encode())
            raw.sendall(body)
            answer = b""
            while b"request_id" not in answer:
                answer += raw.recv(65536)
        assert f" {status} ".encode() in answer[:20], answer
        problem = json.loads(answer.partition(b"\r\n\r\n")[2])
        assert problem["errors"][0]["pointer"] == pointer, problem

    assert others_are_served(server, refused)


def test_targets_that_are_too_many_bytes(client):
    target = b'{"position": [1, 0], "phi": ' + b"0.0}"
    body = b'{"task": "xy", "targets": [' + b",".join([target] * 300_000) + b"]}"
    assert post(client, body, IK).status_code == 413
    check(post(client, b'{"targets": [' + b"[]," * 100_000 + b"[]]}", IK), 422, "/targets/0")
