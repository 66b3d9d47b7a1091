"""Files that are opened: workbooks, texts of Windows, URDFs with faults beside their lines."""

import numpy as np
import pytest

from tests.dh_to_urdf.pasted.test_workbooks import ROWS, TITLE, ods, xlsx
from tests.robots.urdf.test_faults import THIRTEEN, TOLD
from tests.web.test_table import URDF, joint_values

LINKS = "L(1) = Link([0 0.4 0 pi/2]);\nL(2) = Link([0 0 0.3 0]);\nr = SerialLink(L);\n"
SCRIPT = f"% bras à 2 degrés\n{LINKS}"
NAMED = '<?xml version="1.0" encoding="ISO-8859-1"?>\n' + URDF.replace('"arm"', '"épaule"')


def choose(page, file) -> None:
    page.locator("input[type=file]").set_input_files(str(file))


def assert_opened(visit, joints) -> None:
    visit.page.wait_for_function(
        "n => document.querySelectorAll('.joint').length === n", arg=joints
    )
    visit.settled()
    assert not visit.page.get_by_role("dialog").count()


def test_the_picker_offers_every_document_that_is_read(open_page):
    offered = open_page("robot=scara").page.locator("input[type=file]").get_attribute("accept")
    assert {".urdf", ".xlsx", ".ods", ".csv", ".txt", ".html", "text/*"} <= {*offered.split(",")}


@pytest.mark.parametrize(
    ("name", "content"),
    [("arm.xlsx", xlsx([[TITLE], [], *ROWS])), ("arm.ODS", ods([[TITLE], [], *ROWS]))],
)
def test_a_workbook_is_opened(name, content, open_page, tmp_path):
    file = tmp_path / name
    file.write_bytes(content)
    visit = open_page("robot=scara&q=20,40,0.08,0&open=pose")
    choose(visit.page, file)
    assert_opened(visit, 2)
    visit.page.locator(".joint .value").nth(1).fill("90")
    visit.settled()
    # q2 - 90 degrees is zero: the second link lies along the first x axis.
    np.testing.assert_allclose(
        [row[3] for row in visit.matrix("pose")], [0.3, 0, 0.4, 1], atol=1e-9
    )


def test_a_workbook_that_cannot_be_read_says_why_and_leaves_the_page(open_page, tmp_path):
    file = tmp_path / "notes.xlsx"
    file.write_bytes(xlsx([["nothing"]]))
    visit = open_page("robot=planar_3r&q=30,-45,60&open=pose", refusals=True)
    choose(visit.page, file)
    window = visit.page.get_by_role("dialog", name="Read the workbook notes.xlsx")
    window.get_by_role("alert").filter(has_text="0 sheets with a D-H table").wait_for()
    assert window.locator("textarea").count() == 0
    assert joint_values(visit.page) == ["30", "-45", "60"]


def test_texts_of_windows_are_opened(open_page, tmp_path):
    visit = open_page("robot=scara&q=20,40,0.08,0&open=pose")
    for encoding in ("windows-1252", "utf-16"):
        file = tmp_path / f"{encoding}.m"
        file.write_bytes(SCRIPT.encode(encoding))
        choose(visit.page, file)
        assert_opened(visit, 2)
        visit.page.keyboard.press("Control+z")
        assert_opened(visit, 4)
    file = tmp_path / "named.urdf"
    file.write_bytes(NAMED.encode("iso-8859-1"))
    choose(visit.page, file)
    assert_opened(visit, 2)


@pytest.mark.parametrize("language", ["en-GB", "fr-FR"])
def test_every_fault_of_a_urdf_is_shown_beside_its_lines(language, open_page, tmp_path):
    file = tmp_path / "bad.urdf"
    file.write_text(THIRTEEN)
    visit = open_page("robot=planar_3r&q=30,-45,60&open=pose", refusals=True, locale=language)
    page, before = visit.page, visit.page.url
    choose(page, file)
    window = page.get_by_role("dialog")
    window.wait_for()
    faults = window.locator(".faults > li")
    assert faults.count() == 10
    rows = THIRTEEN.split("\n")
    for k, (line, xpath, words) in enumerate(TOLD[:10]):
        fault = faults.nth(k)
        said = fault.locator("p").first.inner_text()
        assert said.startswith(f"{'ligne' if language[:2] == 'fr' else 'line'} {line}: ")
        assert language[:2] == "fr" or words in said
        assert fault.locator("code").inner_text() == xpath
        marked = fault.locator("pre mark").inner_text().strip().split(maxsplit=1)
        assert marked == [str(line), rows[line - 1].strip()]
        assert rows[line - 2].strip() in fault.locator("pre").inner_text()
    rest = len(TOLD) - 10
    words = f"et {rest} de plus" if language[:2] == "fr" else f"and {rest} more"
    assert window.get_by_text(words, exact=True).count() == 1
    page.keyboard.press("Escape")
    assert not window.count()
    assert (page.url, joint_values(page)) == (before, ["30", "-45", "60"])


def test_what_a_urdf_says_is_shown_as_text(open_page, tmp_path):
    file = tmp_path / "hostile.urdf"
    file.write_text(
        THIRTEEN.replace("elbow", "&lt;img src=x onerror=alert(1)>").replace(
            "<robot", "<!-- <script>alert(1)</script> -->\n<robot"
        )
    )
    visit = open_page("robot=planar_3r", refusals=True)
    choose(visit.page, file)
    window = visit.page.get_by_role("dialog")
    window.wait_for()
    assert window.locator("img, script").count() == 0
    assert "<img src=x onerror=alert(1)>" in window.inner_text()
