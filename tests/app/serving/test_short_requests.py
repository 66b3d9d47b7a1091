"""Short computations are answered without a task, and as the ordinary way answers them."""

import json
import re
import socket
import time
from contextlib import closing

import numpy as np
import pytest

from app.dependencies import Services
from app.middleware.request_id import RequestIds
from app.operations import OPERATIONS
from app.routes.compute import Computation
from app.serving.short_requests import (
    HEAD_BYTES,
    HEADS,
    Declined,
    ShortAnswer,
    short_requests,
)
from app.settings import Settings
from app.telemetry.observed import Records
from kinematics.forward import fk
from robots.shipped import shipped_robot
from tests.conftest import PATIENCE, running_server
from tests.recorded.exchange import Connection
from tests.recorded.fixture import SETUP
from tests.recorded.normalise import normalised
from tests.recorded.replay import chosen_records
from tests.torture.exchange import Sent

BODY = json.dumps({"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]}).encode()
OTHER_WAY = ("X-Unheard-Of", "1")
"""A header that nothing looks at, and with which a request goes the ordinary way."""
FK = "/v1/robots/puma560/fk"


@pytest.fixture
def short(tmp_path):
    return made(data_dir=tmp_path)


def made(**settings):
    services = Services(Settings(preload=False, **settings))
    computations = {one.name: Computation(one, 1_000_000) for one in OPERATIONS}
    records = Records(None, access_log=False, log_clients=False)
    return short_requests(services, computations, records, RequestIds())


def scope(method="POST", path=FK, query=b"", **headers):
    plain = {"host": "localhost", "content-type": "application/json", "content-length": "48"}
    if method == "GET":
        plain = {"host": "localhost"}
    given = {**plain, **{name.replace("_", "-"): value for name, value in headers.items()}}
    return {
        "type": "http",
        "method": method,
        "path": path,
        "query_string": query,
        "headers": [(k.encode(), v.encode()) for k, v in given.items() if v is not None],
    }


@pytest.mark.parametrize(
    "asked",
    [
        scope(user_agent="curl/8.5.0", accept="*/*"),
        scope(user_agent="python-httpx/0.28", accept_encoding="gzip, br", connection="keep-alive"),
        scope(origin="http://localhost:8000", sec_fetch_site="same-origin", referer="http://x/"),
        scope(path="/v1/robots/panda/ik"),
        scope(query=b"angle=deg&format=text"),
        scope("GET", query=b"q=0,0,0,0,0,0", accept_language="fr"),
    ],
)
def test_what_people_and_programs_send_is_answered_at_once(short, asked):
    assert short.find(asked) is not None


@pytest.mark.parametrize(
    "asked",
    [
        scope("PUT"),
        scope("HEAD", content_type=None, content_length=None),
        scope(host="rebound.example.org/"),
        scope(host=None),
        scope(content_type="application/x-npy"),
        scope(content_type="application/json; charset=latin-1"),
        scope(content_length="4001"),
        scope(content_length=None, transfer_encoding="chunked"),
        scope(content_encoding="gzip"),
        scope(expect="100-continue"),
        scope(if_none_match='"x"'),
        scope(authorization="Bearer abc"),
        scope(query=b"q=" + b"0" * 5000),
        scope(path="/v1/robots/puma560/urdf"),
        scope(path="/v1/robots/puma560/path"),
        scope(path="/v1/fk"),
        scope(path="/other/v1/robots/puma560/fk"),
    ],
)
def test_what_is_unusual_goes_the_ordinary_way(short, asked):
    assert short.find(asked) is None


def test_two_headers_of_one_kind_go_the_ordinary_way(short):
    for name in (b"host", b"content-type", b"content-length", b"accept"):
        asked = scope(accept="*/*")
        asked["headers"].append((name, dict(asked["headers"])[name]))
        assert short.find(asked) is None, name


@pytest.mark.parametrize(
    "more",
    [{"rate_limit": "10/second"}, {"cors_origins": "*"}, {"api_keys": f"ada:write:{64 * '0'}"}],
)
def test_where_more_is_done_for_each_request_all_go_the_ordinary_way(tmp_path, more):
    assert made(data_dir=tmp_path, **more) is None


def test_where_traces_are_kept_all_go_the_ordinary_way(tmp_path, monkeypatch):
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", "http://localhost:4318")
    monkeypatch.delenv("OTEL_SDK_DISABLED", raising=False)
    assert made(data_dir=tmp_path) is None


def test_errors_and_robots_that_are_not_loaded_go_the_ordinary_way(short):
    found = short.find(scope())
    assert short.answer(found, BODY) is Declined.ERROR
    short.services.store.get("puma560")
    assert isinstance(short.answer(found, BODY), ShortAnswer)
    assert short.answer(found, b'{"q": [0, 0]}') is Declined.ERROR
    assert short.answer(found, b"{") is Declined.ERROR
    assert short.answer(short.find(scope(path="/v1/robots/none/fk")), BODY) is Declined.ERROR


def test_what_takes_longer_is_tried_once(short):
    """A target out of reach: the attempt on the event loop is not made again."""
    short.services.store.get("puma560")
    found = short.find(scope(path="/v1/robots/puma560/ik", content_length="40"))
    body = b'{"target": {"matrix": [[1,0,0,9],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}'
    assert short.answer(found, body) is Declined.LONGER


def every_way(connection, sent):
    """Answers by the parser, by a head that is remembered, and by the ordinary way."""
    plain = [connection.send(sent) for _ in range(2)]
    return *plain, connection.send(sent.with_header(*OTHER_WAY))


def computed(every):
    """Recorded requests of computations on shipped robots, which change nothing."""
    found = [
        one.asked
        for one in chosen_records()
        if one.asked.operation != SETUP
        and one.asked.sent.method in ("GET", "POST")
        and one.asked.sent.target.startswith("/v1/robots/")
        and "recorded-" not in one.asked.sent.target
        and one.asked.operation in {operation.name for operation in OPERATIONS}
        and one.asked.operation not in ("path", "path/compare", "symbolic", "workspace")
        # The last column of a table is the time that it took.
        and not (one.asked.operation == "ik" and re.search("latex|csv", str(one.asked.sent)))
    ]
    return found[::every]


def compared(address, every):
    chosen = computed(every)
    with closing(Connection(address)) as connection:
        for asked in chosen:
            plain, again, other = every_way(connection, asked.sent)
            alike(address, asked.sent, plain, other)
            alike(address, asked.sent, again, other)
    return len(chosen)


def alike(address, sent, plain, other):
    assert normalised(*plain, address) == normalised(*other, address), sent.shown()
    assert sorted(plain[1]) == sorted(other[1]), sent.shown()
    for name in {*plain[1]} - {"date", "x-request-id", "content-length"}:
        assert plain[1][name] == other[1][name], sent.shown()


def numbers_of_joints():
    """Bodies of one q, also such as are refused or told a warning, and others beside them."""
    q = [0.1, -0.2, 0.3, 0.4, 0.5, 0.6]
    several = [
        {"q": q},
        {"q": [0, 1, -0.0, 1e-300, 0.5, 2]},
        {"q": [30, 0, 0, 0, 0, 9]},
        {"q": [1e7, 0, 0, 0, 0, 0]},
        {"q": q[:5]},
        {"q": [q, q]},
        {"q": "0"},
        {"q": [True, 0, 0, 0, 0, 0]},
        {"q": q, "frame": None},
        {"p": q},
        {},
    ]
    texts = [json.dumps(one).encode() for one in several]
    texts += [b'{"q": [1e999, 0, 0, 0, 0, 0]}', b'{"q": [0,0,0,0,0,0], "q": [1,0,0,0,0,0]}', b"{"]
    return [*texts, b' { "q" : [0, 0,0 ,0,0,0 ] } ', rb'{"\u0071": [0,0,0,0,0,0]}', b"[1]"]


@pytest.mark.parametrize("name", ["fk", "jacobian", "singularity"])
@pytest.mark.parametrize("query", ["", "angle=deg", "lang=fr", "format=text"])
def test_bodies_of_one_q_are_answered_byte_by_byte_alike(server, name, query):
    kind = (("Content-Type", "application/json"),)
    with closing(Connection(server)) as connection:
        for body in numbers_of_joints():
            sent = Sent("POST", f"/v1/robots/puma560/{name}", query, kind, body)
            *plain, other = every_way(connection, sent)
            for one in plain:
                alike(server, sent, one, other)
                assert one[0] != 200 or one[2] == other[2], body


def test_solutions_of_closed_forms_are_answered_alike(server):
    """Within and beyond limits, out of reach, singular, with options: at once or in a thread."""
    robot = shipped_robot("puma560")
    rng = np.random.default_rng(5)
    targets = [fk(robot, q)[robot.tip_frame] for q in rng.uniform(-2.5, 2.5, (8, robot.dof))]
    targets.append(fk(robot, np.zeros(robot.dof))[robot.tip_frame])
    bodies = [{"target": {"matrix": one.tolist()}} for one in targets]
    bodies.append({"target": {"position": [9, 0, 0]}, "task": "position"})
    bodies += [bodies[0] | more for more in ({"windings": "all"}, {"swivel": 0.1}, {"task": "xy"})]
    kind = (("Content-Type", "application/json"),)
    with closing(Connection(server)) as connection:
        for body in bodies:
            text = json.dumps(body).encode()
            sent = Sent("POST", "/v1/robots/puma560/ik/solutions", "", kind, text)
            *plain, other = every_way(connection, sent)
            for one in plain:
                alike(server, sent, one, other)


def asking(port, host="127.0.0.1", body=b'{"q": [0, 0, 0, 0, 0, 0]}', more=b""):
    """A whole request in one piece."""
    return (
        b"POST %b HTTP/1.1\r\nHost: %b:%d\r\nContent-Type: application/json\r\n%b"
        b"Content-Length: %d\r\n\r\n%b" % (FK.encode(), host.encode(), port, more, len(body), body)
    )


def test_a_head_is_remembered_for_its_length_of_body_only(short):
    short.services.store.get("puma560")
    head = asking(80, body=BODY)[: -len(BODY)]
    found = short.find(scope(content_length=str(len(BODY))))
    assert short.known(head + BODY) is None
    short.remember(head + BODY, found, BODY)
    assert short.known(head + BODY) == (found, BODY)
    other = BODY.replace(b"0.1", b"0.9")
    assert short.known(head + other) == (found, other)
    for data in (head, head + BODY[:-1], head + BODY + b"P", b"\n" + head + BODY, head[:-1], b""):
        assert short.known(data) is None


@pytest.mark.parametrize("more", [b"P", b"POST / HTTP/1.1\r\n\r\n"])
def test_a_head_is_remembered_only_where_the_parser_has_found_that_body(short, more):
    head = asking(80, body=BODY)[: -len(BODY)]
    found = short.find(scope(content_length=str(len(BODY))))
    short.remember(head + BODY + more, found, BODY)
    short.remember(head + BODY[:-1], found, BODY[:-1])
    assert short.known(head + BODY) is None


def test_heads_with_an_id_of_their_own_are_not_remembered_and_the_others_are_bounded(short):
    own = short.find(scope(content_length=str(len(BODY)), x_request_id="mine-1"))
    plain = short.find(scope(content_length=str(len(BODY))))
    for k in range(HEADS + 10):
        short.remember(asking(k, body=BODY), plain, BODY)
        assert short.known(asking(k, body=BODY))
        short.remember(asking(k, "other", BODY), own, BODY)
        assert not short.known(asking(k, "other", BODY))
    assert sum(short.known(asking(k, body=BODY)) is not None for k in range(HEADS + 10)) <= HEADS
    long = asking(80, "a" * HEAD_BYTES, BODY)
    short.remember(long, plain, BODY)
    assert not short.known(long)


class Talk:
    """A kept connection, over which bytes are sent as they are."""

    def __init__(self, address):
        host, _, port = address.removeprefix("http://").partition(":")
        self.port = int(port)
        self.socket = socket.create_connection((host, self.port), PATIENCE)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.answers = self.socket.makefile("rb")

    def close(self):
        self.answers.close()
        self.socket.close()

    def answer(self):
        """Status and body of the next answer."""
        status, length = self.answers.readline().split()[1], 0
        while (line := self.answers.readline()) not in (b"\r\n", b""):
            if line.startswith(b"content-length:"):
                length = int(line.partition(b":")[2])
        return int(status), self.answers.read(length)


def test_a_remembered_head_within_a_request_is_no_request(server):
    """Bytes that look like a whole request, where the parser is in the middle of another."""
    with closing(Talk(server)) as talk:
        plain = asking(talk.port)
        for _ in range(3):
            talk.socket.sendall(plain)
            assert talk.answer()[0] == 200
        outer = asking(talk.port, body=plain)[: -len(plain)]
        talk.socket.sendall(plain + outer)
        assert talk.answer()[0] == 200
        talk.socket.sendall(plain)
        assert talk.answer()[0] == 400  # POST is no JSON
        talk.socket.sendall(plain + b"POST /")
        assert talk.answer()[0] == 200
        talk.socket.sendall(plain)
        assert talk.answer()[0] != 200


def test_remembered_heads_and_others_are_answered_in_order(server):
    with closing(Talk(server)) as talk:
        plain, other = asking(talk.port), asking(talk.port, more=b"X-Unheard-Of: 1\r\n")
        talk.socket.sendall(plain)
        expected = talk.answer()
        assert expected[0] == 200
        for data in (plain, other, plain + other, plain, other + plain, plain):
            talk.socket.sendall(data)
            for _ in range(data.count(b"POST")):
                assert talk.answer() == expected
        half = len(plain) // 2
        talk.socket.sendall(plain[:half])
        time.sleep(0.1)
        talk.socket.sendall(plain[half:])
        assert talk.answer() == expected


def test_a_connection_idles_from_its_last_answer_on(server):
    """Uvicorn's time to wait for the next request, 5 s, counts from each answer."""
    with closing(Talk(server)) as talk:
        for _ in range(4):
            talk.socket.sendall(asking(talk.port))
            assert talk.answer()[0] == 200
            time.sleep(2)
        assert talk.socket.recv(100) == b""


def test_every_way_answers_alike(server):
    assert compared(server, 60) > 100


@pytest.mark.slow
def test_all_recorded_requests_are_answered_alike_every_way(tmp_path):
    with running_server(tmp_path) as (address, _):
        assert compared(address, 1) > 5000


def test_pipelined_requests_are_answered_in_order(server):
    host, _, port = server.removeprefix("http://").partition(":")
    asked = []
    for k in range(30):
        body = json.dumps({"q": [k / 100, 0, 0, 0, 0, 0]}).encode()
        more = b"X-Unheard-Of: 1\r\n" if k % 3 == 0 else b""
        asked.append(
            b"POST %b HTTP/1.1\r\nHost: %b\r\nX-Request-ID: id-%d\r\nContent-Type:"
            b" application/json\r\n%bContent-Length: %d\r\n\r\n%b"
            % (FK.encode(), host.encode(), k, more, len(body), body)
        )
    asked[-1] = asked[-1].replace(b"Host:", b"Connection: close\r\nHost:")
    with socket.create_connection((host, int(port)), PATIENCE) as connection:
        connection.sendall(b"".join(asked))
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    text = b"".join(parts).decode()
    ids = [line.split(": id-")[1] for line in text.splitlines() if "x-request-id: id-" in line]
    assert ids == [str(k) for k in range(30)]
    assert text.count("HTTP/1.1 200 OK") == 30
    assert "connection: close" in text.rpartition("HTTP/1.1 200 OK")[2]


def test_a_body_that_comes_in_pieces_is_waited_for(server):
    host, _, port = server.removeprefix("http://").partition(":")
    head = (
        b"POST %b HTTP/1.1\r\nHost: %b\r\nContent-Type: application/json\r\nContent-Length: %d\r\n"
        b"Connection: close\r\n\r\n" % (FK.encode(), host.encode(), len(BODY))
    )
    with socket.create_connection((host, int(port)), PATIENCE) as connection:
        for piece in (head[:20], head[20:], BODY[:7], BODY[7:]):
            connection.sendall(piece)
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    assert b"".join(parts).startswith(b"HTTP/1.1 200 OK")
