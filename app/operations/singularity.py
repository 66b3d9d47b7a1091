"""singularity: rank, lost directions, null motions, ellipsoids, dexterity and named factors."""

from __future__ import annotations

from typing import Annotated, Any, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields import texts
from app.fields.field import LEFT_OUT
from app.fields.joints import Configuration
from app.fields.lengths import LENGTH
from app.fields.names import Frame, TaskSpace
from app.fields.numbers import RankTolerance, within_query
from app.operations.operation import (
    SHEET_FORMS,
    Answer,
    Context,
    Operation,
    check_size,
    is_light,
)
from app.operations.shapes import (
    FLAG,
    NUMBER,
    TEXT,
    AnswerUnits,
    EachFlag,
    EachInteger,
    EachMatrix,
    EachNumber,
    EachNumberOrNull,
    EachVector,
    each,
    each_or_none,
    listed,
    or_null,
)
from app.operations.sizes import WORDS, encoded, rows_need, rows_of
from app.sheets import columns
from app.sheets.headings import Heading, numbered
from app.sheets.sheet import Column, Sheet
from kinematics.chain import chain_of
from kinematics.configuration import joint_names
from kinematics.deadline import checked
from kinematics.dexterity import characteristic_length, dexterity
from kinematics.ellipsoids import Ellipsoid, ellipsoids
from kinematics.explanation import lost_direction_in_words, null_motion_in_words
from kinematics.jacobian import jacobian, task_jacobian
from kinematics.jacobian import peak_bytes as jacobian_bytes
from kinematics.named_singularities import Factorization, factorization, is_prepared
from kinematics.singularity import RANK_TOLERANCE, SingularityReport, report_on
from kinematics.singularity import peak_bytes as report_bytes
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot


class SingularityRequest(msgspec.Struct, kw_only=True):
    """Where to look, and in which task space."""

    q: Configuration
    task: TaskSpace = POSE
    frame: Frame = LEFT_OUT
    tolerance: RankTolerance = RANK_TOLERANCE
    characteristic_length: Annotated[
        float | None,
        within_query(
            1e-6,
            1e6,
            "Length by which linear rows are divided in `dexterity`, m; default the root mean"
            " square distance of the frame from the turning axes over all postures.",
            "Length by which m/s are divided, m; default the arm's own.",
            texts.length,
        ),
        LENGTH,
    ] = None


class EllipsoidView(TypedDict):
    """Ellipsoids of velocity and of force: the same axes, reciprocal semi-axes.

    ``axes``: unit vectors in base axes, one a row. ``velocity_semi_axes``: for unit joint
    velocities, m/s or rad/s. ``force_semi_axes``: for unit joint torques, N or N m; null where the
    structure carries any force.
    """

    axes: EachMatrix
    velocity_semi_axes: EachVector
    force_semi_axes: Annotated[Any, each(listed(or_null(NUMBER)))]


class EllipsoidsView(TypedDict):
    """Translation and rotation apart, so that m and rad do not mix; null without such rows."""

    translation: EllipsoidView | None
    rotation: EllipsoidView | None


class DexterityView(TypedDict):
    """Of the homogeneous Jacobian: linear rows over, sliding columns times a characteristic length.

    ``chosen``: ``given``, or ``mean_lever``: the root mean square distance of the frame from the
    turning axes over full turns of all joints, which is the same at every q.
    """

    characteristic_length: float
    chosen: str
    condition_number: EachNumberOrNull
    isotropy: EachNumber


class FactorView(TypedDict):
    """One named factor; ``normalised`` is its value over its bound, -1 to 1."""

    name: str
    value: EachNumber
    normalised: EachNumber
    unit: str
    vanishes: EachFlag
    joints: list[str]
    vanishes_where: str


class FactorizationView(TypedDict):
    """``determinant`` (columns from base to frame) or ``manipulability`` = constant x factors.

    ``difference`` is measured against the model; ``exact`` where it is rounding. Where no
    structure is known, ``reason`` says so.
    """

    structure: str | None
    reason: str | None
    of: str | None
    constant: Annotated[float | FloatArray | None, each_or_none(NUMBER)]
    product: Annotated[float | FloatArray | None, each_or_none(NUMBER)]
    difference: Annotated[float | FloatArray | None, each_or_none(NUMBER)]
    exact: Annotated[bool | list[bool] | None, each_or_none(FLAG)]
    factors: list[FactorView]


class _Report(TypedDict):
    """What the singular values say, for each q."""

    rank: EachInteger
    singular_values: EachVector
    condition_number: EachNumberOrNull
    manipulability: EachNumber
    lost_directions: EachMatrix
    null_motions: EachMatrix
    singular: EachFlag


class SingularityAnswer(_Report):
    """The report; for a batch every leaf has a leading axis n."""

    units: AnswerUnits
    task: str
    rows: list[str]
    columns: list[str]
    frame: str
    tolerance: float
    explanation: Annotated[list[str] | list[list[str]], each(listed(TEXT))]
    factorization: FactorizationView
    ellipsoids: EllipsoidsView
    dexterity: DexterityView
    warnings: list[str]


_MAX_WORDS = 8
QUICK_DOF = 8
"""Joints up to which one q takes well below a millisecond; of more, others would wait too long."""


def _memory(robot: Robot, request: SingularityRequest, context: Context) -> Need:
    dof = robot.dof
    each = float(report_bytes(dof)) + jacobian_bytes(dof, 4) + WORDS * min(dof, _MAX_WORDS)
    each += encoded(context.form, dof**2 + 70, 6)
    return rows_need(rows_of(request.q), each, context.form, numbers=6 * dof + dof**2)


def _run(robot: Robot, request: SingularityRequest, context: Context) -> Answer:
    task = request.task
    frame = request.frame
    q = request.q
    check_size(q, 6 * robot.dof + robot.dof**2)
    full = jacobian(robot, q, frame)
    J = full if task is POSE else task_jacobian(robot, q, task, frame)
    every = J if q.ndim == 2 else [J]
    batch = [report_on(one, robot, task, request.tolerance) for one in checked(every)]
    first = batch[0]
    named = factorization(robot, q, task, frame, request.tolerance)
    words = [
        _in_words(robot, task, one, of_task, report)
        for one, of_task, report in checked(
            zip(full if q.ndim == 2 else [full], every, batch, strict=True)
        )
    ]
    translation, rotation = ellipsoids(J, task, request.tolerance)
    answer: SingularityAnswer = {
        "units": {"angle": "rad", "length": "m"},
        "task": task.name,
        "rows": list(task.row_names),
        "columns": list(joint_names(robot)),
        "frame": frame,
        **_report(batch, many=q.ndim == 2),
        "tolerance": first.tolerance,
        "explanation": words if q.ndim == 2 else words[0],
        "factorization": _factorization_view(robot, frame, named),
        "ellipsoids": {
            "translation": _ellipsoid_view(translation),
            "rotation": _ellipsoid_view(rotation),
        },
        "dexterity": _dexterity_view(robot, J, task, frame, request),
        "warnings": [*context.warnings, *first.warnings],
    }
    values = np.array([report.singular_values for report in batch])
    return Answer(
        answer,
        values if q.ndim == 2 else values[0],
        sheet=lambda: _sheet(robot, np.atleast_2d(q), batch, named, answer, context),
    )


def _attempt(robot: Robot, request: SingularityRequest, context: Context) -> Answer | None:
    """Return the answer for one q of an arm of known structure: some tenths of a millisecond."""
    if not is_light(robot, request) or robot.dof > QUICK_DOF:
        return None
    if not is_prepared(robot, request.task, request.frame):
        return None
    return _run(robot, request, context)


def _sheet(
    robot: Robot,
    q: FloatArray,
    batch: list[SingularityReport],
    named: Factorization,
    answer: SingularityAnswer,
    context: Context,
) -> Sheet:
    """Return one row a q: the measures, and the factors of the determinant where there are some."""
    sigma = np.array([report.singular_values for report in batch])
    isotropy = np.atleast_1d(np.asarray(answer["dexterity"]["isotropy"], np.float64))
    found = [
        columns.samples(len(q)),
        *columns.joints(robot, q, context.units),
        Column(Heading.RANK, [report.rank for report in batch]),
        Column(Heading.SINGULAR, [report.singular for report in batch]),
        Column(Heading.MANIPULABILITY, [report.manipulability for report in batch]),
        Column(Heading.CONDITION_NUMBER, [report.condition_number for report in batch]),
        *(Column(numbered(Heading.SINGULAR_VALUE, k + 1), one) for k, one in enumerate(sigma.T)),
        Column(Heading.ISOTROPY, isotropy),
    ]
    if named.structure is None:
        return Sheet(tuple(found))
    if named.of == "determinant":
        found.append(Column(Heading.DETERMINANT, np.broadcast_to(named.product, len(q))))
    for factor in named.factors:
        value = np.broadcast_to(factor.value, len(q))
        unit = "" if factor.unit == "1" else factor.unit
        found.append(Column(numbered(Heading.FACTOR, factor.name), value, unit))
    return Sheet(tuple(found))


def _in_words(
    robot: Robot, task: Task, full: FloatArray, J: FloatArray, report: SingularityReport
) -> list[str]:
    return [
        *(lost_direction_in_words(task, one, J) for one in report.lost_directions),
        *(null_motion_in_words(robot, one, full, J) for one in report.null_motions[:_MAX_WORDS]),
    ]


def _factorization_view(robot: Robot, frame: str, named: Factorization) -> FactorizationView:
    if named.structure is None:
        return {
            "structure": None,
            "reason": named.reason,
            "of": None,
            "constant": None,
            "product": None,
            "difference": None,
            "exact": None,
            "factors": [],
        }
    columns = chain_of(robot, frame).columns
    return {
        "structure": named.structure,
        "reason": None,
        "of": named.of,
        "constant": named.constant,
        "product": named.product + 0.0,
        "difference": named.difference,
        "exact": named.exact.tolist(),
        "factors": [
            {
                "name": factor.name,
                "value": factor.value,
                "normalised": factor.normalised,
                "unit": factor.unit,
                "vanishes": factor.vanishes.tolist(),
                "joints": [robot.joints[columns[k]].name for k in factor.joints],
                "vanishes_where": factor.vanishes_where,
            }
            for factor in named.factors
        ],
    }


def _ellipsoid_view(ellipsoid: Ellipsoid | None) -> EllipsoidView | None:
    if ellipsoid is None:
        return None
    return {
        "axes": ellipsoid.axes,
        "velocity_semi_axes": ellipsoid.velocity,
        "force_semi_axes": finite_or_null(ellipsoid.force),
    }


def _dexterity_view(
    robot: Robot, J: FloatArray, task: Task, frame: str, request: SingularityRequest
) -> DexterityView:
    given = request.characteristic_length
    length = characteristic_length(robot, frame) if given is None else given
    found = dexterity(J, robot.is_revolute, task, length, request.tolerance)
    return {
        "characteristic_length": length,
        "chosen": "mean_lever" if given is None else "given",
        "condition_number": finite_or_null(found.condition_number),
        "isotropy": found.isotropy.tolist(),
    }


def finite_or_null(values: FloatArray) -> Any:
    """Nested lists of an array, with null for what is infinite; the array where nothing is."""
    if np.isfinite(values).all():
        return values if values.ndim else float(values)
    nulls = values.astype(object)
    nulls[~np.isfinite(values)] = None
    return nulls.tolist()


def _report(batch: list[SingularityReport], *, many: bool) -> _Report:
    if not many:
        one = batch[0]
        return {
            "rank": one.rank,
            "singular_values": one.singular_values,
            "condition_number": one.condition_number,
            "manipulability": one.manipulability,
            "lost_directions": one.lost_directions,
            "null_motions": one.null_motions,
            "singular": one.singular,
        }
    return {
        "rank": [one.rank for one in batch],
        "singular_values": [one.singular_values for one in batch],
        "condition_number": [one.condition_number for one in batch],
        "manipulability": [one.manipulability for one in batch],
        "lost_directions": [one.lost_directions for one in batch],
        "null_motions": [one.null_motions for one in batch],
        "singular": [one.singular for one in batch],
    }


SINGULARITY = Operation(
    name="singularity",
    summary="Singularity report",
    description="Rank, singular values, condition number (null where infinite), manipulability,"
    " task directions that are lost and joint motions that do nothing, also in words; of arms of"
    " known structure the named factors of the determinant (shoulder, elbow, wrist), checked on"
    " the model; manipulability ellipsoids of translation and of rotation, and `dexterity`, which"
    " does not mix m and rad. Choose a task that fits the arm: a planar arm is only seen as"
    " singular in `xy` or `xy_phi`. As npy: singular values. As csv and latex: one row a q.",
    request=SingularityRequest,
    answer=SingularityAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.5236, 0.0], "task": "xy"},
    example_robot="planar_2r",
    forms=SHEET_FORMS,
    npy_field="q",
    attempt=_attempt,
)
