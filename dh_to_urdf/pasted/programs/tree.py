"""Syntax trees that Python and MATLAB share: expressions and statements, each with its line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import TypeAlias

MAX_DEPTH = 40
"""Nesting of brackets, operators and blocks that is read."""
MAX_NODES = 60_000


@dataclass(frozen=True, slots=True)
class Number:
    """A literal; ``text`` as it was written."""

    line: int
    value: float
    text: str


@dataclass(frozen=True, slots=True)
class Text:
    """A literal text."""

    line: int
    value: str


@dataclass(frozen=True, slots=True)
class Constant:
    """``True``, ``False`` or ``None``."""

    line: int
    value: bool | None


@dataclass(frozen=True, slots=True)
class Name:
    """A name."""

    line: int
    name: str


@dataclass(frozen=True, slots=True)
class Attribute:
    """``owner.name``."""

    line: int
    owner: Expression
    name: str


@dataclass(frozen=True, slots=True)
class Apply:
    """``function(arguments)``; in MATLAB perhaps an index."""

    line: int
    function: Expression
    arguments: tuple[Expression, ...]
    keywords: tuple[tuple[str, Expression], ...] = ()


@dataclass(frozen=True, slots=True)
class Index:
    """``owner[keys]`` of Python and ``owner{keys}`` of MATLAB."""

    line: int
    owner: Expression
    keys: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Slice:
    """``start:stop:step`` of Python, ``start:step:stop`` of MATLAB; a bare ``:`` has no parts."""

    line: int
    start: Expression | None
    stop: Expression | None
    step: Expression | None


@dataclass(frozen=True, slots=True)
class End:
    """``end`` within an index of MATLAB."""

    line: int


@dataclass(frozen=True, slots=True)
class Unary:
    """``-x``, ``+x``, ``not x`` (``!``), ``*x`` (in a list), ``x'``."""

    line: int
    symbol: str
    operand: Expression


@dataclass(frozen=True, slots=True)
class Binary:
    """``left symbol right`` with Python's symbols; MATLAB's ``.*`` and ``^`` as they stand."""

    line: int
    symbol: str
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Listed:
    """A list or a tuple of Python."""

    line: int
    items: tuple[Expression, ...]
    is_tuple: bool = False


@dataclass(frozen=True, slots=True)
class Matrix:
    """``[…]`` of MATLAB, or ``{…}``."""

    line: int
    rows: tuple[tuple[Expression, ...], ...]
    is_cell: bool = False


@dataclass(frozen=True, slots=True)
class Pairs:
    """A dictionary of Python."""

    line: int
    items: tuple[tuple[Expression, Expression], ...]


@dataclass(frozen=True, slots=True)
class Choice:
    """``yes if test else no``."""

    line: int
    test: Expression
    yes: Expression
    no: Expression


@dataclass(frozen=True, slots=True)
class Comprehension:
    """``[item for target in source if test]`` with one ``for``."""

    line: int
    item: Expression
    target: Expression
    source: Expression
    tests: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Unread:
    """An expression that is not read: what it is, and the expressions in it."""

    line: int
    what: str
    parts: tuple[Expression, ...] = ()


@dataclass(frozen=True, slots=True)
class Assign:
    """``targets = value``; ``symbol`` is that of ``+=`` and its like, else empty."""

    line: int
    targets: tuple[Expression, ...]
    value: Expression
    symbol: str = ""


@dataclass(frozen=True, slots=True)
class Evaluate:
    """An expression as a statement."""

    line: int
    value: Expression


@dataclass(frozen=True, slots=True)
class Delete:
    """``del targets``; none for ``clear``, which deletes all."""

    line: int
    targets: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Branch:
    """``if test: yes else: no``."""

    line: int
    test: Expression
    yes: tuple[Statement, ...]
    no: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Loop:
    """``for target in source: body``."""

    line: int
    target: Expression
    source: Expression
    body: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Return:
    """``return value``, or the outputs of a function of MATLAB."""

    line: int
    value: Expression | None


@dataclass(frozen=True, slots=True)
class Define:
    """A function: names of its arguments with defaults, and the outputs of MATLAB."""

    line: int
    name: str
    arguments: tuple[tuple[str, Expression | None], ...]
    body: tuple[Statement, ...]
    outputs: tuple[str, ...] = ()
    is_plain: bool = True
    """False where it has ``*args``, ``**kwargs`` or a decorator."""


@dataclass(frozen=True, slots=True)
class DefineClass:
    """A class with its superclasses."""

    line: int
    name: str
    parents: tuple[Expression, ...]
    body: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Import:
    """``import module as name`` and ``from module import original as name``."""

    line: int
    names: tuple[tuple[str, str], ...]
    """Names and the dotted names that they stand for."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A statement that is not read: what it is, and the statements and expressions in it."""

    line: int
    what: str
    parts: tuple[Node, ...] = ()


Expression: TypeAlias = (
    Number
    | Text
    | Constant
    | Name
    | Attribute
    | Apply
    | Index
    | Slice
    | End
    | Unary
    | Binary
    | Listed
    | Matrix
    | Pairs
    | Choice
    | Comprehension
    | Unread
)
Statement: TypeAlias = (
    Assign | Evaluate | Delete | Branch | Loop | Return | Define | DefineClass | Import | Unknown
)
Node: TypeAlias = Expression | Statement


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment without its mark."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Program:
    """A program.

    Attributes:
        statements: What it does, in order.
        comments: Its comments.
        is_matlab: Whether it is MATLAB (or Octave), else Python.
    """

    statements: tuple[Statement, ...]
    comments: tuple[Comment, ...]
    is_matlab: bool


def nodes_of(root: Node) -> Iterator[Node]:
    """Return a node and all nodes below it, in no order."""
    stack: list[object] = [root]
    while stack:
        found = stack.pop()
        if isinstance(found, tuple):
            stack.extend(found)
        elif hasattr(found, "__dataclass_fields__"):
            yield found  # type: ignore[misc]
            stack.extend(getattr(found, field.name) for field in fields(found))  # type: ignore[arg-type]
