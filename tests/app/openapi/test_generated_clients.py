"""Clients that are generated from the OpenAPI document: without a warning, with typed numbers."""

import json
import subprocess
import sys
import venv
from pathlib import Path

import pytest
from openapi_spec_validator import validate

import hatch_build
from tests.app.openapi.typescript import PAGE, generate, schemas_of

ROOT = Path(__file__).parents[3]
CONFIG = ROOT / "docs" / "openapi-python-client.yaml"
CALLS = """
import sys
from arm_client import Client
from arm_client.api.compute import fk, ik
from arm_client.models import FKAnswer, FKRequest, IKAnswer, IKRequest, Target

client = Client(sys.argv[1])
pose = fk.sync("planar_2r", client=client, body=FKRequest(q=[0.0, 0.0]))
assert isinstance(pose, FKAnswer), pose
matrix = pose.poses["tool"].matrix
assert (type(matrix[0][3]), matrix[0][3]) == (float, 1.8), matrix
wanted = IKRequest(target=Target(position=[1.8, 0.0]), task="xy")
answer = ik.sync("planar_2r", client=client, body=wanted)
assert isinstance(answer, IKAnswer), answer
assert answer.status == "converged"
assert [type(value) for value in answer.q] == [float, float], answer.q
"""
USES = """
import type { components, paths } from './schema';
type Answer<P extends keyof paths> = paths[P] extends {
  post: { responses: { 200: { content: { 'application/json': infer A } } } };
} ? A : never;
declare const pose: components['schemas']['FKAnswer'];
declare const poses: components['schemas']['FKAnswerBatch'];
declare const solved: Answer<'/v1/robots/{robot_id}/ik'>;
export const x: number | undefined = pose.poses['tool']?.matrix[0]?.[3];
export const xs: number | undefined = poses.poses['tool']?.matrix[0]?.[0]?.[3];
export const q: number[] | number[][] = solved.q;
export const status: string | string[] = solved.status;
"""


def arrays_without_items(node, place=""):
    """Places of arrays of which the document does not say what they hold."""
    if isinstance(node, dict):
        if node.get("type") == "array" and "items" not in node:
            yield place
        for key, value in node.items():
            yield from arrays_without_items(value, f"{place}/{key}")
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from arrays_without_items(value, f"{place}/{index}")


@pytest.fixture(scope="module")
def document(client):
    return client.get("/openapi.json").json()


def test_the_document_is_valid_and_says_what_its_arrays_hold(document):
    validate(document)
    assert not list(arrays_without_items(document))


def test_one_and_many_are_types_of_their_own(document):
    content = document["paths"]["/v1/robots/{robot_id}/fk"]["post"]["responses"]["200"]["content"]
    named = [
        one["$ref"].rpartition("/")[2] for one in content["application/json"]["schema"]["oneOf"]
    ]
    assert named == ["FKAnswer", "FKAnswerBatch"]
    schemas = document["components"]["schemas"]
    assert schemas["PoseView"]["properties"]["position"]["items"] == {"type": "number"}
    many = schemas["PoseViewBatch"]["properties"]["position"]["items"]
    assert (many["minItems"], many["items"]) == (3, {"type": "number"})


@pytest.mark.slow
def test_a_python_client_returns_typed_numbers(document, server, tmp_path):
    (tmp_path / "openapi.json").write_text(json.dumps(document))
    venv.create(tmp_path / "venv")
    python = tmp_path / "venv" / "bin" / "python"
    uv = Path(sys.executable).parent / "uv"
    packages = ("openapi-python-client==0.29.0", "attrs", "httpx", "python-dateutil")
    subprocess.run([uv, "pip", "install", "-q", "--python", python, *packages], check=True)
    command = [python.with_name("openapi-python-client"), "generate", "--path", "openapi.json"]
    options = ["--config", CONFIG, "--meta", "none", "--output-path", "arm_client"]
    made = subprocess.run(
        [*command, *options],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
        stdin=subprocess.DEVNULL,
    )
    assert "arning" not in made.stdout + made.stderr
    done = subprocess.run(
        [python, "-c", CALLS, server], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_typescript_types_hold_numbers(document, tmp_path):
    (tmp_path / "use.ts").write_text(USES)
    generate(document, tmp_path)
    hatch_build.run_npm(tmp_path, "run", "--silent", "check")


@pytest.mark.slow
def test_the_page_has_the_types_of_the_document(document, tmp_path):
    written = generate(schemas_of(document), tmp_path)
    assert PAGE.read_text() == written, "run: make api-types"
