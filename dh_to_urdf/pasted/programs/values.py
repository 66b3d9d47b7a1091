"""What a program of robots holds: numbers, lists, arrays, poses, links, robots, functions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.poses import Matrix

if TYPE_CHECKING:
    from dh_to_urdf.pasted.programs import tree

MAX_ITEMS = 4096
"""Items of a list and elements of an array that are held."""


class Unread(Exception):
    """An expression has no value here; the message says why."""


@dataclass(frozen=True, slots=True)
class Unresolved:
    """A name that the program gives no value: a number of the user, a module, a function."""

    name: str


@dataclass(frozen=True, slots=True)
class Opaque:
    """A value that is not known, and why."""

    why: str
    line: int


@dataclass(frozen=True, slots=True)
class Function:
    """A function or class of a library, by the last part of its name."""

    name: str


Scalar: TypeAlias = Sum | Unresolved | Opaque


@dataclass(eq=False)
class Items:
    """A list, a tuple, a cell array, or a row of links of MATLAB.

    Attributes:
        items: What it holds.
        is_tuple: Whether it is a tuple.
        robot: The robot whose list of links it is, which nothing may change.
        line: Where it is made.
    """

    items: list[Value]
    is_tuple: bool = False
    robot: Robot | None = None
    line: int = 0


@dataclass(eq=False)
class Array:
    """Numbers in rows: a matrix of MATLAB, or an array of NumPy.

    Attributes:
        rows: The rows; an array of one dimension has one.
        flat: Whether it has one dimension.
        line: Where it is written.
        view_of: The array that it looks into, as slices of NumPy do.
    """

    rows: tuple[tuple[Scalar, ...], ...]
    flat: bool = False
    line: int = 0
    view_of: Array | None = None
    lines: tuple[int, ...] = ()
    """Lines of the rows, where they are known."""

    @property
    def elements(self) -> tuple[Scalar, ...]:
        """Return the elements row by row."""
        return tuple(element for row in self.rows for element in row)

    @property
    def shape(self) -> tuple[int, int]:
        """Return the numbers of rows and columns."""
        return len(self.rows), len(self.rows[0]) if self.rows else 0


@dataclass(frozen=True)
class Pose:
    """An ``SE3``: a 4x4 matrix in the program's unit of length."""

    matrix: Matrix


@dataclass(frozen=True, slots=True)
class Placed:
    """A number of a link with the line that set it."""

    value: Scalar
    line: int


@dataclass(eq=False)
class Link:
    """A link; an object that lists share.

    Attributes:
        line: Where it is made.
        numbers: theta, d, a, alpha and offset, where they are given.
        type: ``R`` or ``P``; None where it is open yet.
        modified: None where nothing says it.
        flipped: Whether q runs against the axis.
        limits: Lower and upper bound.
        is_fixed: Whether it does not move, as some bodies of a ``rigidBodyTree``.
    """

    line: int
    numbers: dict[str, Placed] = field(default_factory=dict)
    type: str | None = None
    modified: bool | None = None
    flipped: bool = False
    limits: tuple[Placed, Placed] | None = None
    is_fixed: bool = False


@dataclass(eq=False)
class Robot:
    """A robot.

    Attributes:
        line: Where it is made.
        links: Its links, in order.
        base: Pose of its frame 0.
        tool: Pose of its tool in the last frame.
        name: As the program names it.
        modified: What the robot itself says of its links.
        title: What a variable calls it.
    """

    line: int
    links: list[Link]
    base: Matrix
    tool: Matrix
    name: str | None = None
    modified: bool | None = None
    title: str = ""
    used: bool = False
    """Whether it is part of another robot."""
    held: list[Array] = field(default_factory=list)
    """Arrays that its base and tool share with variables, in Python."""


@dataclass(eq=False)
class Body:
    """A ``rigidBody`` of MathWorks with its joint."""

    line: int
    name: str
    joint: Joint | None = None
    given: bool = False
    """Whether a robot has taken it, as it was then."""


@dataclass(eq=False)
class Joint:
    """A ``rigidBodyJoint``: its type, and its D-H row once it is set."""

    line: int
    name: str
    type: str
    row: tuple[Scalar, ...] | None = None
    convention: str = ""
    row_line: int = 0
    limits: tuple[Placed, Placed] | None = None
    flipped: bool = False
    given: bool = False
    """Whether a body has taken it, as it was then."""


@dataclass(eq=False)
class Tree:
    """A ``rigidBodyTree``: bodies with the names of their parents."""

    line: int
    bodies: list[tuple[Body, str]] = field(default_factory=list)
    title: str = ""


@dataclass(eq=False)
class UserFunction:
    """A function of the program.

    Attributes:
        definition: Its text.
        scopes: What it sees besides its own names, innermost first.
        of: The class that it is a method of.
    """

    definition: tree.Define
    scopes: tuple[dict[str, Value], ...] = ()
    of: UserClass | None = None


@dataclass(eq=False)
class UserClass:
    """A class of the program.

    Attributes:
        definition: Its text.
        parents: Its superclasses.
        scopes: What its methods see, innermost first.
        used: Whether an object of it is made.
    """

    definition: tree.DefineClass
    parents: tuple[Value, ...] = ()
    scopes: tuple[dict[str, Value], ...] = ()
    used: bool = False


@dataclass(eq=False)
class Instance:
    """An object of a class of the program; ``robot`` if the class is a robot's."""

    of: UserClass
    attributes: dict[str, Value] = field(default_factory=dict)
    robot: Robot | None = None


@dataclass(frozen=True)
class Method:
    """A method of a value, such as ``L.append``.

    Attributes:
        owner: The value.
        name: The method.
        of: For ``super()``, the class whose parents are asked.
    """

    owner: Value
    name: str
    of: UserClass | None = None


Value: TypeAlias = (
    Sum
    | bool
    | str
    | Unresolved
    | Opaque
    | Function
    | Items
    | Array
    | Pose
    | Link
    | Robot
    | Body
    | Joint
    | Tree
    | UserFunction
    | UserClass
    | Instance
    | Method
    | dict[str, "Value"]
    | None
)


def parts_of(value: Value, depth: int = 0) -> Iterator[Link | Robot | Body | Joint | Tree]:
    """Return the links and robots in a value."""
    if isinstance(value, (Link, Robot, Body, Joint, Tree)):
        yield value
    elif depth > 4:
        return
    elif isinstance(value, Items):
        for item in value.items:
            yield from parts_of(item, depth + 1)
    elif isinstance(value, dict):
        for item in value.values():
            yield from parts_of(item, depth + 1)
    elif isinstance(value, Instance):
        if value.robot is not None:
            yield value.robot
        for item in value.attributes.values():
            yield from parts_of(item, depth + 1)
    elif isinstance(value, Method):
        yield from parts_of(value.owner, depth + 1)


def is_part(value: Value) -> bool:
    """Return whether a value holds a link or a robot."""
    return next(parts_of(value), None) is not None


def number(value: float) -> Sum:
    """Return a plain number."""
    return Sum(plain=float(value))
