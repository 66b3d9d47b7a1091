"""Data frames and dictionaries of columns: ``pd.DataFrame({'a': […], 'alpha': […]})``."""

from __future__ import annotations

from collections.abc import Iterable

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.headings import COLUMN_QUANTITIES, Heading, heading_problem, read_heading
from dh_to_urdf.pasted.programs.arrays import as_array
from dh_to_urdf.pasted.programs.cells import raw_cell
from dh_to_urdf.pasted.programs.values import Items, Placed, Unread, Value
from dh_to_urdf.pasted.raw_table import RawCell, RawRow, RawTable
from dh_to_urdf.table import Convention


def data_frame(arguments: list[Value], keywords: dict[str, Value]) -> Value:
    """Return what ``DataFrame`` makes, as a dictionary of columns or a list of rows.

    Raises:
        Unread: Its arguments are not read.
    """
    data = arguments[0] if arguments else keywords.get("data")
    columns = keywords.get("columns")
    if isinstance(data, dict) and columns is None:
        return data
    if isinstance(columns, Items) and all(isinstance(name, str) for name in columns.items):
        array = as_array(data)
        names = [str(name) for name in columns.items]
        if array.flat or len(names) != array.shape[1]:
            raise Unread(say("DataFrame with these columns is not read"))
        return {name: Items([row[k] for row in array.rows]) for k, name in enumerate(names)}
    if isinstance(data, Items) and columns is None:
        return data
    raise Unread(say("DataFrame with these arguments is not read"))


def table_of_frames(values: Iterable[Value], convention: Convention) -> RawTable | None:
    """Return the one table that is a dictionary of columns, or a list of dictionaries.

    Raises:
        DHError: There are several, or its columns cannot be read.
    """
    found: list[list[dict[str, Value]]] = []
    for value in values:
        rows = _rows(value)
        if rows and rows not in found:
            found.append(rows)
    if not found:
        return None
    if len(found) > 1:
        raise DHError.single((), say("the text holds {count} tables; paste one", count=len(found)))
    headings = {key: _heading(key) for key in found[0][0]}
    problem, warning = heading_problem([h for h in headings.values() if h], convention.value)
    if problem:
        raise DHError.single((), problem)
    table = RawTable([], warnings=[warning] if warning else [])
    keys = [heading.key for heading in headings.values() if heading]
    if len(set(keys)) != len(keys):
        raise DHError.single((), say("two columns of the table have one meaning; keep one"))
    for k, row in enumerate(found[0], start=1):
        if row.keys() != found[0][0].keys():
            raise DHError.single(
                ("joints", k - 1), say("joint {k} has other keys than the first; give all", k=k)
            )
        cells: dict[str, RawCell] = {}
        for key, value in row.items():
            heading = headings[key]
            if heading is None:
                raise DHError.single((), say("the column {key} is unknown; leave it out", key=key))
            if isinstance(value, str):
                cells[heading.key] = RawCell(value, key, k, heading.unit)
            else:
                cells[heading.key] = _cell(value, key, k, heading.unit)
        table.rows.append(RawRow(k, cells))
    if "theta" not in keys and "type" not in keys and "variable" not in keys:
        table.typed = True
    return table


def _cell(value: Value, key: str, k: int, unit: float | None) -> RawCell:
    try:
        return raw_cell(Placed(as_array(value).elements[0], k), key, unit)
    except (Unread, IndexError):
        raise DHError.single(
            ("joints", k - 1), say("joint {k}: {name} is no number", k=k, name=key)
        ) from None


def _heading(key: str) -> Heading | None:
    return read_heading(key.replace("_", " ")) or read_heading(key)


def _rows(value: Value) -> list[dict[str, Value]]:
    """Return the rows of a table, none for another value."""
    if isinstance(value, dict):
        columns = {key: _column(item) for key, item in value.items()}
        if not _is_table(columns) or None in columns.values():
            return []
        sizes = {len(column) for column in columns.values() if column is not None}
        if len(sizes) != 1:
            raise DHError.single((), say("the columns of the table differ in length"))
        return [
            {key: column[k] for key, column in columns.items() if column is not None}
            for k in range(sizes.pop())
        ]
    if isinstance(value, Items) and value.items:
        rows = [item for item in value.items if isinstance(item, dict)]
        if len(rows) == len(value.items) and all(_is_table(row) for row in rows):
            return rows
    return []


def _column(value: Value) -> list[Value] | None:
    if isinstance(value, Items):
        return list(value.items)
    try:
        return list(as_array(value).elements)
    except Unread:
        return None


def _is_table(columns: Iterable[str]) -> bool:
    found = {heading.key for key in columns if (heading := _heading(key)) is not None}
    return "alpha" in found and len(found & set(COLUMN_QUANTITIES)) > 2
