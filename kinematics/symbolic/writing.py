"""One request from start to end: everything plain first, then simplified while there is time."""

from __future__ import annotations

import time
from functools import partial
from typing import Any

from dh_to_urdf.messages import chained, say
from dh_to_urdf.table import DHTable
from kinematics.symbolic.check import Checker
from kinematics.symbolic.inverse import Inverse, inverse_of, simplify_inverse
from kinematics.symbolic.inverse_model import (
    Derivation,
    NoClosedForm,
    derive,
    evaluated,
    model_source,
    model_view,
)
from kinematics.symbolic.length_names import Length, written_name
from kinematics.symbolic.listing import latex_listing, text_listing
from kinematics.symbolic.parameters import lengths_of, nearly_right_angles
from kinematics.symbolic.quantities import Determinant, Entries, Work
from kinematics.symbolic.request import CODE, Notation, Quantity, SymbolicRequest
from kinematics.symbolic.time_limit import Unfinished, limited
from kinematics.symbolic.views import (
    characters,
    definitions,
    determinant_view,
    inverse_view,
    source,
    used_symbols,
    view,
    writer_of,
)
from kinematics.task import ROWS

PLAIN_SECONDS = 6.0
"""Time for writing everything without simplification, s."""
CODE_SHARE = 0.3
"""Share of the time budget for common subexpressions."""
MAX_CHARACTERS = 1_000_000
"""Largest size of one quantity, characters."""


class Writing:
    """The growing answer to one request."""

    def __init__(self, table: DHTable, request: SymbolicRequest) -> None:
        self.table = table
        self.request = request
        self.work = Work(table, request)
        self.checker = Checker(table, self.work.chain, request.task)
        self.entries: list[Entries] = []
        self.determinant: Determinant | None = None
        self.inverse: Inverse | None = None
        self.model: Derivation | None = None
        self.no_inverse: str | None = None
        self.left_out: dict[Quantity, str] = {}
        self.code: str | None = None
        self._shared = False

    def plain(self) -> None:
        """Write everything without simplification; note what is too large and left out."""
        end = time.monotonic() + PLAIN_SECONDS
        for quantity in self.request.quantities:
            left = end - time.monotonic()
            try:
                if quantity is Quantity.DET_JACOBIAN:
                    self.determinant = limited(left, self.work.determinant)
                elif quantity is Quantity.INVERSE_JACOBIAN:
                    self.inverse = limited(left, self._plain_inverse)
                elif quantity is Quantity.INVERSE:
                    self.model = limited(left, self._derived)
                else:
                    self.entries.append(limited(left, partial(self._plain, quantity)))
            except NoClosedForm as reason:
                self.no_inverse = str(reason)
                self.left_out[quantity] = say("inverse is left out: {reason}", reason=reason)
            except Unfinished as reason:
                self.left_out[quantity] = say(
                    "{quantity} is left out: {reason}", quantity=quantity, reason=reason
                )
        if self.request.notation in CODE:
            self._write_code(end - time.monotonic(), share=False)

    def simplify(self) -> None:
        """Simplify one quantity after the other until the time budget is spent."""
        coding = self.request.notation in CODE
        end = time.monotonic() + self.request.time_budget
        simplified_by = end - (CODE_SHARE * self.request.time_budget if coding else 0.0)
        for entries in self.entries:
            self._simplify(entries, simplified_by)
        if self.determinant is not None:
            self._solve(self.determinant, simplified_by)
        if self.inverse is not None and self.inverse.written:
            self._simplify_inverse(self.inverse, simplified_by)
        if coding:
            self._write_code(PLAIN_SECONDS, share=False)
            self._write_code(end - time.monotonic(), share=True)

    def answer(self) -> dict[str, Any]:
        """Return the answer so far, ready for JSON."""
        request, names = self.request, self.work.names
        used = used_symbols(self.entries, self.determinant, self.inverse)
        definitions_of = set(used)
        if self.model is not None:
            used |= set(self.model.lengths)
        joints = [self.table.rows[k].name for k in self.table.free_rows]
        found: dict[str, Any] = {
            "convention": self.table.convention.value,
            "parameters": request.parameters,
            "values": {name: names.lengths[name] for name in self._in_order(used)},
            "definitions": definitions(definitions_of, names),
            "columns": joints,
            "frame": request.frame,
            "base": request.base,
            "expressed_in": request.expressed_in or request.base,
            "notation": request.notation.value,
        }
        found |= self._quantities(joints)
        found["simplified"] = self._simplified()
        found["notes"] = [*self.left_out.values(), *nearly_right_angles(self.table)]
        if self.determinant is not None:
            found["notes"] += [note for note in self.determinant.notes() if note]
        if self.inverse is not None and self.inverse.note:
            found["notes"].append(self.inverse.note)
        if self.model is not None:
            found["notes"] += self.model.notes
        if self.no_inverse is not None:
            found["no_inverse"] = self.no_inverse
        if request.notation in CODE:
            found["code"] = self.code
        if request.listing:
            found["listing"] = self._listing(found)
        return found

    def _plain(self, quantity: Quantity) -> Entries:
        entries = self.work.entries(quantity)
        if not self._holds(entries):
            raise AssertionError(f"{quantity} disagrees with the table")
        return entries

    def _plain_inverse(self) -> Inverse:
        inverse = inverse_of(self.work)
        if inverse.written and not self.checker.inverts(inverse, self._axes):
            raise AssertionError("inverse_jacobian disagrees with the table")
        return inverse

    def _derived(self) -> Derivation:
        model = derive(self.table, self.request)
        if not evaluated(model, self.table, self.checker.samples):
            raise NoClosedForm(
                say("its formulas lose too many digits with these numbers; ask ik/solutions")
            )
        return model

    @property
    def _axes(self) -> str:
        return self.request.expressed_in or self.request.base

    def _simplify_inverse(self, inverse: Inverse, end: float) -> None:
        before = inverse.written, inverse.over
        try:
            limited(end - time.monotonic(), partial(simplify_inverse, self.work, inverse))
        except Unfinished:
            inverse.simplified = False
        if not self.checker.inverts(inverse, self._axes):
            (inverse.written, inverse.over), inverse.simplified = before, False

    def _holds(self, entries: Entries) -> bool:
        return self.checker.holds(entries, self._axes)

    def _simplify(self, entries: Entries, end: float) -> None:
        before = [[list(row) for row in grid] for grid in entries.written]
        try:
            limited(end - time.monotonic(), partial(self.work.simplify, entries))
        except Unfinished:
            entries.simplified = False
        if not self._holds(entries):
            entries.written, entries.simplified = before, False

    def _solve(self, determinant: Determinant, end: float) -> None:
        try:
            limited(end - time.monotonic(), partial(self.work.look, determinant))
            for minor in determinant.minors:
                limited(end - time.monotonic(), partial(self.work.solve, minor))
        except Unfinished as reason:
            self.left_out[Quantity.DET_JACOBIAN] = say(
                "det_jacobian is not finished: {reason}", reason=reason
            )
        self.checker.settle_signs(determinant)

    def _write_code(self, seconds: float, *, share: bool) -> None:
        try:
            self.code = limited(seconds, partial(self._source, share=share))
        except Unfinished:
            self._shared = False
        else:
            self._shared = share

    def _source(self, *, share: bool) -> str:
        model = [] if self.model is None else [model_source(self.model, self.request.notation)]
        if self.request.quantities == (Quantity.INVERSE,):
            return chained("", model)
        written = source(
            self.table,
            self.request,
            self.entries,
            self.determinant,
            self.inverse,
            self.work.names,
            share=share,
        )
        return chained("\n\n", (written, *model))

    def _quantities(self, joints: list[str]) -> dict[str, Any]:
        if self.request.notation in CODE:
            return {}
        write = writer_of(self.request.notation)
        found: dict[str, Any] = {}
        for entries in self.entries:
            if characters(entries, write) > MAX_CHARACTERS:
                reason = say(
                    "{quantity} is left out: over {max_characters} characters",
                    quantity=entries.quantity,
                    max_characters=MAX_CHARACTERS,
                )
                self.left_out[entries.quantity] = reason
                found[entries.quantity.value] = None
                continue
            found[entries.quantity.value] = view(entries, write)
        if found.get("jacobian"):
            rows = ROWS if self.request.task is None else self.request.task.row_names
            found["jacobian"] = {"matrix": found["jacobian"], "rows": list(rows), "columns": joints}
        for quantity in self.left_out:
            found.setdefault(quantity.value, None)
        if self.determinant is not None:
            view_of = determinant_view(self.determinant, joints, write, self.work)
            found["det_jacobian"] = view_of
        if self.inverse is not None:
            found["inverse_jacobian"] = inverse_view(self.inverse, joints, write)
        if self.model is not None:
            latex = self.request.notation is Notation.LATEX
            found["inverse"] = model_view(self.model, latex=latex)
        return found

    def _simplified(self) -> dict[str, bool]:
        found = {one.quantity.value: one.simplified for one in self.entries}
        if self.determinant is not None:
            found["det_jacobian"] = self.determinant.simplified
        if self.inverse is not None and self.inverse.written:
            found["inverse_jacobian"] = self.inverse.simplified
        # An inverse model has one form only, or there is none for any time.
        missing = [Quantity.INVERSE] if self.no_inverse is not None else []
        found |= {q.value: False for q in self.left_out if q not in missing}
        if self.request.notation in CODE:
            found["code"] = self._shared
        return found

    def _in_order(self, used: set[str]) -> list[str]:
        lengths: list[Length] = lengths_of(self.table)
        chosen = dict(self.request.symbols)
        symbolic = self.request.parameters == "symbolic"
        names = (written_name(one, chosen, symbolic=symbolic)[0] for one in lengths)
        return [name for name in dict.fromkeys(names) if name is not None and name in used]

    def _listing(self, answer: dict[str, Any]) -> str:
        if self.request.notation in CODE:
            return self.code or ""
        latex = self.request.notation is Notation.LATEX
        return latex_listing(answer) if latex else text_listing(answer)
