"""MATLAB and Octave text -> syntax tree; nothing is run."""

from __future__ import annotations

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import tree
from dh_to_urdf.pasted.programs.harmless import COMMANDS
from dh_to_urdf.pasted.programs.matlab_expressions import MatlabExpressions
from dh_to_urdf.pasted.programs.matlab_tokens import matlab_tokens
from dh_to_urdf.pasted.programs.tree import Expression, Program, Statement
from dh_to_urdf.pasted.source_tokens import Token

_BLOCKS = ("while", "parfor", "switch", "try", "do", "unwind_protect", "spmd")
_ENDS = (
    "end",
    "endif",
    "endfor",
    "endfunction",
    "endwhile",
    "endclassdef",
    "endmethods",
    "endproperties",
    "end_try_catch",
    "endswitch",
    "until",
)
_SECTIONS = ("properties", "methods", "events", "enumeration")
_AUGMENTED = ("+=", "-=", "*=", "/=")


def read_matlab(text: str) -> Program:
    """Return the syntax tree of a MATLAB text.

    Raises:
        DHSyntaxError: It is no MATLAB, with the line.
        DHError: It is too long.
    """
    tokens, comments = matlab_tokens(text)
    statements = _MatlabStatements(tokens).program()
    return Program(statements, comments, is_matlab=True)


class _MatlabStatements(MatlabExpressions):
    """Reads statements from a list of tokens."""

    def program(self) -> tuple[Statement, ...]:
        statements = self.block(())
        while self.token.kind != "end":
            # An ``end`` too many closes nothing: functions in scripts may do without.
            self.position += 1
            statements += self.block(())
        return statements

    def block(self, stops: tuple[str, ...]) -> tuple[Statement, ...]:
        """Return statements up to ``end`` or another of these words, which is not taken."""
        self.depth += 1
        if self.depth > tree.MAX_DEPTH:
            raise self.fail(say("blocks are nested too deeply"))
        statements: list[Statement] = []
        while True:
            token = self.token
            if token.kind == "newline" or (token.kind == "symbol" and token.text in ";,"):
                self.position += 1
            elif token.kind == "end" or (
                token.kind == "word" and (token.text in stops or token.text in _ENDS)
            ):
                self.depth -= 1
                return tuple(statements)
            else:
                statements.append(self.statement())
                self.count += 1

    def _end(self) -> None:
        """Take the ``end`` of a block; a missing one at the end of the text is forgiven."""
        if self.token.kind == "word" and self.token.text in _ENDS:
            self.position += 1

    def statement(self) -> Statement:
        """Return one statement."""
        token = self.token
        if token.kind == "word":
            following = self.tokens[self.position + 1]
            match token.text:
                case "if":
                    return self._branch()
                case "for":
                    return self._loop()
                case "function":
                    return self._function()
                case "classdef":
                    return self._class()
                case "return" | "break" | "continue":
                    self.position += 1
                    if token.text == "return":
                        return tree.Return(token.line, None)
                    return tree.Unknown(token.line, token.text)
                case "global" | "persistent" | "import":
                    return self._command(token)
                case word if word in _BLOCKS and following.text not in ("=", "("):
                    return self._unread_block(token)
                case "while" | "switch" | "parfor":
                    return self._unread_block(token)
            if self._is_command(token, following):
                return self._command(token)
        return self._simple()

    def _is_command(self, token: Token, following: Token) -> bool:
        """Return whether a statement is a word with words after it: ``hold on``, ``syms a b``."""
        if not following.spaced or following.line != token.line:
            return False
        if following.kind in ("word", "number"):
            return True
        after = self.tokens[self.position + 2]
        return following.text == "-" and not after.spaced and after.kind == "word"

    def _command(self, token: Token) -> Statement:
        self.position += 1
        words: list[Token] = []
        while self.token.kind not in ("newline", "end") and self.token.text not in (";", ","):
            words.append(self.token)
            self.position += 1
        arguments = tuple(tree.Text(word.line, word.text) for word in words)
        named = tuple(tree.Name(w.line, w.text) for w in words if w.kind == "word")
        if token.text == "clear":
            everything = not named or named[0].name in ("all", "variables", "classes")
            return tree.Delete(token.line, () if everything else named)
        if token.text in ("global", "persistent"):
            return tree.Unknown(token.line, "global", named)
        if token.text in ("import", "syms", "sym"):
            return tree.Import(token.line, ())
        if token.text not in COMMANDS:
            raise self.fail(
                say("{token} with words after it is not read", token=quoted(token.text)), token
            )
        function = tree.Name(token.line, token.text)
        return tree.Evaluate(token.line, tree.Apply(token.line, function, arguments))

    def _simple(self) -> Statement:
        """Return an assignment or an expression."""
        start, line = self.position, self.token.line
        targets = self._outputs()
        if targets is None:
            self.position = start
            first = self.expression()
            token = self.token
            if token.kind == "symbol" and token.text == "=":
                self.position += 1
                return self._ended(tree.Assign(line, (first,), self._value()))
            if token.kind == "symbol" and token.text in _AUGMENTED:
                self.position += 1
                return self._ended(tree.Assign(line, (first,), self.expression(), token.text[0]))
            if token.kind == "symbol" and token.text in ("++", "--"):
                self.position += 1
                one = tree.Number(line, 1.0, "1")
                return self._ended(tree.Assign(line, (first,), one, token.text[0]))
            if isinstance(first, tree.Name) and first.name in ("clear", "clearvars"):
                return self._ended(tree.Delete(line, ()))
            return self._ended(tree.Evaluate(line, first))
        together = tree.Listed(line, targets, is_tuple=True)
        return self._ended(tree.Assign(line, (together,), self.expression()))

    def _value(self) -> Expression:
        """Return what is assigned; ``a = b = c`` is not read."""
        value = self.expression()
        if self.token.kind == "symbol" and self.token.text == "=":
            raise self.fail(say("'=' is not expected"))
        return value

    def _ended(self, statement: Statement) -> Statement:
        token = self.token
        if token.kind in ("newline", "end") or (token.kind == "symbol" and token.text in ";,"):
            return statement
        if token.kind == "word" and token.text in _ENDS:
            return statement
        raise self.fail(say("{token} is not expected", token=quoted(token.text)))

    def _outputs(self) -> tuple[Expression, ...] | None:
        """Return the targets of ``[a, b] = …``; None where that is not what stands here."""
        if self.token.text != "[" or self.token.kind != "symbol":
            return None
        depth, end = 0, self.position
        while self.tokens[end].kind not in ("newline", "end"):
            text = self.tokens[end].text if self.tokens[end].kind == "symbol" else ""
            depth += (text in ("[", "(", "{")) - (text in ("]", ")", "}"))
            end += 1
            if depth == 0:
                break
        following = self.tokens[end]
        if depth or following.kind != "symbol" or following.text != "=":
            return None
        found = self._matrix_of_outputs()
        self.position += 1
        return found

    def _matrix_of_outputs(self) -> tuple[Expression, ...]:
        opened = self.token
        self.position += 1
        outer, self.in_matrix = self.in_matrix, True
        found: list[Expression] = []
        while not self._closes("]", opened):
            if self.symbol(","):
                continue
            if self.token.text == "~":
                self.position += 1
                found.append(tree.Name(opened.line, "~"))
                continue
            found.append(self.expression())
        self.in_matrix = outer
        return tuple(found)

    def _branch(self) -> Statement:
        line = self.token.line
        self.position += 1
        test = self.expression()
        yes = self.block(("else", "elseif"))
        token = self.token
        if token.kind == "word" and token.text == "elseif":
            return tree.Branch(line, test, yes, (self._branch_within(),))
        no: tuple[Statement, ...] = ()
        if token.kind == "word" and token.text == "else":
            self.position += 1
            no = self.block(())
        self._end()
        return tree.Branch(line, test, yes, no)

    def _branch_within(self) -> Statement:
        self.depth += 1
        if self.depth > tree.MAX_DEPTH:
            raise self.fail(say("blocks are nested too deeply"))
        found = self._branch()
        self.depth -= 1
        return found

    def _loop(self) -> Statement:
        line = self.token.line
        self.position += 1
        bracket = self.symbol("(") is not None
        target = self._postfix_name()
        if not self.symbol("="):
            raise self.fail(say("'=' is expected after for"))
        source = self.expression()
        if bracket:
            self.symbol(")")
        body = self.block(())
        self._end()
        return tree.Loop(line, target, source, body)

    def _postfix_name(self) -> Expression:
        token = self.token
        if token.kind != "word":
            raise self.fail(say("a name is expected after for"))
        self.position += 1
        return tree.Name(token.line, token.text)

    def _unread_block(self, token: Token) -> Statement:
        """Return a block that is not read, with what stands in it."""
        self.position += 1
        parts: list[tree.Node] = []
        if token.text in ("while", "parfor", "switch"):
            parts.append(self._simple())
        while True:
            parts += self.block(("case", "otherwise", "catch"))
            if self.token.kind == "word" and self.token.text in ("case", "otherwise", "catch"):
                word = self.token.text
                self.position += 1
                if word == "case":
                    parts.append(tree.Evaluate(self.token.line, self.expression()))
                continue
            self._end()
            return tree.Unknown(token.line, token.text, tuple(parts))

    def _function(self) -> Statement:
        line = self.token.line
        self.position += 1
        outputs: tuple[str, ...] = ()
        found = self._outputs()
        if found is not None:
            outputs = tuple(o.name for o in found if isinstance(o, tree.Name))
        elif self.tokens[self.position + 1].text == "=":
            outputs = (self.token.text,)
            self.position += 2
        name = self.token.text
        self.position += 1
        while self.symbol("."):
            name = self.token.text
            self.position += 1
        arguments: list[str] = []
        if self.token.text == "(":
            inside = self._inside("(")
            arguments = [part.name if isinstance(part, tree.Name) else "~" for part in inside]
        body = self.block(("function",))
        self._end()
        return tree.Define(
            line,
            name,
            tuple((argument, None) for argument in arguments),
            body,
            outputs,
            is_plain="varargin" not in arguments,
        )

    def _class(self) -> Statement:
        line = self.token.line
        self.position += 1
        if self.token.text == "(":
            self._inside("(")
        name = self.token.text
        self.position += 1
        parents: list[Expression] = []
        if self.symbol("<"):
            parents.append(self._postfix())
            while self.symbol("&"):
                parents.append(self._postfix())
        body: list[Statement] = []
        while self.token.kind != "end" and self.token.text not in ("end", "endclassdef"):
            if self.token.kind == "word" and self.token.text in _SECTIONS:
                self.position += 1
                if self.token.text == "(":
                    self._skip_brackets()
                body += self.block(())
                self._end()
            else:
                self.position += 1
        self._end()
        return tree.DefineClass(line, name, tuple(parents), tuple(body))

    def _skip_brackets(self) -> None:
        depth = 0
        while self.token.kind != "end":
            depth += (self.token.text == "(") - (self.token.text == ")")
            self.position += 1
            if depth == 0:
                return
