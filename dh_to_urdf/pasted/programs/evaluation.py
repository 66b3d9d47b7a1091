"""Values of the expressions of a program."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from dh_to_urdf.cells.arithmetic import Sum, variable_of
from dh_to_urdf.cells.values import Values
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import arrays, attributes, calls, operators, tree
from dh_to_urdf.pasted.programs.indexing import (
    Key,
    Several,
    array_at,
    items_at,
    matlab_key,
    python_key,
)
from dh_to_urdf.pasted.programs.library import CONSTRUCTORS, KNOWN
from dh_to_urdf.pasted.programs.numbers import PI, real, whole
from dh_to_urdf.pasted.programs.operators import is_empty, robot_of
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    MAX_ITEMS,
    Array,
    Function,
    Instance,
    Items,
    Joint,
    Link,
    Method,
    Opaque,
    Pose,
    Robot,
    Tree,
    Unread,
    Unresolved,
    UserClass,
    UserFunction,
    Value,
    is_part,
    number,
)

MAX_STEPS = 60_000
"""Nodes that are evaluated."""
MAX_NESTED = 120
"""Evaluations within one another, calls of functions included."""
_CONSTANTS: dict[str, Value] = {
    **dict.fromkeys(("pi", "π", "PI", "Pi", "M_PI"), PI),
    "M_PI_2": Sum(angle=PI.angle / 2, has_angle=True),
    "M_PI_4": Sum(angle=PI.angle / 4, has_angle=True),
    "deg": Sum(angle=PI.angle / 180, has_angle=True),
    "inf": number(float("inf")),
    "Inf": number(float("inf")),
    "tau": Sum(angle=2 * PI.angle, has_angle=True),
}


class Expressions:
    """Evaluates expressions; statements are in :mod:`execution`.

    Attributes:
        is_matlab: Whether the program is MATLAB.
        given: Values of names that the user gives, which win over the program's.
        angle: Unit of bare angles as the user says it, or None.
        scopes: Names and their values, innermost first.
        warnings: What was assumed.
        robots: Every robot that was made.
        trees: Every ``rigidBodyTree`` that was made.
        joints: Every ``rigidBodyJoint`` that was made.
        links: Every link that was made.
    """

    def __init__(self, program: tree.Program, given: Values, angle: str | None) -> None:
        self.is_matlab = program.is_matlab
        self.given = given
        self.angle = angle
        self.scopes: list[dict[str, Value]] = [{}]
        self.imports: dict[str, str] = {}
        self.functions: dict[str, Value] = {}
        self.workspace = self.scopes[0]
        self.warnings: list[str] = []
        self.robots: list[Robot] = []
        self.trees: list[Tree] = []
        self.joints: list[Joint] = []
        self.links: list[Link] = []
        self.frames: list[UserFunction] = []
        self.wanted = 1
        self._sizes: list[tuple[int, ...]] = []
        self._steps = 0
        self._nested = 0

    def run_function(
        self,
        function: UserFunction,
        arguments: list[Value],
        keywords: dict[str, Value],
        line: int,
        wanted: int = 1,
        instance: Instance | None = None,
    ) -> Value:
        """Return what a function of the program returns; statements know how."""
        raise NotImplementedError

    def class_attributes(self, of: UserClass, instance: Instance) -> None:
        """Give an object what the body of its class sets; statements know how."""
        raise NotImplementedError

    def step(self, line: int) -> None:
        """Count one node.

        Raises:
            DHError: The program takes too long.
        """
        self._steps += 1
        if self._steps > MAX_STEPS:
            raise refused(line, say("the program takes too many steps to be read"))

    def evaluate(self, node: tree.Expression) -> Value:
        """Return the value of an expression.

        Raises:
            Unread: It has none here.
            DHError: It changes a link or a robot in a way that is not read.
        """
        self.step(node.line)
        self._nested += 1
        if self._nested > MAX_NESTED:
            raise refused(node.line, say("the program is nested too deeply"))
        try:
            return self._evaluate(node)
        finally:
            self._nested -= 1

    def _evaluate(self, node: tree.Expression) -> Value:
        match node:
            case tree.Number(value=value):
                return Sum(plain=value)
            case tree.Text(value=text) | tree.Constant(value=text):
                return text
            case tree.Name(name=name):
                return self._called(self.look_up(name), node.line)
            case tree.Attribute(owner=owner, name=name):
                return attributes.get(self, self.evaluate(owner), name, node.line)
            case tree.Apply():
                return self._apply(node)
            case tree.Index(owner=owner, keys=keys):
                return self.at(self.evaluate(owner), keys)
            case tree.Slice():
                return self._range(node)
            case tree.End():
                return self._end()
            case tree.Unary():
                return operators.unary(self, node)
            case tree.Binary():
                return operators.binary(self, node)
            case tree.Listed(items=items, is_tuple=is_tuple):
                return Items(list(self._spread(items)), is_tuple, line=node.line)
            case tree.Matrix():
                return self._matrix(node)
            case tree.Pairs(items=pairs):
                return {self._key_name(key): self.evaluate(value) for key, value in pairs}
            case tree.Choice(test=test, yes=yes, no=no):
                return self.evaluate(yes if self.truth(self.evaluate(test)) else no)
            case tree.Comprehension():
                return self._comprehension(node)
            case tree.Unread(what="joined str"):
                if not any(isinstance(part, tree.Apply) for part in tree.nodes_of(node)):
                    return Opaque(say("a text with values in it"), node.line)
        raise Unread(say("{node} is not read", node=getattr(node, "what", say("an expression"))))

    def _called(self, value: Value, line: int) -> Value:
        """Return what a name of MATLAB stands for: a function without parentheses is called."""
        if self.is_matlab and isinstance(value, (UserFunction, UserClass)):
            return calls.call(self, value, [], {}, line)
        if self.is_matlab and isinstance(value, Function) and value.name in CONSTRUCTORS:
            return calls.call(self, value, [], {}, line)
        return value

    def look_up(self, name: str) -> Value:
        """Return what a name stands for."""
        for scope in self.scopes:
            if name in scope:
                return scope[name]
        given = self.given.get(name.replace("_", ""))
        if given is not None:
            return given
        if name in self.functions:
            return self.functions[name]
        if name in self.imports:
            return self.library_name(self.imports[name])
        if name == "__name__":
            return "__main__"
        found = self.library_name(name)
        variable = variable_of(name.lower())
        if isinstance(found, Unresolved) and variable is not None:
            return Sum(terms=((variable, 1.0),))
        return found

    def library_name(self, dotted: str) -> Value:
        """Return what the last part of a dotted name stands for in the libraries."""
        name = dotted.rpartition(".")[2]
        if name in _CONSTANTS:
            return _CONSTANTS[name]
        return Function(name) if name in KNOWN else Unresolved(name)

    def _key_name(self, key: tree.Expression) -> str:
        if isinstance(key, tree.Name):
            return key.name
        value = self.evaluate(key)
        if isinstance(value, str):
            return value
        if isinstance(value, Sum) and value.is_plain:
            return f"{value.plain:g}"
        raise Unread(say("a key of this kind is not read"))

    def _spread(self, nodes: Sequence[tree.Expression]) -> Iterator[Value]:
        for node in nodes:
            if isinstance(node, tree.Unary) and node.symbol == "*":
                yield from self.iterate(self.evaluate(node.operand))
            else:
                yield self.evaluate(node)

    def iterate(self, value: Value) -> list[Value]:
        """Return what a loop over a value runs through.

        Raises:
            Unread: It is no list.
        """
        if isinstance(value, Items):
            return list(value.items)
        if isinstance(value, Array):
            if self.is_matlab:
                columns = list(zip(*value.rows, strict=True))
                if value.shape[0] == 1:
                    return [column[0] for column in columns]
                return [Array(tuple((element,) for element in c)) for c in columns]
            if value.flat:
                return list(value.elements)
            return [array_at(value, (k,), is_matlab=False) for k in range(len(value.rows))]
        if isinstance(value, dict):
            return list(value)
        if self.is_matlab and isinstance(value, Sum):
            return [value]
        raise Unread(say("what a loop runs through is not known"))

    def truth(self, value: Value) -> bool:
        """Return whether a value counts as true.

        Raises:
            Unread: It is not known.
        """
        if isinstance(value, bool) or value is None:
            return bool(value)
        if isinstance(value, (str, dict)):
            return bool(value)
        if isinstance(value, Items):
            return bool(value.items)
        return real(value) != 0.0

    def _range(self, node: tree.Slice) -> Value:
        """Return ``first:step:last`` of MATLAB as a row."""
        if node.start is None or node.stop is None or not self.is_matlab:
            raise Unread(say("a colon alone is not read here"))
        first, last = real(self.evaluate(node.start)), real(self.evaluate(node.stop))
        step = real(self.evaluate(node.step)) if node.step else 1.0
        if step == 0.0 or (last - first) / step > MAX_ITEMS:
            raise Unread(say("a range of this size is not read"))
        count = max(0, int((last - first) / step + 1e-10) + 1) if (last - first) / step >= 0 else 0
        return Array((tuple(number(first + k * step) for k in range(count)),))

    def _end(self) -> Value:
        if not self._sizes:
            raise Unread(say("end is not read here"))
        size = self._sizes[-1]
        return number(size[self._position] if self._position < len(size) else 1)

    _position = 0

    def keys_of(self, value: Value, nodes: Sequence[tree.Expression]) -> list[Key]:
        """Return the positions from 0 that indices pick in a value.

        Raises:
            Unread: They are not known.
        """
        sizes = _sizes(value, len(nodes))
        keys: list[Key] = []
        for position, node in enumerate(nodes):
            size = sizes[position] if position < len(sizes) else 1
            if isinstance(node, tree.Slice) and (node.start is None or not self.is_matlab):
                keys.append(self._slice(node, size))
                continue
            self._sizes.append(sizes)
            outer, self._position = self._position, position
            try:
                found = self.evaluate(node)
            finally:
                self._sizes.pop()
                self._position = outer
            if self.is_matlab:
                keys.append(matlab_key(found))
            elif isinstance(found, (Items, Array)):
                picked = [python_key(v, size) for v in self.iterate(found)]
                keys.append(Several(tuple(picked)))
            else:
                keys.append(python_key(found, size))
        return keys

    def _slice(self, node: tree.Slice, size: int) -> Several:
        parts = [
            None if part is None else whole(self.evaluate(part))
            for part in (node.start, node.stop, node.step)
        ]
        if parts[2] == 0:
            raise Unread(say("a slice has step 0"))
        span = slice(*parts)
        return Several(tuple(range(size))[span], span)

    def at(self, value: Value, nodes: Sequence[tree.Expression]) -> Value:
        """Return the part of a value that indices pick.

        Raises:
            Unread: The value has no such part.
        """
        if isinstance(value, Instance) and value.robot is not None:
            value = value.robot
        if isinstance(value, Function) and value.name == "r_":
            blocks = [[arrays.as_array(v) for v in map(self.evaluate, nodes)]]
            return Array(arrays.joined(blocks, nodes[0].line).rows, flat=True)
        if isinstance(value, dict):
            key = self._key_name(nodes[0])
            if key not in value:
                raise Unread(say("a key is not there"))
            return value[key]
        if isinstance(value, Robot) and not self.is_matlab:
            value = Items(list(value.links), robot=value)
        if isinstance(value, Pose) and self.is_matlab:
            value = arrays.of_matrix(value.matrix)
        if isinstance(value, (Link, Robot, bool, Sum)) and self.is_matlab:
            if all(not isinstance(k, Several) and k == 0 for k in self.keys_of(value, nodes)):
                return value
            raise Unread(say("an index beyond 1 of a single value"))
        if isinstance(value, Opaque):
            raise Unread(say("{why} (line {line})", why=value.why, line=value.line))
        if not isinstance(value, (Items, Array)):
            raise Unread(say("an index of a value of this kind is not read"))
        keys = self.keys_of(value, nodes)
        if isinstance(value, Array):
            return array_at(value, keys, is_matlab=self.is_matlab)
        if len(keys) == 2 and self.is_matlab and keys[0] in (0, Several((0,))):
            keys = keys[1:]
        if len(keys) != 1:
            raise Unread(say("two indices of a list"))
        return items_at(value, keys[0])

    def _apply(self, node: tree.Apply) -> Value:
        """Return the value of a call, or of an index of MATLAB."""
        if isinstance(node.function, tree.Attribute):
            owner = self.evaluate(node.function.owner)
            function: Value = attributes.get(
                self, owner, node.function.name, node.line, called=True
            )
        else:
            function = (
                self.look_up(node.function.name)
                if isinstance(node.function, tree.Name)
                else self.evaluate(node.function)
            )
        if not isinstance(function, (Function, Unresolved, UserFunction, UserClass, Method)):
            if self.is_matlab and not isinstance(function, Opaque):
                return self.at(function, node.arguments)
            if isinstance(function, Sum) and function.variable:
                function = Unresolved(function.variable[0])
        arguments, keywords = self._arguments(node)
        wanted, self.wanted = self.wanted, 1
        return calls.call(self, function, arguments, keywords, node.line, wanted)

    def _arguments(self, node: tree.Apply) -> tuple[list[Value], dict[str, Value]]:
        arguments: list[Value] = []
        keywords: dict[str, Value] = {}
        wanted, self.wanted = self.wanted, 1
        for part in node.arguments:
            if isinstance(part, tree.Unread) and part.what.endswith("="):
                keywords[part.what[:-1]] = self.evaluate(part.parts[0])
            elif isinstance(part, tree.Unary) and part.symbol == "*":
                arguments += self.iterate(self.evaluate(part.operand))
            elif isinstance(part, tree.Slice) and part.start is None and self.is_matlab:
                raise Unread(say("a colon is no argument"))
            else:
                arguments.append(self.copied(self.evaluate(part)))
        for key, value in node.keywords:
            if key == "**":
                found = self.evaluate(value)
                if not isinstance(found, dict):
                    raise Unread(say("** of a value that is no dictionary"))
                keywords.update(found)
            else:
                keywords[key] = self.evaluate(value)
        self.wanted = wanted
        return arguments, keywords

    def copied(self, value: Value) -> Value:
        """Return the list that MATLAB hands on, which is a copy."""
        if self.is_matlab and isinstance(value, Items):
            return Items(list(value.items), value.is_tuple, line=value.line)
        return value

    def _matrix(self, node: tree.Matrix) -> Value:
        rows = [[self.evaluate(part) for part in row] for row in node.rows]
        flat = [robot_of(value) for row in rows for value in row]
        if node.is_cell or any(is_part(value) for value in flat):
            items: list[Value] = []
            for value in flat:
                spread = isinstance(value, Items) and not node.is_cell
                items += value.items if isinstance(value, Items) and spread else [value]
            return Items([v for v in items if not is_empty(v) or node.is_cell], line=node.line)
        if flat and all(isinstance(value, str) for value in flat):
            return "".join(str(value) for value in flat)[:600]
        for value in flat:
            if isinstance(value, (str, dict)) or value is None:
                raise Unread(say("a matrix of texts and numbers is not read"))
        blocks = [[_block(value) for value in row] for row in rows]
        found = arrays.joined(blocks, node.line)
        if len(found.rows) == len(node.rows):
            found.lines = tuple(row[0].line for row in node.rows)
        return found

    def _comprehension(self, node: tree.Comprehension) -> Value:
        found: list[Value] = []
        for value in self.iterate(self.evaluate(node.source)):
            self.scopes.insert(0, {})
            try:
                self.bind(node.target, value)
                if all(self.truth(self.evaluate(test)) for test in node.tests):
                    found.extend(self._spread([node.item]))
            finally:
                self.scopes.pop(0)
            if len(found) > MAX_ITEMS:
                raise Unread(say("a list of this size is not read"))
        return Items(found, line=node.line)

    def bind(self, target: tree.Expression, value: Value) -> None:
        """Give names of a loop their values."""
        if isinstance(target, tree.Name):
            self.scopes[0][target.name] = value
            return
        if isinstance(target, tree.Listed):
            values = self.iterate(value)
            if len(values) == len(target.items):
                for part, item in zip(target.items, values, strict=True):
                    self.bind(part, item)
                return
        raise Unread(say("the target of a loop is not read"))


def _block(value: Value) -> Array:
    found = arrays.as_array(value)
    return Array(found.rows)


def _sizes(value: Value, count: int) -> tuple[int, ...]:
    """Return what ``end`` stands for at each of so many indices."""
    if isinstance(value, Items):
        return (len(value.items),) if count == 1 else (1, len(value.items))
    if isinstance(value, Array):
        if count == 1 and not value.flat:
            one_line = value.shape[0] * value.shape[1]
            return (one_line,)
        return (value.shape[1],) if value.flat else value.shape
    return (1,)
