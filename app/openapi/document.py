"""The OpenAPI document: schemas from the declarations of fields and the types of answers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from app.openapi.answers import REF, answer_schemas
from app.openapi.operations import operation_paths
from app.openapi.problems import ProblemDetails
from app.openapi.table_schemas import table_schemas
from app.operations.operation import Operation


def build_openapi(
    app: FastAPI, operations: Sequence[Operation], extra_types: Iterable[Any]
) -> dict[str, Any]:
    """Return the document of an application.

    Args:
        app: The application.
        operations: Its computations.
        extra_types: Answer types of the routes that are no computations.
    """
    document = get_openapi(
        title=app.title,
        version=app.version,
        description=app.description,
        routes=app.routes,
        tags=app.openapi_tags,
    )
    answers = answer_schemas(operation.answer for operation in operations)
    for operation in operations:
        for path, item in operation_paths(operation, answers).items():
            # An address may have a GET of its own beside the computation.
            document["paths"].setdefault(path, {}).update(item)
    types: list[Any] = [ProblemDetails, *extra_types]
    for operation in operations:
        types += [operation.form.wire, operation.form.inline]
    _, components = msgspec.json.schema_components(dict.fromkeys(types), ref_template=REF)
    schemas = document.setdefault("components", {}).setdefault("schemas", {})
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)
    schemas.update(components | answers | table_schemas())
    for path in document["paths"].values():
        for operation_item in path.values():
            operation_item.get("responses", {}).pop("422", None)
            _drop_doubles(operation_item)
    return document


def _drop_doubles(operation_item: dict[str, Any]) -> None:
    """Keep the described one of parameters that FastAPI derived as well."""
    found: dict[tuple[str, str], Any] = {}
    for parameter in operation_item.get("parameters", []):
        found[(parameter["in"], parameter["name"])] = parameter
    if found:
        operation_item["parameters"] = list(found.values())
