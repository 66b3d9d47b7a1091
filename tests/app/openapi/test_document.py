"""The OpenAPI document is true: its examples run, answers fit; the docs are offline."""

import re

import jsonschema
import pytest


@pytest.fixture(scope="module")
def document(client):
    return client.get("/openapi.json").json()


def resolved(document, schema):
    return {**schema, "components": document["components"]}


def operations(document):
    for path, item in document["paths"].items():
        for method, operation in item.items():
            yield path, method, operation


def filled(path, operation):
    for parameter in operation.get("parameters", []):
        if parameter["in"] == "path":
            path = path.replace(f"{{{parameter['name']}}}", parameter.get("example", "pa10"))
    return path


def test_every_example_runs_as_it_stands_and_fits_its_schema(client, document):
    ran = 0
    for path, method, operation in operations(document):
        if not path.startswith("/v1") or path.endswith("/meshes/{name}"):
            continue  # test_meshes.py reads each file that a robot has
        url = filled(path, operation)
        query = {
            p["name"]: p["example"]
            for p in operation.get("parameters", [])
            if p["in"] == "query" and "example" in p
        }
        body = operation.get("requestBody", {}).get("content", {}).get("application/json", {})
        if method == "get":
            answer = client.get(url, params=query)
        elif "example" in body:
            jsonschema.validate(body["example"], resolved(document, body["schema"]))
            if method == "put":
                url = f"/v1/robots/{body['example']['name']}"
            answer = client.request(method, url, json=body["example"])
        else:
            continue
        if path == "/v1/robots" and method == "post":
            client.delete(answer.headers["location"])
        assert answer.status_code in (200, 201), (method, path, answer.text)
        content = operation["responses"][str(answer.status_code)].get("content", {})
        if "schema" in content.get("application/json", {}):
            schema = content["application/json"]["schema"]
            jsonschema.validate(answer.json(), resolved(document, schema))
            ran += 1
    assert ran >= 15


def test_batch_answers_fit_their_schemas(client, document):
    for name, extra in (("fk", {"euler": "ZXZ"}), ("jacobian", {}), ("singularity", {})):
        operation = document["paths"][f"/v1/robots/{{robot_id}}/{name}"]["post"]
        schema = operation["responses"]["200"]["content"]["application/json"]["schema"]
        body = {"q": [[0.1] * 7, [0.2] * 7], **extra}
        answer = client.post(f"/v1/robots/pa10/{name}", json=body).json()
        jsonschema.validate(answer, resolved(document, schema))


def test_paths_with_everything_fit_their_schemas(client, document):
    body = {
        "q": [0, -0.5, 0, -2, 0, 1.6, 0.8, 0],
        "target": {"position": [0.4, 0.2, 0.5]},
        "task": "position",
        "samples": 11,
        "link_geometry": "urdf",
        "link_radius": 0.05,
        "obstacles": [{"type": "half_space", "normal": [0, 0, 1]}],
        "retime": {"acceleration": 5},
    }
    for name in ("path", "path/compare"):
        operation = document["paths"][f"/v1/robots/{{robot_id}}/{name}"]["post"]
        content = operation["requestBody"]["content"]["application/json"]
        jsonschema.validate(body, resolved(document, content["schema"]))
        answer = client.post(f"/v1/robots/panda_urdf/{name}", json=body).json()
        schema = operation["responses"]["200"]["content"]["application/json"]["schema"]
        jsonschema.validate(answer, resolved(document, schema))
        assert answer["links"]
        assert answer["warnings"]
        assert "501" in operation["responses"]


@pytest.mark.scene
def test_every_reference_resolves(document):
    names = set(document["components"]["schemas"])
    used = set(re.findall(r"#/components/schemas/(\w+)", str(document)))
    assert used <= names


def test_problems_fit_their_schema(client, document):
    schema = resolved(document, {"$ref": "#/components/schemas/ProblemDetails"})
    jsonschema.validate(client.get("/v1/robots/none").json(), schema)


@pytest.mark.scene
def test_docs_need_no_other_host(client):
    page = client.get("/docs").text
    sources = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert sources
    for source in sources:
        assert source.startswith("/"), source
        assert client.get(source).status_code == 200
