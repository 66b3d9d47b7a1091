"""Polynomials of each quantity, and their expressions, plain or simplified."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import combinations
from math import comb
from typing import TypeAlias

from dh_to_urdf.messages import say
from dh_to_urdf.table import DHTable
from kinematics.symbolic.arrange import expanded, folded, shortest_form
from kinematics.symbolic.chain import Chain, Steps, chain_of
from kinematics.symbolic.determinant import Sparse, Views, determinant
from kinematics.symbolic.expressions import Sum
from kinematics.symbolic.factors import factored
from kinematics.symbolic.jacobian import Column, jacobian_columns
from kinematics.symbolic.names import Names
from kinematics.symbolic.parameters import unusual_angles
from kinematics.symbolic.polynomial import Polynomial
from kinematics.symbolic.request import Quantity, SymbolicRequest
from kinematics.symbolic.steps import Pose, Walker
from kinematics.symbolic.trigonometry import shortest

MAX_MINORS = 36

MAX_UNUSUAL = 2
"""Number of angles without exact cosine whose cosines are kept as symbols, to cancel squares."""

Grid: TypeAlias = list[list[Polynomial]]


@dataclass
class Entries:
    """One quantity: matrices of polynomials, and their expressions so far.

    Attributes:
        quantity: The quantity.
        labels: Name of each matrix: ``A1``, ``T``, ….
        grids: The matrices.
        positions: Whether the last column of the first three rows holds positions.
        written: An expression for each entry.
        simplified: Whether every expression is.
    """

    quantity: Quantity
    labels: list[str]
    grids: list[Grid]
    positions: bool
    written: list[list[list[Sum]]] = field(default_factory=list)
    simplified: bool = False


@dataclass
class Minor:
    """The determinant of one square part of J.

    Attributes:
        without: Numbers of the joints whose columns are left out.
        sparse: J in its sparsest form.
        expression: The determinant, if found.
        factored: Whether its factors are irreducible.
    """

    without: tuple[int, ...]
    sparse: Sparse | None = None
    expression: Sum | None = None
    factored: bool = False


@dataclass
class Determinant:
    """Determinants of a Jacobian: of J itself, or of its square parts.

    Attributes:
        rows: Rows of the task, as indices.
        joints: Numbers of the joints on the chain.
        minors: One for a square J; for a redundant arm each square part of it.
        note: Why there is none, or which minors they are.
    """

    rows: tuple[int, ...]
    joints: tuple[int, ...]
    minors: list[Minor]
    note: str = ""

    def notes(self) -> list[str]:
        """Return notes about it, in words."""
        zero = self.minors and all(minor.expression == Sum() for minor in self.minors)
        return [
            self.note,
            say("these rows of J are dependent in every configuration") if zero else "",
        ]

    @property
    def found(self) -> bool:
        """Whether all were found."""
        return all(minor.expression is not None for minor in self.minors)

    @property
    def simplified(self) -> bool:
        """Whether all were found and factored."""
        return all(minor.expression is not None and minor.factored for minor in self.minors)


class Work:
    """One request on one table.

    Attributes:
        names: Its symbols.
        chain: From the base to the frame.
    """

    def __init__(self, table: DHTable, request: SymbolicRequest) -> None:
        self.table = table
        self.request = request
        symbolic = request.parameters == "symbolic"
        rounded = unusual_angles(table) > MAX_UNUSUAL
        self.names = Names(table.dof, symbolic, dict(request.symbols), rounded=rounded)
        self.chain: Chain = chain_of(table, self.names, request.base, request.frame)
        self._known: dict[tuple[Polynomial, bool], Sum] = {}
        self._tip: Pose | None = None
        self._columns: dict[str, list[Column]] = {}

    def entries(self, quantity: Quantity) -> Entries:
        """Return the polynomials of a quantity, written without simplification.

        Raises:
            TooManyTerms: They exceed the limits.
        """
        labels, grids, positions = {
            Quantity.A: self._links,
            Quantity.T0: self._products,
            Quantity.T: self._matrix,
            Quantity.POSITION: self._position,
            Quantity.ROTATION: self._rotation,
            Quantity.JACOBIAN: self._jacobian,
        }[quantity]()
        found = Entries(quantity, labels, grids, positions)
        found.written = [
            [[expanded(folded(entry, self.names), self.names) for entry in row] for row in grid]
            for grid in grids
        ]
        return found

    def simplify(self, entries: Entries) -> None:
        """Simplify entry after entry in place; may be interrupted between any two."""
        for m, grid in enumerate(entries.grids):
            for i, row in enumerate(grid):
                for j, entry in enumerate(row):
                    last = entries.positions and j == len(row) - 1
                    entries.written[m][i][j] = self.simple(entry, position=last)
        entries.simplified = True

    def simple(self, p: Polynomial, *, position: bool = False) -> Sum:
        """Return the shortest form of a polynomial."""
        key = (p, position)
        if key not in self._known:
            form = shortest(p, self.names)
            self._known[key] = shortest_form(form, self.names, position=position)
        return self._known[key]

    def determinant(self) -> Determinant:
        """Return the determinants to compute."""
        joints = tuple(dict.fromkeys(axis.joint for axis in self.chain.axes))
        if self.request.task is not None and self.request.task.own_axes:
            own = say(
                "the determinant is written for rows in base axes, and the task {task}"
                " counts turns about the frame's own axes",
                task=self.request.task.name,
            )
            return Determinant(self.request.task.rows, joints, [], own)
        if self.table.is_coupled:
            free = say("the determinant is written for joints that are all free")
            return Determinant((), joints, [], free)
        rows, note = self.square_rows(len(joints))
        count = comb(len(joints), len(rows)) if 0 < len(rows) <= len(joints) else 0
        if note or not count:
            return Determinant(rows, joints, [], note or say("no joint moves this frame"))
        if count > MAX_MINORS:
            note = say(
                "det(J Jt) is the sum of the squares of {count} minors; over {max_minors}",
                count=count,
                max_minors=MAX_MINORS,
            )
            return Determinant(rows, joints, [], say("{note} are not written", note=note))
        dropped = combinations(joints, len(joints) - len(rows))
        if count > 1:
            note = say("J is not square: det(J Jt) is the sum of the squares of these minors")
        return Determinant(rows, joints, [Minor(without) for without in dropped], note)

    def look(self, found: Determinant) -> None:
        """Write each square part of J where it is sparsest."""
        if not found.minors:
            return
        seen = Views(self.chain, found.rows)
        for minor in found.minors:
            kept = [joint for joint in found.joints if joint not in minor.without]
            minor.sparse = seen.sparsest(kept)

    def solve(self, minor: Minor) -> None:
        """Compute one determinant, up to the sign that :mod:`kinematics.symbolic.check` settles."""
        if minor.sparse is None:
            return
        blocks = determinant(minor.sparse, self.names)
        for deeply in (False, True):
            product = factored(blocks, self.names, deeply=deeply)
            minor.expression = Sum((product,)) if product.coefficient else Sum()
            minor.factored = deeply

    def jacobian(self, expressed_in: str) -> list[Column]:
        """Return the columns of J in the axes of a frame."""
        tip = len(self.chain.frames) - 1
        if expressed_in not in self._columns:
            self._columns[expressed_in] = jacobian_columns(
                self.chain, self.table.dof, self.chain.node(expressed_in), tip
            )
        return self._columns[expressed_in]

    def task_rows(self) -> list[list[Polynomial]]:
        """Return the rows of J that the request names, all six by default."""
        task = self.request.task
        columns = self.jacobian(self.request.expressed_in or self.request.base)
        if task is None:
            return [[column[i] for column in columns] for i in range(6)]
        turned = self.jacobian(self.chain.frames[-1]) if task.own_axes else columns
        return [[column[i] for column in (columns if i < 3 else turned)] for i in task.rows]

    def square_rows(self, joints: int) -> tuple[tuple[int, ...], str]:
        """Return the rows that make J of so many joints square, and why there are none.

        Args:
            joints: Number of joints that move the frame.
        """
        if self.request.task is not None:
            rows = self.request.task.rows
            if joints < len(rows):
                return rows, (
                    say(
                        "the task has {count} rows and J {joints} columns: give a task of at"
                        " most {joints} rows",
                        count=len(rows),
                        joints=joints,
                    )
                )
            return rows, ""
        columns = self.jacobian(self.request.base)
        rows = tuple(i for i in range(6) if any(column[i] for column in columns))
        linear = tuple(i for i in rows if i < 3)
        if len(rows) <= joints:
            return rows, ""
        if len(linear) == joints:
            return linear, ""
        return rows, (
            say(
                "J has {count} rows and {joints} columns: give a task of {joints} rows"
                " for a determinant",
                count=len(rows),
                joints=joints,
            )
        )

    def _pose(self) -> Pose:
        if self._tip is None:
            walker = Walker(self.names)
            self._tip = walker.go(step for steps in self.chain.steps for step in steps)
        return self._tip

    def _links(self) -> tuple[list[str], list[Grid], bool]:
        steps = Steps(self.table, self.names)
        poses = [Walker(self.names).go(steps.row(k)) for k in range(len(self.table.rows))]
        labels = [f"A{k}" for k in range(1, len(poses) + 1)]
        return labels, [pose.matrix() for pose in poses], True

    def _products(self) -> tuple[list[str], list[Grid], bool]:
        steps = Steps(self.table, self.names)
        walkers = [Walker(self.names)]
        grids = []
        for k, row in enumerate(self.table.rows):
            walker = replace(walkers[row.parent])
            grids.append(walker.go(steps.row(k)).matrix())
            walkers.append(walker)
        return [f"T0_{k}" for k in range(1, len(grids) + 1)], grids, True

    def _matrix(self) -> tuple[list[str], list[Grid], bool]:
        return ["T"], [self._pose().matrix()], True

    def _position(self) -> tuple[list[str], list[Grid], bool]:
        return ["position"], [[[entry] for entry in self._pose().origin]], True

    def _rotation(self) -> tuple[list[str], list[Grid], bool]:
        axes = self._pose().axes
        return ["rotation"], [[[axis[i] for axis in axes] for i in range(3)]], False

    def _jacobian(self) -> tuple[list[str], list[Grid], bool]:
        return ["J"], [self.task_rows()], False
