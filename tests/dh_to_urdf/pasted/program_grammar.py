"""Programs of robots as people write them, each with its robot by construction.

Every choice changes the text and, independently of any reader, the model beside it.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Row:
    """One joint as the program makes it: sigma 0 or 1, numbers in rad and m."""

    sigma: int
    theta: float
    d: float
    a: float
    alpha: float
    offset: float = 0.0
    flip: bool = False
    qlim: tuple[float, float] | None = None

    def matrix(self, q: float, modified: bool) -> np.ndarray:
        """Return A_k of a joint value."""
        v = (-q if self.flip else q) + self.offset
        theta, d = (self.theta, v) if self.sigma else (v, self.d)
        turn, shift = _rz(theta) @ _t(0, 0, d), _t(self.a, 0, 0) @ _rx(self.alpha)
        return shift @ turn if modified else turn @ shift


@dataclass
class Form:
    """A program and its robot."""

    text: str
    language: str
    modified: bool
    rows: list[Row]
    base: np.ndarray = field(default_factory=lambda: np.eye(4))
    tool: np.ndarray = field(default_factory=lambda: np.eye(4))

    def pose(self, q: list[float]) -> np.ndarray:
        """Return the pose of the tool."""
        T = self.base
        for row, value in zip(self.rows, q, strict=True):
            T = T @ row.matrix(value, self.modified)
        return T @ self.tool


def _rx(t: float) -> np.ndarray:
    c, s = math.cos(t), math.sin(t)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])


def _ry(t: float) -> np.ndarray:
    c, s = math.cos(t), math.sin(t)
    return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1.0]])


def _rz(t: float) -> np.ndarray:
    c, s = math.cos(t), math.sin(t)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def _t(x: float, y: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def form(seed: int, language: str) -> Form:
    """Return the program of a seed, in ``python`` or ``matlab``."""
    dice = random.Random(f"{seed} {language}")
    return (_Python if language == "python" else _Matlab)(dice).form()


class _Writer:
    """What both languages share: numbers, links, lists, placements."""

    power = "**"
    comment = "#"
    stop = ""

    def __init__(self, dice: random.Random) -> None:
        self.dice = dice
        self.lines: list[str] = []
        self.modified = dice.random() < 0.35
        self.rows: list[Row] = []
        self.base = np.eye(4)
        self.tool = np.eye(4)
        self.names: dict[str, float] = {}

    def add(self, *lines: str) -> None:
        self.lines += lines

    def chance(self, p: float) -> bool:
        return self.dice.random() < p

    # numbers -----------------------------------------------------------------------------

    def length(self) -> tuple[str, float]:
        """Return a length as a text, and its value."""
        value = self.dice.choice([0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.05, 0.612, 1.0, -0.12])
        kind = self.dice.randrange(8)
        if kind == 0 and value:
            name = f"{self.dice.choice('abhlmw')}{self.dice.randrange(1, 9)}x"
            if name not in self.names:
                self.names[name] = value
                self.add(f"{name} = {value}{self.stop}")
            return name, self.names[name]
        if kind == 1 and value:
            return f"{round(value * 1000)}*1e-3", round(value * 1000) * 1e-3
        if kind == 2:
            return f"0.5{self.power}2", 0.25
        if kind == 3:
            return f"sqrt(0.3{self.power}2 + 0.4{self.power}2)", math.sqrt(0.3**2 + 0.4**2)
        if kind == 4 and value:
            return f"({value} + 0.1)", value + 0.1
        return f"{value:g}", value

    def turn(self) -> tuple[str, float]:
        """Return an angle as a text, and its value."""
        k = self.dice.choice([0, 0, 1, -1, 2, 0.5, -0.5])
        value = k * math.pi / 2
        kind = self.dice.randrange(7)
        if k == 0:
            return "0", 0.0
        if kind == 0:
            return f"{90 * k:g}*pi/180", value
        if kind == 1:
            return self.degrees(90 * k), value
        if kind == 2:
            if "deg" not in self.names:
                self.names["deg"] = math.pi / 180
                self.add(f"deg = pi/180{self.stop}")
            return f"{90 * k:g}*deg", value
        return {1: "pi/2", -1: "-pi/2", 2: "pi", 0.5: "pi/4", -0.5: "-pi/4"}[k], value

    def degrees(self, value: float) -> str:
        raise NotImplementedError

    def row(self) -> tuple[Row, dict[str, str]]:
        """Return a joint, and the texts of its numbers."""
        sigma = int(self.chance(0.25))
        texts: dict[str, str] = {}
        numbers = {"theta": 0.0, "d": 0.0, "a": 0.0, "alpha": 0.0}
        for key in ("theta", "a", "alpha") if sigma else ("d", "a", "alpha"):
            text, value = self.length() if key in ("a", "d") else self.turn()
            texts[key], numbers[key] = text, value
        row = Row(sigma, **numbers)
        if self.chance(0.25):
            text, value = self.length() if sigma else self.turn()
            texts["offset"], row.offset = text, value
        if self.chance(0.12):
            texts["flip"], row.flip = "true", True
        if self.chance(0.2):
            texts["qlim"], row.qlim = "", (-1.0, 1.5)
        return row, texts

    # noise -------------------------------------------------------------------------------

    def noise(self, choices: list[str], p: float = 0.3) -> None:
        if self.chance(p):
            self.add(*self.dice.choice(choices).split("\n"))

    def pick(self, *ways: Callable[[], None]) -> None:
        self.dice.choice(ways)()


class _Python(_Writer):
    prefix = ""
    np = "np."

    def degrees(self, value: float) -> str:
        return self.dice.choice([f"np.deg2rad({value:g})", f"np.radians({value:g})"])

    def link(self) -> tuple[str, Row]:
        """Return a constructor, and its joint."""
        row, texts = self.row()
        name = f"{'Prismatic' if row.sigma else 'Revolute'}{'MDH' if self.modified else 'DH'}"
        extra = []
        if "offset" in texts:
            extra.append(f"offset={texts['offset']}")
        if row.flip:
            extra.append("flip=True")
        if row.qlim:
            extra.append(self.dice.choice(["qlim=[-1, 1.5]", "qlim=np.array([-1, 1.5])"]))
        if self.chance(0.15):
            extra.append("m=1.5, r=[0, 0, 0.1], G=1")
        first = "theta" if row.sigma else "d"
        kind = self.dice.randrange(6)
        if kind == 0:
            parts = [texts[first], texts["a"], texts["alpha"], *extra]
        elif kind == 1:
            name = "DHLink"
            parts = [f"{k}={texts[k]}" for k in (first, "a", "alpha")]
            parts += [f"sigma={row.sigma}", f"mdh={self.modified}", *extra]
        else:
            keys = [k for k in (first, "a", "alpha") if texts[k] != "0" or self.chance(0.5)]
            self.dice.shuffle(keys)
            parts = [f"{k}={texts[k]}" for k in keys] + extra
        return f"{self.prefix}{name}({', '.join(parts)})", row

    def form(self) -> Form:
        self.prefix = self.dice.choice(["", "", "rtb.", "roboticstoolbox."])
        imports = {
            "": "from roboticstoolbox import *",
            "rtb.": "import roboticstoolbox as rtb",
            "roboticstoolbox.": "import roboticstoolbox",
        }[self.prefix]
        self.add(imports, "import numpy as np", "from math import pi, sqrt")
        self.add("from spatialmath import SE3")
        self.add("from spatialmath.base import transl, trotx, troty, trotz, rpy2tr")
        self.noise(['"""A small arm."""', "# the arm\nprint('start')", "np.set_printoptions(3)"])
        head = len(self.lines)
        wrap = self.dice.choice(["script", "script", "script", "class", "class", "function"])
        self.links()
        self.noise(
            ["q0 = np.zeros(3)", "print(L)", "count = len(L)", "for link in L:\n    print(link)"]
        )
        placed = self.arguments()
        name = self.dice.choice([", name='arm'", ', name="arm", manufacturer="us"', ""])
        made = f"{self.prefix}DHRobot(L{name}{placed})"
        if wrap == "class":
            self.add(f"super().__init__(L{name}{placed})")
            self.later("self")
            self.noise(
                ["self.qz = np.zeros(self.n)", "self.addconfiguration('qz', [0]*self.n)"], 0.4
            )
            body = [f"        {line}" for line in self.lines[head:]]
            self.lines = self.lines[:head]
            self.add(f"class Arm({self.prefix}DHRobot):", "    def __init__(self):", *body)
            if self.chance(0.6):
                self.add("", "if __name__ == '__main__':", "    robot = Arm()", "    print(robot)")
        elif wrap == "function":
            self.add(f"robot = {made}")
            self.later("robot")
            body = [f"    {line}" for line in self.lines[head:]]
            self.lines = self.lines[:head]
            self.add("def make():", *body, "    return robot", "", "robot = make()")
        else:
            self.add(f"robot = {made}")
            self.later("robot")
        if wrap != "class":
            self.noise(
                [
                    "print(robot)",
                    "T = robot.fkine([0]*robot.n)",
                    "robot.plot([0]*robot.n)",
                    "q = np.zeros(robot.n)\nrobot.plot(q)\nJ = robot.jacob0(q)",
                ],
                0.5,
            )
        text = "\n".join(self.lines) + "\n"
        return Form(text, "python", self.modified, self.rows, self.base, self.tool)

    def links(self) -> None:
        """Make the list L in one of the ways that people use."""
        n = self.dice.randrange(2, 6)
        made = [self.link() for _ in range(n)]
        texts, rows = [text for text, _ in made], [row for _, row in made]

        def literal() -> None:
            self.add("L = [", *(f"    {text}," for text in texts), "]")

        def names() -> None:
            self.add(*(f"L{k} = {text}" for k, text in enumerate(texts, 1)))
            self.add(f"L = [{', '.join(f'L{k}' for k in range(1, n + 1))}]")

        def appended() -> None:
            self.add(self.dice.choice(["L = []", "L = list()"]))
            self.add(*(f"L.append({text})" for text in texts))

        def inserted() -> None:
            self.add(f"L = [{texts[-1]}]")
            self.add(*(f"L.insert(0, {text})" for text in reversed(texts[:-1])))

        def joined() -> None:
            self.add(f"A = [{texts[0]}]", f"B = [{', '.join(texts[1:])}]", "L = A + B")

        def extended() -> None:
            self.add(f"L = [{texts[0]}]", f"L.extend([{', '.join(texts[1:])}])")

        def added() -> None:
            self.add(f"L = [{texts[0]}]", *(f"L += [{text}]" for text in texts[1:]))

        def reverse() -> None:
            self.add(f"L = [{', '.join(reversed(texts))}]")
            self.add(self.dice.choice(["L.reverse()", "L = L[::-1]", "L = list(reversed(L))"]))

        def sliced() -> None:
            spare = self.link()[0]
            self.add(f"every = [{', '.join([*texts, spare])}]")
            self.add(self.dice.choice([f"L = every[:{n}]", "L = every[:-1]", f"L = every[0:{n}]"]))

        def popped() -> None:
            spare = self.link()[0]
            at = self.dice.randrange(n + 1)
            whole = [*texts[:at], spare, *texts[at:]]
            self.add(f"L = [{', '.join(whole)}]")
            self.add(self.dice.choice([f"L.pop({at})", f"del L[{at}]", f"extra = L.pop({at})"]))

        def replaced() -> None:
            spare = self.link()[0]
            self.add(f"L = [{', '.join([spare, *texts[1:]])}]", f"L[0] = {texts[0]}")

        def spread() -> None:
            self.add(
                f"arm = [{texts[0]}]", f"wrist = ({', '.join(texts[1:])},)", "L = [*arm, *wrist]"
            )

        ways = [literal, literal, names, appended, inserted, joined, extended, added, reverse]
        if self.chance(0.15):
            self.computed()
            return
        self.pick(*ways, sliced, popped, replaced, spread)
        self.rows = rows
        self.set_later("L")
        if self.chance(0.2):
            self.add(f"probe = {self.link()[0]}")

    def computed(self) -> None:
        """Make links from lists of numbers."""
        n = self.dice.randrange(2, 5)
        d = [self.dice.choice([0, 0.1, 0.4]) for _ in range(n)]
        a = [self.dice.choice([0, 0.2, 0.3]) for _ in range(n)]
        turns = [self.dice.choice([0, 1, -1]) for _ in range(n)]
        alpha = [{0: "0", 1: "pi/2", -1: "-pi/2"}[k] for k in turns]
        name = f"{self.prefix}Revolute{'MDH' if self.modified else 'DH'}"
        self.add(f"d = {d}", f"a = {a}", f"alpha = [{', '.join(alpha)}]")
        ways = [
            [f"L = [{name}(d=d[i], a=a[i], alpha=alpha[i]) for i in range({n})]"],
            [
                "L = []",
                f"for i in range({n}):",
                f"    L.append({name}(d=d[i], a=a[i], alpha=alpha[i]))",
            ],
            [f"L = [{name}(d=x, a=y, alpha=z) for x, y, z in zip(d, a, alpha)]"],
            [
                "dh = np.array([d, a, alpha]).T",
                f"L = [{name}(d=r[0], a=r[1], alpha=r[2]) for r in dh]",
            ],
        ]
        self.add(*self.dice.choice(ways))
        self.rows = [Row(0, 0.0, d[k], a[k], turns[k] * math.pi / 2) for k in range(n)]

    def set_later(self, owner: str) -> None:
        """Set properties of links after they are made."""
        for k, row in enumerate(self.rows):
            if not self.chance(0.15):
                continue
            self.set_one(f"{owner}[{k}]", row)

    def set_one(self, target: str, row: Row) -> None:
        kind = self.dice.randrange(4)
        if kind == 0:
            text, row.offset = self.length() if row.sigma else self.turn()
            self.add(f"{target}.offset = {text}")
        elif kind == 1:
            text, row.a = self.length()
            self.add(f"{target}.a = {text}")
        elif kind == 2:
            text, row.alpha = self.turn()
            self.add(f"{target}.alpha = {text}")
        else:
            text, value = self.length()
            row.a = row.a + value
            self.add(f"{target}.a += {text}")

    def pose(self, depth: int = 0) -> tuple[str, np.ndarray]:
        """Return a placement as an SE3 text, and its matrix."""
        text, x = self.length()
        kind = self.dice.randrange(9 if depth == 0 else 6)
        if kind == 0:
            return f"SE3({text}, 0, 0.1)", _t(x, 0, 0.1)
        if kind == 1:
            axis = self.dice.randrange(3)
            return f"SE3.T{'xyz'[axis]}({text})", _t(*[x if k == axis else 0 for k in range(3)])
        if kind == 2:
            turn, t = self.turn()
            axis = self.dice.randrange(3)
            return f"SE3.R{'xyz'[axis]}({turn})", (_rx, _ry, _rz)[axis](t)
        if kind == 3:
            return self.dice.choice(
                [
                    ("SE3.Rz(90, 'deg')", _rz(math.pi / 2)),
                    ("SE3.Ry(30, unit='deg')", _ry(math.pi / 6)),
                ]
            )
        if kind == 4:
            return f"SE3([0, {text}, 0])", _t(0, x, 0)
        if kind == 5:
            r, p, y = 0.1, -0.2, 0.3
            return f"SE3.RPY([{r}, {p}, {y}])", _rz(y) @ _ry(p) @ _rx(r)
        if kind == 6:
            matrix = f"[[1, 0, 0, {text}], [0, 1, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]]"
            return f"SE3(np.array({matrix}))", _t(x, 0, 0.2)
        one, A = self.pose(1)
        two, B = self.pose(1)
        if kind == 7:
            return f"{one} * {two}", A @ B
        return f"{one} * ({two}).inv()", A @ np.linalg.inv(B)

    def arguments(self) -> str:
        """Return base and tool among the arguments of the robot."""
        found = ""
        if self.chance(0.3):
            text, self.tool = self.pose()
            if self.chance(0.4):
                self.add(f"flange = {text}")
                text = "flange"
            found += f", tool={text}"
        if self.chance(0.2):
            text, self.base = self.pose()
            found += f", base={text}"
        return found

    def later(self, robot: str) -> None:
        """Set base, tool and links once the robot is made."""
        if self.chance(0.35):
            text, T = self.pose()
            key = self.dice.choice(["base", "tool"])
            before = getattr(self, key)
            kind = self.dice.randrange(5)
            if kind == 0:
                self.add(f"{robot}.{key} *= {text}")
                setattr(self, key, before @ T)
            elif kind == 1:
                self.add(f"{robot}.{key} = {robot}.{key} * {text}")
                setattr(self, key, before @ T)
            elif kind == 2:
                self.add(f"{robot}.{key} = {text}")
                setattr(self, key, T)
            elif kind == 3:
                self.add(f"{robot}.{key} = transl(0, 0, 0.3) @ trotx(pi/2)")
                setattr(self, key, _t(0, 0, 0.3) @ _rx(math.pi / 2))
            else:
                self.add("T = np.eye(4)", "T[2, 3] = 0.7", f"{robot}.{key} = T")
                setattr(self, key, _t(0, 0, 0.7))
        if self.chance(0.3):
            k = self.dice.randrange(len(self.rows))
            self.set_one(f"{robot}.links[{k}]", self.rows[k])


class _Matlab(_Writer):
    power = "^"
    comment = "%"
    stop = ";"

    def degrees(self, value: float) -> str:
        return f"deg2rad({value:g})"

    def link(self) -> tuple[str, Row]:
        """Return a constructor, and its joint."""
        row, texts = self.row()
        first = "theta" if row.sigma else "d"
        kind = self.dice.randrange(5)
        offset = texts.get("offset", "0")
        pairs = [f"'{k}', {texts[k]}" for k in (first, "a", "alpha")]
        if "offset" in texts:
            pairs.append(f"'offset', {offset}")
        if row.qlim:
            pairs.append("'qlim', [-1 1.5]")
        if kind <= 1 and not row.flip and not row.qlim:
            cells = [texts.get("theta", "0"), texts.get("d", "0"), texts["a"], texts["alpha"]]
            if row.sigma or "offset" in texts or self.chance(0.3):
                cells += [str(row.sigma), offset]
            sep = self.dice.choice([" ", ", ", " , "])
            inside = sep.join(cell.replace(" ", "") for cell in cells)
            flag = ", 'modified'" if self.modified else self.dice.choice(["", ", 'standard'"])
            return f"Link([{inside}]{flag})", row
        if row.flip:
            pairs.append("'flip'")
        if kind == 2:
            name = f"{'Prismatic' if row.sigma else 'Revolute'}{'MDH' if self.modified else ''}"
            self.dice.shuffle(pairs)
            return f"{name}({', '.join(pairs)})", row
        if kind == 3:
            pairs.append(f"'{'prismatic' if row.sigma else 'revolute'}'")
        if self.modified:
            pairs.append("'modified'")
        return f"Link({', '.join(pairs)})", row

    def form(self) -> Form:
        self.noise(
            ["clear all; close all; clc", "%% The arm\nclc", "% a robot", "startup_rvc"], 0.5
        )
        head = len(self.lines)
        wrap = self.dice.choice(["script", "script", "script", "function", "self"])
        robot = "self.model" if wrap == "self" else self.dice.choice(["robot", "arm", "r"])
        self.links(robot)
        if self.matrix:
            self.later(robot)
        else:
            self.noise(["disp(L)", "q0 = zeros(1, 3);", "n = length(L);"])
            placed = self.arguments()
            name = self.dice.choice(
                [", 'name', 'arm'", ", 'name', 'arm', 'manufacturer', 'us'", ""]
            )
            self.add(f"{robot} = SerialLink({self.what}{name}{placed});")
            self.later(robot)
        if wrap == "function":
            body = [f"    {line}" for line in self.lines[head:]]
            self.lines = self.lines[:head]
            self.add(f"function {robot} = make()", *body, "end")
            if self.chance(0.5):
                self.lines = ["a9 = make();", *self.lines]
        else:
            self.noise(
                [
                    f"{robot}.plot([0 0 0])",
                    f"{robot}.teach",
                    f"T = {robot}.fkine([0 0 0])",
                    f"{robot}",
                    f"plot({robot}, [0 0])",
                    "figure(1); hold on; grid on",
                ],
                0.5,
            )
        text = "\n".join(self.lines) + "\n"
        return Form(text, "matlab", self.modified, self.rows, self.base, self.tool)

    matrix = False
    what = "L"

    def links(self, robot: str) -> None:
        """Make the links in one of the ways that people use."""
        n = self.dice.randrange(2, 6)
        if self.chance(0.12):
            self.of_matrix(n, robot)
            return
        if self.chance(0.12):
            self.computed(n)
            return
        made = [self.link() for _ in range(n)]
        texts, rows = [text for text, _ in made], [row for _, row in made]

        def numbered() -> None:
            self.add(*(f"L({k}) = {text};" for k, text in enumerate(texts, 1)))

        def names() -> None:
            self.add(*(f"L{k} = {text};" for k, text in enumerate(texts, 1)))
            self.add(
                f"L = [{self.dice.choice([' ', ', ']).join(f'L{k}' for k in range(1, n + 1))}];"
            )

        def grown() -> None:
            self.add("L = [];", *(f"L = [L {text}];" for text in texts))

        def at_end() -> None:
            self.add(f"L(1) = {texts[0]};", *(f"L(end+1) = {text};" for text in texts[1:]))

        def reverse() -> None:
            self.add(*(f"L({k}) = {text};" for k, text in enumerate(reversed(texts), 1)))
            self.add(self.dice.choice(["L = fliplr(L);", "L = L(end:-1:1);", f"L = L({n}:-1:1);"]))

        def sliced() -> None:
            spare = self.link()[0]
            self.add(*(f"L({k}) = {text};" for k, text in enumerate([*texts, spare], 1)))
            self.what = self.dice.choice([f"L(1:{n})", "L(1:end-1)"])

        def removed() -> None:
            spare = self.link()[0]
            at = self.dice.randrange(n + 1)
            whole = [*texts[:at], spare, *texts[at:]]
            self.add(*(f"L({k}) = {text};" for k, text in enumerate(whole, 1)))
            self.add(f"L({at + 1}) = [];")

        def picked() -> None:
            order = list(range(n))
            self.dice.shuffle(order)
            self.add(*(f"L({k}) = {texts[j]};" for k, j in enumerate(order, 1)))
            back = " ".join(str(order.index(j) + 1) for j in range(n))
            self.what = f"L([{back}])"

        def cells() -> None:
            self.add(*(f"C{{{k}}} = {text};" for k, text in enumerate(texts, 1)), "L = [C{:}];")

        def out_of_order() -> None:
            lines = [f"L({k}) = {text};" for k, text in enumerate(texts, 1)]
            self.add(*reversed(lines))

        def joined() -> None:
            self.add(f"A = [{texts[0]}];", f"B = [{' '.join(texts[1:])}];", "L = [A, B];")

        self.pick(
            numbered,
            numbered,
            numbered,
            names,
            grown,
            at_end,
            reverse,
            sliced,
            removed,
            picked,
            cells,
            out_of_order,
            joined,
        )
        self.rows = rows
        if self.what == "L":
            for k, row in enumerate(rows, 1):
                if self.chance(0.15):
                    self.set_one(f"L({k})", row)
        if self.chance(0.2):
            self.add(f"probe = {self.link()[0]};")

    def of_matrix(self, n: int, robot: str) -> None:
        """Make the robot of a matrix."""
        self.matrix = True
        lines = []
        for _ in range(n):
            row, texts = self.row()
            row.flip, row.qlim = False, None
            cells = [texts.get("theta", "0"), texts.get("d", "0"), texts["a"], texts["alpha"]]
            cells += [str(row.sigma), texts.get("offset", "0")]
            lines.append(" ".join(cell.replace(" ", "") for cell in cells))
            self.rows.append(row)
        self.add(f"DH = [{self.dice.choice(['; ', chr(10) + '      ']).join(lines)}];")
        if self.chance(0.3):
            self.add("DH(:,3) = DH(:,3)*2;")
            for row in self.rows:
                row.a *= 2
        flag = ", 'modified'" if self.modified else ""
        self.add(f"{robot} = SerialLink(DH, 'name', 'arm'{flag});")

    def computed(self, n: int) -> None:
        """Make links in a loop over arrays."""
        d = [self.dice.choice([0, 0.1, 0.4]) for _ in range(n)]
        a = [self.dice.choice([0, 0.2, 0.3]) for _ in range(n)]
        turns = [self.dice.choice([0, 1, -1]) for _ in range(n)]
        alpha = [{0: "0", 1: "pi/2", -1: "-pi/2"}[k] for k in turns]
        flag = ", 'modified'" if self.modified else ""
        self.add(f"d = [{' '.join(map(str, d))}]; a = [{' '.join(map(str, a))}];")
        self.add(f"alpha = [{' '.join(alpha)}];", f"for k = 1:{n}")
        self.add(
            self.dice.choice(
                [
                    f"    L(k) = Link([0 d(k) a(k) alpha(k)]{flag});",
                    f"    L(k) = Link('d', d(k), 'a', a(k), 'alpha', alpha(k){flag});",
                ]
            ),
            "end",
        )
        self.rows = [Row(0, 0.0, d[k], a[k], turns[k] * math.pi / 2) for k in range(n)]

    def set_one(self, target: str, row: Row) -> None:
        kind = self.dice.randrange(5)
        if kind == 0:
            text, row.offset = self.length() if row.sigma else self.turn()
            self.add(f"{target}.offset = {text};")
        elif kind == 1:
            text, row.a = self.length()
            self.add(f"{target}.a = {text};")
        elif kind == 2:
            text, row.alpha = self.turn()
            self.add(f"{target}.alpha = {text};")
        elif kind == 3:
            row.qlim = (-2.0, 2.0)
            self.add(f"{target}.qlim = [-2 2];")
        else:
            row.flip = True
            self.add(f"{target}.flip = true;")

    def pose(self, depth: int = 0) -> tuple[str, np.ndarray]:
        """Return a placement, and its matrix."""
        text, x = self.length()
        kind = self.dice.randrange(10 if depth == 0 else 6)
        if kind == 0:
            return f"transl({text}, 0, 0.1)", _t(x, 0, 0.1)
        if kind == 1:
            return f"transl([0 {text.replace(' ', '')} 0])", _t(0, x, 0)
        if kind == 2:
            turn, t = self.turn()
            axis = self.dice.randrange(3)
            return f"trot{'xyz'[axis]}({turn})", (_rx, _ry, _rz)[axis](t)
        if kind == 3:
            return "trotz(90, 'deg')", _rz(math.pi / 2)
        if kind == 4:
            return "troty(-pi/2)", _ry(-math.pi / 2)
        if kind == 5:
            turn, t = self.turn()
            return f"rpy2tr(0, 0, {turn})", _rz(t)
        if kind == 6:
            return self.dice.choice(
                [
                    (f"SE3({text}, 0, 0.2)", _t(x, 0, 0.2)),
                    ("SE3.Rx(pi/2)", _rx(math.pi / 2)),
                    ("SE3.Ry(30, 'deg')", _ry(math.pi / 6)),
                    ("SE3(0, 0, 0.3) * SE3.Rz(pi)", _t(0, 0, 0.3) @ _rz(math.pi)),
                ]
            )
        if kind == 7:
            return (
                f"[1 0 0 {text.replace(' ', '')}; 0 1 0 0; 0 0 1 0.2; 0 0 0 1]",
                _t(x, 0, 0.2),
            )
        one, A = self.pose(1)
        two, B = self.pose(1)
        if kind == 8:
            return f"{one} * {two}", A @ B
        return f"{one} * inv({two})", A @ np.linalg.inv(B)

    def arguments(self) -> str:
        """Return base and tool among the arguments of the robot."""
        found = ""
        if self.chance(0.25):
            text, self.tool = self.pose()
            if self.chance(0.4):
                self.add(f"flange = {text};")
                text = "flange"
            found += f", 'tool', {text}"
        if self.chance(0.15):
            text, self.base = self.pose()
            found += f", 'base', {text}"
        return found

    def later(self, robot: str) -> None:
        """Set base, tool, offsets and limits once the robot is made."""
        if self.chance(0.4):
            text, T = self.pose()
            key = self.dice.choice(["base", "tool"])
            before = getattr(self, key)
            kind = self.dice.randrange(5)
            if kind == 0:
                self.add(f"{robot}.{key} = {robot}.{key} * {text};")
                setattr(self, key, before @ T)
            elif kind == 1:
                self.add(f"{robot}.{key}(3,4) = 0.6;")
                changed = before.copy()
                changed[2, 3] = 0.6
                setattr(self, key, changed)
            elif kind == 2:
                self.add(f"{robot}.{key}(1:3,4) = [0.1; 0.2; 0.3];")
                changed = before.copy()
                changed[:3, 3] = 0.1, 0.2, 0.3
                setattr(self, key, changed)
            else:
                self.add(f"{robot}.{key} = {text};")
                setattr(self, key, T)
        kind = self.dice.randrange(8)
        k = self.dice.randrange(len(self.rows))
        turns = not any(row.sigma for row in self.rows)
        if kind == 0 and turns:
            texts = [self.turn() for _ in self.rows]
            self.add(f"{robot}.offset = [{' '.join(text.replace(' ', '') for text, _ in texts)}];")
            for row, (_, value) in zip(self.rows, texts, strict=True):
                row.offset = value
        elif kind == 1 and not self.rows[k].sigma:
            text, value = self.turn()
            self.add(f"{robot}.offset({k + 1}) = {text};")
            self.rows[k].offset = value
        elif kind == 2:
            self.set_one(f"{robot}.links({k + 1})", self.rows[k])
