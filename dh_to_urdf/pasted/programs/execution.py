"""Statements of a program of robots: what they do to links and robots, or their refusal."""

from __future__ import annotations

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import assignment, harmless, library, robots, tree
from dh_to_urdf.pasted.programs.evaluation import Expressions
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Array,
    Instance,
    Items,
    Opaque,
    Robot,
    Tree,
    Unread,
    UserClass,
    UserFunction,
    Value,
    is_part,
    number,
)

MAX_CALLS = 12
"""Calls of functions of the program within one another."""


class _Returned(Exception):
    """A function returns."""

    def __init__(self, value: Value, line: int) -> None:
        self.value = value
        self.line = line


class _Left(Exception):
    """A loop is left, or goes on with its next run."""

    def __init__(self, word: str, line: int) -> None:
        self.word = word
        self.line = line


class Statements(Expressions):
    """Follows the statements of a program.

    Attributes:
        loose: Values of expressions that stand alone.
        passed: Lines of statements that were passed over, and why.
    """

    loose: list[Value]
    passed: list[tuple[int, str]]

    def follow(self, program: tree.Program) -> None:
        """Follow a program from its first statement to its last.

        Raises:
            DHError: A statement touches a link or a robot and is not read.
        """
        self.loose, self.passed = [], []
        if self.is_matlab:
            for statement in program.statements:
                if isinstance(statement, tree.Define):
                    self.functions[statement.name] = UserFunction(statement)
        try:
            self.block(program.statements)
        except _Returned:
            return
        except _Left as left:
            raise refused(left.line, say("{left} outside a loop", left=left.word)) from None

    def block(self, statements: tuple[tree.Statement, ...]) -> None:
        """Follow statements in their order."""
        for statement in statements:
            self.step(statement.line)
            try:
                self._execute(statement)
            except Unread as error:
                self._pass_over(statement, str(error))

    def _pass_over(self, statement: tree.Statement, why: str) -> None:
        """Skip a statement that is not read; what it sets is not known after it.

        Raises:
            DHError: It touches a link or a robot.
        """
        if self.touches(statement) and not self._only_looks(statement):
            raise refused(
                statement.line,
                say("{why}; this statement touches a link or a robot, and is not read", why=why),
            )
        self.passed.append((statement.line, why))
        for node in tree.nodes_of(statement):
            if isinstance(node, tree.Assign):
                for target in node.targets:
                    self._forget(target, why, node.line)
            elif isinstance(node, tree.Loop):
                self._forget(node.target, why, node.line)

    def _forget(self, target: tree.Expression, why: str, line: int) -> None:
        """Make a variable unknown."""
        if isinstance(target, tree.Listed):
            for part in target.items:
                self._forget(part, why, line)
            return
        root: tree.Expression = target
        while isinstance(root, (tree.Attribute, tree.Index, tree.Apply)):
            root = root.function if isinstance(root, tree.Apply) else root.owner
        if isinstance(root, tree.Name):
            value = self.scopes[0].get(root.name)
            if isinstance(value, Instance) and isinstance(target, tree.Attribute):
                value.attributes[target.name] = Opaque(why, line)
            elif not isinstance(value, Instance):
                self.scopes[0][root.name] = Opaque(why, line)

    def touches(self, node: tree.Node) -> bool:
        """Return whether a link or a robot, or what makes one, occurs in a node."""
        for part in tree.nodes_of(node):
            if isinstance(part, tree.Name):
                if part.name in library.CONSTRUCTORS:
                    return True
                value = next((s[part.name] for s in self.scopes if part.name in s), None)
                if is_part(value) or (isinstance(value, UserClass) and _is_robots(value)):
                    return True
            elif isinstance(part, tree.Attribute) and part.name in library.CONSTRUCTORS:
                return True
        return False

    def _only_looks(self, node: tree.Node) -> bool:
        """Return whether a node is an expression of functions that change nothing."""
        if isinstance(node, (tree.Loop, tree.Branch)):
            inside = node.body if isinstance(node, tree.Loop) else (*node.yes, *node.no)
            head = node.source if isinstance(node, tree.Loop) else node.test
            looks = self._only_looks(tree.Evaluate(node.line, head))
            if isinstance(node, tree.Loop) and self.touches(node.target):
                return False
            return looks and all(self._only_looks(part) for part in inside)
        if not isinstance(node, (tree.Evaluate, tree.Assign)):
            return False
        if isinstance(node, tree.Assign):
            if not all(isinstance(target, tree.Name) for target in node.targets):
                return False
            if any(self.touches(target) for target in node.targets):
                return False
        for part in tree.nodes_of(node):
            if isinstance(part, tree.Apply):
                function = part.function
                if isinstance(function, (tree.Name, tree.Attribute)):
                    name = function.name
                    if name in harmless.FUNCTIONS or name in library.PURE:
                        continue
                    if self.is_matlab and isinstance(function, tree.Name):
                        value = next((s[name] for s in self.scopes if name in s), None)
                        if isinstance(value, (Items, Array, Sum)):
                            continue
                    if self.is_matlab and name in ("links", "base", "tool", "offset", "qlim"):
                        continue
                return False
            if isinstance(part, tree.Name) and part.name in library.CONSTRUCTORS:
                return False
        return True

    def _execute(self, statement: tree.Statement) -> None:
        match statement:
            case tree.Assign():
                self._assign(statement)
            case tree.Evaluate(value=value):
                self._evaluate_alone(value)
            case tree.Delete(targets=targets):
                self._delete(targets)
            case tree.Branch():
                self._branch(statement)
            case tree.Loop():
                self._loop(statement)
            case tree.Return(value=value):
                raise _Returned(self.evaluate(value) if value else None, statement.line)
            case tree.Define(name=name):
                found = UserFunction(statement, tuple(self.scopes))
                if self.is_matlab:
                    self.functions[name] = UserFunction(statement)
                else:
                    self.scopes[0][name] = found
            case tree.DefineClass():
                self._class(statement)
            case tree.Import(names=names):
                for name, dotted in names:
                    self.imports[name] = dotted
                    self.scopes[0].pop(name, None)
            case tree.Unknown(what="break" | "continue" as word):
                raise _Left(word, statement.line)
            case tree.Unknown(what="global" | "nonlocal" as word):
                if len(self.frames) > 0:
                    raise refused(
                        statement.line, say("{word} in a function is not read", word=word)
                    )
            case tree.Unknown(what="raise"):
                raise refused(statement.line, say("the program stops here with an error"))
            case tree.Unknown(what=what):
                raise Unread(say("{what} is not read", what=what))

    def _class(self, statement: tree.DefineClass) -> None:
        parents = tuple(
            self.look_up(parent.name) if isinstance(parent, tree.Name) else self.evaluate(parent)
            for parent in statement.parents
            if isinstance(parent, (tree.Name, tree.Attribute))
        )
        made = UserClass(statement, parents, tuple(self.scopes))
        if self.is_matlab:
            self.functions[statement.name] = made
        self.scopes[0][statement.name] = made

    def class_attributes(self, of: UserClass, instance: Instance) -> None:
        """Give an object what the body of its class sets."""
        for parent in of.parents:
            if isinstance(parent, UserClass):
                self.class_attributes(parent, instance)
        outer, self.scopes = self.scopes, [instance.attributes, *of.scopes]
        try:
            self.block(
                tuple(s for s in of.definition.body if isinstance(s, (tree.Assign, tree.Evaluate)))
            )
        finally:
            self.scopes = outer

    def _assign(self, statement: tree.Assign) -> None:
        targets, line = statement.targets, statement.line
        if statement.symbol:
            assignment.augment(self, targets[0], statement.symbol, statement.value, line)
            return
        target = targets[0]
        given = statement.value
        empty = isinstance(given, tree.Matrix) and not given.rows and not given.is_cell
        if self.is_matlab and empty and isinstance(target, (tree.Apply, tree.Index)):
            assignment.remove(self, target, line)
            return
        if isinstance(target, tree.Listed):
            self.wanted = len(target.items)
        try:
            value = self.copied(self.evaluate(statement.value))
        finally:
            self.wanted = 1
        for place in targets:
            assignment.assign(self, place, value, line)

    def _evaluate_alone(self, node: tree.Expression) -> None:
        if (
            isinstance(node, tree.Name)
            and self.is_matlab
            and not any(node.name in scope for scope in self.scopes)
        ):
            self._bare_word(node)
            return
        if isinstance(node, tree.Text):
            return
        value = self.evaluate(node)
        if is_part(value) or isinstance(value, (Array, Items)):
            self.loose.append(value)

    def _bare_word(self, node: tree.Name) -> None:
        """Follow a word of MATLAB alone: a function of the text, or a script that is not read."""
        if node.name in self.functions or node.name in library.CONSTRUCTORS:
            value = self.evaluate(node)
            if is_part(value):
                self.loose.append(value)
            return
        if node.name in harmless.WORDS or node.name in harmless.FUNCTIONS:
            return
        if self.robots or self.links or self.trees:
            raise refused(
                node.line,
                say(
                    "{node} is a script or function that is not in the text; it may change"
                    " the robot",
                    node=node.name,
                ),
            )

    def _delete(self, targets: tuple[tree.Expression, ...]) -> None:
        if not targets:
            self.scopes[0].clear()
            self.loose.clear()
        for target in targets:
            if isinstance(target, tree.Name):
                self.scopes[0].pop(target.name, None)
            else:
                assignment.remove(self, target, target.line)

    def _branch(self, statement: tree.Branch) -> None:
        try:
            truth = self.truth(self.evaluate(statement.test))
        except Unread as error:
            raise Unread(say("whether this if holds is not known ({error})", error=error)) from None
        self.block(statement.yes if truth else statement.no)

    def _loop(self, statement: tree.Loop) -> None:
        try:
            values = self.iterate(self.evaluate(statement.source))
        except Unread as error:
            raise Unread(say("a loop is not run ({error})", error=error)) from None
        for value in values:
            self.bind(statement.target, value)
            try:
                self.block(statement.body)
            except _Left as left:
                if left.word == "break":
                    return

    def run_function(
        self,
        function: UserFunction,
        arguments: list[Value],
        keywords: dict[str, Value],
        line: int,
        wanted: int = 1,
        instance: Instance | None = None,
    ) -> Value:
        """Return what a function of the program returns.

        Args:
            function: The function.
            arguments: Its arguments.
            keywords: Its named arguments.
            line: Where it is called.
            wanted: Number of outputs that MATLAB asks for.
            instance: The object that a constructor of MATLAB makes.

        Raises:
            Unread: Its arguments do not fit.
            DHError: A statement in it touches a link or a robot and is not read.
        """
        definition = function.definition
        if len(self.frames) >= MAX_CALLS:
            raise refused(
                line, say("{definition}() calls itself too deeply", definition=definition.name)
            )
        scope = self._bound(definition, arguments, keywords)
        if self.is_matlab:
            scope["nargout"] = number(wanted)
        if instance is not None and definition.outputs:
            scope[definition.outputs[0]] = instance
        outer = self.scopes
        self.scopes = [scope, *function.scopes]
        self.frames.append(function)
        try:
            self.block(definition.body)
        except _Returned as returned:
            if not self.is_matlab:
                return returned.value
        except _Left as left:
            raise refused(left.line, say("{left} outside a loop", left=left.word)) from None
        finally:
            self.scopes = outer
            self.frames.pop()
        if not definition.outputs:
            return None
        outputs = [
            scope.get(name, Opaque(say("output {name} is not set", name=name), line))
            for name in definition.outputs
        ]
        return Items(outputs[:wanted], is_tuple=True) if wanted > 1 else outputs[0]

    def _bound(
        self, definition: tree.Define, arguments: list[Value], keywords: dict[str, Value]
    ) -> dict[str, Value]:
        """Return the names of a function's arguments with their values."""
        names = [name for name, _ in definition.arguments]
        if not definition.is_plain:
            raise Unread(
                say(
                    "{definition}() takes arguments of a form that is not read",
                    definition=definition.name,
                )
            )
        if len(arguments) > len(names) or any(key not in names for key in keywords):
            raise Unread(
                say(
                    "{definition}() is called with other arguments than it has",
                    definition=definition.name,
                )
            )
        scope: dict[str, Value] = dict(zip(names, arguments, strict=False))
        scope.update(keywords)
        for name, default in definition.arguments:
            if name not in scope and default is not None:
                scope[name] = self.evaluate(default)
        if self.is_matlab:
            scope["nargin"] = number(len(arguments))
        return scope

    def assigned(self, name: str, value: Value) -> None:
        """Give a variable its value; a number that the user gives wins."""
        key = name.replace("_", "")
        if isinstance(value, Sum) and self.given.get(key) is not None:
            return
        for found in self.titled(value):
            found.title = found.title or name
        self.scopes[0][name] = value

    @staticmethod
    def titled(value: Value) -> list[Robot | Tree]:
        """Return the robots that a variable names."""
        if isinstance(value, Instance) and value.robot is not None:
            return [value.robot]
        return [value] if isinstance(value, (Robot, Tree)) else []


def _is_robots(value: UserClass) -> bool:
    return any(getattr(parent, "name", "") in robots.CLASSES for parent in value.parents)
