"""Python text -> syntax tree, by the standard ``ast``; nothing is run or compiled."""

from __future__ import annotations

import ast
import io
import re
import textwrap
import tokenize
from itertools import pairwise

from dh_to_urdf.errors import DHError, DHSyntaxError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import tree
from dh_to_urdf.pasted.programs.tree import Comment, Expression, Program, Statement

_OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
    ast.MatMult: "@",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Is: "is",
    ast.IsNot: "is not",
    ast.In: "in",
    ast.NotIn: "not in",
    ast.And: "and",
    ast.Or: "or",
    ast.USub: "-",
    ast.UAdd: "+",
    ast.Not: "not",
    ast.Invert: "~",
}
_PREFIXES = re.compile(r"(?:[-+~(\[{]\s*|\bnot\b\s*|\blambda\b[^:\n]{0,20}:\s*){60}")
_RIGHT = re.compile(r"(?:\*\*[^*\n]{0,20}){60}|(?:\belse\b[^\n]{0,40}){60}")
_PROMPT = re.compile(r"^(?:>>>|\.\.\.|In \[\d{1,4}\]:)[ ]?", re.MULTILINE)
_ESCAPE = re.compile(r"\\(?![\n'\"\\])")


def read_python(text: str) -> Program:
    """Return the syntax tree of a Python text.

    Args:
        text: The text; prompts ``>>>`` are taken off.

    Raises:
        DHSyntaxError: It is no Python, with the line.
        DHError: It is nested too deeply or too long.
    """
    if _PREFIXES.search(text) or _RIGHT.search(text):
        raise DHSyntaxError.single((), say("the program is nested too deeply"))
    if _PROMPT.match(text.lstrip("\n")):
        text = _PROMPT.sub("", text)
    # Escapes say nothing here, and unknown ones would make the parser warn on stderr.
    text = textwrap.dedent(_ESCAPE.sub("/", text.replace("\r\n", "\n")))
    try:
        module = _parsed(text)
    except SyntaxError as error:
        raise DHSyntaxError.single(
            (), say("line {lineno}: {msg}", lineno=error.lineno or 1, msg=error.msg)
        ) from None
    except (ValueError, MemoryError, RecursionError):
        raise DHSyntaxError.single((), say("the program cannot be parsed")) from None
    reader = _Reader()
    return Program(reader.block(module.body, 0), _comments(text), is_matlab=False)


def _parsed(text: str) -> ast.Module:
    """Parse a text, whose first line may have lost the indent of the others."""
    try:
        return ast.parse(text)
    except IndentationError:
        first, line_end, rest = text.partition("\n")
        return ast.parse(first.lstrip() + line_end + textwrap.dedent(rest))


def _comments(text: str) -> tuple[Comment, ...]:
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(text).readline))
    except (tokenize.TokenError, SyntaxError):
        return ()
    return tuple(
        Comment(token.start[0], token.string.lstrip("# "))
        for token in tokens
        if token.type == tokenize.COMMENT
    )


class _Reader:
    """Turns nodes of ``ast`` into those of :mod:`tree`."""

    def __init__(self) -> None:
        self.count = 0

    def _note(self, node: ast.AST, depth: int) -> int:
        """Count a node; return its line."""
        self.count += 1
        line = getattr(node, "lineno", 1)
        if depth > tree.MAX_DEPTH:
            raise DHSyntaxError.single(
                (), say("line {line}: the program is nested too deeply", line=line)
            )
        if self.count > tree.MAX_NODES:
            raise DHError.single((), say("the program is too long for a table"))
        return int(line)

    def block(self, nodes: list[ast.stmt], depth: int) -> tuple[Statement, ...]:
        """Return statements."""
        return tuple(self.statement(node, depth + 1) for node in nodes)

    def statement(self, node: ast.stmt, depth: int) -> Statement:
        """Return one statement."""
        line = self._note(node, depth)
        match node:
            case ast.Assign(targets=targets, value=value):
                found = tuple(self.expression(target, depth) for target in targets)
                return tree.Assign(line, found, self.expression(value, depth))
            case ast.AnnAssign(target=target, value=annotated) if annotated is not None:
                return tree.Assign(
                    line, (self.expression(target, depth),), self.expression(annotated, depth)
                )
            case ast.AnnAssign() | ast.Pass() | ast.Assert():
                return tree.Import(line, ())
            case ast.AugAssign(target=target, op=op, value=value):
                symbol = _OPERATORS.get(type(op), "?")
                return tree.Assign(
                    line, (self.expression(target, depth),), self.expression(value, depth), symbol
                )
            case ast.Expr(value=value):
                return tree.Evaluate(line, self.expression(value, depth))
            case ast.Delete(targets=targets):
                return tree.Delete(line, tuple(self.expression(t, depth) for t in targets))
            case ast.If(test=test, body=body, orelse=orelse):
                return tree.Branch(
                    line,
                    self.expression(test, depth),
                    self.block(body, depth),
                    self.block(orelse, depth),
                )
            case ast.For(target=target, iter=source, body=body, orelse=[]):
                return tree.Loop(
                    line,
                    self.expression(target, depth),
                    self.expression(source, depth),
                    self.block(body, depth),
                )
            case ast.Return(value=returned):
                return tree.Return(line, self.expression(returned, depth) if returned else None)
            case ast.FunctionDef():
                return self._function(node, line, depth)
            case ast.ClassDef(name=name, bases=bases, body=body):
                parents = tuple(self.expression(base, depth) for base in bases)
                return tree.DefineClass(line, name, parents, self.block(body, depth))
            case ast.Import(names=names):
                return tree.Import(
                    line,
                    tuple((n.asname or n.name.partition(".")[0], _module(n)) for n in names),
                )
            case ast.ImportFrom(names=names, module=module):
                return tree.Import(
                    line,
                    tuple((n.asname or n.name, f"{module}.{n.name}") for n in names),
                )
        return tree.Unknown(line, _title(node), self._parts(node, depth))

    def _function(self, node: ast.FunctionDef, line: int, depth: int) -> Statement:
        given = node.args
        names = [argument.arg for argument in (*given.posonlyargs, *given.args)]
        defaults: list[ast.expr | None] = [None] * (len(names) - len(given.defaults))
        pairs = list(zip(names, [*defaults, *given.defaults], strict=True))
        pairs += [
            (a.arg, value) for a, value in zip(given.kwonlyargs, given.kw_defaults, strict=True)
        ]
        return tree.Define(
            line,
            node.name,
            tuple((name, self.expression(v, depth) if v else None) for name, v in pairs),
            self.block(node.body, depth),
            is_plain=given.vararg is None and given.kwarg is None and not node.decorator_list,
        )

    def _parts(self, node: ast.AST, depth: int) -> tuple[tree.Node, ...]:
        parts: list[tree.Node] = []
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr):
                parts.append(self.expression(child, depth))
            elif isinstance(child, ast.stmt):
                parts.append(self.statement(child, depth + 1))
            else:
                parts.extend(self._parts(child, depth + 1))
        return tuple(parts)

    def expression(self, node: ast.expr, depth: int) -> Expression:
        """Return one expression."""
        depth += 1
        line = self._note(node, depth)
        match node:
            case ast.Constant(value=bool() | None as value):
                return tree.Constant(line, value)
            case ast.Constant(value=int() | float() as value):
                return _number(line, value)
            case ast.Constant(value=str() as value):
                return tree.Text(line, value)
            case ast.Name(id=name):
                return tree.Name(line, name)
            case ast.Attribute(value=owner, attr=name):
                return tree.Attribute(line, self.expression(owner, depth), name)
            case ast.Call(func=function, args=arguments, keywords=keywords):
                return tree.Apply(
                    line,
                    self.expression(function, depth),
                    tuple(self.expression(argument, depth) for argument in arguments),
                    tuple((k.arg or "**", self.expression(k.value, depth)) for k in keywords),
                )
            case ast.Subscript(value=owner, slice=ast.Tuple(elts=keys)):
                return tree.Index(
                    line,
                    self.expression(owner, depth),
                    tuple(self.expression(key, depth) for key in keys),
                )
            case ast.Subscript(value=owner, slice=key):
                return tree.Index(
                    line, self.expression(owner, depth), (self.expression(key, depth),)
                )
            case ast.Slice(lower=start, upper=stop, step=step):
                bounds = [self.expression(p, depth) if p else None for p in (start, stop, step)]
                return tree.Slice(line, *bounds)
            case ast.UnaryOp(op=op, operand=operand):
                return tree.Unary(line, _OPERATORS[type(op)], self.expression(operand, depth))
            case ast.Starred(value=value):
                return tree.Unary(line, "*", self.expression(value, depth))
            case ast.BinOp():
                return self._binary(node, line, depth)
            case ast.BoolOp(op=op, values=values):
                found = [self.expression(value, depth) for value in values]
                joined = found[0]
                for other in found[1:]:
                    joined = tree.Binary(line, _OPERATORS[type(op)], joined, other)
                return joined
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                return tree.Binary(
                    line,
                    _OPERATORS[type(op)],
                    self.expression(left, depth),
                    self.expression(right, depth),
                )
            case ast.List(elts=items) | ast.Tuple(elts=items):
                found = [self.expression(item, depth) for item in items]
                return tree.Listed(line, tuple(found), isinstance(node, ast.Tuple))
            case ast.Dict(keys=names, values=values) if all(names):
                pairs = zip(names, values, strict=True)
                return tree.Pairs(
                    line,
                    tuple(
                        (self.expression(k, depth), self.expression(v, depth))
                        for k, v in pairs
                        if k is not None
                    ),
                )
            case ast.IfExp(test=test, body=yes, orelse=no):
                return tree.Choice(
                    line,
                    self.expression(test, depth),
                    self.expression(yes, depth),
                    self.expression(no, depth),
                )
            case (
                ast.ListComp(elt=item, generators=loops)
                | ast.GeneratorExp(elt=item, generators=loops)
            ) if len(loops) < 5 and not any(loop.is_async for loop in loops):
                return self._comprehension(item, loops, line, depth)
        parts = self._parts(node, depth)
        return tree.Unread(line, _title(node), parts)  # type: ignore[arg-type]

    def _comprehension(
        self, item: ast.expr, loops: list[ast.comprehension], line: int, depth: int
    ) -> Expression:
        """Return a comprehension; further loops are comprehensions in it, spread out."""
        found = self.expression(item, depth)
        for k, loop in enumerate(reversed(loops)):
            found = tree.Comprehension(
                line,
                tree.Unary(line, "*", found) if k else found,
                self.expression(loop.target, depth),
                self.expression(loop.iter, depth),
                tuple(self.expression(test, depth) for test in loop.ifs),
            )
        return found

    def _binary(self, node: ast.BinOp, line: int, depth: int) -> Expression:
        """Return a sum or a product; long sums go left without depth."""
        chain: list[tuple[ast.operator, ast.expr, int]] = []
        left: ast.expr = node
        while isinstance(left, ast.BinOp):
            chain.append((left.op, left.right, left.lineno))
            left = left.left
            self._note(left, depth)
        if len(chain) > 2000:
            raise DHSyntaxError.single((), say("line {line}: the sum is too long", line=line))
        found = self.expression(left, depth)
        for op, right, at in reversed(chain):
            symbol = _OPERATORS.get(type(op), "?")
            found = tree.Binary(at, symbol, found, self.expression(right, depth))
        return found


def _number(line: int, value: float) -> Expression:
    try:
        return tree.Number(line, float(value), str(value) if abs(value) < 1e15 else "")
    except OverflowError:
        return tree.Number(line, float("inf"), "")


def _module(alias: ast.alias) -> str:
    return alias.name if alias.asname else alias.name.partition(".")[0]


def _title(node: ast.AST) -> str:
    """Return ``while``, ``with``, ``lambda`` … for a message."""
    name = type(node).__name__.removesuffix("Stmt")
    words = [name[i:j] for i, j in pairwise([*_capitals(name), len(name)])]
    return " ".join(word.lower() for word in words)


def _capitals(name: str) -> list[int]:
    return [k for k, letter in enumerate(name) if letter.isupper()]
