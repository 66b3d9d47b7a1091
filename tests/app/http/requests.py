"""Requests to one robot, and what a refusal of them must be."""

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
