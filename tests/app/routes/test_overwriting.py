"""A robot of somebody else is replaced only by who says so."""

import httpx
import pytest

from app.access.keys import Scope, new_key
from tests.app.access.requests import bearer
from tests.conftest import PATIENCE


def table(a, **more):
    return {"convention": "standard", "joints": [{"type": "R", "a": a, "alpha": 0, "d": 0}]} | more


@pytest.mark.scene
def test_another_robot_under_the_id_is_not_replaced_unasked(client):
    path = "/v1/robots/overwriting"
    first = client.put(path, json=table(1))
    assert first.status_code == 201
    assert client.put(path, json=table(1)).status_code == 200
    refused = client.put(path, json=table(2))
    assert refused.status_code == 428
    assert refused.json()["type"] == "/problems/unconfirmed-overwrite"
    assert "If-Match" in refused.json()["detail"]
    assert "?overwrite=true" in refused.json()["detail"]
    tag = first.headers["etag"]
    assert client.get(path).headers["etag"] == tag
    assert client.put(path, json=table(2), headers={"If-Match": '"other"'}).status_code == 412
    assert client.put(path, json=table(2), headers={"If-Match": tag}).status_code == 200
    assert client.put(path, json=table(3)).status_code == 428
    assert client.put(path, json=table(3), params={"overwrite": "true"}).status_code == 200
    assert client.put(path, json=table(4), params={"overwrite": "false"}).status_code == 428
    assert client.put(path, json=table(4), params={"overwrite": "yes"}).status_code == 422
    assert client.put(path, json=table(4), headers={"If-Match": "*"}).status_code == 200
    named = table(5, name="overwriting")
    taken = client.post("/v1/robots", json=named)
    assert taken.status_code == 409
    assert "overwrite=true" in taken.json()["detail"]
    assert client.post("/v1/robots", json=named, params={"overwrite": "true"}).status_code == 200
    assert client.delete(path).status_code == 204
    new = client.post("/v1/robots", json=named, params={"overwrite": "true"})
    assert (new.status_code, new.headers["location"]) == (201, path)
    client.delete(path)


@pytest.mark.parametrize("kind", ["text/csv", "application/xml", "text/plain", "application/yaml"])
def test_every_kind_of_document_may_overwrite(client, kind):
    path = "/v1/robots/overwriting-kinds"
    client.put(path, json=table(1), params={"overwrite": "true"})
    urdf = client.get(path + "/urdf").text
    documents = {
        "text/csv": "name,type,alpha,a,d,theta\nj1,R,0,2,0,0\n",
        "application/xml": urdf,
        "text/plain": "| i | α_i | a_i | d_i | θ_i |\n|-|-|-|-|-|\n| 1 | 0 | 2 | 0 | θ_1 |",
        "application/yaml": "convention: standard\njoints: [{type: R, a: 2, alpha: 0, d: 0}]\n",
    }
    query = {"convention": "standard"} if kind in ("text/csv", "text/plain") else {}
    query |= {"name": "overwriting-kinds"} if kind == "text/plain" else {}
    headers = {"Content-Type": kind}

    def put(more):
        return client.put(path, content=documents[kind], params=query | more, headers=headers)

    assert put({}).status_code == 428, put({}).text
    assert put({"overwrite": "true"}).status_code == 200
    client.delete(path)


def test_with_keys_the_maker_needs_to_say_nothing(serve):
    (ada, first), (bob, second) = (new_key(name, Scope.WRITE) for name in ("ada", "bob"))
    path = "/v1/robots/arm"
    with (
        serve(api_keys=f"{first.line},{second.line}") as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):

        def status(method, secret, a=None, **more):
            body = {} if a is None else {"json": table(a)}
            answer = client.request(method, path, headers=bearer(secret), **body, **more)
            return answer.status_code

        overwrite = {"params": {"overwrite": "true"}}
        assert [status("PUT", ada, a) for a in (1, 2, 3)] == [201, 200, 200]
        assert [status("PUT", bob, a) for a in (3, 4)] == [200, 428]
        assert status("DELETE", bob) == 428
        assert status("PUT", ada, 4) == 200
        assert status("PUT", bob, 5, **overwrite) == 200
        assert [status("PUT", one, 6) for one in (ada, bob)] == [428, 200]
        assert status("DELETE", ada) == 428
        assert status("DELETE", ada, **overwrite) == 204
