import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from dh_to_urdf import (
    read_csv,
    read_mapping,
    read_par,
    read_yaml,
    table_to_par,
    table_to_urdf,
)
from dh_to_urdf.pasted.writer import TABLE_TEXTS

COMMAND = Path(sys.executable).parent / "dh-to-urdf"
YAML = """\
name: two_r
convention: modified
joints:
- {name: q1, type: R, alpha: 0, a: 0, d: 0, theta: 0}
- {name: q2, type: R, alpha: 0, a: 0.5, d: 0, theta: 90°, limits: {lower: -2, upper: 2}}
"""
CSV = "name,type,alpha,a,d,theta\nq1,R,0,0,0,0\nq2,P,90,500,0,45\n"


def run(*arguments, text=""):
    return subprocess.run(
        [COMMAND, *map(str, arguments)],
        input=text,
        capture_output=True,
        encoding="utf-8",
        env={**os.environ, "PYTHONWARNINGS": "error"},
        check=False,
    )


@pytest.fixture
def document(tmp_path):
    """Writes a file and gives its path."""

    def write(name, text):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_yaml_becomes_a_urdf_file(document, tmp_path):
    output = tmp_path / "robot.urdf"
    result = run(document("two_r.yaml", YAML), "-o", output)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert output.read_text(encoding="utf-8") == table_to_urdf(read_yaml(YAML)) + "\n"


def test_json_is_printed_without_output_file(document):
    table = {"convention": "dh", "joints": [{"type": "R", "alpha": 0, "a": 1, "d": 0}]}
    result = run(document("arm.json", json.dumps(table)), "--no-visuals")
    assert result.returncode == 0
    assert result.stdout == table_to_urdf(read_mapping(table), visuals=False) + "\n"


def test_csv_needs_a_convention(document):
    path = document("arm.csv", CSV)
    refused = run(path)
    assert (refused.returncode, refused.stdout) == (1, "")
    assert refused.stderr.startswith("convention: convention is missing; give standard")
    options = ("--name", "arm", "--angle", "deg", "--length", "mm")
    result = run(path, "--convention", "standard", *options)
    assert result.stdout == table_to_urdf(read_csv(CSV, "standard", "arm", "deg", "mm")) + "\n"


def test_a_dash_reads_standard_input():
    assert run("-", text=YAML).stdout == table_to_urdf(read_yaml(YAML)) + "\n"


def test_a_dash_with_a_convention_is_csv():
    assert (
        run("-", "--convention", "dh", text=CSV).stdout == table_to_urdf(read_csv(CSV, "dh")) + "\n"
    )


def test_a_bad_table_exits_with_1_and_says_where(document, tmp_path):
    bad = YAML.replace("a: 0.5", "a: foo").replace("lower: -2", "lower: 3")
    output = tmp_path / "robot.urdf"
    result = run(document("bad.yaml", bad), "-o", output)
    assert (result.returncode, result.stdout) == (1, "")
    first, second = result.stderr.splitlines()
    assert first.startswith("joints[1].a: joint 2 (q2): a is 'foo'")
    assert second.startswith("joints[1].limits.lower: joint 2 (q2): limits.lower 3 is above")
    assert not output.exists()


def test_what_was_assumed_is_said_on_standard_error(document):
    rounded = "tool: [[0.8, -0.600001, 0, 0], [0.6, 0.8, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
    result = run(document("t.yaml", YAML + rounded))
    assert result.returncode == 0
    assert result.stderr.startswith("warning: tool: the matrix is rounded")


def test_check_loads_the_result_with_an_independent_reader(document):
    result = run(document("two_r.yaml", YAML), "--check")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == table_to_urdf(read_yaml(YAML)) + "\n"


def test_a_missing_file_is_a_usage_error(tmp_path):
    result = run(tmp_path / "nothing.yaml")
    assert (result.returncode, "does not exist" in result.stderr) == (2, True)


PAR = Path(__file__).parents[1] / "fixtures" / "par"


def test_par_files_take_values_and_are_written(tmp_path):
    output = tmp_path / "rx90.par"
    values = ("--values", "D3:0.45,RL4:450mm")
    result = run(PAR / "rx90.par", *values, "--format", "par", "-o", output)
    assert (result.returncode, result.stderr) == (0, "")
    table = read_par((PAR / "rx90.par").read_text(), values={"D3": 0.45, "RL4": 0.45})
    assert output.read_text() == table_to_par(table)
    refused = run(PAR / "rx90.par")
    assert (refused.returncode, "'D3'" in refused.stderr) == (1, True)


def test_closed_loops_are_cut():
    values = ("--values", "d2:0.3,d3:0.8,d4:0.14,d8:0.5,RL4:1")
    result = run(PAR / "sr400.par", *values, "--cut-loops")
    assert (result.returncode, result.stdout.count("continuous")) == (0, 8)
    assert result.stderr.startswith("warning: closed loops are cut")


@pytest.mark.parametrize(("suffix", "form"), [("tex", "latex"), ("m", "matlab")])
def test_pasted_text_is_read_by_its_suffix(document, suffix, form):
    table = read_yaml(YAML)
    path = document(f"two_r.{suffix}", TABLE_TEXTS[form].write(table))
    result = run(path, "--convention", "modified", "--name", "two_r", "--format", "markdown")
    assert result.returncode == 0, result.stderr
    heading = TABLE_TEXTS["markdown"].write(table).splitlines()[:2]
    assert result.stdout.splitlines()[:2] == heading
    assert "| 2 |" in result.stdout
    assert "-2 rad" in result.stdout


def test_columns_and_units_of_pasted_text(document):
    path = document("bare.txt", "0 400 0 90\n0 0 300 0\n")
    options = ("--convention", "dh", "--columns", "theta,d,a,alpha", "--angle", "deg")
    result = run(path, *options, "--length", "mm", "--format", "tsv")
    assert result.stdout.splitlines()[1] == "1\tR\tpi/2\t0\t0.4\ttheta1"


def test_values_are_not_for_documents_that_have_them(document):
    result = run(document("two_r.yaml", YAML), "--values", "a:1")
    assert (result.returncode, "field values" in result.stderr) == (2, True)
