"""Pasted programs: the robot that the program makes, or a refusal with the line."""

from __future__ import annotations

import contextlib
import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dh_to_urdf import DHError, dh_matrices, read_pasted
from tests.cost import within
from tests.dh_to_urdf.pasted.program_grammar import form

FIXTURES = Path(__file__).parents[2] / "fixtures"
Q = (0.3, -0.4)
TIP = (0.485602, 0.068689, 0.4)
"""Where the arm of the cases has its tip at q, by the product of its two link matrices."""
PY = "L = [RevoluteDH(d=0.4, a=0.3), RevoluteDH(a=0.2, alpha=pi)]\n"
M = "L(1) = Link([0 0.4 0.3 0]);\nL(2) = Link([0 0 0.2 pi]);\n"
ARM_PY, ARM_M = f"{PY}robot = DHRobot(L)\n", f"{M}arm = SerialLink(L);\n"


def tip(text: str, convention: str = "standard", q: Any = Q) -> np.ndarray:
    return dh_matrices(read_pasted(text, convention), np.array(q)).T[:3, 3]


CASES = {
    "tool of super().__init__": (
        "class Arm(DHRobot):\n    def __init__(self):\n"
        "        L = [RevoluteDH(d=0.4, a=0.3), RevoluteDH(a=0.2, alpha=pi)]\n"
        "        super().__init__(L, name='arm', tool=SE3(0.25, 0, 0))\n",
        (0.734353, 0.043731, 0.4),
    ),
    "base of self.model": (
        f"{M}self.model = SerialLink(L, 'name', 'a');\nself.model.base = transl(0,0,0.5);",
        (0.485602, 0.068689, 0.9),
    ),
    "one element of base": (f"{ARM_M}arm.base(3,4) = 0.5;", (0.485602, 0.068689, 0.9)),
    "base in place": (f"{ARM_PY}robot.base *= SE3.Tz(0.5)", (0.485602, 0.068689, 0.9)),
    "slice": (f"{M}L(3) = Link([0 0 0.9 0]);\narm = SerialLink(L(1:2));", TIP),
    "insert": (
        "L = [RevoluteDH(a=0.2, alpha=pi)]\nL.insert(0, RevoluteDH(d=0.4, a=0.3))\n"
        "robot = DHRobot(L)",
        TIP,
    ),
    "stray link": (f"{ARM_M}probe = Link([0 0.1 0.1 0]);", TIP),
    "offset of one joint": (f"{ARM_M}arm.offset(1) = pi/2;", (-0.068689, 0.485602, 0.4)),
    "offset before": (f"{M}L(1).offset = pi/2;\narm = SerialLink(L);", (-0.068689, 0.485602, 0.4)),
    "offset after": (f"{ARM_M}L(1).offset = pi/2;", (-0.068689, 0.485602, 0.4)),
    "offsets of the robot": (f"{ARM_M}arm.offset = [pi/2 0];", (-0.068689, 0.485602, 0.4)),
    "variable set twice": (
        "a = 0.3;\nL1 = Link([0 0.4 a 0]);\na = 0.2;\nL2 = Link([0 0 a pi]);\n"
        "arm = SerialLink([L1 L2]);",
        TIP,
    ),
    "tool by transl": (f"{ARM_M}arm.tool = transl(0,0,0.1);", (0.485602, 0.068689, 0.3)),
    "name of another variable": (f"{PY}base = 26\nrobot = DHRobot(L)", TIP),
    "main guard": (
        f"{PY}if __name__ == '__main__':\n    robot = DHRobot(L)\n    print(robot)",
        TIP,
    ),
    "f-string and try import": (
        "try:\n    import matplotlib\nexcept ImportError:\n    matplotlib = None\n"
        f"{PY}robot = DHRobot(L, name=f'arm-{{1}}')\nprint(f'{{robot}}')",
        TIP,
    ),
    "function file": (f"function arm = make()\n{ARM_M}end", TIP),
    "model function of the Toolbox": (
        f"function r = mdl_arm()\n{M}robot = SerialLink(L, 'name', 'A/1');\nq = [0 0];\n"
        "if nargin == 1\n r = robot;\nelseif nargin == 0\n assignin('caller', 'arm', robot);\n"
        " assignin('caller', 'qz', q);\nend\nend\n",
        TIP,
    ),
    "class of MATLAB": (
        "classdef Arm < handle\n properties\n  model\n end\n methods\n  function self = Arm(base)\n"
        "   if nargin < 1\n    base = transl(0,0,0.5);\n   end\n   self.make();\n"
        "   self.model.base = base;\n  end\n  function make(self)\n   "
        + f"{M}   self.model = SerialLink(L, 'name', 'a');\n  end\n end\nend\n",
        (0.485602, 0.068689, 0.9),
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_robot_is_the_one_that_the_program_makes(case):
    text, where = CASES[case]
    assert tip(text) == pytest.approx(where, abs=1e-6)


@pytest.mark.parametrize("type_", ["prismatic", "fixed", "revolute"])
@pytest.mark.parametrize("body", ["", "body1.Joint = jnt1;\naddBody(robot, body1, 'base');\n"])
def test_a_rigid_body_tree_has_the_joints_that_it_says(type_, body):
    second = body.replace("1", "2").replace("'base'", "'body1'")
    text = (
        "% a alpha d theta\ndhparams = [0.3 0 0.4 0;\n            0.2 pi 0 0];\n"
        "robot = rigidBodyTree;\nbody1 = rigidBody('body1');\n"
        "jnt1 = rigidBodyJoint('jnt1','revolute');\nbody2 = rigidBody('body2');\n"
        f"jnt2 = rigidBodyJoint('jnt2','{type_}');\n"
        "setFixedTransform(jnt1,dhparams(1,:),'dh');\n"
        f"setFixedTransform(jnt2,dhparams(2,:),'dh');\n{body}{second}"
    )
    table = read_pasted(text, "standard")
    assert [row.type.value for row in table.rows] == ["revolute", type_]
    with pytest.raises(DHError, match="convention=standard"):
        read_pasted(text, "modified")
    if body:
        with pytest.raises(DHError, match="body 'body2' is on 'base'; only a serial chain"):
            read_pasted(
                text.replace("'body1');\n", "'base');\n").replace("Body('base'", "Body('body1'"),
                "dh",
            )
        with pytest.raises(DHError, match="joint is changed after it was given on"):
            read_pasted(text + "setFixedTransform(jnt1, dhparams(2,:), 'dh');", "dh")


TOUCHING = [
    *(
        (ARM_PY, line)
        for line in (
            "setattr(robot, 'base', SE3.Tx(1))",
            "exec('robot.base = SE3.Tx(1)')",
            "robot.links.append(RevoluteDH(a=1))",
            "robot.links[0] = RevoluteDH(a=1)",
            "robot.tool.t[0] = 1",
            "while x: robot.base *= SE3.Tx(1)",
            "if x: robot.base = SE3.Tx(1)",
            "for k in x: L[0].a = k",
            "tweak(robot)",
            "robot.tweak()",
            "robot.links[0].flip = True",
            "robot.links[0].twist = 1",
            "robot.base = SE3.Tx(x)",
            "robot.base = load(1)",
            "robot._T = SE3.Tx(1).A",
            "L.sort(key=lambda l: l.a)",
            "g = lambda: L.pop()",
            "L[0].a = x.y",
            "with f() as g: L[0].a = 3",
            "robot = tweak(robot)",
            "T = np.eye(4); robot.tool = T; T[2, 3] = 1",
            "globals()['robot'].base = SE3.Tx(1)",
        )
    ),
    *(
        (ARM_M, line)
        for line in (
            "eval('arm.base = transl(0,0,1);');",
            "tweak(arm);",
            "tweak;",
            "load x.mat",
            "while x, arm.base = transl(0,0,1); end",
            "if x9 == 2, arm.base = transl(0,0,1); end",
            "for k=1:n9, L(k).a = k; end",
            "arm.links(2) = Link([0 0 5 0]);",
            "arm.addprop('x');",
            "L(1).twist = 3;",
            "arm.base = f9(1);",
            "arm.base = arm.base + 1;",
            "try, arm.base = transl(0,0,1); catch, end",
            "switch x, case 1, arm.base = transl(0,0,1); end",
            "L(1).a = @(x) x;",
            "arm.links(1).a = x9(3);",
            "g = @() arm.tweak();",
        )
    ),
]


@pytest.mark.parametrize(("program", "line"), TOUCHING)
def test_a_statement_that_touches_a_robot_and_is_not_read_is_refused_with_its_line(program, line):
    with pytest.raises(DHError, match=rf"line {program.count(chr(10)) + 1}\b"):
        read_pasted(program + line, "standard")


@pytest.mark.parametrize(
    ("program", "line"),
    [
        *(
            (ARM_PY, line)
            for line in (
                "print(robot)",
                "q = robot.ikine_LM(T)",
                "robot.plot([0, 0])",
                "x = robot.links[0].a",
                "import matplotlib.pyplot as plt\nplt.figure()\nplt.plot([1, 2])",
                "def f(q):\n    return robot.fkine(q)\nf([0, 0])",
                "for q in x:\n    robot.plot(q)",
                "assert robot.n == 2",
                "robot.qz = [0, 0]",
            )
        ),
        *(
            (ARM_M, line)
            for line in (
                "arm.plot([0 0]); hold on; view(3)",
                "arm.teach",
                "disp(arm)",
                "arm",
                "for i=1:10, arm.plot([i 0]); pause(.1); end",
                "syms q1 q2; T = arm.fkine([q1 q2])",
                "J = arm.jacob0([0 0]); x = J(1,:)*2;",
                "% arm.base = transl(0,0,9);",
                "%{\narm.base = transl(0,0,9);\n%}",
                "if x9, disp('a'); end",
                "q = [0 pi/2]';",
            )
        ),
    ],
)
def test_what_leaves_the_robot_as_it_is_changes_nothing(program, line):
    assert tip(program + line) == pytest.approx(TIP, abs=1e-6)


def test_several_robots_are_refused_by_name_unless_one_is_named():
    text = f"{PY}left = DHRobot(L, name='l')\nright = DHRobot(L[:1], name='r')\n"
    with pytest.raises(DHError, match=r"2 robots: 'left' \(line 2\), 'right' \(line 3\)"):
        read_pasted(text, "dh")
    assert read_pasted(text, "dh", name="r").dof == 1
    assert read_pasted(text, "dh", name="left").dof == 2


def test_links_of_another_robot_are_refused_with_the_line():
    text = (
        "links = [RevoluteDH(d=0.4, a=0.3)]\npuma = models.DH.Puma560()\n"
        "links.extend(puma.links)\nrobot = DHRobot(links)\n"
    )
    with pytest.raises(DHError, match=r"line 3: .*Puma560\(\) is not read, line 2"):
        read_pasted(text, "dh")


def test_columns_as_lists_of_their_own():
    text = (
        "a = [0.0642, 0.305, 0, 0, 0, 0]\nd = [0.16977, 0, 0, -0.22263, 0, -0.03625]\n"
        "alpha = [-pi/2, 0, pi/2, -pi/2, pi/2, 0]\n"
    )
    q = np.radians([90, 0, 30, 45, 10, 0])
    assert tip(text, q=q) == pytest.approx((0.004451, 0.236181, -0.051724), abs=1e-6)
    with pytest.raises(DHError, match="differ in length"):
        read_pasted(text.replace(", 0]\nd", "]\nd"), "dh")


def test_a_dictionary_of_sympy():
    text = (
        "q1, q2 = symbols('q1:3')\ns = {alpha0: 0, a0: 0, d1: 0.4, q1: q1,\n"
        "     alpha1: -pi/2, a1: 0.3, d2: 0, q2: q2 - pi/2}\n"
    )
    rows = read_pasted(text, "modified").rows
    assert [(row.alpha, row.a, row.d) for row in rows] == [(0, 0, 0.4), (-math.pi / 2, 0.3, 0)]
    assert rows[1].offset == -math.pi / 2
    with pytest.raises(DHError, match="convention=modified"):
        read_pasted(text, "standard")


def test_degrees_and_millimetres_hold_for_base_and_tool_too():
    text = "L(1) = Link([0 400 300 90]);\narm = SerialLink(L, 'tool', transl(0,0,100)*trotx(90));"
    with pytest.raises(DHError, match="90 in trotx has no unit"):
        read_pasted(text, "dh", length="mm")
    table = read_pasted(text, "dh", angle="deg", length="mm")
    assert (table.rows[0].d, table.tool[2, 3]) == (0.4, 0.1)
    assert table.tool[:3, :3] == pytest.approx(np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]))


def test_bytes_of_windows_are_read_with_a_warning():
    text = f"% Parámetros, ángulos\n{ARM_M}".encode("latin-1")
    table = read_pasted(text, "dh")
    assert "Windows-1252" in table.warnings[0]


def test_a_tool_that_the_robot_is_not_given_is_told():
    table = read_pasted(f"{ARM_PY}tool = SE3(0, 0, 0.3)\n", "dh")
    assert "tool is a variable of the text" in table.warnings[0]
    assert read_pasted(f"{PY}tool = SE3(0, 0, 0.3)\n", "dh").tool[2, 3] == 0.3


@pytest.mark.parametrize("language", ["python", "matlab"])
def test_no_program_of_the_grammar_is_read_as_another_robot(language):
    read = 0
    for seed in range(150):
        made = form(seed, language)
        try:
            table = read_pasted(made.text, "modified" if made.modified else "standard")
        except DHError:
            continue
        read += 1
        assert table.dof == len(made.rows), made.text
        for q in np.random.default_rng(seed).uniform(-1, 1, (2, table.dof)):
            error = np.abs(dh_matrices(table, q).T - made.pose(list(q))).max()
            assert error < 1e-9, made.text
        limits = [(r.limits.lower, r.limits.upper) for r in table.rows]
        assert limits == [row.qlim or (None, None) for row in made.rows], made.text
    assert read >= 0.8 * 150


def test_no_program_is_read_as_another_robot_than_the_toolbox_made():
    """The Robotics Toolbox for Python 1.5.0 has run each of them."""
    programs = json.loads((FIXTURES / "toolbox_programs.json").read_text())
    read = 0
    for program in programs:
        try:
            table = read_pasted(program["text"], "mdh" if program["modified"] else "dh")
        except DHError:
            continue
        read += 1
        assert table.dof == len(program["q"][0]), program["text"]
        T = dh_matrices(table, np.array(program["q"])).T[:, :3]
        assert np.abs(T - np.array(program["T"])).max() < 1e-9, program["text"]
    assert len(programs) > 200
    assert read >= 0.8 * len(programs)


def _styled(model: dict[str, Any], style: int) -> str:
    """Write the numbers of a model of the Toolbox as a class of our own."""
    suffix = "MDH" if model["modified"] else "DH"
    links = []
    for sigma, theta, d, a, alpha, offset, flip, limits in model["rows"]:
        name, first = ("Prismatic", theta) if sigma else ("Revolute", d)
        links.append(
            f"rtb.{name}{suffix}({'theta' if sigma else 'd'}={first!r}, a={a!r},"
            f" alpha={alpha!r}, offset={offset!r}, flip={flip}, qlim={limits})"
        )
    body = ["links = []", *(f"links.append({link})" for link in links)]
    if style == 1:
        body = [f"links = [{', '.join(links)}]"]
    base, tool = f"SE3(np.array({model['base']}))", f"SE3(np.array({model['tool']}))"
    body.append(f"super().__init__(links, name='m', base={base}, tool={tool})")
    if style == 2:
        body[-1:] = ["super().__init__(links)", f"self.base = {base}", f"self.tool = {tool}"]
    inside = "\n".join(f"        {line}" for line in body)
    return f"class Model(rtb.DHRobot):\n    def __init__(self):\n{inside}\n        self.qz = 0\n"


@pytest.mark.parametrize("style", [0, 1, 2])
def test_the_models_of_the_toolbox_are_read_as_it_computes_them(style):
    models = json.loads((FIXTURES / "toolbox_models.json").read_text())
    assert len(models) == 24
    for model in models:
        table = read_pasted(_styled(model, style), "mdh" if model["modified"] else "dh")
        T = dh_matrices(table, np.array(model["q"])).T[:, :3]
        assert np.abs(T - np.array(model["T"])).max() < 1e-9, model["name"]


@pytest.mark.parametrize(
    "piece",
    [
        "a=",
        "L=[L,Link('d',0)];\n",
        "RevoluteDH(),",
        "x=[x x];",
        "if 1,",
        "f(",
        "a.b.",
        "1+",
        "x'",
        "b=b+b;",
        "Link('d',0);\n",
        "for i=1:9,",
        "def f():\n f()\n",
        "L=[RevoluteDH()]*9\n",
        "not ",
        "lambda:",
        "a**",
        "[*",
        "'",
        "\\",
        "{",
        "class A(A):\n pass\n",
        "x if x else ",
    ],
)
def test_long_programs_take_no_time(piece):
    for head in ("", "L = [RevoluteDH(d=1)]\n", "L(1) = Link('d', 1);\n"):
        started = time.thread_time()
        with contextlib.suppress(DHError):
            read_pasted((head + piece * 100_000)[:99_000], "standard")
        assert within(time.thread_time() - started, 5)


def test_loops_and_calls_without_end_are_refused():
    for text in (
        "def f(n):\n    return f(n)\nrobot = DHRobot(f(1))",
        "L = [RevoluteDH() for a in range(4000) for b in range(4000)]",
        "for a in range(4000):\n    for b in range(4000):\n        x = 1\nL = [RevoluteDH()]",
        "x = 9**9**9**9\nL = [RevoluteDH(d=x)]",
        "x = [0]*10**9\nL = [RevoluteDH(d=x[0])]",
        "L = [RevoluteDH()]\nL.append(L)\nrobot = DHRobot(L)",
    ):
        with pytest.raises(DHError):
            read_pasted(text, "standard")
