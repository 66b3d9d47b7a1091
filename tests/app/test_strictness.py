"""Bodies, queries, headers and methods at the edges: exact or refused, at once, in one shape."""

import gzip
import io
import json
import socket
import struct

import numpy as np
import pytest

from app.operations.singularity import SINGULARITY
from robots.shipped import shipped_robot
from tests.app.meanwhile import others_are_served
from tests.conftest import PATIENCE
from tests.cost import within
from tests.processes import processor_seconds

FK = "/v1/robots/planar_2r/fk"
IK = "/v1/robots/planar_2r/ik"
JSON = {"Content-Type": "application/json"}
NPY = {"Content-Type": "application/x-npy"}


def check(answer, status, pointer, *words):
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert len(answer.content) <= 4096
    problem = answer.json()
    assert 1 <= len(problem["errors"]) <= 10
    assert problem["errors"][0]["pointer"] == pointer, problem
    assert [word for word in words if word not in problem["detail"]] == []


def post(client, body, path=FK, headers=JSON):
    return client.post(path, content=body, headers=headers)


@pytest.mark.parametrize(
    ("path", "body", "pointer"),
    [
        (FK, b'{"q": [1, 2], "q": [0, 0]}', "/q"),
        (FK, b'{"q": [0, 0], "\\u0071": [0, 0]}', "/q"),
        (FK, b'{"q": {"j1": 0, "j1": 0, "j2": 0}}', "/q/j1"),
        (FK, b'{"q": [0, 0], "frames": ["q", "tool"], "q": [0, 0]}', "/q"),
        (FK, b'{"q": [0, 0], "euler": "ZXZ", "euler": "ZXZ"}', "/euler"),
        (IK, b'{"task": "xy", "target": {"position": [1, 0], "position": [0, 1]}}',
         "/target/position"),
        (IK, b'{"task": "xy", "targets": [{"position": [1, 0]}, {"position": [1, 0],'
         b' "position": [0, 1]}]}', "/targets/1/position"),
        ("/v1/fk", b'{"robot": "planar_2r", "robot": "ur5", "q": [0, 0]}', "/robot"),
        ("/v1/fk", b'{"robot": {"urdf": "a", "urdf": "a"}, "q": [0, 0]}', "/robot/urdf"),
        ("/v1/fk", b'{"robot": {"urdf": "a"}, "robot": {"urdf": "a"}, "q": [0, 0]}', "/robot"),
        ("/v1/fk", b'{"robot": {"a/b~": 1, "a/b~": 1}, "q": [0, 0]}', "/robot/a~1b~0"),
        ("/v1/diff", b'{"robot": "ur5", "other": "ur5", "robot": "ur5"}', "/robot"),
        ("/v1/axes-to-dh", b'{"joints": [], "joints": []}', "/joints"),
    ],
)  # fmt: skip
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


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


def with_header(header, payload=b"", version=1):
    size = struct.pack("<H" if version == 1 else "<I", len(header) + 1)
    return b"\x93NUMPY" + bytes([version, 0]) + size + header + b"\n" + payload


Q = np.array([[0.5, -0.25], [1.0, 2.0], [0.125, 0.75]])


@pytest.mark.parametrize(
    "array",
    [
        Q.astype(">f8"), Q.astype("<f4"), Q.astype(">f4"), Q.astype("<f2"), np.asfortranarray(Q),
        Q.astype(">f8").copy(order="F"), Q[0], Q.astype(">f2"),
    ],
)  # fmt: skip
def test_npy_of_any_real_type_and_order_is_read_exactly(client, array):
    answer = post(client, npy(array), headers=NPY)
    assert answer.status_code == 200, answer.text
    expected = post(client, json.dumps({"q": array.astype(float).tolist()}))
    assert answer.json() == expected.json()


def test_npy_of_integers_and_of_other_versions_is_read_exactly(client):
    expected = post(client, b'{"q": [[1, -2], [3, 4]]}').json()
    whole = np.array([[1, -2], [3, 4]])
    for kind in ("<i8", ">i4", "<i2", "i1"):
        assert post(client, npy(whole.astype(kind)), headers=NPY).json() == expected
    data = whole.astype("<f8").tobytes()
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }"
    for version in (1, 2, 3):
        answer = post(client, with_header(header, data, version), headers=NPY)
        assert answer.json() == expected, version


HEADER = "{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}"


@pytest.mark.parametrize(
    ("body", "status"),
    [
        (npy(Q.astype(complex)), 422),
        (npy(Q.astype(np.longdouble)), 422),
        (npy(Q > 0), 422),
        (npy(Q.astype("U8")), 422),
        (npy(Q.astype("M8[s]")), 422),
        (npy(np.array([(0.0, 1.0)], dtype="f8,f8")), 422),
        (npy(np.array([[{}, []]], dtype=object)), 422),
        (npy(np.empty((0, 2))), 422),
        (npy(np.zeros((1, 1, 1, 2))), 422),
        (npy(np.zeros((2, 2, 2))), 422),
        (npy(np.array(0.5)), 422),
        (npy(np.array([[np.nan, 0.0]])), 422),
        (npy(np.array([[np.inf, 0.0]])), 422),
        (npy(Q)[:-1], 400),
        (npy(Q) + b"\0", 400),
        (npy(Q)[:20], 400),
        (b"", 400),
        (b"PK\x03\x04", 400),
        (with_header(HEADER.format("'<f8'", False, "(-1, 2)").encode()), 422),
        (with_header(HEADER.format("'<f8'", False, "(4294967296, 4294967296)").encode()), 422),
        (with_header(HEADER.format("'<f8'", False, "(999999999, 999999999)").encode()), 413),
        (with_header(HEADER.format("'<f8'", False, "(True, 2)").encode(), bytes(16)), 422),
        (with_header(HEADER.format("'<f8'", "1", "(1, 2)").encode(), bytes(16)), 400),
        (with_header(HEADER.format("'|O'", False, "(1, 2)").encode(), bytes(16)), 422),
        (with_header(HEADER.format("'<u1'", False, "(32000000, 2)").encode()), 413),
        (with_header(b"(" * 4000), 400),
        (with_header(b"-" * 4000 + b"1"), 400),
        (with_header(b"9**9**9**9"), 400),
        (with_header(b"__import__('os').abort()"), 400),
        (with_header(b" " * 10_000_000, version=2), 400),
        (with_header(b"{" * 60_000, version=2), 400),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff", 400),
        (b"\x93NUMPY\x09\x00v\x00", 400),
    ],
)
def test_other_npy_is_refused_at_once(client, service, body, status):
    before = processor_seconds(service[1])
    answer = post(client, body, headers=NPY)
    assert within(processor_seconds(service[1]) - before, 2)
    pointer = answer.json()["errors"][0]["pointer"]
    check(answer, status, pointer)


@pytest.mark.parametrize(
    ("query", "pointer"),
    [
        ("q=0,0&q=0,0", "/q"),
        ("q=0,0&x=1", "/x"),
        ("q=", "/q"),
        ("q=0,", "/q"),
        ("q=%zz,0", "/q"),
        ("q=%00,0", "/q"),
        ("q=%ff,0", "/q"),
        ("q=nan,0", "/q"),
        ("q=1e400,0", "/q"),
        ("q=1_0,0", "/q"),
        ("q=%D9%A3,0", "/q"),
        ("q=%EF%BC%91,0", "/q"),
        ("q=]0,0[", "/q"),
        ("q=1e+1,0", "/q"),
        ("q=" + "0," * 2000 + "0", "/q"),
        ("q=0,0&euler=", "/euler"),
        ("q=0,0&frames=", "/frames"),
        ("q=0,0&frames=tool,,tool", "/frames"),
        ("q=0,0&angle=", "/angle"),
        ("q=0,0&format=", "/format"),
        ("", "/q"),
    ],
)
def test_queries_that_say_something_else(client, query, pointer):
    check(client.get(f"{FK}?{query}"), 422, pointer)


def test_queries_that_are_too_long(client):
    many = "&".join(f"x{k}=1" for k in range(20_000))
    check(client.get(f"{FK}?{many[:60_000]}"), 414, "", "POST")
    check(client.get("/v1/" + "a" * 5000), 414, "")


@pytest.mark.parametrize("size", ["0", "1001", "-1", "1e3", "%D9%A3", "", "1" * 400, "+1"])
def test_page_sizes(client, size):
    check(client.get(f"/v1/robots?page_size={size}"), 422, "/page_size")


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
        ({"Accept": "application/json;q=0, text/csv"}, 406, "application/json"),
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


def test_a_body_without_a_declared_length_is_bounded(client):
    def parts(count):
        for _ in range(count):
            yield b" " * 65536

    headers = JSON
    check(client.put("/v1/robots/probe", content=parts(40), headers=headers), 413, "", "larger")
    check(client.post(FK, content=parts(3), headers=headers), 400, "", "empty")


def test_head_is_get_without_a_body_on_every_route(client):
    document = client.get("/openapi.json").json()
    paths = [path for path, item in document["paths"].items() if "get" in item]
    for path in (*paths, "/", "/docs", "/openapi.json", "/problems/invalid-q"):
        parameters = document["paths"].get(path, {}).get("get", {}).get("parameters", [])
        examples = {p["name"]: p["example"] for p in parameters if "example" in p}
        robot = examples.pop("robot_id", "ur5")
        url = path.replace("{robot_id}", robot)
        head, get = client.head(url, params=examples), client.get(url, params=examples)
        assert (head.status_code, head.content) == (get.status_code, b""), url
        assert head.headers["content-type"] == get.headers["content-type"]
    assert client.head("/v1/fk").status_code == 405
    assert client.head("/v1/robots/none").status_code == 404


@pytest.mark.parametrize(
    ("path", "allowed"),
    [
        ("/v1/robots", "GET, HEAD, POST, OPTIONS"),
        ("/v1/robots/ur5", "GET, HEAD, PUT, DELETE, OPTIONS"),
        ("/v1/robots/ur5/fk", "GET, HEAD, POST, OPTIONS"),
        ("/v1/robots/ur5/dh", "GET, HEAD, OPTIONS"),
        ("/v1/fk", "POST, OPTIONS"),
        ("/health/live", "GET, HEAD, OPTIONS"),
        ("/docs-assets/x.js", "GET, HEAD, OPTIONS"),
    ],
)
def test_methods_that_are_not_possible_say_which_are(client, path, allowed):
    for method in ("TRACE", "PATCH", "PROPFIND"):
        answer = client.request(method, path)
        check(answer, 405, "", method, allowed)
        assert answer.headers["allow"] == allowed
    answer = client.options(path)
    if "docs-assets" not in path:
        assert (answer.status_code, answer.content) == (204, b"")
        assert answer.headers["allow"] == allowed


@pytest.mark.parametrize(
    "path", ["/v1/robots/", "/v1//robots", "/v1/robots/ur5/fk/", "/v1/robots/%2e%2e", "/v1/fk/x",
             "/v1/robots/%00", "/v1/robots/UR5", "/v1/robots/ur5%20", "/v1/robots/a%2Fb"],
)  # fmt: skip
def test_addresses_that_lead_nowhere(client, path):
    check(client.get(path), 404, "")
    check(client.options(path), 404, "") if path.endswith("/") else None


def test_problems_are_text_for_those_who_ask_for_text(client):
    asked = ({"params": {"format": "text"}}, {"headers": {"Accept": "text/plain"}})
    for ask in asked:
        answer = client.get("/v1/robots/puma56", **ask)
        assert answer.status_code == 404
        assert answer.headers["content-type"] == "text/plain; charset=utf-8"
        first, second, third = answer.text.splitlines()
        assert first == "404 There is no such robot"
        assert "did you mean puma560" in second
        assert third == f"request_id: {answer.headers['x-request-id']}"
    answer = client.get(f"{FK}?q=0,x&format=text")
    assert answer.text.splitlines()[1].startswith("  /q: ")
    check(client.get(f"{FK}?q=0,x&format=json", headers={"Accept": "text/plain"}), 422, "/q")


@pytest.mark.parametrize(
    ("path", "body", "pointer"),
    [
        ("fk", {"q": {"j1": 0, "j2": 10**400}}, "/q/j2"),
        ("fk", {"q": {"j1": 0, "j2": -(10**20)}}, "/q/1"),
        ("singularity", {"q": [0, 0], "tolerance": -1}, "/tolerance"),
        ("singularity", {"q": [0, 0], "tolerance": 1e308}, "/tolerance"),
        ("singularity", {"q": [0, 0], "characteristic_length": 0}, "/characteristic_length"),
        ("singularity", {"q": [0, 0], "characteristic_length": 1e-320}, "/characteristic_length"),
        ("singularity", {"q": [0, 0], "task": [0] * 6}, "/task"),
        ("singularity", {"q": [0, 0], "task": [True] * 6}, "/task/0"),
        ("singularity/nearest", {"q": [0, 0], "tolerance": 5}, "/tolerance"),
        ("manipulability-gradient", {"q": [0, 0], "tolerance": -1e-320}, "/tolerance"),
        ("wrench", {"q": [0, 0], "tau": [1e308, 0]}, "/tau/0"),
        ("wrench", {"q": [0, 0], "tau": [1, 0], "tolerance": 1}, "/tolerance"),
        ("joint-torques", {"q": [0, 0], "wrench": [0, 0, 0, 0, 0, 1e308]}, "/wrench/5"),
        ("joint-velocities", {"q": [0, 0], "twist": [0] * 6, "damping": 1e-320}, "/damping"),
        ("joint-velocities", {"q": [0, 0], "twist": [0] * 6, "damping": 1e308}, "/damping"),
        ("twist", {"q": [0, 0], "qd": [0, 1e308]}, "/qd/1"),
        ("step", {"q": [0, 0], "delta_x": [1e308, 0], "task": "xy"}, "/delta_x"),
        ("step", {"q": [0, 0], "delta_x": [0, 0], "task": "xy", "damping": 1e308}, "/damping"),
        ("ik", {"target": {"position": [1e308, 0]}, "task": "xy"}, "/target/position"),
        ("ik", {"target": {"position": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 0]}},
         "/target/quaternion_xyzw"),
        ("ik", {"target": {"matrix": np.diag([1, 1, -1, 1]).tolist()}}, "/target/matrix"),
        ("ik", {"target": {"matrix": np.diag([2, 2, 2, 1]).tolist()}}, "/target/matrix"),
        ("ik", {"target": {"matrix": [[1e308] * 4] * 4}}, "/target/matrix"),
        ("ik", {"target": {"position": [0, 0, 0], "euler": {"sequence": "Z" * 9000,
                                                            "angles": [0, 0, 0]}}},
         "/target/euler/sequence"),
        ("ik", {"target": {"position": [1, 0]}, "task": "xy", "max_restarts": 10**9},
         "/max_restarts"),
        ("ik", {"target": {"position": [1, 0]}, "task": "xy", "time_budget_ms": -1},
         "/time_budget_ms"),
        ("ik", {"targets": [{"position": [1, 0]}] * 500 + [{"position": [1, None]}], "task": "xy"},
         "/targets/500/position/1"),
        ("ik", {"targets": [{"position": [1, 0]}] * 500 + [{"position": [1, 1e7]}], "task": "xy"},
         "/targets/500/position"),
        ("fk", {"q": [0, 0], "frames": [f"f{k}" for k in range(99_000)]}, "/frames/0"),
    ],
)  # fmt: skip
def test_numbers_and_lists_that_would_break_the_mathematics(client, path, body, pointer):
    check(client.post(f"/v1/robots/planar_2r/{path}", json=body), 422, pointer)


def test_time_budget_of_nothing_and_doubled_frames_are_answered(client):
    body = {"target": {"position": [1, 0]}, "task": "xy", "time_budget_ms": 0}
    assert client.post(IK, json=body).json()["status"] in ("timeout", "converged")
    answer = client.post(FK, json={"q": [0, 0], "frames": ["tool"] * 99_000}).json()
    assert list(answer["poses"]) == ["tool"]


def test_singularity_reports_are_left_to_a_thread():
    """Milliseconds each: in the event loop, eight at a time would hold up /health/live."""
    robot, request = shipped_robot("puma560"), SINGULARITY.request(q=np.zeros(6))
    assert SINGULARITY.run_at_once(robot, request, None) is None
