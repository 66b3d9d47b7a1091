"""What the OpenAPI document says of computations, from their declared fields."""

from __future__ import annotations

import re
from typing import Any

from app.http.negotiation import FORMATS, JSON, NPY, PNG
from app.http.query import DECIMAL_TEXT, LANG_TEXT, ORIENTATIONS
from app.openapi.answers import REF, answer_schema
from app.openapi.problems import PROBLEMS
from app.operations.operation import Operation, Runs
from dh_to_urdf.languages import codes

ROBOT_ID = "^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$"


def operation_paths(operation: Operation, schemas: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the path items of a computation.

    Args:
        operation: The computation.
        schemas: The component schemas of all answers.
    """
    name = re.sub(r"[-/.]", "_", operation.name)
    answers = _answers(operation, schemas)
    choices = _choices(operation)
    robot = _robot_parameter(operation.example_robot)
    example = operation.example
    body: dict[str, Any] = {JSON: _content(operation.form.wire, example)}
    if operation.npy_field:
        body[NPY] = {"schema": {"type": "string", "format": "binary"}}
    inline = {JSON: _content(operation.form.inline, {"robot": operation.example_robot, **example})}

    def item(suffix: str, summary: str, extra: dict[str, Any]) -> dict[str, Any]:
        return {
            "tags": ["compute"],
            "operationId": f"{name}{suffix}",
            "summary": summary,
            "description": operation.description,
            **extra,
            "responses": answers,
        }

    summary = operation.summary
    return {
        f"/v1/robots/{{robot_id}}/{operation.name}": {
            "post": item(
                "",
                summary,
                {
                    "parameters": [robot, *choices],
                    "requestBody": {"required": True, "content": body},
                },
            ),
            "get": item(
                "_get",
                f"{summary}, from a query",
                {"parameters": [robot, *_query(operation), *choices]},
            ),
        },
        f"/v1/{operation.name}": {
            "post": item(
                "_inline",
                f"{summary} of a robot in the body",
                {
                    "parameters": choices,
                    "requestBody": {"required": True, "content": inline},
                },
            )
        },
    }


def _content(type_: type, example: dict[str, Any]) -> dict[str, Any]:
    return {"schema": {"$ref": REF.format(name=type_.__name__)}, "example": example}


def _choices(operation: Operation) -> list[dict[str, Any]]:
    """Return the parameters that every form has."""
    first, *forms = sorted(
        (key for key, value in FORMATS.items() if value in operation.forms),
        key=lambda key: FORMATS[key] != operation.forms[0],
    )
    shown = " or ".join([f"{first} (default)", *forms])
    told = {
        "angle": ("rad (default) or deg: joint values, Euler angles.", ["rad", "deg"]),
        "format": (f"{shown}.", [first, *forms]),
        "lang": (LANG_TEXT, list(codes())),
        "decimal": (DECIMAL_TEXT, ["point", "comma"]),
        "digits": ("Decimals of numbers in text, CSV and LaTeX, 0 to 15.", None),
        "length": ("Unit of lengths, in and out.", ["m", "mm"]),
        "orientation": ("A further way to write orientations.", list(ORIENTATIONS)),
        "with": ("status: npy holds rows with the status of each.", ["status"]),
    }
    return [_parameter(name, *told[name]) for name in operation.parameters]


def _query(operation: Operation) -> list[dict[str, Any]]:
    """Return the parameters of the GET form."""
    form = operation.form
    return [
        _parameter(
            key,
            parameter.description,
            required=name in form.required and len(form.fields[name].parameters) == 1,
            example=_example(operation, name, key),
        )
        for key, (name, parameter) in form.parameters.items()
    ]


def _example(operation: Operation, name: str, key: str) -> str | None:
    value = operation.example.get(name)
    if isinstance(value, dict):
        value = value.get(key)
    if isinstance(value, list):
        return ",".join(str(item) for item in value)
    return value if isinstance(value, str) else None


def _answers(operation: Operation, schemas: dict[str, Any]) -> dict[str, Any]:
    content = {form: {"schema": _form_schema(operation, form, schemas)} for form in operation.forms}
    in_process = operation.runs is Runs.PROCESS
    return {
        "200": {"description": "The answer.", "content": content},
        **{str(status): problem for status, problem in PROBLEMS.items()},
        **({"501": PROBLEMS["4XX"]} if in_process or operation.needs else {}),
        **({"503": PROBLEMS["4XX"]} if in_process else {}),
    }


def _form_schema(operation: Operation, form: str, schemas: dict[str, Any]) -> dict[str, Any]:
    if form == JSON:
        return answer_schema(operation.answer, schemas)
    return {"type": "string", "format": "binary"} if form in (NPY, PNG) else {"type": "string"}


def _parameter(
    name: str,
    description: str,
    choices: list[str] | None = None,
    *,
    required: bool = False,
    example: str | None = None,
) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": "string"}
    if choices:
        schema["enum"] = choices
    parameter = {
        "name": name,
        "in": "query",
        "required": required,
        "description": description,
        "schema": schema,
    }
    return parameter | ({"example": example} if example is not None else {})


def _robot_parameter(example: str) -> dict[str, Any]:
    return {
        "name": "robot_id",
        "in": "path",
        "required": True,
        "schema": {"type": "string", "pattern": ROBOT_ID},
        "example": example,
    }
