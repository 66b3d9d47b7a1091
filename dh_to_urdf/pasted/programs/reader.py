"""Programs in Python and MATLAB -> raw tables of the robot that they make."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.cells.values import Values
from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.names import name_of
from dh_to_urdf.pasted.placement_notes import placement_notes
from dh_to_urdf.pasted.programs import selection, tables
from dh_to_urdf.pasted.programs.cells import raw_cell
from dh_to_urdf.pasted.programs.execution import Statements
from dh_to_urdf.pasted.programs.language import read_program
from dh_to_urdf.pasted.programs.poses import pose_matrix
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.robots import set_robot
from dh_to_urdf.pasted.programs.tree import Comment
from dh_to_urdf.pasted.programs.values import (
    Array,
    Items,
    Link,
    Opaque,
    Placed,
    Pose,
    Robot,
    Unread,
)
from dh_to_urdf.pasted.raw_table import RawCell, RawRow, RawTable
from dh_to_urdf.poses import Matrix, rigid_transform
from dh_to_urdf.table import Convention

_INFINITE = float("inf")


def table_from_program(
    text: str,
    convention: Convention,
    columns: Sequence[str] | None,
    values: Values,
    angle: str | None,
    length: float,
    name: str | None = None,
) -> tuple[RawTable, dict[str, Any]]:
    """Read the robot that a program makes, or the table that it writes.

    Args:
        text: The program.
        convention: What the rows mean; it must be that of the links.
        columns: Order of the columns of a matrix.
        values: Numbers that the user gives for names; they win over those of the program.
        angle: Unit of bare angles, None for rad where no angle looks like degrees.
        length: The program's unit of length in m.
        name: The robot that the user wants, by its name or variable.

    Returns:
        The table, and base and tool as fields of a document.

    Raises:
        DHError: The program does something to a link or a robot that is not read, with the line;
            it makes no robot, or several; or its links are of another convention.
    """
    program = read_program(text)
    machine = Statements(program, values, angle)
    try:
        machine.follow(program)
        robot = selection.robot_of(machine, name)
        if robot is None or (columns is not None and not robot.links):
            found = tables.table_of(machine, program.comments, convention, columns)
            found.warnings += machine.warnings
            found.placed_in_m = True
            return found, _notes(machine, program.comments, length)
    except RecursionError:
        raise DHError.single((), say("the program is nested too deeply")) from None
    table = RawTable([], typed=True, warnings=list(machine.warnings), placed_in_m=True)
    table.name = name_of(robot.name, table.warnings)
    for link in robot.links:
        _check_convention(convention, link, robot)
        table.rows.append(_row(link))
    if robot in machine.robots:
        table.warnings += _unused_notes(machine, robot)
        return table, _placements(robot, length)
    return table, _notes(machine, program.comments, length)


def _notes(machine: Statements, comments: Sequence[Comment], length: float) -> dict[str, Any]:
    """Return base and tool of a text without a robot: variables of these names, or comments."""
    found = placement_notes("\n".join(comment.text for comment in comments))[1]
    robot = Robot(1, [], np.eye(4), np.eye(4))
    for key in ("base", "tool"):
        value = machine.scopes[-1].get(key)
        if isinstance(value, (Array, Items, Pose, Opaque)):
            if key in found:
                raise DHError.single((key,), say("{key} stands twice; keep one", key=key))
            set_robot(robot, key, value, 1, [], is_matlab=machine.is_matlab)
    return found | _placements(robot, length)


def _unused_notes(machine: Statements, robot: Robot) -> list[str]:
    """Warn of a variable base or tool that the robot does not get."""
    warnings: list[str] = []
    for key, given in (("base", robot.base), ("tool", robot.tool)):
        value = machine.scopes[-1].get(key)
        try:
            matrix = pose_matrix(value)
        except Unread:
            continue
        if matrix is not None and not np.array_equal(matrix, given):
            warnings.append(
                say(
                    "{key} is a variable of the text that the robot is not given; it is"
                    " left out (robot.{key} = {key} would give it)",
                    key=key,
                )
            )
    return warnings


def _row(link: Link) -> RawRow:
    cells: dict[str, RawCell] = {}
    for key, placed in link.numbers.items():
        cells[key] = raw_cell(placed, key)
    own = None if link.is_fixed else "theta" if link.type == "R" else "d"
    for key in ("alpha", "a", "theta", "d"):
        if key != own and key not in cells:
            cells[key] = raw_cell(Placed(Sum(), link.line), key)
    if link.flipped:
        cells["sign"] = RawCell("-1", "flip", link.line)
    if link.limits is not None and not _without_end(link.limits):
        for key, bound in zip(("lower", "upper"), link.limits, strict=True):
            cells[key] = raw_cell(bound, "qlim")
    cells["type"] = RawCell("F" if link.is_fixed else link.type or "R", "type", link.line)
    return RawRow(link.line, cells, own_constant=False)


def _without_end(limits: tuple[Placed, Placed]) -> bool:
    found = [bound.value.plain for bound in limits if isinstance(bound.value, Sum)]
    return found == [-_INFINITE, _INFINITE]


def _check_convention(convention: Convention, link: Link, robot: Robot) -> None:
    modified = bool(link.modified if link.modified is not None else robot.modified)
    written = Convention.MODIFIED if modified else Convention.STANDARD
    if convention is Convention.KHALIL:
        raise DHError.single(
            ("convention",),
            say(
                "line {line}: links of the Robotics Toolbox are {written}, not khalil;"
                " give convention={written}",
                line=link.line,
                written=written,
            ),
        )
    if written is not convention:
        add = "" if modified else say(", or add 'modified' to the link")
        raise DHError.single(
            ("convention",),
            say(
                "line {line}: the link is {written}, but convention says {convention};"
                " give convention={written}{add}",
                line=link.line,
                written=written,
                convention=convention,
                add=add,
            ),
        )


def _placements(robot: Robot, length: float) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, matrix in (("base", robot.base), ("tool", robot.tool)):
        if np.array_equal(matrix, np.eye(4)):
            continue
        T: Matrix = matrix + 0.0
        T[:3, 3] = T[:3, 3] * length if length == 1.0 else T[:3, 3] / round(1.0 / length)
        try:
            rigid_transform(T)
        except ValueError as error:
            raise refused(
                robot.line, say("{key} of the robot {error}", key=key, error=error)
            ) from None
        found[key] = {"matrix": T.tolist()}
    return found
