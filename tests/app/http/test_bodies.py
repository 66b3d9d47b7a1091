"""Bodies that do not say how long they are."""

from tests.app.http.requests import FK, JSON, check


def test_a_body_without_a_declared_length_is_bounded(client):
    def parts(count):
        for _ in range(count):
            yield b" " * 65536

    headers = JSON
    check(client.put("/v1/robots/probe", content=parts(40), headers=headers), 413, "", "larger")
    check(client.post(FK, content=parts(3), headers=headers), 400, "", "empty")
