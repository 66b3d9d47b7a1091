"""A class list in CSV: sheets for all students, and from their answers a table of marks in CSV."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.exercises.catalogue import exercise_named
from app.exercises.drawing import drawn
from app.exercises.marking import NO_ANSWER, marked
from app.exercises.sheets import sheet

SEED_COLUMNS = ("id", "seed", "student", "number", "numéro", "numero", "étudiant", "etudiant")
MAX_LIST = 10_000_000
_NOT_IN_NAMES = re.compile(r"[^\w.-]+")


class ClassListError(ValueError):
    """A class list, or a file of answers, that cannot be used."""


@dataclass(frozen=True)
class ClassList:
    """Rows of a class list.

    Attributes:
        column: Column that holds what the numbers are drawn from.
        columns: All columns.
        rows: By column.
        delimiter: Between columns.
    """

    column: str
    columns: tuple[str, ...]
    rows: tuple[Mapping[str, str], ...]
    delimiter: str


def read_class_list(path: Path) -> ClassList:
    """Read a class list: CSV with a heading, in UTF-8, with commas, semicolons or tabs.

    Raises:
        ClassListError: It cannot be read, has no column of numbers, or a number twice.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise ClassListError(f"{path}: {error}; give a CSV file in UTF-8") from None
    if len(text) > MAX_LIST:
        raise ClassListError(f"{path}: the file is larger than {MAX_LIST} characters")
    heading = text.partition("\n")[0]
    delimiter = max(",;\t", key=heading.count)
    reader = csv.DictReader(io.StringIO(text), delimiter=delimiter)
    columns = tuple(one.strip() for one in reader.fieldnames or ())
    reader.fieldnames = list(columns)
    column = next((one for one in columns if one.lower() in SEED_COLUMNS), None)
    if column is None:
        raise ClassListError(f"{path}: no column is called id; name the students' numbers so")
    rows = []
    seen: dict[str, int] = {}
    for row in reader:
        if None in row:
            raise ClassListError(
                f"{path}: line {reader.line_num} has more cells than the heading; put answers with"
                " commas between double quotes"
            )
        cells = {name: (value or "").strip() for name, value in row.items()}
        seed = cells[column]
        if not seed:
            if any(cells.values()):
                raise ClassListError(f"{path}: line {reader.line_num} has no {column}")
            continue
        if seed in seen:
            raise ClassListError(
                f"{path}: line {reader.line_num}: {seed} stands in line {seen[seed]} already"
            )
        seen[seed] = reader.line_num
        rows.append(cells)
    return ClassList(column, columns, tuple(rows), delimiter)


def file_name(seed: str) -> str:
    """Return the name of a student's files, without ending."""
    return _NOT_IN_NAMES.sub("-", seed).strip("-.") or "student"


def write_sheets(
    name: str, students: ClassList, folder: Path, language: str, address: str
) -> list[Path]:
    """Write a sheet for each student.

    Raises:
        RequestProblem: There is no such exercise, or a number cannot be a seed.
        ClassListError: Two students' files would have one name.
    """
    exercise_named(name)
    names = _file_names(students)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for row in students.rows:
        seed = row[students.column]
        path = folder / f"{names[seed]}.txt"
        path.write_text(sheet(drawn(name, seed), language, address), encoding="utf-8")
        written.append(path)
    return written


def _file_names(students: ClassList) -> dict[str, str]:
    names = {row[students.column]: file_name(row[students.column]) for row in students.rows}
    if len({name.lower() for name in names.values()}) < len(names):
        raise ClassListError("two students' files would have the same name; change their ids")
    return names


def marks_table(name: str, students: ClassList, folder: Path | None) -> str:
    """Return the marks of a class as CSV, a row a student.

    Answers are in the columns of the list that have names of parts, or in files ``ID.json`` of a
    folder, as they are sent to the service.

    Args:
        name: Name of the exercise.
        students: The class list.
        folder: Where the files are; None: answers are in the list.

    Raises:
        RequestProblem: There is no such exercise, or a number cannot be a seed.
        ClassListError: The list has no answers, and no folder is given.
    """
    declaration = exercise_named(name)
    parts = [part.name for part in declaration.parts]
    if folder is None and not set(parts) & set(students.columns):
        raise ClassListError(
            f"the list has no column of answers ({', '.join(parts)}); add some, or name the folder"
            " of answers"
        )
    names = _file_names(students)
    kept = [one for one in students.columns if one not in parts]
    stream = io.StringIO()
    writer = csv.writer(stream, delimiter=students.delimiter, lineterminator="\n")
    writer.writerow([*kept, *parts, "total", "out_of", "remarks"])
    for row in students.rows:
        seed = row[students.column]
        remark = ""
        try:
            answers = _answers(row, parts, folder, names[seed], seed)
            found = marked(drawn(name, seed), answers)
        except ClassListError as error:
            found, remark = marked(drawn(name, seed), {}), str(error)
        cells = [f"{part['marks']:g}" for part in found["parts"]]
        remarks = remark or "; ".join(_remarks(found["parts"]))
        own = [_safe(row[one]) for one in kept]
        total = [f"{found['marks']:g}", f"{found['out_of']:g}"]
        writer.writerow([*own, *cells, *total, _safe(remarks)])
    return stream.getvalue()


def _safe(cell: str) -> str:
    """Return a cell that no spreadsheet takes for a formula."""
    return f"'{cell}" if cell[:1] in ("=", "+", "-", "@", "\t", "\r") else cell


def _answers(
    row: Mapping[str, str], parts: Sequence[str], folder: Path | None, name: str, seed: str
) -> Mapping[str, Any]:
    if folder is not None:
        return _from_file(folder / f"{name}.json", seed)
    return {part: _cell(row[part]) for part in parts if row.get(part)}


def _cell(text: str) -> Any:
    """Return what a cell holds: JSON, or else a formula."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _from_file(path: Path, seed: str) -> Mapping[str, Any]:
    """Return the answers of a file, which has them alone or with the seed, as it is sent."""
    if not path.exists():
        raise ClassListError(NO_ANSWER)
    try:
        document = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        raise ClassListError(f"{path.name} cannot be read: {error}") from None
    if not isinstance(document, dict):
        raise ClassListError(f"{path.name} holds no object of answers")
    if "answers" not in document:
        return document
    if document.get("seed", seed) != seed:
        raise ClassListError(f"{path.name} is about another seed, {document['seed']!r}")
    answers = document["answers"]
    if not isinstance(answers, dict):
        raise ClassListError(f"{path.name} holds no object of answers")
    return answers


def _remarks(parts: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield what is to say of the answers that are not right."""
    for part in parts:
        if part["correct"]:
            continue
        first = [one["message"] for one in part["diagnosis"] if one["explanation"] == 1]
        said = ", and ".join(first) or part["note"] or "wrong"
        yield f"{part['name']}: {said}"
