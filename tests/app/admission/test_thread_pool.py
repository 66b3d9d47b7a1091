"""More work than there is room for: shed at once, with the time to come back; health goes on."""

from concurrent.futures import Future, ThreadPoolExecutor, wait

import httpx
import pytest

from robots.storage.directory import RobotDirectory
from robots.storage.usage_record import Quotas
from tests.conftest import PATIENCE, until

ENDLESS = "/v1/robots/panda/endless"
BODY = {"q": [0.1] * 7}


def ask(address: str, path: str = ENDLESS, **options: object) -> httpx.Response:
    return httpx.post(address + path, json=BODY, timeout=PATIENCE, **options)


def statuses(answers: list[Future[httpx.Response]]) -> list[int]:
    return [answer.result().status_code for answer in answers]


@pytest.mark.scene
def test_beyond_the_queue_work_is_shed_at_once_and_all_the_rest_is_done(serve_long_work):
    settings = {"compute_threads": 1, "max_waiting": 2, "max_wait_seconds": PATIENCE}
    with serve_long_work(**settings) as server, ThreadPoolExecutor(12) as pool:
        kept = [pool.submit(ask, server.address) for _ in range(3)]
        until(lambda: server.in_progress() == 3)
        # These are answered although nothing that came before them is.
        shed = [pool.submit(ask, server.address) for _ in range(9)]
        for answer in (one.result() for one in shed):
            assert answer.status_code == 503
            assert 1 <= int(answer.headers["retry-after"]) <= 60
            assert answer.headers["content-type"] == "application/problem+json"
            assert answer.json()["type"].endswith("/problems/busy")
        assert not any(one.done() for one in kept)
        server.open_gate()
        assert statuses(kept) == [200] * 3
        assert ask(server.address).status_code == 200


def test_who_waits_too_long_is_told_so(serve_long_work):
    settings = {"compute_threads": 1, "max_waiting": 50, "max_wait_seconds": 0.5}
    with serve_long_work(**settings) as server, ThreadPoolExecutor(8) as pool:
        first = pool.submit(ask, server.address)
        server.works_for(0.2)
        late = [pool.submit(ask, server.address) for _ in range(7)]
        assert statuses(late) == [503] * 7
        server.open_gate()
        assert statuses([first]) == [200]


def test_health_answers_while_forty_slow_requests_are_in_flight(serve_long_work):
    with serve_long_work(max_wait_seconds=PATIENCE) as server, ThreadPoolExecutor(40) as pool:
        slow = [pool.submit(ask, server.address) for _ in range(40)]
        until(lambda: server.in_progress() == 40)
        server.works_for(0.2)
        for _ in range(50):
            answer = httpx.get(f"{server.address}/health/live", timeout=PATIENCE)
            assert answer.status_code == 200
        assert not any(one.done() for one in slow)
        server.open_gate()
        assert statuses(slow) == [200] * 40


def test_uploads_are_shed_too(serve_long_work, tmp_path):
    joint = '<joint name="j{0}" type="revolute"><parent link="l{0}"/><child link="l{1}"/>'
    joint += '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    links = "".join(f'<link name="l{k}"/>' for k in range(61))
    joints = "".join(joint.format(k, k + 1) for k in range(60))
    urdf = f'<robot name="r">{links}{joints}</robot>'

    def upload(k: int) -> httpx.Response:
        return httpx.put(
            f"{server.address}/v1/robots/arm-{k}",
            content=urdf.replace('name="r"', f'name="r{k}"'),
            headers={"Content-Type": "application/xml"},
            timeout=PATIENCE,
        )

    with serve_long_work(max_waiting=0) as server, ThreadPoolExecutor(40) as pool:
        # Another writer has its turn: nobody's upload is stored before it is over.
        with RobotDirectory(tmp_path / "data", Quotas()).write_transaction():
            uploads = [pool.submit(upload, k) for k in range(40)]
            until(lambda: sum(one.done() for one in uploads) >= 20)
            early = [one.result() for one in uploads if one.done()]
            assert {answer.status_code for answer in early} == {503}
            assert "/problems/busy" in {answer.json()["type"] for answer in early}
        wait(uploads)
        assert {one.result().status_code for one in uploads} <= {201, 503}
        assert upload(1000).status_code == 201


def test_streams_hold_their_place_and_are_not_broken_off(serve_long_work):
    settings = {"compute_threads": 1, "max_waiting": 1, "max_wait_seconds": PATIENCE}
    headers = {"Accept": "application/x-ndjson"}
    with serve_long_work(**settings) as server, ThreadPoolExecutor(2) as pool:
        kept = [pool.submit(ask, server.address, headers=headers) for _ in range(2)]
        until(lambda: server.in_progress() == 2)
        for _ in range(4):
            assert ask(server.address, headers=headers).status_code == 503
        assert not any(one.done() for one in kept)
        server.open_gate()
        for answer in (one.result() for one in kept):
            assert answer.status_code == 200
            *lines, last = answer.text.splitlines()
            assert lines == [f'{{"index":{k}}}' for k in range(len(lines))]
            assert last == f'{{"last":{len(lines)}}}'
