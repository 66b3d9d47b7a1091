import json

import pytest
from click.testing import CliRunner

from dh_to_urdf import read_csv, read_json, read_yaml, table_to_urdf
from dh_to_urdf.urdf_cli import main

YAML = """\
name: arm
convention: standard
joints:
- {name: q1, type: R, alpha: 90°, a: 0, d: 0.3, theta: 0, limits: {lower: -1, upper: 1}}
- {name: q2, type: P, alpha: 0, a: 0.5, d: 0, theta: 0}
"""


@pytest.fixture
def urdf(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(table_to_urdf(read_yaml(YAML)))
    return str(path)


def run(*arguments, text=None):
    return CliRunner().invoke(main, [*arguments], input=text)


def test_every_format_holds_the_table(urdf, tmp_path):
    common = [urdf, "--convention", "craig"]
    text = run(*common, "--angle", "deg", "--explain")
    assert text.exit_code == 0
    assert "How it was found:" in text.output
    assert "residual:" in text.output
    document = json.loads(run(*common, "--format", "json").output)
    assert document["residual"]["position"] < 1e-12
    rows = read_json(json.dumps(document)).rows
    assert read_yaml(run(*common, "--format", "yaml").output).rows == rows
    csv = run(*common, "--format", "csv").stdout
    assert read_csv(csv, "modified").rows[:2] == rows
    assert r"\begin{tabular}" in run(*common, "--format", "latex").output
    output = tmp_path / "out.yaml"
    run(*common, "--format", "yaml", "-o", str(output))
    assert read_yaml(output.read_text()).rows == rows


def test_standard_input_base_and_tip(urdf):
    with open(urdf) as stream:  # noqa: PTH123
        text = stream.read()
    result = run("-", "--convention", "dh", "--tip", "frame_1", "--format", "json", text=text)
    assert [row["name"] for row in json.loads(result.output)["joints"]] == ["q1"]


def test_errors_say_where_and_exit_with_1(urdf):
    result = run(urdf, "--convention", "dh", "--tip", "nowhere")
    assert result.exit_code == 1
    assert "tip: tip is 'nowhere'" in result.output
    assert run(urdf).exit_code == 2
    assert run(urdf, "--convention", "dh", "--snap", "1").exit_code == 2
