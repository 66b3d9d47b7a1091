"""The OpenAPI document: schemas from the very types that requests are decoded to."""

from __future__ import annotations

import re
from functools import cache
from typing import Annotated, Any

import msgspec
from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from app.http.negotiation import FORMATS, JSON, NPY, PNG
from app.openapi.table_schemas import table_schemas
from app.operations import OPERATIONS, Operation

ROBOT_ID = "^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$"
REF = "#/components/schemas/{name}"
_NUMBERS = {
    "q": (
        "Joint values, comma-separated, in the robot's order; pi/2 and 90deg are read too.",
        True,
    ),
    "qd": ("Joint velocities, comma-separated, in the robot's order.", True),
    "twist": ("vx,vy,vz,wx,wy,wz, or one value a task row.", True),
    "wrench": ("fx,fy,fz,mx,my,mz, in N and N m.", True),
    "tau": ("Joint torques and forces, comma-separated, in N m and N.", True),
    "damping": ("0 (none), or such as 0.01.", False),
    "characteristic_length": ("Length by which m/s are divided, m; default the arm's own.", False),
    "seed": ("First start, comma-separated joint values.", False),
    "frames": ("Frame names, comma-separated, or all; default the tip.", False),
    "frame": ("Frame name; default the tip.", False),
    "joints": ("Names of two joints, comma-separated.", True),
    "view": ("auto (default), iso, xy, xz or yz.", False),
    "labels": ("true (default) or false: names of the axes.", False),
    "width": ("Pixels, 200 to 2000; default 640.", False),
    "height": ("Pixels, 200 to 2000; default 480.", False),
    "euler": ("Euler sequence such as ZXZ; for ik with angles: ZXZ:10,20,30.", False),
    "reference_frame": ("local_world_aligned, world or local.", False),
    "task": ("Task space by name, or six 0 or 1.", False),
    "tolerance": ("singularity: relative tolerance of the rank; ik: m and rad.", False),
    "position": ("Target x,y,z in m.", False),
    "rpy": ("Target roll,pitch,yaw.", False),
    "quaternion_xyzw": ("Target quaternion x,y,z,w.", False),
    "phi": ("Target angle about z.", False),
    "direction": ("Target direction of the frame's z axis, x,y,z.", False),
    "matrix": ("Target matrix, 16 numbers row by row.", False),
    "max_restarts": ("Random starts after the seed.", False),
    "random_seed": ("Seed of the random starts.", False),
    "time_budget_ms": ("Milliseconds.", False),
    "choose": ("closest, most_manipulable or farthest_from_limits.", False),
    "max_iterations": ("Steps of one start.", False),
    "quantities": ("Comma-separated: A, T0, T, position, rotation, jacobian, det_jacobian.", False),
    "parameters": ("numeric (default) or symbolic: names instead of lengths.", False),
    "symbols": ("Names of lengths: a2:L1,a3:L2.", False),
    "base": ("base_link (default) or frame_0.", False),
    "expressed_in": ("Frame in whose axes the Jacobian is written.", False),
    "delta_x": ("Wanted motion, comma-separated, one value a task row.", True),
    "z": ("Wanted joint motion, of which the part in the null space is added.", False),
    "method": ("Name of a method, such as qp.", False),
    "methods": ("Names of methods, comma-separated.", False),
    "time_law": ("linear, cubic, quintic or trapezoidal.", False),
    "tf": ("Duration, s.", False),
    "samples": ("Number of samples, the start included.", False),
}


class ProblemItem(msgspec.Struct, kw_only=True):
    """One thing wrong with a request."""

    pointer: str
    message: str


class ProblemDetails(msgspec.Struct, kw_only=True):
    """RFC 9457 problem document."""

    type: str
    title: str
    status: int
    detail: str
    errors: list[ProblemItem]
    request_id: str


def inline_request_type(operation: Operation) -> type[msgspec.Struct]:
    """The request of a computation with a ``robot`` besides."""
    return _inline(operation.request)


@cache
def _inline(request: type[msgspec.Struct]) -> type[msgspec.Struct]:
    robot = Annotated[
        msgspec.Raw,
        msgspec.Meta(
            description='A D-H table, {"urdf": text, "tip": …}, or the id of a stored robot.',
            extra_json_schema={
                "anyOf": [
                    {"type": "string"},
                    {"$ref": "#/components/schemas/DHTable"},
                    {"$ref": "#/components/schemas/InlineURDF"},
                ]
            },
        ),
    ]
    return msgspec.defstruct(
        f"Inline{request.__name__}",
        [("robot", robot)],
        bases=(request,),
        kw_only=True,
        forbid_unknown_fields=True,
    )


def operation_docs(operation: Operation) -> dict[str, dict[str, Any]]:
    """What the docs say of a computation's routes, by path and method."""
    name = re.sub(r"[-/.]", "_", operation.name)
    answers = _answers(operation)
    first, *forms = sorted(
        (key for key, value in FORMATS.items() if value in operation.offers),
        key=lambda key: FORMATS[key] != operation.offers[0],
    )
    choices = [
        _parameter("angle", "rad (default) or deg: joint values, Euler angles.", ["rad", "deg"]),
        _parameter("format", f"{' or '.join([f'{first} (default)', *forms])}.", [first, *forms]),
    ]
    body: dict[str, Any] = {
        JSON: {
            "schema": {"$ref": REF.format(name=operation.request.__name__)},
            "example": operation.example,
        }
    }
    if operation.array_field:
        body[NPY] = {"schema": {"type": "string", "format": "binary"}}
    inline_body = {
        JSON: {
            "schema": {"$ref": REF.format(name=inline_request_type(operation).__name__)},
            "example": {"robot": operation.example_robot, **operation.example},
        }
    }
    query = [
        _parameter(
            key, _NUMBERS[key][0], required=_NUMBERS[key][1], example=_example(operation, key)
        )
        for key in operation.query
    ]

    def item(suffix: str, summary: str, extra: dict[str, Any]) -> dict[str, Any]:
        return {
            "tags": ["compute"],
            "operationId": f"{name}{suffix}",
            "summary": summary,
            "description": operation.description,
            **extra,
            "responses": answers,
        }

    robot = _robot_parameter(operation.example_robot)
    content = {"required": True, "content": body}
    inline_content = {"required": True, "content": inline_body}
    summary = operation.summary
    stored = {
        "post": item("", summary, {"parameters": [robot, *choices], "requestBody": content}),
        "get": item("_get", f"{summary}, from a query", {"parameters": [robot, *query, *choices]}),
    }
    inline = {
        "post": item(
            "_inline",
            f"{summary} of a robot in the body",
            {"parameters": choices, "requestBody": inline_content},
        )
    }
    path = f"/v1/robots/{{robot_id}}/{operation.name}"
    return {path: stored, f"/v1/{operation.name}": inline}


def _answers(operation: Operation) -> dict[str, Any]:
    return {
        "200": {
            "description": "The answer.",
            "content": {
                form: {"schema": _form_schema(operation, form)} for form in operation.offers
            },
        },
        **{str(status): problem for status, problem in PROBLEMS.items()},
        **({"501": PROBLEMS["4XX"]} if operation.out_of_process or operation.extras else {}),
        **({"503": PROBLEMS["4XX"]} if operation.out_of_process else {}),
    }


def _form_schema(operation: Operation, form: str) -> dict[str, str]:
    if form == JSON:
        return {"$ref": REF.format(name=operation.response.__name__)}
    return {"type": "string", "format": "binary"} if form in (NPY, PNG) else {"type": "string"}


PROBLEMS: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "description": "A problem: what is wrong, where, and what to write instead.",
        "content": {
            "application/problem+json": {"schema": {"$ref": REF.format(name="ProblemDetails")}},
            # To those who ask for text: the same in lines.
            "text/plain": {"schema": {"type": "string"}},
        },
    }
}


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


def _example(operation: Operation, key: str) -> str | None:
    value = operation.example.get(key, operation.example.get("target", {}).get(key))
    if isinstance(value, list):
        return ",".join(str(item) for item in value)
    return value if isinstance(value, str) else None


def build_openapi(app: FastAPI, extra_types: tuple[Any, ...]) -> dict[str, Any]:
    """The document of an application.

    Args:
        app: The application.
        extra_types: Answer types of the routes that are no computations.
    """
    document = get_openapi(
        title=app.title, version=app.version, description=app.description, routes=app.routes,
        tags=app.openapi_tags,
    )  # fmt: skip
    for operation in OPERATIONS:
        document["paths"].update(operation_docs(operation))
    types: list[Any] = [ProblemDetails, *extra_types]
    for operation in OPERATIONS:
        types += [operation.request, operation.response, inline_request_type(operation)]
    _, components = msgspec.json.schema_components(types, ref_template=REF)
    schemas = document.setdefault("components", {}).setdefault("schemas", {})
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)
    schemas.update(components)
    schemas.update(table_schemas())
    for path in document["paths"].values():
        for operation_item in path.values():
            operation_item.get("responses", {}).pop("422", None)
            _drop_doubles(operation_item)
    return document


def _drop_doubles(operation_item: dict[str, Any]) -> None:
    """Keeps the described one of parameters that FastAPI derived as well."""
    found: dict[tuple[str, str], Any] = {}
    for parameter in operation_item.get("parameters", []):
        found[(parameter["in"], parameter["name"])] = parameter
    if found:
        operation_item["parameters"] = list(found.values())
