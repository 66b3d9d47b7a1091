import math
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import (
    Convention,
    DHError,
    JointType,
    dh_matrices,
    read_csv,
    read_mapping,
    read_pasted,
)
from dh_to_urdf.pasted.latex import plain_cell
from tests.cost import within

ARM = read_mapping(
    {
        "convention": "modified",
        "joints": [
            {"type": "R", "alpha": 0, "a": 0, "d": 0.4, "theta": "q1"},
            {"type": "R", "alpha": "-pi/2", "a": 0, "d": 0, "theta": "q2 - 90°"},
            {"type": "P", "alpha": "pi/2", "a": 0.3, "d": "d3", "theta": 0},
        ],
    }
)
LATEX = r"""
\begin{table}[ht]
\centering
\caption{Parameters of the arm, $\alpha_{i-1}$ in rad}\label{tab:dh}
\begin{tabular}{|c|c|c|c|c|} \hline
% a comment
$i$ & $\alpha_{i-1}$ & $a_{i-1}$ & $d_i$ & $\theta_i$ \\ \hline\hline
1 & $0$ & 0 & $0{,}4$ & $\theta_1$ \\ \hline
2 & $-\frac{\pi}{2}$ & 0 & 0 & $\theta_2 - 90^\circ$ \\[2pt] \cline{2-3}
3 & $\dfrac{\pi}{2}$ & $0.3$ & $d_{3}$ & 0 \\ \bottomrule
\end{tabular}
\end{table}
"""
TEXTS = {
    "latex": LATEX,
    "latex without dollars": r"""\begin{tabular}{lrrrr} \toprule
        Link & \(\alpha_{i-1}\) [\si{\degree}] & \textbf{$a_{i-1}$} (mm) & $d_i$ (\unit{mm}) &
        $\theta_i^*$ [$^\circ$]\\ \midrule
        \textbf{1} & \phantom{-}0 & 0 & 400 & $\theta_1^*$ \\ \addlinespace[2pt]
        2 & \ang{-90} & 0 & 0 & $\theta_2^{\star} - 90$ \\ \cmidrule(lr){1-2}
        3 & 90 & 300 & $d_3$ & \SI{0}{\degree} \\ \bottomrule
        \end{tabular}""",
    "pmatrix": r"""T = \begin{pmatrix} \alpha_{i-1} & a_{i-1} & d_i & \theta_i \\
        0 & 0 & 0.4 & \theta_1 \\ -\pi/2 & 0 & 0 & -\tfrac\pi2 + \theta_2 \\
        \frac{\pi}{2} & 0.3 & d_3 & 0 \end{pmatrix}""",
    "rows alone": r"""\alpha & a & d & \theta \\ 0 & 0 & 0.4 & q_1 \\
        -\pi/2 & 0 & 0 & q_2-\pi/2 \\ \pi/2 & .3 & q_3 & 0""",
    "markdown": """
Some words before it.

| Joint | α(i-1) | a(i-1) |  d  |    θ     |
|:-----:|-------:|--------|-----|----------|
|   1   |    0   |   0    | 0,4 | θ1*      |
|   2   |  -π/2  |   0    |  0  | θ2* - 90° |
|   3   |   π/2  |  0,3   | d3  |    0     |
""",
    "box": """
┌───┬─────────┬──────────┬────────┬─────────────────┐
│ j │ ⍺ⱼ₋₁    │  aⱼ₋₁    │   dⱼ   │       θⱼ        │
├───┼─────────┼──────────┼────────┼─────────────────┤
│ 1 │    0.0° │        0 │    0.4 │  q1             │
│ 2 │  -90.0° │        0 │      0 │  q2 - 90°       │
│ 3 │   90.0° │      0.3 │     q3 │  0              │
└───┴─────────┴──────────┴────────┴─────────────────┘
""",
    "spreadsheet": 'i\tα [°]\ta [mm]\td [mm]\tθ [°]\t\n1\t0\t0\t"400"\tq1\t\n'
    "2\t-90\t0\t0\tq2-90\t\n3\t90\t300\td3\t0,0\t\n",
    "wide columns": """
 i    twist      a      d      theta
 1    0          0      0,4    th1
 2    -90 deg    0      0      th2 - 90 deg
 3    90 deg     0,3    d3     0
""",
    "narrow columns": "i α a d θ σ\n1 0 0 .4 θ₁ 0\n2 -π/2 0 0 θ₂-π/2 0\n3 π/2 .3 d₃ 0 1\n",
    "comma": "type,alpha,a,d,theta\nR,0,0,0.4,*\nR,-pi/2,0,0,q-pi/2\nP,pi/2,0.3,*,0\n",
    "semicolon": "type;alpha;a;d;theta\nR;0;0;0,4;-\nR;-90°;0;0;q2-90°\nP;90°;0,3;–;0\n",
    "matrix": """% alpha  a  d  theta  sigma
        DH = [ 0      0    0.4  0      0
               -pi/2  0    0    -pi/2  0    % the shoulder
               pi/2   0.3  0    0      1 ];
        plot(q0)""",
    "matrix with signs": """% theta  d  a  alpha sigma
        DH = [0 1-.6, 0 0 0; -pi/2 0, 0 -pi/2 0; ...
              0 0 .3 pi / 2 1];""",
    "numpy": """import numpy as np   # alpha, a, d, theta, sigma
        dh = np.array([[0, 0, 0.4, 0, 0], [-np.pi/2, 0, 0, -np.pi/2, 0],
                       [np.radians(90), 0.3, 0, 0, 1]])""",
    "links": """deg = pi/180; reach = 0.3;  % lengths in m
        L(1) = Link('d', 0.4, 'a', 0, 'alpha', 0, 'modified');
        L(3) = Link('prismatic', 'theta', 0, 'a', reach, 'alpha', pi/2, 'modified');
        L(2) = Link('d', 0, 'alpha', -90*deg, 'offset', -pi/2, 'modified');
        robot = SerialLink(L, 'name', 'arm');
        robot.plot([0 0 0])""",
    "vectors": """L1 = Link([0 0.4 0 0 0], 'modified');
        L2 = Link([0 0 0 -pi/2 0 -pi/2], 'modified'); L3 = Link([0 0 .3 pi/2 1], 'modified');
        arm = SerialLink([L1 L2 L3], 'name', 'arm')""",
    "serial link": """DH = [0 0.4 0 0 0 0; 0 0 0 -pi/2 0 -pi/2; 0 0 0.3 pi/2 1 0];
        q = [0 0 0];
        SerialLink(DH, 'modified', 'name', 'arm')""",
    "python": """from math import pi
        robot = DHRobot([
            RevoluteMDH(d=0.4),
            RevoluteMDH(alpha=-pi/2, offset=-pi/2, m=17.4, I=[0.1, 0.5, 0.5, 0, 0, 0]),
            PrismaticMDH(a=0.3, alpha=pi/2, qlim=None),
        ], name="arm")""",
}


def same(table, other, digits=1e-15):
    assert [row.type for row in table.rows] == [row.type for row in other.rows]
    q = np.random.default_rng(0).uniform(-3, 3, (20, other.dof))
    assert np.abs(dh_matrices(table, q).T0 - dh_matrices(other, q).T0).max() < digits


@pytest.mark.parametrize("form", TEXTS)
def test_the_same_arm_in_every_form(form):
    same(read_pasted(TEXTS[form], "modified"), ARM)
    same(read_pasted(TEXTS[form].encode(), " Craig ", name="x", angle="rad"), ARM)


def test_a_tree_of_khalil():
    text = """
        j  a(j)  σ  γ    b    α    d    θ       r
        1  0     0  0    0    0    0    θ1      0.2
        2  1     0  0    0    90°  0.1  θ2      0
        3  1     1  π/3  0.2  -90°  0.3  0      r3 + 0,1
        4  3     2  0    0    0    0.1  45°     0
    """
    rows = read_pasted(text, "khalil").rows
    assert [row.parent for row in rows] == [0, 1, 1, 3]
    assert [row.type.value[0] for row in rows] == ["r", "r", "p", "f"]
    assert (rows[2].gamma, rows[2].b, rows[2].offset) == (math.pi / 3, 0.2, 0.1)
    assert rows[3].theta == math.pi / 4


def test_units_of_a_column_of_a_cell_and_of_the_table():
    text = "i\ta [mm]\tα [°]\td\tθ\n1\t300\t90\t200\tq1 + 45\n2\t0.2m\tpi/2\t0\tq2 - pi/2\n"
    rows = read_pasted(text, "dh", angle="deg", length="mm").rows
    assert [(row.a, row.alpha, row.d) for row in rows] == [
        (0.3, math.pi / 2, 0.2),
        (0.2, math.pi / 2, 0),
    ]
    assert [row.offset for row in rows] == [math.pi / 4, -math.pi / 2]


def test_limits_in_columns_and_as_qlim():
    text = "| i | a | α | d | θ | min | max |\n|-|-|-|-|-|-|-|\n|1|0|0|0|q1|-160°|160°|\n"
    limits = read_pasted(text, "dh").rows[0].limits
    assert (limits.lower, limits.upper) == (math.radians(-160), math.radians(160))
    for qlim in (
        "[-160 160]*pi/180",
        "[-160, 160]/180*pi",
        "deg2rad([-160 160])",
        "[-160*deg, 160*deg]",
        "[-160 160]*deg",
        "[-8*pi/9 8*pi/9]",
    ):
        rows = read_pasted(f"deg = pi/180;\nLink('d', 0, 'qlim', {qlim})", "dh").rows
        assert rows[0].limits.lower == pytest.approx(math.radians(-160), rel=1e-15), qlim
        assert rows[0].limits.upper == pytest.approx(math.radians(160), rel=1e-15), qlim
    rows = read_pasted("PrismaticDH(qlim=np.array([-0.5, 1]), flip=True)", "dh").rows
    assert (rows[0].limits.lower, rows[0].limits.upper, rows[0].sign) == (-0.5, 1, -1)


def test_base_and_tool_stand_beside_the_table():
    matrix = "[1 0 0 0; 0 1 0 0; 0 0 1 -0.1; 0 0 0 1]"
    nested = "[[1, 0, 0, 0.2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
    for text in (
        f"{TEXTS['markdown']}\ntool = {matrix}\nbase: {nested}\n",
        f"{TEXTS['links']}\nrobot.tool = {matrix};\nrobot.base = transl(0.2, 0, 0);",
        f"{LATEX}\n% tool = {matrix}\n% base = {nested}",
    ):
        table = read_pasted(text, "mdh")
        assert (table.tool[2, 3], table.base[0, 3]) == (-0.1, 0.2)
        same(table, ARM)
    for text in (
        "tool = transl(0, 0, 0.1)",
        "tool = [0 0 0.1]",
        f"tool = {matrix}\ntool = {matrix}",
    ):
        with pytest.raises(DHError, match="tool") as caught:
            read_pasted(f"{TEXTS['markdown']}\n{text}", "mdh")
        assert caught.value.faults[0].location == ("tool",)


def test_names_have_values_from_the_caller_or_from_the_text():
    text = r"""\begin{array}{cccc} a_i & \alpha_i & d_i & \theta_i \\
        l_1 & 0 & d_1 & \theta_1 \\ 2 l_{2} & \alpha & 0 & \theta_2 \end{array}"""
    values = {"l1": 0.5, "l_2": "100mm", "d1": 0.2}
    with pytest.raises(DHError) as caught:
        read_pasted(text, "dh", values=values)
    assert [p.message for p in caught.value.faults] == [
        "joint 2 (line 2, column \\alpha_i): '\\\\alpha' is 'alpha', which has an unknown name"
        " 'alpha'; if it is a number, give values alpha:0.5"
    ]
    rows = read_pasted(text, "dh", values=values | {"alpha": "90°"}).rows
    assert [(row.a, row.d, row.alpha) for row in rows] == [(0.5, 0.2, 0), (0.2, 0, math.pi / 2)]
    script = "a2 = 0.4; a3 = a2/2;\nL(1) = Link('d',0,'a',a2);\nL(2) = Link('d',0,'a',a3);"
    assert [row.a for row in read_pasted(script, "dh").rows] == [0.4, 0.2]
    assert [row.a for row in read_pasted(script, "dh", values={"a2": 1}).rows] == [1, 0.5]


def test_the_variable_tells_the_type():
    text = "| i | a | α | d | θ |\n|-|-|-|-|-|\n|1|0|0|{d}|{theta}|\n|2|0|0|0|q2|\n"

    def first(d, theta, **options):
        return read_pasted(text.format(d=d, theta=theta), "dh", **options).rows[0]

    assert first("d1", "30°").type is JointType.PRISMATIC
    assert first("q1", "30°").type is JointType.PRISMATIC
    assert first("0.5", "θ1").type is JointType.REVOLUTE
    row = first("d1", "θ1", values={"d1": 0.5})
    assert (row.type, row.d) == (JointType.REVOLUTE, 0.5)
    row = first("d1", "θ1", values={"θ1": 0.5})
    assert (row.type, row.theta) == (JointType.PRISMATIC, 0.5)
    for d, theta, words in (
        ("d1", "θ1", ("column d", "'d1' holds d1", "give values d1:0.5")),
        ("q1", "θ1", ("column d", "both hold a joint variable")),
        ("0.5", "30°", ("line 3", "its type is open", "write theta1 or d1")),
        ("d7", "0", ("line 3", "type is open")),
        ("0", "θ7", ("line 3", "type is open")),
    ):
        with pytest.raises(DHError) as caught:
            first(d, theta)
        assert [w for w in words if w not in caught.value.faults[0].message] == []


def test_a_table_of_numbers_alone_is_revolute_with_a_warning():
    table = read_pasted("theta d a alpha\n0 0.4 0 pi/2\n0 0 0.3 0\n", "dh")
    assert [row.type for row in table.rows] == [JointType.REVOLUTE] * 2
    assert "every joint is taken as revolute" in table.warnings[0]
    table = read_pasted("0 0.4 0 pi/2\n0 0 0.3 0\n", "dh", columns="theta,d,a,alpha")
    assert (table.rows[0].d, table.rows[1].a) == (0.4, 0.3)


HEAD = "| i | a | α | d | θ |\n|---|---|---|---|---|\n"
GOOD = HEAD + "|1|0|0|0.4|q1|\n|2|0.3|0|0|q2|\n"


@pytest.mark.parametrize(
    ("text", "convention", "words"),
    [
        (GOOD.replace("|0.4|", "|x|"), "dh", ("joint 1 (line 3, column d)", "'x'", "values x:")),
        (GOOD.replace("|0|q2", "|0|q3"), "dh", ("line 4", "open")),
        (
            GOOD.replace("|0.3|0|", "|0.3|90|"),
            "dh",
            ("line 4, column α", "'90' has no unit", "write 90°", "angle=deg"),
        ),
        (GOOD.replace("q2", "q2 - 90"), "dh", ("line 4, column θ", "'q2 - 90' has no unit")),
        (GOOD.replace("0.3", "1,234"), "dh", ("line 4, column a", "two numbers", "decimal point")),
        (GOOD.replace("0.3", "45°"), "dh", ("line 4, column a", "an angle; a length is needed")),
        (GOOD.replace("0.3", "1e9"), "dh", ("line 4, column a", "beyond", "check its unit")),
        (GOOD.replace("0.3", ""), "dh", ("joint 2: a is missing", "0 if it is zero")),
        (GOOD.replace("0.3", "1" * 301), "dh", ("line 4, column a", "longer than 300")),
        (GOOD.replace("0.3", "q2"), "dh", ("line 4, column a", "'q2' holds q2")),
        (GOOD.replace("q2", "2*q2"), "dh", ("line 4", "open")),
        (GOOD.replace("|2|", "|3|"), "dh", ("line 4, column i", "number 3 where 2 is due")),
        (GOOD.replace("|2|0.3", "|2"), "dh", ("line 4 has 4 cells under 5 columns (i,",)),
        (GOOD.replace("| θ |", "| foo |"), "dh", ("line 1", "'foo' is unknown", "known are")),
        (GOOD.replace("| θ |", "| a |"), "dh", ("line 1", "'a' stands twice")),
        (GOOD.replace("| a |", "| r |"), "dh", ("r is a column of the khalil convention only",)),
        (GOOD.replace("| a |", "| a_{i-1} |"), "dh", ("'a_{i-1}'", "convention=modified")),
        (GOOD, "khalil", ("khalil has no column a",)),
        (GOOD, None, ("convention is missing", "standard (distal, Paul)")),
        (GOOD, "foo", ("'foo' is unknown",)),
        (
            GOOD.replace("| i |", "| type |").replace("|2|", "|x|"),
            "dh",
            ("joint 2 (line 4, column type)", "R, P or F"),
        ),
        ("", "dh", ("no table",)),
        ("hello world, this is\nno table", "dh", ("names no columns", "columns=theta,d,a,alpha")),
        ("0 0.4 0 pi/2\n0 0 0.3 0\n", "dh", ("line 1", "names no columns")),
        ("A = [0 0.4 0 pi/2; 0 0 0.3 0]", "dh", ("names no columns", "% theta d a alpha")),
        (
            "% theta d a alpha\n[0 0.4 0 pi/2; 0 0 0.3]",
            "dh",
            ("line 2: row 2 of the matrix", "3 el"),
        ),
        ("[1 2 3; 1 2 3]\n[1 2 3; 1 2 3]", "dh", ("2 matrices",)),
        (
            "Link('d', 0.4, 'alpha', pi/2)",
            "mdh",
            ("link is standard", "convention=standard", "add 'modified'"),
        ),
        ("RevoluteMDH(d=0.4)", "dh", ("link is modified", "convention=modified")),
        ("RevoluteMDH(d=0.4)", "khalil", ("not khalil", "convention=modified")),
        ("Link('d', 0.4, 'alpha', 90)", "dh", ("column alpha", "'90' has no unit")),
        ("Link('d', 0, 'theta', 0)", "dh", ("line 1", "theta and d", "'revolute'")),
        ("Link('d', 0, 'beta', 0)", "dh", ("unknown parameter 'beta'", "known are theta")),
        ("Link('d', 0, 'd', 0)", "dh", ("stands twice",)),
        ("Link([0.5 0.4 0 0])", "dh", ("theta of a revolute joint is ignored", "offset")),
        ("Link([0 0.4 0])", "dh", ("4 to 6 numbers",)),
        ("Link('d', 0, 'qlim', 3)", "dh", ("qlim is '3'", "[lower upper]")),
        ("L(1) = Link('d', 0);\nL(3) = Link('d', 0);", "dh", ("link 2 of L is missing",)),
        ("L(2) = Link('d', 0);", "dh", ("link 1 of L is missing",)),
        ("A = Link('d', 0);\n\ufeffB = Link('d', 0)", "dh", ("line 2", r"'\ufeff' is not")),
        ("A = Link('d', 0); SerialLink([A B])", "dh", ("'B'", "not made")),
        ("Link('d', 0", "dh", ("line 1", "never closed")),
        (LATEX + LATEX, "mdh", ("two LaTeX tables",)),
        (
            LATEX.replace(r"\dfrac", r"\foo"),
            "mdh",
            ("joint 3 (line 10, column $\\alpha_{i-1}$)", "unexpected"),
        ),
        (HEAD + "|1|0|0|0.4|q|\n" * 301, "dh", ("line 4, column i", "2 is due")),
        ("θ d a α\n" + "q 0 0 0\n" * 301, "dh", ("301 rows; at most 300",)),
        ("x" * 100_001, "dh", ("longer than 100000",)),
        (b"\xff\xfe\x00", "dh", ("not UTF-8",)),
    ],
)
def test_a_refusal_names_line_column_and_remedy(text, convention, words):
    with pytest.raises(DHError) as caught:
        read_pasted(text, convention)
    message = caught.value.faults[0].message
    assert [word for word in words if word not in message] == [], message


@pytest.mark.parametrize(
    ("typeset", "plain"),
    [
        (r"$-\frac{\pi}{2}$", "-(pi/2)"),
        (r"\frac{3\pi}{4}", "(3pi/4)"),
        (r"\dfrac\pi2", "(pi/2)"),
        (r"\frac{a+b}{\sqrt{2}}", "((a+b)/(sqrt(2)))"),
        (r"90^{\circ}", "90°"),
        ("90º", "90°"),
        (r"\theta_{1}^{*}+\pi", "theta_1+pi"),
        (r"\theta_{12}", "theta_12"),
        ("θ₁* - 90°", "θ1 - 90°"),
        ("𝜃₂", "θ2"),
        ("q_i", "q"),
        ("2*-3", "2*-3"),
        ("2**3", "2**3"),
        ("**0.5**", "0.5"),
        (r"\text{d}_3", "d_3"),
        (r"{-}0{,}5", "-0,5"),
        (r"-{\pi + 1}", "-(pi + 1)"),
        (r"2^{3}", "2^(3)"),
        (r"\unknown{3}", r"\unknown3"),
    ],
)
def test_typeset_cells_become_plain(typeset, plain):
    assert plain_cell(typeset) == plain


def test_columns_that_contradict_nothing_are_read_with_a_warning():
    text = GOOD.replace("| a |", "| a_i |")
    assert read_pasted(text, "dh").warnings == ()
    assert "read as a and alpha of i-1" in read_pasted(text, "mdh").warnings[0]


def test_names_of_joints_are_kept():
    text = HEAD.replace("| i |", "| name |") + "|base yaw|0|0|0.4|q|\n|elbow_1|0.3|0|0|q|\n"
    assert [row.name for row in read_pasted(text, "dh").rows] == ["base yaw", "elbow_1"]
    text = HEAD + "|shoulder|0|0|0.4|q|\n|$2$|0.3|0|0|q|\n"
    assert [row.name for row in read_pasted(text, "dh").rows] == ["shoulder", "j2"]


def test_csv_takes_values_too():
    table = read_csv("type,alpha,a,d,theta\nR,0,l_1,0,q1\n", "dh", values={"l1": "30cm"})
    assert table.rows[0].a == 0.3


SCRAPS = st.sampled_from(
    [
        *"ab:-&*[]{}|>%'\"#, \n\t017.eE+;=\x00\r_^$~°θπ()\\",
        "\\\\",
        "\\frac{",
        "\\begin{tabular}",
        "\\end{tabular}",
        "\\theta_",
        "alpha",
        "theta",
        "| a | alpha | d | theta |\n",
        "Link(",
        "RevoluteDH(",
        "SerialLink(",
        "'d',",
        "d=",
        "[0 0 0 0]",
        "q1",
        "pi/2",
        "90°",
        "tool = [",
        "L(1) = ",
        "np.array(",
        "\\multicolumn{2}{c}{",
        "% theta d a alpha\n",
        "[0 0 0 0; 0 0 0 0]",
        "i\ta\td\talpha\ttheta\n",
        "1\t0\t0\t0\tq1\n",
        "1e999",
        "nan",
        " 'modified'",
        "qlim=[",
        "²",
    ]
)


@settings(max_examples=400, deadline=None)
@given(
    st.lists(SCRAPS, max_size=40).map("".join) | st.text(max_size=80) | st.binary(max_size=80),
    st.sampled_from(Convention),
)
def test_any_text_is_refused_or_a_table(text, convention):
    try:
        table = read_pasted(text, convention)
    except DHError:
        return
    assert table.rows


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_a_damaged_table_is_refused_or_a_table(data):
    text = TEXTS[data.draw(st.sampled_from(sorted(TEXTS)))]
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text)))
        text = text[:at] + data.draw(SCRAPS) + text[at + data.draw(st.integers(0, 4)) :]
    try:
        table = read_pasted(text, "modified")
    except DHError:
        return
    assert np.isfinite(dh_matrices(table, np.zeros(table.dof)).T).all()


@pytest.mark.parametrize(
    "piece",
    [
        "a=",
        "[",
        "[ [",
        "(",
        "L(1)=",
        "Link(",
        "\\frac{",
        "^{",
        "_",
        "a & b \\\\\n",
        "|a|b|\n",
        "\n",
        "\\begin{tabular}",
        "Link([0 0 0 0])\n",
        "[0 0 0 0]\n",
        "x = [",
        "tool = [",
        " ",
        "'",
        "[[1,",
        "% a alpha d theta\n",
        "\\hline",
        "\\multicolumn{",
        "$",
        "%{\n",
        "%{ \nLink(",
        '"""\n',
    ],
)
def test_long_garbage_takes_no_time(piece):
    started = time.thread_time()
    with pytest.raises(DHError):
        read_pasted((piece * 100_000)[:100_000], "standard")
    assert within(time.thread_time() - started, 5)


def first_row(cells, convention="dh", **options):
    """The first joint of a table in which a, alpha, d and theta are these."""
    row = {"a": "0.3", "α": "0", "d": "0.1", "θ": "θ1"} | cells
    text = f"{HEAD}|1|{row['a']}|{row['α']}|{row['d']}|{row['θ']}|\n|2|0|0|0|θ2|\n"
    return read_pasted(text, convention, **options).rows[0]


def test_degrees_that_lost_their_sign_are_refused():
    # The ring of 90° comes out of a PDF as a superscript zero, or as a plain one.
    assert first_row({"α": "90⁰"}).alpha == math.pi / 2
    for cells in ({"α": "900"}, {"θ": "θ1 - 900"}):
        with pytest.raises(DHError, match="more than a turn"):
            first_row(cells, angle="deg")
    assert first_row({"α": "900°"}).alpha == 5 * math.pi


def test_a_long_length_without_unit_warns_of_millimetres():
    text = HEAD + "|1|431.8|0|0|θ1|\n"
    assert "give length=mm" in read_pasted(text, "dh").warnings[0]
    for read in (
        read_pasted(text, "dh", length="mm"),
        read_pasted(text.replace("431.8", "431.8 mm"), "dh"),
        read_pasted(text.replace("| a |", "| a (mm) |"), "dh"),
    ):
        assert (read.rows[0].a, read.warnings) == (0.4318, ())


def test_an_empty_variable_among_named_ones_is_no_joint():
    text = HEAD + "|1|0.3|0|0|{}|\n|2|0|0|0.1|-|\n"
    assert read_pasted(text.format("-"), "dh").dof == 2
    with pytest.raises(DHError, match=r"joint 2 .*F for a row that does not move"):
        read_pasted(text.format("θ1"), "dh")


def test_the_sine_of_a_bare_90_is_refused():
    with pytest.raises(DHError, match="sin of 90 rad; write 90°"):
        first_row({"a": "0.3*sin(90)"})
    assert first_row({"a": "0.3*sin(90°)"}).a == 0.3
    assert first_row({"a": "0.3*sin(90)"}, angle="deg").a == 0.3


def test_a_column_of_variables_names_those_of_its_rows():
    text = "|i|a|α|d|θ|q|\n|-|-|-|-|-|-|\n|1|0.3|0|0.2|30°|{}|\n"
    assert read_pasted(text.format("d1"), "dh").rows[0].type is JointType.PRISMATIC
    for cell in ("θ2", "90°"):
        with pytest.raises(DHError, match="not the variable of joint 1"):
            read_pasted(text.format(cell), "dh")


def test_words_of_other_languages_and_indices_in_parentheses():
    text = (
        "Articulation;Type;alpha (degrés);a (mètres);d (metres);theta (deg)\n"
        "1;rotoide;90;0;0,66;θ(1)\n2;Glissière;0;1,5;q(2);0\n3;pivot;0;0;0;q(3) - 90\n"
    )
    rows = read_pasted(text, "dh").rows
    assert [row.type.value[0] for row in rows] == ["r", "p", "r"]
    assert (rows[0].alpha, rows[0].d, rows[2].offset) == (math.pi / 2, 0.66, -math.pi / 2)
    assert read_pasted("Link (i) | a | α | d | θ\n1 | 0.3 | 0 | 0 | θ1\n", "dh").rows[0].a == 0.3


def test_a_row_without_its_borders_is_not_lost():
    with pytest.raises(DHError, match=r"line 5 has no \|"):
        read_pasted(GOOD + "3 0.3 0 0 q3\n", "dh")
    with pytest.raises(DHError, match=r"line 4 has no \|"):
        read_pasted(GOOD.replace("|2|0.3|0|0|q2|", "2 0.3 0 0 q2\n|3|0|0|0|q3|"), "dh")
    assert read_pasted(f"The arm:\n{GOOD}\nwhere q1 is the shoulder.", "dh").dof == 2


NUMBERS = "% theta d a alpha\nDH = [0 1 0 0; 0 0 1 0; 0 0 0 1; 0 2 0 0]"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (NUMBERS.replace("[", "deg2rad([") + ")", "an angle; a length is needed"),
        (NUMBERS + "\nDH[:, 1:3] *= 1e-3", "line 3"),
        (NUMBERS + "\noffset = [pi/2 0 0 0]", "'offset' beside the matrix"),
        ("# theta d a alpha\nDH = np.array([[0, 1, 0, 0], [0, 0, 1, 0]]).T", "no table"),
        ("while x\nL(1) = Link('d',0.1,'a',0.2);\nend", "line 1: while is not read"),
        ("for i=1:n\nL(i) = Link('d',0.1,'a',0.2);\nend", "line 1: a loop is not run"),
        ("if x\nL(1) = Link('d',0.1,'a',0.2);\nend", "line 1: whether this if holds"),
        ("DHRobot([RevoluteDH(a=0.2)]*3)", "one link stands twice"),
        ("L1=Link('d',0); L2=Link('d',1);\nSerialLink(L1); SerialLink(L2)", "2 robots"),
        (
            "L2 = Link('d', 0)\nL3 = Link('d', 1)\nA = [L2 L3]; B = [L3 L2];",
            "several lists of links",
        ),
        ("L2 = Link('d', 0);", "link 1 is missing"),
    ],
)
def test_what_a_program_does_with_its_numbers_is_refused_where_it_is_not_read(text, words):
    with pytest.raises(DHError, match=words):
        read_pasted(text, "dh")


@pytest.mark.parametrize(
    ("text", "column", "numbers"),
    [
        (NUMBERS + ";\nDH(:,2:3) = DH(:,2:3)/1000;", "d", [1e-3, 0, 0, 2e-3]),
        (NUMBERS + "\nDH = DH*1e-3", "d", [1e-3, 0, 0, 2e-3]),
        (NUMBERS + "'", "d", [0, 0, 1, 0]),
        ("for i=1:3\nL(i) = Link('d',i/10,'a',0.2);\nend", "d", [0.1, 0.2, 3 / 10]),
        ("DHRobot([RevoluteDH(a=k/10) for k in range(1, 4)])", "a", [0.1, 0.2, 3 / 10]),
        ("a=1;\nL(1)=Link('d',0,'a',a);\na=2;\nL(2)=Link('d',0,'a',a);", "a", [1, 2]),
        ("l=1\nl += 1\nL1 = RevoluteDH(a=l)", "a", [2]),
        ("L(1) = Link('d', 0);\nL(1) = Link('d', 0.5);", "d", [0.5]),
        ("L(1) = Link('d', 0);\nL(1).offset = pi/2;", "offset", [math.pi / 2]),
    ],
)
def test_what_a_program_does_with_its_numbers_is_read(text, column, numbers):
    assert [getattr(row, column) for row in read_pasted(text, "dh").rows] == numbers


def test_comments_in_blocks_lists_of_links_and_a_name_like_base():
    text = '''"""
    Example: RevoluteDH(d=1)
    """
    base = 26.45 * inch  # the pedestal
    inch = 0.0254
    L1 = RevoluteDH(a=0.4)
    L2 = RevoluteDH(d=pedestal, a=0.3)
    links = [L2, L1]
    robot = DHRobot(links)'''
    text = text.replace("    base", "    inch = 0.0254\n    base").replace("pedestal,", "base,")
    assert [(row.d, row.a) for row in read_pasted(text, "dh").rows] == [
        (pytest.approx(0.67183), 0.3),
        (0, 0.4),
    ]
    text = "%{\nL(1)=Link('d',1);\n%}\nL(1)=Link('d',0.5);"
    assert [row.d for row in read_pasted(text, "dh").rows] == [0.5]


def test_variables_may_count_the_rows_that_move():
    text = (
        "| i | type | α | a | d | θ |\n|-|-|-|-|-|-|\n| 0 | F | π | 0 | 0 | 0 |\n"
        "| 1 | R | π/2 | 0 | -0.28 | q1 |\n| 2 | R | π/2 | 0 | -0.01 | q{}+π |\n"
    )
    table = read_pasted(text.format(2), "standard")
    assert [row.type.value for row in table.rows] == ["fixed", "revolute", "revolute"]
    assert table.rows[2].offset == math.pi
    with pytest.raises(DHError, match="is the variable of joint 3, not 2"):
        read_pasted(text.format(3), "standard")
    rows = text.replace("q1", "q2").format(3)
    assert read_pasted(rows, "standard").dof == 2


@pytest.mark.parametrize("labels", ["i1 i2 i3", "0 1 2", "1 2 3"])
def test_a_print_of_a_data_frame_has_labels_without_a_heading(labels):
    first, second, third = labels.split()
    text = (
        "      θi        di   a(i-1)    α(i-1)\n"
        f"{first}  0.00  0.089159  0.00000  0.000000\n"
        f"{second} -1.57  0.000000  0.00000  1.570000\n"
        f"{third}  0.00  0.000000 -0.42500  0.000000\n"
    )
    rows = read_pasted(text, "modified").rows
    assert [(row.d, row.a, row.alpha) for row in rows] == [
        (0.089159, 0, 0),
        (0, 0, 1.57),
        (0, -0.425, 0),
    ]
    if third.isdecimal():
        with pytest.raises(DHError, match="5 cells under 4 columns"):
            read_pasted(text.replace(f"\n{third} ", "\n7 "), "modified")


@pytest.mark.parametrize("theta", "θϑΘϴӨөƟѲ𝜃")
def test_letters_that_look_like_theta_are_read(theta):
    text = f"| i | α i-1 | a i-1 | di | {theta} i |\n|-|-|-|-|-|\n| 1 | 0 | 0 | 0.34 | {theta}1 |\n"
    assert read_pasted(text, "modified").rows[0].d == 0.34


PRINT = """DHRobot: arm, 2 joints (RR), dynamics, standard DH parameters
┌──────┬───────┬───────┬────────┐
│  θⱼ  │  dⱼ   │  aⱼ   │   ⍺ⱼ   │
├──────┼───────┼───────┼────────┤
│  q1  │  0.4  │  0.3  │   0.0° │
│  q2  │  0.0  │  0.2  │ 180.0° │
└──────┴───────┴───────┴────────┘

┌──────┬──────┬───────┐
│ name │ q0   │ q1    │
├──────┼──────┼───────┤
│   qz │  0°  │  0°   │
└──────┴──────┴───────┘
"""


def test_the_whole_print_of_a_robot_of_the_toolbox():
    table = read_pasted(PRINT, "standard")
    assert [(row.d, row.a) for row in table.rows] == [(0.4, 0.3), (0, 0.2)]
    assert table.warnings == ("line 10: the box of named configurations is left out",)
    tool = "\n┌──────┬──────────┐\n│ tool │ t = 0, 0 │\n└──────┴──────────┘\n"
    with pytest.raises(DHError, match="line 16: the box says of the tool"):
        read_pasted(PRINT + tool, "standard")


def test_a_last_row_to_the_end_of_the_arm_does_not_move():
    text = (
        "Links | alpha(i-1) | a(i-1) | d(i) | theta(i)\n--- | --- | --- | --- | ---\n"
        "0->1 | 0 | 0 | 0.75 | q1\n1->2 | - pi/2 | 0.35 | 0 | q2 - pi/2\n"
        "{} | 0 | 1.25 | 0.303 | 0\n"
    )
    for last in ("2->EE", "2->G", "2 -> tool", "end-effector"):
        table = read_pasted(text.format(last), "modified")
        assert [row.type.value for row in table.rows] == ["revolute", "revolute", "fixed"]
        assert "the row has no joint variable" in table.warnings[0]
    with pytest.raises(DHError, match="no cell holds the joint variable"):
        read_pasted(text.format("2->3"), "modified")


def test_a_number_for_a_joint_variable_is_refused():
    with pytest.raises(DHError, match="'q1' is the variable of this joint, and values gives it"):
        read_pasted("alpha a d theta\n0 0.3 0 q1\n", "dh", values={"q1": 0.4})
    assert read_pasted("alpha a d theta\n0 a1 0 q1\n", "dh", values={"a1": 0.4}).rows[0].a == 0.4


def test_powers_stand_in_cells():
    for cell, value in (("0.5**2", 0.25), ("0.5^2", 0.25), ("sqrt(0.3**2+0.4**2)", 0.5)):
        assert first_row({"a": cell}).a == value
    assert first_row({"α": "atan2(1,0)"}).alpha == math.pi / 2
    assert first_row({"a": "$0.5^{2}$"}).a == 0.25
