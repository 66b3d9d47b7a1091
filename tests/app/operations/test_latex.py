"""Answers as LaTeX: the numbers of JSON, and nothing that plain pdflatex stops at."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.sheets.latex import equation, escaped, number, tabular
from app.sheets.sheet import Column, Sheet

MATRIX = re.compile(
    r"\\\[ ([^\n]*?) = (?:[^\n]*? )?\\begin\{bmatrix\}\n(.*?)\n\\end\{bmatrix\} \\\]", re.DOTALL
)
ARM = "/v1/robots/puma560"
Q = {"q": [0.1, -0.2, 0.3, 0.4, -0.5, 0.6]}


def matrices(text):
    """What a reader of LaTeX finds, by label."""
    found = {}
    for label, body in MATRIX.findall(text):
        rows = [row.split(" & ") for row in body.split(" \\\\\n")]
        found[label] = np.array([[float(as_python(entry)) for entry in row] for row in rows])
    return found


def as_python(entry):
    return re.sub(r" \\cdot 10\^\{(-?\d+)\}", r"e\1", entry)


def latex(client, path, body, **query):
    answer = client.post(path, json=body, params={**query, "format": "latex"})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].startswith("application/x-latex")
    return answer.text


@pytest.mark.scene
def test_matrices_are_those_of_json(client):
    T = matrices(latex(client, f"{ARM}/fk", {**Q, "frames": ["frame_2", "tool"]}))
    poses = client.post(f"{ARM}/fk", json={**Q, "frames": "all"}).json()["poses"]
    np.testing.assert_allclose(T[r"T_{\text{tool}}"], poses["tool"]["matrix"], atol=5.1e-7)
    np.testing.assert_allclose(T[r"T_{\text{frame\_2}}"], poses["frame_2"]["matrix"], atol=5.1e-7)
    said = client.post(f"{ARM}/dh-matrices", json=Q).json()
    found = matrices(latex(client, f"{ARM}/dh-matrices", Q, digits=9))
    for k in range(6):
        np.testing.assert_allclose(found[f"A_{{{k + 1}}}"], said["A"][k], atol=5.1e-10)
        np.testing.assert_allclose(found[f"{{}}^{{0}}A_{{{k + 1}}}"], said["T0"][k], atol=5.1e-10)
    np.testing.assert_allclose(found["T"], said["T"], atol=5.1e-10)


def test_a_square_jacobian_with_determinant_and_inverse(client):
    body = {"q": [0.5, 0.3], "task": "xy"}
    text = latex(client, "/v1/robots/planar_2r/jacobian", body, digits=12)
    found = matrices(text)
    np.testing.assert_allclose(found["J"] @ found["J^{-1}"], np.eye(2), atol=1e-10)
    determinant = float(re.search(r"\\det J = (\S+) ", text)[1])
    assert determinant == pytest.approx(np.linalg.det(found["J"]), abs=1e-10)
    stretched = latex(client, "/v1/robots/planar_2r/jacobian", {**body, "q": [0.5, 0]})
    assert "J^{-1}" not in stretched


def test_more_columns_than_amsmath_takes(client):
    text = latex(client, "/v1/robots/talos/jacobian", {"q": [0.0] * 32, "frame": "base_link"})
    assert "bmatrix" not in text
    assert text.count("&") == 6 * (len(text.split("{array}{")[1].split("}")[0]) - 1)


def test_numbers():
    shown = {0.25: "0.25", -0.0: "0", 1e-13: "0", 2.0: "2", 1.5e-9: r"1.5 \cdot 10^{-9}"}
    shown |= {-2e7: r"-2 \cdot 10^{7}", np.inf: r"\infty", 1 / 3: "0.333333", 0.9999999: "1"}
    assert {value: number(value) for value in shown} == shown
    assert number(0.25, 4) == "0.2500"
    assert number(-0.00001, 3) == "0.000"


@given(st.text(max_size=40))
def test_any_text_is_safe(text):
    """What is left without the commands of the table is no letter that LaTeX acts on."""
    shown = escaped(text)
    rest = re.sub(r"\\text[a-z]+\{\}|\$\\[A-Za-z]+\$|\$\^\\circ\$|\\[#$%&_{}]", "", shown)
    rest = re.sub(r"^\{[\[*]\}", "", rest)
    assert not set(rest) & set("\\{}#$%&_^~")
    assert all(letter.isascii() or "À" <= letter <= "ž" for letter in rest)
    assert "\n" not in shown


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no pdflatex here")
def test_pdflatex_compiles_all_of_it(client, tmp_path):
    arm = {
        "name": "θ_arm",
        "convention": "standard",
        "joints": [
            {"name": "épaule_1", "type": "R", "a": 0.4, "alpha": 0, "d": 0},
            {"name": "关节 2", "type": "R", "a": 0.3, "alpha": 0, "d": 0},
        ],
    }
    square = {"task": "xy", "parameters": "symbolic", "quantities": "all"}
    parts = [
        latex(client, "/v1/fk", {"robot": arm, "q": [[0.1, 0.2], [1e-9, 2]], "frames": "all"}),
        latex(client, "/v1/jacobian", {"robot": arm, "q": [0.1, 0.2], "task": "xy"}),
        latex(client, "/v1/singularity", {"robot": arm, "q": [0.1, 0.2], "task": "xy"}),
        latex(client, "/v1/symbolic", {"robot": arm, **square}),
        latex(client, "/v1/symbolic", {"robot": "planar_3r", **square, "task": "xy_phi"}),
        latex(client, "/v1/ik", {"robot": arm, "task": "xy", "target": {"position": [9, 9]}}),
        latex(
            client, f"{ARM}/ik/solutions", {"target": {"position": [0.4, 0.2, 0.5], "rpy": [0] * 3}}
        ),
        latex(client, "/v1/robots/talos/jacobian", {"q": [0.0] * 32}),
        *(
            client.get(f"/v1/dh-matrices?convention={name}&format=latex").text
            for name in ("standard", "modified", "khalil")
        ),
        client.get("/v1/robots/pa10/dh?convention=standard&format=latex").text,
        tabular(Sheet((Column("[a]", ["[x]", "*", '"<|>~^\\']), Column("b_%", [1, 2.5, -3e9])))),
        equation("M", np.array([[1e-9, np.inf, -0.0]])),
    ]
    head = "\\documentclass{article}\\usepackage{amsmath}\\begin{document}\n"
    (tmp_path / "all.tex").write_text(head + "\n".join(parts) + "\\end{document}\n", "utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, stdin=subprocess.DEVNULL)
    assert done.returncode == 0, done.stdout[-3000:].decode("utf-8", "replace")
