"""Schemas of answers: from the types that operations build, one for one q and one for a batch."""

from __future__ import annotations

from collections.abc import Iterable
from copy import deepcopy
from functools import cache
from typing import (
    Annotated,
    Any,
    NotRequired,
    Required,
    TypedDict,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

import msgspec

from app.operations.shapes import EACH, EACH_OR_NONE, SHAPE, or_null

REF = "#/components/schemas/{name}"
BATCH = "Batch"
_EACH = {EACH, EACH_OR_NONE}
_MARKS = {*_EACH, SHAPE}
_PREFIX = REF.format(name="")


def answer_schemas(answers: Iterable[type]) -> dict[str, Any]:
    """Return the component schemas of answer types, with those for batches.

    Args:
        answers: TypedDicts.
    """
    _, found = msgspec.json.schema_components([_plain(one) for one in answers], ref_template=REF)
    many = _with_samples(found)
    schemas = {name: _shaped(schema, many, batch=False) for name, schema in found.items()}
    for name in filter(many.__contains__, found):  # in the order of the types
        schema = _shaped(deepcopy(found[name]), many, batch=True)
        schemas[name + BATCH] = {**schema, "title": name + BATCH}
    return schemas


def answer_schema(answer: type, schemas: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of an answer: a reference, or a choice of that for one and for many."""
    one = {"$ref": REF.format(name=answer.__name__)}
    batch = answer.__name__ + BATCH
    return {"oneOf": [one, {"$ref": REF.format(name=batch)}]} if batch in schemas else one


def _with_samples(schemas: dict[str, Any]) -> set[str]:
    """Return the names of those that hold a value for each sample, also within others."""
    found = {name for name, schema in schemas.items() if _holds_mark(schema)}
    while True:
        more = {
            name
            for name, schema in schemas.items()
            if name not in found and _references(schema) & found
        }
        if not more:
            return found
        found |= more


def _holds_mark(schema: Any) -> bool:
    if isinstance(schema, dict):
        return bool(_EACH & set(schema)) or any(map(_holds_mark, schema.values()))
    return isinstance(schema, list) and any(map(_holds_mark, schema))


def _references(schema: Any) -> set[str]:
    if isinstance(schema, dict):
        own = {schema["$ref"].removeprefix(_PREFIX)} if "$ref" in schema else set()
        return own.union(*map(_references, schema.values()))
    return set().union(*map(_references, schema)) if isinstance(schema, list) else set()


def _shaped(schema: Any, many: set[str], *, batch: bool) -> Any:
    """Return a schema with the shapes in the places of their marks."""
    if isinstance(schema, list):
        return [_shaped(one, many, batch=batch) for one in schema]
    if not isinstance(schema, dict):
        return schema
    words = {key: schema[key] for key in ("description",) if key in schema}
    if SHAPE in schema:
        return {**words, **schema[SHAPE]}
    own = schema.get(EACH, schema.get(EACH_OR_NONE))
    if own is not None:
        one = {"type": "array", "items": own, "minItems": 1} if batch else own
        return {**words, **(or_null(one) if EACH_OR_NONE in schema else one)}
    if batch and schema.get("$ref", "").removeprefix(_PREFIX) in many:
        return {"$ref": schema["$ref"] + BATCH}
    return {key: _shaped(value, many, batch=batch) for key, value in schema.items()}


@cache
def _plain(answer: Any) -> Any:
    """Return a TypedDict in which marked values have no type of their own.

    Their marks say what JSON shows; their Python types (arrays, or lists of arrays) do not.
    """
    if not _is_marked(answer, frozenset()):
        return answer
    hints = get_type_hints(answer, include_extras=True)
    members = {
        # Not by __required_keys__: it cannot see NotRequired in annotations that are texts.
        name: NotRequired[_replaced(hint)] if get_origin(hint) is NotRequired else _replaced(hint)
        for name, hint in hints.items()
    }
    plain = TypedDict(answer.__name__, members)  # type: ignore[misc]
    plain.__doc__ = answer.__doc__
    return plain


def _is_marked(hint: Any, within: frozenset[Any]) -> bool:
    """Return whether a type holds a marked value; ``within`` are the TypedDicts around it."""
    if is_typeddict(hint):
        hints = get_type_hints(hint, include_extras=True).values()
        around = within | {hint}
        return hint not in within and any(_is_marked(one, around) for one in hints)
    metas = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
    own = any(_MARKS & set(meta.extra_json_schema or {}) for meta in metas)
    return own or any(_is_marked(one, within) for one in get_args(hint))


def _replaced(hint: Any) -> Any:
    if get_origin(hint) in (NotRequired, Required):
        return _replaced(get_args(hint)[0])
    if get_origin(hint) is Annotated:
        inner, *metas = get_args(hint)
        marked = any(_MARKS & set(meta.extra_json_schema or {}) for meta in metas)
        hint = Any if marked else _replaced(inner)
        for meta in metas:
            hint = Annotated[hint, meta]
        return hint
    if is_typeddict(hint):
        return _plain(hint)
    arguments = get_args(hint)
    if not arguments or get_origin(hint) is None:
        return hint
    inner = tuple(_replaced(one) for one in arguments)
    if inner == arguments:
        return hint
    if type(hint).__name__ == "UnionType":
        union = inner[0]
        for one in inner[1:]:
            union = union | one
        return union
    return hint.copy_with(inner) if hasattr(hint, "copy_with") else get_origin(hint)[inner]
