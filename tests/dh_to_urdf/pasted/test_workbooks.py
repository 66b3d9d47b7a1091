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
