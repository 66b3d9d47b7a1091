"""Memory of large bodies is bounded, while they arrive too."""

import httpx

from tests.conftest import PATIENCE, until

FK = "/v1/robots/panda/fk"
PIECE = b"[0, 0, 0, 0, 0, 0, 0]," * 10_000


def test_memory_of_large_bodies_is_bounded(serve):
    with serve(max_buffered_bytes=1_000_000, body_seconds=PATIENCE) as server:

        def answer() -> httpx.Response:
            parts = iter((b'{"q": [', PIECE, b"[0, 0, 0, 0, 0, 0, 0]]}"))
            headers = {"Content-Type": "application/json"}
            return httpx.post(server.address + FK, content=parts, headers=headers, timeout=PATIENCE)

        assert answer().status_code == 200
        with server.connect() as connection:
            # Nearly all of the memory; and there is more to come, so that it stays taken.
            connection.sendall(
                b"POST /v1/robots/panda/fk HTTP/1.1\r\nHost: x\r\nContent-Type: application/json"
                b"\r\nContent-Length: 60000000\r\n\r\n" + PIECE * 4
            )
            until(lambda: answer().status_code == 503)
            refused = answer()
            assert (refused.status_code, refused.headers["retry-after"]) == (503, "2")
            small = httpx.post(server.address + FK, json={"q": [0] * 7}, timeout=PATIENCE)
            assert small.status_code == 200
        until(lambda: answer().status_code == 200)
