"""MATLAB and Python text -> raw table: matrices of parameters, and links of the Robotics Toolbox.

The links are those of Corke's Robotics Toolbox for MATLAB (``Link``, ``Revolute``, ``Prismatic``,
``RevoluteMDH``, ``PrismaticMDH``, ``SerialLink``) and for Python (``RevoluteDH``, …, ``DHRobot``):
a parameter that is not given is 0, and the order in a vector is theta, d, a, alpha, sigma, offset.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.grids import MAX_COLUMNS, is_latex
from dh_to_urdf.headings import Heading, heading_problem, read_heading
from dh_to_urdf.raw_table import RawCell, RawRow, RawTable, headings_of
from dh_to_urdf.source_tokens import (
    Token,
    arguments,
    closing,
    matrix_rows,
    text_of,
    tokens_of,
)
from dh_to_urdf.table import Convention

MAX_LEFT, MAX_RIGHT = 12, 40
"""Tokens of an assignment that are looked at."""
_LINKS = {
    "Link": (None, None), "DHLink": (None, None),
    "Revolute": ("R", False), "Prismatic": ("P", False),
    "RevoluteDH": ("R", False), "PrismaticDH": ("P", False),
    "RevoluteMDH": ("R", True), "PrismaticMDH": ("P", True),
}  # fmt: skip
"""Type and whether modified, of each class; None where the arguments say it."""
_ROBOTS = ("SerialLink", "DHRobot", "SerialLink.SerialLink")
_ORDER = ("theta", "d", "a", "alpha", "sigma", "offset")
_PARAMETERS = ("theta", "d", "a", "alpha", "offset")
_DYNAMIC = {"m", "r", "I", "Jm", "G", "B", "Tc", "jm", "g", "tc", "mesh", "i", "b"}
_FLAGS = {
    "modified": ("modified", True), "mdh": ("modified", True), "standard": ("modified", False),
    "std": ("modified", False), "revolute": ("type", "R"), "prismatic": ("type", "P"),
    "flip": ("flip", True),
}  # fmt: skip
_NUMBERED = re.compile(r"([^\W\d]\w*)[({\[](\d{1,4})[)}\]]")
_TRUE, _FALSE = {"true", "1"}, {"false", "0"}
_MATRIX = re.compile(r"(?:^|[=(\s])\[\s*[-+\d.\[(]|\.array\s*\(|^[ \t]*\[", re.MULTILINE)
_CALL = re.compile(
    r"\b(?:Link|DHLink|Revolute|Prismatic|RevoluteDH|PrismaticDH|RevoluteMDH|PrismaticMDH"
    r"|SerialLink|DHRobot)\s*\("
)


def is_program(text: str) -> bool:
    """Whether a text holds links of the Robotics Toolbox or a matrix in brackets."""
    if is_latex(text):
        return False
    if _CALL.search(text):
        return True
    lines = [line for line in text.splitlines() if line.strip()]
    piped = sum(line.count("|") >= 2 and line.lstrip()[:1] not in "%#" for line in lines)
    headed = any(
        len(words) > 2 and all(read_heading(word) for word in words)
        for line in lines[:3]
        if line.lstrip()[:1] not in "%#[" and (words := line.split())
    )
    return _MATRIX.search(text) is not None and piped < 2 and not headed


@dataclass
class _Link:
    """One call of a link class, or one row of a matrix that a robot is made of."""

    line: int
    cells: dict[str, RawCell]
    type: str | None
    modified: bool | None
    target: str


def table_from_program(
    text: str, convention: Convention, columns: Sequence[str] | None
) -> RawTable:
    """Reads the links or the matrix of a text.

    Args:
        text: The text.
        convention: What the rows mean; it must be that of the links.
        columns: Order of the columns of a matrix.

    Raises:
        DHError: No table, an argument that is not read, or links of another convention.
    """
    return _Program(tokens_of(text), convention, columns).read()


class _Program:
    def __init__(
        self, tokens: list[Token], convention: Convention, columns: Sequence[str] | None
    ) -> None:
        self.tokens = tokens
        self.convention = convention
        self.columns = columns
        self.links: list[_Link] = []
        self.matrices: dict[str, tuple[int, list[list[list[Token]]]]] = {}
        self.order: list[str] = []
        self.robot_matrix: str | None = None
        self.robot_modified: bool | None = None
        self.table = RawTable([])

    def read(self) -> RawTable:
        """The table of the text."""
        index = 0
        while index < len(self.tokens):
            index = self._statement(index)
        if self.links:
            return self._of_links()
        return self._of_matrix()

    def _statement(self, index: int) -> int:
        """Reads what starts here and gives the index after it."""
        token = self.tokens[index]
        following = self.tokens[index + 1] if index + 1 < len(self.tokens) else None
        opens = following is not None and following.text == "(" and following.kind == "symbol"
        name = token.text.rpartition(".")[2] if token.kind == "word" else ""
        if opens and name in _LINKS:
            end = closing(self.tokens, index + 1)
            self._link(name, token.line, self.tokens[index + 2 : end], self._target(index))
            return end + 1
        if opens and name in _ROBOTS:
            self._robot(self.tokens[index + 2 : closing(self.tokens, index + 1)])
            return index + 2
        if token.kind == "symbol" and token.text == "[":
            end = closing(self.tokens, index)
            inside = self.tokens[index + 1 : end]
            if not any(t.kind == "word" and t.text in (*_LINKS, *_ROBOTS) for t in inside):
                key = self._target(index) or f"[{index}"
                self.matrices[key] = (token.line, matrix_rows(inside))
                return end + 1
        if token.kind == "symbol" and token.text == "=":
            self._assignment(index)
        return index + 1

    def _target(self, index: int) -> str:
        """What stands before the = in front of a token: ``L(1)``, ``L1``; empty if nothing."""
        position = index - 1
        first = max(0, index - MAX_LEFT)
        while position > first and self.tokens[position].text in ("(", "array", "[", "{"):
            position -= 1
        if position < 0 or self.tokens[position].text != "=":
            return ""
        return self._left_side(position)

    def _left_side(self, equals: int) -> str:
        start, first = equals, max(0, equals - MAX_LEFT)
        while start > first and self.tokens[start - 1].kind != "newline":
            if self.tokens[start - 1].text in (";", ","):
                break
            start -= 1
        return "".join(token.text for token in self.tokens[start:equals])

    def _assignment(self, equals: int) -> None:
        """``L1 = 0.3``: a number with a name; or ``L(1).offset = pi/2``, which is refused."""
        left = self._left_side(equals)
        attribute = left.rpartition(".")[2] if "." in left else ""
        if attribute in (*_PARAMETERS, "qlim", "sigma", "flip", "mdh"):
            raise DHError.single(
                "",
                f"line {self.tokens[equals].line}: {quoted(left)} is set after the link was made;"
                f" give {attribute} among the arguments of the link",
            )
        if not left.isidentifier():
            return
        end = equals + 1
        last = min(len(self.tokens), end + MAX_RIGHT)
        while end < last and self.tokens[end].kind not in ("newline", "comment"):
            if self.tokens[end].text in (";", ",", "["):
                break
            end += 1
        self.table.assigned[left] = text_of(self.tokens[equals + 1 : end])

    def _link(self, name: str, line: int, inside: list[Token], target: str) -> None:
        type_, modified = _LINKS[name]
        link = _Link(line, {}, type_, modified, target)
        listed = arguments(inside)
        position = 0
        while position < len(listed):
            argument = listed[position]
            position += 1
            first = argument[0]
            if first.text == "[" and position == 1:
                self._vector(link, argument)
                continue
            if first.kind == "word" and len(argument) > 2 and argument[1].text == "=":
                self._parameter(link, first.text, argument[2:])
                continue
            if first.kind == "string" and len(argument) == 1:
                flag = _FLAGS.get(first.text.lower())
                if flag is not None:
                    self._flag(link, flag)
                    continue
                if position < len(listed):
                    self._parameter(link, first.text, listed[position])
                    position += 1
                    continue
            raise DHError.single(
                "",
                f"line {first.line}: {name} has an argument {quoted(text_of(argument))} that is not"
                " read; write 'd', 0.3, 'a', 0, 'alpha', pi/2 or d=0.3, a=0, alpha=pi/2",
            )
        self._settle(link, name)

    def _vector(self, link: _Link, argument: list[Token]) -> None:
        rows = matrix_rows(argument[1 : closing(argument, 0)])
        if len(rows) != 1 or not 4 <= len(rows[0]) <= 6:
            raise DHError.single(
                "", f"line {link.line}: a vector of a link has 4 to 6 numbers: {', '.join(_ORDER)}"
            )
        self._from_vector(link, rows[0])

    def _from_vector(self, link: _Link, row: list[list[Token]]) -> None:
        for key, element in zip(_ORDER, row, strict=False):
            self._parameter(link, key, element)
        link.type = link.type or "R"
        own = "theta" if link.type == "R" else "d"
        cell = link.cells.get(own)
        if cell is not None and re.fullmatch(r"0*\.?0*|NaN", cell.text):
            del link.cells[own]

    def _flag(self, link: _Link, flag: tuple[str, object]) -> None:
        what, value = flag
        if what == "modified":
            link.modified = bool(value)
        elif what == "type":
            link.type = str(value)
        else:
            link.cells["sign"] = RawCell("-1", "flip", link.line)

    def _parameter(self, link: _Link, key: str, value: list[Token]) -> None:
        text = text_of(value)
        lowered = key.lower() if key not in _DYNAMIC else key
        if lowered in _PARAMETERS:
            if lowered in link.cells:
                raise DHError.single(
                    "", f"line {link.line}: {key} of the link stands twice; keep one"
                )
            link.cells[lowered] = RawCell(text, key, value[0].line if value else link.line)
        elif lowered == "sigma":
            link.type = {"0": "R", "1": "P"}.get(text, text)
        elif lowered == "qlim":
            self._limits(link, value)
        elif lowered in ("mdh", "modified", "flip") and text.lower() in _TRUE | _FALSE:
            if lowered == "flip":
                sign = "-1" if text.lower() in _TRUE else "1"
                link.cells["sign"] = RawCell(sign, "flip", link.line)
            else:
                link.modified = text.lower() in _TRUE
        elif lowered == "name":
            link.cells["name"] = RawCell(text, "name", link.line)
        elif lowered == "convention" and text.lower() in ("standard", "modified"):
            link.modified = text.lower() == "modified"
        elif lowered in ("jointtype", "type") and text.lower()[:1] in ("r", "p"):
            link.type = text[0].upper()
        elif key in _DYNAMIC:
            warning = "masses, inertias and motors of the links are left out"
            if warning not in self.table.warnings:
                self.table.warnings.append(warning)
        else:
            raise DHError.single(
                "",
                f"line {link.line}: the link has an unknown parameter {quoted(key)}; known are"
                " theta, d, a, alpha, offset, qlim, sigma, flip, modified",
            )

    def _limits(self, link: _Link, value: list[Token]) -> None:
        """``[-1 1]``, ``[-60 60]*pi/180``, ``deg2rad([-60 60])``, ``np.array([-1, 1])``."""
        text = text_of(value)
        start = next((i for i, t in enumerate(value) if t.kind == "symbol" and t.text == "["), None)
        if start is not None:
            end = closing(value, start)
            rows = matrix_rows(value[start + 1 : end])
            elements = [text_of(element) for row in rows for element in row]
            before, after = text_of(value[:start]), text_of(value[end + 1 :])
            if before.startswith("array"):
                before, after = "", after.removeprefix(")")
            if len(elements) == 2:
                for key, element in zip(("lower", "upper"), elements, strict=True):
                    whole = f"{before}({element}){after}" if before or after else element
                    link.cells[key] = RawCell(whole, "qlim", value[0].line)
                return
        if text not in ("None", "[]"):
            raise DHError.single(
                "", f"line {link.line}: qlim is {quoted(text)}; write [lower upper]"
            )

    def _settle(self, link: _Link, name: str) -> None:
        """The type as the Toolbox finds it: a given theta makes a prismatic joint."""
        cells = link.cells
        if link.type is None and "theta" in cells and "d" in cells and name == "Link":
            raise DHError.single(
                "",
                f"line {link.line}: the link has theta and d; give the one that is constant, or"
                " 'revolute' or 'prismatic'",
            )
        link.type = link.type or ("P" if "theta" in cells and "d" not in cells else "R")
        if link.type not in ("R", "P"):
            raise DHError.single(
                "", f"line {link.line}: sigma is {quoted(link.type)}; give 0 (R) or 1 (P)"
            )
        self.links.append(link)

    def _robot(self, inside: list[Token]) -> None:
        """The order of the links, the name, and the convention of a robot."""
        listed = arguments(inside)
        for position, argument in enumerate(listed):
            first = argument[0]
            word = first.text.lower()
            value = listed[position + 1] if position + 1 < len(listed) else None
            if first.kind == "word" and len(argument) > 2 and argument[1].text == "=":
                value = argument[2:]
            elif first.kind != "string" and position == 0:
                self._parts(argument)
                continue
            if first.kind == "string" or (argument[1:2] and argument[1].text == "="):
                if word == "name" and value and value[0].kind == "string":
                    self.table.name = value[0].text
                elif word in ("modified", "mdh"):
                    self.robot_modified = True
                elif word in ("base", "tool"):
                    raise DHError.single(
                        f"/{word}",
                        f"line {first.line}: {word} among the arguments is not read; write its"
                        f" matrix on a line of its own, as {word} = [1 0 0 0; 0 1 0 0; 0 0 1 0.1;"
                        " 0 0 0 1]",
                    )

    def _parts(self, argument: list[Token]) -> None:
        if argument[0].text in ("[", "{"):
            inside = argument[1 : closing(argument, 0)]
            if any(token.text in _LINKS for token in inside):
                return
            rows = matrix_rows(inside)
            words = [text_of(element).replace(" ", "") for row in rows for element in row]
            if words and all(re.match(r"[^\W\d]", word) for word in words):
                self.order = words
            else:
                self.robot_matrix = "robot"
                self.matrices["robot"] = (argument[0].line, rows)
        elif len(argument) == 1 and argument[0].kind == "word":
            self.robot_matrix = argument[0].text

    def _of_links(self) -> RawTable:
        links = self._ordered()
        for link in links:
            modified = link.modified if link.modified is not None else self.robot_modified
            self._check_convention(bool(modified), link.line)
        for link in links:
            own = "theta" if link.type == "R" else "d"
            for key in ("alpha", "a", "theta", "d"):
                if key != own:
                    link.cells.setdefault(key, RawCell("0", key, link.line))
            link.cells["type"] = RawCell(link.type or "R", "type", link.line)
            self.table.rows.append(RawRow(link.line, link.cells, own_constant=False))
        self.table.typed = True
        return self.table

    def _ordered(self) -> list[_Link]:
        """The links in the order of the robot, or of their numbers, or of the text."""
        by_target: dict[str, _Link] = {}
        for link in self.links:
            if link.target in by_target:
                raise DHError.single("", f"line {link.line}: {link.target} is made twice; keep one")
            if link.target:
                by_target[link.target] = link
        if self.order and all(word in by_target for word in self.order):
            return [by_target[word] for word in self.order]
        if self.order:
            missing = next(word for word in self.order if word not in by_target)
            raise DHError.single("", f"the robot has a link {quoted(missing)} that is not made")
        numbers = [_NUMBERED.fullmatch(link.target) for link in self.links]
        if not all(numbers) or len({match[1] for match in numbers if match}) != 1:
            return self.links
        found = sorted((int(n[2]), k) for k, n in enumerate(numbers) if n)
        start = found[0][0]
        for expected, (number, k) in enumerate(found, start=start):
            if number != expected or start > 1:
                raise DHError.single(
                    "", f"line {self.links[k].line}: link {number} stands where {expected} is due"
                )
        return [self.links[k] for _, k in found]

    def _check_convention(self, modified: bool, line: int) -> None:
        written = Convention.MODIFIED if modified else Convention.STANDARD
        if self.convention is Convention.KHALIL:
            raise DHError.single(
                "/convention",
                f"line {line}: links of the Robotics Toolbox are {written}, not khalil; give"
                f" convention={written}",
            )
        if written is not self.convention:
            add = "" if modified else ", or add 'modified' to the link"
            raise DHError.single(
                "/convention",
                f"line {line}: the link is {written}, but convention says {self.convention}; give"
                f" convention={written}{add}",
            )

    def _of_matrix(self) -> RawTable:
        line, rows, toolbox = self._chosen()
        if toolbox and self.columns is None:
            return self._of_toolbox_matrix(line, rows)
        headings = self._headings()
        problem, warning = heading_problem(headings, self.convention.value)
        if problem:
            raise DHError.single("", problem)
        if warning:
            self.table.warnings.append(warning)
        for number, row in enumerate(rows, start=1):
            at = row[0][0].line
            if len(row) != len(headings):
                raise DHError.single(
                    f"/joints/{number - 1}",
                    f"row {number} of the matrix (line {at}) has {len(row)} elements under"
                    f" {len(headings)} columns ({', '.join(h.text for h in headings)})",
                )
            cells = {
                heading.key: RawCell(text_of(element), heading.text, at, heading.unit)
                for heading, element in zip(headings, row, strict=True)
            }
            self.table.rows.append(RawRow(at, cells))
        return self.table

    def _chosen(self) -> tuple[int, list[list[list[Token]]], bool]:
        if self.robot_matrix is not None and self.robot_matrix in self.matrices:
            return (*self.matrices[self.robot_matrix], True)
        wide = [m for m in self.matrices.values() if m[1] and len(m[1][0]) >= 3]
        several = [m for m in wide if len(m[1]) > 1] or wide
        if not several:
            raise DHSyntaxError.single(
                "", "the text holds no table: no link, and no matrix of three columns or more"
            )
        if len(several) > 1:
            raise DHError.single(
                "", f"the text holds {len(several)} matrices; paste the one with the table"
            )
        if max(len(row) for row in several[0][1]) > MAX_COLUMNS:
            raise DHError.single("", f"a row has over {MAX_COLUMNS} elements")
        return (*several[0], False)

    def _headings(self) -> list[Heading]:
        """The columns as given, or as a comment names them."""
        if self.columns is not None:
            return headings_of(self.columns, self.convention, "columns")
        khalil = self.convention is Convention.KHALIL
        for token in self.tokens:
            if token.kind != "comment" or len(token.text) > 300:
                continue
            text = token.text.lstrip("%# \t[").rstrip("] ")
            words = [word for word in re.split(r"[\s,|;&]+", text) if word]
            found = [read_heading(word, khalil=khalil) for word in words]
            if len(words) >= 3 and all(found):
                return headings_of(words, self.convention, f"line {token.line}")
        raise DHError.single(
            "",
            "the matrix names no columns; write them in a comment above it, such as"
            " % theta d a alpha, or give columns=theta,d,a,alpha",
        )

    def _of_toolbox_matrix(self, line: int, rows: list[list[list[Token]]]) -> RawTable:
        """The matrix of a ``SerialLink``: theta, d, a, alpha and then sigma and offset."""
        for row in rows:
            if not 4 <= len(row) <= 6:
                raise DHError.single(
                    "", f"line {line}: a row of a robot has 4 to 6 numbers: {', '.join(_ORDER)}"
                )
            link = _Link(row[0][0].line, {}, None, None, "")
            self._from_vector(link, row)
            self.links.append(link)
        return self._of_links()
