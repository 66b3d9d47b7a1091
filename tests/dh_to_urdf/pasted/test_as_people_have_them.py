"""Kinds of tables that people paste; one arm of three joints in many spellings."""

import math

import numpy as np
import pytest

from dh_to_urdf import DHError, JointType, dh_matrices, read_pasted
from dh_to_urdf.encodings import decoded
from dh_to_urdf.pasted.pose_text import printed_pose
from tests.dh_to_urdf.conftest import shift, turn

HEAD = "| i | α | a | d | θ |\n|---|---|---|---|---|\n"
ROWS = "| 1 | 90° | 0 | 0.4 | q1 |\n| 2 | 0 | 0.3 | 0 | q2-90° |\n| 3 | -90° | 0.05 | 0 | q3 |\n"
PLAIN = "| 1 | 90 | 0 | 400 | q1 |\n| 2 | 0 | 300 | 0 | q2-90 |\n| 3 | -90 | 50 | 0 | q3 |\n"
FRAME = """         theta    d     a     alpha
{}0    0.0  0.4  0.00  1.570796
{}1    0.0  0.0  0.30  0.000000
{}2    0.0  0.0  0.05 -1.570796
"""
LISTS = "theta = [0 -pi/2 0]; d = [0.4 0 0]; a = [0 0.3 0.05]; alpha = [pi/2 0 -pi/2];\n"
MATRIX = "DH = [0 0.4 0 pi/2; -pi/2 0 0.3 0; 0 0 0.05 -pi/2];"
TEXTS = {
    "a last row": HEAD + ROWS,
    "units in a title": "All angles in degrees, lengths in mm\n" + HEAD + PLAIN,
    "units below": HEAD + PLAIN + "\nAngles in degrees; lengths in millimetres.",
    "units after a dash": HEAD + "| | [deg] | [mm] | [mm] | [deg] |\n" + PLAIN,
    "units in French": "Paramètres (angles en degrés, longueurs en mm)\n" + HEAD + PLAIN,
    "lists": LISTS,
    "lists side by side": LISTS + "DH = [theta; d; a; alpha]';",
    "numpy columns": "import numpy as np\ntheta=[0,-np.pi/2,0]\nd=[0.4,0,0]\na=[0,0.3,0.05]\n"
    "alpha=[np.pi/2,0,-np.pi/2]\nDH = np.column_stack((theta, d, a, alpha))",
    "comment": "% DH = [theta d a alpha]\n" + MATRIX,
    "comment behind": MATRIX + " % theta, d, a, alpha",
    "comment of a table": "% Joint | theta | d | a | alpha\n" + MATRIX,
    "a comment a row": "M = [0 -pi/2 0;  % theta\n0.4 0 0;  % d\n0 0.3 0.05;  % a\n"
    "pi/2 0 -pi/2];  % alpha",
    "heading as a matrix": "DH=[theta d a alpha]\n0 0.4 0 pi/2\n-pi/2 0 0.3 0\n0 0 0.05 -pi/2\n",
    "C": "// theta, d, a, alpha\ndouble dh[3][4] = {\n {0, 0.4, 0, M_PI/2},\n"
    " {-M_PI_2, 0, 0.3, 0},\n {0, 0, 0.05, -M_PI/2}\n};",
    "data frame": "df = pd.DataFrame({'theta': [0, -np.pi/2, 0], 'd': [0.4, 0, 0],"
    " 'a': [0, 0.3, 0.05], 'alpha': [np.pi/2, 0, -np.pi/2]})",
    "dictionaries": "dh = [\n {'a': 0, 'alpha': np.pi/2, 'd': 0.4, 'theta': 0},\n"
    " {'a': 0.3, 'alpha': 0, 'd': 0, 'theta': -np.pi/2},\n"
    " {'a': 0.05, 'alpha': -np.pi/2, 'd': 0, 'theta': 0}]",
    "transposed": "| | 1 | 2 | 3 |\n|---|---|---|---|\n| θ | q1 | q2 - 90° | q3 |\n"
    "| d | 0.4 | 0 | 0 |\n| a | 0 | 0.3 | 0.05 |\n| α | 90° | 0 | -90° |\n",
    "transposed with units": "| Parameter | Joint 1 | Joint 2 | Joint 3 |\n|-|-|-|-|\n"
    "| θ [deg] | θ1 | θ2-90 | θ3 |\n| d [mm] | 400 | 0 | 0 |\n| a [mm] | 0 | 300 | 50 |\n"
    "| α [deg] | 90 | 0 | -90 |\n",
    "MATLAB print": "arm:: 3 axis, RRR, stdDH\n+---+------+-----+------+---------+---------+\n"
    "| j | theta | d | a | alpha | offset |\n+---+------+-----+------+---------+---------+\n"
    "| 1| q1| 0.4| 0| 90°| 0|\n| 2| q2| 0| 0.3| 0| -90°|\n| 3| q3| 0| 0.05| -90°| 0|\n",
    "HTML": "<table><tr><th>i</th><th>&alpha;<sub>i</sub></th><th>a<sub>i</sub></th><th>d</th>"
    "<th>&theta;<sub>i</sub></th></tr><tr><td>1</td><td>90&deg;</td><td>0</td><td>0.4</td>"
    "<td>&theta;<sub>1</sub></td></tr><tr><td>2</td><td>0</td><td>0.3</td><td>0</td>"
    "<td>&theta;<sub>2</sub> &minus; 90&deg;</td></tr><tr><td>3</td><td>-90&deg;</td>"
    "<td>0.05</td><td>0</td><td>&theta;<sub>3</sub></td></tr></table>",
    "French": "Liaison;Torsion α (°);Longueur a (m);Décalage d (m);Angle θ (°)\n1;90;0;0,4;q1\n"
    "2;0;0,3;0;q2 - 90\n3;-90;0,05;0;q3\n",
    "words": "| Joint | Twist angle | Link length | Link offset | Joint angle |\n|-|-|-|-|-|\n"
    + ROWS,
    "indices from 0": HEAD + ROWS.replace("| 1", "| 0").replace("| 2", "| 1").replace("| 3", "| 2")
    .replace("q1", "q0").replace("q2", "q1").replace("q3", "q2"),
}  # fmt: skip


def expected(q):
    T = turn("z", q[0]) @ shift(0, 0, 0.4) @ turn("x", math.pi / 2)
    T = T @ turn("z", q[1] - math.pi / 2) @ shift(0.3, 0, 0)
    return T @ turn("z", q[2]) @ shift(0.05, 0, 0) @ turn("x", -math.pi / 2)


def assert_arm(table, before=None, after=None):
    for q in np.random.default_rng(2).uniform(-2, 2, (3, 3)):
        T = (np.eye(4) if before is None else before) @ expected(q)
        T = T if after is None else T @ after
        assert np.allclose(dh_matrices(table, q).T, T, atol=1e-9)


@pytest.mark.parametrize("name", TEXTS)
def test_a_table_is_read_as_it_is_meant(name):
    assert_arm(read_pasted(TEXTS[name], "standard"))


@pytest.mark.parametrize("labels", ["", "Joint ", "i", "   "])
def test_a_frame_has_an_index(labels):
    table = read_pasted(FRAME.format(labels, labels, labels), "standard")
    assert [row.a for row in table.rows] == [0.0, 0.3, 0.05]
    table = read_pasted(FRAME.format("", "", "") + "\n[3 rows x 4 columns]\n", "standard")
    assert table.dof == 3


@pytest.mark.parametrize("head", ["Links", "Link#", "Link #", "Joint No.", "N°", "Articulation"])
def test_a_column_of_numbers_has_many_names(head):
    assert_arm(read_pasted(HEAD.replace("i", head, 1) + ROWS, "standard"))


@pytest.mark.parametrize("label", ["EE", "3→EE", "flange", "End Effector", "outil", "Tool frame"])
def test_a_last_row_at_the_tip_does_not_move(label):
    table = read_pasted(HEAD + ROWS + f"| {label} | 0 | 0 | 0.1 | 0 |\n", "standard")
    assert table.rows[-1].type is JointType.FIXED
    assert_arm(table, after=shift(0, 0, 0.1))


@pytest.mark.parametrize("label", ["0", "base", "B→0", "socle"])
def test_a_first_row_at_the_base_does_not_move(label):
    table = read_pasted(HEAD + f"| {label} | 0 | 0 | 0.2 | 0 |\n" + ROWS, "standard")
    assert_arm(table, before=shift(0, 0, 0.2))


def test_a_numbered_row_without_variable_is_asked_for_its_type():
    text = HEAD + ROWS + "| 4 | 0 | 0 | 0.1 | 0 |\n"
    with pytest.raises(DHError, match="add a column type"):
        read_pasted(text, "standard")


@pytest.mark.parametrize("letter", "θϑΘϴӨөѲѳƟɵꝊⲐ𝜃𝛉⊖Ø")
def test_letters_that_look_like_theta(letter):
    text = (HEAD + ROWS).replace("θ", letter).replace("q", letter)
    assert_arm(read_pasted(text, "standard"))


@pytest.mark.parametrize("letter", "αɑ∝⍺𝛼ά")
def test_letters_that_look_like_alpha(letter):
    assert_arm(read_pasted((HEAD + ROWS).replace("α", letter), "standard"))


@pytest.mark.parametrize(
    "angle",
    [
        *("½π", "½ π", "π/2", "np.pi/2", "math.pi/2", "M_PI/2", "M_PI_2", "90*deg", "90º", "π÷2"),
        *("1/2*pi", "π*2^-1", "np.deg2rad(90)", "Math.PI/2", "π/2 rad", "sqrt(4)*pi/4"),
    ],
)
def test_right_angles(angle):
    assert_arm(read_pasted((HEAD + ROWS).replace("90°", angle), "standard"))


@pytest.mark.parametrize(
    "length",
    [
        *("√0.09", "sqrt(0.09)", "0.09**0.5", "0.09^0.5", "3·10⁻¹", "3×10^-1", "3x10^-1", "300*mm"),
        *("np.sqrt(0.09)", "0,3", "3e-1", "sqrt(0.18²+0.24²)", "30 cm"),
    ],
)
def test_lengths(length):
    assert_arm(read_pasted((HEAD + ROWS).replace("0.3", length), "standard"))


@pytest.mark.parametrize("variable", ["θ{}(t)", "theta_{}(t)", "q[{}]", "`q{}`"])
def test_joint_variables(variable):
    text = HEAD + ROWS
    for k in (1, 2, 3):
        text = text.replace(f"q{k}", variable.format(k))
    assert_arm(read_pasted(text.replace("`-90°", "-90°`"), "standard"))


@pytest.mark.parametrize(
    ("title", "remedy"),
    [
        ("θ in degrees, α in radians", "angle="),
        ("lengths in mm, offsets in m", "length="),
        ("a in mm", "length="),
    ],
)
def test_units_of_some_values_are_refused(title, remedy):
    with pytest.raises(DHError, match=remedy):
        read_pasted(f"{title}\n{HEAD}{PLAIN}", "standard")
    assert_arm(read_pasted(f"{title}\n{HEAD}{PLAIN}", "standard", angle="deg", length="mm"))


@pytest.mark.parametrize("words", ["a 6 degrees of freedom arm", "moves at 3 rad/s, 20 mm thick"])
def test_other_words_are_no_units(words):
    assert_arm(read_pasted(f"{words}\n{HEAD}{ROWS}", "standard"))


def test_rows_apart_are_not_lost():
    with pytest.raises(DHError, match="stand apart"):
        read_pasted(HEAD + ROWS + "\n| 4 | 0 | 0.2 | 0 | q4 |\n| 5 | 0 | 0.2 | 0 | q5 |\n", "dh")


def test_a_name_without_number_in_a_program_is_no_other_one():
    with pytest.raises(DHError, match="unknown name"):
        read_pasted("% theta d a alpha\nDH = [0 0.4 0 W_PI/2; 0 0 0.3 0]", "dh")


def test_bytes_of_other_encodings():
    text = "% Paramètres – à l’épaule\n" + TEXTS["comment"]
    for encoding in ("cp1252", "utf-16", "utf-8-sig"):
        table = read_pasted(text.encode(encoding), "standard")
        assert_arm(table)
        assert ("Windows-1252" in " ".join(table.warnings)) is (encoding == "cp1252")
    greek = (HEAD + ROWS).encode("cp1253")
    assert_arm(read_pasted(greek, "standard", encoding="windows-1253"))
    with pytest.raises(DHError, match="unknown"):
        decoded(b"a", "zip")
    with pytest.raises(DHError, match="byte 1"):
        decoded(b"\xff\x20", "utf-8")


@pytest.mark.parametrize(
    ("text", "rotation"),
    [
        ("t = 1, 2, 3; rpy/xyz = 10°, 20°, 30°", (("x", 30), ("y", 20), ("z", 10))),
        ("t = 1, 2, 3; rpy/zyx = 10°, 20°, 30°", (("z", 30), ("y", 20), ("x", 10))),
        ("t = (1, 2, 3), RPY/yxz = (10, 20, 30) deg", (("y", 30), ("x", 20), ("z", 10))),
        ("t = 1, 2, 3; eul = 10°, 20°, 30°", (("z", 10), ("y", 20), ("z", 30))),
        ("t = 1, 2, 3; angvec = (30° | 0, 0, 1)", (("z", 30),)),
    ],
)
def test_poses_as_the_toolbox_prints_them(text, rotation):
    T = shift(1, 2, 3)
    for axis, angle in rotation:
        T = T @ turn(axis, math.radians(angle))
    assert np.allclose(printed_pose(text), T, atol=1e-12)


def test_costly_texts_end_soon():
    for text in ("\t" * 90_000, " " * 90_000, "a " * 50_000, "in deg " * 14_000, "<td" * 30_000):
        with pytest.raises(DHError):
            read_pasted(text, "dh")
