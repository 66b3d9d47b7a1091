"""Memory is reserved before it is used: fairly, with an end to waiting, and never too much."""

import asyncio

import httpx
import pytest

from app.admission.machine import IDLE
from app.admission.memory import Memory
from app.admission.need import SMALL, Need
from app.dependencies import Services
from app.http.problems import RequestProblem
from app.settings import Settings
from tests.conftest import PATIENCE, until

FK = "/v1/robots/panda/fk"
PIECE = b"[0, 0, 0, 0, 0, 0, 0]," * 10_000
LARGE = 10 * SMALL


def run(scene):
    return asyncio.run(asyncio.wait_for(scene, PATIENCE))


def test_who_waits_is_served_in_turn_and_small_ones_pass_by():
    async def scene():
        memory, order = Memory(LARGE, PATIENCE), []

        async def one(name, size):
            reservation = memory.reservation()
            await reservation.grow(Need(size))
            order.append(name)
            return reservation

        first = await one("first", LARGE - SMALL)
        second = asyncio.create_task(one("second", LARGE // 2))
        third = asyncio.create_task(one("third", LARGE // 4))
        await asyncio.sleep(0)
        (await one("small", 1000)).end()
        assert memory.waiting == 2
        first.end()
        (await second).end()
        (await third).end()
        assert order == ["first", "small", "second", "third"]
        assert (memory.used, memory.waiting) == (0, 0)

    run(scene())


def test_who_waits_too_long_is_told_when_to_come_again():
    async def scene():
        memory = Memory(LARGE, 0.05)
        held = memory.reservation()
        await held.grow(Need(LARGE))
        with pytest.raises(RequestProblem) as refused:
            await memory.reservation().grow(Need(LARGE))
        assert refused.value.type.status == 503
        assert int(refused.value.headers["Retry-After"]) >= 1
        held.end()
        assert (memory.used, memory.waiting) == (0, 0)

    run(scene())


def test_who_leaves_while_waiting_lets_the_next_one_in():
    async def scene():
        memory = Memory(LARGE, PATIENCE)
        held = memory.reservation()
        await held.grow(Need(LARGE // 2))
        leaving = asyncio.create_task(memory.reservation().grow(Need(LARGE)))
        await asyncio.sleep(0)
        behind = memory.reservation()
        staying = asyncio.create_task(behind.grow(Need(LARGE // 4)))
        await asyncio.sleep(0)
        leaving.cancel()
        await staying
        held.end()
        behind.end()
        assert (memory.used, memory.waiting) == (0, 0)

    run(scene())


@pytest.mark.parametrize(
    ("need", "words"),
    [
        (Need(LARGE / 100, 1000), "give at most 90 rows of q"),
        (Need(1.0, 10**5, of="samples", squared=True), "give at most 6000 samples"),
        (Need(1.0, fixed=LARGE), "it does not fit on this service"),
    ],
)
def test_what_can_never_fit_is_refused_with_the_size_that_would(need, words):
    async def scene():
        memory = Memory(LARGE, PATIENCE)
        with pytest.raises(RequestProblem, match=words) as refused:
            await memory.reservation(LARGE // 10).grow(need)
        assert refused.value.type.status == 413
        assert memory.used == 0

    run(scene())


def test_memory_of_large_bodies_is_bounded(serve):
    with serve(max_worker_bytes=100_000_000, max_wait_seconds=1, body_seconds=PATIENCE) as server:

        def answer() -> httpx.Response:
            parts = iter((b'{"q": [', PIECE, b"[0, 0, 0, 0, 0, 0, 0]]}"))
            headers = {"Content-Type": "application/json"}
            return httpx.post(server.address + FK, content=parts, headers=headers, timeout=PATIENCE)

        assert answer().status_code == 200
        with server.connect() as connection:
            # Nearly all of the memory; and there is more to come, so that it stays taken.
            connection.sendall(
                b"POST /v1/robots/panda/fk HTTP/1.1\r\nHost: x\r\nContent-Type: application/json"
                b"\r\nContent-Length: 60000000\r\n\r\n" + PIECE * 120
            )
            until(lambda: answer().status_code == 503)
            assert int(answer().headers["retry-after"]) >= 1
            small = httpx.post(server.address + FK, json={"q": [0] * 7}, timeout=PATIENCE)
            assert small.status_code == 200
        until(lambda: answer().status_code == 200)


def test_documents_count_while_they_are_read():
    """Of a robot, in the threads that read them, too."""

    async def scene():
        services = Services(Settings(max_worker_bytes=IDLE + LARGE, max_wait_seconds=0.05))
        try:
            memory, size = services.memory, LARGE // 100
            assert await services.loaded(lambda: memory.used, size) >= 10 * size
            assert memory.used == 0
            with pytest.raises(RequestProblem, match="bytes in a document at once") as refused:
                await services.loaded(lambda: None, LARGE // 10)
            assert refused.value.type.status == 413
            held = memory.reservation()
            await held.grow(Need(LARGE))
            with pytest.raises(RequestProblem) as busy:
                await services.loaded(lambda: None, size)
            assert busy.value.type.status == 503
            assert await services.loaded(lambda: "small", 1000) == "small"
            held.end()
        finally:
            services.close()

    run(scene())
