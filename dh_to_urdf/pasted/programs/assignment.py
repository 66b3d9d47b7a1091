"""Assignments of a program: names, properties, single elements, parts that are removed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import arrays, attributes, tree
from dh_to_urdf.pasted.programs.indexing import (
    Key,
    Several,
    matlab_items_with,
    with_element,
    without_items,
)
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Array,
    Instance,
    Items,
    Link,
    Opaque,
    Pose,
    Robot,
    Unread,
    UserClass,
    Value,
    is_part,
)

if TYPE_CHECKING:
    from dh_to_urdf.pasted.programs.execution import Statements

_NOBODY = UserClass(tree.DefineClass(0, "", (), ()))
"""The class of structures, and of self where its head is not in the text."""


def assign(machine: Statements, target: tree.Expression, value: Value, line: int) -> None:
    """Give a target its value.

    Raises:
        Unread: The target is not read.
        DHError: It changes a link or a robot in a way that is not read.
    """
    match target:
        case tree.Name(name=name):
            machine.assigned(name, value)
        case tree.Listed(items=items):
            _unpack(machine, items, value, line)
        case tree.Attribute(owner=owner, name=name):
            _set_property(machine, owner, name, value, line)
        case tree.Apply(function=owner, arguments=keys) if machine.is_matlab:
            _set_matlab(machine, owner, keys, value, line)
        case tree.Index(owner=owner, keys=keys):
            if machine.is_matlab:
                _set_matlab(machine, owner, keys, value, line)
            else:
                _set_python(machine, owner, keys, value, line)
        case _:
            raise Unread(say("the target of an assignment is not read"))


def _unpack(
    machine: Statements, items: tuple[tree.Expression, ...], value: Value, line: int
) -> None:
    if isinstance(value, Opaque) or (len(items) == 1 and machine.is_matlab):
        values: list[Value] = [value] * len(items)
    else:
        values = machine.iterate(value)
    rest = [k for k, part in enumerate(items) if isinstance(part, tree.Unary)]
    if len(rest) == 1 and len(values) >= len(items) - 1:
        k, after = rest[0], len(items) - rest[0] - 1
        middle = Items(values[k : len(values) - after])
        values = [*values[:k], middle, *values[len(values) - after :]]
        star = items[k]
        assert isinstance(star, tree.Unary)
        items = (*items[:k], star.operand, *items[k + 1 :])
    if len(values) != len(items):
        raise Unread(say("unpacks another number of values"))
    for part, item in zip(items, values, strict=True):
        assign(machine, part, item, line)


def _set_property(
    machine: Statements, owner: tree.Expression, name: str, value: Value, line: int
) -> None:
    if (
        isinstance(owner, tree.Name)
        and (machine.is_matlab or owner.name == "self")
        and not any(owner.name in scope for scope in machine.scopes)
    ):
        # A structure of MATLAB, or a piece of a class without its head.
        machine.scopes[0][owner.name] = Instance(_NOBODY)
    found = machine.evaluate(owner)
    if isinstance(found, Pose):
        if not machine.is_matlab:
            raise refused(
                line, say(".{name} of a pose is set; make the pose with its numbers", name=name)
            )
        assign(machine, owner, attributes.with_pose_part(found, name, value), line)
        return
    for robot in machine.titled(value):
        robot.title = robot.title or name
    attributes.put(machine, found, name, value, line)


def _current(machine: Statements, owner: tree.Expression) -> Value:
    """Return what a target holds; an empty list where MATLAB would make one."""
    if isinstance(owner, tree.Name):
        found = next((s[owner.name] for s in machine.scopes if owner.name in s), None)
        if found is None:
            return Array(())
        return found
    found = machine.evaluate(owner)
    if isinstance(found, Opaque) and isinstance(owner, tree.Attribute):
        holder = machine.evaluate(owner.owner)
        if isinstance(holder, Instance) and owner.name not in holder.attributes:
            return Array(())
    return found


def _set_matlab(
    machine: Statements,
    owner: tree.Expression,
    nodes: tuple[tree.Expression, ...],
    value: Value,
    line: int,
) -> None:
    """Set elements of MATLAB: the list or array is a new one, given to the same place."""
    found = _current(machine, owner)
    if isinstance(found, Items) and found.robot is not None:
        raise refused(
            line, say("the links of a robot are changed after it was made; change them first")
        )
    if isinstance(found, (Link, Robot)) and isinstance(owner, tree.Name):
        found = Items([found])
    if isinstance(found, Array) and not found.elements and is_part(value):
        found = Items([], line=line)
    if isinstance(found, Pose):
        matrix = _with(machine, arrays.of_matrix(found.matrix), nodes, value)
        assign(machine, owner, Pose(arrays.to_matrix(matrix)), line)
        return
    if isinstance(found, Items):
        keys = _flat(machine.keys_of(found, nodes))
        assign(machine, owner, matlab_items_with(found, keys, value), line)
    elif isinstance(found, Array):
        assign(machine, owner, _with(machine, found, nodes, value), line)
    else:
        raise Unread(say("an element of a value of this kind is set"))


def _with(
    machine: Statements, array: Array, nodes: tuple[tree.Expression, ...], value: Value
) -> Array:
    if isinstance(value, Items) and machine.is_matlab:
        raise Unread(say("an element is set to a list"))
    keys = machine.keys_of(array, nodes)
    return with_element(array, keys, value, is_matlab=machine.is_matlab)


def _flat(keys: list[Key]) -> Key:
    """Return the index of a row from one index, or from two of which the first is 1."""
    if len(keys) == 2 and keys[0] in (0, Several((0,))):
        keys = keys[1:]
    if len(keys) != 1:
        raise Unread(say("two indices of a list of links"))
    return keys[0]


def _set_python(
    machine: Statements,
    owner: tree.Expression,
    nodes: tuple[tree.Expression, ...],
    value: Value,
    line: int,
) -> None:
    found = machine.evaluate(owner)
    if isinstance(found, dict) and len(nodes) == 1:
        key = machine.evaluate(nodes[0])
        if not isinstance(key, str):
            raise Unread(say("a key of this kind is not read"))
        found[key] = value
        return
    if isinstance(found, (Pose, Robot)):
        raise refused(line, say("an element of a pose or robot is set; make it with its numbers"))
    if isinstance(found, Items):
        _set_item(machine, found, nodes, value, line)
        return
    if not isinstance(found, Array):
        raise Unread(say("an element of a value of this kind is set"))
    made = _with(machine, found, nodes, value)
    _refuse_shared(machine, found, line)
    assign(machine, owner, made, line)


def _refuse_shared(machine: Statements, array: Array, line: int) -> None:
    """Refuse to change an array that a variable or a robot shares, or that is a slice.

    Raises:
        DHError: It is.
    """
    bound = [value for scope in machine.scopes for value in scope.values()]
    bound += [item for value in bound if isinstance(value, Items) for item in value.items]
    names = sum(value is array for value in bound)
    views = any(isinstance(value, Array) and value.view_of is array for value in bound)
    held = any(array in (other, other.view_of) for r in machine.robots for other in r.held)
    if array.view_of is not None or names > 1 or views or held:
        raise refused(
            line,
            say(
                "an array is changed that another variable, or the robot, shares; make"
                " it with its numbers before it is used"
            ),
        )


def _set_item(
    machine: Statements,
    items: Items,
    nodes: tuple[tree.Expression, ...],
    value: Value,
    line: int,
) -> None:
    if items.robot is not None:
        raise refused(
            line, say("the links of a robot are changed after it was made; change them first")
        )
    if items.is_tuple or len(nodes) != 1:
        raise Unread(say("an item of this list is set"))
    (key,) = machine.keys_of(items, nodes)
    if isinstance(key, Several):
        if key.span is None:
            raise Unread(say("items of a list are set by a list of positions"))
        items.items[key.span] = machine.iterate(value)
    else:
        items.items[key] = value


def remove(machine: Statements, target: tree.Expression, line: int) -> None:
    """Remove elements: ``del L[0]`` and ``L(2) = []``.

    Raises:
        Unread: The target is not read.
        DHError: It changes the links of a robot.
    """
    if isinstance(target, tree.Apply):
        owner, nodes = target.function, target.arguments
    elif isinstance(target, tree.Index):
        owner, nodes = target.owner, target.keys
    elif isinstance(target, tree.Attribute):
        holder = machine.evaluate(target.owner)
        if isinstance(holder, Instance) and not is_part(holder.attributes.get(target.name)):
            holder.attributes.pop(target.name, None)
            return
        raise refused(line, say(".{target} is deleted, which is not read", target=target.name))
    else:
        raise Unread(say("what is deleted is not read"))
    found = machine.evaluate(owner)
    if isinstance(found, Items):
        if found.robot is not None:
            raise refused(line, say("the links of a robot are changed after it was made"))
        key = _flat(machine.keys_of(found, nodes))
        if machine.is_matlab:
            assign(machine, owner, without_items(found, key), line)
        else:
            found.items[:] = without_items(found, key).items
        return
    if isinstance(found, Array) and machine.is_matlab:
        assign(machine, owner, _without(machine, found, nodes), line)
        return
    raise Unread(say("an element of a value of this kind is removed"))


def _without(machine: Statements, array: Array, nodes: tuple[tree.Expression, ...]) -> Array:
    keys = machine.keys_of(array, nodes)
    rows, columns = array.shape
    if len(keys) == 1 and rows == 1:
        keys = [Several((0,)), keys[0]]
    if len(keys) != 2:
        raise Unread(say("elements of a matrix are removed by one index"))
    first, second = (set(key.positions) if isinstance(key, Several) else {key} for key in keys)
    if len(first) == rows:
        kept = tuple(tuple(e for c, e in enumerate(row) if c not in second) for row in array.rows)
        return Array(kept, line=array.line)
    if len(second) == columns:
        return Array(tuple(row for r, row in enumerate(array.rows) if r not in first))
    raise Unread(say("a part of a matrix is removed"))


def augment(
    machine: Statements, target: tree.Expression, symbol: str, node: tree.Expression, line: int
) -> None:
    """Follow ``target += value``: lists of Python change themselves."""
    if symbol == "+" and not machine.is_matlab:
        before = machine.evaluate(target)
        if isinstance(before, Items) and not before.is_tuple:
            value = machine.evaluate(node)
            if before.robot is not None:
                raise refused(line, say("the links of a robot are changed after it was made"))
            if not isinstance(value, (Items, Array)):
                why = say(" ({why})", why=value.why) if isinstance(value, Opaque) else ""
                raise refused(
                    line, say("a list is extended by a value that is not known{why}", why=why)
                )
            before.items += machine.iterate(value)
            return
        if isinstance(before, Array) and not isinstance(target, tree.Index):
            _refuse_shared(machine, before, line)
    elif not machine.is_matlab:
        before = machine.evaluate(target)
        if isinstance(before, Array) and not isinstance(target, tree.Index):
            _refuse_shared(machine, before, line)
        if isinstance(before, Items) and symbol == "*":
            raise Unread(say("*= of a list is not read"))
    value = machine.evaluate(tree.Binary(line, symbol, target, node))
    assign(machine, target, value, line)
