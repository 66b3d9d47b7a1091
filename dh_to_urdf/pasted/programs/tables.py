"""Tables that a program writes as a matrix, as one list a column, or as a dictionary."""

from __future__ import annotations

import re
from collections.abc import Sequence

from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.headings import MAX_COLUMNS, Heading, heading_problem
from dh_to_urdf.pasted.programs import column_names
from dh_to_urdf.pasted.programs.arrays import as_array, transposed
from dh_to_urdf.pasted.programs.cells import raw_cell
from dh_to_urdf.pasted.programs.execution import Statements
from dh_to_urdf.pasted.programs.frames import table_of_frames
from dh_to_urdf.pasted.programs.tree import Comment
from dh_to_urdf.pasted.programs.values import Array, Items, Placed, Scalar, Unread, Value
from dh_to_urdf.pasted.raw_table import RawRow, RawTable, headings_of
from dh_to_urdf.table import Convention

_KEY = re.compile(r"(alpha|theta|q|a|d|r)_?([0-9]{1,3})")


def table_of(
    machine: Statements,
    comments: Sequence[Comment],
    convention: Convention,
    columns: Sequence[str] | None,
) -> RawTable:
    """Return the table of a program that makes no robot.

    Args:
        machine: The program at its end.
        comments: Its comments, one of which may name the columns.
        convention: What the rows mean.
        columns: Order of the columns of a matrix, as the user says it.

    Raises:
        DHError: There is none, or several, or it cannot be read.
    """
    arrays = _arrays(machine)
    wide = [(name, a) for name, a in arrays if not a.flat and a.shape[1] >= 3 and a.elements]
    several = [(name, a) for name, a in wide if a.shape[0] > 1]
    lists = _of_lists(arrays, convention)
    if lists is not None and columns is None:
        table, found_lists = lists
        if all(_is_made_of(array, found_lists) for _, array in several):
            return table
    framed = table_of_frames((*machine.scopes[-1].values(), *machine.loose), convention)
    if framed is not None and not several:
        return framed
    several = several or ([] if lists else wide)
    if not several:
        found = _of_dictionary(machine, convention)
        if found is not None:
            return found
        raise DHSyntaxError.single(
            (),
            say("the text holds no table: no link, and no matrix of three columns or more")
            + _passed(machine),
        )
    if len(several) > 1:
        raise DHError.single(
            (),
            say(
                "the text holds {count} matrices; paste the one with the table", count=len(several)
            ),
        )
    ((name, array),) = several
    beside = next((n for n, _ in arrays if "offset" in n.lower() and n != name), None)
    if beside is not None:
        raise DHError.single(
            (),
            say(
                "{beside} beside the matrix is not read; write it as a column offset",
                beside=quoted(beside),
            ),
        )
    return _of_matrix(array, comments, convention, columns)


def _arrays(machine: Statements) -> list[tuple[str, Array]]:
    """Return the arrays of numbers that variables hold or that stand alone."""
    found: dict[int, tuple[str, Array]] = {}
    named = [*machine.scopes[-1].items(), *(("", value) for value in machine.loose)]
    for name, value in named:
        if isinstance(value, (Array, Items)) and id(value) not in found:
            try:
                array = as_array(value)
            except Unread:
                continue
            if isinstance(value, Items):
                lines = tuple(_line(item, value.line) for item in value.items)
                array = Array(array.rows, array.flat, value.line, lines=lines)
            found[id(value)] = (name, array)
    return list(found.values())


def _line(value: Value, line: int) -> int:
    return getattr(value, "line", 0) or line


def _passed(machine: Statements) -> str:
    """Return why the first statement with a matrix was passed over."""
    for line, why in machine.passed:
        if "matrix" in why:
            return say(" (line {line}: {why})", line=line, why=why)
    for line, why in machine.passed[:1]:
        return say(" (line {line}: {why})", line=line, why=why)
    return ""


def _of_matrix(
    array: Array,
    comments: Sequence[Comment],
    convention: Convention,
    columns: Sequence[str] | None,
) -> RawTable:
    if array.shape[1] > MAX_COLUMNS:
        raise DHError.single(
            (), say("a row has over {max_columns} elements", max_columns=MAX_COLUMNS)
        )
    array, headings = _headings(array, comments, convention, columns)
    problem, warning = heading_problem(headings, convention.value)
    if problem:
        raise DHError.single((), problem)
    table = RawTable([], warnings=[warning] if warning else [])
    for k, row in enumerate(array.rows):
        line = array.lines[k] if k < len(array.lines) else array.line
        if len(row) != len(headings):
            raise DHError.single(
                ("joints", k),
                say(
                    "row {k} of the matrix (line {line}) has {count} elements under"
                    " {count_2} columns ({headings})",
                    k=k + 1,
                    line=line,
                    count=len(row),
                    count_2=len(headings),
                    headings=", ".join(h.text for h in headings),
                ),
            )
        cells = {
            heading.key: raw_cell(Placed(element, line), heading.text, heading.unit)
            for heading, element in zip(headings, row, strict=True)
        }
        table.rows.append(RawRow(line, cells))
    return table


def _headings(
    array: Array,
    comments: Sequence[Comment],
    convention: Convention,
    columns: Sequence[str] | None,
) -> tuple[Array, list[Heading]]:
    """Return a matrix with a row a joint, and its columns as given, or as a comment names them."""
    high, wide = array.shape
    if columns is not None:
        found = headings_of(columns, convention, "columns")
        turned = len(found) == high and len(found) != wide
        return (transposed(array) if turned else array), found
    of_each = column_names.of_rows(comments, array.lines) if len(array.lines) == high else None
    if of_each is not None and high > 2:
        return transposed(array), of_each
    found_in = column_names.in_comments(comments, (wide,))
    if found_in is not None:
        return array, found_in
    found_in = column_names.in_comments(comments, (high,)) if high > 2 else None
    if found_in is not None:
        return transposed(array), found_in
    raise DHError.single(
        (),
        say(
            "the matrix names no columns; write them in a comment above it, such as"
            " % theta d a alpha, or give columns=theta,d,a,alpha"
        ),
    )


def _is_made_of(array: Array, lists: Sequence[Sequence[Scalar]]) -> bool:
    """Return whether every row, or every column, of a matrix is one of the lists."""
    rows = [list(row) for row in array.rows]
    columns = [list(column) for column in zip(*array.rows, strict=True)]
    known = [list(one) for one in lists]
    return all(row in known for row in rows) or all(column in known for column in columns)


def _of_lists(
    arrays: Sequence[tuple[str, Array]], convention: Convention
) -> tuple[RawTable, list[tuple[Scalar, ...]]] | None:
    """Return a table of lists ``a = […]``, ``d = […]``, ``alpha = […]``, and the lists."""
    found: dict[str, tuple[str, Array]] = {}
    units: dict[str, float | None] = {}
    for name, array in arrays:
        heading = column_names.column_of_variable(name)
        if heading is None or 1 not in array.shape:
            continue
        key = heading.key
        units[key] = heading.unit
        if key in found:
            raise DHError.single(
                (),
                say(
                    "{found} and {name} both look like the column {key}",
                    found=found[key][0],
                    name=name,
                    key=key,
                ),
            )
        found[key] = (name, array)
    x_column = "d" if convention is Convention.KHALIL else "a"
    if "alpha" not in found or x_column not in found:
        return None
    sizes = {len(array.elements) for _, array in found.values()}
    if len(sizes) > 1:
        shown = ", ".join(f"{name} {len(a.elements)}" for name, a in found.values())
        raise DHError.single(
            (), say("the lists of the columns differ in length: {shown}", shown=shown)
        )
    table = RawTable([])
    for k in range(sizes.pop()):
        cells = {
            key: raw_cell(Placed(array.elements[k], array.line or 1), name, units[key])
            for key, (name, array) in found.items()
        }
        table.rows.append(RawRow(k + 1, cells))
    if "type" not in found and "theta" not in found:
        table.typed = True
    return table, [array.elements for _, array in found.values()]


def _of_dictionary(machine: Statements, convention: Convention) -> RawTable | None:
    """Return the table of ``{alpha0: 0, a0: 0, d1: 0.75, q1: q1, …}`` of sympy; None for none."""
    tables = []
    for value in machine.scopes[-1].values():
        if isinstance(value, dict):
            keys = {key: match for key in value if (match := _KEY.fullmatch(key))}
            if len(keys) >= 4:
                tables.append((value, keys))
    if len(tables) > 1:
        raise DHError.single((), say("the text holds {count} tables; paste one", count=len(tables)))
    if not tables:
        return None
    values, keys = tables[0]
    first = {match[1]: 10**6 for match in keys.values()}
    for match in keys.values():
        first[match[1]] = min(first[match[1]], int(match[2]))
    own = "theta" if "theta" in first else "q"
    if "alpha" not in first or "a" not in first or own not in first or "d" not in first:
        return None
    before = first["alpha"] == 0
    if first["a"] != first["alpha"] or first["d"] != 1 or first[own] != 1:
        raise DHError.single(
            (), say("the numbers of alpha, a, d and q do not count up from the first")
        )
    if before and convention is Convention.STANDARD:
        raise DHError.single(
            ("convention",),
            say(
                "alpha0 and a0 are of the modified convention, but convention says"
                " standard; give convention=modified"
            ),
        )
    table = RawTable([])
    for k in range(1, sum(match[1] == own for match in keys.values()) + 1):
        cells = {}
        for key, name in (
            ("alpha", f"alpha{k - before}"),
            ("a", f"a{k - before}"),
            ("d", f"d{k}"),
            ("theta", f"{own}{k}"),
        ):
            found = next((n for n in (name, name[:-1]) if n in values), None)
            matching = [n for n in keys if n.replace("_", "") == name]
            if not matching:
                raise DHError.single((), say("{name} is not in the table", name=name))
            del found
            element = values[matching[0]]
            try:
                cells[key] = raw_cell(Placed(as_array(element).elements[0], 1), matching[0])
            except (Unread, IndexError):
                raise DHError.single((), say("{name} is no number", name=name)) from None
        table.rows.append(RawRow(k, cells))
    return table
