"""MATLAB and Python text -> raw table: matrices of parameters, and links of the Robotics Toolbox.

The links are those of Corke's Robotics Toolbox for MATLAB (``Link``, ``Revolute``, ``Prismatic``,
``RevoluteMDH``, ``PrismaticMDH``, ``SerialLink``) and for Python (``RevoluteDH``, …, ``DHRobot``):
a parameter that is not given is 0, and the order in a vector is theta, d, a, alpha, sigma, offset.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.pasted.grids import MAX_COLUMNS, is_latex
from dh_to_urdf.pasted.headings import Heading, heading_problem, read_heading
from dh_to_urdf.pasted.program_limits import (
    refuse_loops,
    refuse_reworked_list,
    refuse_reworked_matrix,
    without_blocks,
)
from dh_to_urdf.pasted.raw_table import RawCell, RawRow, RawTable, headings_of
from dh_to_urdf.pasted.source_tokens import (
    Token,
    arguments,
    closing,
    matrix_rows,
    text_of,
    tokens_of,
)
from dh_to_urdf.pasted.toolbox_links import (
    LINKS,
    ORDER,
    PARAMETERS,
    Link,
    fill_from_vector,
    read_link,
)
from dh_to_urdf.table import Convention

MAX_LEFT, MAX_RIGHT = 12, 40
"""Tokens of an assignment that are looked at."""
_ROBOTS = ("SerialLink", "DHRobot", "SerialLink.SerialLink")
_NUMBERED = re.compile(r"([^\W\d]\w*)[({\[]([0-9]{1,4})[)}\]]")
_MATRIX = re.compile(r"(?:^|[=(\s])\[\s*[-+\d.\[(]|\.array\s*\(|^[ \t]*\[", re.MULTILINE)
_CALL = re.compile(
    r"\b(?:Link|DHLink|Revolute|Prismatic|RevoluteDH|PrismaticDH|RevoluteMDH|PrismaticMDH"
    r"|SerialLink|DHRobot)\s*\((?!\s*[ijkn]\s*\))"
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
    return _Program(tokens_of(without_blocks(text)), convention, columns).read()


class _Program:
    def __init__(
        self, tokens: list[Token], convention: Convention, columns: Sequence[str] | None
    ) -> None:
        self.tokens = tokens
        self.convention = convention
        self.columns = columns
        self.links: list[Link] = []
        self.matrices: dict[str, tuple[int, list[list[list[Token]]]]] = {}
        self.starts: dict[str, int] = {}
        self.robots = 0
        self.last_link = 0
        self.robot_matrix: str | None = None
        self.robot_modified: bool | None = None
        self.table = RawTable([])

    def read(self) -> RawTable:
        """The table of the text."""
        index = 0
        while index < len(self.tokens):
            index = self._statement(index)
        if self.robots > 1:
            raise DHError.single((), f"the text makes {self.robots} robots; paste one")
        if self.links:
            return self._of_links()
        return self._of_matrix()

    def _statement(self, index: int) -> int:
        """Reads what starts here and gives the index after it."""
        token = self.tokens[index]
        following = self.tokens[index + 1] if index + 1 < len(self.tokens) else None
        opens = following is not None and following.text == "(" and following.kind == "symbol"
        name = token.text.rpartition(".")[2] if token.kind == "word" else ""
        if opens and name in LINKS:
            end = closing(self.tokens, index + 1)
            inside, target = self.tokens[index + 2 : end], self._target(index)
            link = read_link(name, token.line, inside, target, self.table.warnings)
            self.links.append(link)
            self.last_link = end
            return end + 1
        if opens and name in _ROBOTS:
            self.robots += 1
            self._robot(self.tokens[index + 2 : closing(self.tokens, index + 1)])
            return index + 2
        if token.kind == "symbol" and token.text == "[":
            end = closing(self.tokens, index)
            inside = self.tokens[index + 1 : end]
            if not any(t.kind == "word" and t.text in (*LINKS, *_ROBOTS) for t in inside):
                key = self._target(index) or f"[{index}"
                self.matrices[key] = (token.line, matrix_rows(inside))
                self.starts[key] = index
                return end + 1
            refuse_reworked_list(self.tokens, end)
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
        if attribute in (*PARAMETERS, "qlim", "sigma", "flip", "mdh"):
            raise DHError.single(
                (),
                f"line {self.tokens[equals].line}: {quoted(left)} is set after the link was made;"
                f" give {attribute} among the arguments of the link",
            )
        name = left.rstrip("+-*/")
        if not name.isidentifier():
            return
        end = equals + 1
        last = min(len(self.tokens), end + MAX_RIGHT)
        while end < last and self.tokens[end].kind not in ("newline", "comment"):
            if self.tokens[end].text in (";", ",", "["):
                break
            end += 1
        # Of ``a2 += 0.1`` the name is kept without a value, so that a2 stands for none.
        text = text_of(self.tokens[equals + 1 : end]) if name == left else ""
        self.table.assigned.append((name, text))

    def _robot(self, inside: list[Token]) -> None:
        """The order of the links, the name, and the convention of a robot."""
        listed = arguments(inside)
        names = {
            k
            for k, argument in enumerate(listed)
            if argument[0].kind == "string" and argument[0].text.lower() == "name"
        }
        for position, argument in enumerate(listed):
            if position - 1 in names and position not in names:
                continue
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
                        (word,),
                        f"line {first.line}: {word} among the arguments is not read; write its"
                        f" matrix on a line of its own, as {word} = [1 0 0 0; 0 1 0 0; 0 0 1 0.1;"
                        " 0 0 0 1]",
                    )

    def _parts(self, argument: list[Token]) -> None:
        if argument[0].text in ("[", "{"):
            end = closing(argument, 0)
            inside = argument[1:end]
            refuse_reworked_list(argument, end)
            if not any(token.text in LINKS for token in inside):
                self.robot_matrix = "robot"
                self.matrices["robot"] = (argument[0].line, matrix_rows(inside))
        elif len(argument) == 1 and argument[0].kind == "word":
            self.robot_matrix = argument[0].text

    def _of_links(self) -> RawTable:
        refuse_loops(self.tokens, self.last_link)
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

    def _ordered(self) -> list[Link]:
        """The links in the order of the robot, or of their numbers, or of the text."""
        by_target: dict[str, Link] = {}
        for link in self.links:
            if link.target in by_target:
                twice = quoted(link.target)
                raise DHError.single((), f"line {link.line}: {twice} is made twice; keep one")
            if link.target:
                by_target[link.target] = link
        order = self._order(by_target)
        if order:
            missing = next((word for word in order if word not in by_target), None)
            if missing is None:
                return [by_target[word] for word in order]
            raise DHError.single((), f"the robot has a link {quoted(missing)} that is not made")
        numbers = [_NUMBERED.fullmatch(link.target) for link in self.links]
        if not all(numbers) or len({match[1] for match in numbers if match}) != 1:
            return self.links
        found = sorted((int(n[2]), k) for k, n in enumerate(numbers) if n)
        start = found[0][0]
        for expected, (number, k) in enumerate(found, start=start):
            if start > 1:
                raise DHError.single((), f"the links start at {start}; link 1 is missing")
            if number != expected:
                raise DHError.single(
                    (), f"line {self.links[k].line}: link {number} stands where {expected} is due"
                )
        return [self.links[k] for _, k in found]

    def _order(self, by_target: dict[str, Link]) -> tuple[str, ...]:
        """The names of the links in a list of them, such as ``[L1 L2]``; empty if there is none.

        Raises:
            DHError: Two lists that differ.
        """
        lists = {}
        for key, (_, rows) in self.matrices.items():
            words = tuple(text_of(element).replace(" ", "") for row in rows for element in row)
            of_robot = key == self.robot_matrix and all(re.match(r"[^\W\d]", w) for w in words)
            if words and (of_robot or all(word in by_target for word in words)):
                lists[words] = key
        if len(lists) > 1:
            raise DHError.single((), "the text holds two lists of links; paste one robot")
        return next(iter(lists), ())

    def _check_convention(self, modified: bool, line: int) -> None:
        written = Convention.MODIFIED if modified else Convention.STANDARD
        if self.convention is Convention.KHALIL:
            raise DHError.single(
                ("convention",),
                f"line {line}: links of the Robotics Toolbox are {written}, not khalil; give"
                f" convention={written}",
            )
        if written is not self.convention:
            add = "" if modified else ", or add 'modified' to the link"
            raise DHError.single(
                ("convention",),
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
            raise DHError.single((), problem)
        if warning:
            self.table.warnings.append(warning)
        for number, row in enumerate(rows, start=1):
            at = row[0][0].line
            if len(row) != len(headings):
                raise DHError.single(
                    ("joints", number - 1),
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
            self._refuse_reworked(self.robot_matrix)
            return (*self.matrices[self.robot_matrix], True)
        wide = {key: m for key, m in self.matrices.items() if m[1] and len(m[1][0]) >= 3}
        several = {key: m for key, m in wide.items() if len(m[1]) > 1} or wide
        if not several:
            raise DHSyntaxError.single(
                (), "the text holds no table: no link, and no matrix of three columns or more"
            )
        if len(several) > 1:
            raise DHError.single(
                (), f"the text holds {len(several)} matrices; paste the one with the table"
            )
        ((key, (line, rows)),) = several.items()
        if max(len(row) for row in rows) > MAX_COLUMNS:
            raise DHError.single((), f"a row has over {MAX_COLUMNS} elements")
        offsets = next((other for other in self.matrices if "offset" in other.lower()), key)
        if offsets != key:
            raise DHError.single(
                (),
                f"line {self.matrices[offsets][0]}: {quoted(offsets)} beside the matrix is not"
                " read; write it as a column offset",
            )
        self._refuse_reworked(key)
        return line, rows, False

    def _refuse_reworked(self, key: str) -> None:
        if key in self.starts:
            name = "" if key.startswith("[") else key
            refuse_reworked_matrix(self.tokens, self.starts[key], name)

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
            (),
            "the matrix names no columns; write them in a comment above it, such as"
            " % theta d a alpha, or give columns=theta,d,a,alpha",
        )

    def _of_toolbox_matrix(self, line: int, rows: list[list[list[Token]]]) -> RawTable:
        """The matrix of a ``SerialLink``: theta, d, a, alpha and then sigma and offset."""
        for row in rows:
            if not 4 <= len(row) <= 6:
                raise DHError.single(
                    (), f"line {line}: a row of a robot has 4 to 6 numbers: {', '.join(ORDER)}"
                )
            link = Link(row[0][0].line, {}, None, None, "")
            fill_from_vector(link, row)
            self.links.append(link)
        return self._of_links()
