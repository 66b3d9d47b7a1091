"""Followers and couplings in the rows of a document: fields, and cells with variables of others.

``{"mimic": {"joint": "j1", "multiplier": -2, "offset": 0.1}}`` or ``"mimic": "-2*q1 + 0.1"``;
``{"coupling": {"j2": 1}}`` or ``"coupling": "q2"``; and in the cell of the joint variable of row 3
``q3 + q2`` (a coupling) or ``-q2 + pi/2`` (a follower). The number behind a letter is that of the
row. Plain numbers are in the units of the table, in a multiplier those of both joints.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from dh_to_urdf.cells.arithmetic import Variable
from dh_to_urdf.cells.expressions import Cell, CellError, Quantity, parse_cell
from dh_to_urdf.cells.values import Values
from dh_to_urdf.couplings import CouplingError, MovingJoint, joint_map
from dh_to_urdf.documents.checks import Report, Units, refuse_unknown
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.table import DHRow, JointType, Mimic

FIELDS = ("mimic", "coupling")
SLIDES = ("d", "r")
"""Letters of the variables of joints that slide."""
_FORMS = say('give {{"joint": "j1", "multiplier": -1, "offset": 0}} or a text such as "-q1 + 0.1"')
_COUPLED = say('give {{"j2": 1}} or a text such as "q2"')

Term: TypeAlias = tuple[Variable | str, float]
"""A joint, by its variable in a cell or by its name, and its coefficient in the table's units."""


@dataclass(frozen=True, slots=True)
class Dependence:
    """What a row as written depends on, before the names of all rows are known.

    Attributes:
        field: ``mimic``, ``coupling``, or the column of the joint variable.
        follows: The first of the terms is what the joint follows; else all are couplings.
        terms: Other joints and coefficients, in the units of the table.
        offset: Of the joint that is followed, rad or m.
    """

    field: str
    follows: bool
    terms: tuple[Term, ...]
    offset: float = 0.0


def of_cell(
    cell: Cell, column: str, letters: tuple[str, ...], k: int
) -> tuple[Dependence | None, int]:
    """Return what the cell of a joint variable says of other joints, and the sign of its own.

    Args:
        cell: The cell.
        column: Its column.
        letters: Letters of the joint variable in it.
        k: Number of the row, from 0.
    """
    own = [c for (letter, index), c in cell.terms if letter in letters and index in (None, k + 1)]
    others = tuple(
        ((letter, index), c)
        for (letter, index), c in cell.terms
        if not (letter in letters and index in (None, k + 1))
    )
    if not others:
        return None, cell.sign
    if own:
        sign = -1 if own[0] < 0 else 1
        return Dependence(column, False, tuple((v, c / sign) for v, c in others)), sign
    return Dependence(column, True, others), 1


def of_fields(
    fields: Mapping[Any, Any],
    k: int,
    type_: JointType,
    units: Units,
    values: Values,
    location: Location,
    label: str,
    report: Report,
) -> tuple[Dependence, ...]:
    """Read ``mimic`` and ``coupling`` of a row; faults go to the report."""
    found = []
    for field in FIELDS:
        raw = fields.get(field)
        if raw is None:
            continue
        at = (*location, field)
        if type_ is JointType.FIXED:
            report.add(
                at,
                say(
                    "{label}: a fixed joint has no {field}; leave it out", label=label, field=field
                ),
            )
            continue
        quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
        try:
            if isinstance(raw, str):
                found.append(_of_text(raw, field, k, quantity, units, values))
            elif not isinstance(raw, Mapping):
                raise CellError(
                    say(
                        "is {raw}; {forms}",
                        raw=quoted(raw),
                        forms=_FORMS if field == "mimic" else _COUPLED,
                    )
                )
            elif field == "mimic":
                refuse_unknown(
                    raw,
                    ("joint", "multiplier", "offset"),
                    at,
                    say("{label}: mimic", label=label),
                    report,
                )
                found.append(_of_mimic(raw, quantity, units, values))
            else:
                terms = tuple(
                    (str(name), _number(value, values, say("of {name} ", name=quoted(name))))
                    for name, value in raw.items()
                )
                if any(value == 0.0 for _, value in terms):
                    raise CellError(say("has a coefficient of 0; leave that joint out"))
                if terms:
                    found.append(Dependence(field, False, terms))
        except CellError as error:
            report.add(at, say("{label}: {field} {error}", label=label, field=field, error=error))
    return tuple(found)


def _of_text(
    raw: str, field: str, k: int, quantity: Quantity, units: Units, values: Values
) -> Dependence:
    cell = parse_cell(raw, quantity, units.of(quantity), values, units.angle, coupled=True)
    if not cell.terms:
        raise CellError(
            say("is {raw}, which names no joint; {forms}", raw=quoted(raw), forms=_FORMS)
        )
    for (letter, index), _ in cell.terms:
        if index is None:
            raise CellError(
                say(
                    "is {raw}; write the number of the row after {letter}",
                    raw=quoted(raw),
                    letter=letter,
                )
            )
        if index == k + 1:
            raise CellError(
                say("is {raw}, with the joint itself; name others only", raw=quoted(raw))
            )
    if field == "coupling" and cell.value != 0.0:
        raise CellError(say("is {raw}; write the constant as offset", raw=quoted(raw)))
    return Dependence(field, field == "mimic", cell.terms, cell.value)


def _of_mimic(
    raw: Mapping[Any, Any], quantity: Quantity, units: Units, values: Values
) -> Dependence:
    name = raw.get("joint")
    if not isinstance(name, str):
        raise CellError(say("lacks the name of a joint; {forms}", forms=_FORMS))
    multiplier = _number(raw.get("multiplier", 1.0), values, say("multiplier "))
    try:
        cell = parse_cell(raw.get("offset", 0.0), quantity, units.of(quantity), values, units.angle)
    except CellError as error:
        raise CellError(say("offset {error}", error=error)) from None
    if cell.variable is not None:
        raise CellError(say("offset holds a joint variable; give a number"))
    return Dependence("mimic", True, ((name, multiplier),), cell.value)


def _number(raw: object, values: Values, what: str) -> float:
    try:
        cell = parse_cell(raw, Quantity.NUMBER, 1.0, values)
    except CellError as error:
        raise CellError(say("{what}{error}", what=what, error=error)) from None
    if cell.variable is not None:
        raise CellError(say("{what}holds a joint variable; give a number", what=what))
    return cell.value


def resolved(
    rows: Sequence[DHRow],
    dependences: Mapping[int, Dependence],
    units: Units,
    report: Report,
) -> list[DHRow]:
    """Return the rows with what they depend on, after checking that it makes a robot.

    Args:
        rows: The rows, all that the document has.
        dependences: What rows depend on, by their number from 0.
        units: Units of plain numbers.
        report: Receives faults.
    """
    if not dependences:
        return list(rows)
    made = list(rows)
    known = len(report.faults)
    for k, dependence in dependences.items():
        terms = []
        for term, coefficient in dependence.terms:
            name = _name(rows, k, term, dependence.field, report)
            if name is not None:
                leader = next((row for row in rows if row.name == name), None)
                terms.append((name, coefficient * _scale(rows[k], leader, units)))
        if len(terms) < len(dependence.terms):
            continue
        if dependence.follows:
            (name, multiplier), *rest = terms
            mimic = Mimic(name, multiplier, dependence.offset)
            made[k] = replace(made[k], mimic=mimic, coupling=tuple(rest))
        else:
            made[k] = replace(made[k], coupling=tuple(terms))
    if len(report.faults) == known:
        check(made, dependences, report)
    return made


def check(rows: Sequence[DHRow], dependences: Mapping[int, Dependence], report: Report) -> None:
    """Report rows whose joints depend on each other in a way that is no robot."""
    moving = [k for k, row in enumerate(rows) if row.type is not JointType.FIXED]
    joints = [
        MovingJoint(row.name, row.type, row.limits, row.mimic, row.coupling)
        for row in (rows[k] for k in moving)
    ]
    try:
        joint_map(joints, [row.name for row in rows if row.type is JointType.FIXED])
    except CouplingError as error:
        k = moving[error.joint]
        field = dependences[k].field if k in dependences and error.field in FIELDS else error.field
        report.add(("joints", k, field), say("joint {k}: {error}", k=k + 1, error=error))


def _name(
    rows: Sequence[DHRow], k: int, term: Variable | str, field: str, report: Report
) -> str | None:
    """Return the name of the joint that a term means; None after reporting why there is none."""
    if isinstance(term, str):
        return term
    letter, index = term
    written = f"{letter}{'' if index is None else index}"
    at, label = ("joints", k, field), say("joint {k} ({row})", k=k + 1, row=rows[k].name)
    constant = say("; if it is a constant, give values {written}:0.5", written=written)
    if index is None or not 1 <= index <= len(rows):
        report.add(
            at,
            say(
                "{label}: {field} has the variable {written}, but there is no such joint{constant}",
                label=label,
                field=field,
                written=written,
                constant=constant,
            ),
        )
        return None
    leader = rows[index - 1]
    if leader.type is JointType.FIXED:
        report.add(
            at,
            say(
                "{label}: {field} has the variable of joint {index} ({leader}), which"
                " does not move{constant}",
                label=label,
                field=field,
                index=index,
                leader=leader.name,
                constant=constant,
            ),
        )
        return None
    if letter != "q" and (letter in SLIDES) is leader.type.is_revolute:
        report.add(
            at,
            say(
                "{label}: {field} has {written}, but the variable of joint {index}"
                " ({leader}) is {value}{constant}",
                label=label,
                field=field,
                written=written,
                index=index,
                leader=leader.name,
                value=say("an angle") if leader.type.is_revolute else say("a length"),
                constant=constant,
            ),
        )
        return None
    return leader.name


def _scale(row: DHRow, leader: DHRow | None, units: Units) -> float:
    """Return the factor of a coefficient in the table's units to one in rad and m."""
    if leader is None or row.type.is_revolute is leader.type.is_revolute:
        return 1.0
    ratio = units.angle / units.length
    return ratio if row.type.is_revolute else 1.0 / ratio
