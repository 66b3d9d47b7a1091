"""The table as people type and paste it."""

import numpy as np
import pytest

from tests.conftest import until

MARKDOWN = """| i | α_i | a_i | d_i | θ_i |
|---|-----|-----|-----|-----|
| 1 | 90° | 0 | 0,4 | θ_1 |
| 2 | 0 | 0.3 | 0 | θ_2 - π/2 |
| 3 | 0 | L3 | 0 | q3 |
"""
SPREADSHEET = "theta\td\ta\talpha\nq1\t0,4\t0\t90\nq2\t0\t0,3\t0\n"
LATEX = r"""\begin{tabular}{c|cccc}
$i$ & $\theta_i$ & $d_i$ & $a_i$ & $\alpha_i$ \\ \hline
1 & $\theta_1$ & 0.4 & 0 & $\pi/2$ \\
2 & $\theta_2$ & 0 & 0.3 & 0 \\
\end{tabular}"""
MATLAB = "L(1) = Link([0 0.4 0 pi/2]);\nL(2) = Link([0 0 0.3 0]);\n"
TWO_LINKS = {
    "convention": "standard",
    "joints": [
        {"type": "R", "alpha": "pi/2", "a": 0, "d": 0.4},
        {"type": "R", "alpha": 0, "a": 0.3, "d": 0},
    ],
}


def pose_of(client, table, q):
    body = {"robot": table, "q": q}
    (pose,) = client.post("/v1/fk?angle=deg", json=body).json()["poses"].values()
    return pose["matrix"]


def cell(visit, row, column):
    return visit.page.get_by_label(f"Row {row}, {column}", exact=True)


@pytest.mark.scene
def test_cells_take_what_people_write(open_page, client):
    visit = open_page("robot=planar_2r&q=30,60&open=pose")
    for column, text in (("α", "pi/2"), ("a", "0,4"), ("d", "300e-3"), ("θ", "-q1 + 90°")):
        cell(visit, 1, column).fill(text)
    visit.settled()
    table = {
        "convention": "standard",
        "units": {"angle": "deg"},
        "joints": [
            {"type": "R", "alpha": "pi/2", "a": 0.4, "d": 0.3, "theta": "-q1+90"},
            {"type": "R", "alpha": 0, "a": 0.8, "d": 0},
        ],
    }
    np.testing.assert_allclose(
        visit.matrix("pose"), pose_of(client, table, [30, 60]), rtol=0, atol=1e-15
    )


def test_a_doubtful_value_is_told_above_the_numbers(open_page):
    visit = open_page("robot=planar_2r&q=30,60&open=pose")
    warnings = visit.page.get_by_role("list", name="Doubtful values")
    assert warnings.count() == 0
    cell(visit, 1, "a").fill("300")
    visit.settled()
    until(lambda: warnings.count() == 1)
    assert "a of joint 1" in warnings.inner_text()
    assert "300 m; millimetres?" in warnings.inner_text()
    cell(visit, 1, "a").fill("0.3")
    visit.settled()
    until(lambda: warnings.count() == 0)


def test_what_is_wrong_stands_at_its_cell(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose", refusals=True)
    good = visit.matrix("pose")
    wrong = cell(visit, 3, "α")
    wrong.fill("90 apples")
    visit.page.wait_for_selector("[aria-invalid=true]")
    assert wrong.get_attribute("aria-invalid") == "true"
    assert visit.page.locator("[aria-invalid=true]").count() == 1
    described = wrong.get_attribute("aria-describedby")
    message = visit.page.locator(f"#{described}").inner_text()
    assert "joint 3" in message
    assert "apples" in message
    assert visit.matrix("pose") == good
    wrong.fill("-90")
    visit.page.wait_for_selector("[aria-invalid=true]", state="detached")


def test_rows_are_added_moved_typed_and_removed_and_all_of_it_is_undone(open_page):
    visit = open_page("robot=planar_2r&q=30,60&open=pose")
    page = visit.page
    first = visit.matrix("pose")

    def rows() -> list[list[str]]:
        return [
            [one.input_value() for one in row.locator("td.cell input").all()]
            for row in page.locator(".dh tbody tr").all()
        ]

    start = rows()
    page.get_by_label("Add a row after row 1").click()
    assert [len(rows()), rows()[1][0], rows()[2][0]] == [3, "q2", "q3"]
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 3")
    page.get_by_label("Move row 3 up").click()
    assert [row[2] for row in rows()] == [start[0][2], start[1][2], "0"]
    assert [row[0] for row in rows()] == ["q1", "q2", "q3"]
    page.get_by_label("Row 3, type of joint").select_option("prismatic")
    assert rows()[2][:2] == ["0", "q3"]
    page.get_by_label("Row 3, type of joint").select_option("fixed")
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 2")
    page.get_by_label("Remove row 3").click()
    visit.settled()
    assert rows() == start
    while page.get_by_label("Undo").is_enabled():
        page.keyboard.press("Control+z")
    visit.settled()
    assert rows() == start
    assert visit.matrix("pose") == first
    page.keyboard.press("Control+y")
    page.wait_for_function("() => document.querySelectorAll('.dh tbody tr').length === 3")


@pytest.mark.parametrize(
    "text", [SPREADSHEET, LATEX, MATLAB], ids=["spreadsheet", "latex", "matlab"]
)
def test_pasted_tables_are_read(text, open_page, client):
    visit = open_page("robot=planar_2r&q=30,60&open=pose")
    page = visit.page
    page.get_by_role("button", name="Paste …").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Text of the table").fill(text)
    if text == SPREADSHEET:
        dialog.get_by_label("Angles").select_option("deg")
    dialog.get_by_role("button", name="Read the table").click()
    dialog.wait_for(state="detached")
    visit.settled()
    np.testing.assert_allclose(
        visit.matrix("pose"), pose_of(client, TWO_LINKS, [30, 60]), rtol=0, atol=1e-15
    )


def test_a_pasted_table_asks_for_the_names_that_it_needs(open_page):
    visit = open_page("robot=planar_2r&q=30,60&open=pose", refusals=True)
    page = visit.page
    cell(visit, 1, "a").focus()
    page.evaluate(
        """text => {
            const data = new DataTransfer();
            data.setData('text/plain', text);
            document.activeElement.dispatchEvent(new ClipboardEvent(
                'paste', {clipboardData: data, bubbles: true, cancelable: true}));
        }""",
        MARKDOWN,
    )
    dialog = page.get_by_role("dialog")
    dialog.get_by_text("unknown name 'L3'").wait_for()
    dialog.get_by_label("Numbers for names").fill("L3:0.25")
    dialog.get_by_role("button", name="Read the table").click()
    dialog.wait_for(state="detached")
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 3")
    assert cell(visit, 2, "θ").input_value() in (
        "q2 - 90",
        "q2 - 1.57079632679",
        "q2 - 1.5707963267948966",
    )
    assert cell(visit, 3, "a").input_value() == "0.25"


def test_another_convention_is_the_same_arm(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    before = visit.matrix("pose")
    page = visit.page
    page.get_by_label("Convention").select_option("modified")
    page.wait_for_function("() => location.hash.includes('convention=modified')")
    visit.settled()
    heads = page.locator(".dh thead button").all_inner_texts()
    assert [one[0] for one in heads] == ["α", "a", "d", "θ"]
    cell(visit, 1, "a").fill("0")
    page.wait_for_function("() => location.hash.includes('table=')")
    visit.settled()
    np.testing.assert_allclose(visit.matrix("pose"), before, atol=1e-12)


def test_the_same_numbers_can_be_read_in_another_convention(open_page, client):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    table = client.get("/v1/robots/puma560/dh?angle=deg").json() | {"convention": "modified"}
    visit.page.get_by_label("Read as …").select_option("modified")
    visit.page.wait_for_function("() => location.hash.includes('table=')")
    visit.settled()
    np.testing.assert_allclose(
        visit.matrix("pose"), pose_of(client, table, [0, 45, -90, 0, 45, 0]), rtol=0, atol=1e-15
    )


URDF = """<robot name="two"><link name="root"/><link name="arm"/><link name="hand"/>
<joint name="z" type="revolute"><parent link="root"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="a" type="continuous"><parent link="arm"/><child link="hand"/>
<origin xyz="1 0 0.5"/><axis xyz="0 1 0"/></joint></robot>"""


def test_a_urdf_is_opened_without_being_stored_and_downloaded(open_page, client, tmp_path):
    before = client.get("/v1/robots?page_size=1000").json()["robots"]
    file = tmp_path / "two.urdf"
    file.write_text(URDF)
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    page = visit.page
    page.locator("input[type=file]").set_input_files(str(file))
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 2")
    page.locator(".joint .value").nth(0).fill("30")
    visit.settled()
    body = {"robot": {"urdf": URDF}, "q": [30, 0]}
    (pose,) = client.post("/v1/fk?angle=deg", json=body).json()["poses"].values()
    np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])
    assert client.get("/v1/robots?page_size=1000").json()["robots"] == before
    page.get_by_role("button", name="Download …").click()
    for name, start in (("URDF", "<robot"), ("YAML", "name:"), ("LaTeX", "\\begin")):
        with page.expect_download() as downloaded:
            page.get_by_role("dialog").get_by_role("button", name=name).click()
        text = downloaded.value.path().read_text()
        assert start in text[:400]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "arm.yaml",
            "convention: modified\nunits: {angle: deg, length: m}\njoints:\n"
            "  - {type: R, alpha: 0, a: 0, d: 0.4}\n  - {type: R, alpha: 90, a: 0.3, d: 0}\n",
        ),
        (
            "arm.csv",
            "name,type,alpha,a,d,theta,offset,sign\nj1,R,90,0,0.4,0,0,1\nj2,R,0,0.3,0,0,0,1\n",
        ),
        ("arm.md", MARKDOWN.replace("L3", "0.1")),
    ],
)
def test_tables_are_opened_from_files(name, text, open_page, tmp_path):
    file = tmp_path / name
    file.write_text(text)
    visit = open_page("robot=scara&q=20,40,0.08,0&open=pose")
    visit.page.locator("input[type=file]").set_input_files(str(file))
    rows = 3 if name.endswith("md") else 2
    visit.page.wait_for_function("n => document.querySelectorAll('.joint').length === n", arg=rows)
    visit.settled()
    assert len(visit.matrix("pose")) == 4


def joint_values(page) -> list[str]:
    return [one.input_value() for one in page.locator(".joint .value").all()]


def test_joints_keep_their_values_when_rows_move(open_page):
    """A row takes its posture along; a new one is at zero, and so is one that slides now."""
    visit = open_page("robot=planar_3r&q=30,-45,60&open=pose")
    page = visit.page
    page.get_by_label("Add a row after row 1").click()
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 4")
    visit.settled()
    assert joint_values(page) == ["30", "0", "-45", "60"]
    page.get_by_label("Move row 3 up").click()
    visit.settled()
    assert joint_values(page) == ["30", "-45", "0", "60"]
    page.get_by_label("Remove row 1").click()
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 3")
    visit.settled()
    assert joint_values(page) == ["-45", "0", "60"]
    page.get_by_label("Row 1, type of joint").select_option("prismatic")
    page.wait_for_function("() => document.querySelector('.joint .unit').textContent === 'm'")
    visit.settled()
    assert joint_values(page) == ["0", "0", "60"]
    for expected in (["-45", "0", "60"], ["30", "-45", "0", "60"]):
        page.keyboard.press("Control+z")
        visit.settled()
        assert joint_values(page) == expected


def test_the_row_that_is_shown_is_followed(open_page):
    page = open_page("robot=planar_3r&q=30,-45,60&row=3,4").page
    page.get_by_label("Move row 3 up").click()
    page.wait_for_function("() => location.hash.includes('row=2,4')")
    page.get_by_label("Remove row 2").click()
    page.wait_for_function("() => !location.hash.includes('row=')")


def test_undo_goes_back_in_the_field_that_is_being_typed_into(open_page):
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    page = visit.page
    typed = cell(visit, 2, "a")
    for text in ("0.5", "0.7"):
        typed.fill(text)
        # What is typed in one go is undone in one go.
        page.wait_for_timeout(1000)
    for expected in ("0.5", "0.4318"):
        page.keyboard.press("Control+z")
        until(lambda expected=expected: typed.input_value() == expected)
    value = page.locator(".joint .value").nth(0)
    value.fill("20")
    page.keyboard.press("Control+z")
    assert value.input_value() == "0"
    page.get_by_role("button", name="Paste …").click()
    text = page.get_by_label("Text of the table")
    hash_before = page.evaluate("() => location.hash")
    text.press_sequentially("abc")
    page.keyboard.press("Control+z")
    assert text.input_value() != "abc"
    page.wait_for_timeout(400)
    assert page.evaluate("() => location.hash") == hash_before


def test_what_is_wrong_with_the_tool_stands_at_its_field(open_page):
    page = open_page("robot=puma560&q=0,45,-90,0,45,0", refusals=True).page
    page.get_by_text("Base and tool").click()
    field = page.get_by_label("Tool, z", exact=True)
    field.fill("far")
    page.wait_for_selector("[aria-invalid=true]")
    assert field.get_attribute("aria-invalid") == "true"
    field.fill("0.1")
    page.wait_for_selector("[aria-invalid=true]", state="detached")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            URDF.replace('type="continuous"', 'type="fixed"').replace(
                'type="revolute"', 'type="fixed"'
            ),
            "no joint that moves",
        ),
        (URDF.replace('xyz="0 1 0"', 'xyz="0 0 0"'), "axis is zero"),
        ("<robot", "XML"),
    ],
    ids=["nothing moves", "no axis", "no XML"],
)
def test_a_urdf_that_cannot_be_used_leaves_the_page_as_it_is(text, message, open_page, tmp_path):
    file = tmp_path / "bad.urdf"
    file.write_text(text)
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose", refusals=True)
    page = visit.page
    before = [visit.matrix("pose"), joint_values(page), page.url]
    page.locator("input[type=file]").set_input_files(str(file))
    page.locator(".toast, dialog", has_text=message).wait_for()
    page.wait_for_timeout(500)
    assert [visit.matrix("pose"), joint_values(page), page.url] == before
    assert not page.locator("body.stale").count()


TREE = """<robot name="tree"><link name="base"/><link name="a"/><link name="b"/><link name="c"/>
<link name="end"/>
<joint name="lift" type="prismatic"><parent link="base"/><child link="a"/>
<origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.02" effort="1" velocity="1"/></joint>
<joint name="left" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0.2 0.1"/>
<axis xyz="1 0 0"/><limit lower="-1.5" upper="1.5" effort="1" velocity="1"/></joint>
<joint name="right" type="continuous"><parent link="a"/><child link="c"/>
<origin xyz="0 -0.2 0.1"/><axis xyz="0 1 0"/></joint>
<joint name="hand" type="fixed"><parent link="b"/><child link="end"/>
<origin xyz="0.3 0 0.2"/></joint></robot>"""


def test_a_tree_with_a_slide_is_moved_and_its_table_can_be_shown(open_page, client, tmp_path):
    file = tmp_path / "tree.urdf"
    file.write_text(TREE)
    visit = open_page("robot=puma560&q=0,45,-90,0,45,0&open=pose")
    page = visit.page
    page.locator("input[type=file]").set_input_files(str(file))
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 3")
    visit.settled()
    # Three joints cannot have every pose.
    assert page.locator("#section-ik").count() == 1
    page.wait_for_function("() => location.hash.includes('task=position')")
    slider = page.locator(".joint input[type=range]").nth(0)
    slider.evaluate("one => { one.value = 0.0123; one.dispatchEvent(new Event('input')); }")
    page.locator(".joint .value").nth(1).fill("30")
    page.locator(".joint .value").nth(2).fill("50")
    visit.settled()
    # A short slide is moved in steps that are shorter still.
    assert joint_values(page) == ["0.0123", "30", "50"]
    body = {"robot": {"urdf": TREE}, "q": [0.0123, 30, 50]}
    (pose,) = client.post("/v1/fk?angle=deg", json=body).json()["poses"].values()
    np.testing.assert_array_equal(visit.matrix("pose"), pose["matrix"])
    page.get_by_label("Row 2, left").click()
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 2")
    visit.settled()
    assert joint_values(page) == ["0.0123", "30"]
    np.testing.assert_allclose(visit.matrix("pose"), pose["matrix"], atol=1e-9)
    page.wait_for_function("() => document.querySelector('.host').probe.motion() !== null")
    page.keyboard.press("Control+z")
    page.wait_for_function("() => document.querySelectorAll('.joint').length === 3")
