import io
import zipfile

import numpy as np
import openpyxl
import pytest

from dh_to_urdf import DHError, dh_matrices, read_pasted, read_spreadsheet

TITLE = "D-H parameters of the arm (mm, degrees)"
ROWS = [["i", "α", "a", "d", "θ"], [1, 90, 0, 400, "q1"], [2, 0, 300, 0, "q2-90"]]
RIGHT = (
    "| i | α | a | d | θ |\n|-|-|-|-|-|\n| 1 | 90° | 0 | 0.4 | q1 |\n| 2 | 0 | 0.3 | 0 | q2-90° |\n"
)
ODS = """<office:document-content xmlns:office="urn:oasis:names:tc:opendocument:xmlns:office:1.0"
 xmlns:table="urn:oasis:names:tc:opendocument:xmlns:table:1.0"
 xmlns:text="urn:oasis:names:tc:opendocument:xmlns:text:1.0" office:version="1.2"><office:body>
 <office:spreadsheet><table:table table:name="DH">{rows}</table:table></office:spreadsheet>
 </office:body></office:document-content>"""


def xlsx(*sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for rows in sheets:
        sheet = book.create_sheet()
        for row in rows:
            sheet.append(row)
    content = io.BytesIO()
    book.save(content)
    return content.getvalue()


def ods(rows, repeated=1):
    def cell(value):
        kind = "float" if isinstance(value, (int, float)) else "string"
        number = f' office:value="{value}"' if kind == "float" else ""
        return (
            f'<table:table-cell office:value-type="{kind}"{number}'
            f' table:number-columns-repeated="{repeated}"><text:p>{value}</text:p>'
            "</table:table-cell>"
        )

    body = "".join(
        f'<table:table-row table:number-rows-repeated="{repeated}">'
        f"{''.join(map(cell, row))}</table:table-row>"
        for row in rows
    )
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        archive.writestr("META-INF/manifest.xml", "<manifest/>")
        archive.writestr("content.xml", ODS.format(rows=body))
    return content.getvalue()


def assert_right(table):
    right = read_pasted(RIGHT, "standard")
    q = [0.3, -0.4]
    assert np.allclose(dh_matrices(table, q).T, dh_matrices(right, q).T, atol=1e-12)


def test_a_workbook_is_read():
    table = read_spreadsheet(xlsx([[TITLE], [], *ROWS], [["notes", 1, 2, 3]]), "standard")
    assert_right(table)
    assert "plain numbers are in deg, mm" in table.warnings[0]
    shifted = [["", *row] for row in ([TITLE], [], *ROWS, [], ["measured in 2024"])]
    assert_right(read_spreadsheet(xlsx(shifted), "standard"))
    assert_right(read_spreadsheet(ods(ROWS), "standard", angle="deg", length="mm"))
    turned = [list(line) for line in zip(*ROWS, strict=True)]
    assert_right(read_spreadsheet(xlsx([[TITLE], *turned]), "standard"))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "no .xlsx or .ods"),
        (b"PK\x03\x04 and more", "no .xlsx or .ods"),
        (xlsx([["nothing"]]), "0 sheets"),
        (xlsx(ROWS, ROWS), "2 sheets"),
        (xlsx([*ROWS, [], [3, 0, 300, 0, "q3"]]), "stands apart"),
        (ods([[1]], repeated=1_000_000), "too many cells"),
    ],
)
def test_other_files_are_refused(content, words):
    with pytest.raises(DHError, match=words):
        read_spreadsheet(content, "standard")


def test_bombs_are_refused():
    book = openpyxl.Workbook()
    book.active["A1"], book.active["XFD1048576"] = 1, 2
    content = io.BytesIO()
    book.save(content)
    with pytest.raises(DHError, match="too many cells"):
        read_spreadsheet(content.getvalue(), "standard")
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("content.xml", b"0" * 30_000_000)
    with pytest.raises(DHError, match="unpacked"):
        read_spreadsheet(content.getvalue(), "standard")


FORMULAS = [
    ["i", "type", "alpha", "a", "d", "theta", "offset", "lower", "upper"],
    [1, "R", 0, 0.2, 0.4, "=PI()/2", 0, "=-PI()", "=PI()"],
    [2, "R", 0, 0.3, 0, 0, "=PI()/4", -1, 1],
]


def changed(content, part, old, new):
    """A workbook with other text in one of its parts."""
    written = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(content)) as archive,
        zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as copy,
    ):
        for name in archive.namelist():
            text = archive.read(name)
            if name == part:
                assert old in text
                text = text.replace(old, new)
            copy.writestr(name, text)
    return written.getvalue()


def test_a_formula_without_its_value_is_refused_by_its_cell():
    with pytest.raises(DHError) as caught:
        read_spreadsheet(xlsx(FORMULAS), "standard")
    told = [str(fault) for fault in caught.value.faults]
    assert [text.split()[1] for text in told] == ["F2", "H2", "I2", "G3"]
    assert "=PI()/2" in told[0]
    assert "save it" in told[0]
    rows = ods([["i", "alpha", "a", "d", "theta"], [1, 90, 0, 400, 77]])
    right = b'<table:table-cell office:value-type="float" office:value="77"'
    formula = b'<table:table-cell table:formula="of:=PI()/2"'
    with pytest.raises(DHError, match="cell E2 of sheet 'DH' holds the formula of:=PI"):
        read_spreadsheet(changed(rows, "content.xml", right, formula), "standard")


def test_a_table_of_formulas_only_is_refused_by_its_cells():
    rows = [FORMULAS[0], [f"={10 + k}" for k in range(9)], [f"={20 + k}" for k in range(9)]]
    with pytest.raises(DHError, match="cell A2 of sheet"):
        read_spreadsheet(xlsx(rows), "standard")
    heads = [[f'="{head}"' for head in FORMULAS[0]], *ROWS[1:]]
    with pytest.raises(DHError, match="cell A1 of sheet"):
        read_spreadsheet(xlsx(heads), "standard")


def test_values_that_the_file_calls_stale_are_refused():
    sheet = "xl/worksheets/sheet1.xml"
    zeros = changed(xlsx(FORMULAS), sheet, b"</f><v></v>", b"</f><v>0</v>")
    with pytest.raises(DHError, match="cell F2 of sheet"):
        read_spreadsheet(zeros, "standard")
    saved = changed(zeros, "xl/workbook.xml", b' fullCalcOnLoad="1"', b"")
    assert read_spreadsheet(saved, "standard").rows[1].offset == 0


@pytest.mark.parametrize("error", ["#REF!", "#DIV/0!", "#N/A"])
def test_errors_are_refused_by_name(error):
    rows = [*FORMULAS[:1], [1, "R", 0, 0.2, 0.4, error, 0, -1, 1]]
    with pytest.raises(DHError, match=f"cell F2 of sheet 'Sheet' is the error {error}"):
        read_spreadsheet(xlsx(rows), "standard")
    cell = (
        '<table:table-cell table:formula="of:=1/0" office:value-type="string"'
        ' xmlns:c="urn:org:documentfoundation:names:experimental:calc:xmlns:calcext:1.0"'
        f' office:string-value="" c:value-type="error"><text:p>{error}</text:p></table:table-cell>'
        '<table:table-cell office:value-type="float" office:value="0"'
    )
    right = b'<table:table-cell office:value-type="float" office:value="77"'
    written = ods([["i", "alpha", "a", "d", "theta"], [1, 90, 0, 400, 77]])
    with pytest.raises(DHError, match=f"cell E2 of sheet 'DH' is the error {error}"):
        read_spreadsheet(changed(written, "content.xml", right, cell.encode()), "standard")


def test_hidden_sheets_count_where_no_visible_one_has_a_table():
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in (("shown", [[TITLE], *ROWS]), ("old", [*ROWS, [], [3, 0, 300, 0, "q3"]])):
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book["old"].sheet_state = "hidden"
    content = io.BytesIO()
    book.save(content)
    assert_right(read_spreadsheet(content.getvalue(), "standard"))
    del book["shown"]
    content = io.BytesIO()
    book.create_sheet("front")
    book.save(content)
    with pytest.raises(DHError, match="stands apart"):
        read_spreadsheet(content.getvalue(), "standard")
