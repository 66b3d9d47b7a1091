"""A new computation is one module: its three forms, document, errors and example follow."""

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, TypedDict

import httpx
import jsonschema
import msgspec
import numpy as np
import pytest
import uvicorn

from app.fields.field import LEFT_OUT
from app.fields.joints import Configuration
from app.fields.names import Frame, TaskSpace
from app.fields.numbers import within_query
from app.main import create_app
from app.operations import OPERATIONS, Answer, Context, Operation
from app.operations.shapes import AnswerUnits, EachNumber
from app.operations.sizes import rows_need, rows_of
from app.settings import Settings
from kinematics.forward import fk
from kinematics.task import POSE
from robots.robot import Robot
from tests.conftest import until, unused_port


class ReachRequest(msgspec.Struct, kw_only=True):
    """How far a frame is from the base."""

    q: Configuration
    frame: Frame = LEFT_OUT
    task: TaskSpace = POSE
    factor: Annotated[float, within_query(0, 10, "Multiplies the distance.", "A factor.")] = 1.0


class ReachAnswer(TypedDict):
    """The distance, m."""

    units: AnswerUnits
    reach: EachNumber
    frame: str
    task: str
    warnings: list[str]


def reach(robot: Robot, request: ReachRequest, context: Context) -> Answer:
    pose = fk(robot, request.q, [request.frame])[request.frame]
    distance = request.factor * np.linalg.norm(pose[..., :3, 3], axis=-1)
    answer: ReachAnswer = {
        "units": context.units.named,
        "reach": distance,
        "frame": request.frame,
        "task": request.task.name,
        "warnings": context.warnings,
    }
    return Answer(answer, np.asarray(distance))


REACH = Operation(
    name="reach",
    summary="Distance from the base",
    description="How far a frame is from the base, m. As npy: shape () or (n,).",
    request=ReachRequest,
    answer=ReachAnswer,
    run=reach,
    memory=lambda robot, request, context: rows_need(
        rows_of(request.q), 200.0, context.form, numbers=1
    ),
    example={"q": [0.5, 0.25], "task": "xy"},
    example_robot="planar_2r",
    npy_field="q",
)
STORED = "/v1/robots/planar_2r/reach"


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    folder: Path = tmp_path_factory.mktemp("data")
    app = create_app(Settings(data_dir=folder, preload=False), (*OPERATIONS, REACH))
    server = uvicorn.Server(uvicorn.Config(app, port=unused_port(), log_level="error"))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        until(lambda: server.started)
        with httpx.Client(base_url=f"http://127.0.0.1:{server.config.port}") as client:
            yield client
    finally:
        server.should_exit = True
        thread.join()


def expected(q: list[float]) -> float:
    """Of the two links, 1 m and 0.8 m long."""
    return float(np.sqrt(1 + 0.8**2 + 2 * 0.8 * np.cos(q[1])))


def test_three_forms_give_the_same_answer(client):
    stored = client.post(STORED, json=REACH.example)
    from_query = client.get(f"{STORED}?q=0.5,0.25&task=xy")
    inline = client.post("/v1/reach", json={"robot": "planar_2r", **REACH.example})
    assert stored.json() == from_query.json() == inline.json()
    assert stored.json()["reach"] == pytest.approx(expected([0.5, 0.25]), abs=1e-12)
    assert (stored.json()["task"], stored.json()["frame"]) == ("xy", "tool")


def test_units_text_and_batches_come_with_it(client):
    degrees = client.get(f"{STORED}?q=90,90&angle=deg").json()
    assert degrees["reach"] == pytest.approx(np.hypot(1, 0.8), abs=1e-12)
    assert degrees["units"]["angle"] == "deg"
    assert "reach: 1.8" in client.get(f"{STORED}?q=0,0&format=text").text
    batch = client.post(STORED, json={"q": [[0, 0], [0, "x"]]})
    assert batch.status_code == 422
    assert batch.json()["errors"][0]["pointer"] == "/q/1/1"
    assert client.post(STORED, json={"q": [[0, 0], [0, 0]]}).json()["reach"] == [1.8, 1.8]


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({}, "/q"),
        ({"q": [0]}, "/q"),
        ({"q": [0, 0], "frame": "nowhere"}, "/frame"),
        ({"q": [0, 0], "task": "sideways"}, "/task"),
        ({"q": [0, 0], "factor": "two"}, "/factor"),
        ({"q": [0, 0], "factory": 2}, "/factory"),
    ],
)
def test_errors_name_the_field(client, body, pointer):
    answer = client.post(STORED, json=body)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == pointer
    inline = client.post("/v1/reach", json={"robot": "planar_2r", **body})
    assert inline.json()["errors"][0]["pointer"] == pointer


def test_unknown_parameters_of_a_query_are_refused_with_the_known_ones(client):
    answer = client.get(f"{STORED}?q=0,0&factr=2")
    assert answer.status_code == 422
    assert "did you mean factor" in answer.json()["detail"]


PLACED = ("xyz", "rpy", "quaternion_xyzw", "matrix")
"""How a placement is given in a query."""


def test_it_is_documented_with_its_example(client):
    document = client.get("/openapi.json").json()
    stored = document["paths"]["/v1/robots/{robot_id}/reach"]
    assert "/v1/reach" in document["paths"]
    names = [one["name"] for one in stored["get"]["parameters"]]
    assert names[:5] == ["robot_id", "q", "frame", "task", "factor"]
    of_the_robot = [f"{one}_{form}" for one in ("base", "tool") for form in PLACED]
    assert names[5:-5] == [*of_the_robot, "limits"]
    assert names[-5:] == ["angle", "format", "lang", "digits", "length"]
    schemas = {"components": document["components"]}
    content = stored["post"]["requestBody"]["content"]["application/json"]
    jsonschema.validate(content["example"], {**content["schema"], **schemas})
    factor = document["components"]["schemas"]["ReachRequest"]["properties"]["factor"]
    assert (factor["minimum"], factor["maximum"], factor["default"]) == (0, 10, 1.0)
    answer = stored["post"]["responses"]["200"]["content"]["application/json"]["schema"]
    for q in ([0, 0], [[0, 0], [0, 1]]):
        given = client.post(STORED, json={"q": q}).json()
        jsonschema.validate(given, {**answer, **schemas})
    assert {one["$ref"].rpartition("/")[2] for one in answer["oneOf"]} == {
        "ReachAnswer",
        "ReachAnswerBatch",
    }
