"""Exercises: the list, one with the numbers of a student, and the marks of answers."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec
from fastapi import APIRouter, Request, Response

from app.dependencies import ServicesDep
from app.exercises.catalogue import exercise_named
from app.exercises.drawing import drawn
from app.exercises.marking import check_names, marked
from app.exercises.sheets import catalogue_view, exercise_view, sheet
from app.exercises.texts import LANGUAGES, language_of
from app.http.bodies import read_body
from app.http.language import language_headers
from app.http.language import language_of as spoken_in
from app.http.negotiation import JSON, TEXT, require_type, wanted_type
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import check_query
from app.http.responses import respond
from app.http.strict_json import decode_body
from app.openapi.answers import REF
from app.openapi.problems import PROBLEMS
from app.operations.check import CheckDiagnosis, CheckError, check_reveal
from dh_to_urdf.messages import say

MAX_BODY = 200_000
_LANG = {
    "name": "lang",
    "in": "query",
    "description": "Language of the texts; default by Accept-Language.",
    "schema": {"enum": list(LANGUAGES)},
}
_NAME = {
    "name": "name",
    "in": "path",
    "required": True,
    "description": "Name of the exercise.",
    "schema": {"type": "string"},
    "example": "planar-2r",
}
_SEED = {
    "name": "seed",
    "in": "query",
    "required": True,
    "description": "What the numbers are drawn from, such as a student's number.",
    "schema": {"type": "string", "minLength": 1, "maxLength": 128},
    "example": "20261234",
}


class ExerciseLine(msgspec.Struct, kw_only=True):
    """One exercise."""

    name: str
    title: str
    parts: list[str]
    marks: float


class ExerciseList(msgspec.Struct, kw_only=True):
    """All exercises."""

    exercises: list[ExerciseLine]


class ExercisePart(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One question: what to give, in which form. The named fields are those of ``check``."""

    name: str
    text: str
    quantity: str
    form: str
    marks: float
    index: int | None = None
    frame: str | None = None
    reference_frame: str | None = None
    task: str | None = None
    euler: str | None = None
    convention: str | None = None
    target: dict[str, Any] | None = None


class ExerciseView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An exercise with the numbers of one student; degrees and m."""

    name: str
    seed: str
    title: str
    text: str
    units: dict[str, str]
    robot: dict[str, Any]
    lengths: dict[str, float]
    parts: list[ExercisePart]
    marks: float
    send: str
    q: list[float] | None = None
    delta_x: list[float] | None = None
    z: list[float] | None = None


class ExerciseAnswers(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """The answers of one student, by name of the part; ``answer`` where there is one part only."""

    seed: Annotated[str, msgspec.Meta(extra_json_schema={"minLength": 1, "maxLength": 128})]
    answers: dict[str, Any] = {}
    answer: Any = None
    reveal: bool = False


class MarkedPart(msgspec.Struct, kw_only=True):
    """What was found of one answer, as ``check`` tells it, and its marks."""

    name: str
    marks: float
    out_of: float
    correct: bool
    largest_error: float | None
    errors: list[CheckError]
    diagnosis: list[CheckDiagnosis]
    note: str
    expected: Any = None


class Marks(msgspec.Struct, kw_only=True):
    """The marks of one student."""

    name: str
    seed: str
    marks: float
    out_of: float
    parts: list[MarkedPart]


TYPES = (ExerciseList, ExerciseView, ExerciseAnswers, Marks)
"""Types that the OpenAPI document describes."""


def _described(name: str) -> dict[int | str, dict[str, Any]]:
    return {
        200: {
            "description": "OK",
            "content": {
                JSON: {"schema": {"$ref": REF.format(name=name)}},
                TEXT: {"schema": {"type": "string"}},
            },
        }
    }


router = APIRouter(prefix="/v1/exercises", tags=["exercises"], responses=PROBLEMS)


@router.get(
    "",
    summary="Exercises",
    responses=_described("ExerciseList"),
    openapi_extra={"parameters": [_LANG]},
)
async def list_exercises(request: Request) -> Response:
    """Each with its parts and what they are worth."""
    check_query(request, common=("format", "lang"))
    wanted = wanted_type(request, JSON, TEXT)
    found = {"exercises": catalogue_view(language_of(request))}
    return respond(found, wanted, spoken_in(request))


@router.get(
    "/{name}",
    summary="An exercise with numbers of one's own",
    responses=_described("ExerciseView"),
    openapi_extra={"parameters": [_NAME, _SEED, _LANG]},
)
async def read_exercise(name: str, request: Request, services: ServicesDep) -> Response:
    """Each seed draws other lengths and poses; the same seed always the same. Text is a sheet."""
    check_query(request, "seed", common=("format", "lang"))
    wanted, language = wanted_type(request, JSON, TEXT), language_of(request)
    spoken = spoken_in(request)
    exercise_named(name)
    seed = request.query_params.get("seed")
    if seed is None:
        raise RequestProblem(
            INVALID_REQUEST, say("seed is missing; give a student's number or name"), "/seed"
        )
    address = str(request.base_url)

    def answer() -> Response:
        found = drawn(name, seed)
        if wanted == TEXT:
            content = sheet(found, language, address)
            headers = language_headers(spoken)
            return Response(content, headers=headers, media_type="text/plain; charset=utf-8")
        return respond(exercise_view(found, language, address), wanted, spoken)

    return await services.computed(answer, request)


@router.post(
    "/{name}/check",
    summary="Mark the answers of an exercise",
    responses=_described("Marks"),
    openapi_extra={
        "parameters": [_NAME],
        "requestBody": {
            "required": True,
            "content": {
                JSON: {
                    "schema": {"$ref": REF.format(name="ExerciseAnswers")},
                    "example": {"seed": "20261234", "answers": {"determinant": "L1*L2*S2"}},
                }
            },
        },
    },
)
async def check_exercise(name: str, request: Request, services: ServicesDep) -> Response:
    """Part by part, as `check` does it. An answer that cannot be read is wrong, with the reason."""
    check_query(request, common=("format", "lang"))
    require_type(request, JSON)
    wanted = wanted_type(request, JSON, TEXT)
    declaration = exercise_named(name)
    asked = decode_body(await read_body(request, MAX_BODY), ExerciseAnswers)
    check_reveal(asked.reveal, services.settings)
    answers = dict(asked.answers)
    if asked.answer is not None:
        if answers or len(declaration.parts) > 1:
            names = ", ".join(part.name for part in declaration.parts)
            raise RequestProblem(
                INVALID_REQUEST,
                say("give answers by name of their part: {names}", names=names),
                "/answers",
            )
        answers[declaration.parts[0].name] = asked.answer

    def answer() -> Response:
        found = drawn(name, asked.seed)
        check_names(found, answers)
        return respond(marked(found, answers, reveal=asked.reveal), wanted, spoken_in(request))

    return await services.computed(answer, request)
