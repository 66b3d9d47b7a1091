"""Expressions of MATLAB and Octave, by recursive descent over tokens."""

from __future__ import annotations

from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import tree
from dh_to_urdf.pasted.programs.tree import Expression
from dh_to_urdf.pasted.source_tokens import Token

_LEVELS: tuple[tuple[str, ...], ...] = (
    ("||",),
    ("&&",),
    ("|",),
    ("&",),
    ("==", "~=", "!=", "<", "<=", ">", ">="),
)
_SUMS = ("+", "-")
_PRODUCTS = ("*", "/", "\\", ".*", "./", ".\\")
_POWERS = ("^", ".^")
_TRANSPOSES = ("'", ".'")
_CLOSING = {"(": ")", "[": "]", "{": "}"}
_SPELLINGS = {"~=": "!=", "||": "or", "&&": "and", "|": "or", "&": "and"}


class MatlabExpressions:
    """Reads expressions from a list of tokens."""

    def __init__(self, tokens: list[Token]) -> None:
        self.tokens = tokens
        self.position = 0
        self.depth = 0
        self.count = 0
        self.in_matrix = False
        """Whether blanks part elements here."""
        self.in_brackets = False
        """Whether line ends are blanks here."""

    @property
    def token(self) -> Token:
        """Return the next token."""
        while self.in_brackets and self.tokens[self.position].kind == "newline":
            self.position += 1
        return self.tokens[self.position]

    def fail(self, what: str, token: Token | None = None) -> DHSyntaxError:
        """Return an error with the line."""
        line = (token or self.token).line
        return DHSyntaxError.single((), say("line {line}: {what}", line=line, what=what))

    def symbol(self, *symbols: str) -> str | None:
        """Take one of these symbols if it is next."""
        token = self.token
        if token.kind == "symbol" and token.text in symbols:
            self.position += 1
            return token.text
        return None

    def expression(self) -> Expression:
        """Return an expression."""
        self.depth += 1
        self.count += 1
        if self.depth > tree.MAX_DEPTH:
            raise self.fail(say("brackets are nested too deeply"))
        if self.count > tree.MAX_NODES:
            raise DHError.single((), say("the program is too long for a table"))
        found = self._level(0)
        self.depth -= 1
        return found

    def _operator(self, symbols: tuple[str, ...]) -> str | None:
        """Take an operator, unless it starts the next element of a matrix."""
        token = self.token
        if token.kind != "symbol" or token.text not in symbols:
            return None
        if self.in_matrix and token.spaced:
            following = self.tokens[self.position + 1]
            if not following.spaced and following.kind != "newline" and token.text in _SUMS:
                return None
        self.position += 1
        return token.text

    def _level(self, level: int) -> Expression:
        if level == len(_LEVELS):
            return self._range()
        left = self._level(level + 1)
        while True:
            line = self.token.line
            symbol = self._operator(_LEVELS[level])
            if symbol is None:
                return left
            right = self._level(level + 1)
            left = tree.Binary(line, _SPELLINGS.get(symbol, symbol), left, right)

    def _range(self) -> Expression:
        line = self.token.line
        first = self._sum()
        if not self._operator((":",)):
            return first
        second = self._sum()
        if self._operator((":",)):
            return tree.Slice(line, first, self._sum(), second)
        return tree.Slice(line, first, second, None)

    def _sum(self) -> Expression:
        left = self._product()
        while True:
            line = self.token.line
            symbol = self._operator(_SUMS)
            if symbol is None:
                return left
            left = tree.Binary(line, symbol, left, self._product())

    def _product(self) -> Expression:
        left = self._signed()
        while True:
            line = self.token.line
            symbol = self._operator(_PRODUCTS)
            if symbol is None:
                return left
            left = tree.Binary(line, symbol, left, self._signed())

    def _signed(self) -> Expression:
        signs: list[tuple[int, str]] = []
        while True:
            line = self.token.line
            sign = self.symbol("-", "+", "~", "!", "++", "--")
            if sign is None:
                break
            signs += [(line, letter) for letter in sign]
            if len(signs) > tree.MAX_DEPTH:
                raise self.fail(say("the signs are nested too deeply"))
        found = self._power()
        for line, sign in reversed(signs):
            found = tree.Unary(line, "not" if sign in "~!" else sign, found)
        return found

    def _power(self) -> Expression:
        left = self._postfix()
        while True:
            line = self.token.line
            symbol = self._operator(_POWERS)
            if symbol is None:
                return left
            sign = self.symbol("-", "+")
            right = self._postfix()
            if sign == "-":
                right = tree.Unary(line, "-", right)
            left = tree.Binary(line, symbol, left, right)

    def _postfix(self) -> Expression:
        found = self._atom()
        while True:
            token = self.token
            parted = self.in_matrix and token.spaced
            if token.kind != "symbol" or parted:
                return found
            if token.text == "(":
                found = tree.Apply(token.line, found, self._inside("("))
            elif token.text == "{":
                found = tree.Index(token.line, found, self._inside("{"))
            elif token.text in _TRANSPOSES:
                self.position += 1
                found = tree.Unary(token.line, "'", found)
            elif token.text == "." and not self.tokens[self.position + 1].spaced:
                found = self._field(found)
            else:
                return found
            self.count += 1

    def _field(self, owner: Expression) -> Expression:
        self.position += 1
        token = self.token
        if token.kind == "word":
            self.position += 1
            return tree.Attribute(token.line, owner, token.text)
        if token.text == "(":
            return tree.Unread(token.line, say("field by name"), (owner, *self._inside("(")))
        raise self.fail(say("{token} after a dot", token=quoted(token.text)))

    def _inside(self, opening: str) -> tuple[Expression, ...]:
        """Return the arguments or indices between brackets."""
        opened = self.tokens[self.position]
        self.position += 1
        outer = self.in_matrix, self.in_brackets
        self.in_matrix, self.in_brackets = False, True
        found: list[Expression] = []
        closing = _CLOSING[opening]
        while not self._closes(closing, opened):
            found.append(self._argument())
            if not self.symbol(",") and not (
                self.token.kind == "symbol" and self.token.text == closing
            ):
                raise self._unexpected(opened)
        self.in_matrix, self.in_brackets = outer
        return tuple(found)

    def _closes(self, closing: str, opened: Token) -> bool:
        if self.token.kind == "end":
            raise self.fail(say("{opened} is never closed", opened=opened.text), opened)
        return self.symbol(closing) is not None

    def _unexpected(self, opened: Token) -> DHSyntaxError:
        if self.token.kind == "end":
            return self.fail(say("{opened} is never closed", opened=opened.text), opened)
        return self.fail(say("{token} is not expected", token=quoted(self.token.text)))

    def _argument(self) -> Expression:
        token = self.token
        following = self.tokens[self.position + 1]
        if token.text == ":" and token.kind == "symbol" and following.text in (",", ")", "}"):
            self.position += 1
            return tree.Slice(token.line, None, None, None)
        if token.kind == "word" and following.text == "=" and following.kind == "symbol":
            self.position += 2
            return tree.Unread(token.line, f"{token.text}=", (self.expression(),))
        return self.expression()

    def _atom(self) -> Expression:
        token = self.token
        self.position += 1
        if token.kind == "number":
            return tree.Number(token.line, float(token.text.lower().replace("d", "e")), token.text)
        if token.kind == "string":
            return tree.Text(token.line, token.text)
        if token.kind == "word":
            return self._word(token)
        if token.text == "(":
            outer = self.in_matrix, self.in_brackets
            self.in_matrix, self.in_brackets = False, True
            found = self.expression()
            if not self._closes(")", token):
                raise self._unexpected(token)
            self.in_matrix, self.in_brackets = outer
            return found
        if token.text in ("[", "{"):
            return self._matrix(token)
        if token.text == "@":
            return self._handle(token)
        self.position -= 1
        if token.kind in ("newline", "end"):
            raise self.fail(say("the expression ends too early"))
        raise self.fail(say("{token} is not expected", token=quoted(token.text)))

    def _word(self, token: Token) -> Expression:
        if token.text == "end":
            return tree.End(token.line)
        if token.text in ("true", "false"):
            return tree.Constant(token.line, token.text == "true")
        return tree.Name(token.line, token.text)

    def _handle(self, token: Token) -> Expression:
        """Return a function handle or an anonymous function, which is not read."""
        if self.token.text == "(":
            arguments = self._inside("(")
            return tree.Unread(
                token.line, say("anonymous function"), (*arguments, self.expression())
            )
        return tree.Unread(token.line, say("function handle"), (self._postfix(),))

    def _matrix(self, opened: Token) -> Expression:
        closing = _CLOSING[opened.text]
        outer = self.in_matrix, self.in_brackets
        self.in_matrix, self.in_brackets = True, False
        self.depth += 1
        if self.depth > tree.MAX_DEPTH:
            raise self.fail(say("brackets are nested too deeply"), opened)
        rows: list[tuple[Expression, ...]] = []
        row: list[Expression] = []
        while True:
            token = self.token
            if token.kind == "newline" or (token.kind == "symbol" and token.text == ";"):
                self.position += 1
                if row:
                    rows.append(tuple(row))
                row = []
            elif token.kind == "symbol" and token.text == ",":
                self.position += 1
            elif self._closes(closing, opened):
                break
            else:
                row.append(self.expression())
        if row:
            rows.append(tuple(row))
        self.depth -= 1
        self.in_matrix, self.in_brackets = outer
        return tree.Matrix(opened.line, tuple(rows), opened.text == "{")
