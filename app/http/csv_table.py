"""Tables as CSV, in the language and with the decimal mark that a request asks for."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from app.sheets.headings import Heading, with_unit
from app.sheets.sheet import Sheet, cell
from dh_to_urdf.languages import ENGLISH, Language
from kinematics.deadline import checked


@dataclass(frozen=True, slots=True)
class CsvForm:
    """How a table is written.

    Attributes:
        language: Of its headings and words.
        digits: Decimals of numbers; None: all that they have.
        commas: Whether numbers have decimal commas, and cells semicolons between them, as
            spreadsheets of many countries read and write.
    """

    language: Language = ENGLISH
    digits: int | None = None
    commas: bool = False

    def heading(self, name: str) -> str:
        """A heading; of one that a name or number follows, the first part: ``sigma_2``."""
        known = self.language.heading(name)
        first, mark, rest = name.partition("_")
        return known if known != name or not mark else f"{self.language.heading(first)}_{rest}"

    def cell(self, name: str, value: object) -> object:
        """A value of a column; see :func:`app.sheets.sheet.cell`."""
        if isinstance(value, bool):
            return self.language.word("", "true" if value else "false")
        if isinstance(value, str):
            words = value.split(" ") if name == Heading.POSTURE.value else [value]
            value = " ".join(self.language.word(name, self.language.text(one)) for one in words)
        written = cell(value, self.digits)
        if self.commas and isinstance(written, float):
            return str(written).replace(".", ",")
        return written

    def lines(self, rows: Iterable[Iterable[object]]) -> bytes:
        """Rows as lines."""
        stream = io.StringIO()
        csv.writer(stream, delimiter=";" if self.commas else ",").writerows(rows)
        return stream.getvalue().encode()


def csv_parts(sheet: Sheet, form: CsvForm, warnings: Sequence[str] = ()) -> list[bytes]:
    """A table as CSV (RFC 4180), in parts: a header, nothing where a value is null.

    Args:
        sheet: The table.
        form: How it is written.
        warnings: Told in a last column, from the first row on.
    """
    told = list(warnings[: len(sheet)])
    if len(warnings) > len(sheet) > 0:
        told[-1] = " | ".join(warnings[len(sheet) - 1 :])
    names = [column.heading for column in sheet.columns]
    headings = [
        with_unit(form.heading(name), column.unit)
        for name, column in zip(names, sheet.columns, strict=True)
    ]
    more = [form.heading(Heading.WARNINGS.value)] if told else []
    parts = [form.lines([[*headings, *more]])]
    number = 0
    for block in checked(sheet.blocks(), 1):
        rows = [[form.cell(*pair) for pair in zip(names, row, strict=True)] for row in block]
        for row in rows if told else ():
            row.append(told[number] if number < len(told) else "")
            number += 1
        parts.append(form.lines(rows))
    return parts
