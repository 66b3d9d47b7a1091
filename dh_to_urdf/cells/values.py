"""Numbers for the names in a table's cells: ``D3:0.45, RL4:450mm``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from dh_to_urdf.cells.arithmetic import FUNCTIONS, CellError, Sum, parse_sum, variable_of
from dh_to_urdf.cells.expressions import MAX_CELL_LENGTH, MAX_MAGNITUDE, ascii_numbers
from dh_to_urdf.documents.checks import Report
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.messages import say

MAX_VALUES = 300
MAX_VALUES_LENGTH = 20_000
VALUES_RULE = say("write values as D3:0.45,RL4:450mm")
_NAME = re.compile(r"[^\W\d_]\w{0,31}")
_NEXT = re.compile(r"[,;](?=\s*[^\W\d_]\w*\s*[:=])")
_RESERVED = {"pi", "π", *FUNCTIONS}


class Values:
    """What names stand for, by their spelling without underscores: ``l_1`` and ``l1`` are one.

    A plain number is in the units of the table, like a plain number in a cell.
    """

    def __init__(self, sums: Mapping[str, Sum] | None = None, used: set[str] | None = None) -> None:
        self._sums = dict(sums or {})
        self._used: set[str] = set() if used is None else used

    def get(self, name: str) -> Sum | None:
        """Return the value of a name, None for a name without one."""
        found = self._sums.get(name)
        if found is not None:
            self._used.add(name)
        return found

    def __contains__(self, name: str) -> bool:
        return name in self._sums

    def with_value(self, name: str, value: Sum) -> Values:
        """Return the values with one more."""
        return Values({**self._sums, name: value}, self._used)

    def without(self, name: str) -> Values:
        """Return the values without one."""
        kept = {other: value for other, value in self._sums.items() if other != name}
        return Values(kept, self._used)

    def without_variable(self, letters: tuple[str, ...], index: int) -> Values:
        """Return the values without names of the row's own joint variable (``r3`` of row 3)."""
        hidden = [
            name
            for name in self._sums
            if (variable := variable_of(name)) is not None
            and variable[0] in letters
            and variable[1] in (None, index)
        ]
        if not hidden:
            return self
        kept = {name: value for name, value in self._sums.items() if name not in hidden}
        return Values(kept, self._used)

    @property
    def unused(self) -> tuple[str, ...]:
        """Return the names that no cell asked for."""
        return tuple(name for name in self._sums if name not in self._used)


def split_values(text: str) -> dict[str, str]:
    """Split ``D3:0.45,RL4:0,45`` into texts by name; ``=`` and ``;`` are read too.

    Raises:
        DHError: Not pairs of names and numbers.
    """
    if len(text) > MAX_VALUES_LENGTH:
        raise DHError.single(
            ("values",),
            say(
                "values is longer than {max_values_length} characters",
                max_values_length=MAX_VALUES_LENGTH,
            ),
        )
    pairs: dict[str, str] = {}
    for part in _NEXT.split(text):
        name, colon, value = part.replace("=", ":", 1).partition(":")
        name = name.strip()
        if not colon:
            raise DHError.single(
                ("values",),
                say(
                    "values holds {part}; {values_rule}", part=quoted(part), values_rule=VALUES_RULE
                ),
            )
        if name in pairs:
            raise DHError.single(
                ("values", name), say("values has {name} twice; keep one", name=quoted(name))
            )
        pairs[name] = value.strip()
    return pairs


def read_values(raw: object, known: Values | None = None) -> Values:
    """Read a mapping from names to numbers or short texts; later ones may use earlier ones.

    Args:
        raw: The mapping.
        known: Values to go on from.

    Raises:
        DHError: With a location below ``values``.
    """
    values = known or Values()
    if isinstance(raw, Values):
        return raw
    if raw is None:
        return values
    if not isinstance(raw, Mapping):
        raise DHError.single(
            ("values",), say('values is {raw}; give {{"D3": 0.45}}', raw=quoted(raw))
        )
    if len(raw) > MAX_VALUES:
        raise DHError.single(
            ("values",), say("values has over {max_values} names", max_values=MAX_VALUES)
        )
    keys: set[str] = set()
    for name, item in raw.items():
        location = ("values", str(name))
        if not isinstance(name, str) or not _NAME.fullmatch(name) or name.lower() in _RESERVED:
            raise DHError.single(
                location,
                say(
                    "values names {name}; give a letter with letters and digits after it,"
                    " as it stands in the cells",
                    name=quoted(name),
                ),
            )
        key = name.replace("_", "")
        if key in keys:
            raise DHError.single(
                location, say("values has {name} twice; keep one", name=quoted(name))
            )
        try:
            values = values.with_value(key, _value(item, values))
        except (CellError, OverflowError, RecursionError) as error:
            reason = str(error) if isinstance(error, CellError) else say("is not a finite number")
            raise DHError.single(
                location,
                say(
                    "values: {name} is {item}, which {reason}",
                    name=name,
                    item=quoted(item),
                    reason=reason,
                ),
            ) from None
        keys.add(key)
    return values


def refuse_unused(values: Values, report: Report) -> None:
    """Report values that no cell uses: a misspelt name, or a joint variable."""
    for name in values.unused:
        joint = say(", since a joint variable takes none") if variable_of(name) else ""
        report.add(
            ("values", name),
            say(
                "values has {name}, which stands for no constant in the table{joint}; leave it out",
                name=name,
                joint=joint,
            ),
        )


def _value(item: Any, values: Values) -> Sum:
    if isinstance(item, bool) or not isinstance(item, (int, float, str)):
        raise CellError(say("is no number"))
    if isinstance(item, str) and len(item) > MAX_CELL_LENGTH:
        raise CellError(
            say("is longer than {max_cell_length} characters", max_cell_length=MAX_CELL_LENGTH)
        )
    total = (
        parse_sum(ascii_numbers(item), values) if isinstance(item, str) else Sum(plain=float(item))
    )
    if total.variable is not None:
        raise CellError(say("holds a joint variable; give a number"))
    if not all(abs(part) <= MAX_MAGNITUDE for part in (total.plain, total.angle, total.length)):
        raise CellError(
            say("is not a finite number within ±{max_magnitude:g}", max_magnitude=MAX_MAGNITUDE)
        )
    return total
